"""The robot: a disc that turns, goes forward and stops where it touches something.

Contact is found by pymunk's own swept query: how far a point gets along a line among obstacles grown by the robot's
radius, which is how far a disc gets among the obstacles themselves.

    action 0 turn left, 1 turn right, 2 forward
    pose (x [m], y [m], theta [rad]);  odometry (forward [m], turn [rad]): what the wheels report
"""

from dataclasses import dataclass

import numpy as np
import pymunk

from .places import check_poses, wrap_angle
from .world import ROBOT_RADIUS_M

ACTIONS = ("left", "right", "forward")  # CHOICE: turns both ways; the paper says "rotating r or forward f motions"
LEFT, RIGHT, FORWARD = range(len(ACTIONS))
N_ACTIONS = len(ACTIONS)
SKIN_M = 1e-3  # a robot at rest keeps this from what stopped it, or the next query would start in contact


@dataclass(frozen=True)
class Motion:
    """How the robot moves; the noise is that of its odometry."""

    turn_rad: float = np.pi / 6  # CHOICE: 30 degrees, one bearing bin a turn
    forward_m: float = 0.5  # CHOICE: 0.5 m: Habitat's 0.25 m hardly leaves a 2 m cell in four steps
    std_m: float = 0.03  # CHOICE: 3 cm and 0.03 rad; the paper names no motion noise
    std_rad: float = 0.03


class Robot:
    """A home's obstacles in a pymunk space, and a body that is put where a robot is, one robot after the other."""

    def __init__(self, world, motion=None, radius_m=ROBOT_RADIUS_M):
        self.motion = motion or Motion()
        self.space, self.body = pymunk.Space(), pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        for (x, y), (a, b), angle in zip(world.centre[world.blocks], world.half[world.blocks],
                                         world.angle[world.blocks], strict=True):
            placed = pymunk.Transform(np.cos(angle), np.sin(angle), -np.sin(angle), np.cos(angle), x, y)
            corners = [(a, b), (-a, b), (-a, -b), (a, -b)]
            # The shapes are thick, not the query: pymunk leaves out every shape whose bounds the bare line misses.
            self.space.add(pymunk.Poly(self.space.static_body, corners, placed, radius_m))

    def step(self, poses, actions, rng):
        """Act once with each robot: poses (B, 3), actions (B,) -> poses (B, 3), odometry (B, 2), bumped (B,) bool.

        Each robot moves exactly as asked or until it touches; odometry errs by `motion.std_m` and `std_rad`.
        """
        poses, m = check_poses(poses).reshape(-1, 3).copy(), self.motion
        actions = check_actions(actions, len(poses))
        turn = np.choose(actions, [m.turn_rad, -m.turn_rad, 0.0])
        forward = np.where(actions == FORWARD, m.forward_m, 0.0)
        bumped = np.zeros(len(poses), bool)
        for i in np.flatnonzero(actions == FORWARD):
            forward[i], bumped[i] = self.advance(poses[i], m.forward_m)
        poses[:, 0] += forward * np.cos(poses[:, 2])
        poses[:, 1] += forward * np.sin(poses[:, 2])
        poses[:, 2] = wrap_angle(poses[:, 2] + turn)
        noise = rng.standard_normal((len(poses), 2)) * [m.std_m, m.std_rad]
        return poses, np.stack([forward, turn], 1) + noise, bumped

    def advance(self, pose, distance_m):
        """How far a disc at `pose` gets straight ahead, at most `distance_m`, and whether something stopped it."""
        x, y, theta = pose
        self.body.position, self.body.angle = (x, y), theta
        reach = distance_m + SKIN_M
        target = self.body.local_to_world((reach, 0))
        hit = self.space.segment_query_first(self.body.position, target, 0, pymunk.ShapeFilter())
        if hit is None:
            return distance_m, False
        return max(0.0, hit.alpha * reach - SKIN_M), True


def check_actions(actions, n, n_actions=N_ACTIONS):
    """The actions as ints (n,); ValueError unless they are n whole numbers 0 .. n_actions - 1."""
    actions = np.asarray(actions)
    if actions.shape != (n,) or not np.isin(actions, range(n_actions)).all():
        raise ValueError(f"actions: expected {n} whole numbers 0..{n_actions - 1}, "
                         f"found {np.atleast_1d(actions)[:9]} of shape {actions.shape}")
    return actions.astype(int)
