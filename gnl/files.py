"""Files that are whole or not there: written to a temporary name beside the target, then renamed.

Arrays travel as .npz without pickles; each file carries a format version and a note of what made it, so that
a file from elsewhere is refused with one clear line and not half-understood.
"""

import io
import json
import os
import tempfile
import zipfile
from pathlib import Path

import numpy as np

from .checks import check_finite

FORMAT = 1


def write_whole(path, data):
    """Write the bytes `data` to `path`, or to where it links: all of them or nothing, whatever interrupts it."""
    path = Path(path)
    path = path.resolve() if path.is_symlink() else path
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise ValueError(f"{path}: expected a file or nothing, found a device")
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:  # which would name the temporary file
        raise OSError(error.errno, error.strerror, str(path)) from None
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask)  # mkstemp makes private files; restore the usual permissions
        os.replace(temporary, path)
    except BaseException as error:
        Path(temporary).unlink(missing_ok=True)  # it is gone if the interruption came after the renaming
        if isinstance(error, OSError) and error.errno:  # it names no file, or the temporary one
            raise OSError(error.errno, error.strerror, str(path)) from None
        raise


def check_folder(option, path):
    """ValueError if there is a file where a folder is to be, no name for it, or no permission to write there."""
    if not str(path):
        raise ValueError(f"{option}: expected a folder, found no name")
    there = next(part for part in (Path(path), *Path(path).parents) if part.exists())
    if not there.is_dir():
        raise ValueError(f"{option}: expected a folder, found the file {there}")
    if not os.access(there, os.W_OK | os.X_OK):
        raise ValueError(f"{option}: expected a folder to write in, found {there}, where you may not")


def check_file(option, path):
    """ValueError if a file has no name, or its folder cannot be made."""
    if not str(path):
        raise ValueError(f"{option}: expected a file, found no name")
    check_folder(option, Path(path).parent)


def save_arrays(path, made_by, **arrays):
    """Save named arrays and `made_by`, a JSON-able description of what produced them, as .npz."""
    buffer = io.BytesIO()
    header = json.dumps({"format": FORMAT, "made_by": made_by}, sort_keys=True)
    np.savez(buffer, header=np.frombuffer(header.encode(), np.uint8), **arrays)
    write_whole(path, buffer.getvalue())


def load_arrays(path):
    """Arrays in a file of `save_arrays` as a dict, and what it was `made_by`; ValueError for any other file."""
    if not Path(path).exists():
        raise ValueError(f"{path}: expected a file of arrays, found nothing")
    try:
        if not (Path(path).is_file() and zipfile.is_zipfile(path)):  # a device may have no end
            raise ValueError("no archive")
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
        header = json.loads(arrays.pop("header").tobytes())
        version, made_by = header["format"], header["made_by"]
    except Exception as error:  # a damaged archive can fail in any of the layers below
        reason = str(error).partition("\n")[0]
        raise ValueError(f"{path}: expected an .npz file of gnl, found something else ({reason})") from None
    if version != FORMAT:
        raise ValueError(f"{path}: expected format version {FORMAT}, found {version!r}")
    return arrays, made_by


def save_json(path, value):
    """Save what JSON can hold in one form only, so that equal values are equal files."""
    write_whole(path, (json.dumps(value, sort_keys=True, separators=(",", ":")) + "\n").encode())


def load_json(path, what, check=None):
    """The dict in a JSON file; ValueError that names the file, and `what` it should hold.

    check(dict) may simply use what should be there: whatever it raises is a fault of the file.
    """
    try:
        found = json.loads(Path(path).read_bytes())
    except (OSError, ValueError, RecursionError) as error:  # JSON may be nested deeper than Python can follow
        raise ValueError(f"{path}: expected {what}, found {error}") from None
    if not isinstance(found, dict):
        raise ValueError(f"{path}: expected {what}, found a {type(found).__name__}")
    try:
        if check:
            check(found)
    except (ValueError, KeyError, TypeError, IndexError, AttributeError, ZeroDivisionError) as error:
        raise ValueError(f"{path}: expected {what}, found {error!r}") from None
    return found


def check_params(path, params, wanted):
    """ValueError if the arrays of a file differ from those `wanted` in name or shape, or are not finite numbers."""
    for name in wanted | params:
        expected = wanted[name].shape if name in wanted else "nothing"
        found = params[name].shape if name in params else "nothing"
        if expected != found:
            raise ValueError(f"{path}: {name}: expected shape {expected}, found {found}")
        values = params[name]
        if not np.issubdtype(values.dtype, np.floating):
            raise ValueError(f"{path}: {name}: expected floating-point numbers, found {values.dtype}")
        check_finite(f"{path}: {name}", values)
