"""Run chapters: every python fence of a page, top to bottom, in one namespace; what it prints must be what is written.

    python tutorials/run.py [CHAPTER ...]        all chapters, a line each

The first text fence after a python fence, and before the next, is its output; three dots in it stand for anything. A
python fence without one is run, but what it prints is not compared.
"""

import contextlib
import io
import os
import re
import sys
import time
from pathlib import Path

HERE = Path(__file__).parent
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
STRAY = re.compile(r"^```.*|^ +```(python|text).*", re.MULTILINE)  # what is left of fences that FENCE does not match


def run(page, folder=HERE):
    """Run a page in a folder; ValueError at the first output that is not what is written."""
    text, namespace, printed = Path(page).read_text(encoding="utf-8"), {"__name__": "__main__"}, None
    if stray := STRAY.search(FENCE.sub("", text)):
        raise ValueError(f"{page}: expected fences of one word or none, those to be run not indented, "
                         f"found {stray[0]!r}")
    before = os.getcwd()
    os.chdir(folder)
    try:
        for fence in FENCE.finditer(text):
            kind, body, line = fence[1], fence[2], text.count("\n", 0, fence.start()) + 1
            if kind == "python":
                code = compile("\n" * line + body, str(page), "exec")  # so that an error names its line of the page
                with contextlib.redirect_stdout(io.StringIO()) as stream:
                    exec(code, namespace)
                printed = stream.getvalue()
            elif kind == "text" and printed is not None:
                pattern = re.escape(body.strip()).replace(r"\.\.\.", ".*?")
                if not re.fullmatch(pattern, printed.strip(), re.DOTALL):
                    raise ValueError(f"{page}, line {line}: expected the output\n{body}\nfound\n{printed}")
                printed = None
    finally:
        os.chdir(before)


def chapters():
    """All pages that are chapters, in order."""
    return sorted(HERE.glob("[0-9][0-9]_*.md"))


def main(names):
    """Run the chapters named, or all: a line each."""
    for name in names:
        if not any(name in (page.stem, page.stem[:2]) for page in chapters()):
            known = ", ".join(page.stem[:2] for page in chapters())
            print(f"tutorials/run.py: expected chapters of {known}, found {name}", file=sys.stderr)
            sys.exit(2)
    chosen = [page for page in chapters() if not names or page.stem in names or page.stem[:2] in names]
    for page in chosen:
        start = time.perf_counter()
        run(page)
        print(f"{page.stem:<32}{time.perf_counter() - start:5.1f} s, and prints what is written")


if __name__ == "__main__":
    main(sys.argv[1:])
