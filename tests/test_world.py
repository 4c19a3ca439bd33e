"""Homes become boxes as the format says, and a free pose is free."""

import os
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from conftest import FLAT, FOUND, room, thing
from scipy import stats

import gnl
from gnl.classes import BED, DOOR, OTHER, SOFA, TABLE, TV, WALL, class_of
from gnl.free_space import box_distance
from gnl.world import ROBOT_HEIGHT_M, ROBOT_RADIUS_M, World

BOXES = ["centre", "half", "angle", "z", "label", "colour"]


def boxes_of(world, label, above=-1.0):
    return np.flatnonzero((world.label == label) & (world.z[:, 0] > above))


def corners(world, box):
    """The footprint's corners, rounded, as a set."""
    c, s = np.cos(world.angle[box]), np.sin(world.angle[box])
    u, v = world.half[box, 0] * np.array([c, s]), world.half[box, 1] * np.array([-s, c])
    return {tuple(np.round(world.centre[box] + a * u + b * v, 6) + 0.0) for a in (1, -1) for b in (1, -1)}


def front_door(width=0.9, **door):
    """A room with a gap in its western wall, and a door in it."""
    plan = room()
    plan["walls"][3:] = [[0, 4, 0, 2 + width / 2], [0, 2 - width / 2, 0, 0]]
    plan["doors"] = [{"segment": [0, 2 - width / 2, 0, 2 + width / 2], **door}]
    return plan


def inner_door(**door):
    """Two rooms and a door between them."""
    plan = room()
    plan["walls"] += [[3, 0, 3, 1.5], [3, 2.4, 3, 4]]
    plan["doors"] = [{"segment": [3, 1.5, 3, 2.4], **door}]
    return plan


@pytest.mark.parametrize(("walls", "lost"), [([[4, 0, 4, 1], [4, 1.9, 4, 4]], []), ([[4, 0, 4, 4]], ["kitchen"]),
                                             ([[4, 0, 4, 1.8], [4, 1.9, 4, 4]], ["kitchen"])])
def test_a_room_that_no_robot_gets_into_is_named(two_rooms_plan, walls, lost):
    two_rooms_plan["walls"][-2:] = walls
    two_rooms_plan["doors"].pop()
    assert World(two_rooms_plan).out_of_reach() == lost


def test_spots_in_a_room_are_those_of_a_raster_within_its_corners(two_rooms):
    corner = {"polygon": [[0, 0], [1, 0], [1, 0.5], [0.5, 0.5], [0.5, 1], [0, 1]]}
    expected = {(x, y) for x in (0.25, 0.75) for y in (0.25, 0.75)} - {(0.75, 0.75)}
    assert set(map(tuple, two_rooms.spots_in(corner, 0.5).tolist())) == expected


def test_a_real_home_has_free_poses_that_are_free_and_inside(real_home):
    poses = real_home.free_poses(200, np.random.default_rng(0))
    b = real_home.blocks
    distance = box_distance(poses[:, :2], real_home.centre[b], real_home.half[b], real_home.angle[b])
    assert (distance > ROBOT_RADIUS_M).all()
    assert real_home.is_free(poses[:, :2]).all()
    assert real_home.free_space.inside(poses[:, :2]).all()
    x0, y0, x1, y1 = real_home.bounds
    assert ((poses[:, :2] > [x0, y0]) & (poses[:, :2] < [x1, y1])).all()
    assert ((poses[:, 2] >= -np.pi) & (poses[:, 2] <= np.pi)).all()


def test_a_real_home_has_colours_and_boxes_in_range(real_home):
    assert ((real_home.colour >= 0) & (real_home.colour <= 1)).all()
    assert (real_home.half > 0).all()
    assert (real_home.z[:, 1] > real_home.z[:, 0]).all()
    assert np.isfinite(np.column_stack([getattr(real_home, name) for name in BOXES])).all()


def test_a_saved_home_comes_back_bit_for_bit(real_home, tmp_path):
    real_home.save(tmp_path / "home.json")
    again = World.load(tmp_path / "home.json")
    for name in BOXES:
        assert getattr(again, name).tobytes() == getattr(real_home, name).tobytes()
    assert (again.bounds, again.name, again.wall_height) == (real_home.bounds, real_home.name, real_home.wall_height)


