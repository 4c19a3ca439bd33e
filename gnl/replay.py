"""A replay: one episode as an animated picture that explains itself.

On the left the home with the robot and its way (orange), the particles of its filter (violet) and the filter's
answer: a cell and a bearing, green if right, red if wrong. On the right what the robot sees, what it makes of it,
and what its planner thinks of each action. A frame for each look, one for each decision, some for the way between.
"""

import copy
import io
from dataclasses import dataclass, field

import numpy as np
from PIL import Image

from . import draw
from .camera import render
from .canvas import BAR, BELIEF, FAINT, INK, LINE_PX, PAPER, QUIET, RIGHT, ROBOT, TINTS, WRONG, Canvas
from .classes import PALETTE
from .episode import run
from .files import write_whole
from .floor_map import Map
from .places import wrap_angle
from .robot import ACTIONS
from .senses import Senses

WIDTH_PX, HEIGHT_PX, MAP_PX, VIEW_PX, GAP_PX = 830, 566, (412, 412), 192, 10  # GitHub's pages are 830 wide
KEY = {"robot": "robot", "sight": "its view", "particles": "particles", "right": "answer, right", "wrong": "or wrong"}
LOOK_S, MOTION_S, LAST_S, N_MOTION = 1.6, 0.12, 3.2, 3
DECIDE, DOING = ("turn left", "turn right", "go forward"), ("turning left", "turning right", "going forward")


@dataclass(frozen=True)
class Look:
    """All that one look of an episode shows."""

    pose: np.ndarray  # (3,) true pose
    place: int  # true place
    answer: int  # place that the filter names
    pooled: np.ndarray  # (K,) its belief
    particles: tuple  # x, y, theta, weight, (M,) each
    states: np.ndarray  # (K,) reciprocal ranks of this view
    view: np.ndarray  # (192, 192, 3) what the camera sees
    labels: np.ndarray  # (64, 64) what the net makes of it
    graph: object  # SceneGraphs of this view
    q: np.ndarray | None  # (A,) values of the next actions, if known
    action: int | None  # that led here; None at the start
    bumped: bool  # whether something stopped it


@dataclass
class Witness(Senses):
    """Senses that remember what each stage made of the latest look, and a large version of the photograph."""

    latest: dict = field(default_factory=dict)

    def timed(self, stage, function, *args):
        """function(*args), remembered."""
        if stage == "view":  # light and exposure are drawn before the pixels: the large photograph is the same
            world, poses, rng, _, noise, _ = args
            self.latest["large"] = render(world, poses, copy.deepcopy(rng), VIEW_PX, noise)[0]
        self.latest[stage] = function(*args)
        return self.latest[stage]


def collect(senses, robot, grid, plan, start_pose, seed, nnql=None, rules=None):
    """Run one episode and keep what each look shows: list of Look; arguments as for episode.run."""
    witness, looks = Witness(senses.world, senses.net, senses.gcn, senses.noise), []

    def watch(step, poses, states, pooled, filter, **_):
        seen = witness.latest
        particles = tuple(a[0].copy() for a in (filter.x, filter.y, filter.theta, filter.weight))
        looks.append(Look(
            pose=poses[0].copy(), place=int(grid.place_of(poses)[0]), answer=int(pooled[0].argmax()), pooled=pooled[0],
            particles=particles, states=states[0], view=seen["large"][0],
            labels=seen.get("labels", seen["view"][1])[0], graph=seen["graph"],
            q=nnql.q_values(states)[0] if nnql else None, action=int(seen["plan"][0]) if step else None,
            bumped=bool(step and seen["robot"][2][0])))

    run(witness, robot, grid, plan, start_pose[None], seed, rules, watch)
    return looks


def frames(looks, world, grid):
    """Pictures of an episode and how long to show each: list of (PIL.Image, seconds)."""
    home = Map(world, *MAP_PX, grid)
    whole = home.copy()
    whole.path([look.pose for look in looks])
    for look in looks:
        whole.place(look.answer, RIGHT)
    whole.names()
    home.named = whole.named  # the same in all frames: where the robot never comes
    panels = [_panels(look, grid) for look in looks]
    shown = []
    for t, (look, panel) in enumerate(zip(looks, panels, strict=True)):
        after = "at the start" if not t else "after a bump" if look.bumped else f"after {DOING[look.action]}"
        shown.append((_frame(home, panel, looks, t, look.pose, after), LOOK_S if look is not looks[-1] else LAST_S))
        if look is looks[-1]:
            break
        action = looks[t + 1].action
        shown.append((_frame(home, panel, looks, t, look.pose, f"decides to {DECIDE[action]}", action), LOOK_S))
        for share in np.arange(1, N_MOTION + 1) / (N_MOTION + 1):
            way = looks[t + 1].pose - look.pose
            way[2] = wrap_angle(way[2])
            shown.append((_frame(home, panel, looks, t, look.pose + share * way, DOING[action], action), MOTION_S))
    return shown


