"""Laws of the procedural homes and of the flat that is drawn by hand."""

import functools
import json
import subprocess
import sys
from collections import Counter, defaultdict
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from scipy import ndimage

import data_gen
from data_gen import rooms as rooms_module
from data_gen.__main__ import main
from data_gen.box import Box, distance, inside, outline
from data_gen.furnish import ALONE, AT_WALL, furnish, in_one_part
from data_gen.furniture import ROOMS
from data_gen.layout import draw_gaps, good_shape, turn
from data_gen.rooms import home_plan, make_home
from gnl.classes import CLASSES
from gnl.world import World

FLAT = Path(data_gen.__file__).parent / "homes" / "flat.json"
CELL_M, ROBOT_M, ROBOT_HEIGHT_M = 0.05, 0.2, 1.35


@pytest.fixture(scope="module")
def homes():
    return [home_plan(seed) for seed in range(50)]


@pytest.fixture(scope="module")
def floors(homes):
    return [regions(plan) for plan in homes]


@pytest.fixture(scope="module")
def flat():
    return json.loads(FLAT.read_text())


def board(x0, y0, x1, y1, thickness):
    """Corners of a board that stands along a segment."""
    a, b = np.array([x0, y0]), np.array([x1, y1])
    u, v = (b - a) / np.hypot(*(b - a))
    aside = np.array([-v, u]) * thickness / 2
    return np.array([a - aside, b - aside, b + aside, a + aside])


def leaf(door, opened_rad=np.pi / 2):
    """Corners of a door's leaf, hinged at the first end of its segment and turned to its left."""
    x0, y0, x1, y1 = door["segment"]
    c, s = np.cos(opened_rad), np.sin(opened_rad)
    return board(x0, y0, x0 + c * (x1 - x0) - s * (y1 - y0), y0 + s * (x1 - x0) + c * (y1 - y0), 0.04)


def covers(polygon, x, y):
    """Which of the points (x, y) lie within a polygon, by the even-odd rule."""
    inside = np.zeros(np.shape(x), bool)
    for (x0, y0), (x1, y1) in zip(polygon, np.roll(polygon, -1, 0), strict=True):
        if y0 != y1:
            inside ^= ((y0 > y) != (y1 > y)) & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return inside


def grid(low, high, cell):
    return np.meshgrid(*(np.arange(a + cell / 2, b, cell) for a, b in zip(low, high, strict=True)))


def overlaps(polygons, others=None):
    """Pairs (i, j) of polygons that overlap, seen on a grid of 1 cm over what their bounds have in common.

    Without others, of the polygons among themselves: i < j.
    """
    among, others = others is None, polygons if others is None else others
    low = np.maximum(np.array([np.min(p, 0) for p in polygons])[:, None], [np.min(p, 0) for p in others])
    high = np.minimum(np.array([np.max(p, 0) for p in polygons])[:, None], [np.max(p, 0) for p in others])
    near = (high - low > 0.002).all(-1)
    for i, j in np.argwhere(np.triu(near, 1) if among else near):
        x, y = grid(low[i, j], high[i, j], min(0.01, (high[i, j] - low[i, j]).min() / 3))
        if (covers(polygons[i], x, y) & covers(others[j], x, y)).sum() > 2:
            yield int(i), int(j)


def top(thing):
    return thing["z0"] + thing["height"]


def regions(plan):
    """Parts of the floor in which a robot can roam, numbered from 1, on a raster; the raster's x and y."""
    ends = np.array(plan["walls"]).reshape(-1, 2)
    x, y = grid(ends.min(0), ends.max(0), CELL_M)
    obstacles = [board(*wall, 0.1) for wall in plan["walls"]]
    obstacles += [leaf(door, np.pi / 2 * (door["state"] == "open")) for door in plan["doors"]]
    obstacles += [thing["polygon"] for thing in plan["objects"]
                  if thing["z0"] < ROBOT_HEIGHT_M and top(thing) > 0.05]
    free = np.ones(x.shape, bool)
    for polygon in obstacles:
        (x0, y0), (x1, y1) = np.min(polygon, 0), np.max(polygon, 0)
        near = np.ix_((y[:, 0] >= y0) & (y[:, 0] <= y1), (x[0] >= x0) & (x[0] <= x1))  # else there is nothing to cover
        free[near] &= ~covers(polygon, x[near], y[near])
    clearance = ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1] * CELL_M
    return ndimage.label(clearance > ROBOT_M)[0], x, y


