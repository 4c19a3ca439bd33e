"""Files are whole or not there, and what is no file of ours is refused in one line."""

import io
import json
import os
import tempfile

import numpy as np
import pytest
from conftest import full_disk

from gnl.files import FORMAT, check_folder, load_arrays, save_arrays, save_json, write_whole


def header(**content):
    return np.frombuffer(json.dumps(content).encode(), np.uint8)


def test_a_file_holds_what_was_written_in_folders_that_are_made(tmp_path):
    write_whole(tmp_path / "a" / "b" / "file.bin", b"first")
    write_whole(tmp_path / "a" / "b" / "file.bin", b"second")
    assert (tmp_path / "a" / "b" / "file.bin").read_bytes() == b"second"
    assert os.listdir(tmp_path / "a" / "b") == ["file.bin"]


def test_a_file_has_the_usual_rights(tmp_path):
    write_whole(tmp_path / "ours", b"")
    (tmp_path / "usual").touch()
    assert (tmp_path / "ours").stat().st_mode == (tmp_path / "usual").stat().st_mode


@pytest.mark.parametrize("stop", [OSError("disk full"), KeyboardInterrupt()], ids=["error", "ctrl-c"])
@pytest.mark.parametrize("existed", [True, False])
def test_an_interrupted_write_leaves_all_as_it_was(tmp_path, monkeypatch, stop, existed):
    class HalfWay(io.FileIO):
        def write(self, data):
            super().write(data[:len(data) // 2])
            raise stop

    if existed:
        (tmp_path / "file").write_bytes(b"old")
    with monkeypatch.context() as patch, pytest.raises(type(stop)):
        patch.setattr(os, "fdopen", HalfWay)
        write_whole(tmp_path / "file", b"new and longer")
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"old"] * existed


def test_who_is_interrupted_when_all_is_done_has_the_file_and_hears_of_the_interruption(tmp_path, monkeypatch):
    def replace(old, new, replace=os.replace):
        replace(old, new)
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", replace)
    with pytest.raises(KeyboardInterrupt):
        write_whole(tmp_path / "file", b"new")
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("file", b"new")]


def test_a_link_stays_a_link_and_what_it_links_to_is_written(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "there" / "file")
    for data in b"first", b"second":
        write_whole(tmp_path / "link", data)
        assert (tmp_path / "link").is_symlink()
        assert [path.read_bytes() for path in (tmp_path / "there").iterdir()] == [data]


def test_a_device_is_left_alone(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ValueError, match="pipe: expected a file or nothing, found a device"):
        write_whole(tmp_path / "pipe", b"new")
    assert (tmp_path / "pipe").is_fifo()


@pytest.mark.parametrize("where", ["", "new", "new/newer"])
def test_a_folder_where_one_may_not_write_is_named_before_any_work(tmp_path, monkeypatch, where):
    monkeypatch.setattr(os, "access", lambda path, _: str(path) != str(tmp_path))  # root may write anywhere
    with pytest.raises(ValueError, match=f"--out: expected a folder to write in, found {tmp_path}, where you may not"):
        check_folder("--out", tmp_path / where)
    monkeypatch.undo()
    check_folder("--out", tmp_path / where)


def test_a_full_disk_is_told_with_the_name_of_the_file(tmp_path, monkeypatch):
    with monkeypatch.context() as patch, pytest.raises(OSError) as full:
        patch.setattr(os, "fdopen", full_disk)
        write_whole(tmp_path / "file", b"new")
    assert str(full.value) == f"[Errno 28] No space left on device: '{tmp_path / 'file'}'"
    assert not list(tmp_path.iterdir())


def test_a_folder_in_the_way_is_told_by_its_name(tmp_path):
    (tmp_path / "file").mkdir()
    with pytest.raises(OSError) as refusal:
        write_whole(tmp_path / "file", b"new")
    assert str(refusal.value) == f"[Errno 21] Is a directory: '{tmp_path / 'file'}'"
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_where_no_file_can_be_made_the_target_is_named(tmp_path, monkeypatch):
    def mkstemp(dir, prefix):
        raise OSError(13, "Permission denied", f"{dir}/{prefix}1b2c3")

    monkeypatch.setattr(tempfile, "mkstemp", mkstemp)
    with pytest.raises(OSError) as refusal:
        write_whole(tmp_path / "file", b"new")
    assert str(refusal.value) == f"[Errno 13] Permission denied: '{tmp_path / 'file'}'"


def test_a_failed_rename_leaves_all_as_it_was(tmp_path, monkeypatch):
    def refuse(*_):
        raise PermissionError

    (tmp_path / "file").write_bytes(b"old")
    with monkeypatch.context() as patch, pytest.raises(PermissionError):
        patch.setattr(os, "replace", refuse)
        write_whole(tmp_path / "file", b"new")
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"old"]


