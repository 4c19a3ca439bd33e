"""Pictures: where metres land, that colours are those of the classes, and that what matters is marked."""

import numpy as np
import pytest
from conftest import FLAT, room, thing
from PIL import Image

from gnl import canvas, draw, floor_map
from gnl.classes import BED, CLASSES, N_CLASSES, PALETTE, SOFA, TABLE, TV, WALL
from gnl.places import PlaceGrid
from gnl.scene_graph import scene_graph
from gnl.strip import cast
from gnl.world import World

PLAN = {"name": "six by four", "walls": [[0, 0, 6, 0], [6, 0, 6, 4], [6, 4, 0, 4], [0, 4, 0, 0]],
        "rooms": [{"type": "bedroom", "polygon": [[0, 0], [6, 0], [6, 4], [0, 4]]}],
        "objects": [{"class": "bed", "polygon": [[0.5, 2.5], [2, 2.5], [2, 3.5], [0.5, 3.5]], "height": 0.5},
                    {"class": "sofa", "polygon": [[4, 0.5], [5, 0.5], [5, 1], [4, 1]], "height": 0.8}]}


@pytest.fixture(scope="module")
def world():
    return World(PLAN)


@pytest.fixture(scope="module")
def grid(world):
    return PlaceGrid(world)


def colour_at(picture, xy):
    return picture.getpixel(tuple(int(value) for value in xy))


def count(picture, colour):
    return (np.array(picture) == np.array(colour)).all(-1).sum()


def test_metres_land_on_pixels_with_y_upwards(world):
    plan = floor_map.Map(world, 640)  # 600 px for 6 m, and a rim of 20
    assert plan.picture().size == (640, 440)
    assert np.allclose(plan.at([[0, 0], [6, 4], [1, 3]]), [[20, 420], [620, 20], [120, 120]])


def test_a_map_of_given_size_holds_the_whole_home_in_its_middle(world):
    plan = floor_map.Map(world, 300, 600)
    assert plan.picture().size == (300, 600)
    low, high = plan.at([0, 0]), plan.at([6, 4])
    assert np.allclose(low + high, [300, 600])


def test_things_stand_on_the_map_where_they_stand_in_the_home(world):
    plan = floor_map.Map(world, 640)
    assert colour_at(plan.picture(), plan.at([1, 3])) == tuple(PALETTE[BED])
    assert colour_at(plan.picture(), plan.at([4.5, 0.75])) == tuple(PALETTE[SOFA])
    assert colour_at(plan.picture(), plan.at([3, 0])) == tuple(PALETTE[WALL])


def test_a_petal_points_to_the_bearings_of_its_place(world, grid):
    pose = np.array([3.2, 1.9, np.radians(100)])
    plan = floor_map.Map(world, 640, grid=grid)
    plan.belief(np.eye(grid.n_places)[grid.place_of(pose)])
    middle = np.array([3, 1])  # of the cell
    ahead = 0.8 * np.array([np.cos(np.radians(105)), np.sin(np.radians(105))])
    assert np.abs(np.subtract(colour_at(plan.picture(), plan.at(middle + ahead)), canvas.BELIEF)).max() < 20
    assert sum(colour_at(plan.picture(), plan.at(middle - ahead))) > 3 * 220


def test_places_with_hardly_any_belief_have_no_petal_and_the_more_belief_the_darker(world, grid, monkeypatch):
    petals, pooled = [], np.zeros(grid.n_places)
    pooled[[5, 20, 30, 40]] = 0.001, 0.01, 0.1, 0.8
    plan = floor_map.Map(world, 640, grid=grid)
    monkeypatch.setattr(canvas.Canvas, "polygon", lambda _, points, *how: petals.append((points, how[0])))
    plan.belief(pooled)
    violet = [(points, colour[3]) for points, colour in petals if colour[:3] == canvas.BELIEF]
    np.testing.assert_array_equal([points for points, _ in violet], [plan.petal(place) for place in (20, 30, 40)])
    shades = [shade for _, shade in violet]
    assert 30 < shades[0] < shades[1] < shades[2] < 256