def cut_off(plan, floor):
    """Types of the rooms that the robot cannot reach from the largest part of the floor."""
    region, x, y = floor
    home = region == np.bincount(region[region > 0]).argmax()
    return [room["type"] for room in plan["rooms"] if not home[covers(room["polygon"], x, y)].sum() > 50]


def collisions(plan):
    """Names of two things that share space."""
    things = plan["objects"]
    polygons = [thing["polygon"] for thing in things]
    pairs = ((things[i], things[j]) for i, j in overlaps(polygons))
    return [(a["name"], b["name"]) for a, b in pairs if min(top(a), top(b)) > max(a["z0"], b["z0"]) + 1e-3]


def things_in_the_way(plan):
    """Names of what stands in a wall, in an open door's leaf or where it swings."""
    polygons = [thing["polygon"] for thing in plan["objects"]]
    in_walls = overlaps(polygons, [board(*wall, 0.1) for wall in plan["walls"]])
    doors = [door for door in plan["doors"] if door["state"] == "open"]
    swings = [leaf(door, angle) for door in doors for angle in np.linspace(0, np.pi / 2, 7)]
    in_swings = (i for i, _ in overlaps(polygons, swings) if plan["objects"][i]["z0"] < 2.0)
    return [plan["objects"][i]["name"] for i in {*(i for i, _ in in_walls), *in_swings}]


def looks_by_room(plan):
    """(type, {name: [sizes of its pieces]}) of each room."""
    for room in plan["rooms"]:
        looks = defaultdict(list)
        for thing in plan["objects"]:
            if covers(room["polygon"], *np.mean(thing["polygon"], 0)):
                sides = np.hypot(*np.diff(thing["polygon"][:3], axis=0).T)
                looks[thing["name"]].append((*sides, thing["height"]))
        yield room["type"], looks


def share_alike(aliasing, seeds=range(8)):
    """Share of the bedrooms' pairs whose beds are the same."""
    same = []
    for seed in seeds:
        bedrooms = [looks for kind, looks in looks_by_room(home_plan(seed, aliasing)) if kind == "bedroom"]
        same += [np.allclose(a["bed"], b["bed"], atol=2e-3) for a, b in combinations(bedrooms, 2)]
    return np.mean(same)


def test_homes_are_of_the_promised_size(homes):
    for plan in homes:
        ends = np.array(plan["walls"]).reshape(-1, 2)
        sides = np.ptp(ends, axis=0)
        assert 80 <= sides.prod() <= 130 and (sides >= 8.4).all() and (sides <= 13.1).all()
        kinds = [room["type"] for room in plan["rooms"]]
        assert 6 <= len(kinds) <= 9 and kinds.count("bedroom") >= 2
        assert {"living room", "kitchen", "bathroom", "corridor"} <= set(kinds)
        extents = np.array([np.ptp(room["polygon"], axis=0) for room in plan["rooms"]])
        assert np.isclose(extents.prod(1).sum(), sides.prod())  # rooms tile the home
        for kind, extent in zip(kinds, extents, strict=True):
            assert extent.min() >= 1.2
            assert extent.prod() >= {"bathroom": 4, "corridor": 0}.get(kind, 8)
        assert 30 <= len(plan["objects"]) <= 80
    assert {len(plan["rooms"]) for plan in homes} == {6, 7, 8, 9}


def test_robot_reaches_every_room(homes, floors):
    assert [cut_off(plan, floor) for plan, floor in zip(homes, floors, strict=True)] == [[]] * len(homes)


def test_hardly_any_floor_is_cut_off(floors):
    for region, _, _ in floors:
        sizes = np.bincount(region.ravel())[1:]
        assert sizes.max() > 0.98 * sizes.sum()


def test_no_two_things_share_space(homes):
    assert [pair for plan in homes for pair in collisions(plan)] == []


def test_nothing_stands_in_walls_or_where_doors_swing(homes):
    assert [name for plan in homes for name in things_in_the_way(plan)] == []