def test_homes_are_the_same_in_a_fresh_process():
    code = f"""
import zlib
from gnl.world import World
for path in {[str(path) for path in [FLAT, *FOUND]]}:
    world = World.load(path)
    print(zlib.crc32(b"".join(getattr(world, name).tobytes() for name in {BOXES})))
"""
    there = subprocess.run([sys.executable, "-c", code], cwd=Path(gnl.__file__).parents[1], check=True, text=True,
                           capture_output=True, env={**os.environ, "PYTHONHASHSEED": "7"}).stdout.split()
    for path, found in zip([FLAT, *FOUND], there, strict=True):
        world = World.load(path)
        assert int(found) == zlib.crc32(b"".join(getattr(world, name).tobytes() for name in BOXES))


def test_class_names_know_no_case_and_a_name_that_is_no_class_is_other():
    assert [class_of(name) for name in ("bed", "BED", "Bed", " bed ", "piano", "", "beds")] == [BED] * 4 + [OTHER] * 3
    world = World(room(thing("SOFA", 1, 1, 1, 0.5, 0.8), thing("Piano", 4, 2, 1, 0.5, 1.0)))
    assert world.label[4:].tolist() == [SOFA, OTHER]


def test_a_thing_is_the_box_that_the_plan_says():
    world = World(room(thing("table", 2, 1.5, 1.2, 0.7, 0.7, z0=0.1, angle=0.5)))
    c, s = np.cos(0.5), np.sin(0.5)
    expected = {tuple(np.round((2 + a * c - b * s, 1.5 + a * s + b * c), 6))
                for a in (0.6, -0.6) for b in (0.35, -0.35)}
    (table,) = boxes_of(world, TABLE)
    assert corners(world, table) == expected
    np.testing.assert_allclose(world.z[table], (0.1, 0.8))


def test_a_concave_thing_is_several_boxes_of_one_colour():
    sofa = {"class": "sofa", "polygon": [[1, 1], [4, 1], [4, 2], [2, 2], [2, 3], [1, 3]], "height": 0.8}
    world = World(room(sofa))
    parts = boxes_of(world, SOFA)
    assert len(parts) == 2
    np.testing.assert_allclose(4 * world.half[parts].prod(1).sum(), 4.0)
    assert world.colour[parts[0]].tolist() == world.colour[parts[1]].tolist()


def test_a_picture_without_depth_and_a_mat_without_height_still_are_boxes():
    flat = {"class": "other", "polygon": [[1, 1], [2, 1], [3, 1]], "height": 0}
    world = World(room(flat))
    assert (world.half[-1] > 0).all()
    assert world.z[-1, 1] > world.z[-1, 0]


def test_a_closed_door_fills_its_gap_and_wall_stands_above_it():
    world = World(inner_door(state="closed", height=2.0))
    (leaf,), (lintel,) = boxes_of(world, DOOR), boxes_of(world, WALL, above=0)
    np.testing.assert_allclose(world.centre[[leaf, lintel]], [[3, 1.95]] * 2)
    np.testing.assert_allclose(world.half[[leaf, lintel], 0], 0.45)
    np.testing.assert_allclose(abs(np.cos(world.angle[[leaf, lintel]])), 0, atol=1e-12)
    np.testing.assert_allclose(world.z[[leaf, lintel]], [[0, 2.0], [2.0, 2.5]])
    assert not world.is_free([[3, 1.95]])


def test_an_open_door_hinges_at_its_first_end_and_stands_to_the_left():
    world = World(inner_door(state="open", height=2.0))
    (leaf,), (lintel,) = boxes_of(world, DOOR), boxes_of(world, WALL, above=0)
    # From (3, 1.5) to (3, 2.4) one looks along +y; the left is -x, the hinge (3, 1.5).
    np.testing.assert_allclose(world.centre[leaf], [2.55, 1.5])
    np.testing.assert_allclose(world.half[leaf, 0], 0.45)
    np.testing.assert_allclose(abs(np.sin(world.angle[leaf])), 0, atol=1e-12)
    np.testing.assert_allclose(world.z[leaf], (0, 2.0))
    np.testing.assert_allclose(world.centre[lintel], [3, 1.95])
    np.testing.assert_allclose(world.z[lintel], (2.0, 2.5))
    assert world.is_free([[3, 1.95]])


def test_a_door_as_high_as_the_walls_has_no_wall_above_it():
    assert len(boxes_of(World(inner_door(state="open", height=2.5)), WALL, above=0)) == 0


