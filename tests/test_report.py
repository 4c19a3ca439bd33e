"""The report: its numbers are those of the cells' files, by hand; its pictures show them; what is no cell is named."""

import json
import re

import numpy as np
import pytest
from PIL import Image

from gnl import draw_charts, report
from gnl.__main__ import main
from gnl.experiment import GAPS_DEG, GAPS_M, to_bytes
from gnl.paper import table_1

N = 100


def outcome(rng, share):
    """Five looks of N episodes, of which a share is right after the last."""
    looks = rng.random((5, N)) < share
    return {"place": ["".join("01"[int(x)] for x in look) for look in looks], "location": ["1" * N] * 5}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Twelve cells of known shares of right answers."""
    out, rng = tmp_path_factory.mktemp("report"), np.random.default_rng(0)
    for world in (800, 801):
        for m in (0.2, 0.6, 1.0):
            for deg in (10, 90):
                first = outcome(rng, 0.3)
                tests = {"MV": outcome(rng, 0.4), "Scan": outcome(rng, 0.5)}
                tests["MV"]["place"][0] = first["place"][0]
                result = {"cell": {"world": world, "t_xy_m": m, "t_theta_deg": deg, "seed": 0}, "sequence": [0] * 4,
                          "tests": tests, "checkpoints": [outcome(rng, 0.36 + 0.01 * i) for i in range(10)],
                          "validation": [outcome(rng, 0.4) for _ in range(10)]}
                costs = {"seconds": 10.0, "views": 1000, "of stages": {"labels": 5.0, "graph": 1.0, "plan": 0.5},
                         "machine": "two cores", "peak MB": 123.0, "versions": {"numpy": "2.0"}}
                for kind, value in (("cells", result), ("costs", costs)):
                    path = out / kind / f"{world}-{m:g}m-{deg}deg-seed0.json"
                    path.parent.mkdir(exist_ok=True)
                    path.write_bytes(to_bytes(value))
    (out / "settings.json").write_bytes(to_bytes({"episodes": 10_000, "tests": N}))
    return out


@pytest.fixture(scope="module")
def written(folder):
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(folder)])
    assert exit.value.code == 0
    return (folder / "report" / "report.md").read_text()


def last(folder, name, method):
    result = json.loads((folder / "cells" / f"{name}.json").read_bytes())
    of = result["checkpoints"][-1] if method == "Ours" else result["tests"][method]
    return np.array([c == "1" for c in of["place"][-1]])


def row(written, start):
    """Cells of the first row of a table that begins so."""
    line = next(line for line in written.splitlines() if line.startswith(f"| {start} |"))
    return [cell.strip() for cell in line.split("|")[1:-1]]


def test_the_means_are_those_of_the_files_and_the_papers_stand_beside_them(folder, written):
    names = [path.stem for path in (folder / "cells").glob("*.json")]
    ours, theirs = row(written, "all")[4].split()
    assert float(ours) == pytest.approx(100 * np.mean([last(folder, name, "Ours") for name in names]), abs=0.051)
    cells = [table_1()[w, m, d]["Ours"] for w in (800, 801) for m in (0.2, 0.6, 1.0) for d in (10, 90)]
    assert theirs == f"({np.mean(cells):.1f})"


def test_a_difference_is_that_of_the_pairs_with_its_interval_and_p(folder, written):
    names = sorted(path.stem for path in (folder / "cells").glob("*.json"))
    d = np.concatenate([last(folder, name, "Scan").astype(int) - last(folder, name, "MV") for name in names])
    _, points, interval, p, *worlds = row(written, "Scan - MV")
    low, high = map(float, re.findall(r"[+-][\d.]+", interval))
    assert float(points) == pytest.approx(100 * d.mean(), abs=0.051)
    assert low < float(points) < high
    assert float(p) < 0.05
    assert len(worlds) == 2


def test_the_papers_own_differences_are_told(written):
    part = written.split("## The paper's own cells")[1].split("##")[0]
    assert [row(part, name)[1] for name in ("MV - SV", "Ours - MV", "DA - Ours")] == ["+9.5", "+2.6", "-0.2"]


def test_every_cell_stands_in_the_table_in_the_papers_order(folder, written):
    rows = [line for line in written.split("## Table I\n")[1].splitlines() if re.match(r"\| [\d.]+ \| \d+ \|", line)]
    gaps = [tuple(float(cell) for cell in line.split("|")[1:3]) for line in rows]
    assert gaps == sorted(gaps, reverse=True)
    assert len(gaps) == 6
    first = rows[0].split("|")
    assert float(first[4].split()[0]) == pytest.approx(100 * last(folder, "800-1m-90deg-seed0", "MV").mean(), abs=0.051)
    assert first[4].split()[1] == "(52)"


def test_costs_are_those_of_all_views(written):
    assert row(written, "labels and graph") == ["labels and graph", "6.00", "18"]
    assert row(written, "all")[1:3] != row(written, "plan")[1:3]
    assert "at most 123 MB a process" in written


def test_the_pictures_are_there_and_the_text_names_them(folder, written):
    for name in re.findall(r"\]\((\w+\.png)\)", written):
        with Image.open(folder / "report" / name) as picture:
            assert min(picture.size) > 100
    assert len(re.findall(r"\]\((\w+\.png)\)", written)) == 3


def test_a_second_report_is_the_same(folder, written):
    before = {path.name: path.read_bytes() for path in (folder / "report").iterdir()}
    with pytest.raises(SystemExit):
        main(["report", "--out", str(folder)])
    assert before == {path.name: path.read_bytes() for path in (folder / "report").iterdir()}


@pytest.mark.parametrize("damage", [b"", b"{}", b"[1, 2]", b'{"cell": 3'])
def test_a_damaged_cell_is_named(folder, tmp_path, capsys, damage):
    for kind in ("cells", "costs"):
        (tmp_path / kind).mkdir()
    (tmp_path / "settings.json").write_bytes(b"{}")
    path = tmp_path / "cells" / "800-1m-90deg-seed0.json"
    path.write_bytes(damage)
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(tmp_path)])
    assert exit.value.code == 2
    err = capsys.readouterr().err
    assert err.startswith(f"python -m gnl: {path}: expected the outcomes of a cell")
    assert err.count("\n") == 1


def test_where_there_is_no_cell_the_command_says_so(tmp_path, capsys):
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(tmp_path)])
    assert exit.value.code == 2
    assert "expected cells of `python -m gnl table`, found none" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_shade_tells_better_from_worse_and_none_is_white():
    assert draw_charts.shade(0) == (255, 255, 255)
    better, worse = draw_charts.shade(10), draw_charts.shade(-10)
    assert better[2] > better[0]
    assert worse[0] > worse[2]
    assert draw_charts.shade(15) == draw_charts.shade(40)


def test_a_heat_map_has_a_field_for_each_gap_and_grey_where_nothing_is_known():
    points = {(m, deg): 12.0 for m in GAPS_M for deg in GAPS_DEG}
    full = np.array(draw_charts.heat_maps({800: points}, GAPS_M, GAPS_DEG))
    del points[0.6, 50]
    less = np.array(draw_charts.heat_maps({800: points}, GAPS_M, GAPS_DEG))
    blue = (full == draw_charts.shade(12.0)).all(2).sum()
    assert (less == draw_charts.shade(12.0)).all(2).sum() / blue == pytest.approx(24 / 25, abs=0.01)


def test_interval_of_equal_cells():
    assert report.interval([0.05, 0.05]) == ("+5.0", "[+5.0, +5.0]")
