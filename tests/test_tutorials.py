"""The tutorials: every chapter runs and says what it prints, every grader tells right answers from wrong ones."""

import ast
import copy
import functools
import importlib
import importlib.util
import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from gnl import learned
from gnl.world import World

ROOT = Path(__file__).parents[1]
TUTORIALS = ROOT / "tutorials"


def load(path):
    """A file as a module, its own folder on the path, as when it is run."""
    sys.path.insert(0, str(path.parent))
    try:
        spec = importlib.util.spec_from_file_location(path.stem, path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module
    finally:
        sys.path.remove(str(path.parent))


runner = load(TUTORIALS / "run.py")
grader = load(TUTORIALS / "exercises" / "grader.py")
CHAPTERS = runner.chapters()
PAGES = [ROOT / "README.md", *sorted(TUTORIALS.glob("**/*.md"))]
EXERCISES = sorted((TUTORIALS / "exercises").glob("ex_*.py"))


def number(path):
    return path.stem[-2:]


def page(tmp_path, text):
    path = tmp_path / "page.md"
    path.write_text(text)
    return path


def test_a_page_whose_outputs_are_as_written_runs(tmp_path):
    runner.run(page(tmp_path, "# A\n\n```text\nno output\n```\n\n"
                              "```python\na = 2\nprint(a, 'is', 0.123)\n```\n\n```text\n2 is ...\n```\n\n"
                              "```python\nassert a == 2\n```\n\n```sh\nnot run\n```\n"), tmp_path)


@pytest.mark.parametrize("written", ["3", "2 2", "", "2\nmore"])
def test_an_output_that_is_not_as_written_is_named_by_its_line(tmp_path, written):
    text = f"# A\n\n```python\nprint(2)\n```\n\n```text\n{written}\n```\n"
    with pytest.raises(ValueError, match=r"page.md, line 7: expected the output"):
        runner.run(page(tmp_path, text), tmp_path)


def test_an_error_names_its_line_of_the_page(tmp_path):
    path = page(tmp_path, "# A\n\ntext\n\n```python\na = 1\nb = a / 0\n```\n")
    with pytest.raises(ZeroDivisionError) as error:
        runner.run(path, tmp_path)
    assert error.traceback[-1].lineno + 1 == 7


def test_a_page_is_read_as_utf_8_wherever_one_is(tmp_path):
    path = tmp_path / "page.md"
    path.write_bytes("```python\nprint(len('ä'))\n```\n\n```text\n1\n```\n".encode())
    code = (f"import sys; sys.path.insert(0, {str(TUTORIALS)!r}); import locale, run; "
            f"assert locale.getpreferredencoding(False) != 'UTF-8'; run.run({str(path)!r}, {str(tmp_path)!r})")
    here = {"PATH": os.environ["PATH"], "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C"}
    subprocess.run([sys.executable, "-c", code], env=here, check=True, timeout=60)


def test_a_fence_that_prints_what_nobody_wrote_down_passes_and_an_output_belongs_to_the_last_fence(tmp_path):
    runner.run(page(tmp_path, "```python\nprint(1)\n```\n\n```python\nprint(2)\n```\n\n```sh\nls\n```\n\n"
                              "```text\n2\n```\n\n```text\nno output\n```\n"), tmp_path)


@pytest.mark.parametrize("fence", [
    "```python title=x\n1 / 0\n```\n", "```python \n1 / 0\n```\n", "  ```python\n  1 / 0\n  ```\n",
    "```c++\n1 / 0;\n```\n\n```python\n1 / 0\n```\n", "  ```text\n  2\n  ```\n"])
def test_a_fence_that_would_not_be_run_is_told(tmp_path, fence):
    with pytest.raises(ValueError, match="expected fences of one word or none, those to be run not indented, found "):
        runner.run(page(tmp_path, fence), tmp_path)
    runner.run(page(tmp_path, "  ```\n  w w d\n  ```\n"), tmp_path)


def test_a_page_runs_in_its_folder_and_leaves_the_current_one_as_it_was(tmp_path):
    before = Path.cwd()
    runner.run(page(tmp_path, "```python\nopen('here', 'w').close()\n```\n"), tmp_path)
    assert (tmp_path / "here").exists()
    assert Path.cwd() == before


def test_a_chapter_that_is_none_is_one_line(capsys):
    with pytest.raises(SystemExit) as exit:
        runner.main(["00", "99"])
    assert exit.value.code == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert err.startswith("tutorials/run.py: expected chapters of 00, 01, ")
    assert err.endswith(", 12, found 99\n")


@pytest.fixture(scope="module")
def quick_senses():
    """Six chapters ask for senses that learned in one and the same home: they learn once, and each gets a copy."""
    taught = functools.cache(lambda plan, learn=learned.quick_senses: learn(World(json.loads(plan))))
    return lambda world: replace(copy.deepcopy(taught(json.dumps(world.plan))), world=world)


@pytest.mark.parametrize("chapter", CHAPTERS, ids=lambda path: path.stem)
def test_a_chapter_runs_says_what_it_prints_and_draws_its_figures(chapter, tmp_path, monkeypatch, quick_senses):
    monkeypatch.setattr(learned, "quick_senses", quick_senses)
    folder = tmp_path / "tutorials"
    (folder / "figures").mkdir(parents=True)
    (tmp_path / "data_gen").symlink_to(ROOT / "data_gen")  # what a chapter finds beside its folder, and in it
    (folder / "results").symlink_to(TUTORIALS / "results")
    runner.run(chapter, folder)
    drawn = {path.name for path in (folder / "figures").iterdir()}
    shown = set(re.findall(r"\(figures/([^)]+)\)", chapter.read_text()))
    assert shown == drawn
    for name in drawn:
        committed = TUTORIALS / "figures" / name
        assert committed.stat().st_size <= 100_000
        with Image.open(committed) as one, Image.open(folder / "figures" / name) as other:
            assert one.size == other.size
            difference = np.asarray(one.convert("RGB"), float) - np.asarray(other.convert("RGB"), float)
        assert abs(difference).mean() < 1, f"{name} is no longer what the chapter draws"
        assert (abs(difference).max(2) > 64).mean() < 0.002, f"{name} is no longer what the chapter draws"


@pytest.mark.parametrize("chapter", CHAPTERS, ids=lambda path: path.stem)
def test_a_chapter_is_of_readable_size_and_has_two_to_three_characters_of_prose_to_one_of_code(chapter):
    """The code of pictures, which is folded, counts for neither."""
    text = chapter.read_text()
    assert 600 <= len(re.sub(r"```.*?```", "", text, flags=re.DOTALL).split()) <= 1500
    assert max(len(line) for fence in runner.FENCE.finditer(text) for line in fence[2].splitlines()
               if fence[1] in ("python", "text")) <= 97  # a page of GitHub shows no more without a scroll bar
    shown = re.sub(r"<details><summary>Code of the pictures?</summary>.*?</details>", "", text, flags=re.DOTALL)
    code = sum(len(fence[2]) for fence in runner.FENCE.finditer(shown) if fence[1] == "python")
    said = runner.FENCE.sub(lambda fence: "" if fence[1] in ("python", "text") else fence[0], shown)
    assert 2 <= len(said) / code <= 3


@pytest.mark.parametrize("exercises", EXERCISES, ids=number)
def test_the_solutions_are_right(exercises):
    tasks, solutions = load(exercises).TASKS, load(TUTORIALS / "solutions" / f"sol_{number(exercises)}.py")
    for answer, check in tasks.values():
        check(getattr(solutions, answer.__name__))


def nearest_that_covers(begin, end, n):
    rows = np.arange(n)
    covers = (begin[:, None] <= rows) & (rows < end[:, None])
    return np.where(covers.any(0), covers.argmax(0), -1) if len(begin) else np.full(n, -1)


def entry_and_exit(faces, others, s):
    enter, leave = ((lines[:, :1] + lines[:, 1:] * s) for lines in (faces, others))
    enter, leave = enter.min(0), leave.max(0)
    return np.where((enter > 0) & (enter > leave), enter, 0)


def turned(centre, half, angle):
    ahead, left = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    return [centre + u * half[0] * ahead + v * half[1] * left for u, v in ((1, 1), (-1, 1), (-1, -1), (1, -1))]


@pytest.mark.parametrize(("task", "answer"), [("1.2", turned), ("2.3", entry_and_exit), ("3.3", nearest_that_covers)])
def test_an_answer_is_given_the_arrays_that_its_stub_promises(task, answer):
    _, check = load(TUTORIALS / "exercises" / f"ex_0{task[0]}.py").TASKS[task]
    check(answer)


@pytest.mark.parametrize("exercises", EXERCISES, ids=number)
def test_the_stubs_are_not_right(exercises, capsys):
    tasks = load(exercises).TASKS
    assert grader.grade(tasks) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == list(tasks)


@pytest.mark.parametrize("exercises", EXERCISES, ids=number)
def test_at_least_two_plausible_wrong_answers_to_each_task_are_told_from_the_right_one(exercises):
    module, wrong = load(exercises), load(ROOT / "tests" / "tutorials" / f"wrong_{number(exercises)}.py").WRONG
    assert wrong.keys() == module.TASKS.keys()
    for task, (_, check) in module.TASKS.items():
        assert len(wrong[task]) >= 2
        for answer in wrong[task]:
            with pytest.raises(Exception) as error:  # noqa: PT011 (of any kind: what is wrong may also break)
                check(answer)
            assert not isinstance(error.value, NotImplementedError)


@pytest.mark.parametrize("exercises", EXERCISES, ids=number)
def test_a_chapter_states_each_of_its_exercises_with_a_hint(exercises):
    (text,) = [chapter.read_text() for chapter in CHAPTERS if chapter.stem[:2] == number(exercises)]
    tasks = load(exercises).TASKS
    assert 3 <= len(tasks) <= 5
    assert all(re.search(rf"\b{re.escape(task)}\b", text) for task in tasks)
    assert text.count("<details>") == text.count("</details>") >= len(tasks)


def shell_commands(page):
    """Lines of the sh fences of a page, comments left out."""
    fences = re.findall(r"^```sh\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)
    return [line.partition("#")[0].split() for fence in fences for line in fence.splitlines() if line.strip()]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_commands_of_a_page_are_there(page, capsys):
    targets = set(re.findall(r"^([\w ]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    known, variables = {name for names in targets for name in names.split()}, (ROOT / "Makefile").read_text()
    for program, *words in shell_commands(page):
        if program == "make":
            settings = [word for word in words if "=" in word]
            assert set(words) - set(settings) <= known
            assert all(re.search(rf"^{word.partition('=')[0]} \?=", variables, re.MULTILINE) for word in settings)
        else:
            assert program in (".venv/bin/python", "python")
            if words[0] == "-m":
                with pytest.raises(SystemExit) as exit:
                    importlib.import_module(f"{words[1]}.__main__").main([*words[2:3], "--help"])
                assert exit.value.code == 0
                help_ = capsys.readouterr().out
                assert [word for word in words if word.startswith("--") and word not in help_] == []
            else:
                assert (ROOT / words[0]).exists()


def test_the_blocks_of_the_readme_run():
    runner.run(ROOT / "README.md", ROOT)


def public_names(path):
    """Functions, classes and methods of a module, what begins with _ left out."""
    def public(nodes):
        return [node for node in nodes
                if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_")]

    for node in public(ast.parse(path.read_text()).body):
        yield from (part.name for part in (node, *public(node.body if isinstance(node, ast.ClassDef) else [])))


def test_each_public_function_of_the_library_is_named_in_some_chapter():
    code = [part for chapter in CHAPTERS for part in re.findall(r"```.*?```|`[^`\n]+`", chapter.read_text(), re.DOTALL)]
    named = set(re.findall(r"\w+", "\n".join(code)))
    library = {path.name: set(public_names(path)) for path in (ROOT / "gnl").glob("*.py")}
    assert sum(map(len, library.values())) > 300
    assert {module: names - named for module, names in library.items() if names - named} == {}


def test_right_answers_are_counted_and_wrong_ones_are_told_with_what_was_got_and_expected(capsys):
    def double(x):
        return 2 * np.asarray(x)

    def grade_1(double):
        grader.expect("double of 2", double(2), 4)

    def grade_2(double):
        grader.expect("double of (1, 2)", double([1, 2]), [2, 5])

    def grade_3(double):
        grader.expect("shape", double([1, 2]), [[2, 4]])

    def grade_4(double):
        double(None)

    def grade_5(double):
        grader.expect("a word for a number", str(double(2)), 4)

    graders = enumerate((grade_1, grade_2, grade_3, grade_4, grade_5), 1)
    assert grader.grade({f"1.{i}": (double, check) for i, check in graders}) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "1.1  right"
    assert lines[1] == "1.2  not yet: double of (1, 2) at (1,): got 4, expected 5"
    assert lines[2] == "1.3  not yet: shape: got shape (2,), expected (1, 2)"
    told = re.fullmatch(r"1\.4  not yet: TypeError in line (\d+): .*", lines[3])
    assert Path(__file__).read_text().splitlines()[int(told[1]) - 1] == "        return 2 * np.asarray(x)"
    assert lines[4] == "1.5  not yet: a word for a number: got 4 (of type <U1), expected 4"


def test_a_fault_in_a_library_is_told_by_the_line_that_called_it_and_a_lacking_return_by_its_name(capsys):
    def total(x):
        return np.concatenate(x)

    def lacking(x):
        2 * x

    def grade_it(answer):
        grader.expect("sum", answer(3), 3)

    assert grader.grade({"1.1": (total, grade_it), "1.2": (lacking, grade_it)}) == 0
    lines = capsys.readouterr().out.splitlines()
    line, = re.fullmatch(r"1\.1  not yet: \w+ in line (\d+): .*", lines[0]).groups()
    assert "np.concatenate" in Path(__file__).read_text().splitlines()[int(line) - 1]
    assert lines[1] == "1.2  not yet: lacking returned None: is its return missing?"


@pytest.mark.parametrize(("got", "words"), [(Fraction(1, 3), None), (0.33333333, None), (Fraction(1, 4), "got 1/4"),
                                            (None, "got None"), ([1 / 3], "shape")])
def test_a_fraction_is_a_number_and_nothing_is_none(got, words):
    if words:
        with pytest.raises(grader.Wrong, match=words):
            grader.expect("a third", got, 1 / 3)
    else:
        grader.expect("a third", got, 1 / 3)