def test_a_door_told_again_among_the_objects_is_told_once():
    plan = inner_door(state="open")
    plan["objects"] = [thing("door", 3, 1.95, 0.05, 0.9, 2.0), thing("door", 5, 1, 0.05, 0.9, 2.0)]
    world = World(plan)
    assert len(boxes_of(world, DOOR)) == 2  # its leaf, and the one that leans elsewhere
    assert world.is_free([[3, 1.95]])


def test_a_folding_door_along_a_wall_stays_there():
    plan = room()
    plan["doors"] = [{"segment": [1, 0.08, 1.8, 0.08], "state": "open"}]
    world = World(plan)
    (leaf,) = boxes_of(world, DOOR)
    np.testing.assert_allclose(world.centre[leaf], (1.4, 0.08))
    assert len(boxes_of(world, WALL, above=0)) == 0


def test_a_wall_that_ends_in_the_middle_of_a_gap_does_not_shut_its_door():
    plan = inner_door(state="open")
    plan["walls"].append([3, 1.95, 5, 1.95])
    world = World(plan)
    assert len(boxes_of(world, WALL, above=0)) == 1  # the lintel
    assert (world.centre[world.label == DOOR, 0] < 2.9).all()  # its leaf stands aside


def test_of_doors_without_a_state_a_front_door_is_shut_and_an_inner_door_open():
    assert not World(front_door()).is_free([[0, 2]])
    assert World(inner_door()).is_free([[3, 1.95]])
    assert World(inner_door(state=None)).is_free([[3, 1.95]])


def test_what_lies_before_an_open_front_door_is_not_inside():
    world = World(front_door(state="open"))
    assert world.free_space.inside([[3, 2], [0.5, 2], [-0.4, 2], [-1.5, 2]]).tolist() == [True, True, False, False]
    poses = world.free_poses(500, np.random.default_rng(0))
    assert (poses[:, 0] > -0.3).all()


def test_a_front_door_through_which_a_ball_would_fit_is_shut_to_it():
    plan = front_door(width=1.8, state="open")
    plan["walls"] += [[3, 0, 3, 1.6], [3, 2.4, 3, 4]]
    assert World(plan).free_space.inside([[1.5, 2], [4.5, 2], [-1.5, 2]]).tolist() == [True, True, False]


@pytest.mark.parametrize("ask", ["is_free", "is_reachable"])
def test_points_are_lists_or_arrays_of_two_numbers(two_rooms, ask):
    ask = getattr(two_rooms, ask)
    assert ask([[3.2, 1.0], [1.1, 0.7]]).tolist() == ask(np.array([[3.2, 1.0], [1.1, 0.7]])).tolist() == [True, False]
    with pytest.raises(ValueError, match="xy: expected finite numbers, found nan"):
        ask([[1.1, np.nan]])
    with pytest.raises(ValueError, match=r"xy: expected shape \(n, 2\), found \(4, 3\)"):
        ask(np.zeros((4, 3)))


def test_outside_nothing_is_free():
    assert World(room()).is_free([[3, 2], [-1.5, 2], [3, 5.5], [300, 2]]).tolist() == [True, False, False, False]


def test_low_hanging_and_standing_things_block_flat_and_high_ones_do_not():
    world = World(room(thing("table", 1, 1, 0.5, 0.5, 0.7), thing("other", 2, 1, 0.5, 0.5, 0.02),
                       thing("other", 3, 1, 0.5, 0.5, 0.3, z0=ROBOT_HEIGHT_M + 0.05),
                       thing("other", 4, 1, 0.5, 0.5, 0.3, z0=ROBOT_HEIGHT_M - 0.05)))
    assert world.blocks[4:].tolist() == [True, False, False, True]
    assert world.is_free([[1, 1], [2, 1], [3, 1], [4, 1]]).tolist() == [False, True, True, False]


def test_free_is_more_than_a_radius_from_everything():
    world = World(room(thing("table", 3, 2, 1, 1, 0.7)))
    right_of_table, before_wall = 3.5, 5.95  # a wall is 10 cm thick
    x = np.array([right_of_table + 0.299, right_of_table + 0.301, before_wall - 0.301, before_wall - 0.299])
    assert world.is_free(np.stack([x, np.full(4, 2.0)], 1), radius_m=0.3).tolist() == [False, True, True, False]


def test_what_stands_on_a_thing_or_hangs_above_it_is_carried_by_it(two_rooms):
    above_table = [label for label in two_rooms.label[two_rooms.carries] if label not in (WALL, DOOR)]
    assert above_table == [TABLE]
    assert TV in two_rooms.label


