"""The strip is what a ray by ray look finds, and what pymunk finds, however the home lies."""

import naive
import numpy as np
import pymunk
import pytest
from conftest import room, strewn_plan, thing

from gnl import strip
from gnl.classes import BED, DOOR, OTHER, SOFA, TABLE, TV, WALL
from gnl.free_space import box_distance
from gnl.strip import FACES, NEAREST_M, cast, slopes
from gnl.world import World


def poses_clear_of(world, n, seed=0):
    """Poses anywhere in the bounds, 10 cm from every outline: from within a box pymunk sees nothing of it."""
    rng = np.random.default_rng(seed)
    poses = rng.uniform([*world.bounds[:2], -np.pi], [*world.bounds[2:], np.pi], (200 * n, 3))
    clear = box_distance(poses[:, :2], world.centre, world.half, world.angle).min(1) > 0.1
    return poses[clear][:n]


def overlapping(seed):
    """A room of forty boxes thrown in at random."""
    rng = np.random.default_rng(seed)
    return World(room(*[thing("other", *rng.uniform(0, [9, 5]), *rng.uniform(0.05, 1.5, 2), rng.uniform(0.1, 2.4),
                              angle=rng.uniform(0, np.pi)) for _ in range(40)], size=(9.0, 5.0)))


def bearings_of(pose, n_columns):
    return pose[2] + np.arctan(slopes(n_columns))


def assert_nearest_is_pymunks(world, poses, n_columns=64):
    space = pymunk.Space()
    for (x, y), (a, b), angle in zip(world.centre, world.half, world.angle, strict=True):
        frame = pymunk.Transform(np.cos(angle), np.sin(angle), -np.sin(angle), np.cos(angle), x, y)
        space.add(pymunk.Poly(space.static_body, [(a, b), (-a, b), (-a, -b), (a, -b)], frame))
    near, _, _ = cast(world, poses, n_columns).dense()
    reach = 100.0
    for v, (x, y, _) in enumerate(poses):
        for c, bearing in enumerate(bearings_of(poses[v], n_columns)):
            far_end = (x + reach * np.cos(bearing), y + reach * np.sin(bearing))
            hit = space.segment_query_first((x, y), far_end, 0, pymunk.ShapeFilter())
            expected = np.inf if hit is None else hit.alpha * reach
            np.testing.assert_allclose(near[v, c, 0], expected, atol=1e-6)


def test_the_nearest_crossing_is_pymunks_on_procedural_homes(home):
    assert_nearest_is_pymunks(home, poses_clear_of(home, 6))


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_nearest_crossing_is_pymunks_among_boxes_turned_at_random(seed):
    world = overlapping(seed)
    assert_nearest_is_pymunks(world, poses_clear_of(world, 6))


def assert_strip_is_the_naive_one(world, poses, n_columns=40):
    near, far, box = cast(world, poses, n_columns).dense()
    for v, pose in enumerate(poses):
        for c, crossings in enumerate(naive.strip(world, pose, n_columns)):
            n = len(crossings)
            order = np.lexsort((box[v, c, :n], far[v, c, :n], near[v, c, :n].round(9)))
            expected = sorted(crossings, key=lambda crossing: (round(crossing[0], 9), *crossing[1:]))
            assert box[v, c, :n][order].tolist() == [which for *_, which in expected]
            np.testing.assert_allclose(near[v, c, :n][order], [distance for distance, *_ in expected], atol=1e-9)
            np.testing.assert_allclose(far[v, c, :n][order], [distance for _, distance, _ in expected], rtol=1e-6)
            assert (box[v, c, n:] == -1).all()
            assert (near[v, c, n:] == np.inf).all()
            assert (far[v, c, n:] == np.inf).all()


def test_all_crossings_are_those_of_slabs_ray_by_ray(home):
    assert_strip_is_the_naive_one(home, home.free_poses(3, np.random.default_rng(2)))


def test_all_crossings_are_those_of_slabs_in_a_strewn_room(strewn):
    poses = np.random.default_rng(0).uniform([0.2, 0.2, -np.pi], [7.8, 4.8, np.pi], (12, 3))  # also from within boxes
    assert_strip_is_the_naive_one(strewn, poses, 20)


def test_all_crossings_are_those_of_slabs_in_a_real_home(real_home):
    assert_strip_is_the_naive_one(real_home, real_home.free_poses(1, np.random.default_rng(0)), 24)


def test_crossings_go_from_near_to_far_and_end_at_a_wall(strewn):
    poses = np.random.default_rng(1).uniform([0.2, 0.2, -np.pi], [7.8, 4.8, np.pi], (10, 3))
    near, far, box = cast(strewn, poses).dense()
    crossed = box >= 0
    assert (near[..., 1:] >= near[..., :-1]).all()
    assert (far[crossed] > near[crossed]).all()
    last = np.take_along_axis(box, crossed.sum(-1, keepdims=True) - 1, -1)
    assert (last >= 0).all()
    assert (strewn.label[last] == WALL).all()


