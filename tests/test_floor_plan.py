"""A floor plan is checked, each fault is one line that names its place; what is merely odd is left as it is."""

import copy
import json

import pytest

from gnl import floor_plan
from gnl.world import World

NAN, INF = float("nan"), float("inf")
GOOD = {
    "name": "hut", "units": "m", "wall_height": 2.4,
    "walls": [[0, 0, 5, 0], [5, 0, 5, 3], [5, 3, 0, 3], [0, 3, 0, 0]],
    "doors": [{"segment": [0, 1, 0, 2], "height": 2.0, "state": "closed"}],
    "rooms": [{"type": "bedroom", "polygon": [[0, 0], [5, 0], [5, 3]]}],
    "objects": [{"class": "bed", "polygon": [[1, 1], [2, 1], [2, 2]], "z0": 0.0, "height": 0.5, "color": [9, 9, 9]}],
    "colors": {"wall": [200, 200, 200]},
}
# Where the fault is, what stands there, what the message must say: place, expected.
FAULTS = [
    ([], [], "top level: expected an object"),
    ([], None, "top level: expected an object"),
    (["units"], "cm", 'units: expected "m"'),
    (["wall_height"], "high", "wall_height: expected a number"),
    (["wall_height"], NAN, "wall_height: expected a number"),
    (["wall_height"], -2.5, "wall_height: expected a number >= 1.35"),
    (["wall_height"], 1.3, "wall_height: expected a number >= 1.35, found 1.3"),
    (["wall_height"], None, "wall_height: expected a number"),
    (["walls"], ..., "walls: expected a list of at least one wall"),
    (["walls"], [], "walls: expected a list of at least one wall"),
    (["walls"], {"a": 1}, "walls: expected a list of at least one wall"),
    (["walls", 2], [5, 3, 0], "walls[2]: expected a list of 4 numbers"),
    (["walls", 2], "wall", "walls[2]: expected a list of 4 numbers"),
    (["walls", 2], [5, 3, 5, 3], "walls[2]: expected two different end points"),
    (["walls", 2, 1], "3", "walls[2]: expected a number"),
    (["walls", 2, 1], True, "walls[2]: expected a number"),
    (["walls", 2, 1], NAN, "walls[2]: expected a number"),
    (["walls", 2, 1], -INF, "walls[2]: expected a number"),
    (["walls", 2, 1], 10**400, "walls[2]: expected a number"),
    (["walls", 2, 1], 1000, "walls: expected a home of at most 200 m"),
    (["walls", 2, 2], -1e8, "walls: expected a home of at most 200 m"),
    (["doors"], {}, "doors: expected a list"),
    (["doors", 0], [0, 1, 0, 2], "doors[0]: expected an object"),
    (["doors", 0, "segment"], ..., "doors[0].segment: expected a list of 4 numbers"),
    (["doors", 0, "segment"], [0, 1, 0, 1], "doors[0].segment: expected two different end points"),
    (["doors", 0, "height"], -1, "doors[0].height: expected a number >= 0.1"),
    (["doors", 0, "state"], "ajar", 'doors[0].state: expected "open" or "closed"'),
    (["doors", 0, "color"], "red", "doors[0].color: expected a list of 3 numbers"),
    (["doors", 0, "state"], True, 'doors[0].state: expected "open" or "closed"'),
    (["rooms"], "bedroom", "rooms: expected a list"),
    (["rooms", 0], "bedroom", "rooms[0]: expected an object"),
    (["rooms", 0, "polygon"], [[0, 0], [5, 0]], "rooms[0].polygon: expected a polygon of 3 to 400 points"),
    (["rooms", 0, "polygon", 1, 1], 1e8, "rooms: expected a home of at most 200 m"),
    (["objects"], None, "objects: expected a list"),
    (["objects", 0], 3, "objects[0]: expected an object"),
    (["objects", 0, "polygon"], ..., "objects[0].polygon: expected a polygon of 3 to 400 points"),
    (["objects", 0, "polygon"], [[1, 1], [2, 1]], "objects[0].polygon: expected a polygon of 3 to 400 points"),
    (["objects", 0, "polygon"], [[1, 1], [2, 1]] * 201, "objects[0].polygon: expected a polygon of 3 to 400 points"),
    (["objects", 0, "polygon"], [[i, i % 2] for i in range(104)] + [[103, 9], [0, 9]],
     "objects[0].polygon: expected a polygon of at most 50 inner corners"),
    (["objects", 0, "polygon", 1], [1, 2, 3], "objects[0].polygon: expected a list of 2 numbers"),
    (["objects", 0, "polygon", 1, 0], None, "objects[0].polygon: expected a number"),
    (["objects", 0, "polygon", 1, 0], 1e300, "objects[0].polygon: expected a number"),
    (["objects", 0, "z0"], "floor", "objects[0].z0: expected a number"),
    (["objects", 0, "height"], ..., "objects[0].height: expected a number >= 0"),
    (["objects", 0, "height"], -0.5, "objects[0].height: expected a number >= 0"),
    (["objects", 0, "class"], ..., "objects[0].class: expected a word"),
    (["objects", 0, "class"], 3, "objects[0].class: expected a word"),
    (["objects", 0, "color"], [0, 0, 256], "objects[0].color: expected three numbers from 0 to 255"),
    (["objects", 0, "color"], [0, 0, -1], "objects[0].color: expected three numbers from 0 to 255"),
    (["objects", 0, "color"], "red", "objects[0].color: expected a list of 3 numbers"),
    (["colors"], [1, 2, 3], "colors: expected an object"),
    (["colors", "wall"], [1, 2], "colors.wall: expected a list of 3 numbers"),
    (["colors", "wall"], [1, 2, 999], "colors.wall: expected three numbers from 0 to 255"),
]


