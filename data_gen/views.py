"""Training views for the segmentation net: what a robot sees in many homes, and the true labels.

The paper takes a net "off the shelf", trained on other images than those of its worlds. So the homes here are not
those in which a robot is localized: seeds from 0 on, where the worlds have 800 and more.
"""

from pathlib import Path

import numpy as np

from gnl.camera import render
from gnl.classes import N_CLASSES
from gnl.files import check_file, load_arrays, save_arrays
from gnl.learned import digest, digest_of_code
from gnl.paper import WORLDS
from gnl.photo import check_noise
from gnl.segnet import SIZE_PX
from gnl.terminal import Stage

from .rooms import make_home

# DIFFERS: the net learns from homes of the same kind as those where it is used; the paper's from photographs (ADE20K).
LEAST_KINDS, LEAST_SHARE = 3, 0.01  # CHOICE: a view with fewer kinds of things, a bare wall mostly, teaches little

MODULES = "box", "furnish", "furniture", "layout", "rooms", "views"  # modules that decide what there is to see


def add_arguments(parser):
    """Options of `python -m data_gen views`."""
    parser.add_argument("out", help="file of arrays to write (.npz)")
    parser.add_argument("--homes", type=int, default=40, help="homes with the seeds 0, 1, ... (40)")
    parser.add_argument("--views", type=int, default=2400, help="views in all (2400)")
    parser.add_argument("--seed", type=int, default=0, help="seed of poses and noise (0)")
    parser.add_argument("--noise", type=float, default=1.0, help="appearance noise (1)")
    parser.add_argument("--kinds", type=int, default=LEAST_KINDS, help=f"fewest classes in a view ({LEAST_KINDS})")


def run(args):
    """Views of many homes and their true labels, unless the file has just these already."""
    made_by = {"homes": args.homes, "views": args.views, "seed": args.seed, "noise": args.noise, "kinds": args.kinds,
               "code": digest([digest_of_code(), digest_of_code(Path(__file__).parent, MODULES)])}
    check_file("out", args.out)
    if Path(args.out).exists():
        there = load_arrays(args.out)[1]
        if there == made_by:
            return
        if not isinstance(there, dict) or not {"homes", "views"} <= there.keys():
            raise ValueError(f"{args.out}: expected views or nothing, found a file made by {there}")
    stage = Stage("homes")
    rgb, labels = training_views(args.homes, args.views, args.seed, args.noise, args.kinds, stage)
    save_arrays(args.out, made_by, rgb=rgb, labels=labels)
    stage.done(f"{args.homes} furnished homes drawn, {args.views} views rendered to learn from")


def training_views(n_homes, n_views, seed, noise=1.0, n_kinds=LEAST_KINDS, progress=None):
    """Views at random free poses, evenly from homes 0 .. n_homes - 1; n_kinds classes or more fill at least 1 % each.

    returns : rgb (n_views, 64, 64, 3) uint8, labels (n_views, 64, 64) uint8;  progress(share done)
    """
    if not 1 <= n_homes <= WORLDS[0]:
        raise ValueError(f"homes: expected 1..{WORLDS[0]}, found {n_homes}")
    if n_views < 1:
        raise ValueError(f"views: expected at least 1, found {n_views}")
    if seed < 0:
        raise ValueError(f"seed: expected at least 0, found {seed}")
    if not 1 <= n_kinds <= LEAST_KINDS:  # views of more kinds may be too rare to find
        raise ValueError(f"kinds: expected 1..{LEAST_KINDS}, found {n_kinds}")
    check_noise(noise)
    rng, rgb, labels = np.random.default_rng(seed), [], []
    for home in range(n_homes):
        wanted = n_views * (home + 1) // n_homes - n_views * home // n_homes
        world, found = make_home(home), 0
        while found < wanted:
            image, label = render(world, world.free_poses(2 * wanted, rng), rng, SIZE_PX, noise)
            seen = (label.reshape(len(label), -1, 1) == np.arange(N_CLASSES)).sum(1) >= LEAST_SHARE * SIZE_PX ** 2
            good = np.flatnonzero(seen.sum(1) >= n_kinds)[:wanted - found]
            rgb.append(image[good])
            labels.append(label[good])
            found += len(good)
        if progress:
            progress((home + 1) / n_homes)
    return np.concatenate(rgb), np.concatenate(labels)