def test_a_wall_hides_what_is_behind_it_and_a_doorway_shows_it(two_rooms):
    def seen(x, y, theta):
        box = cast(two_rooms, np.array([[x, y, theta]])).dense()[2]
        return set(two_rooms.label[box[box >= 0]])
    assert seen(5.2, 3.0, 0.0) == {WALL, SOFA}
    assert TABLE not in seen(4.6, 2.9, np.pi)  # it stands right behind the wall
    assert OTHER in seen(3.3, 1.45, 0.0)  # through the open door: the carpet
    assert DOOR in seen(1.0, 1.95, np.pi)  # the shut one


def test_lower_walls_do_not_hide_what_is_behind_them():
    world = World(room(thing("wall", 3, 2, 0.1, 4, 1.1), thing("bed", 5, 2, 1, 1, 0.5)))
    box = cast(world, np.array([[1.0, 2.0, 0.0]]), 9).dense()[2][0, 4]
    assert world.label[box[box >= 0]].tolist() == [WALL, BED, WALL]


def test_a_wall_that_goes_on_behind_the_camera_is_seen_out_to_the_rim():
    # A long wall on the left, its far end behind the camera and to the right of its axis.
    near, _, box = cast(World(room(size=(20.0, 4.0))), np.array([[5.0, 3.0, -0.4]]), 16).dense()
    assert box[0, 0, 0] == 2
    bearing = -0.4 + np.arctan(slopes(16)[0])
    np.testing.assert_allclose(near[0, 0, 0], 0.95 / np.sin(bearing))


def test_a_camera_in_the_plane_of_a_side_sees_past_it():
    world = World(room(thing("bed", 4, 1.5, 1, 1, 0.5)))  # its side lies in y = 2
    near, _, box = cast(world, np.array([[1.0, 2.0, 0.0], [1.0, 2.0, np.pi / 4], [4.0, 3.0, -np.pi / 2]]), 64).dense()
    assert not (box[0, :32] == 4).any()  # it lies to the right of the axis
    assert (box[0, 32:42, 0] == 4).all()
    assert np.isfinite(near[..., 0]).all()


def test_distances_are_along_the_ray():
    near, far, _ = cast(World(room()), np.array([[1.0, 2.0, 0.0]]), 512).dense()
    ahead = 4.95  # the face of the wall
    middle = slice(200, 312)
    np.testing.assert_allclose(near[0, middle, 0], ahead * np.hypot(1, slopes(512))[middle])
    np.testing.assert_allclose(far[0, middle, 0], (ahead + 0.1) * np.hypot(1, slopes(512))[middle])


def test_column_0_is_the_leftmost_of_ninety_degrees():
    np.testing.assert_allclose(slopes(512)[[0, -1]], [511 / 512, -511 / 512])
    world = World(room(thing("bed", 4, 3, 0.5, 0.5, 0.5), thing("sofa", 4, 1, 0.5, 0.5, 0.5)))
    box = cast(world, np.array([[1.0, 2.0, 0.0]])).dense()[2][0]
    bed, sofa = (np.flatnonzero((box == np.flatnonzero(world.label == label)).any(-1)) for label in (BED, SOFA))
    assert bed.max() < 256 <= sofa.min()
    np.testing.assert_array_equal(bed, 511 - sofa[::-1])


def moved(plan, angle, shift, mirror=1):
    """The plan mirrored at the x axis, turned around the origin and shifted."""
    c, s = np.cos(angle), np.sin(angle)

    def point(x, y):
        y = mirror * y
        return [float(c * x - s * y + shift[0]), float(s * x + c * y + shift[1])]

    def segment(x0, y0, x1, y1):
        return point(x0, y0) + point(x1, y1)

    return {**plan, "walls": [segment(*wall) for wall in plan["walls"]],
            "doors": [{**door, "segment": segment(*door["segment"])} for door in plan.get("doors", [])],
            "objects": [{**item, "polygon": [point(*p) for p in item["polygon"]]} for item in plan["objects"]]}


@pytest.mark.parametrize(("angle", "shift"), [(0.0, (100, -50)), (0.7, (0, 0)), (-2.2, (3, 4))])
def test_home_and_camera_moved_together_show_the_same(two_rooms_plan, angle, shift):
    poses = np.array([[2.0, 1.8, 0.3], [3.2, 1.5, 0.0], [5.0, 1.7, 2.8], [6.0, 2.3, -1.5]])
    c, s = np.cos(angle), np.sin(angle)
    there = np.stack([c * poses[:, 0] - s * poses[:, 1] + shift[0], s * poses[:, 0] + c * poses[:, 1] + shift[1],
                      poses[:, 2] + angle], 1)
    for plan in (two_rooms_plan, strewn_plan(4)):
        here = cast(World(plan), poses, 64).dense()
        moved_along = cast(World(moved(plan, angle, shift)), there, 64).dense()
        for a, b in zip(here, moved_along, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-5)


