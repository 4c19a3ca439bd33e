"""The command line: help, the graph of a label image worked by hand, and one clear line for every mistake."""

import struct
import subprocess
import sys
import zlib

import numpy as np
import pytest
from PIL import Image

from gnl.__main__ import main
from gnl.classes import PALETTE

# A bed at the left and a tv at the lower right before a wall; too small a lamp.
LABELS = np.zeros((512, 512), np.uint8)
LABELS[100:300, 48:248] = 3
LABELS[320:400, 332:432] = 8
LABELS[10:60, 400:480] = 9
ADE20K = np.array([1, 4, 6, 8, 15, 16, 24, 51, 90, 150], np.uint8)

# word = (class * 3 + size) * 9 + location. The bed's box, 40,000 px, is more than a 16th of the image, 16,384 px, and
# less than 6 of these; its middle (148, 200) lies in the first column and the second row of 3 x 3.
NODES = """\
  0  wall, large, centre  word 22  box 0 0 512 512  next to 1 2
  1  bed, medium, left  word 93  box 48 100 248 300  next to 0
  2  tv, small, lower right  word 224  box 332 320 432 400  next to 0
"""


def run(*arguments):
    """Exit status of `python -m gnl`."""
    with pytest.raises(SystemExit) as exit:
        main([str(argument) for argument in arguments])
    return exit.value.code


def write(path, labels=LABELS, palette=False):
    image = Image.fromarray(labels)
    if palette:
        image.putpalette(np.resize(PALETTE, (256, 3)).ravel().tolist())
        assert image.mode == "P"
    image.save(path)
    return path


def test_the_module_runs_as_a_program():
    finished = subprocess.run([sys.executable, "-W", "error", "-m", "gnl", "--help"], capture_output=True, text=True)
    assert finished.returncode == 0
    assert "demo" in finished.stdout
    assert "graph" in finished.stdout
    assert finished.stderr == ""


def test_a_command_does_not_wait_for_what_others_import():
    code = "import atexit, sys; atexit.register(lambda: print(*sys.modules)); from gnl.__main__ import main; main()"
    there = subprocess.run([sys.executable, "-c", code, "graph", "--help"], capture_output=True, text=True).stdout
    assert "gnl.draw_graph" in there.split()
    assert "gnl.table" not in there.split()


@pytest.mark.parametrize("command", ["demo", "graph"])
def test_each_command_has_help(capsys, command):
    assert run(command, "--help") == 0
    assert capsys.readouterr().out.startswith(f"usage: python -m gnl {command}")


@pytest.mark.parametrize("line", ["", "dance", "graph", "demo", "graph a.png --loose", "demo --tests many",
                                  "table --quic", "table --ou there"])
def test_what_is_no_command_has_status_2(capsys, line):
    assert run(*line.split()) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("python -m gnl")
    assert err.endswith(" (see --help)\n")
    assert err.count("\n") == 1


def test_an_image_that_blurs_indices_is_refused(tmp_path, capsys):
    path = tmp_path / "view.jpg"
    Image.fromarray(LABELS).save(path)
    assert run("graph", path) == 2
    assert capsys.readouterr().err == (f"python -m gnl: {path}: expected an image that keeps indices as they are, "
                                       "such as PNG, found JPEG\n")


def test_an_image_that_is_damaged_where_pillow_does_not_look_is_refused(tmp_path, capsys):
    path = tmp_path / "view.tif"
    Image.new("L", (20, 20)).save(path)
    damaged = bytearray(path.read_bytes())
    tags = int.from_bytes(damaged[4:8], "little")  # where their number stands, then they themselves, 12 bytes each
    n_tags = int.from_bytes(damaged[tags:tags + 2], "little")
    damaged[tags + 2 + 12 * n_tags + 1] = 0xb5  # another image should follow there
    path.write_bytes(damaged)
    assert run("graph", path) == 2
    assert capsys.readouterr().err.startswith(f"python -m gnl: {path}: expected an image, found something else (")


def test_the_graph_of_a_label_image_is_printed_and_drawn(tmp_path, capsys):
    path, picture = write(tmp_path / "view.png"), tmp_path / "view-graph.png"
    assert run("graph", path) == 0
    out, err = capsys.readouterr()
    assert out == f"{path}: 512 x 512 pixels, 3 nodes, 2 edges\n{NODES}drawn in {picture}\n"
    assert err == ""
    with Image.open(picture) as image:
        drawn = np.array(image.convert("RGB"))
    assert drawn.shape == (512, 512, 3)
    assert len(np.unique(drawn.reshape(-1, 3), axis=0)) > 10  # boxes, edges and words, not the labels alone


