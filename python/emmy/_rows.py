"""The CSV files of sweeps: a row for each run, in the order in which they ended until the sweep is complete."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import ResultsError, regular
from ._history import record_array
from ._results import read_rows

#: Columns of a motion with whole numbers.
WHOLE = {"step", "newton_iterations", "degree", "contact_points"}

#: The results of a run, and the message if it failed.
Row = tuple[dict[str, Any], str | None]


class RowFile:
    """The file of a sweep of a function."""

    def __init__(self, path: Path, runs: Sequence[Mapping[str, Any]], until: float | None, resume: bool) -> None:
        self._path, self._runs = path, runs
        #: Values that all runs have, beside their parameters.
        self._common = {} if until is None or "until" in runs[0] else {"until": repr(float(until))}
        self._names: list[str] = []
        self.rows: dict[int, Row] = {}
        if path.exists():
            if not resume:
                raise ResultsError(f"{os.fspath(path)} exists; resume=True continues its sweep")
            self._read()
            self.write()

    def _read(self) -> None:
        regular(self._path)
        text = self._path.read_text(encoding="utf-8", errors="replace")
        # The last line of a sweep that was killed may be cut.
        lines = list(csv.reader((text[: text.rfind("\n") + 1] or text).splitlines(keepends=True)))
        if not lines:
            return
        own = [*self._runs[0], *self._common]
        width = 1 + len(own)
        if lines[0][:width] != ["run", *own] or lines[0][-1] != "message":
            raise ResultsError(
                f"{os.fspath(self._path)} is of another sweep: its first columns are not run, {', '.join(own)}"
            )
        self._names = lines[0][width:-1]
        if "until" in self._names:
            ends = ", ".join(line[width] for line in lines[1:2])
            raise ResultsError(f"{os.fspath(self._path)} is of another sweep: its runs have until = {ends}")
        for line in lines[1:]:
            index = int(line[0]) - 1
            if not 0 <= index < len(self._runs) or line[1:width] != self._texts(index):
                raise ResultsError(
                    f"{os.fspath(self._path)} is of another sweep: run {line[0]} has {', '.join(line[1:width])}"
                )
            values = zip(self._names, line[width:-1], strict=True)
            self.rows[index] = ({name: _number(name, value) for name, value in values if value}, line[-1] or None)

    def _texts(self, index: int) -> list[str]:
        own = [value if isinstance(value, str) else _shown(value) for value in self._runs[index].values()]
        return [*own, *self._common.values()]

    def add(self, index: int, row: Row) -> None:
        """Adds a row."""
        self.rows[index] = row
        new = [name for name in row[0] if name not in self._names]
        if new or len(self.rows) == 1:
            self._names += new
            self.write()
            return
        with open(self._path, "a", newline="", encoding="utf-8") as file:
            csv.writer(file).writerow(self._line(index))

    def _line(self, index: int) -> list[Any]:
        values, message = self.rows[index]
        return [index + 1, *self._texts(index), *(values.get(name, "") for name in self._names), message or ""]

    def write(self) -> None:
        """Writes all rows, in the order of the runs."""
        part = self._path.with_name(self._path.name + ".part")
        with open(part, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["run", *self._runs[0], *self._common, *self._names, "message"])
            writer.writerows(self._line(index) for index in sorted(self.rows))
        os.replace(part, self._path)


def _shown(value: Any) -> str:
    """The value of a parameter as text, without the types of NumPy."""
    if isinstance(value, (np.generic, np.ndarray)):
        return repr(value.tolist())
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_shown, value))}]"
    return repr(value)


def _number(name: str, value: str) -> float | int | str:
    if name == "limited_by":
        return value
    return int(value) if name in WHOLE else float(value)


def of_library(path: Path, runs: Sequence[Mapping[str, Any]]) -> tuple[NDArray[Any], dict[int, str]]:
    """The table of a sweep of the library, with parameters as they were given, and the messages of failed runs."""
    lines = read_rows(path)
    names, rows = lines[0], sorted(lines[1:], key=lambda line: int(line[0]))
    columns: dict[str, list[Any]] = {name: [runs[int(line[0]) - 1][name] for line in rows] for name in runs[0]}
    for at, name in enumerate(names):
        texts = [line[at] for line in rows]
        if name == "status":
            columns[name] = texts
        elif name not in ("run", "message", *runs[0]):
            columns[name] = [_number(name, text) if text else np.nan for text in texts]
    messages = [line[names.index("message")] for line in rows]
    return record_array(columns), {index: message for index, message in enumerate(messages) if message}