def test_rooms_of_one_type_have_one_tint_and_others_another():
    rooms = [{"type": kind, "polygon": [[x, 0], [x + 2, 0], [x + 2, 4], [x, 4]]}
             for x, kind in ((0, "bath"), (2, "kitchen"), (4, "bath"))]
    plan = floor_map.Map(World(room(rooms=rooms)), 640)
    bath, kitchen, other_bath = (colour_at(plan.picture(), plan.at([x, 0.7])) for x in (1, 3, 5))
    assert bath == other_bath != kitchen
    assert {bath, kitchen} <= {*canvas.TINTS}


def test_a_robot_sees_as_far_as_the_wall_and_not_behind_itself(world):
    plan = floor_map.Map(world, 640)
    before = plan.picture()
    plan.sight(np.array([3.0, 2.0, 0.0]))
    for xy, seen in (((5.8, 2), True), ((4.5, 3.4), True), ((2.5, 2), False), ((3.2, 3), False)):
        assert (colour_at(before, plan.at(xy)) != colour_at(plan.picture(), plan.at(xy))) == seen


def test_more_weight_is_more_dots(world, grid):
    x, y = np.repeat([1.0, 5.0], 50), np.full(100, 2.0)
    weight = np.repeat([1.0, 0.0], 50)
    plan = floor_map.Map(world, 640)
    before = plan.picture()
    plan.particles((x, y, np.zeros(100), weight), n=20)
    assert colour_at(plan.picture(), plan.at([1, 2])) != colour_at(before, plan.at([1, 2]))
    assert colour_at(plan.picture(), plan.at([5, 2])) == colour_at(before, plan.at([5, 2]))


def test_particles_are_shown_as_often_as_they_weigh(world, monkeypatch):
    """The first weighs a hundredth of all, the second a half."""
    plan, dots = floor_map.Map(world, 640), []
    monkeypatch.setattr(canvas.Canvas, "disc", lambda _, middle, *how: dots.append(middle))
    x, weight = np.array([1.0, 2.0, 3.0]), np.array([0.02, 1.0, 0.98])
    for n, shown in ((10, [0, 5, 5]), (100, [1, 50, 49])):
        dots.clear()
        plan.particles((x, np.full(3, 2.0), np.zeros(3), weight), n=n)
        assert [int(np.isclose(np.array(dots)[:, 0], plan.at([one, 2])[0]).sum()) for one in x] == shown


def test_a_copied_map_is_a_sheet_of_its_own(world):
    plan = floor_map.Map(world, 320)
    before = plan.picture()
    plan.copy().robot(np.array([3.0, 2.0, 1.0]))
    assert plan.picture() == before


def test_labels_and_legend_have_the_colours_of_their_classes():
    image = np.arange(N_CLASSES).reshape(2, 5).repeat(5, 0).repeat(2, 1)
    assert (np.array(draw.labels(image, 10)) == PALETTE[image]).all()
    assert all(count(draw.legend(), PALETTE[c]) >= 100 for c in range(len(CLASSES)))


@pytest.fixture
def legends(monkeypatch):
    """The classes of each legend that is drawn, and its marks."""
    drawn, legend = [], draw.legend
    monkeypatch.setattr(draw, "legend", lambda classes=range(N_CLASSES), marks=None: (
        drawn.append((list(classes), marks)), legend(classes, marks))[1])
    return drawn


def classes_in(pixels):
    """Classes whose very colour is in some pixels."""
    return [c for c in range(N_CLASSES) if count(pixels, PALETTE[c])]


@pytest.mark.parametrize("theta", [0, 90, 140, 300])
def test_a_strip_names_the_classes_in_it_and_no_other(world, legends, theta):
    dense = [part[0] for part in cast(world, np.array([[3.0, 2.0, np.radians(theta)]])).dense()]
    plot = np.array(draw.strip(world, dense, 400, 300))[24:324, 30:430]
    assert legends == [(classes_in(plot), {"hidden": "hidden by walls"})]
    assert WALL in legends[0][0]


