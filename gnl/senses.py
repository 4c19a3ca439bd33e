"""The senses: from poses to scores of places, by camera, segmentation net, scene graph and GCN, many robots at once.

    B robots side by side   K places
"""

import time
from dataclasses import dataclass, field

import numpy as np

from . import segnet
from .camera import render
from .scene_graph import join, scene_graph


@dataclass
class Senses:
    """Camera, net, graph and classifier of a home. Counts the views and the seconds of each stage."""

    world: object
    net: dict | None  # weights of the segmentation net; None: true labels
    gcn: object  # anything with scores(SceneGraphs) -> (B, K)
    noise: float = 1.0
    seconds: dict = field(default_factory=dict)
    views: int = 0

    def look(self, poses, rng, wanted=None):
        """What robots at `poses` (B, 3) see, as SceneGraphs; only of those `wanted`, (B,) bool, if given."""
        rgb, labels = self.timed("view", render, self.world, poses, rng, segnet.SIZE_PX, self.noise, wanted)
        if self.net is not None:
            labels = self.timed("labels", segnet.predict, self.net, rgb)
        self.views += len(rgb)
        return self.timed("graph", scene_graph, labels)

    def look_around(self, poses, rng, progress=None, at_once=128):
        """`look` for any number of poses, `at_once` at a time; progress(share done) after each."""
        parts = []
        for i in range(0, max(1, len(poses)), at_once):  # one look even if there are no poses
            parts.append(self.look(poses[i:i + at_once], rng))
            if progress:
                progress(min(1, (i + at_once) / max(1, len(poses))))
        return join(parts)

    def scores(self, poses, rng, wanted=None):
        """Scores of all places for the view from each pose: (B, 3) -> (B, K); only of the `wanted` poses, if given."""
        return self.timed("GCN", self.gcn.scores, self.look(poses, rng, wanted))

    def timed(self, stage, function, *args):
        """function(*args), its time added to that of `stage`."""
        start = time.perf_counter()
        result = function(*args)
        self.seconds[stage] = self.seconds.get(stage, 0.0) + time.perf_counter() - start
        return result


class SharedSenses:
    """Senses of planners that are tested from the same starts with the same luck.

    While two of them do the same, robot b of one sees the very view that robot b of the other saw. So its scores are
    remembered, and only what is new is looked at, and counted.
    """

    def __init__(self, senses):
        self.senses, self.timed = senses, senses.timed
        self._seen = {}  # (state of the appearance stream, robot, pose) -> scores, (K,)

    def scores(self, poses, rng):
        """Scores of all places for the view from each pose: (B, 3) -> (B, K)."""
        luck = rng.bit_generator.state["state"]["state"]
        keys = [(luck, b, pose.tobytes()) for b, pose in enumerate(poses)]
        new = np.array([key not in self._seen for key in keys])
        scores = self.senses.scores(poses, rng, new)  # draws the luck of all
        self._seen.update((keys[b], of_view) for b, of_view in zip(np.flatnonzero(new), scores, strict=True))
        return np.stack([self._seen[key] for key in keys])