def test_what_stands_on_a_thing_or_hangs_above_it_has_it_below(two_rooms):
    lintels = (two_rooms.label == WALL) & (two_rooms.z[:, 0] > 0)
    assert two_rooms.covers[two_rooms.label == TV].all()
    assert two_rooms.covers[lintels].all()  # doors' leaves
    assert not two_rooms.covers[(two_rooms.label == WALL) & ~lintels].any()


def test_free_poses_hang_together():
    plan = room()
    plan["walls"] += [[2, 0, 2, 4]]  # a small room that no door leads to
    poses = World(plan).free_poses(500, np.random.default_rng(0))
    assert (poses[:, 0] > 2).all()
    assert poses.shape == (500, 3)


def test_free_poses_are_uniform_over_the_free_floor_and_all_around(two_rooms):
    poses = two_rooms.free_poses(40_000, np.random.default_rng(2))
    assert stats.kstest(poses[:, 2], stats.uniform(-np.pi, 2 * np.pi).cdf).pvalue > 1e-3
    x, y = np.meshgrid(np.arange(0.025, 7, 0.05), np.arange(0.025, 4, 0.05), indexing="ij")
    free = two_rooms.is_reachable(np.stack([x, y], -1).reshape(-1, 2)).reshape(7, 20, 4, 20)
    expected = free.sum((1, 3)) / free.sum()  # of each square metre, its share of what is free
    found = np.histogram2d(poses[:, 0], poses[:, 1], [np.arange(8), np.arange(5)])[0] / len(poses)
    assert expected.max() > 2 * expected.min()
    assert abs(found - expected).max() < 0.004


def test_free_poses_come_from_the_generator_alone(two_rooms):
    one, two = (two_rooms.free_poses(20, np.random.default_rng(4)) for _ in range(2))
    np.testing.assert_array_equal(one, two)
    assert (two_rooms.free_poses(20, np.random.default_rng(5)) != one).any()
    assert two_rooms.free_poses(0, np.random.default_rng(4)).shape == (0, 3)


def test_a_home_without_free_space_is_refused():
    full = World(room(thing("bed", 3, 2, 5.9, 3.9, 0.5), name="full"))
    with pytest.raises(ValueError, match=r"'full': expected free space for a disc of 0.2 m, found 0 free among"):
        full.free_poses(1, np.random.default_rng(0))


class Impatient:
    """A generator that draws a million times and no more."""

    def __init__(self):
        self.rng, self.left = np.random.default_rng(0), 1e6

    def __getattr__(self, name):
        self.left -= 100
        assert self.left > 0, "still drawing"
        return getattr(self.rng, name)


def test_a_home_with_a_hole_just_too_small_is_refused_in_the_end():
    # By the raster of 5 cm a disc of 40 cm fits between the beds; by their outlines it does not.
    beds = [thing("bed", 1.5 + 0.695 * np.cos(a), 1.5 + 0.695 * np.sin(a), 1.0, 3.0, 0.5, angle=a)
            for a in 0.5 + np.arange(4) * np.pi / 2]
    rims = [thing("bed", x, y, 0.6, 0.6, 0.5) for x in (0.3, 2.7) for y in (0.3, 2.7)]
    with pytest.raises(ValueError, match="expected free space"):
        World(room(*beds, *rims, size=(3.0, 3.0))).free_poses(1, Impatient())


def test_a_thing_bears_the_colour_that_the_plan_gives_it_and_its_neighbours_keep_theirs():
    things = [thing("bed", 1, 1, 1, 0.5, 0.5), thing("sofa", 4, 2, 1, 0.5, 0.5)]
    before = World(room(*things))
    after = World(room({**things[0], "color": [255, 0, 51]}, things[1], colors={"floor": [0, 255, 0]}))
    np.testing.assert_allclose(after.colour[4], (1, 0, 0.2))
    np.testing.assert_allclose(after.floor_colour, (0, 1, 0))
    np.testing.assert_array_equal(after.colour[5], before.colour[5])
    np.testing.assert_array_equal(after.ceiling_colour, before.ceiling_colour)


def test_colours_belong_to_the_home():
    def colours(name):
        return World(room(thing("bed", 1, 1, 1, 0.5, 0.5), name=name)).colour[4].tolist()
    assert colours("this") == colours("this")
    assert colours("this") != colours("that")
