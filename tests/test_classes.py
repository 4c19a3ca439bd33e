"""The ten words: their names, their colours to any eye, and ADE20K's indices in them."""

import csv
from pathlib import Path

import numpy as np
import pytest

from gnl.classes import BED, CLASSES, DOOR, N_CLASSES, OTHER, PALETTE, TV, class_of, from_ade20k

TABLE = Path(__file__).parents[2] / "shared" / "ade150_to_meta10.csv"  # of ADE20K's names, read strictly
KNOWN = {1: "wall", 4: "floor", 6: "ceiling", 8: "bed", 15: "door", 16: "table", 24: "sofa", 51: "refrigerator",
         90: "tv"}

# What an eye without one kind of cone makes of linear RGB (Machado, Oliveira and Fernandes 2009, severity 1).
EYES = {
    "all cones": np.eye(3),
    "no long": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "no medium": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "no short": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
RGB_TO_XYZ = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
                       [0.0193339, 0.1191920, 0.9503041]])
DISTINCT = 12  # CIELAB; 2 is just noticeable side by side


def test_the_classes_stand_in_the_order_of_the_paper():
    assert CLASSES == ("wall", "floor", "ceiling", "bed", "door", "table", "sofa", "refrigerator", "tv", "other")
    assert (BED, DOOR, TV, OTHER) == (3, 4, 8, 9)


def test_a_name_gives_its_class_however_it_is_written():
    for i, name in enumerate(CLASSES):
        assert class_of(name) == class_of(name.upper()) == class_of(f" {name.title()} ") == i


@pytest.mark.parametrize("name", ["chair", "", "beds", "tv stand", None])
def test_a_name_that_is_no_class_is_other(name):
    assert class_of(name) == OTHER


def test_ade20k_is_read_strictly():
    strict = KNOWN
    if TABLE.exists():
        with open(TABLE, newline="") as file:
            strict = {int(row["idx"]): row["meta_strict"] for row in csv.DictReader(file)}
        assert sorted(strict) == list(range(1, 151))
    expected = [class_of(strict.get(i, "other")) for i in range(151)]
    assert from_ade20k(np.arange(151)).tolist() == expected
    assert {i: CLASSES[c] for i, c in enumerate(expected) if c != OTHER} == KNOWN


def test_an_image_of_ade20k_keeps_its_shape():
    image = np.array([[[0, 8], [15, 90], [16, 150]]])
    assert np.array_equal(from_ade20k(image), [[[OTHER, BED], [DOOR, TV], [5, OTHER]]])


@pytest.mark.parametrize("label", [-1, 151, 255])
def test_an_index_that_ade20k_does_not_have_is_refused(label):
    with pytest.raises(ValueError, match=rf"labels: expected ADE20K's indices 0\.\.150, found .*{label}"):
        from_ade20k(np.array([[1, label]]))


def test_indices_that_are_no_whole_numbers_are_refused():
    with pytest.raises(ValueError, match="labels: expected whole numbers, found float64"):
        from_ade20k(np.array([[1.0, 8.0]]))


def lab(colours, eye):
    """CIELAB of sRGB colours (n, 3) in 0..255 as an eye sees them."""
    c = colours / 255
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4) @ np.transpose(EYES[eye])
    t = linear.clip(0, 1) @ RGB_TO_XYZ.T / RGB_TO_XYZ.sum(1)
    x, y, z = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29).T
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], 1)


@pytest.mark.parametrize("eye", EYES)
def test_any_two_classes_differ_in_colour_to_any_eye(eye):
    assert PALETTE.shape == (N_CLASSES, 3)
    seen = lab(PALETTE, eye)
    close = {(CLASSES[i], CLASSES[j]): round(float(np.linalg.norm(seen[i] - seen[j])), 1)
             for i in range(N_CLASSES) for j in range(i)}
    assert {pair: d for pair, d in close.items() if d < DISTINCT} == {}
