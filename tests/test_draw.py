"""Pictures: where metres land, that colours are those of the classes, and that what matters is marked."""

import numpy as np
import pytest
from PIL import Image

from gnl import draw, floor_map
from gnl.classes import BED, CLASSES, N_CLASSES, PALETTE, SOFA, WALL
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
    assert colour_at(plan.picture(), plan.at([3, 0])) == floor_map.WALLS


def test_a_petal_points_to_the_bearings_of_its_place(world, grid):
    pose = np.array([3.2, 1.9, np.radians(100)])
    plan = floor_map.Map(world, 640, grid=grid)
    plan.belief(np.eye(grid.n_places)[grid.place_of(pose)])
    middle = np.array([3, 1])  # of the cell
    ahead = 0.8 * np.array([np.cos(np.radians(105)), np.sin(np.radians(105))])
    assert np.abs(np.subtract(colour_at(plan.picture(), plan.at(middle + ahead)), floor_map.BELIEF)).max() < 20
    assert sum(colour_at(plan.picture(), plan.at(middle - ahead))) > 3 * 220


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


def test_a_copied_map_is_a_sheet_of_its_own(world):
    plan = floor_map.Map(world, 320)
    before = plan.picture()
    plan.copy().robot(np.array([3.0, 2.0, 1.0]))
    assert plan.picture() == before


def test_labels_and_legend_have_the_colours_of_their_classes():
    image = np.arange(N_CLASSES).reshape(2, 5).repeat(5, 0).repeat(2, 1)
    assert (np.array(draw.labels(image, 10)) == PALETTE[image]).all()
    assert all(count(draw.legend(), PALETTE[c]) >= 100 for c in range(len(CLASSES)))


def test_a_wall_stands_in_the_strip_at_its_distance(world):
    dense = [part[0] for part in cast(world, np.array([[3.0, 2.0, 0.0]])).dense()]  # the wall is 2.95 m ahead
    picture = np.array(draw.strip(world, dense, 384, 412))  # 400 rows for 4 m
    column = picture[6:406, 34 + 349 // 2]
    assert (column[400 - 294:-3] == floor_map.PAPER).all()
    assert (column[400 - 304:400 - 296] == PALETTE[WALL]).all()
    assert (column[3:400 - 306] == floor_map.FAINT).all()


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
        box = draw._spot(np.array([100, 100]), 90, 16, taken, (200, 200))
        assert 0 <= box[0] < box[2] <= 200
        assert 0 <= box[1] < box[3] <= 200
        low, high = np.maximum(box[:2], taken[:, :2]), np.minimum(box[2:], taken[:, 2:])
        assert not (high > low).all(1).any()
        taken = np.vstack([taken, box])


@pytest.mark.parametrize("rank", [1, 3, 40])
def test_the_true_place_is_green_wherever_it_ranks(grid, rank):
    values = 1 / np.arange(1, grid.n_places + 1)
    picture = np.array(draw.ranks(grid, values, rank - 1, n=5))
    green = (picture == floor_map.RIGHT).all(-1).any(1)
    row = min(rank, 5) - 1
    assert green[row * floor_map.LINE_PX:(row + 1) * floor_map.LINE_PX].any()
    assert not green[:row * floor_map.LINE_PX].any()
    assert not green[(row + 1) * floor_map.LINE_PX:].any()


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