def test_all_ten_classes_are_in_every_home(homes):
    for plan in homes:
        words = {thing["class"] for thing in plan["objects"]}
        assert words | {"wall", "floor", "ceiling", "door"} == set(CLASSES) and plan["doors"]


def test_one_seed_is_one_home_in_a_fresh_process_too(homes):
    code = "import json; from data_gen.rooms import home_plan; print(json.dumps(home_plan(7)))"
    fresh = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True,
                           cwd=Path(data_gen.__file__).parents[1]).stdout
    assert json.loads(fresh) == homes[7]  # and so nothing in it is more than plain JSON
    assert len({json.dumps(plan["walls"]) for plan in homes}) == len(homes)


def test_aliasing_makes_rooms_of_a_type_alike():
    assert share_alike(0.0) == 0
    assert 0 < share_alike(0.6) < 1
    assert share_alike(1.0) == 1


@pytest.mark.parametrize("aliasing", [-0.1, 1.1, float("nan"), "much", None])
def test_bad_aliasing_is_refused(aliasing):
    with pytest.raises(ValueError, match="aliasing: expected .* found"):
        home_plan(0, aliasing)


@pytest.mark.parametrize("seed", [-1, 0.5, "one", None])
def test_bad_seed_is_refused(seed):
    with pytest.raises(ValueError, match="seed: expected .* found"):
        home_plan(seed)


def test_home_is_the_world_of_its_plan():
    home = make_home(np.int64(3), aliasing=0.5)
    assert home.plan == home_plan(3, 0.5)
    assert home.is_free(home.free_poses(20, np.random.default_rng(0))[:, :2]).all()


def written(path):
    """Exit status of `python -m data_gen home PATH`."""
    with pytest.raises(SystemExit) as exit:
        main(["home", str(path), "--seed", "3"])
    return exit.value.code


def test_a_home_takes_the_place_of_another_procedural_one_and_of_no_other_file(tmp_path, capsys):
    home, mine, notes = (tmp_path / name for name in ("home.json", "mine.json", "notes.md"))
    make_home(5).save(home)
    assert written(home) == 0
    assert World.load(home).plan == home_plan(3)
    World({**home_plan(5), "name": "my home-5"}).save(mine)
    notes.write_text("dear diary")
    for path, found in (mine, "expected a procedural home or nothing, found my home-5"), (notes, "expected JSON"):
        before = path.read_bytes()
        assert written(path) == 2
        assert path.read_bytes() == before
        err = capsys.readouterr().err
        assert err.startswith(f"python -m data_gen: {path}: {found}")
        assert err.count("\n") == 1


def test_a_home_without_a_name_of_a_file_is_one_line(capsys):
    assert written("") == 2
    assert capsys.readouterr().err == "python -m data_gen: out: expected a file, found no name\n"


def by_room(plan):
    """Type and polygon of each room, and its things: name, middle, unit vector to its front, polygon, whole object."""
    middles = np.array([np.mean(thing["polygon"], 0) for thing in plan["objects"]])
    for room in plan["rooms"]:
        things = []
        for i in np.flatnonzero(covers(room["polygon"], *middles.T)):
            thing, polygon = plan["objects"][i], np.array(plan["objects"][i]["polygon"])
            back, front = polygon[:2].mean(0), polygon[2:].mean(0)  # corners begin at the back
            look = (front - back) / np.hypot(*(front - back))
            things.append((thing["name"], middles[i], look, polygon, thing))
        yield room["type"], np.array(room["polygon"]), things


@pytest.fixture(scope="module")
def all_rooms(homes):
    """Of all homes: polygon of each room, and its things, as by_room gives them."""
    return [(polygon, things) for plan in homes for _, polygon, things in by_room(plan)]


def test_each_chair_looks_at_its_table(homes):
    chairs = 0
    for plan in homes:
        for _, _, things in by_room(plan):
            tables = [polygon for name, *_, polygon, _ in things if name in ("desk", "dining table", "kitchen table")]
            for name, _, look, polygon, _ in things:
                if name == "chair":
                    x, y = (polygon[2:].mean(0) + np.linspace(0, 0.5, 51)[:, None] * look).T
                    assert any(covers(table, x, y).any() for table in tables)
                    chairs += 1
    assert chairs > 100


