"""The report on Table I, from the files of its cells alone: Markdown, and the pictures of draw_charts.py."""

from collections import Counter
from pathlib import Path

import numpy as np

from . import draw, draw_charts
from .compare import episodes_needed, in_points, mcnemar, over_cells
from .experiment import GAPS_DEG, GAPS_M, N_CHECKPOINTS, Cell, load_cell
from .files import check_folder, load_json, write_whole
from .groundwork import check_settings
from .outcomes import adapted, best_checkpoint, by_gap, by_world, curve, from_training, gains, groups, right
from .paper import VIEW_MS, table_1
from .table import cell_path
from .terminal import Stage, count

SHOWN = "SV", "MV", "Scan", "Ours", "DA", "Ours+", "Oracle"
PAIRS = (("MV", "SV"), ("Ours", "MV"), ("DA", "Ours"), ("Scan", "MV"), ("Ours", "Scan"), ("Ours+", "MV"),
         ("Ours+", "Scan"), ("Ours+", "Ours"), ("Oracle", "Ours"))
RESOLVED = 10, 5, 2.5, 1  # differences to be shown, in points
FEW_CELLS = 10
T_XY = "t_xy_m", "T_xy {} m"


def add_arguments(parser):
    """Options of `python -m gnl report`."""
    parser.add_argument("--out", default="out/table", help="folder of results of `python -m gnl table` (out/table)")
    parser.add_argument("--to", help="folder for the report (OUT/report)")


def run(args):
    """Write report.md and its pictures."""
    check_folder("--to", args.out if args.to is None else args.to)
    stage, folder = Stage("report"), Path(args.to or Path(args.out) / "report")
    results, costs, settings = load(args.out)
    text = "\n\n".join(sections(results, costs, settings)) + "\n"
    pictures = {"gaps": draw_charts.heat_maps(by_gap(results, "Ours", "MV"), GAPS_M, GAPS_DEG),
                "curves": draw_charts.curves({world: curve(of_world) for world, of_world in by_world(results).items()}),
                "chosen": draw_charts.histogram(Counter(adapted(result) for result in results))}
    for name, picture in pictures.items():
        draw.save_png(picture, folder / f"{name}.png")
    write_whole(folder / "report.md", text.encode())
    stage.done(f"{len(results)} cells, {folder / 'report.md'}")


def load(out):
    """Outcomes and costs of all cells of a folder, ordered by cell, and their settings."""
    paths = sorted(Path(out).glob("cells/*.json"))
    if not paths:
        raise ValueError(f"{Path(out) / 'cells'}: expected cells of `python -m gnl table`, found none")
    cells = [load_cell(path) for path in paths]
    for path, (result, _) in zip(paths, cells, strict=True):
        if result["tests"].keys() != cells[0][0]["tests"].keys():
            raise ValueError(f"{path}: expected tests of {', '.join(cells[0][0]['tests'])}, as in {paths[0].name}, "
                             f"found those of {', '.join(result['tests'])}; name another folder")
    cells.sort(key=lambda cell: [cell[0]["cell"][name] for name in ("world", "t_xy_m", "t_theta_deg", "seed")])
    settings = load_json(Path(out) / "settings.json", "the settings of a table")
    if not {"episodes", "tests"} <= settings.keys():
        raise ValueError(f"{Path(out) / 'settings.json'}: expected the settings of a table, found {sorted(settings)}")
    made_from = {}
    for result, _ in cells:
        path = cell_path(out, Cell(**result["cell"]).name)
        check_settings(path, result.get("settings") or {}, settings)
        parts = made_from.setdefault(result["cell"]["world"], result.get("made from"))
        if parts != result.get("made from"):
            raise ValueError(f"{path}: expected a cell made from {parts}, as others of its home, found one made from "
                             f"{result.get('made from')}; name another folder")
    return *map(list, zip(*cells, strict=True)), settings


