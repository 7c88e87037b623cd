"""Sweeps: a motion with every combination of some parameters."""

from __future__ import annotations

import inspect
import itertools
import math
import re
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _emmy, _rows
from . import _words as words
from ._errors import ConvergenceError, Error, InputError, fault
from ._history import History, record_array, to_pandas
from ._motion import NO_PLAN, Motion
from ._progress import Progress
from ._results import Run, stamp
from ._rows import Row
from ._run import StrPath, call, directory_of, flags, toml
from ._studies import Problem


@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """Runs over combinations of parameters.

    Attributes
    ----------
    parameters : dict of str to list
        Values of each parameter.
    columns : list of str
        Names of the results.
    table : structured array
        A row for each run, with its parameters and its results; the last parameter changes fastest. The results of
        a failed run are those up to its last good step, or NaN if there is none. For each column X that a probe,
        reaction, extreme or value has in the history there are the last number ``X``, the smallest ``X_min`` at the
        time ``X_min_time`` and the largest ``X_max`` at ``X_max_time``.
    failures : dict of int to str
        Message of each failed run by its row in `table`, counted from 0.
    path : pathlib.Path or None
        CSV file of the rows.

    Examples
    --------
    >>> def make(speed):
    ...     mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    ...     body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=2))
    ...     return emmy.Motion(body, steps=(1.0, 0.5), initial=emmy.Initial(velocity=(speed, 0, 0)))
    >>> sweep = emmy.sweep(make, {"speed": [1.0, 2.0, 3.0]})
    >>> np.round(sweep.table["kinetic_energy"], 9).tolist()          # m v^2/2
    [1.0, 4.0, 9.0]
    """

    parameters: dict[str, list[Any]]
    columns: list[str]
    table: NDArray[Any]
    failures: dict[int, str]
    path: Path | None = None

    def to_pandas(self) -> Any:
        """The table as a data frame of pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each run.

        Raises
        ------
        ImportError
            If pandas is not installed.

        Examples
        --------
        >>> path = emmy.new("spinning-block")
        >>> sweep = emmy.sweep(path, {"region.0.density": [1.0, 2.0]}, until=0.1, measure="steps")
        >>> sweep.to_pandas().columns.tolist()
        ['region.0.density', 'steps']
        """
        return to_pandas(self.table)

    def __len__(self) -> int:
        return len(self.table)

    def __repr__(self) -> str:
        return f"<emmy.Sweep over {', '.join(self.parameters)}: {len(self)} runs, {len(self.failures)} failed>"


