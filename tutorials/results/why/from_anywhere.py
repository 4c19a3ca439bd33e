"""How far does what NNQL learned carry? Two trainings in each of six cells, which differ in nothing but luck.

    python tutorials/results/why/from_anywhere.py

Prints a line for each cell. Of the first training: points ahead of MV from starts that it was trained on, from
anywhere, and from the tests of the cell (each ten times, averaged), always with new luck. In the tests:
how often an action undoes the one before, how often actions drawn at random in the same shares would, and how often
MV does. Of both: how often they choose alike in new views, and how often actions drawn at random would.
"""

import numpy as np
from cells_again import SIX, in_cells, run, undone

from gnl import episode, planners
from gnl.compare import paired_difference
from gnl.ranks import reciprocal_ranks
from gnl.robot import LEFT, N_ACTIONS, RIGHT

TIMES = 10


def measure(_i, task, starts):
    """The line of a cell."""
    (senses, *_), rng = task, np.random.default_rng(5)
    ours, again = (episode.train_nnql(*task, starts["training"], seed) for seed in (21, 22))
    n, line = min(TIMES * len(starts["tests"]), len(starts["training"])), ""  # n episodes from each of the three
    known, anywhere = rng.choice(starts["training"], n, False), senses.world.free_poses(n, rng)
    for poses, times in (known, 1), (anywhere, 1), (starts["tests"], TIMES):
        records = [episode.run_all(*task, plan, poses.repeat(times, 0), 7)
                   for plan in (planners.greedy(ours), planners.chance)]
        right, chance = (record.correct[:, -1].reshape(-1, times).mean(1) for record in records)
        mean, low, high = (100 * value for value in paired_difference(right, chance))
        line += f"  {mean:+5.1f} [{low:+5.1f}, {high:+5.1f}]"
    actions, by_chance = (record.actions for record in records)  # of the tests
    share = np.bincount(actions.ravel(), minlength=N_ACTIONS) / actions.size
    line += f"  {undone(actions):.0%} {2 * share[LEFT] * share[RIGHT]:.0%} {undone(by_chance):.0%}"
    states = reciprocal_ranks(senses.scores(anywhere, rng))
    one, two = (planners.best_actions(store.q_values(states), rng) for store in (ours, again))
    by_lot = np.bincount(one, minlength=N_ACTIONS) @ np.bincount(two, minlength=N_ACTIONS) / n ** 2
    return line + f"  {(one == two).mean():.0%} {by_lot:.0%}"


def main(cells=SIX, **where):
    """Measure the cells, and print."""
    lines = in_cells(measure, cells, **where)
    starts = "training starts", "anywhere", "tests"
    print(f"{'ahead of MV, from':<17}", *(f"{words:<20}" for words in starts), f"{'undone':<11}", "alike", sep="  ")
    for cell, line in zip(cells, lines, strict=True):
        print(f"{cell.name.rpartition('-seed')[0]:<17}{line}")


if __name__ == "__main__":
    run(main)
