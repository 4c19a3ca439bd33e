"""Scene graphs of label images from elsewhere, printed and drawn: any picture of class indices, ours or ADE20K's.

A picture entirely in our colours is read by colour, not by index: a drawing program may have reordered its palette.
"""

from pathlib import Path

import numpy as np
from PIL import Image

from . import draw
from .classes import CLASSES, N_CLASSES, PALETTE, from_ade20k
from .scene_graph import VIEW_PX, scene_graph, unpack_words
from .terminal import count


def add_arguments(parser):
    """Options of `python -m gnl graph`."""
    parser.add_argument("labels", help=f"image with one class index per pixel, 0..{N_CLASSES - 1} in the order "
                                       f"{', '.join(CLASSES)}, or in the colours of our pictures")
    parser.add_argument("--ade20k", action="store_true", help="the indices are ADE20K's 0..150, 0 for no label")
    parser.add_argument("--out", help="picture to write, scaled to 512 x 512 as the boxes "
                                      "are (LABELS-graph.png beside the image)")


def run(args):
    """Print the graph, one node per line, and draw it over the labels."""
    labels, coloured = load(args.labels, args.ade20k)
    out = Path(args.out) if args.out else Path(args.labels).with_name(Path(args.labels).stem + "-graph.png")
    if out.suffix.lower() != ".png":
        raise ValueError(f"--out: expected a name that ends in .png, found {out}")
    if out.exists() and out.samefile(args.labels):
        raise ValueError(f"--out: expected a file other than the labels, found {out}")
    graph = scene_graph(labels)
    print(f"{args.labels}: {labels.shape[1]} x {labels.shape[0]} pixels{' read by their colours' if coloured else ''}, "
          f"{count(len(graph.words), 'node')}, {count(len(graph.edges), 'edge')}")
    classes = {CLASSES[label] for label, _, _ in unpack_words(graph.words)}
    if len(classes) == 1:
        print(f"every node is '{classes.pop()}': if that is not so, the indices are those of another list "
              + ("(gnl's own: without --ade20k; ADE20K's count from 1)" if args.ade20k else "(ADE20K's: --ade20k)"))
    for i, ((label, size, location), box) in enumerate(zip(unpack_words(graph.words), graph.boxes, strict=True)):
        neighbours = sorted({*graph.edges[graph.edges[:, 0] == i, 1], *graph.edges[graph.edges[:, 1] == i, 0]})
        print(f"{i:3}  {CLASSES[label]}, {draw.SIZES[size]}, {draw.LOCATIONS[location]}  word {graph.words[i]}  "
              f"box {' '.join(f'{v:.0f}' for v in box)}  next to {' '.join(map(str, neighbours)) or 'none'}")
    rows, columns = (np.arange(VIEW_PX) * n // VIEW_PX for n in labels.shape)
    draw.save_png(draw.graph(graph, draw.labels(labels[rows[:, None], columns], VIEW_PX)), out)
    print(f"drawn in {out}")


def load(path, ade20k=False):
    """Labels (H, W) in 0..9 of an image, and whether they were read by colour; ValueError if neither way works."""
    try:
        with Image.open(path) as image:
            image.load()
            n_frames = getattr(image, "n_frames", 1)
    except FileNotFoundError:
        raise ValueError(f"{path}: expected a label image, found nothing") from None
    except Exception as error:  # a damaged picture may fail in any of Pillow's layers
        raise ValueError(f"{path}: expected an image, found something else ({error})") from None
    if n_frames > 1:
        raise ValueError(f"{path}: expected one image, found {n_frames}")
    if image.format == "JPEG":
        raise ValueError(f"{path}: expected an image that keeps indices as they are, such as PNG, found JPEG")
    found = f"a picture of mode {image.mode}"
    if image.mode in ("RGB", "RGBA", "P") and not ade20k:
        labels = by_colour(np.array(image.convert("RGB")))
        if labels.max() < N_CLASSES:
            return labels, True
        found += f", {np.mean(labels == N_CLASSES):.1%} of it in other colours"
    if image.mode not in ("L", "P", "I", "I;16", "1"):
        raise ValueError(f"{path}: expected one class index a pixel, or the colours of classes.py and no others, "
                         f"found {found}")
    labels = np.array(image).astype(int)
    highest = 150 if ade20k else N_CLASSES - 1
    if labels.min() < 0 or labels.max() > highest:
        hint = "" if ade20k or labels.max() > 150 else "; --ade20k for indices of ADE20K"
        raise ValueError(f"{path}: expected indices 0..{highest}, found {labels.min()}..{labels.max()}{hint}")
    return from_ade20k(labels) if ade20k else labels, False


def by_colour(rgb):
    """Labels (H, W) of a picture (H, W, 3) in the colours of PALETTE; N_CLASSES where there is any other colour."""
    label_of = np.full(1 << 24, N_CLASSES, np.uint8)
    label_of[PALETTE @ (1 << np.array([16, 8, 0]))] = range(N_CLASSES)
    red, green, blue = np.moveaxis(rgb.astype(np.int32), -1, 0)
    return label_of[red << 16 | green << 8 | blue].astype(int)
