"""What made Ours+? Ours+ beside other forms of itself, in six cells, from the tests and from anywhere.

    python tutorials/results/why/ours_plus.py

Prints by how much each plan is ahead of Scan and of Ours+, and how often an action undoes the one before.

    Ours, drawn    NNQL whose means are drawn towards those of step and last action (open_points.md)
    anew           Ours+ that decides anew after every look
    belief         learns from the belief in the true place instead of 1 / rank of the true place in the new view
    +1 and -1      learns from right and wrong
    4 neighbours   asks 4 instead of 100
    pairs          ignores NNQL's steps: from 3000 training starts, with the same luck, each action is done in every
                   step, and its worth is the final belief in the true place
"""

import numpy as np
from cells_again import SIX, in_cells, run, undone

from gnl import episode, options, planners
from gnl.choices import with_context
from gnl.compare import in_points, paired_difference
from gnl.episode import LENGTH
from gnl.experiment import RACE_STARTS
from gnl.other_stores import Shrunk
from gnl.robot import N_ACTIONS

TIMES = 10  # runs from each start of the tests; their mean counts


class By(options.Experience):
    """Steps with another reward."""

    def __init__(self, reward):
        super().__init__()
        self.reward = reward

    def watch(self, step, **look):
        """Remember a look, and its other reward."""
        before = len(self.rewards)
        super().watch(step, **look)
        if len(self.rewards) > before:
            self.rewards[-1] = self.reward(look)


class InPairs:
    """Each action in every step, from the same starts with the same luck."""

    def __init__(self, task, starts, seed):
        worth = []
        for action in range(N_ACTIONS):
            first = []  # views, the same for every action

            def watch(step, states, first=first, **_):
                if step == 0:
                    first.append(states)

            record = episode.run_all(*task, planners.scan([action] * LENGTH), starts, seed, watch=watch)
            worth.append(record.belief[:, -1])
        self.first, self.worth = np.concatenate(first), np.stack(worth, 1)

    def q_values(self, states):
        """Mean worth over the nearest first views: (B, K) -> (B, A)."""
        return self.worth[options.nearest(states, self.first, options.K_NEIGHBOURS)].mean(1)


def measure(i, task, starts):
    """From the tests and from anywhere: for each plan the share right from each pose, and the share undone."""
    (senses, _, grid), rng = task, np.random.default_rng((5, i))
    lived = options.Experience(), By(lambda look: look["belief"]), By(lambda look: np.where(look["right"], 1.0, -1.0))

    def watch(*args, **look):
        for one in lived:
            one.watch(*args, **look)

    training = starts["training"]
    ours = episode.train_nnql(*task, training, seed=21, watch=watch)
    drawn, rules = Shrunk(grid.n_places, N_ACTIONS, pull=64), episode.Rules(state=with_context)
    episode.train_nnql(*task, training, 21, rules, store=drawn)
    race = episode.race(*task, training[:RACE_STARTS], 22)
    plus, of_belief, of_answers = (options.Options(one, *race) for one in lived)
    forms = {"Ours+": plus, "belief": of_belief, "+1 and -1": of_answers,
             "4 neighbours": options.Options(lived[0], *race, k=4), "pairs": InPairs(task, training[:3000], 23)}
    plans = {"MV": planners.chance, "Ours": planners.greedy(ours), "Ours, drawn": planners.greedy(drawn),
             "Scan": planners.scan(race[0][0]), "anew": planners.greedy(plus),
             **{name: planners.go_on(planners.greedy(form)) for name, form in forms.items()}}
    found = []
    anywhere = senses.world.free_poses(20 * len(starts["tests"]), rng)
    for poses, times in (starts["tests"], TIMES), (anywhere, 1):
        of_plans = {}
        for name, plan in plans.items():
            record = episode.run_all(*task, plan, poses.repeat(times, 0), 7,
                                     rules=rules if name == "Ours, drawn" else None)
            of_plans[name] = record.correct[:, -1].reshape(-1, times).mean(1), undone(record.actions)
        found.append(of_plans)
    return found


def main(cells=SIX, **where):
    """Measure the cells, and print."""
    for poses, found in zip(("tests", "anywhere"), zip(*in_cells(measure, cells, **where), strict=True), strict=True):
        print(f"{poses:<14}{'ahead of Scan':<22}{'ahead of Ours+':<22}undone")
        right = {name: np.concatenate([of_cell[name][0] for of_cell in found]) for name in found[0]}
        for name in right:
            beside = [f"{in_points(*paired_difference(right[name], right[other])):<22}" for other in ("Scan", "Ours+")]
            print(f"{name:<14}{''.join(beside)}{np.mean([of_cell[name][1] for of_cell in found]):.0%}")


if __name__ == "__main__":
    run(main)