def sections(results, costs, settings):
    """The parts of the report, each a piece of Markdown."""
    methods = methods_of(results)
    n_tests = sum(len(right(result)["MV"]) for result in results)
    yield "# Table I, run again"
    yield (f"{len(results)} cells, {settings['episodes']} training episodes and {settings['tests']} tests each; "
           f"{n_tests} test episodes of every method. All numbers are percent or percentage points of right answers "
           "(place: x, y and bearing) after the fifth look. Intervals are 95 %, from a bootstrap of whole cells"
           + (": of so few cells they say nothing." if len(results) < FEW_CELLS else
              "; they hold for these homes, this net and these classifiers, which cells share."))
    yield "## Means\n\n" + means(results, methods)
    yield "## Differences in pairs\n\n" + differences(results, methods)
    yield ("![Squares: Ours - MV at each gap, a table for each home](gaps.png)\n\n"
           "*Ours - MV by gap. Blue: Ours was right more often, orange: chance was.*")
    yield "## The paper's own cells\n\n" + papers_differences()
    yield "## How many episodes it takes\n\n" + power(results, methods)
    yield "## The location alone\n\n" + locations(results, methods)
    yield "## What Ours knows by heart\n\n" + by_heart(results)
    yield "## Which checkpoint adaptation chose\n\n" + adaptation(results)
    yield ("![Lines: right answers by checkpoint, a chart for each home](curves.png)\n\n"
           "*Share of right answers after the last look: Ours by checkpoint, with its interval, and methods that have "
           "no checkpoints.*")
    yield ("![Bars: how many cells chose each checkpoint](chosen.png)\n\n"
           "*In how many cells adaptation chose each checkpoint.*")
    yield "## What it costs\n\n" + cost(costs)
    yield "## Table I\n\n" + whole_table(results, methods)


def markdown(head, rows):
    """A table."""
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def percent(values):
    return f"{100 * np.mean(values):.1f}"


def interval(differences):
    """Mean over cells in points and its interval, as words."""
    return in_points(*over_cells(differences, np.random.default_rng(0)))


def means(results, methods):
    """Right answers by world, by T_xy and by T_theta, the paper's in brackets."""
    papers, rows = table_1(), []
    for name, group in groups(results, ("world", "home {}"), T_XY, ("t_theta_deg", "T_theta {} deg")):
        cells = [(r["cell"]["world"], r["cell"]["t_xy_m"], r["cell"]["t_theta_deg"]) for r in group]
        row = [name]
        for method in methods:
            theirs = [papers[cell][method] for cell in cells if cell in papers and method in papers[cell]]
            row.append(percent([right(result)[method].mean() for result in group])
                       + (f" ({np.mean(theirs):.1f})" if theirs else ""))
        rows.append(row)
    return ("The paper's means of the same cells in brackets. SV answers from the first view, MV moves by "
            "chance, Scan by one fixed sequence, Ours by NNQL; DA is Ours at a checkpoint chosen by validation, Oracle "
            "at that which is best on the tests themselves: that is cheating. Ours+ goes on with one action.\n\n"
            + markdown(["", *methods], rows))


def methods_of(results):
    """What was tested, in the order of the report: the known methods first, then planners that a reader added."""
    there = right(results[0])
    return [*(name for name in SHOWN if name in there), *(name for name in there if name not in SHOWN)]


def pairs_of(methods):
    """Pairs (a, b) of methods for a - b; from a planner that a reader added, chance and the best fixed sequence."""
    pairs = [*PAIRS, *((name, other) for name in methods if name not in SHOWN for other in ("MV", "Scan"))]
    return [(a, b) for a, b in pairs if a in methods and b in methods]


def differences(results, methods):
    """Paired differences over all cells and in each world, and McNemar's exact p over all pairs."""
    worlds = by_world(results)
    rows = []
    for a, b in pairs_of(methods):
        d = {world: gains(group, a, b) for world, group in worlds.items()}
        every = [np.concatenate([right(result)[name] for result in results]) for name in (a, b)]
        rows.append([f"{a} - {b}", interval(sum(d.values(), [])), f"{mcnemar(*every):.1g}",
                     *(interval(of_world) for of_world in d.values())])
    return ("McNemar's p takes the episodes of a cell as independent, and may be too small.\n\n"
            + markdown(["", "points", "McNemar p", *(f"home {world}" for world in worlds)], rows))


def papers_differences():
    """The same for the paper's 75 cells, whose episodes are not known: only cells can be resampled."""
    cells = table_1().values()
    rows = [[f"{a} - {b}", interval([(cell[a] - cell[b]) / 100 for cell in cells])]
            for a, b in (("MV", "SV"), ("Ours", "MV"), ("DA", "Ours"))]
    return markdown(["", "points"], rows)


def power(results, methods):
    """Episodes needed to show a difference, paired and unpaired."""
    rows = []
    for a, b in pairs_of(methods):
        first, second = (np.concatenate([right(result)[name] for result in results]).astype(float) for name in (a, b))
        paired, alone = (first - second).std(), np.hypot(first.std(), second.std())
        rows.append([f"{a} - {b}", *(f"{episodes_needed(points / 100, paired)} / {episodes_needed(points / 100, alone)}"
                                     for points in RESOLVED)])
    return ("To see a true difference in 80 % of all experiments at 95 %: episodes in pairs / episodes of each method "
            "that are not paired. This takes the episodes of a cell as independent; where they are alike it takes "
            "more.\n\n" + markdown(["", *(count(n, "point") for n in RESOLVED)], rows))


