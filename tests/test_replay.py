"""The replay: it shows the episode that was, in as many frames as it has looks, decisions and ways between."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from gnl import canvas, draw, episode, planners, replay, segnet
from gnl.gcn import GCN
from gnl.nnql import NNQL
from gnl.places import PlaceGrid
from gnl.robot import N_ACTIONS, Robot
from gnl.senses import Senses
from gnl.world import World

PLAN = {"name": "six by four", "walls": [[0, 0, 6, 0], [6, 0, 6, 4], [6, 4, 0, 4], [0, 4, 0, 0]],
        "objects": [{"class": "bed", "polygon": [[0.5, 2.5], [2, 2.5], [2, 3.5], [0.5, 3.5]], "height": 0.5}]}
START, SEED = np.array([3.0, 1.0, 0.3]), 7
LEFT_THEN_FORWARD = planners.scan([0, 2])


@pytest.fixture(scope="module")
def parts():
    world = World(PLAN)
    grid = PlaceGrid(world)
    rng = np.random.default_rng(0)
    senses = Senses(world, segnet.new_params(rng), GCN(grid.n_places, rng, hidden=8))
    return world, grid, Robot(world), senses


@pytest.fixture(scope="module")
def looks(parts):
    _, grid, robot, senses = parts
    return replay.collect(senses, robot, grid, LEFT_THEN_FORWARD, START, SEED,
                          NNQL(grid.n_places, N_ACTIONS), rules=episode.Rules(length=2))


def test_looking_over_its_shoulder_does_not_change_an_episode(parts, looks):
    _, grid, robot, senses = parts
    states = []
    record = episode.run(senses, robot, grid, LEFT_THEN_FORWARD, START[None], SEED, rules=episode.Rules(length=2),
                         watch=lambda step, **happened: states.append(happened["states"][0]))
    assert np.array_equal([look.states for look in looks], states)
    assert np.array_equal([look.pose for look in looks], record.poses[0])
    assert [look.answer for look in looks] == record.answers[0].tolist()
    assert [look.place for look in looks] == record.places[0].tolist()
    assert [look.pooled[look.place] for look in looks] == record.belief[0].tolist()
    assert [look.action for look in looks] == [None, *record.actions[0]]


def test_each_look_keeps_its_own_particles(looks):
    first, second, _ = (look.particles for look in looks)
    assert not np.array_equal(first[2], second[2])


def test_the_large_view_is_the_photograph_that_the_net_saw(parts):
    world, grid, robot, senses = parts
    witness = replay.Witness(world, senses.net, senses.gcn)
    witness.look(START[None], np.random.default_rng(3))
    small, large = witness.latest["view"][0][0], witness.latest["large"][0]
    averaged = np.array(Image.fromarray(large).resize((64, 64), Image.Resampling.BOX), float)
    assert abs(averaged.mean((0, 1)) - small.mean((0, 1))).max() < 2  # light and colour cast differ by much more


def test_a_frame_for_each_look_each_decision_and_some_between(parts, looks, tmp_path):
    world, grid, *_ = parts
    replay.save_gif(looks, world, grid, tmp_path / "episode.gif")
    assert [path.name for path in tmp_path.iterdir()] == ["episode.gif"]
    assert (tmp_path / "episode.gif").stat().st_size < 1.5e6
    with Image.open(tmp_path / "episode.gif") as film:
        assert film.size == (830, 566)  # a page on GitHub is 830 px wide: it makes no letter smaller
        assert film.n_frames == 3 + 2 + 2 * replay.N_MOTION
        assert film.info["loop"] == 0  # for ever
        assert film.info["duration"] == 1600
        page = np.array(film.convert("RGB"))
    for colour in (canvas.PAPER, draw.PALETTE[3], canvas.ROBOT, canvas.BELIEF):
        assert (page == colour).all(-1).any(), colour


def test_right_answers_are_green_and_wrong_ones_red(parts, looks):
    world, grid, *_ = parts
    pictures = [np.array(picture) for picture, seconds in replay.frames(looks[:1], world, grid)]
    dot = pictures[0][18:35, 804:821]
    right = looks[0].answer == looks[0].place
    assert (dot == (canvas.RIGHT if right else canvas.WRONG)).all(-1).sum() > 100
    assert (dot[4:12, 4:12] == canvas.PAPER).all(-1).any()  # a tick or a cross, for eyes that see no red


def test_no_letter_of_a_frame_is_smaller_than_eleven_pixels_or_cut_off(parts, looks, monkeypatch):
    _, grid, *_ = parts
    written, text = [], canvas.Canvas.text

    def note(page, at, words, size=12, colour=canvas.INK, anchor="lm", halo=None):
        left = at[0] - {"l": 0, "m": 0.5, "r": 1}[anchor[0]] * canvas.text_width(words, size)
        written.append((size, left, left + canvas.text_width(words, size) - page.width))
        text(page, at, words, size, colour, anchor, halo)

    monkeypatch.setattr(canvas.Canvas, "text", note)
    replay.frames(looks, parts[0], grid)
    smallest, left, _ = np.min(written, 0)
    assert smallest >= 11
    assert left >= 0
    assert max(beyond for *_, beyond in written) <= 0


def test_names_of_rooms_do_not_move_from_frame_to_frame(looks, monkeypatch):
    rooms = [{"type": "bedroom", "polygon": [[0, 0], [6, 0], [6, 4], [0, 4]]}]
    world, spots, text = World({**PLAN, "rooms": rooms}), set(), canvas.Canvas.text
    monkeypatch.setattr(canvas.Canvas, "text", lambda page, at, words, *how, **more: (
        spots.add(tuple(at)) if words == "bedroom" else None, text(page, at, words, *how, **more)))
    replay.frames(looks, world, PlaceGrid(world))
    assert len(spots) == 1


def test_a_tick_is_no_cross_and_what_is_to_come_is_neither():
    pages = []
    for known in ([True], [False], []):
        pages.append(canvas.Canvas(20, 20))
        replay._tick(pages[-1], (10, 10), *known)
    shapes = [(np.array(page.picture()) > 240).all(-1)[5:15, 5:15] for page in pages]  # white within the disc
    assert not (shapes[0] == shapes[1]).all()
    assert min(shapes[0].sum(), shapes[1].sum()) > 5
    assert shapes[2].sum() == 0


def test_an_episode_of_one_look_is_one_frame(parts):
    world, grid, robot, senses = parts
    looks = replay.collect(senses, robot, grid, planners.stay, START, SEED)
    assert len(looks) == len(replay.frames(looks, world, grid)) == 1
    assert replay.gif(replay.frames(looks, world, grid)).startswith(b"GIF89a")


def test_a_frame_shows_the_look_that_it_is_of(parts, looks, monkeypatch):
    drawn, words, page = {}, [], replay.Map(parts[0], 412, 412, parts[1])
    for name in ("particles", "place", "sight", "path", "robot"):
        monkeypatch.setattr(replay.Map, name, lambda _, what, *more, name=name: drawn.update({name: (what, *more)}))
    monkeypatch.setattr(canvas.Canvas, "text", lambda _, at, text, *how, **more: words.append(text))
    for wrong, verdict, colour in ((0, "right", canvas.RIGHT), (1, "wrong", canvas.WRONG)):
        look, pose = replace(looks[1], answer=looks[1].place + wrong), looks[1].pose + 0.1
        replay._frame(page, [], [looks[0], look, looks[2]], 1, pose, "turning left", 0)
        assert drawn["place"] == (look.answer, colour)
        assert drawn["particles"][0] is look.particles
        assert drawn["robot"][0] is drawn["sight"][0] is pose
        np.testing.assert_array_equal(drawn["path"][0], [looks[0].pose, look.pose, pose])
        assert {f"answer {verdict}", "look 2 of 3"} <= set(words)
        words.clear()


def test_between_two_looks_the_robot_goes_the_short_way_and_the_words_say_how(parts, looks, monkeypatch):
    shown = []
    monkeypatch.setattr(replay, "_frame", lambda _home, _panel, _looks, t, pose, *doing: shown.append((t, pose, doing)))
    first, second = (replace(looks[i], pose=np.array([3.0, 1, theta])) for i, theta in ((0, 3.0), (1, -3.0)))
    replay.frames([first, replace(second, bumped=True, action=1)], *parts[:2])
    assert [t for t, *_ in shown] == [0] * 5 + [1]
    ends = np.linspace(3.0, 2 * np.pi - 3.0, 5)  # across the bearing where angles begin anew
    assert [pose[2] % (2 * np.pi) for _, pose, _ in shown] == pytest.approx([3.0, *ends])
    assert [doing for *_, doing in shown] == [("at the start",), ("decides to turn right", 1),
                                              *[("turning right", 1)] * 3, ("after a bump",)]


@pytest.mark.parametrize("shift", [0, -0.5])
def test_beads_of_actions_lie_farther_right_for_more_and_the_chosen_one_is_orange(shift):
    def beads(chosen, *colours):
        picture = np.array(replay._actions(np.array([0.2, -0.1, 0.4]) + shift, chosen))[:, 60:350]
        lines = [picture[19 * a:19 * a + 19] for a in range(3)]
        return [np.nonzero((line == colour).all(2))[1].mean() for line, colour in zip(lines, colours, strict=True)]

    left, right, forward = beads(2, canvas.BAR, canvas.BAR, canvas.ROBOT)
    assert right < left < forward
    assert (left - right) / (forward - right) == pytest.approx(0.6, abs=0.02)
    assert beads(None, canvas.INK, canvas.INK, canvas.INK) == pytest.approx([left, right, forward], abs=1)


def test_beads_of_equal_actions_lie_below_each_other():
    picture = np.array(replay._actions(np.full(3, -0.2), None))[:, 60:350]
    assert len({np.nonzero((picture[19 * a:19 * a + 19] == canvas.INK).all(2))[1].mean() for a in range(3)}) == 1


def test_the_panels_are_of_the_look_and_ticks_of_the_answers_so_far(parts, looks, monkeypatch):
    ranked, ticks, valued = [], [], []
    monkeypatch.setattr(draw, "ranks", lambda _grid, values, *_: ranked.append(values) or Image.new("RGB", (9, 9)))
    monkeypatch.setattr(replay, "_tick", lambda _page, _at, *right: ticks.append(right))
    monkeypatch.setattr(replay, "_actions", lambda q, chosen: valued.append((q, chosen)) or Image.new("RGB", (9, 9)))
    film = [replace(look, answer=look.place + wrong) for look, wrong in zip(looks, (1, 0, 1), strict=True)]
    panel = replay._panels(film[1], parts[1])
    assert ranked[0] is film[1].states
    assert ranked[1] is film[1].pooled
    replay._frame(replay.Map(parts[0], 412, 412, parts[1]), panel, film, 1, film[1].pose, "", 2)
    assert ticks == [(False,), (True,), ()]
    assert valued == [(film[1].q, 2)]