def test_arrays_come_back_bit_for_bit_with_what_made_them(tmp_path):
    arrays = {"a": np.random.default_rng(0).normal(size=(3, 4)), "b": np.arange(5, dtype=np.uint8)}
    save_arrays(tmp_path / "file.npz", {"seed": 3, "name": "home"}, **arrays)
    loaded, made_by = load_arrays(tmp_path / "file.npz")
    assert made_by == {"seed": 3, "name": "home"}
    assert loaded.keys() == arrays.keys()
    for name, array in arrays.items():
        assert loaded[name].dtype == array.dtype
        np.testing.assert_array_equal(loaded[name], array)


def test_the_same_arrays_make_the_same_file(tmp_path):
    for name in ("one", "two"):
        save_arrays(tmp_path / name, {"seed": 1}, a=np.arange(3))
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()


def missing(path):
    pass


def folder(path):
    path.mkdir()


def pipe(path):
    os.mkfifo(path)  # who reads it waits for ever


def empty(path):
    path.touch()


def text(path):
    path.write_text("wall floor ceiling")


def single_array(path):
    np.save(path.with_suffix(".npy"), np.arange(3))
    path.with_suffix(".npy").rename(path)


def pickles(path):
    np.savez(path, header=header(format=FORMAT, made_by=0), a=np.array([{}], object))


def no_header(path):
    np.savez(path, a=np.arange(3))


def header_of_numbers(path):
    np.savez(path, header=np.full(3, 255, np.uint8))


def header_of_a_list(path):
    np.savez(path, header=np.frombuffer(b"[]", np.uint8))


def header_without_maker(path):
    np.savez(path, header=header(format=FORMAT))


def other_version(path):
    np.savez(path, header=header(format=FORMAT + 1, made_by=0))


def truncated(path):
    save_arrays(path, {}, a=np.arange(1000))
    path.write_bytes(path.read_bytes()[:-100])


def damaged_data(path):
    save_arrays(path, {}, a=np.arange(1000))
    path.write_bytes(path.read_bytes().replace(np.arange(500, 600).tobytes(), bytes(800)))


def damaged_shape(path):
    save_arrays(path, {}, a=np.arange(1000))
    path.write_bytes(path.read_bytes().replace(b"'shape': (1000,)", b"'shape': ((100,)"))


def unknown_packing(path):
    save_arrays(path, {}, a=np.arange(1000))
    data = bytearray(path.read_bytes())
    data[data.rfind(b"PK\1\2") + 10] = 99  # how the last array is packed, in the archive's table of contents
    path.write_bytes(data)


FAULTS = [missing, folder, pipe, empty, text, single_array, pickles, no_header, header_of_numbers, header_of_a_list,
          header_without_maker, other_version, truncated, damaged_data, damaged_shape, unknown_packing]


@pytest.mark.parametrize("make", FAULTS, ids=lambda make: make.__name__)
def test_what_is_no_file_of_ours_is_refused_in_one_line(tmp_path, make):
    path = tmp_path / "file.npz"
    make(path)
    with pytest.raises(ValueError) as refusal:
        load_arrays(path)
    line = str(refusal.value)
    assert line.startswith(f"{path}: expected ")
    assert "found" in line
    assert "\n" not in line


def test_no_file_is_called_nothing(tmp_path):
    with pytest.raises(ValueError, match="expected a file of arrays, found nothing"):
        load_arrays(tmp_path / "file.npz")


def test_another_version_is_named(tmp_path):
    other_version(tmp_path / "file.npz")
    with pytest.raises(ValueError, match=f"expected format version {FORMAT}, found {FORMAT + 1}"):
        load_arrays(tmp_path / "file.npz")


def test_a_file_is_renamed_within_its_folder_for_no_rename_reaches_another_disk(tmp_path, monkeypatch):
    moved, replace = [], os.replace
    monkeypatch.setattr(os, "replace", lambda old, new: moved.append((old, new)) or replace(old, new))
    write_whole(tmp_path / "a" / "file", b"new")
    assert [os.path.dirname(path) for path in moved[0]] == [str(tmp_path / "a")] * 2


def test_a_write_leaves_the_mask_of_rights_as_it_was(tmp_path):
    before = os.umask(0o027)
    try:
        write_whole(tmp_path / "ours", b"")
        assert (tmp_path / "ours").stat().st_mode & 0o777 == 0o640
        assert os.umask(0o027) == 0o027
    finally:
        os.umask(before)


def test_equal_values_are_equal_files_of_json(tmp_path):
    save_json(tmp_path / "one", {"b": 1, "a": [2, None]})
    save_json(tmp_path / "other", {"a": [2, None], "b": 1})
    assert (tmp_path / "one").read_bytes() == (tmp_path / "other").read_bytes() == b'{"a":[2,null],"b":1}\n'
