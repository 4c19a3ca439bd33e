"""The full run: all cells are there, and what pages say of it is what the cells say."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from data_gen.rooms import make_home
from gnl.__main__ import main
from gnl.learned import digest
from gnl.table import GAPS, WORLDS

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "tutorials" / "results"
REPORT = (RESULTS / "report.md").read_text()


def row(text, first):
    """The other cells of the first table row whose first one is this."""
    table = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("|")]
    return next(cells[1:] for cells in table if cells[0] == first)


def test_of_the_effects_of_open_points_as_many_miss_zero_as_is_said():
    page = (RESULTS.parent / "open_points.md").read_text()
    table = "".join(line.rpartition(" | ")[2] for line in page.splitlines(keepends=True) if line.startswith("| "))
    bounds = np.array(re.findall(r"(?:MV|(?<!- )Ours) [+-][\d.]+ \[([+-][\d.]+), ([+-][\d.]+)\]", table), float)
    miss = (bounds[:, 0] > 0) | (bounds[:, 1] < 0)
    words = " ".join(page.split())
    assert f"of the {len(bounds)} intervals of MV and Ours" in words
    assert f"by chance; {miss.sum()} do." in words


def test_every_cell_of_the_paper_is_there_at_its_scale():
    cells = [json.loads(path.read_bytes()) for path in RESULTS.glob("cells/*.json")]
    found = {(of["cell"]["world"], f"{of['cell']['t_xy_m']}/{of['cell']['t_theta_deg']}") for of in cells}
    assert found == {(world, gap) for world in WORLDS for gap in GAPS}
    assert len(cells) == 75
    for of in cells:
        assert (of["settings"]["episodes"], of["settings"]["tests"], len(of["checkpoints"])) == (10_000, 100, 10)
        assert {len(look) for outcome in of["tests"].values() for look in outcome["place"]} == {100}


@pytest.mark.parametrize("folder", [RESULTS, RESULTS / "seed1"], ids=lambda folder: folder.name)
def test_the_cells_are_of_the_homes_that_are_drawn_today(folder):
    homes = {world: digest(make_home(world).plan) for world in WORLDS}
    cells = [json.loads(path.read_bytes()) for path in folder.glob("cells/*.json")]
    assert len(cells) == 75
    assert {(of["cell"]["world"], of["made from"]["home"]) for of in cells} == set(homes.items())


def test_the_report_is_what_the_cells_say(tmp_path):
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(RESULTS), "--to", str(tmp_path)])
    assert exit.value.code == 0
    assert (tmp_path / "report.md").read_text() == REPORT
    assert "say nothing" not in REPORT
    for path in tmp_path.glob("*.png"):
        drawn, kept = (np.array(Image.open(folder / path.name).convert("RGB")).astype(int)
                       for folder in (tmp_path, RESULTS))
        assert (abs(drawn - kept).max(2) > 64).mean() < 0.002  # one curve is more


def test_the_readme_says_what_the_report_says():
    readme = (ROOT / "README.md").read_text().partition("## Table I, run again")[2].partition("\n## ")[0]
    means = dict(zip(row(REPORT, ""), row(REPORT, "all"), strict=True))
    assert row(readme, "75 cells") == [means[name] for name in row(readme, "")]
    said = [line for line in readme.splitlines() if re.match(r"\| \S+ - \S+ \|", line)]
    assert len(said) > 3
    papers = REPORT.partition("## The paper's own cells")[2]
    for name, *numbers in ([cell.strip() for cell in line.split("|")[1:-1]] for line in said):
        assert numbers[0] == row(REPORT, name)[0]
        assert numbers[1] == (row(papers, name)[0] if f"| {name} |" in papers.partition("\n## ")[0] else "")


def test_what_is_said_of_seed_1_is_what_its_cells_say(tmp_path):
    with pytest.raises(SystemExit) as exit:
        main(["report", "--out", str(RESULTS / "seed1"), "--to", str(tmp_path)])
    assert exit.value.code == 0
    report, told = (tmp_path / "report.md").read_text(), (RESULTS / "README.md").read_text()
    assert len(list((RESULTS / "seed1" / "cells").glob("*-seed1.json"))) == 75
    for name in ("MV - SV", "Ours - MV", "DA - Ours", "Scan - MV", "Ours - Scan", "Ours+ - MV", "Ours+ - Scan"):
        assert row(told, name)[:2] == [row(REPORT, name)[0], row(report, name)[0]]
    for part, at in ((REPORT, 0), (report, 1)):
        homes = row(part, "Ours - MV")[2:]
        assert [row(told, f"Ours - MV, home {world}")[at] for world in (800, 801, 809)] == homes
        assert row(told, "Ours - MV, location alone")[at] == row(part.partition("## The location alone")[2],
                                                                 "Ours - MV")[1]


def test_what_pages_say_of_starts_of_training_is_in_the_report():
    part = REPORT.partition("## What Ours knows by heart")[2].partition("\n## ")[0]
    mean, interval = row(part, "all")[1].split(" ", 1)
    for page in ("README.md", "tutorials/10_active_localization.md"):
        assert re.search(rf"{re.escape(mean)}\s+{re.escape(interval)}", (ROOT / page).read_text())
    told = (RESULTS / "README.md").read_text().partition("**Ours does better where it learned.**")[2]
    told = told.partition("\n\nThe wider")[0]
    for name in ("all", "T_xy 0.2 m", "T_xy 0.6 m", "T_xy 1.0 m"):
        tests, known, _, known_of_scan = row(part, name)
        assert row(told, name) == [tests, known, known_of_scan]