def gif(shown):
    """Frames as an animated GIF that loops for ever, all in one palette: bytes."""
    stills = [picture for picture, seconds in shown if seconds != MOTION_S]
    wall = Image.new("RGB", (stills[0].width, stills[0].height * len(stills)))
    for i, picture in enumerate(stills):
        wall.paste(picture, (0, i * picture.height))
    # The colours that mean something stay as they are: no other one may be near them.
    pale = (PALETTE + 255.0) / 2  # labels under a graph
    clouds = PAPER + np.linspace(0.2, 1, 9)[:, None] * np.subtract(BELIEF, PAPER)  # particles, few to many
    exact = np.array([*PALETTE, *pale, *clouds, *TINTS, PAPER, INK, QUIET, FAINT, ROBOT, RIGHT, WRONG])
    others = np.array(wall.quantize(256 - len(exact)).getpalette()).reshape(-1, 3)
    others = others[abs(others[:, None] - exact).max(2).min(1) > 8]
    palette = Image.new("P", (1, 1))
    palette.putpalette(np.vstack([exact, others]).astype(np.uint8).tobytes())
    flat = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture, _ in shown]
    data = io.BytesIO()
    flat[0].save(data, "GIF", save_all=True, append_images=flat[1:], loop=0, optimize=False,
                 duration=[round(1000 * seconds) for _, seconds in shown])
    return data.getvalue()


def save_gif(looks, world, grid, path):
    """Write the replay of an episode, whole or not at all."""
    write_whole(path, gif(frames(looks, world, grid)))


def _panels(look, grid):
    """What a look shows and says, in pictures: view, graph on labels, ranks, belief."""
    return (draw.view(look.view, VIEW_PX), draw.graph(look.graph, draw.labels(look.labels, VIEW_PX), full=False),
            draw.ranks(grid, look.states, look.place, 6, VIEW_PX),
            draw.ranks(grid, look.pooled, look.place, 6, VIEW_PX, ("rank", "place", "belief")))


def _frame(home, panel, looks, t, pose, doing, action=None):
    """One picture: look t, the robot at `pose`; `action` is the one that the planner has chosen, if it has."""
    page, look, right = Canvas(WIDTH_PX, HEIGHT_PX), looks[t], looks[t].answer == looks[t].place
    verdict = RIGHT if right else WRONG
    home = home.copy()
    home.particles(look.particles)
    home.place(look.answer, verdict)
    home.sight(pose)
    home.path([*(earlier.pose for earlier in looks[:t + 1]), pose])
    home.robot(pose)
    page.paste(home.picture(), 4, 44)
    page.text((24, 478), f"answer {'right' if right else 'wrong'}", 16, verdict)
    page.text((140, 479), f"belief in the true place (green) {look.pooled[look.place]:.2f}", 13)
    page.paste(draw.legend([], KEY), 24, 506)
    page.paste(draw.legend(), 24, 534)

    page.text((24, 26), f"look {t + 1} of {len(looks)}", 20)
    page.text((142, 27), doing, 15, ROBOT)
    x0, x1 = WIDTH_PX - 2 * VIEW_PX - 2 * GAP_PX, WIDTH_PX - VIEW_PX - GAP_PX
    parts = [("the robot sees", x0, 72), ("it recognises", x1, 72), ("this view says", x0, 300),
             ("the filter believes", x1, 300), ("value of next action: the greatest is chosen", x0, 470)]
    pictures = panel if look is looks[-1] else [*panel, _actions(look.q, action)]
    for (title, x, y), picture in zip(parts, pictures, strict=False):
        page.text((x, y - 13), title, 13)
        page.paste(picture, x, y)
    ends = WIDTH_PX - GAP_PX - 8 - 22 * np.arange(len(looks))[::-1]
    page.text((ends[0] - 16, 27), "answers", 13, anchor="rm")
    for i, (other, x) in enumerate(zip(looks, ends, strict=True)):  # as they were so far
        _tick(page, (x, 26), *([other.answer == other.place] if i <= t else []))
    return page.picture()


def _tick(page, at, right=None):
    """A disc with a tick for a right answer or a cross for a wrong one; pale if there is none yet."""
    lines = {True: [[(-4, 0), (-1, 3), (4, -3)]], False: [[(-3, -3), (3, 3)], [(-3, 3), (3, -3)]], None: []}[right]
    page.disc(at, 8, {True: RIGHT, False: WRONG, None: FAINT}[right])
    for points in lines:
        page.line(np.add(points, at), PAPER, 2)


def _actions(q, chosen, width_px=2 * VIEW_PX + GAP_PX):
    """The values of the actions (A,), if known, as beads on one scale, the best farthest right; the chosen one orange.

    Bars would mislead: where all values are below zero, the best has the shortest.
    """
    left, right = 70, width_px - 54
    page = Canvas(width_px, LINE_PX * len(ACTIONS))
    for a, name in enumerate(ACTIONS):
        y, ink = LINE_PX * a + 9, ROBOT if a == chosen else INK
        page.text((0, y), name, 12, ink)
        if q is not None:
            page.line([(left, y), (right, y)], FAINT, 2)
            x = left + (right - left) * (q[a] - min(q)) / max(max(q) - min(q), 1e-9)
            page.disc((x, y), 6, ink if chosen is None or a == chosen else BAR)
            page.text((width_px, y), f"{q[a]:+.2f}", 11, ink, "rm")
    return page.picture()
