"""Plausible wrong answers to the exercises of chapter 12."""

import copy

import numpy as np

from gnl.classes import from_ade20k


def box(kind, x, y, w, d, height):
    return {"class": kind, "polygon": [[x, y], [x + w, y], [x + w, y + d], [x, y + d]], "height": height}


def into_the_old_list(plan, kind, x, y, width, depth, height):
    new = dict(plan)
    new.setdefault("objects", []).append(box(kind, x, y, width, depth, height))
    return new


def turned(plan, kind, x, y, width, depth, height):
    return {**plan, "objects": [*plan.get("objects", []), box(kind, x, y, depth, width, height)]}


def about_the_middle(plan, kind, x, y, width, depth, height):
    thing = box(kind, x - width / 2, y - depth / 2, width, depth, height)
    return {**plan, "objects": [*plan.get("objects", []), thing]}


def crossed(plan, kind, x, y, width, depth, height):
    thing = box(kind, x, y, width, depth, height)
    thing["polygon"][2:] = thing["polygon"][:1:-1]
    return {**plan, "objects": [*plan.get("objects", []), thing]}


def drawn_every_step():
    return lambda _step, states, rng: rng.integers(2, size=len(states))


def with_forward():
    kept = None

    def plan(step, states, rng):
        nonlocal kept
        kept = rng.integers(3, size=len(states)) if step == 0 else kept
        return kept
    return plan


def once_and_for_all():
    kept = None

    def plan(_step, states, rng):
        nonlocal kept
        kept = rng.integers(2, size=len(states)) if kept is None else kept
        return kept
    return plan


def one_for_all():
    kept = None

    def plan(step, states, rng):
        nonlocal kept
        kept = np.full(len(states), rng.integers(2)) if step == 0 else kept
        return kept
    return plan


def of_all(counts, unseen=0.1):
    smooth = counts + unseen
    return np.log(smooth / smooth.sum())


def no_smoothing(counts, unseen=0.1):
    with np.errstate(all="ignore"):
        return np.log(counts / counts.sum(1, keepdims=True))


def smoothed_above_alone(counts, unseen=0.1):
    with np.errstate(all="ignore"):
        return np.log((counts + unseen) / counts.sum(1, keepdims=True))


def not_shifted(labels):
    labels = np.asarray(labels).astype(int)
    return from_ade20k(np.where(labels == 255, 0, labels))


def beyond_the_table(labels):
    return from_ade20k(np.asarray(labels).astype(int) + 1)


def none_is_wall(labels):
    labels = np.asarray(labels).astype(int)
    return from_ade20k(np.where(labels == 255, 0, labels) + 1)


def a_list_for_the_old_plan(plan, kind, x, y, width, depth, height):
    plan.setdefault("objects", [])
    new = copy.deepcopy(plan)
    corners = [[x, y], [x + width, y], [x + width, y + depth], [x, y + depth]]
    new["objects"].append({"class": kind, "polygon": corners, "height": height})
    return new


def luck_of_its_own():
    own, kept = np.random.default_rng(), {}

    def plan(step, states, _rng):
        if step == 0:
            kept["drawn"] = own.integers(2, size=len(states))
        return kept["drawn"]
    return plan


def remembered_by_all(kept={}):  # noqa: B006 (that is the mistake)
    def plan(step, states, rng):
        if step == 0:
            kept["drawn"] = rng.integers(2, size=len(states))
        return kept["drawn"]
    return plan


WRONG = {"12.1": [into_the_old_list, turned, about_the_middle, crossed, a_list_for_the_old_plan],
         "12.2": [drawn_every_step, with_forward, once_and_for_all, one_for_all, luck_of_its_own, remembered_by_all],
         "12.3": [of_all, no_smoothing, smoothed_above_alone], "12.4": [not_shifted, beyond_the_table, none_is_wall]}