def sweep(
    problem: StrPath | Problem | Callable[..., Motion],
    parameters: Mapping[str, Sequence[Any]],
    *,
    set: Mapping[str, Any] | None = None,
    workers: int | None = None,
    until: float | None = None,
    output: StrPath | None = None,
    progress: bool = False,
    resume: bool = False,
    keep: bool = False,
    modes: int | None = None,
    measure: str | Sequence[str] | Callable[[Any], Mapping[str, float]] | None = None,
) -> Sweep:
    """Runs a motion with every combination of values of some parameters, several at a time.

    Parameters
    ----------
    problem : str, path, Problem or function
        Input file, whose keys are the parameters; or a function ``make(**parameters)`` that makes a `Motion` with a
        plan. Motions run on threads; the function itself must allow that.
    parameters : dict of str to list
        Values: of dotted keys of the input such as "region.0.density", or of arguments of the function. The last
        parameter changes fastest. Results do not depend on the number of workers.
    set : dict, optional
        Of a file: values of further dotted keys, the same in all runs, as in `run`.
    workers : int, optional
        Runs at a time; as many as there are threads if not given.
    until : float, optional
        End of the runs.
    output : str or path, optional
        Of a file: the directory of the sweep, by default the output directory of the input with "-sweep" added. Of a
        function: a CSV file of the rows, each written when its run ends.
    progress : bool, optional
        Whether to show a bar, of tqdm if it is installed.
    resume : bool, optional
        Whether to continue the interrupted sweep in `output`: only runs without a row, so that failed ones stay. Give
        the same `until` and `measure`.
    keep : bool, optional
        Of a file: whether to keep input, history and summary of run N, counted from 1, in the folder ``runs/N`` of the
        directory, for `Run` and `compare`.
    modes : int, optional
        Of a file: number of natural modes of each run, in place of its motion; the columns are ``frequency_1`` and so
        on, ``effective_mass_x_1`` and so on.
    measure : str, list of str or function, optional
        Names of the results that alone are wanted: columns of the table, of the history (their last numbers) or of the
        summary, and ``X_min``, ``X_max``, ``X_min_time``, ``X_max_time`` of any column X of the history. Or a function
        with further results of a run, as a dict of numbers with names of their own: of the motion at its end or, of a
        file, of its `Run`. The runs of a file are kept then, as by `keep`.

    Returns
    -------
    Sweep

    Raises
    ------
    InputError
        If the input or a key is bad, or a run has no result of a name in `measure`.
    ResultsError
        If the results cannot be written; of a function, if `output` exists and `resume` is not given; if `resume` is
        given and `output` holds another sweep.
    ConvergenceError
        If no row is written.
    TypeError
        If the function has other parameters, or an argument has another type.

    Notes
    -----
    An `emmy.Error` fails its run only. Any other exception of the function or of `measure` ends the sweep; the rows in
    `output` stay, and `resume=True` continues it. The results of a file are measured after its last run, so that
    `resume=True` measures again without new runs.

    Examples
    --------
    >>> sweep = emmy.sweep(emmy.new("spinning-block"), {"region.0.density": [1, 2], "time.scheme": ["DGM"]}, until=0.2)
    >>> sweep.table["region.0.density"].tolist(), len(sweep.failures)
    ([1, 2], 0)
    >>> sweep = emmy.sweep("spinning-block.toml", {"region.0.density": [1, 2]}, set={"time.scheme": "DGM"}, until=0.2,
    ...                    measure=["kinetic_energy_max", "steps"])
    >>> sweep.table.dtype.names
    ('region.0.density', 'kinetic_energy_max', 'steps')
    """
    if workers is not None:
        workers = words.count(workers, 1, "workers", most=65535)
    if until is not None and not math.isfinite(until):
        raise fault("until", f"must be finite, not {until}")
    values = {name: _values(own, f"parameters.{name}") for name, own in words.mapping(parameters, "parameters").items()}
    for name, own in values.items():
        if not own:
            raise fault(f"parameters.{name}", "has no values")
    if not values:
        raise fault("parameters", "there is no parameter")
    chosen = _measure(measure, values)
    if callable(problem):
        if set is not None:
            raise TypeError("set: only with an input file, which has keys")
        if keep:
            raise TypeError("keep: only with an input file; a function may keep the histories of its motions itself")
        if modes is not None:
            raise TypeError("modes: only with an input file; `emmy.modes` computes those of a body")
        path = None if output is None else Path(output)
        return _of_function(problem, values, workers, until, path, progress, resume, chosen)
    if modes is not None and callable(chosen):
        raise TypeError("measure: not a function with modes, whose runs have no motion")
    changes = dict(words.mapping(set or {}, "set"))
    for key in changes:
        if key in values:
            raise fault(f"set.{key}", "is one of the parameters")
    return _of_file(problem, values, changes, workers, until, output, progress, resume, keep, modes, chosen)


#: What is measured: chosen results by their names, or further ones by a function.
Measure = tuple[str, ...] | Callable[[Any], Mapping[str, float]]


def _measure(
    given: str | Sequence[str] | Callable[[Any], Mapping[str, float]] | None, parameters: Mapping[str, Any]
) -> Measure | None:
    if given is None or callable(given):
        return given
    names = (given,) if isinstance(given, str) else tuple(given) if isinstance(given, Iterable) else None
    if not names or not all(isinstance(name, str) for name in names):
        raise TypeError(f"measure: {given!r} is neither the name of a result, nor a list of names, nor a function")
    for name in names:
        if name in parameters:
            raise fault("measure", f"{name!r} is a parameter, which is in the table anyway")
    return names


def _values(given: Any, place: str) -> list[Any]:
    if isinstance(given, (str, bytes)) or not isinstance(given, Iterable):
        raise TypeError(f"{place}: {type(given).__name__} in place of a list of values")
    return [value.item() if isinstance(value, np.generic) else value for value in given]