def test_most_televisions_look_at_the_sofa_that_looks_at_them(homes):
    at_each_other = []
    for plan in homes:
        for kind, _, things in by_room(plan):
            sofas, tvs = ([thing for thing in things if thing[0] == name] for name in ("sofa", "tv"))
            if kind == "living room" and tvs:
                (_, tv, tv_looks, *_), (_, sofa, sofa_looks, *_) = tvs[0], sofas[0]
                at_each_other.append(tv_looks @ sofa_looks < -0.99 and (tv - sofa) @ sofa_looks > 1)
    assert len(at_each_other) > 0.9 * len(homes)
    assert np.mean(at_each_other) > 0.5  # one wall in four would be luck


def test_the_floor_before_what_stands_at_a_wall_is_free_of_what_stands_alone(homes):
    rules = defaultdict(set)
    for pieces in ROOMS.values():
        for name, words, _ in pieces:
            rules[name] |= {rule.split()[0] for rule in words.split(" or ")}
    alone = {name for name, of_name in rules.items() if of_name <= {*ALONE}} - {"carpet"}
    at_wall = {name for name in alone if rules[name] <= {*AT_WALL}}
    for plan in homes:
        for _, _, things in by_room(plan):
            standing = [thing for thing in things if thing[0] in alone and thing[-1]["z0"] < 0.1]
            fronts = [np.array([left, right, right + 0.49 * look, left + 0.49 * look]) + 0.005 * look
                      for name, _, look, (*_, right, left), _ in standing if name in at_wall]
            blocked = [(i, j) for i, j in overlaps(fronts, [polygon for *_, polygon, _ in standing])] if fronts else []
            assert not blocked


@functools.cache
def rules_of(name):
    """First words of all rules by which a piece gets its place."""
    return {rule.split()[0] for pieces in ROOMS.values() for of_name, words, _ in pieces if of_name == name
            for rule in words.split(" or ")}


def test_lamps_monitors_and_ovens_stand_on_the_top_of_something(all_rooms):
    raised = 0
    for _, things in all_rooms:
        for name, middle, *_, thing in things:
            if rules_of(name) == {"on"}:
                assert any(abs(top(other) - thing["z0"]) < 2e-4 and covers(polygon, *middle)
                           for *_, polygon, other in things)
                raised += 1
    assert raised > 100


def test_what_stands_at_a_wall_has_its_back_two_centimetres_from_it_and_in_a_corner_a_side_too(all_rooms):
    found = Counter()
    for room, things in all_rooms:
        low, high = room.min(0) + 0.05, room.max(0) - 0.05  # the faces of walls 10 cm thick
        for name, _, _, polygon, _ in things:
            rules, back = rules_of(name), polygon[:2].mean(0)
            if rules <= {*AT_WALL, "above"}:
                assert abs(np.minimum(back - low, high - back).min() - 0.02) < 2e-3
                found["wall"] += 1
            if rules == {"corner"}:
                assert abs(np.minimum(polygon.min(0) - low, high - polygon.max(0)) - 0.02).max() < 2e-3
                found["corner"] += 1
    assert found["wall"] > 1000
    assert found["corner"] > 200


@pytest.mark.parametrize(("name", "other"), [("mirror", "basin"), ("picture", "bed")])
def test_most_mirrors_hang_above_the_basin_and_most_pictures_above_the_bed(all_rooms, name, other):
    above = []
    for _, things in all_rooms:
        hanging, below = ([thing for thing in things if thing[0] == of_name] for of_name in (name, other))
        if hanging and below:
            (_, high, look, polygon, _), (_, low, low_look, low_polygon, _) = hanging[0], below[0]
            along = np.array([-look[1], look[0]])
            room_to_slide = np.ptp(low_polygon @ along) - np.ptp(polygon @ along)
            above.append(look @ low_look > 0.99 and abs((high - low) @ along) < abs(room_to_slide) / 2 + 2e-3)
    assert len(above) > 30
    assert np.mean(above) > 0.7  # the others found no place there