def test_a_home_names_the_classes_in_it_and_the_starts(world, grid, legends):
    starts = world.free_poses(7, np.random.default_rng(0))
    picture = draw.home(world, 400, grid, starts, starts[0])
    (classes, _), (none, marks) = legends
    assert classes == [WALL, BED, SOFA]
    assert none == []
    assert set(marks) == {"start", "robot", "sight"}
    assert "7" in marks["start"]
    x, y = floor_map.Map(world, 400, grid=grid).at(starts[0, :2]) + 4  # and the margin of the sheet
    disc = np.array(picture)[int(y) - 12:int(y) + 12, int(x) - 12:int(x) + 12]
    assert count(disc, canvas.ROBOT) > 60
    assert count(disc, canvas.PAPER) > 20


@pytest.mark.parametrize(("z0", "height", "pale"), [(0.0, 0.7, False), (0.0, 0.04, True), (2.0, 0.3, True)])
def test_a_home_says_what_pale_things_are_if_there_are_any(world, legends, z0, height, pale):
    thing = {"class": "lamp", "polygon": [[2, 2], [3, 2], [3, 3], [2, 3]], "z0": z0, "height": height}
    draw.home(World({**world.plan, "objects": [thing]}), 400)
    assert [marks for _, marks in legends] == [None] + [{"pale": "pale: hangs overhead or lies flat"}] * pale


@pytest.mark.parametrize("mark", draw.MARKS)
def test_every_mark_stays_clear_of_its_words(mark):
    picture = np.array(draw.legend([], {mark: "words"}))
    inked = (picture != 255).any(2).any(0)
    assert inked[:15].any()
    assert not inked[15:17].any()


def test_no_letter_is_smaller_than_eleven_pixels(world, grid, monkeypatch):
    sizes, write = [], canvas.Canvas.text
    monkeypatch.setattr(canvas.Canvas, "text", lambda self, at, words, size=12, *rest, **more: (
        sizes.append(size), write(self, at, words, size, *rest, **more))[1])
    pose = np.array([3.0, 2.0, 0.0])
    draw.home(world, 320, grid, [pose], pose)
    draw.strip(world, [part[0] for part in cast(world, pose[None]).dense()])
    draw.graph(scene_graph(np.full((64, 64), SOFA)), Image.new("RGB", (200, 200)))
    draw.sheet([draw.ranks(grid, np.arange(grid.n_places))], ["title"])
    assert len(sizes) > 40
    assert min(sizes) >= 11


@pytest.mark.parametrize("width", [160, 448, 900])
def test_names_of_rooms_do_not_touch_one_another(real_home, width):
    plan = floor_map.Map(real_home, width, grid=PlaceGrid(real_home))
    plan.names()
    assert len(plan.named) == len(real_home.plan.get("rooms", [])) or width == 160
    boxes = [(middle, np.array([canvas.text_width(name, px), px]) / 2) for middle, name, px in plan.named]
    for i, (middle, half) in enumerate(boxes):
        for other, its_half in boxes[:i]:
            assert (abs(middle - other) >= half + its_half + floor_map.AIR_PX).any()


def test_names_of_rooms_that_lie_open_to_one_another_keep_to_their_rooms():
    flat = World.load(FLAT)
    plan = floor_map.Map(flat, 448)
    plan.names()
    rooms = {room["type"]: plan.at(room["polygon"]) for room in flat.plan["rooms"]}
    for middle, name, px in plan.named:
        half = canvas.text_width(name, px) / 2
        assert rooms[name][:, 0].min() < middle[0] - half
        assert rooms[name][:, 0].max() > middle[0] + half


@pytest.mark.parametrize("draw_at", [lambda plan, poses: plan.robot(poses[0]), lambda plan, poses: plan.path(poses),
                                     lambda plan, poses: plan.starts(poses),
                                     lambda plan, poses: plan.particles((*poses.T, np.ones(len(poses))))])