def of_ade20k(path):
    write(path, ADE20K[LABELS])
    return ["--ade20k"]


def with_palette(path):
    write(path, palette=True)
    return []


def with_palette_of_ade20k(path):
    write(path, ADE20K[LABELS], palette=True)
    return ["--ade20k"]


def of_16_bits(path):
    write(path, LABELS.astype(np.uint16))
    return []


def of_other_size(path):
    write(path, LABELS[::2, ::4])
    return []


@pytest.mark.parametrize("make", [of_ade20k, with_palette, with_palette_of_ade20k, of_16_bits, of_other_size],
                         ids=lambda make: make.__name__)
def test_the_same_labels_in_another_form_make_the_same_graph(tmp_path, capsys, make):
    path = tmp_path / "view.png"
    options = make(path)
    assert run("graph", path, *options) == 0
    assert NODES in capsys.readouterr().out


def test_the_picture_goes_where_it_is_told_to(tmp_path):
    path = write(tmp_path / "view.png")
    assert run("graph", path, "--out", tmp_path / "new" / "picture.png") == 0
    with Image.open(tmp_path / "new" / "picture.png") as image:
        assert image.size == (512, 512)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["new", "view.png"]


def test_a_view_without_a_region_has_an_empty_graph(tmp_path, capsys):
    crumbs = np.add.outer(np.arange(512), np.arange(512)).astype(np.uint8) % 2
    assert run("graph", write(tmp_path / "view.png", crumbs)) == 0
    out = capsys.readouterr().out
    assert "512 x 512 pixels, 0 nodes, 0 edges\n" in out
    assert len(out.splitlines()) == 2


@pytest.mark.parametrize(("label", "name"), [(0, "wall"), (9, "other")])
def test_a_graph_of_one_class_says_that_the_indices_may_be_those_of_another_list(tmp_path, capsys, label, name):
    assert run("graph", write(tmp_path / "view.png", np.full((64, 64), label, np.uint8))) == 0
    first, second, *_ = capsys.readouterr().out.splitlines()
    assert first.endswith("64 x 64 pixels, 1 node, 0 edges")
    assert f"'{name}'" in second
    assert "--ade20k" in second


def test_one_edge_is_one_edge_and_two_classes_need_no_hint(tmp_path, capsys):
    halves = np.repeat(np.array([[0, 9]], np.uint8), 256, 1).repeat(512, 0)
    assert run("graph", write(tmp_path / "view.png", halves)) == 0
    out = capsys.readouterr().out
    assert "2 nodes, 1 edge\n" in out
    assert "--ade20k" not in out


def test_our_own_indices_read_as_those_of_ade20k_are_hinted_at(tmp_path, capsys):
    assert run("graph", write(tmp_path / "view.png", np.full((64, 64), 9, np.uint8)), "--ade20k") == 0
    assert "without --ade20k" in capsys.readouterr().out.splitlines()[1]


@pytest.mark.parametrize("mode", ["RGB", "RGBA", "P"])
def test_a_picture_all_in_our_colours_is_read_by_them(mode, tmp_path, capsys):
    """Whatever order a drawing program has given its palette."""
    picture = Image.fromarray(PALETTE[LABELS]).convert("RGBA" if mode == "RGBA" else "RGB")
    if mode == "P":
        picture = picture.quantize(8)
        assert (np.array(picture) != LABELS).any()
    picture.save(tmp_path / "labels.png")
    assert run("graph", tmp_path / "labels.png") == 0
    by_colour = capsys.readouterr().out
    write(tmp_path / "labels.png")
    assert run("graph", tmp_path / "labels.png") == 0
    assert by_colour.replace(" read by their colours", "") == capsys.readouterr().out != by_colour


def test_the_labels_are_never_drawn_over(tmp_path, capsys):
    path = write(tmp_path / "labels.png")
    before = path.read_bytes()
    assert run("graph", path, "--out", tmp_path / ".." / tmp_path.name / "labels.png") == 2
    assert "--out: expected a file other than the labels, found " in capsys.readouterr().err
    assert path.read_bytes() == before


def missing(path):
    return ["found nothing"]


def a_song(path):
    path.write_text("la la la")
    return ["expected an image"]


def folder(path):
    path.mkdir()
    return ["expected an image"]


def rgb(path):
    Image.new("RGB", (8, 8)).save(path)
    return ["expected one class index a pixel", "RGB", "100.0% of it in other colours"]


def moving(path):
    frames = [Image.fromarray(LABELS), Image.fromarray(LABELS[::-1])]
    frames[0].save(path, "GIF", save_all=True, append_images=frames[1:])
    return ["expected one image, found 2"]