def locations(results, methods):
    """Right answers if the bearing does not count, and how much methods differ then."""
    def where(result):
        return right(result, "location")

    rows = [["place", *(percent([right(result)[name].mean() for result in results]) for name in methods)],
            ["location", *(percent([where(result)[name].mean() for result in results]) for name in methods)]]
    pairs = [[f"{a} - {b}", *(interval(gains(results, a, b, of)) for of in (right, where))]
             for a, b in pairs_of(methods)]
    return markdown(["", *methods], rows) + "\n\n" + markdown(["", "place", "location"], pairs)


def by_heart(results):
    """Ours beside chance and the best fixed sequence, from the tests and from starts that it was trained on."""
    pairs = [(other, of) for other in ("MV", "Scan") for of in (right, from_training)]
    rows = [[name, *(interval(gains(group, "Ours", other, of)) for other, of in pairs)]
            for name, group in groups(results, T_XY)]
    heads = [f"Ours - {other}, {'tests' if of is right else 'training starts'}" for other, of in pairs]
    return ("From the tests, and from as many of the starts of its own training, evenly spread, with new luck.\n\n"
            + markdown(["", *heads], rows))


def adaptation(results):
    """How often each checkpoint was chosen, and how often it was best on the tests; what choosing gained."""
    chosen = np.array([adapted(result) for result in results])
    best = [best_checkpoint(result["checkpoints"]) for result in results]
    rows = [["chosen", *np.bincount(chosen, minlength=N_CHECKPOINTS)],
            ["best on the tests", *np.bincount(best, minlength=N_CHECKPOINTS)]]
    gain = gains(results, "DA", "Ours")
    early = [g for g, c in zip(gain, chosen, strict=True) if c < N_CHECKPOINTS // 2]
    text = f"DA - Ours {interval(gain)}"
    if early:
        text += f"; where one of the first five was chosen ({len(early)} of the cells) {interval(early)}"
    text += ". The best of ten equal ones looks better than they are: much of what Oracle gains is luck, if not all"
    return text + ".\n\n" + markdown(["checkpoint", *range(1, N_CHECKPOINTS + 1)], rows)


def cost(costs):
    """Milliseconds per view by stage, the paper's beside them; memory, machine, versions."""
    views = sum(of_cell["views"] for of_cell in costs)
    stages = sorted({name for of_cell in costs for name in of_cell["of stages"]})
    ms = {name: 1000 * sum(of_cell["of stages"].get(name, 0) for of_cell in costs) / views for name in stages}
    ms["labels and graph"] = ms.pop("labels", 0) + ms.pop("graph")
    rows = [[name, f"{value:.2f}", VIEW_MS.get(name, "")] for name, value in sorted(ms.items(), key=lambda x: -x[1])]
    seconds, training = (sum(part["seconds"] for part in parts)
                         for parts in (costs, [of_cell["of training"] for of_cell in costs]))
    rows.append(["all", f"{1000 * seconds / views:.2f}", f"from {sum(VIEW_MS.values()):.0f} on"])
    machines = dict.fromkeys(of_cell["machine"] for of_cell in costs)
    versions = dict.fromkeys(", ".join(f"{name} {version}" for name, version in of_cell["versions"].items())
                             for of_cell in costs)
    memory = max(of_cell["peak MB"] for of_cell in costs)
    unit, size_s = ("hours", 3600) if seconds >= 3600 else ("minutes", 60)
    return (f"{views} views in {seconds / size_s:.2f} {unit}, summed over cells that ran side by side, "
            f"{training / size_s:.2f} of them for the episodes of training; at most {memory:.0f} MB a process; "
            f"{', '.join(machines)}; {' or '.join(versions)}. Milliseconds a view; the paper does not say whether its "
            "18 hold the net, and names none for rendering, filter and learning:\n\n"
            + markdown(["stage", "ours", "the paper"], rows))


def whole_table(results, methods):
    """Every cell in the paper's layout, home by home, the paper's number in brackets."""
    papers, tables = table_1(), []
    for world, of_world in by_world(results).items():
        cells, rows = {}, []
        for result in of_world:
            cells.setdefault((result["cell"]["t_xy_m"], result["cell"]["t_theta_deg"]), []).append(right(result))
        for gap in sorted(cells, reverse=True):
            theirs = papers.get((world, *gap), {})
            rows.append([*gap, *(percent([one[method].mean() for one in cells[gap]])
                                 + (f" ({theirs[method]:.0f})" if method in theirs else "") for method in methods)])
        tables.append(f"Home {world}:\n\n" + markdown(["T_xy [m]", "T_theta [deg]", *methods], rows))
    return "\n\n".join(tables)