def test_names_of_rooms_keep_away_from_what_is_drawn(world, draw_at):
    plan = floor_map.Map(world, 640)
    plan.names()
    (before, name, px), = plan.named
    there = [(before - plan.at([0, 0])) / plan.px_per_m * [1, -1]]
    draw_at(plan, np.pad(there, ((0, 2), (0, 1)), "edge"))
    assert plan.named[0][0] is before  # settled is settled
    plan.names()
    (after, *_), = plan.named
    assert (abs(after - before) > [canvas.text_width(name, px) / 2, px / 2]).any()


def test_names_of_rooms_keep_away_from_the_frame_of_a_place():
    flat = World.load(FLAT)
    plan = floor_map.Map(flat, 600, grid=PlaceGrid(flat))
    for place in range(0, plan.grid.n_places, plan.grid.n_bearings):
        plan.place(place, canvas.BELIEF)
        plan.names()
        corner = plan.grid.corner_of(place)[:2]
        (left, bottom), (right, top) = plan.at(corner), plan.at(corner + plan.grid.cell_m)
        for (x, y), name, px in plan.named:
            half = canvas.text_width(name, px) / 2
            covers = sum(x - half < side < x + half and top < y < bottom for side in (left, right))
            assert not covers, (place, name)
        plan = floor_map.Map(flat, 600, grid=plan.grid)


def test_names_are_written_smaller_where_a_room_is_too_narrow_for_them():
    widths = {}
    for metres in 2.5, 1.2, 0.9:
        plan = floor_map.Map(World(room(size=(metres, 6.0), rooms=[
            {"type": "corridor", "polygon": [[0, 0], [metres, 0], [metres, 6], [0, 6]]}])), height_px=340, width_px=400)
        plan.names()
        (_, _, widths[metres]), = plan.named
    assert widths == {2.5: floor_map.NAME_PX, 1.2: floor_map.SMALL_PX, 0.9: floor_map.SMALL_PX}


def test_a_name_that_has_no_spot_beside_another_one_is_written_smaller():
    shared = {"type": "corridor", "polygon": [[0, 0], [1, 0], [1, 1], [0, 1]]}
    plan = floor_map.Map(World(room(size=(1.0, 6.0), rooms=[shared, shared])), 400, 380)
    plan.names()
    assert [px for *_, px in plan.named] == [floor_map.NAME_PX, floor_map.SMALL_PX]


def test_names_of_rooms_stand_above_all_that_is_drawn(world):
    plan = floor_map.Map(world, 640)
    plan.names()
    (middle, name, _), = plan.named
    plan.box(0, 0, plan.width, plan.height, canvas.ROBOT)
    half = canvas.text_width(name, floor_map.NAME_PX) / 2, floor_map.NAME_PX / 2
    picture = plan.picture().crop((*(middle - half), *(middle + half)))
    assert (np.array(picture) == canvas.ROBOT).all(2).mean() < 0.5  # the rest is letters, and light around them
    assert plan.picture() == plan.picture()


def test_a_wall_stands_in_the_strip_at_its_distance(world):
    dense = [part[0] for part in cast(world, np.array([[3.0, 2.0, 0.0]])).dense()]  # the wall is 2.95 m ahead
    column = np.array(draw.strip(world, dense, 400, 400))[24:424, 30 + 200]  # 400 rows for 4 m
    assert (column[400 - 294:] == canvas.PAPER).all()
    assert (column[400 - 304:400 - 296] == PALETTE[WALL]).all()
    behind = column[:400 - 306]
    assert ((behind == canvas.FAINT) | (behind == canvas.PAPER)).all()
    assert 100 < count(behind, canvas.FAINT) * 7 / 3 + 10 > count(behind, canvas.PAPER)


