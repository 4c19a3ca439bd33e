"""Learned parts: learnt once and then loaded, one file for each way to learn, and never a wrong or broken one."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from data_gen.rooms import make_home
from gnl import episode, gcn, learned, segnet
from gnl.files import load_arrays, save_arrays
from gnl.gcn import GCN
from gnl.nnql import NNQL
from gnl.places import PlaceGrid
from gnl.robot import Robot
from gnl.senses import Senses

STARTS = np.array([[1.0, 2, 0], [3, 2, 1]])
VIEWS = np.random.default_rng(0).integers(0, 256, (16, 64, 64, 3), np.uint8), np.zeros((16, 64, 64), np.uint8)


def silent(*_):
    """A stage that shows nothing."""


class Part:
    """A part that counts how often it is learnt."""

    def __init__(self):
        self.learnt = 0

    def get(self, folder, **settings):
        def learn(path):
            self.learnt += 1
            save_arrays(path, settings, value=np.array(self.learnt))
            return self.learnt

        def load(path):
            arrays, made_by = load_arrays(path)
            return int(arrays["value"]), made_by

        return learned.kept(folder, "part", settings, load, learn)


def test_a_part_is_learnt_once_and_loaded_after(tmp_path):
    part = Part()
    assert [part.get(tmp_path / "new", seed=0) for _ in range(3)] == [1, 1, 1]
    assert part.learnt == 1


def test_other_settings_are_learnt_into_another_file(tmp_path):
    part = Part()
    assert [part.get(tmp_path, seed=seed) for seed in (0, 1, 0)] == [1, 2, 1]
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize("name", learned.STAGES)
def test_other_code_of_a_stage_is_learnt_into_another_file(tmp_path, monkeypatch, name):
    part, read = Part(), Path.read_text
    assert part.get(tmp_path, seed=0) == 1
    monkeypatch.setattr(Path, "read_text", lambda path, **how: read(path, **how) + "#" * (path.stem == name))
    assert part.get(tmp_path, seed=0) == 2


def test_the_order_of_settings_does_not_matter():
    assert learned.digest({"seed": 0, "noise": 1.0}) == learned.digest({"noise": 1.0, "seed": 0})
    assert len(learned.digest({})) == 8


def test_other_arrays_have_another_fingerprint_and_their_order_does_not_matter():
    a, b = np.arange(6.0), np.zeros(3)
    one = learned.fingerprint({"a": a, "b": b})
    assert one == learned.fingerprint({"b": b.copy(), "a": a.copy()})
    nearly = np.append(a[:-1], np.nextafter(a[-1], 9))
    others = [{"a": b, "b": a}, {"a": a.reshape(2, 3), "b": b}, {"a": a, "b": b.astype(np.float32)}, {"a": a},
              {"a": a, "c": b}, {"a": nearly, "b": b}, {"a": a, "b": b.view(np.int64)}]
    assert len({one, *map(learned.fingerprint, others)}) == 1 + len(others)


def test_learning_that_is_interrupted_is_begun_again(tmp_path):
    def interrupted(path):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        learned.kept(tmp_path, "part", {"seed": 0}, load_arrays, interrupted)
    assert Part().get(tmp_path, seed=0) == 1


def test_a_file_under_another_ones_name_is_refused(tmp_path):
    Part().get(tmp_path, seed=0)
    (path,) = tmp_path.iterdir()
    path.rename(learned.path_of(tmp_path, "part", {"seed": 1}))
    with pytest.raises(ValueError, match=r"part-.*: expected what was made by {'seed': 1}, found .* by {'seed': 0}"):
        Part().get(tmp_path, seed=1)


def truncated(path):
    path.write_bytes(path.read_bytes()[:-20])


def empty(path):
    path.write_bytes(b"")


def other_bytes(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 255
    path.write_bytes(data)


@pytest.mark.parametrize("damage", [truncated, empty, other_bytes], ids=lambda damage: damage.__name__)
def test_a_damaged_file_is_named_and_left_as_it_is(tmp_path, damage):
    def net():
        return learned.segmentation_net(tmp_path, VIEWS, "views", epochs=1, seed=0, stage=silent)

    net()
    (path,) = tmp_path.iterdir()
    damage(path)
    before = path.read_bytes()
    with pytest.raises(ValueError, match=f"{path}: expected an .npz file of gnl, found something else .*; "
                                         "remove it, and it is learned anew"):
        net()
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def never(*_args, **_options):
    raise AssertionError("learnt again")


def test_a_net_from_its_file_is_the_net_that_was_learnt(tmp_path, monkeypatch):
    learnt = learned.segmentation_net(tmp_path, VIEWS, "views", 1, seed=0, stage=silent)
    monkeypatch.setattr(segnet, "train", never)
    loaded = learned.segmentation_net(tmp_path, VIEWS, "views", 1, seed=0, stage=silent)
    assert learnt.keys() == loaded.keys()
    for name in learnt:
        assert learnt[name].dtype == loaded[name].dtype
        assert np.array_equal(learnt[name], loaded[name])
    assert any((learnt[name] != start).any() for name, start in segnet.new_params(np.random.default_rng(0)).items())


class Helper:
    """An executor that does what it is given at once, in this process, and counts it."""

    def __init__(self):
        self.given = 0

    def submit(self, function, *args, **options):
        self.given += 1
        done = function(*args, **options)
        return SimpleNamespace(result=lambda: done)


@pytest.fixture
def parts(two_rooms):
    """Senses of true labels and a GCN that has learned nothing, a grid, a helper."""
    grid = PlaceGrid(two_rooms)
    return Senses(two_rooms, None, GCN(grid.n_places, np.random.default_rng(0), hidden=8)), grid, Helper()


def test_a_classifier_a_store_and_a_scan_from_their_files_are_those_that_were_learnt(parts, tmp_path, monkeypatch):
    senses, grid, helper = parts
    other = make_home(3)

    def learn():
        one = learned.place_classifier(tmp_path, senses, grid, 8, 0, {}, helper, None, epochs=1, batch=4)
        of_worlds = dict(learned.place_classifiers(tmp_path, {3: Senses(other, None, None), 4: senses}, 8, 0,
                                                   {"many": 1}, helper, epochs=1, batch=4))
        store = learned.q_values(tmp_path, senses, Robot(senses.world), grid, 4, 0, {}, silent)
        scan = learned.fixed_scan(tmp_path, senses, grid, 1, 0, {}, helper)()
        networks = [one, *(of_worlds[world] for world in (3, 4))]
        assert [network.scores(senses.look(STARTS, np.random.default_rng(0))).shape[1] for network in networks] == [
            grid.n_places, PlaceGrid(other).n_places, grid.n_places]
        return [array for part in networks for array in part.params.values()] + [*store.values, scan]

    learnt, given = learn(), helper.given
    assert given == 4  # half of the views of one GCN, two other GCNs, the race
    assert len(list(tmp_path.iterdir())) == 5
    for module, name in ((gcn, "train"), (episode, "train_nnql"), (episode, "race")):
        monkeypatch.setattr(module, name, never)
    for one, again in zip(learnt, learn(), strict=True):
        np.testing.assert_array_equal(one, again)
    assert helper.given == given


@pytest.mark.parametrize("helped", [False, True])
def test_what_is_seen_from_a_pose_is_learnt_as_the_place_of_that_pose(parts, monkeypatch, helped):
    senses, grid, helper = parts
    taught = []
    monkeypatch.setattr(gcn, "train", lambda network, graphs, places, *_, **how: taught.append((graphs, places, how)))
    learned.learn_places(senses, grid, 9, 5, helper if helped else None, epochs=7)
    ((graphs, places, how),) = taught
    poses = senses.world.free_poses(9, np.random.default_rng(5))
    seen = senses.look(poses, np.random.default_rng(0))  # true labels have no noise
    for name in vars(seen):
        np.testing.assert_array_equal(getattr(graphs, name), getattr(seen, name))
    np.testing.assert_array_equal(places, grid.place_of(poses))
    assert how["epochs"] == 7
    assert helper.given == helped


def test_the_helper_and_who_is_helped_see_with_noise_of_their_own(parts, monkeypatch):
    """And neither with the numbers that the poses were made of."""
    senses, grid, helper = parts
    look_around, drawn = senses.look_around, [np.random.default_rng(5).random(2000)]

    def draw_and_look(poses, rng, stage=None):
        drawn.append(rng.random(1000))
        return look_around(poses, rng, stage)

    monkeypatch.setattr(senses, "look_around", draw_and_look)
    monkeypatch.setattr(gcn, "train", lambda *_, **how: None)
    learned.learn_places(senses, grid, 9, 5, helper, draw=lambda n, rng: rng.random((2000, 3))[:n] + 1)
    assert len(drawn) == 3
    assert len(np.unique(np.concatenate(drawn))) == 4000


@pytest.mark.parametrize(("n", "label", "complaint"), [
    (0, 0, r"expected rgb \(n, 64, 64, 3\) and labels \(n, 64, 64\) of bytes, found rgb \(0, 64, 64, 3\)"),
    (2, 10, r"expected labels 0\.\.9, found 10")], ids=["no view", "no label"])
def test_views_of_which_none_is_there_or_with_a_label_that_is_none_are_refused(tmp_path, n, label, complaint):
    path, labels = tmp_path / "views.npz", np.full((n, 64, 64), label, np.uint8)
    save_arrays(path, {"homes": 1, "views": n}, rgb=np.zeros((n, 64, 64, 3), np.uint8), labels=labels)
    with pytest.raises(ValueError, match=rf"views\.npz: {complaint}"):
        learned.load_views(path)


def test_views_are_loaded_as_they_were_saved_up_to_the_last_label(tmp_path):
    path, labels = tmp_path / "views.npz", np.full((16, 64, 64), 9, np.uint8)
    save_arrays(path, {"homes": 1, "views": 16}, rgb=VIEWS[0], labels=labels)
    views, made_by = learned.load_views(path)
    assert made_by == {"homes": 1, "views": 16}
    for found, saved in zip(views, (VIEWS[0], labels), strict=True):
        np.testing.assert_array_equal(found, saved)


def test_places_are_learnt_from_the_poses_that_are_drawn_for_it(parts, monkeypatch):
    senses, grid, _ = parts
    taught, asked = [], []
    monkeypatch.setattr(gcn, "train", lambda network, graphs, places, *_, **how: taught.append((graphs, places)))

    def draw(n, rng):
        asked.append((n, rng.random()))
        return STARTS[:n]

    learned.learn_places(senses, grid, len(STARTS), 5, draw=draw)
    ((graphs, places),) = taught
    np.testing.assert_array_equal(places, grid.place_of(STARTS))
    np.testing.assert_array_equal(graphs.words, senses.look(STARTS, np.random.default_rng(0)).words)
    assert asked == [(len(STARTS), np.random.default_rng(5).random())]


def test_one_view_alone_needs_no_helper(parts):
    def nobody(*_):
        raise AssertionError("asked for help")

    senses, grid = parts[0], PlaceGrid(parts[0].world)
    helper = SimpleNamespace(submit=nobody)
    assert learned.learn_places(senses, grid, 1, 0, helper, epochs=1).n_places == grid.n_places


def test_quick_senses_look_by_true_labels_and_know_their_home_in_64_bits(parts):
    world = parts[0].world
    senses, others = learned.quick_senses(world, 300), learned.quick_senses(world, 300, seed=1)
    assert (senses.world, senses.net, senses.noise) == (world, None, 0)
    assert {p.dtype for p in senses.gcn.params.values()} == {np.dtype(float)}

    def right(senses, *seed):
        poses = world.free_poses(300, np.random.default_rng(*seed))
        return (senses.scores(poses, np.random.default_rng(0)).argmax(1) == PlaceGrid(world).place_of(poses)).mean()

    assert right(senses, [0, 1]) > 0.5 > right(others, [0, 1])  # those that it learned from
    assert right(senses, 0) < 0.5  # what one draws with the same seed is new to it
    fine = PlaceGrid(world, 1.0, 8)
    assert learned.quick_senses(world, 30, grid=fine).gcn.n_places == fine.n_places != senses.gcn.n_places


def test_a_store_of_another_seed_learns_from_other_starts(parts, tmp_path, monkeypatch):
    senses, grid, _ = parts
    starts, seeds = [], []

    def train_nnql(_senses, _robot, _grid, poses, seed, **_):
        starts.append(poses)
        seeds.append(seed)
        return NNQL(grid.n_places, 3)

    monkeypatch.setattr(episode, "train_nnql", train_nnql)
    for seed in (0, 1):
        learned.q_values(tmp_path, senses, None, grid, 6, seed, {}, silent)
    assert seeds == [0, 1]
    assert starts[0].shape == starts[1].shape == (6, 3)
    assert (starts[0] != starts[1]).all()
    assert not np.isin(starts[0], senses.world.free_poses(6, np.random.default_rng(0))).any()  # where the GCN learns


def test_the_best_sequence_is_the_winner_of_a_race_from_random_starts(parts, monkeypatch):
    senses, grid, _ = parts
    starts = senses.world.free_poses(2, np.random.default_rng([7, 2]))
    sequences, _ = episode.race(senses, Robot(senses.world), grid, starts, 7)
    np.testing.assert_array_equal(learned.best_sequence(senses, grid, 2, 7), sequences[0])
    raced = []
    monkeypatch.setattr(episode, "race", lambda *args: raced.append(args[3:]) or ([[0]], [1]))
    learned.best_sequence(senses, grid, 2, 7)
    np.testing.assert_array_equal(raced[0][0], starts)
    assert raced[0][1:] == (7,)


def test_top_places_are_shares_of_views_whose_place_is_first_and_among_three():
    scores = np.array([[9.0, 8, 7, 6], [6, 9, 8, 7], [9, 8, 7, 6], [9, 8, 7, 6]])
    network = SimpleNamespace(scores=lambda graphs: graphs)
    assert learned.top_places(network, scores, np.array([0, 0, 2, 3])) == (1 / 4, 2 / 4)


WAYS = {
    learned.segmentation_net: {"views": VIEWS, "views_made_by": "views", "epochs": 1, "seed": 0, "stage": silent},
    learned.place_classifier: {"senses": None, "grid": None, "n_views": 8, "seed": 0, "settings": {"noise": 1},
                               "helper": None, "stage": silent, "batch": 4},
    learned.q_values: {"senses": None, "robot": None, "grid": None, "n_episodes": 8, "seed": 0,
                       "settings": {"noise": 1}, "stage": silent},
    learned.fixed_scan: {"senses": None, "grid": None, "n_starts": 8, "seed": 0, "settings": {"noise": 1},
                         "helper": SimpleNamespace(submit=silent)},
}
OTHERS = {"views_made_by": "others", "epochs": 2, "seed": 1, "n_views": 9, "settings": {"noise": 2}, "batch": 5,
          "n_episodes": 9, "n_starts": 9}


def get(part, folder, **way):
    """What learned.<part> gives, at once or when it is asked for."""
    found = part(folder, **way)
    return found() if part is learned.fixed_scan else found


@pytest.mark.parametrize("part", WAYS, ids=lambda part: part.__name__)
def test_all_that_a_part_is_learnt_from_is_in_the_name_of_its_file(monkeypatch, part):
    monkeypatch.setattr(learned, "kept", lambda folder, name, settings, *_: f"{name}-{learned.digest(settings)}")
    names = [get(part, "", **WAYS[part])]
    names += [get(part, "", **{**WAYS[part], key: other}) for key, other in OTHERS.items() if key in WAYS[part]]
    assert len(set(names)) == len(names) >= 4


def test_a_net_of_other_layers_has_another_file(monkeypatch):
    monkeypatch.setattr(learned, "kept", lambda folder, name, settings, *_: learned.digest(settings))
    way = WAYS[learned.segmentation_net]
    here = learned.segmentation_net("", **way)
    monkeypatch.setattr(segnet, "new_params", lambda rng: {"w": rng.random(3)})
    assert learned.segmentation_net("", **way) != here


@pytest.mark.parametrize("part", WAYS, ids=lambda part: part.__name__)
def test_a_file_of_something_else_is_refused_by_name(monkeypatch, tmp_path, part):
    monkeypatch.setattr(learned, "kept", lambda folder, name, settings, load, learn: load)
    path = tmp_path / "other.npz"
    save_arrays(path, {}, other=np.zeros(3))
    with pytest.raises(ValueError, match=f"{path}: "):
        get(part, tmp_path, **WAYS[part])(path)


@pytest.mark.parametrize("sequence", [[9, 9, 9, 9], [0, 1, -1, 2], [0.5], [0, 0], [], [[0] * 4], 0])
def test_a_sequence_of_no_actions_is_refused(monkeypatch, tmp_path, sequence):
    monkeypatch.setattr(learned, "kept", lambda folder, name, settings, load, learn: load)
    save_arrays(tmp_path / "scan.npz", {}, sequence=np.array(sequence))
    load = get(learned.fixed_scan, tmp_path, **WAYS[learned.fixed_scan])
    words = r"scan\.npz: expected a sequence of actions \(actions: expected 4 whole numbers 0\.\.2, found "
    with pytest.raises(ValueError, match=words):
        load(tmp_path / "scan.npz")