def test_a_mirrored_home_mirrors_the_strip():
    plan, poses = strewn_plan(4), np.array([[2.0, 1.02, 0.3], [5.0, 2.97, -2.8], [3.0, 1.9, 1.4]])
    here = cast(World(plan), poses, 64).dense()
    mirrored = cast(World(moved(plan, 0.0, (0, 0), mirror=-1)), poses * [1, -1, -1], 64).dense()
    for a, b in zip(here, mirrored, strict=True):
        np.testing.assert_allclose(a, b[:, ::-1], rtol=1e-5)


def test_a_camera_under_a_lamp_crosses_it_from_where_it_is():
    world = World(room(thing("other", 3, 2, 0.6, 0.4, 0.3, z0=1.7)))
    near, far, box = cast(world, np.array([[3.0, 2.0, 0.0]]), 9).dense()
    ahead = np.hypot(1, slopes(9))
    assert (box[0, :, 0] == 4).all()
    np.testing.assert_allclose(near[0, :, 0], NEAREST_M * ahead)
    np.testing.assert_allclose(far[0, 4, 0], 0.3)
    np.testing.assert_allclose(far[0, 0, 0], 0.2 / slopes(9)[0] * ahead[0])  # it leaves by the side


def test_what_ends_nearer_than_the_nearest_distance_is_cut_off():
    """Two boards right before the camera, one through which the cut goes and one in front of it."""
    boards = thing("tv", 1.05, 2, 0.04, 2, 2), thing("sofa", 1.02, 2, 0.02, 2, 2)
    world = World(room(*boards))
    near, far, box = cast(world, np.array([[1.0, 2.0, 0.0]]), 9).dense()
    ahead = np.hypot(1, slopes(9))
    assert world.label[box[0, :, 0]].tolist() == [TV] * 9
    np.testing.assert_allclose(near[0, :, 0], NEAREST_M * ahead)
    np.testing.assert_allclose(far[0, :, 0], 0.07 * ahead)
    assert_strip_is_the_naive_one(world, np.array([[1.0, 2.0, 0.0], [1.0, 2.0, 0.6], [1.02, 2.1, -2.0]]))


def test_rays_leave_some_boxes_where_they_leave_them_among_all(strewn):
    strip = cast(strewn, np.array([[2.0, 1.02, 0.3], [5.0, 2.97, -2.8]]), 64)
    some = np.random.default_rng(0).permutation(len(strip.ray))[:99]
    np.testing.assert_array_equal(strip.w_out(some), strip.w_out()[some])
    assert (strip.w_out() < strip.w_in).all()


def test_rays_enter_by_the_side_that_faces_them():
    """Around a box, turned: side k looks to its own angle and k quarter turns."""
    world = World(room(thing("bed", 5, 5, 1, 1, 0.5, angle=0.3), size=(10.0, 10.0)))
    for k in range(4):
        bearing = 0.3 + k * np.pi / 2
        for off, sides in ((0.0, {k}), (0.7, {k, (k + 1) % 4})):  # in front of it, before the corner with the next
            x, y = 5 + 2 * np.cos(bearing + off), 5 + 2 * np.sin(bearing + off)
            strip = cast(world, np.array([[x, y, bearing + off + np.pi]]), 64)
            bed, side = strip.face // FACES == 4, strip.face % FACES
            assert set(side[bed].tolist()) == sides
            if off:  # the next one lies farther counter-clockwise, which one sees from outside on the right
                assert strip.ray[bed & (side == k)].max() < strip.ray[bed & (side == (k + 1) % 4)].min()


def test_a_view_of_nothing_crosses_nothing():
    world = World(room())
    near, far, box = cast(world, np.array([[-5.0, 2.0, np.pi], [3.0, 9.0, np.pi / 2]]), 32).dense()
    assert (box == -1).all()
    assert (near == np.inf).all()
    assert (far == np.inf).all()
    assert box.shape[:2] == (2, 32)


def test_many_views_are_cast_as_each_would_alone(home):
    poses = home.free_poses(12, np.random.default_rng(3))
    together = cast(home, poses, 100).dense()
    for v in range(12):
        for whole, alone in zip(together, cast(home, poses[v:v + 1], 100).dense(), strict=True):
            depth = alone.shape[-1]
            np.testing.assert_array_equal(whole[v, :, :depth], alone[0])
            assert (whole[v, :, depth:] == (np.inf if whole.dtype == float else -1)).all()


@pytest.mark.parametrize("angle", [np.pi, 3.5, 0, np.nan])
def test_a_view_of_half_a_circle_or_more_is_refused(monkeypatch, angle):
    monkeypatch.setattr(strip, "FIELD_OF_VIEW_RAD", angle)
    with pytest.raises(ValueError, match=f"field of view: expected more than 0 and less than pi, found {angle}"):
        slopes(8)


def test_no_views_have_a_strip_too_and_a_pose_that_is_none_has_no_strip(home):
    assert [part.shape for part in cast(home, np.empty((0, 3)), 64).dense()] == [(0, 64, 1)] * 3
    with pytest.raises(ValueError, match="poses: expected finite numbers, found nan"):
        cast(home, [[1, 2, np.nan]])
    with pytest.raises(ValueError, match=r"poses: expected shape"):
        cast(home, [[1, 2]])
