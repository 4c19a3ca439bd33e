"""Learned parts: learnt once and then loaded, one file for each way to learn, and never a wrong or broken one."""

from types import SimpleNamespace

import numpy as np
import pytest

from gnl import learned, segnet
from gnl.files import load_arrays, save_arrays

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


def test_the_order_of_settings_does_not_matter():
    assert learned.digest({"seed": 0, "noise": 1.0}) == learned.digest({"noise": 1.0, "seed": 0})
    assert len(learned.digest({})) == 8


def test_learning_that_is_interrupted_is_begun_again(tmp_path):
    def interrupted(path):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        learned.kept(tmp_path, "part", {"seed": 0}, load_arrays, interrupted)
    assert Part().get(tmp_path, seed=0) == 1


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
    with pytest.raises(ValueError, match=f"{path}: expected an .npz file of gnl, found something else"):
        net()
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_a_net_from_its_file_is_the_net_that_was_learnt(tmp_path):
    learnt, loaded = (learned.segmentation_net(tmp_path, VIEWS, "views", 1, seed=0, stage=silent) for _ in range(2))
    assert learnt.keys() == loaded.keys()
    for name in learnt:
        assert learnt[name].dtype == loaded[name].dtype
        assert np.array_equal(learnt[name], loaded[name])
    assert any((learnt[name] != start).any() for name, start in segnet.new_params(np.random.default_rng(0)).items())


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


@pytest.mark.parametrize("part", WAYS, ids=lambda part: part.__name__)
def test_a_file_of_something_else_is_refused_by_name(monkeypatch, tmp_path, part):
    monkeypatch.setattr(learned, "kept", lambda folder, name, settings, load, learn: load)
    path = tmp_path / "other.npz"
    save_arrays(path, {}, other=np.zeros(3))
    with pytest.raises(ValueError, match=f"{path}: "):
        get(part, tmp_path, **WAYS[part])(path)