def classes_ahead(world, height_px):
    """The middle column of the strip of a robot at (1, 2) that looks to the right: classes, the nearest first."""
    dense = [part[0] for part in cast(world, np.array([[1.0, 2.0, 0.0]])).dense()]
    column = np.array(draw.strip(world, dense, 400, height_px))[24:24 + height_px, 30 + 200][::-1]
    return [next(iter(classes_in(pixel)), None) for pixel in column]


def test_in_a_strip_a_short_thing_is_seen_within_a_long_one_at_its_distance():
    """A television on a table, 1.5 to 3.5 m ahead of the robot."""
    on = World(room(thing("table", 3.5, 2, 2.0, 1.0, 0.7), thing("tv", 3.5, 2, 0.2, 0.6, 0.5, z0=0.7)))
    column = classes_ahead(on, 300)  # 50 px a metre: the wall is 4.95 m away
    assert [column[int(50 * metres)] for metres in (1.4, 1.6, 2.3, 2.5, 2.7, 3.4, 3.6)] == [
        None, TABLE, TABLE, TV, TABLE, TABLE, None]


@pytest.mark.parametrize("x", [3.0, 3.01, 3.02, 3.03])
def test_in_a_strip_a_thing_as_thin_as_paper_is_two_pixels_or_three(x):
    column = classes_ahead(World(room(thing("tv", x, 2, 0.001, 1.0, 1.5))), 150)
    assert 2 <= column.count(TV) <= 3
    assert abs(column.index(TV) - 25 * (x - 1)) <= 1


def test_a_graph_of_no_node_is_a_pale_picture():
    none = scene_graph(np.indices((64, 64)).sum(0) % 2)  # a chess board: no two pixels hang together
    picture = draw.graph(none, Image.new("RGB", (128, 128), (55, 155, 255)))
    assert picture.getcolors() == [(128 * 128, (155, 205, 255))]


def test_a_graph_of_one_node_shows_it_at_the_middle_of_its_box():
    labels = np.full((64, 64), WALL)
    labels[8:24, 32:64] = BED
    graphs = scene_graph(labels)
    assert len(graphs.words) == 2
    picture = draw.graph(graphs, draw.labels(labels, 256))
    assert colour_at(picture, (192, 64)) == tuple(PALETTE[BED])
    assert colour_at(picture, (128, 128)) == tuple(PALETTE[WALL])
    one = draw.graph(scene_graph(np.full((64, 64), SOFA)), draw.labels(labels, 256), full=False)
    assert colour_at(one, (128, 128)) == tuple(PALETTE[SOFA])


def test_words_of_nodes_at_one_spot_do_not_cover_each_other():
    taken = np.zeros((0, 4))
    for _ in range(6):
        box = draw._spot(np.array([100, 100]), 90, 16, taken, np.empty((0, 2)), (200, 200))
        assert 0 <= box[0] < box[2] <= 200
        assert 0 <= box[1] < box[3] <= 200
        low, high = np.maximum(box[:2], taken[:, :2]), np.minimum(box[2:], taken[:, 2:])
        assert not (high > low).all(1).any()
        taken = np.vstack([taken, box])


@pytest.mark.parametrize("toward", [(1, 0), (-1, 0), (0, 1), (0, -1)], ids=str)
def test_words_keep_off_the_edges_of_their_node(toward):
    node = np.array([100, 100])
    edge = node + np.linspace(0, 90, 40)[:, None] * toward
    x0, y0, x1, y1 = draw._spot(node, 60, 16, np.array([[94, 94, 106, 106]]), edge, (200, 200))
    assert not ((edge >= [x0, y0]) & (edge <= [x1, y1])).all(1).any()


@pytest.mark.parametrize("rank", [1, 3, 40])
def test_the_true_place_is_green_wherever_it_ranks(grid, rank):
    values = 1 / np.arange(1, grid.n_places + 1)
    picture = np.array(draw.ranks(grid, values, rank - 1, n=5))
    green = (picture == canvas.RIGHT).all(-1).any(1)
    row = min(rank, 5)  # below the heads
    assert green[row * canvas.LINE_PX:(row + 1) * canvas.LINE_PX].any()
    assert not green[:row * canvas.LINE_PX].any()
    assert not green[(row + 1) * canvas.LINE_PX:].any()


