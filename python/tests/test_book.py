"""The listings of Python in README.md, the book and the README of the package.

The listings of a page run in order, in one folder, with one set of variables:

| listing | test |
|---|---|
| `python` | is run |
| `text python` | lines that the listing before it prints, with their numbers; `...` stands for any others |
| `toml NAME` | is written to NAME |
| `toml FOLDER/NAME` | is a part of this file, which is copied to NAME |
| `python FILE` | is a part of FILE, which another test runs; `cargo test -p emmy-cli --test cli listings` checks that |

Numbers may differ by a thousandth, and by anything below 1e-9, which is round-off. Numbers of seconds are not compared.

`UPDATE_LISTINGS=1 pytest python/tests/test_book.py` writes the present output into the pages.
"""

import contextlib
import io
import itertools
import os
import re
from pathlib import Path

import emmy
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
FENCE = re.compile(r"^```([^\n]+)\n(.*?)^```$", flags=re.M | re.S)
PAGES = sorted(
    str(path.relative_to(ROOT))
    for path in [ROOT / "README.md", ROOT / "python/README.md", *ROOT.glob("book/src/**/*.md")]
    if re.search(r"^```python$", path.read_text(encoding="utf-8"), flags=re.M)
)


NUMBER = r"[+-]?\d+(?:\.\d*)?(?:e[+-]?\d+)?"


def without_numbers(line):
    return " ".join(re.sub(NUMBER, "#", line).split())


def numbers(line):
    """The numbers of a line, but those of seconds."""
    return [float(found) for found in re.findall(rf"{NUMBER}(?![\d.])(?!\s*(?:[mu]?s|seconds?)\b)", line)]


def is_same(line, other):
    """Whether two lines are equal but for round-off and seconds."""
    if without_numbers(line) != without_numbers(other):
        return False
    return numbers(line) == pytest.approx(numbers(other), rel=1e-3, abs=1e-9)


def shown(output, listing):
    """The shown lines of an output with their present text."""
    lines = iter(output.splitlines())
    now = []
    for line in listing.splitlines():
        if line != "...":
            line = next((own.rstrip() for own in lines if without_numbers(own) == without_numbers(line)), None)
        if line is None:
            return output
        now.append(line)
    return "".join(f"{line}\n" for line in now)


def run_page(page):
    """Runs the listings of a page; its variables."""
    text = (ROOT / page).read_text(encoding="utf-8")
    variables = {"__name__": "__main__"}
    output, parts, end = "", [], 0
    for found in FENCE.finditer(text):
        words, listing = found[1].split(), found[2]
        if words == ["python"]:
            line = text[: found.start(2)].count("\n")
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile("\n" * line + listing, str(ROOT / page), "exec"), variables)
            output = printed.getvalue()
        elif words == ["text", "python"]:
            now = shown(output, listing)
            if "UPDATE_LISTINGS" in os.environ:
                parts += [text[end : found.start(2)], now]
                end = found.end(2)
            else:
                lines = list(itertools.zip_longest(now.splitlines(), listing.splitlines(), fillvalue=""))
                wrong = [f"{other!r} is now {line!r}" for line, other in lines if not is_same(line, other)]
                assert not wrong, f"{page}:\n" + "\n".join([*wrong, output])
        elif len(words) == 2 and words[0] == "toml":
            file = Path(words[1])
            whole = (ROOT / file).read_text(encoding="utf-8") if len(file.parts) > 1 else listing
            Path(file.name).write_text(whole, encoding="utf-8")
    if parts:
        (ROOT / page).write_text("".join([*parts, text[end:]]), encoding="utf-8")
    return variables


@pytest.mark.parametrize("page", PAGES)
@pytest.mark.filterwarnings("default")
def test_listings(page):
    for package in ("gmsh", "matplotlib", "pandas", "pyvista", "scipy"):
        pytest.importorskip(package)
    run_page(page)


@pytest.mark.parametrize(
    ("line", "other", "same"),
    [
        ("T + V = 11.333", "T + V = 11.334", True),
        ("T + V = 11.333", "T + V = 11.4", False),
        ("residual -1.1e-14", "residual 4e-15", True),
        ("residual -1.1e-14", "residual 4e-5", False),
        ("101 rows", "102 rows", False),
        ("[ 526.  931. 1494.] Hz", "[ 526. 931. 1494.] Hz", True),
        ("[ 526.  931. 1494.] Hz", "[ 526.  941. 1494.] Hz", False),
        ("10 steps in 12.5 s", "10 steps in 7.25 s", True),
        ("10 steps in 12.5 s", "11 steps in 12.5 s", False),
        ("10 steps, tip at z = 55.66 mm", "10 steps, tip at z = 55.86 mm", False),
        ("10 steps", "10 rows", False),
    ],
)
def test_numbers_of_listings_are_compared(line, other, same):
    assert is_same(line, other) == same


def test_there_are_pages():
    assert {"README.md", "book/src/index.md", "book/src/python.md", "python/README.md"} <= set(PAGES)


@pytest.mark.parametrize(("page", "file"), [("README.md", "spinning-block.toml"), ("book/src/index.md", "pulled.toml")])
def test_inputs_and_python_on_a_page_are_the_same_problem(page, file):
    history = run_page(page)["motion"].history
    run = emmy.run(file, set={"output.every": 0})
    for column in history.dtype.names:
        if column != "wall_seconds":
            assert np.array_equal(history[column], run.history[column], equal_nan=True), column


def test_the_first_page_of_the_book_has_the_problem_of_the_first_program():
    history = run_page("book/src/index.md")["motion"].history
    # The work of the load, by `examples/first_program.rs`; then nothing changes it.
    free = history["total_energy"][history["time"] > 0.2 - 1e-9]
    assert free == pytest.approx(0.498328687637499, rel=1e-12)
