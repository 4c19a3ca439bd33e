"""The house itself: what lies where, what imports what, how long a file is, and that words and code agree."""

import ast
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import pytest

from data_gen.views import MODULES as MODULES_OF_VIEWS
from gnl import camera
from gnl.classes import N_CLASSES
from gnl.episode import LENGTH
from gnl.experiment import N_CHECKPOINTS
from gnl.learned import STAGES
from gnl.nnql import ALPHA, GAMMA, K_NEIGHBOURS
from gnl.particles import N_PARTICLES, N_START_PLACES
from gnl.places import CELL_M, N_BEARINGS
from gnl.scene_graph import FARTHEST_EDGE_PX, N_WORDS, SIZE_UNIT, SMALLEST_REGION_PX
from gnl.table import Settings

ROOT = Path(__file__).parents[1]
MODULES = {f"{path.parent.name}.{path.stem}": path for path in ROOT.glob("*/*.py")
           if path.parent.name in ("gnl", "data_gen")}
GNL = {name for name in MODULES if name.startswith("gnl.")}
TOP = {"setup.cfg", "pyproject.toml", "Makefile", "README.md", "LICENSE", "gnl", "data_gen", "tutorials", "tests",
       ".ci", ".gitignore"}
MAY_DRAW = {f"gnl.{name}" for name in ("demo", "replay", "draw", "draw_graph", "draw_charts", "floor_map", "report",
                                       "__main__")}
LONGEST = 250
OPEN_POINTS = ROOT / "tutorials" / "open_points.md"
PAGES = [ROOT / "README.md", *sorted((ROOT / "tutorials").rglob("*.md"))]
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")


def test_defaults_are_the_papers_numbers():
    assert (camera.SIZE_PX, N_CLASSES, N_WORDS, N_BEARINGS, CELL_M) == (512, 10, 270, 12, 2.0)
    assert (SMALLEST_REGION_PX, FARTHEST_EDGE_PX, SIZE_UNIT) == (5000, 20, 16)
    assert (N_PARTICLES, N_START_PLACES, LENGTH) == (5000, 3, 4)
    assert (K_NEIGHBOURS, ALPHA, GAMMA, N_CHECKPOINTS) == (4, 0.1, 0.9, 10)
    s = Settings()
    assert (s.episodes, s.tests, s.validation) == (10_000, 100, 10)
    assert (s.gcn_views, s.gcn_epochs, s.gcn_batch, s.gcn_rate) == (10_000, 100, 32, 0.001)