@pytest.mark.parametrize("name", ["nightstand", "chair"])
def test_pairs_and_sets_are_alike_and_there_are_some(homes, name):
    pairs = 0
    for plan in homes:
        for kind, _, things in by_room(plan):
            sizes = [(*np.hypot(*np.diff(polygon[:3], axis=0).T), thing["height"])
                     for of_name, _, _, polygon, thing in things if of_name == name]
            if kind in ("bedroom", "dining room", "kitchen"):
                np.testing.assert_allclose(sizes, sizes[:1] * len(sizes), atol=2e-3)
                pairs += len(sizes) > 1
    assert pairs > 10


def test_some_things_stand_on_carpets(homes):
    assert sum(thing["z0"] == 0.01 for plan in homes for thing in plan["objects"]) > 20


def test_a_layout_is_mirrored_and_turned_in_all_eight_ways():
    ways = {json.dumps(turn(np.array([[0.0, 0.0, 1.0, 2.0]]), 5.0, 7.0, np.random.default_rng(seed)))
            for seed in range(100)}
    assert ways == {json.dumps([[x, y, x + w, y + d]]) for W, D, w, d in ((5.0, 7.0, 1.0, 2.0), (7.0, 5.0, 2.0, 1.0))
                    for x in (0.0, W - w) for y in (0.0, D - d)}


def test_corridors_lead_to_a_living_room_or_to_the_outer_wall(homes):
    beyond = set()
    for plan in homes:
        corridor = next(np.array(room["polygon"]) for room in plan["rooms"] if room["type"] == "corridor")
        front_door = next(door["segment"] for door in plan["doors"] if door["state"] == "closed")
        entrance = np.reshape(front_door, (2, 2)).mean(0)
        along = corridor.mean(0) - entrance
        ahead, left = along / np.hypot(*along), np.array([-along[1], along[0]]) / np.hypot(*along)
        x, y = (entrance + 2 * along + 0.1 * ahead + np.linspace(-0.6, 0.6, 25)[:, None] * left).T
        beyond.add(tuple(room["type"] for room in plan["rooms"] if covers(room["polygon"], x, y).any()))
    assert beyond == {(), ("living room",)}


def test_the_front_door_is_in_the_middle_of_the_corridors_end(homes):
    for plan in homes:
        corridor = next(np.array(room["polygon"]) for room in plan["rooms"] if room["type"] == "corridor")
        front_door = next(door["segment"] for door in plan["doors"] if door["state"] == "closed")
        along = corridor.mean(0) - np.reshape(front_door, (2, 2)).mean(0)
        assert abs(along).min() < 1e-3


def test_no_bathroom_is_narrower_than_a_metre_and_seventy():
    assert good_shape("bathroom", 1.7, 3.0) and good_shape("bathroom", 3.0, 1.7)
    assert not good_shape("bathroom", 1.65, 3.0) and not good_shape("bathroom", 3.0, 1.65)


@pytest.mark.parametrize(("shared_m", "n_openings"), [(1.4, 0), (1.6, 1), (3.0, 1)])
def test_rooms_of_the_day_lie_open_to_one_another_where_they_share_a_metre_and_a_half(shared_m, n_openings):
    rooms = [("outside", (-1.0, -2.0, 0.0, -0.5)), ("corridor", (0.0, -2.0, 8.0, -0.5)),
             ("living room", (0.0, 0.0, 4.0, 4.0)), ("kitchen", (4.0, 4.0 - shared_m, 8.0, 8.0 - shared_m))]
    kinds = [gap.kind for gap in draw_gaps(rooms, np.random.default_rng(0))]
    assert kinds.count("opening") == n_openings


@pytest.mark.parametrize(("shared_m", "kind"), [(1.7, "opening"), (2.5, "door")])
def test_a_corridor_as_wide_as_can_be_ends_in_the_living_room_too(shared_m, kind):
    """Between 1.13 m and 2.83 m lie 1.7000000000000002 m."""
    rooms = [("outside", (-1.0, 1.13, 0.0, 1.13 + 1.5)), ("corridor", (0.0, 1.13, 8.0, round(1.13 + shared_m, 2))),
             ("living room", (8.0, 0.0, 12.0, 5.0))]
    assert [gap.kind for gap in draw_gaps(rooms, np.random.default_rng(0))] == ["front door", kind]