def with_value(plan, keys, value):
    """A copy of the plan in which `value` stands at `keys`; ... removes what is there."""
    if not keys:
        return value
    plan = copy.deepcopy(plan)
    *way, last = keys
    part = plan
    for key in way:
        part = part[key]
    if value is ...:
        del part[last]
    else:
        part[last] = value
    return plan


def written(path, plan):
    path.write_text(json.dumps(plan))
    return path


@pytest.mark.parametrize(("keys", "value", "message"), FAULTS, ids=[message for *_, message in FAULTS])
def test_a_fault_is_one_line_of_file_place_expected_and_found(tmp_path, keys, value, message):
    path = written(tmp_path / "home.json", with_value(GOOD, keys, value))
    with pytest.raises(ValueError) as refusal:
        floor_plan.load(path)
    line = str(refusal.value)
    assert line.startswith(f"{path}: {message}")
    assert ", found " in line
    assert "\n" not in line
    assert len(line) < len(str(path)) + 200


@pytest.mark.parametrize("content", [b"", b"walls: none", b'{"walls": [[0, 0, 1', b"\xff\xfe{}", b"[" * 100000],
                         ids=["empty", "text", "half", "not utf-8", "deep"])
def test_what_is_no_json_is_refused_by_name(tmp_path, content):
    path = tmp_path / "home.json"
    path.write_bytes(content)
    with pytest.raises(ValueError) as refusal:
        floor_plan.load(path)
    assert str(refusal.value).startswith(f"{path}: expected JSON, found something else")


def test_a_plan_is_nested_no_deeper_than_what_works_with_it_can_go(tmp_path):
    path = tmp_path / "home.json"
    for inner in (98, 99, 500):  # lists in the plan and in the list of notes
        notes = [json.loads("[" * inner + "]" * inner)]
        path.write_text(json.dumps({**GOOD, "notes": notes}))
        if inner == 98:
            assert floor_plan.load(path)["notes"] == notes
        else:
            with pytest.raises(ValueError) as refusal:
                floor_plan.load(path)
            assert str(refusal.value) == f"{path}: expected at most 100 lists or objects inside one another, found more"