def index_10(path):
    write(path, np.array([[0, 10]], np.uint8))
    return ["expected indices 0..9, found 0..10", "--ade20k"]


def index_255(path):
    write(path, np.array([[0, 255]], np.uint8))
    return ["expected indices 0..9, found 0..255"]


def truncated(path):
    data = write(path).read_bytes()
    path.write_bytes(data[:len(data) // 2])
    return ["expected an image"]


def chunk(kind, data):
    """A part of a PNG file."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def short_head(path):
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", bytes(5)))
    return ["expected an image"]


def bomb(path):
    size = struct.pack(">II", 60000, 60000) + bytes([8, 0, 0, 0, 0])
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", size) + chunk(b"IDAT", zlib.compress(b"")))
    return ["expected an image"]


FAULTS = [missing, a_song, folder, rgb, moving, index_10, index_255, truncated, short_head, bomb]


def assert_one_line(capsys, *words):
    """One line on stderr, nothing on stdout."""
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("python -m gnl: ")
    assert err.endswith("\n")
    assert err.count("\n") == 1
    for word in words:
        assert word in err


@pytest.mark.parametrize("make", FAULTS, ids=lambda make: make.__name__)
def test_a_mistake_is_one_line_that_names_the_file_and_nothing_is_written(tmp_path, capsys, make):
    path = tmp_path / "view.png"
    words = make(path)
    before = list(tmp_path.iterdir())
    assert run("graph", path) == 2
    assert_one_line(capsys, f"{path}: ", "found", *words)
    assert list(tmp_path.iterdir()) == before


def test_an_index_that_ade20k_does_not_have_is_named(tmp_path, capsys):
    path = write(tmp_path / "view.png", np.array([[0, 151]], np.uint8))
    assert run("graph", path, "--ade20k") == 2
    assert_one_line(capsys, f"{path}: expected indices 0..150, found 0..151\n")


@pytest.mark.parametrize(("index", "hint"), [(10, "; --ade20k for indices of ADE20K"),
                                             (150, "; --ade20k for indices of ADE20K"), (151, "")])
def test_indices_that_are_not_ours_are_taken_for_those_of_ade20k_if_it_has_them(tmp_path, capsys, index, hint):
    path = write(tmp_path / "view.png", np.array([[0, index]], np.uint8))
    assert run("graph", path) == 2
    assert_one_line(capsys, f"{path}: expected indices 0..9, found 0..{index}{hint}\n")


def test_a_picture_that_cannot_be_written_leaves_nothing(tmp_path, capsys):
    path = write(tmp_path / "view.png")
    (tmp_path / "taken").mkdir()
    assert run("graph", path, "--out", tmp_path / "taken") == 2
    err = capsys.readouterr().err
    assert err.startswith("python -m gnl: ")
    assert err.count("\n") == 1
    assert str(tmp_path / "taken") in err
    assert sorted(p.name for p in tmp_path.iterdir()) == ["taken", "view.png"]


@pytest.mark.parametrize("name", ["LICENSE", "graph.jpg", "graph"])
def test_a_picture_has_the_name_of_a_picture(tmp_path, capsys, name):
    path = write(tmp_path / "view.png")
    (tmp_path / "LICENSE").write_text("MIT")
    assert run("graph", path, "--out", tmp_path / name) == 2
    assert_one_line(capsys, f"--out: expected a name that ends in .png, found {tmp_path / name}\n")
    assert (tmp_path / "LICENSE").read_text() == "MIT"


def test_the_name_of_a_picture_may_end_in_capitals(tmp_path):
    assert run("graph", write(tmp_path / "view.png"), "--out", tmp_path / "GRAPH.PNG") == 0
    with Image.open(tmp_path / "GRAPH.PNG") as picture:
        assert picture.format == "PNG"


def test_a_python_without_what_gnl_needs_is_told_in_one_line(tmp_path):
    (tmp_path / "numpy.py").write_text("raise ModuleNotFoundError('No module', name='numpy')")
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); from gnl.__main__ import main; main(['graph', 'a.png'])"
    finished = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert finished.returncode == 2
    assert finished.stderr == ("python -m gnl: expected numpy to be installed, as `make` does in .venv, found none\n")


def test_a_program_that_fails_shows_no_traceback(tmp_path):
    finished = subprocess.run([sys.executable, "-W", "error", "-m", "gnl", "graph", tmp_path / "view.png"],
                              capture_output=True, text=True)
    assert finished.returncode == 2
    assert finished.stderr.count("\n") == 1
    assert finished.stdout == ""