def _runs(values: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """All combinations; the last parameter changes fastest."""
    return [dict(zip(values, own, strict=True)) for own in itertools.product(*values.values())]


def _of_file(
    problem: StrPath | Problem,
    values: dict[str, list[Any]],
    changes: dict[str, Any],
    workers: int | None,
    until: float | None,
    output: StrPath | None,
    progress: bool,
    resume: bool,
    keep: bool,
    modes: int | None,
    measure: Measure | None,
) -> Sweep:
    """A sweep of the library."""
    path = problem.path if isinstance(problem, Problem) else Path(problem)
    changes = (problem._changes if isinstance(problem, Problem) else {}) | changes
    end = problem._until if until is None and modes is None and isinstance(problem, Problem) else until
    runs = _runs(values)
    directory = Path(f"{directory_of(path, changes | runs[0])}-sweep" if output is None else output)
    rows = directory / "sweep.csv"
    before = stamp(rows)
    texts = {
        key: ",".join(toml(value, f"parameters.{key}[{index}]") for index, value in enumerate(own))
        for key, own in values.items()
    }
    fixed = flags(set=changes)
    varied = [f"--set={key}={text}" for key, text in texts.items()]
    given: dict[str, Any] = {
        "threads": workers,
        "until": end,
        "output": directory,
        "resume": resume,
        "keep": keep or (measure is not None and modes is None),
        "modes": modes,
        "quiet": not progress,
    }
    try:
        call("sweep", path, progress=progress, more=fixed + varied, **given)
    except ConvergenceError:
        # Failed runs end a complete sweep with an error; their messages are in the rows.
        if stamp(rows) == before:
            raise
    except InputError as error:
        # The changes of a problem have been read already.
        error.faults[:] = [own._replace(place=re.sub("^set$", "parameters", own.place)) for own in error.faults]
        raise
    table, failures = _rows.of_library(rows, runs)
    if measure is not None:
        table = _measured_table(values, table, failures, None if modes is not None else directory / "runs", measure)
    names = [name for name in table.dtype.names or () if name not in values]
    return Sweep(values, names, table, failures, rows)


def _measured_table(
    values: Mapping[str, Any],
    table: NDArray[Any],
    failures: Mapping[int, str],
    folder: Path | None,
    measure: Measure,
) -> NDArray[Any]:
    """The table of a sweep of the library with what is measured in the folders of its runs, if they have some."""
    rows: list[dict[str, Any]] = []
    for index in range(len(table)):
        row = {name: table[name][index].item() for name in table.dtype.names or () if name not in values}
        if index in failures:
            rows.append({name: row[name] for name in measure if name in row} if isinstance(measure, tuple) else row)
            continue
        run = None if folder is None else Run(folder / str(index + 1))
        if isinstance(measure, tuple):
            history, summary = (None, {}) if run is None else (run.history, run.summary)
            rows.append(_chosen(measure, row, history, summary))
        else:
            rows.append(row | _measured(measure(run), {*values, *row}))
    names = dict.fromkeys(name for row in rows for name in row)
    columns = {name: table[name].tolist() for name in values}
    return record_array(columns | {name: [row.get(name, np.nan) for row in rows] for name in names})


def _of_function(
    make: Callable[..., Motion],
    values: dict[str, list[Any]],
    workers: int | None,
    until: float | None,
    path: Path | None,
    progress: bool,
    resume: bool,
    measure: Measure | None,
) -> Sweep:
    """A sweep on threads: the library releases Python's lock in each step."""
    runs = _runs(values)
    _check_parameters(make, runs[0])
    file = None if path is None else _rows.RowFile(path, runs, until, resume)
    rows: dict[int, Row] = {} if file is None else file.rows
    stop = threading.Event()
    missing = [index for index in range(len(runs)) if index not in rows]

    def one(index: int) -> tuple[int, Row]:
        return index, _run(make, runs[index], until, stop, measure)

    with (
        ThreadPoolExecutor(workers or _emmy.threads(), initializer=_emmy.on_one_thread) as pool,
        Progress(progress, len(runs), "runs") as bar,
    ):
        futures = {pool.submit(one, index) for index in missing}
        try:
            for index, row in _as_done(futures):
                rows[index] = row
                if file is not None:
                    file.add(index, row)
                bar.to(len(rows), f"{sum(message is not None for _, message in rows.values())} failed")
        except BaseException:
            stop.set()
            for future in futures:
                future.cancel()
            raise
    ordered = [rows[index] for index in range(len(runs))]
    if file is not None:
        file.write()
    names = list(dict.fromkeys(name for row, _ in ordered for name in row))
    columns: dict[str, list[Any]] = {name: [run[name] for run in runs] for name in values}
    columns |= {name: [row.get(name, np.nan) for row, _ in ordered] for name in names if name not in values}
    failures = {index: message for index, (_, message) in enumerate(ordered) if message is not None}
    return Sweep(values, [name for name in names if name not in values], record_array(columns), failures, path)


def _check_parameters(make: Callable[..., Motion], parameters: Mapping[str, Any]) -> None:
    try:
        signature = inspect.signature(make)
    except ValueError:  # of some builtins
        return
    try:
        signature.bind(**parameters)
    except TypeError as error:
        raise TypeError(f"parameters: {error}") from None


def _as_done(futures: set[Future[tuple[int, Row]]]) -> Iterator[tuple[int, Row]]:
    pending = set(futures)
    while pending:
        # A wait without end would not hear Ctrl-C on every system.
        done, pending = wait(pending, timeout=0.5, return_when=FIRST_COMPLETED)
        for future in sorted(done, key=lambda future: future.exception() is not None):
            yield future.result()


def _run(
    make: Callable[..., Motion],
    parameters: Mapping[str, Any],
    until: float | None,
    stop: threading.Event,
    measure: Measure | None,
) -> Row:
    """A run: the last row of its history, peaks of the columns asked for, and what was measured."""
    motion: Motion | None = None
    message: str | None = None
    try:
        motion = make(**parameters)
        if not isinstance(motion, Motion):
            raise TypeError(
                f"the function of a sweep must return an emmy.Motion, not {words.class_name(type(motion))}"
            )
        if not motion._native.has_plan:
            raise RuntimeError(NO_PLAN)
        end = motion._native.end if until is None else until
        if end > motion._native.end:
            motion.extend(end)
        while not stop.is_set() and motion._native.advance(0.1, end):
            pass
    except Error as error:
        message = str(error)
    if motion is None:
        return {}, message
    history = motion.history
    last = history[-1]
    row = {name: last[name].item() for name in last.dtype.names}
    for name in motion._native.asked:
        peak = history.peak(name)
        row |= {f"{name}_min": peak.smallest, f"{name}_min_time": peak.smallest_time}
        row |= {f"{name}_max": peak.largest, f"{name}_max_time": peak.largest_time}
    if isinstance(measure, tuple):
        return _chosen(measure, row, history, {}), message
    if measure is not None and message is None:
        row |= _measured(measure(motion), {*parameters, *row, "run", "until", "message"})
    return row, message


#: What names of results add to the name of a column, for each part of its peak.
_ENDINGS = {
    "_min_time": "smallest_time", "_max_time": "largest_time", "_min": "smallest", "_max": "largest", "": "last",
}  # fmt: skip


def _chosen(
    names: Sequence[str], row: Mapping[str, Any], history: History | None, summary: Mapping[str, Any]
) -> dict[str, Any]:
    """Results of a run by their names: of its row, of the columns of its history, or of its summary."""
    found: dict[str, Any] = {}
    for name in names:
        number = row[name] if name in row else None if history is None else _of_history(history, name)
        number = summary.get(name) if number is None else number
        if not isinstance(number, (int, float, str)):
            columns = () if history is None else history.dtype.names or ()
            known = ", ".join(dict.fromkeys([*row, *columns]))
            raise fault("measure", f"{name!r} is no result; there is {known}")
        found[name] = number
    return found


def _of_history(history: History, name: str) -> float | None:
    """The last number of a column, or a part of its peak."""
    for ending, part in _ENDINGS.items():
        column = name.removesuffix(ending)
        if name.endswith(ending) and column in (history.dtype.names or ()):
            return float(getattr(history.peak(column), part))
    return None


def _measured(results: Mapping[str, float], taken: set[str]) -> dict[str, float]:
    """The measurements of a function, under names that are not taken."""
    for name in results:
        if not isinstance(name, str):
            raise TypeError(f"measure: the name {name!r} is not text")
        if name in taken:
            raise TypeError(f"measure: the name {name!r} is that of a parameter or of a column of the sweep")
    return {name: float(value) for name, value in results.items()}