def test_pictures_of_a_sheet_do_not_cover_each_other():
    colours = (255, 0, 0), (0, 255, 0), (0, 0, 255)
    pictures = [Image.new("RGB", size, c) for size, c in zip([(30, 50), (60, 20), (40, 40)], colours, strict=True)]
    sheet = draw.sheet(pictures, ["a", "b", "c"], columns=2)
    assert [count(sheet, c) for c in colours] == [1500, 1200, 1600]


def test_a_saved_picture_is_the_picture_and_nothing_else(world, grid, tmp_path):
    picture = draw.home(world, 320, grid, world.free_poses(5, np.random.default_rng(0)))
    draw.save_png(picture, tmp_path / "home.png")
    assert [path.name for path in tmp_path.iterdir()] == ["home.png"]
    assert (np.array(Image.open(tmp_path / "home.png")) == np.array(picture)).all()


def test_a_map_names_its_cells_as_a_chess_board_does_and_its_scale_is_two_metres(monkeypatch):
    words, lines = {}, []
    monkeypatch.setattr(canvas.Canvas, "text", lambda _, at, text, *how: words.update({text: at}))
    monkeypatch.setattr(canvas.Canvas, "line", lambda _, points, *how: lines.append(points))
    home = World(room(size=(6.0, 4.0)))
    plan = floor_map.Map(home, 640, grid=PlaceGrid(home))
    plan.picture()
    assert set(words) == {"A", "B", "C", "1", "2", "2 m"}
    assert words["A"][0] < words["B"][0] < words["C"][0]  # columns to the right
    assert words["1"][1] > words["2"][1]  # rows upwards
    assert np.ptp(np.array(lines[-1])[:, 0]) == pytest.approx(2 * plan.px_per_m)


@pytest.mark.parametrize("theta", [0.6, 2.0, -1.2])
def test_robots_starts_and_particles_look_to_their_bearing(world, monkeypatch, theta):
    plan, darts, hairs = floor_map.Map(world, 640), [], []
    monkeypatch.setattr(canvas.Canvas, "polygon", lambda _, points, *how: darts.append(np.asarray(points)))
    monkeypatch.setattr(canvas.Canvas, "line", lambda _, points, *how: hairs.append(np.subtract(*points[::-1])))
    plan.robot(np.array([3.0, 2.0, theta]))
    plan.starts([[2.0, 1.0, theta]])
    plan.particles((*np.array([[3.0], [2.0], [theta]]), np.ones(1)), n=1)
    ahead = np.array([np.cos(theta), -np.sin(theta)])  # y runs down in a picture
    for way in [points[0] - points[2] for points in darts] + hairs:
        np.testing.assert_allclose(way / np.hypot(*way), ahead, atol=1e-6)


def test_of_two_starts_in_one_spot_the_upper_has_a_rim_on_the_lower(world):
    plan = floor_map.Map(world, 640)
    plan.starts([[3.0, 2.0, 0.3]], canvas.BELIEF)
    lower = (np.array(plan.picture()) == canvas.BELIEF).all(-1)
    plan.starts([[3.0, 2.0, 2.0]], canvas.BELIEF)
    both = (np.array(plan.picture()) == canvas.BELIEF).all(-1)
    assert (both & ~lower).any() and (lower & ~both).any()


def test_cells_far_out_are_named_by_two_letters():
    assert [floor_map.column_name(i) for i in (0, 25, 26, 27, 52)] == ["A", "Z", "AA", "AB", "BA"]


def test_a_path_is_a_line_through_its_poses(world):
    plan = floor_map.Map(world, 640)
    before = plan.picture()
    plan.path(np.array([[2.5, 1.0, 0], [3.5, 2.0, 0]]))
    half_way = plan.at([3.0, 1.5])
    assert colour_at(plan.picture(), half_way) != colour_at(before, half_way)