def test_a_number_without_end_is_refused_by_name(tmp_path):
    path = tmp_path / "home.json"
    path.write_text('{"walls": [[0, 0, 1, ' + 5000 * "9" + "]]}")
    with pytest.raises(ValueError) as refusal:
        floor_plan.load(path)
    assert str(refusal.value).startswith(f"{path}: ")
    assert ": expected " in str(refusal.value)


def test_no_file_and_a_folder_are_refused_by_name(tmp_path):
    for path in (tmp_path / "nowhere.json", tmp_path):
        with pytest.raises(ValueError) as refusal:
            floor_plan.load(path)
        assert str(refusal.value).startswith(f"{path}: expected a floor plan, found no readable file")


def test_a_home_too_far_from_the_origin_for_particles_of_32_bits_is_refused():
    far = {**GOOD, "rooms": [], "objects": [], "walls": [[9_990, 0, 9_995, 0], [9_995, 0, 10_000, 5]]}
    assert floor_plan.check(far) == far
    words = r"walls: expected a home within 10000 m of the origin \(move it there\), found 10000\.5"
    with pytest.raises(ValueError, match=words):
        floor_plan.check({**far, "walls": [*far["walls"], [9_990, 0, 10_000.5, 0]]})


def test_an_object_farther_from_its_home_than_a_home_is_large_is_refused():
    """As one in millimetres is: what covers concave polygons knows metres."""
    corners = [[326.1, 970.2], [4268.1, 3218.7], [3978.4, 3666.5], [4883.1, 3213.7]]
    with pytest.raises(ValueError, match=r"objects: expected a home of at most 200 m, found 4883\.1"):
        floor_plan.check({**GOOD, "objects": [{"class": "bed", "height": 0.5, "polygon": corners}]})


def test_a_key_that_stands_twice_is_refused(tmp_path):
    path = tmp_path / "home.json"
    path.write_text('{"walls": [[0, 0, 4, 0]], "objects": [{"class": "bed", "class": "sofa"}]}')
    with pytest.raises(ValueError, match=f"{path}: .*the key 'class' twice in one object"):
        floor_plan.load(path)


def test_a_plan_that_never_was_a_file_is_checked_too():
    with pytest.raises(ValueError, match="floor plan: walls: expected"):
        World({"walls": []})


@pytest.mark.parametrize(("keys", "value"), [
    (["name"], ...), (["units"], ...), (["wall_height"], ...), (["doors"], ...), (["rooms"], ...), (["objects"], ...),
    (["colors"], ...), (["doors"], []), (["doors", 0, "state"], ...), (["doors", 0, "height"], ...),
    (["objects", 0, "z0"], ...), (["objects", 0, "color"], ...), (["objects", 0, "height"], 0),
    (["objects", 0, "z0"], -1), (["objects", 0, "class"], "piano"), (["wall_height"], 2), (["rooms", 0, "type"], ...),
    (["objects", 0, "polygon"], [[1, 1], [2, 1], [3, 1]]), (["objects", 0, "polygon"], [[1, 1], [1, 1], [1, 1]]),
    (["objects", 0, "polygon", 0], [50, 50]), (["walls", 0], (0, 0, 6, 0)), (["rooms", 0, "polygon", 0], (0, 0)),
])
def test_what_may_be_left_out_or_is_merely_odd_makes_a_home(keys, value):
    world = World(with_value(GOOD, keys, value))
    assert world.is_free([[3.5, 1.5]])


def test_unknown_keys_are_kept(tmp_path):
    plan = {**GOOD, "source": "by hand", "doors": [{**GOOD["doors"][0], "lock": [1, 2]}], "empty": []}
    floor_plan.save(plan, tmp_path / "home.json")
    assert floor_plan.load(tmp_path / "home.json") == plan


def test_a_saved_plan_has_one_thing_a_line(tmp_path):
    floor_plan.save(GOOD, tmp_path / "home.json")
    lines = (tmp_path / "home.json").read_text().splitlines()
    assert sum("[5, 0, 5, 3]" in line for line in lines) == 1
    assert len(lines) == len(GOOD) + len(GOOD["walls"] + GOOD["doors"] + GOOD["rooms"] + GOOD["objects"])
