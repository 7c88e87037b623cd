"""The verbs of the command line as functions."""

from __future__ import annotations

import json
import os
import sys
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _emmy
from ._errors import regular, warn
from ._results import Run
from ._words import mapping, plain

StrPath = str | os.PathLike[str]


def toml(value: Any, place: str = "set") -> str:
    """A value in TOML."""
    value = plain(value, place)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{toml(key)} = {toml(item, f'{place}.{key}')}" for key, item in value.items()) + " }"
    if isinstance(value, tuple):
        return "[" + ", ".join(toml(item, f"{place}[{index}]") for index, item in enumerate(value)) + "]"
    raise TypeError(f"{place}: {type(value).__name__} has no place in an input")


def flags(**given: Any) -> list[str]:
    """Flags of the command line; those that are None or False are left out."""
    own: list[str] = []
    for name, value in given.items():
        flag = "--" + name.replace("_", "-")
        if name == "set":
            changes = mapping(value or {}, "set")
            own += [f"--set={key}={'' if item is None else toml(item, f'set.{key}')}" for key, item in changes.items()]
        elif value is True:
            own.append(flag)
        elif value is not None and value is not False:
            # A value in the same argument may begin with a hyphen.
            own.append(f"{flag}={os.fspath(value) if isinstance(value, (str, os.PathLike)) else plain(value, name)}")
    return own


def call(verb: str, *operands: StrPath, progress: bool = False, more: Sequence[str] = (), **given: Any) -> str:
    """Runs a verb; its notes and warnings are warnings, and its other messages are progress on the standard error."""

    def show(message: str) -> None:
        kind, _, text = message.partition(": ")
        if kind in ("note", "warning"):
            warn([text])
        elif progress:
            print(message, file=sys.stderr)

    argv = [verb, *flags(**given), *more, "--", *(os.fspath(operand) for operand in operands)]
    return _emmy.verb(argv, show)


def run(
    path: StrPath,
    *,
    set: Mapping[str, Any] | None = None,
    until: float | None = None,
    output: StrPath | None = None,
    threads: int | None = None,
    estimate_error: bool = False,
    progress: bool = False,
) -> Run:
    """Runs an input file and writes all results, as `emmy run`.

    Parameters
    ----------
    path : str or path
        Input file.
    set : dict, optional
        Values of dotted keys, such as ``{"time.scheme": "DGM", "region.0.density": 2.5}``; None removes a key.
    until : float, optional
        End of the run.
    output : str or path, optional
        Directory of the results, in place of the one in the input.
    threads : int, optional
        Number of threads.
    estimate_error : bool, optional
        Whether to estimate the error at the end by a second motion.
    progress : bool, optional
        Whether to show progress on the standard error.

    Returns
    -------
    Run

    Raises
    ------
    InputError
        If the input is bad; nothing is written.
    ConvergenceError
        If a step cannot be done; the results up to it are in the directory.
    LimitExceeded
        If a limit of the input is exceeded.
    ResultsError
        If the results cannot be written, or the directory holds other files.

    Examples
    --------
    >>> path = emmy.new("spinning-block")
    >>> run = emmy.run(path, set={"output.every": 0}, until=0.1, output="spin")
    >>> run.status, float(run.history["time"][-1])
    ('done', 0.1)
    """
    directory = directory_of(path, set or {}) if output is None else output
    given: dict[str, Any] = {
        "set": set,
        "until": until,
        "output": directory,
        "threads": threads,
        "estimate_error": estimate_error,
    }
    call("run", path, progress=progress, quiet=not progress, **given)
    return Run(directory)