def test_a_turned_thing_is_turned_on_the_map_too():
    plan = floor_map.Map(World(room(thing("bed", 3, 2, 2.0, 0.4, 0.5, angle=0.6))), 640)
    along = 0.8 * np.array([np.cos(0.6), np.sin(0.6)])
    assert colour_at(plan.picture(), plan.at((3, 2) + along)) == tuple(PALETTE[BED])
    assert colour_at(plan.picture(), plan.at((3, 2) + along * [1, -1])) != tuple(PALETTE[BED])


def test_what_carries_is_drawn_below_what_it_carries_and_what_hangs_has_an_outline_and_no_lintel_is_a_wall(two_rooms):
    plan = floor_map.Map(two_rooms, 640)
    assert colour_at(plan.picture(), plan.at([1.2, 3.1])) == tuple(PALETTE[CLASSES.index("tv")])
    assert colour_at(plan.picture(), plan.at([4.0, 1.45])) != tuple(PALETTE[WALL])


@pytest.mark.parametrize("first", ["the higher", "the lower"])
def test_from_above_one_sees_the_highest_whatever_the_plan_names_first(first):
    things = [thing("tv", 3, 2, 0.4, 0.4, 0.5, z0=0.7), thing("table", 3, 2, 1.2, 1.2, 0.7)]
    plan = floor_map.Map(World(room(*(things if first == "the higher" else things[::-1]))), 640)
    assert colour_at(plan.picture(), plan.at([3.0, 2.0])) == tuple(PALETTE[TV])
    assert colour_at(plan.picture(), plan.at([3.4, 2.0])) == tuple(PALETTE[TABLE])


def test_the_cell_and_the_petal_of_a_place_are_marked(world, grid):
    plan = floor_map.Map(world, 640, grid=grid)
    plan.place(grid.place_of(np.array([3.2, 1.9, np.radians(100)])), canvas.RIGHT)
    assert colour_at(plan.picture(), plan.at([2.0, 1.0])) == canvas.RIGHT  # the cell is 2..4 m, 0..2 m
    assert colour_at(plan.picture(), plan.at([3.0, 2.0])) == canvas.RIGHT
    petal = plan.petal(grid.place_of(np.array([3.2, 1.9, np.radians(100)]))).mean(0)
    assert colour_at(plan.picture(), petal) != colour_at(floor_map.Map(world, 640, grid=grid).picture(), petal)


@pytest.mark.parametrize(("end", "farthest"), [(True, 10.95), (False, np.hypot(12.0, 4.0))], ids=["walled", "open"])
def test_a_sight_ends_at_the_walls_and_where_there_is_none_after_the_width_of_the_home(monkeypatch, end, farthest):
    plan, drawn = room(size=(12.0, 4.0)), []
    plan["walls"] = [wall for wall in plan["walls"] if end or not wall[0] == wall[2] == 12.0]
    home = floor_map.Map(World(plan), 640)
    monkeypatch.setattr(canvas.Canvas, "polygon", lambda _, points, *how: drawn.append(np.asarray(points)))
    home.sight(np.array([1.0, 2.0, 0.0]))
    reach = np.hypot(*(drawn[0][1:] - home.at([1.0, 2.0])).T) / home.px_per_m
    assert reach[128] == pytest.approx(farthest, abs=0.001)
    assert reach[0] == pytest.approx(1.95 * np.sqrt(2), abs=0.02)  # the wall aside


def test_a_sight_ends_at_the_thing_that_hides_the_wall_on_its_own_side_and_far_walls_are_seen():
    hall = World(room(size=(8.0, 4.0)))
    plan = floor_map.Map(hall, 640)
    before = plan.picture()
    plan.sight(np.array([0.5, 0.5, 0.6]))
    assert colour_at(plan.picture(), plan.at([6.5, 3.5])) != colour_at(before, plan.at([6.5, 3.5]))
    assert colour_at(plan.picture(), plan.at([7.0, 1.0])) != colour_at(before, plan.at([7.0, 1.0]))
