"""Homes for the tests: one drawn by hand, one by a seed, one strewn at random, and the real ones.

And what `make` would begin, a process that heeds Ctrl-C, and a disk that is full.
"""

import ast
import copy
import functools
import os
import signal
import subprocess
from pathlib import Path

import numpy as np
import pytest

import data_gen
from data_gen.rooms import make_home
from gnl.world import World

FLAT = Path(data_gen.__file__).parent / "homes" / "flat.json"
FOUND = sorted((Path(__file__).parents[2] / "shared" / "homes").glob("*.json"))
LONGEST = "test_tutorials", "test_table", "test_demo", "test_camera", "test_rooms", "test_pipeline", "test_draw"
drawn, loaded = functools.cache(make_home), functools.cache(World.load)  # many files ask for the same homes


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items):
    """The files that take longest first, so that no worker is left alone with one at the end."""
    items.sort(key=lambda item: LONGEST.index(item.path.stem) if item.path.stem in LONGEST else len(LONGEST))


def thing(kind, x, y, length, width, height, z0=0.0, angle=0.0):
    """An object of a floor plan: a rectangle around (x, y), its length turned by `angle`."""
    u, v = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * [length / 2, width / 2]
    polygon = ((x, y) + corners @ [u, v]).tolist()
    return {"class": kind, "polygon": polygon, "z0": z0, "height": height}


def room(*things, size=(6.0, 4.0), **others):
    """One room without doors, its lower left corner in the origin, and what is in it."""
    x, y = size
    walls = [[0, 0, x, 0], [x, 0, x, y], [x, y, 0, y], [0, y, 0, 0]]
    return {"name": "room", "walls": walls, "objects": list(things), **others}


TWO_ROOMS = {
    "name": "two rooms", "units": "m", "wall_height": 2.5,
    "walls": [[0, 0, 7, 0], [7, 0, 7, 4], [7, 4, 0, 4], [0, 4, 0, 2.4], [0, 1.5, 0, 0],
              [4, 0, 4, 1.0], [4, 1.9, 4, 4]],
    "doors": [{"segment": [0, 1.5, 0, 2.4], "height": 2.0, "state": "closed"},
              {"segment": [4, 1.9, 4, 1.0], "height": 2.0, "state": "open"}],
    "rooms": [{"type": "bedroom", "polygon": [[0, 0], [4, 0], [4, 4], [0, 4]]},
              {"type": "kitchen", "polygon": [[4, 0], [7, 0], [7, 4], [4, 4]]}],
    "objects": [thing("bed", 1.1, 0.7, 1.9, 1.0, 0.5), thing("table", 1.2, 3.1, 1.2, 0.7, 0.74, angle=0.5),
                thing("tv", 1.2, 3.1, 0.7, 0.1, 0.5, z0=0.74, angle=0.5),
                thing("sofa", 5.7, 3.2, 1.6, 0.8, 0.8, angle=-0.3), thing("refrigerator", 6.6, 0.4, 0.6, 0.6, 1.8),
                thing("other", 2.6, 2.0, 0.5, 0.5, 0.4, z0=1.6, angle=0.2), thing("other", 5.6, 1.0, 1.4, 1.0, 0.02)],
}


@pytest.fixture
def two_rooms_plan():
    """7 x 4 m: a shut front door in the west, an open door between; things turned, carried, hanging and flat."""
    return copy.deepcopy(TWO_ROOMS)


@pytest.fixture(scope="session")
def two_rooms():
    return World(copy.deepcopy(TWO_ROOMS))


@pytest.fixture(scope="session", params=[1, 5])
def home(request):
    """A procedural home."""
    return drawn(request.param)


def strewn_plan(seed):
    """An 8 x 5 m room strewn with boxes that do not touch: turned at random, some carried by others, some hanging."""
    rng = np.random.default_rng(seed)
    things = []
    for x in range(8):
        for y in range(5):
            kind, angle = rng.choice(["bed", "table", "sofa", "refrigerator", "tv", "other"]), rng.uniform(0, np.pi)
            length, width, height = rng.uniform(0.1, 0.55, 2).tolist() + [rng.uniform(0.1, 2.0)]
            place = x + rng.uniform(0.45, 0.55), y + rng.uniform(0.45, 0.55)
            if rng.random() < 0.5:
                things.append(thing(str(kind), *place, length, width, height, 0.0, angle))
            if rng.random() < 0.4:
                part, rise = rng.uniform(0.3, 0.9), rng.choice([0.0, 0.1])
                height_above = rng.uniform(0.05, 2.4 - height - rise)
                things.append(thing("tv", *place, part * length, part * width, height_above, height + rise, angle))
    return room(*things, size=(8.0, 5.0), name="strewn")


@pytest.fixture(scope="session", params=[0, 1, 2])
def strewn(request):
    return World(strewn_plan(request.param))


@pytest.fixture(scope="session", params=[FLAT, *FOUND], ids=lambda path: path.stem)
def real_home_path(request):
    """The flat that comes with gnl, and the homes beside the project, if they are there."""
    return request.param


def full_disk(handle, mode):
    """Instead of os.fdopen: a file on a full disk."""
    os.close(handle)
    return open("/dev/full", mode)


def begun_by_make(*words):
    """The arguments of each program that `make` with these words would start."""
    instead = "RUN=python3 -c 'import sys; print(sys.argv[1:])'"
    made = subprocess.run(["make", "--no-print-directory", "-o", ".venv/ready", instead, *words], capture_output=True,
                          text=True, check=True, cwd=Path(data_gen.__file__).parents[1])
    return [ast.literal_eval(line) for line in made.stdout.splitlines()]


def heed_ctrl_c():
    """For a new process: who starts the tests in the background of a script lets them ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def real_home(real_home_path):
    return loaded(real_home_path)