def imports(name):
    """Modules of gnl and data_gen that a module imports, inside of functions too."""
    package, found = name.partition(".")[0], set()
    for node in ast.walk(ast.parse(MODULES[name].read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = ".".join(filter(None, [package if node.level else "", node.module]))
            found |= {base} | {f"{base}.{alias.name}" for alias in node.names}
    return found & MODULES.keys() | {f"{p}.__init__" for p in ("gnl", "data_gen") if p in found and p != package}


def test_the_modules_are_found():
    assert {"gnl.strip", "gnl.demo", "data_gen.rooms"} <= MODULES.keys()
    assert {"gnl.strip", "gnl.photo", "gnl.classes"} <= imports("gnl.camera")
    assert {"gnl.world", "data_gen.layout"} <= imports("data_gen.rooms")


@pytest.mark.parametrize("name", sorted(MODULES))
def test_no_module_is_longer_than_250_lines(name):
    assert len(MODULES[name].read_text().splitlines()) <= LONGEST


@pytest.mark.parametrize("word", ["TODO", "FIXME", "NotImplementedError"])
def test_nothing_is_left_to_be_done(word):
    assert [name for name, path in MODULES.items() if word in path.read_text()] == []


def test_the_algorithm_does_not_know_where_homes_come_from():
    assert [name for name in GNL if any(other.startswith("data_gen") for other in imports(name))] == []


def test_imports_point_one_way():
    below = {name: imports(name) - {name} for name in MODULES}
    while free := [name for name, others in below.items() if not others & below.keys()]:
        for name in free:
            del below[name]
    assert below == {}, "these import one another in a circle"


@pytest.mark.parametrize(("name", "listed"), [("gnl.learned", STAGES), ("data_gen.views", MODULES_OF_VIEWS)])
def test_all_that_decides_what_is_learned_is_in_the_digest_of_its_code(name, listed):
    package, found, new = name.partition(".")[0], set(), {name}
    while new:
        found |= new
        new = {other for one in new for other in imports(one) if other.startswith(f"{package}.")} - found
    assert {f"{package}.{stage}" for stage in listed} == found - {"gnl.files", "gnl.__init__"}


def test_pictures_never_leak_into_the_algorithm():
    drawing = {name for name in GNL if imports(name) & {"gnl.canvas", "gnl.draw", "gnl.floor_map"}}
    assert drawing - MAY_DRAW == set()


def test_nothing_but_the_four_dependencies_is_imported():
    allowed = {"numpy", "scipy", "PIL", "pymunk", "gnl", "data_gen"}
    outside = defaultdict(set)
    for name, path in MODULES.items():
        for node in ast.walk(ast.parse(path.read_text())):
            named = [alias.name for alias in node.names] if isinstance(node, ast.Import) else (
                [node.module] if isinstance(node, ast.ImportFrom) and not node.level else [])
            outside[name] |= {full.partition(".")[0] for full in named}
    outside["gnl.terminal"] -= {"dask"}  # for who asks for a cluster, the extra of that name
    strange = {name: found - allowed - sys.stdlib_module_names for name, found in outside.items()}
    assert {name: found for name, found in strange.items() if found} == {}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_points_to_something_that_is_there(page):
    links = [link.partition("#")[0] for link in LINK.findall(page.read_text()) if "://" not in link]
    assert [link for link in links if not (page.parent / link).exists()] == []


def choices(path):
    """The texts after CHOICE and DIFFERS in the comments of a file, each to the end of its block of comments."""
    found, going_on = [], False
    for line in path.read_text().splitlines():
        if mark := re.search(r"# (?:CHOICE|DIFFERS): (.*)", line):
            found.append(mark[1].strip())
            going_on = True
        elif going_on and (more := re.fullmatch(r"\s*# ?(.*)", line)):
            found[-1] += " " + more[1].strip()
        else:
            going_on = False
    return found


def test_a_choice_goes_on_to_the_end_of_its_comment(tmp_path):
    lines = "a = 1  # CHOICE: one", "# CHOICE: two", "# and a half", "b = 2  # DIFFERS: three", "", "# none"
    (tmp_path / "a.py").write_text("\n".join(lines))
    assert choices(tmp_path / "a.py") == ["one", "two and a half", "three"]


def listed():
    """(file, text) of each row of the first table of open points."""
    table = OPEN_POINTS.read_text().partition("\n| ")[2].partition("\n\n")[0]
    rows = [[cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
            for line in f"| {table}".splitlines()]
    head = next(i for i, row in enumerate(rows) if {"choice", "where"} <= set(row))
    choice, where = rows[head].index("choice"), rows[head].index("where")
    return {(str((OPEN_POINTS.parent / link).resolve().relative_to(ROOT.resolve())), row[choice])
            for row in rows[head + 2:] for link in LINK.findall(row[where])}


def test_every_choice_of_the_code_is_in_the_list_of_open_points_and_the_other_way_round():
    code = {(str(path.relative_to(ROOT)), text) for path in MODULES.values() for text in choices(path)}
    page = listed()
    assert len(code) > 5
    lacking = [f"in the code, not on the page: {file}: {text}" for file, text in sorted(code - page)]
    lacking += [f"on the page, not in the code: {file}: {text}" for file, text in sorted(page - code)]
    assert not lacking, "\n".join(["", *lacking])


def test_what_runs_leave_behind_is_ignored():
    assert {".venv/", "out/", "__pycache__/"} <= set((ROOT / ".gitignore").read_text().split())


def tracked():
    """Files under version control; in a bare copy of the folder all that a run does not leave behind."""
    try:
        listing = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True).stdout.split("\n")
    except FileNotFoundError:
        listing = []
    left_behind = {".git", *(line.strip("/") for line in (ROOT / ".gitignore").read_text().split())}
    return [name for name in listing if name] or [
        path.name for path in ROOT.iterdir() if not any(path.match(pattern) for pattern in left_behind)]


def test_the_top_of_the_house_holds_what_it_should():
    assert {name.partition("/")[0] for name in tracked()} == TOP