def directory_of(path: StrPath, changes: Mapping[str, Any]) -> StrPath:
    """The output directory of an input: that of the changes, of the file, or its name."""
    stem, given = Path(path).stem, mapping(changes, "set")
    if "output" not in given and "output.directory" not in given:
        try:
            given = tomllib.loads(regular(path).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return stem
    table = given.get("output")
    own = given.get("output.directory", table.get("directory") if isinstance(table, Mapping) else None)
    if not isinstance(table, (Mapping, type(None))) or not isinstance(own, (str, os.PathLike, type(None))):
        # The reader names the mistake.
        call("check", path, set=changes)
    return stem if own is None else str(own)


def resume(
    directory: StrPath,
    *,
    until: float | None = None,
    step: float | None = None,
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    estimate_error: bool = False,
    progress: bool = False,
) -> Run:
    """Continues a run that was stopped, or extends it, as `emmy resume`.

    Parameters
    ----------
    directory : str or path
        Output directory of the run.
    until : float, optional
        New end.
    step : float, optional
        Size of the steps from here on.
    set, threads, estimate_error, progress : optional
        As in `run`.

    Returns
    -------
    Run

    Raises
    ------
    ResultsError
        If the directory holds no run that can be resumed, or the results cannot be written.
    InputError, ConvergenceError, LimitExceeded
        As `run`.

    Examples
    --------
    >>> run = emmy.run(emmy.new("spinning-block"), set={"output.every": 0}, until=0.1, output="spin")
    >>> float(emmy.resume("spin", until=0.2).history["time"][-1])
    0.2
    """
    given: dict[str, Any] = {
        "until": until,
        "step": step,
        "set": set,
        "threads": threads,
        "estimate_error": estimate_error,
    }
    call("resume", directory, progress=progress, quiet=not progress, **given)
    return Run(directory)


def check(path: StrPath, *, set: Mapping[str, Any] | None = None, until: float | None = None) -> str:
    """Reads an input and its mesh and reports on them, as `emmy check`.

    Parameters
    ----------
    path : str or path
        Input file.
    set, until : optional
        As in `run`.

    Returns
    -------
    str
        The report.

    Raises
    ------
    InputError
        If the input is bad.

    Examples
    --------
    >>> "117 cells" in emmy.check(emmy.new("l-block"))
    True
    """
    return call("check", path, set=set, until=until)


def report(directory: StrPath) -> Path:
    """Writes the report of a run again, as `emmy report`.

    Parameters
    ----------
    directory : str or path
        Output directory of a run.

    Returns
    -------
    pathlib.Path
        The page.

    Raises
    ------
    ResultsError
        If the directory holds no run.

    Examples
    --------
    >>> run = emmy.run(emmy.new("spinning-block"), set={"output.every": 0}, until=0.1, output="spin")
    >>> emmy.report("spin").name
    'report.html'
    """
    call("report", directory)
    return Path(directory) / "report.html"


@dataclass(frozen=True)
class Comparison:
    """Several runs, or the rows of sweeps, side by side.

    Attributes
    ----------
    report : pathlib.Path
        The page; of sweeps the table `compare.csv`.
    summaries : list of dict
        Summary of each run; of sweeps their rows.
    inputs : list of dict
        For each run its values of all keys in which the inputs differ, as they stand in a file; None where a key is
        missing. Empty for sweeps.

    Examples
    --------
    >>> import pathlib
    >>> emmy.Comparison(pathlib.Path("compare/report.html"), [], []).report.name
    'report.html'
    """

    report: Path
    summaries: list[dict[str, Any]]
    inputs: list[dict[str, str | None]]


def compare(directories: Sequence[StrPath], *, output: StrPath = "compare") -> Comparison:
    """Shows several runs, or the rows of sweeps, side by side, as `emmy compare`.

    Parameters
    ----------
    directories : list of str or path
        Output directories of runs, or of sweeps over the same keys.
    output : str or path, optional
        Directory of the page and its charts.

    Returns
    -------
    Comparison

    Raises
    ------
    ResultsError
        If a directory holds neither a run nor a sweep, or if both are given.

    Examples
    --------
    >>> path = emmy.new("spinning-block")
    >>> for scheme in ("DGM", "AS(5)"):
    ...     run = emmy.run(path, set={"output.every": 0, "time.scheme": scheme}, until=0.1, output=scheme)
    >>> compared = emmy.compare(["DGM", "AS(5)"])
    >>> [summary["scheme"] for summary in compared.summaries]
    ['DGM', 'AS(5)']
    >>> compared.inputs
    [{'time.scheme': '"DGM"'}, {'time.scheme': '"AS(5)"'}]
    """
    text = call("compare", *directories, output=output, quiet=True, json=True)
    lines = [json.loads(line) for line in text.splitlines()]
    page = "report.html" if all("summary" in line for line in lines) else "compare.csv"
    inputs = [line["input"] for line in lines if "summary" in line]
    return Comparison(Path(output) / page, [line.get("summary", line) for line in lines], inputs)
