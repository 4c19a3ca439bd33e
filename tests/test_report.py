"""The report: its numbers are those of the cells' files, by hand; its pictures show them; what is no cell is named."""

import itertools
import json
import re
import shutil
from collections import Counter
from functools import partial

import numpy as np
import pytest
from PIL import Image
from scipy import stats

from gnl import draw_charts, report
from gnl.__main__ import main
from gnl.files import save_json
from gnl.paper import table_1

N = 40
SETTINGS = {"episodes": 10_000, "tests": N}
near = partial(pytest.approx, abs=0.051)  # as one decimal can be
GAPS = (0.2, 10), (0.2, 90), (1.0, 90)
METHODS = "SV", "MV", "Scan", "Ours", "DA", "Ours+", "Oracle"


def outcome(rng, share):
    """Five looks of N episodes, of which a share is right after the last; a fifth of the others in the location."""
    looks = rng.random((5, N)) < share
    where = looks | (rng.random((5, N)) < 0.2)
    return {name: ["".join("01"[int(x)] for x in look) for look in of]
            for name, of in (("place", looks), ("location", where))}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Six cells of known shares of right answers."""
    out, rng = tmp_path_factory.mktemp("report"), np.random.default_rng(0)
    for i, (world, (m, deg)) in enumerate(itertools.product((800, 801), GAPS)):
        tests = {"MV": outcome(rng, 0.4), "Scan": outcome(rng, 0.55), "Ours+": outcome(rng, 0.5)}
        result = {"cell": {"world": world, "t_xy_m": m, "t_theta_deg": deg, "seed": 0}, "sequence": [0] * 4,
                  "name": f"{world}-{m:g}m-{deg}deg-seed0", "settings": SETTINGS,
                  "tests": tests, "checkpoints": [outcome(rng, 0.36 + 0.01 * i) for i in range(10)],
                  "validation": [outcome(rng, 0.4) for _ in range(10)],
                  "from training starts": {name: outcome(rng, share) for name, share in
                                           (("MV", 0.4), ("Scan", 0.5), ("Ours", 0.6))}}
        costs = {"seconds": 3600.0 * (1 + i % 2), "views": 500_000, "of stages": {"labels": 3600.0, "graph": 100.0 * i},
                 "of training": {"seconds": 1800.0 * (1 + i % 2), "views": 400_000},
                 "machine": f"core {i % 2}", "peak MB": 123.0 - i, "versions": {"numpy": "2.0"}}
        for kind, value in (("cells", result), ("costs", costs)):
            path = out / kind / f"{world}-{m:g}m-{deg}deg-seed0.json"
            path.parent.mkdir(exist_ok=True)
            save_json(path, value)
    save_json(out / "settings.json", SETTINGS)
    return out


@pytest.fixture(scope="module")
def written(folder):
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(folder)])
    assert exit.value.code == 0
    return (folder / "report" / "report.md").read_text()


@pytest.fixture(scope="module")
def cells(folder):
    """Of each cell (world, T_xy, T_theta) the right answers after the last look, as numbers, read by hand."""
    found = {}
    for path in sorted(folder.glob("cells/*.json")):
        result = json.loads(path.read_bytes())

        def looks(outcome, what="place"):
            return [np.array([int(c) for c in look]) for look in outcome[what]]

        past, tests = result["checkpoints"], result["tests"]
        n_right = [looks(outcome)[-1].sum() for outcome in past]
        on_validation = [looks(outcome)[-1].sum() for outcome in result["validation"]]
        chosen, best = (max(i for i in range(10) if n[i] == max(n)) for n in (on_validation, n_right))
        outcomes = {**tests, "Ours": past[-1], "DA": past[chosen], "Oracle": past[best]}
        last = {what: {name: looks(outcome, what)[-1] for name, outcome in outcomes.items()}
                | {"SV": looks(tests["MV"], what)[0]} for what in ("place", "location")}
        found[tuple(result["cell"][key] for key in ("world", "t_xy_m", "t_theta_deg"))] = {
            **last["place"], "location": last["location"], "chosen": chosen, "best": best}
    return found


def row(written, start):
    """Cells of the first row of a table that begins so."""
    line = next(line for line in written.splitlines() if line.startswith(f"| {start} |"))
    return [cell.strip() for cell in line.split("|")[1:-1]]


def section(written, title):
    return written.split(f"## {title}\n")[1].split("\n## ")[0]


@pytest.mark.parametrize(("start", "column", "value"), [
    ("all", None, None), ("home 801", 0, 801), ("T_xy 0.2 m", 1, 0.2), ("T_theta 10 deg", 2, 10)])
def test_the_means_are_those_of_the_files_and_the_papers_stand_beside_them(cells, written, start, column, value):
    part = section(written, "Means")
    assert row(part, "")[1:] == list(METHODS)
    group = [cell for cell in cells if column is None or cell[column] == value]
    for method, said in zip(METHODS, row(part, start)[1:], strict=True):
        ours, *theirs = said.split()
        assert float(ours) == near(100 * np.mean([cells[cell][method].mean() for cell in group]))
        papers = [table_1()[cell][method] for cell in group if method in table_1()[cell]]
        assert theirs == ([f"({np.mean(papers):.1f})"] if papers else [])


@pytest.mark.parametrize("pair", [("MV", "SV"), ("Ours", "MV"), ("DA", "Ours"), ("Scan", "MV"), ("Oracle", "Ours")])
def test_a_difference_is_that_of_the_pairs_with_its_interval_and_p(cells, written, pair):
    a, b = pair
    part = section(written, "Differences in pairs")
    _, words, p, *worlds = row(part, f"{a} - {b}")
    points, low, high = map(float, re.findall(r"[+-][\d.]+", words))
    d = np.concatenate([of[a] - of[b] for of in cells.values()])
    assert points == near(100 * d.mean())
    assert low < points < high
    assert float(p) == pytest.approx(stats.binomtest(int((d > 0).sum()), int((d != 0).sum())).pvalue, rel=0.5)
    assert row(part, "")[3:] == ["home 800", "home 801"]
    for world, words in zip((800, 801), worlds, strict=True):
        of_world = np.mean([of[a] - of[b] for (home, *_), of in cells.items() if home == world])
        assert float(words.split()[0]) == near(100 * of_world)


def test_as_many_episodes_are_named_as_pairs_and_as_no_pairs_would_need(cells, written):
    scan, mv = (np.concatenate([of[name] for of in cells.values()]) for name in ("Scan", "MV"))
    variances = (scan - mv).var(), scan.var() + mv.var()
    ten, _, _, one = row(section(written, "How many episodes it takes"), "Scan - MV")[1:]
    for said, difference in ((ten, 0.1), (one, 0.01)):
        needed = [(1.959964 + 0.841621) ** 2 * variance / difference ** 2 for variance in variances]
        assert [int(n) for n in said.split(" / ")] == pytest.approx(needed, abs=1)


def test_what_ours_knows_by_heart_is_told_by_gap(folder, written):
    """Ours - MV and Ours - Scan, from the tests and from starts of training, by hand."""
    part, found = section(written, "What Ours knows by heart"), {}
    for path in sorted(folder.glob("cells/*.json")):
        result = json.loads(path.read_bytes())

        def share(outcome):
            return 100 * outcome["place"][-1].count("1") / N

        ours, known = share(result["checkpoints"][-1]), result["from training starts"]
        numbers = [n for other in ("MV", "Scan") for n in (ours - share(result["tests"][other]),
                                                           share(known["Ours"]) - share(known[other]))]
        for group in ("all", f"T_xy {result['cell']['t_xy_m']} m"):
            found.setdefault(group, []).append(numbers)
    assert [head.rpartition(", ")[2] for head in row(part, "")[1:]] == ["tests", "training starts"] * 2
    for group, numbers in found.items():
        said = row(part, group)[1:]
        assert [float(cell.split()[0]) for cell in said] == near(np.mean(numbers, 0).tolist())
        for cell, column in zip(said, np.transpose(numbers), strict=True):
            low, high = (float(end) for end in re.findall(r"[+-][\d.]+", cell)[1:])
            assert low <= column.mean() + 0.051
            assert high >= column.mean() - 0.051


def test_locations_are_told_apart_from_places(written, cells):
    part = section(written, "The location alone")
    for method, place, location in zip(METHODS, row(part, "place")[1:], row(part, "location")[1:], strict=True):
        assert float(place) == near(100 * np.mean([of[method].mean() for of in cells.values()]))
        assert float(location) == near(100 * np.mean([of["location"][method].mean() for of in cells.values()]))
        assert float(location) > float(place)
    for a, b in (("MV", "SV"), ("Ours", "MV"), ("Scan", "MV")):
        said = [float(words.split()[0]) for words in row(part, f"{a} - {b}")[1:]]
        assert said == near([100 * np.mean([where[a].mean() - where[b].mean() for where in level])
                             for level in (cells.values(), [of["location"] for of in cells.values()])])


def test_the_checkpoints_that_were_chosen_and_that_were_best_are_counted(written, cells):
    part = section(written, "Which checkpoint adaptation chose")
    assert row(part, "checkpoint")[1:] == [str(i) for i in range(1, 11)]
    for start, key in (("chosen", "chosen"), ("best on the tests", "best")):
        counted = [sum(of[key] == i for of in cells.values()) for i in range(10)]
        assert [int(n) for n in row(part, start)[1:]] == counted
    gain = 100 * np.mean([of["DA"] - of["Ours"] for of in cells.values()])
    assert float(re.search(r"DA - Ours ([+-][\d.]+)", part)[1]) == near(gain)


@pytest.mark.parametrize("chosen", [[0, 4, 5, 9, 5, 6], [5, 5, 6, 7, 8, 9]], ids=str)
def test_what_adaptation_gained_where_it_chose_one_of_the_first_five_is_told_if_it_did(folder, chosen):
    def gain(result, checkpoint):
        n_right = [outcome["place"][-1].count("1") for outcome in result["checkpoints"]]
        return 100 * (n_right[checkpoint] - n_right[-1]) / N

    results, _, _ = report.load(folder)
    for result, best in zip(results, chosen, strict=True):
        result["validation"] = [{"place": [str(int(i == best)) * N]} for i in range(10)]
    early = [gain(result, best) for result, best in zip(results, chosen, strict=True) if best in (0, 1, 2, 3, 4)]
    said = re.findall(r"where one of the first five was chosen \((\d) of the cells\) ([+-][\d.]+)",
                      report.adaptation(results))
    assert [int(n) for n, _ in said] == [len(early)] * bool(early)
    assert [float(points) for _, points in said] == ([near(np.mean(early))] if early else [])


def test_the_difference_by_gap_is_that_of_its_cells(folder, cells):
    results, _, _ = report.load(folder)
    of_world = report.by_gap(results, "Scan", "MV")
    assert {(world, *gap) for world, gaps in of_world.items() for gap in gaps} == set(cells)
    for (world, *gap), of in cells.items():
        assert of_world[world][tuple(gap)] == pytest.approx(100 * (of["Scan"] - of["MV"]).mean())
    twice = report.by_gap([results[0], results[0]], "Scan", "MV")
    assert twice == report.by_gap(results[:1], "Scan", "MV")


def test_the_report_says_how_much_it_stands_on(written):
    assert (f"6 cells, 10000 training episodes and {N} tests each; {6 * N} test episodes of every method") in written


def test_the_papers_own_differences_are_told(written):
    part = section(written, "The paper's own cells")
    means = [row(part, name)[1].split()[0] for name in ("MV - SV", "Ours - MV", "DA - Ours")]
    assert means == ["+9.5", "+2.6", "-0.2"]


def test_every_cell_stands_in_the_table_of_its_home_in_the_papers_order(cells, written):
    first, *parts = section(written, "Table I").split("Home ")
    assert (first.strip(), len(parts)) == ("", 2)
    for world, part in zip((800, 801), parts, strict=True):
        assert part.startswith(f"{world}:")
        rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in part.splitlines() if "|" in line]
        assert rows[0] == ["T_xy [m]", "T_theta [deg]", *METHODS]
        gaps = [(float(m), int(deg)) for m, deg, *_ in rows[2:]]
        assert gaps == sorted(GAPS, reverse=True)
        for gap, (_, _, *numbers) in zip(gaps, rows[2:], strict=True):
            for method, said in zip(METHODS, numbers, strict=True):
                ours, *theirs = said.split()
                assert float(ours) == near(100 * cells[(world, *gap)][method].mean())
                papers = table_1()[(world, *gap)].get(method)
                assert theirs == ([] if papers is None else [f"({papers:.0f})"])


def test_cells_that_were_repeated_are_one_row_of_their_mean(folder):
    one, other = report.load(folder)[0][:2]
    twice = [one, {**other, "cell": {**one["cell"], "seed": 1}}]
    said = row(report.whole_table(twice, METHODS), "0.2")[2:]
    for method, words in zip(METHODS, said, strict=True):
        mean = np.mean([report.right(result)[method].mean() for result in twice])
        assert float(words.split()[0]) == near(100 * mean)


def test_costs_are_those_of_all_views(written):
    part = section(written, "What it costs")
    assert row(part, "labels and graph") == ["labels and graph", f"{(6 * 3600 + 1500) / 3000:.2f}", "18"]
    assert row(part, "all") == ["all", f"{9 * 3600 / 3000:.2f}", "from 28 on"]
    assert "3000000 views in 9.00 hours, summed over cells that ran side by side, 4.50 of them for the" in part
    assert "; at most 123 MB a process; core 0, core 1; numpy 2.0" in part
    assert part.index("labels and graph") < part.index("| all |")


def test_costs_of_a_short_run_are_told_in_minutes():
    short = {"seconds": 12.0, "views": 1000, "of stages": {"graph": 3}, "of training": {"seconds": 9.0, "views": 800},
             "machine": "core 0", "peak MB": 123.0, "versions": {"numpy": "2.0"}}
    assert report.cost([short]).startswith("1000 views in 0.20 minutes, summed over cells that ran side by side, 0.15 ")


def test_the_dearest_stage_stands_first_and_the_sum_last():
    of_stages = {"plan": 1.0, "labels": 2.0, "view": 9.0, "graph": 5.0, "filter": 3.0}
    part = report.cost([{"seconds": 20.0, "views": 1000, "of stages": of_stages, "of training": {"seconds": 9.0},
                         "machine": "core 0", "peak MB": 123.0, "versions": {}}])
    rows = [line.split(" | ")[:2] for line in part.splitlines() if line.startswith("| ")][2:]
    assert rows == [["| view", "9.00"], ["| labels and graph", "7.00"], ["| filter", "3.00"], ["| plan", "1.00"],
                    ["| all", "20.00"]]


def test_machines_and_versions_are_those_of_all_cells():
    parts = [{"seconds": 12.0, "views": 1000, "of stages": {"graph": 3}, "of training": {"seconds": 9.0, "views": 800},
              "machine": machine, "peak MB": 123.0, "versions": {"numpy": version, "scipy": "1.17"}}
             for machine, version in (("A", "2.0"), ("B", "2.3"), ("A", "2.0"))]
    assert "; A, B; numpy 2.0, scipy 1.17 or numpy 2.3, scipy 1.17. " in report.cost(parts)


def test_intervals_of_few_cells_are_told_to_say_little(written):
    assert "from a bootstrap of whole cells: of so few cells they say nothing." in written


@pytest.mark.parametrize(("n", "few"), [(9, True), (10, False)])
def test_ten_cells_are_no_longer_few(folder, n, few):
    cells, _, settings = report.load(folder)
    text = next(itertools.islice(report.sections((cells * 2)[:n], [], settings), 1, None))
    assert f"{n} cells" in text
    assert ("of so few cells they say nothing" in text) == few
    assert ("they hold for these homes" in text) != few


def test_the_pictures_are_there_and_the_text_names_them(folder, written):
    for name in re.findall(r"\]\((\w+\.png)\)", written):
        with Image.open(folder / "report" / name) as picture:
            assert min(picture.size) > 100
    assert len(re.findall(r"\]\((\w+\.png)\)", written)) == 3


def test_the_pictures_show_the_same_numbers_as_the_text(folder, cells, tmp_path, monkeypatch):
    shown = {}
    for name in ("heat_maps", "curves", "histogram"):
        monkeypatch.setattr(draw_charts, name, lambda numbers, *_, name=name: shown.update({name: numbers}) or
                            Image.new("RGB", (1, 1)))
    monkeypatch.setattr(report, "sections", lambda *_: [])
    with pytest.raises(SystemExit):
        main(["report", "--out", str(folder), "--to", str(tmp_path)])
    for (world, *gap), of in cells.items():
        assert shown["heat_maps"][world][tuple(gap)] == pytest.approx(100 * (of["Ours"] - of["MV"]).mean())
    assert shown["histogram"] == Counter(of["chosen"] for of in cells.values())
    for world, curves in shown["curves"].items():
        for name in ("Ours", "MV", "Scan", "Ours+"):
            of_world = [of[name].mean() for (home, *_), of in cells.items() if home == world]
            assert sorted(curves[name][:, -1]) == pytest.approx(sorted(of_world))


def test_a_second_report_is_the_same(folder, tmp_path):
    shutil.copytree(folder, tmp_path / "one", ignore=shutil.ignore_patterns("report"))
    for to in ("first", "second"):
        with pytest.raises(SystemExit):
            main(["report", "--out", str(tmp_path / "one"), "--to", str(tmp_path / to)])
    files = {path.name: path.read_bytes() for path in (tmp_path / "first").iterdir()}
    assert len(files) == 4
    assert files == {path.name: path.read_bytes() for path in (tmp_path / "second").iterdir()}


@pytest.mark.parametrize("damage", [b"", b"{}", b"[1, 2]", b'{"cell": 3', b'{"cell": {"world": 800}, "tests": {}}',
                                    b'{"checkpoints": [{"place": [1, 2]}], "tests": {}}', b"[" * 100_000],
                         ids=lambda damage: damage[:20].decode())
def test_a_damaged_cell_is_named(tmp_path, capsys, damage):
    path = tmp_path / "cells" / "800-1m-90deg-seed0.json"
    for file, data in ((path, damage), (tmp_path / "costs" / path.name, b"{}"), (tmp_path / "settings.json", b"{}")):
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(data)
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(tmp_path)])
    assert exit.value.code == 2
    err = capsys.readouterr().err
    assert err.startswith(f"python -m gnl: {path}: expected the outcomes of a cell")
    assert err.count("\n") == 1


@pytest.mark.parametrize("damage", [None, b"", b"{}", b"[1]"])
@pytest.mark.parametrize("name", ["settings.json", "costs/800-1m-90deg-seed0.json"])
def test_damaged_settings_and_costs_are_named(folder, tmp_path, capsys, name, damage):
    shutil.copytree(folder, tmp_path / "one", ignore=shutil.ignore_patterns("report"))
    path = tmp_path / "one" / name
    path.unlink() if damage is None else path.write_bytes(damage)
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(tmp_path / "one")])
    err = capsys.readouterr().err
    assert exit.value.code == 2
    assert f": {path}: " in err
    assert err.count("\n") == 1


@pytest.mark.parametrize("seconds", [-1.0, float("nan"), float("inf")])
def test_costs_that_cannot_be_are_named(folder, tmp_path, capsys, seconds):
    shutil.copytree(folder, tmp_path / "one", ignore=shutil.ignore_patterns("report"))
    path = tmp_path / "one" / "costs" / "800-1m-90deg-seed0.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"seconds": seconds}))
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(tmp_path / "one")])
    assert exit.value.code == 2
    assert f"{path}: expected the costs of a cell, found " in capsys.readouterr().err


def test_a_file_in_the_place_of_the_report_is_named(folder, tmp_path, capsys):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(folder), "--to", str(tmp_path / "file")])
    assert exit.value.code == 2
    assert capsys.readouterr().err == f"python -m gnl: --to: expected a folder, found the file {tmp_path / 'file'}\n"


@pytest.mark.parametrize("missing", ["cell", "validation", "tests", "checkpoints", "from training starts"])
def test_a_cell_that_lacks_a_part_is_named(folder, tmp_path, capsys, missing):
    shutil.copytree(folder, tmp_path / "one", ignore=shutil.ignore_patterns("report"))
    path = tmp_path / "one" / "cells" / "800-1m-90deg-seed0.json"
    result = json.loads(path.read_bytes())
    del result[missing]
    save_json(path, result)
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(tmp_path / "one")])
    err = capsys.readouterr().err
    assert exit.value.code == 2
    assert err.startswith(f"python -m gnl: {path}: expected the outcomes of a cell, found KeyError('{missing}')")
    assert err.count("\n") == 1


def test_a_cell_of_nine_checkpoints_is_named(folder, tmp_path, capsys):
    shutil.copytree(folder, tmp_path / "one", ignore=shutil.ignore_patterns("report"))
    path = tmp_path / "one" / "cells" / "800-1m-90deg-seed0.json"
    result = json.loads(path.read_bytes())
    result["checkpoints"].pop()
    save_json(path, result)
    with pytest.raises(SystemExit):
        main(["report", "--out", str(tmp_path / "one")])
    assert "found ValueError('9 checkpoints, 10 validated')" in capsys.readouterr().err


def test_cells_of_other_settings_are_not_mixed(folder, tmp_path, capsys):
    shutil.copytree(folder, tmp_path / "one", ignore=shutil.ignore_patterns("report"))
    path = tmp_path / "one" / "cells" / "800-1m-90deg-seed0.json"
    save_json(path, json.loads(path.read_bytes()) | {"settings": SETTINGS | {"episodes": 320}})
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(tmp_path / "one")])
    assert exit.value.code == 2
    err = capsys.readouterr().err
    assert f"{path}: expected results of episodes 10000, found some of 320; name another folder" in err
    assert err.count("\n") == 1


def test_cells_of_one_home_that_were_made_from_other_parts_are_not_mixed(folder, tmp_path, capsys):
    shutil.copytree(folder, tmp_path / "mixed")
    path = tmp_path / "mixed" / "cells" / "800-1m-90deg-seed0.json"
    save_json(path, json.loads(path.read_bytes()) | {"made from": {"net": "another"}})
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(tmp_path / "mixed")])
    assert exit.value.code == 2
    assert f"{path}: expected a cell made from None, as others of its home, found one made from " in (
        capsys.readouterr().err)


def with_a_planner(folder, to, cells):
    """A copy of the folder, "no return" tested in the cells that match, and always right."""
    shutil.copytree(folder, to, ignore=shutil.ignore_patterns("report"))
    for path in to.glob(f"cells/{cells}"):
        result = json.loads(path.read_bytes())
        result["tests"]["no return"] = {what: ["1" * N] * 5 for what in ("place", "location")}
        save_json(path, result)
    return to


def test_a_planner_of_ones_own_stands_beside_the_others(folder, cells, tmp_path):
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(with_a_planner(folder, tmp_path / "own", "*"))])
    assert exit.value.code == 0
    written = (tmp_path / "own" / "report" / "report.md").read_text()
    assert row(section(written, "Means"), "")[1:] == [*METHODS, "no return"]
    assert row(section(written, "Means"), "all")[-1] == "100.0"
    for other in ("MV", "Scan"):
        points = row(section(written, "Differences in pairs"), f"no return - {other}")[1].split()[0]
        assert float(points) == near(100 - 100 * np.mean([of[other].mean() for of in cells.values()]))


def test_cells_with_and_without_a_planner_are_not_mixed(folder, tmp_path, capsys):
    own = with_a_planner(folder, tmp_path / "own", "*90deg*")
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(own)])
    assert exit.value.code == 2
    err = capsys.readouterr().err
    assert re.search(r"800-0.2m-90deg-seed0.json: expected tests of .* as in 800-0.2m-10deg-seed0.json, found", err)
    assert err.count("\n") == 1
    assert not (own / "report").exists()


def test_where_there_is_no_cell_the_command_says_so(tmp_path, capsys):
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(tmp_path)])
    assert exit.value.code == 2
    assert f"{tmp_path / 'cells'}: expected cells of `python -m gnl table`, found none" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_interval_of_equal_cells():
    assert report.interval([0.05, 0.05]) == "+5.0 [+5.0, +5.0]"