def furnished(monkeypatch, *lacking):
    """A home whose rooms hold one thing of each class, but in each draw of its furniture one is lacking; all asked."""
    lacking, asked = iter([*lacking, None]), []

    def furnish(room, kind, keep_clear, leaves, key):
        asked.append((room, leaves))
        if kind == "corridor":  # the first room of each draw
            furnish.lacks = next(lacking)
        return [{"class": name, "polygon": outline(room).tolist(), "height": 0.01}
                for name in rooms_module.IN_EVERY_HOME - {furnish.lacks}]

    monkeypatch.setattr(rooms_module, "furnish", furnish)
    return home_plan(3), asked


def test_a_home_that_would_lack_a_class_is_drawn_anew(monkeypatch):
    plan, asked = furnished(monkeypatch, "tv", "bed")
    assert {one["class"] for one in plan["objects"]} == rooms_module.IN_EVERY_HOME
    assert len(asked) > 2 * len(plan["rooms"])


def test_each_open_leaf_is_in_the_way_in_the_room_that_it_stands_in(monkeypatch):
    plan, asked = furnished(monkeypatch)
    assert all(inside(room, one, -0.01) for room, leaves in asked for one in leaves)
    middles = sorted((round(one.x, 3), round(one.y, 3)) for _, leaves in asked for one in leaves)
    doors = [np.mean(leaf(door), 0).round(3) for door in plan["doors"] if door["state"] == "open"]
    np.testing.assert_allclose(middles, sorted(map(tuple, doors)), atol=2e-3)


@pytest.mark.parametrize("leaves", [[], [Box(0.4, -1.2, 0.0, 0.04, 0.9, 2.0)]], ids=["no leaf", "leaf"])
def test_the_floor_of_a_furnished_room_hangs_together_however_narrow_the_ways(leaves):
    """Cells of 10 cm with a middle that is 25 cm from all things, and between them the ways of a disc of 20 cm."""
    room = Box(0.0, 0.0, 0.0, 3.0, 3.4, 2.5)
    x, y = grid((-1.5, -1.7), (1.5, 1.7), 0.02)
    to_walls = np.minimum(1.5 - abs(x), 1.7 - abs(y)) - 0.05
    for key in range(60):
        things = furnish(room, "bedroom", [], leaves, key) or []
        clearance = np.min([to_walls, *(distance(one, x, y) for one in (*leaves, *map(box_of, things))
                                        if one.z0 < ROBOT_HEIGHT_M and one.z0 + one.height > 0.05)], axis=0)
        parts, middles = ndimage.label(clearance > ROBOT_M)[0], np.s_[2::5, 2::5]  # of 5 x 5 points of the raster
        assert len({*parts[middles][clearance[middles] > ROBOT_M + 0.0501].tolist()}) == 1


@pytest.mark.parametrize(("narrowest_m", "one"), [(0.24, False), (0.26, True)])
def test_a_way_is_wide_enough_between_the_middles_of_its_cells_too(narrowest_m, one):
    """Half a cell away from a middle things may be nearer by half a cell."""
    assert in_one_part(np.array([[0.4, 0.4, narrowest_m, 0.4, 0.4]])) == one


def box_of(thing):
    """The Box of an object of a floor plan."""
    a, b, c, _ = np.array(thing["polygon"])
    return Box(*(a + c) / 2, np.arctan2(*(b - a)[::-1]), np.hypot(*(b - a)), np.hypot(*(c - b)), thing["height"],
               thing["z0"])


def test_flat_keeps_the_same_laws(flat):
    assert cut_off(flat, regions(flat)) == [] and collisions(flat) == [] and things_in_the_way(flat) == []


def test_flat_has_all_classes_a_corner_sofa_and_a_turned_table(flat):
    world = World.load(FLAT)
    assert set(world.label) | {1, 2} == set(range(len(CLASSES)))  # floor and ceiling are no boxes
    polygons = {thing["name"]: np.array(thing["polygon"]) for thing in flat["objects"]}
    assert len(polygons["corner sofa"]) == 6
    assert (np.diff(polygons["coffee table"], axis=0) != 0).all()
