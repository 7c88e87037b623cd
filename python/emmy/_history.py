"""Histories as structured arrays."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._errors import fault, missing

#: Columns of whole numbers in the files of a run.
WHOLE = {"step", "newton_iterations", "degree", "contact_points", "cuts", "iteration", "run", "mode"}


class Event(NamedTuple):
    """Something that happened in a step.

    Attributes
    ----------
    step : int
        Number of the step.
    time : float
        Its time.
    kind : str
        "cut", "passed", "grown", "rejected", "degree", "release", "lost-frames", "rounding-floor" or "unresolved".
    message : str
        What happened.

    Examples
    --------
    >>> emmy.Event(3, 0.2, "cut", "a step was cut").kind
    'cut'
    """

    step: int
    time: float
    kind: str
    message: str


#: Limits of adaptive step sizes, in the column `limited_by`: words in the files of a run, else their places.
LIMITS = ("start", "error", "corrections", "kink", "load", "output", "phase", "max_size", "min_size")


class Peak(NamedTuple):
    """Last, smallest and largest number of a column of a history, with times. NaN is neither smallest nor largest.

    Attributes
    ----------
    last : float
        Number in the last row.
    smallest, smallest_time : float
        The smallest number, the first of several, and its time.
    largest, largest_time : float
        The largest number, the first of several, and its time.

    Examples
    --------
    >>> emmy.Peak(last=0.2, smallest=-1.0, smallest_time=0.3, largest=1.0, largest_time=0.1).largest
    1.0
    """

    last: float
    smallest: float
    smallest_time: float
    largest: float
    largest_time: float


class History(np.ndarray[Any, np.dtype[Any]]):
    """A history: a structured array with a row for the start and one for each step. A column is a plain array.

    Examples
    --------
    >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
    >>> history = emmy.Motion(body, steps=(1.0, 0.5), initial=emmy.Initial(velocity=(0, 0, 1))).run()
    >>> len(history), history["time"].tolist()
    (3, [0.0, 0.5, 1.0])
    """

    def __getitem__(self, key: Any) -> Any:
        own = super().__getitem__(key)
        return np.asarray(own) if isinstance(key, str) else own

    def to_pandas(self) -> Any:
        """The history as a data frame of pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each row of the history, and its columns.

        Raises
        ------
        ImportError
            If pandas is not installed.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=2))
        >>> history = emmy.Motion(body, steps=(1.0, 0.5), initial=emmy.Initial(velocity=(0, 0, 1))).run()
        >>> history.to_pandas()["kinetic_energy"].round(9).tolist()
        [1.0, 1.0, 1.0]
        """
        return to_pandas(self)

    def peak(self, name: str) -> Peak:
        """Last, smallest and largest number of a column, with times. Of some rows alone: ``history[9:].peak(name)``.

        Parameters
        ----------
        name : str
            Name of the column.

        Returns
        -------
        Peak

        Raises
        ------
        InputError
            If there is no such column.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> falls = emmy.Initial(velocity=(0, 0, -1))
        >>> motion = emmy.Motion(body, steps=(1.0, 0.5), initial=falls, probes={"o": (0, 0, 0)})
        >>> [round(number, 9) for number in motion.run().peak("o_z")]
        [-1.0, -1.0, 1.0, 0.0, 0.0]
        """
        known = self.dtype.names or ()
        if name not in known:
            raise fault("name", f"{name!r} is not a column; there is {', '.join(known)}")
        if self[name].dtype.kind == "U":
            raise fault("name", f"{name!r} has words, which have no peak")
        numbers, times = self[name], self["time"]
        last = float(numbers[-1]) if len(numbers) else math.nan
        if np.isnan(numbers).all():
            return Peak(last, math.nan, math.nan, math.nan, math.nan)
        low, high = int(np.nanargmin(numbers)), int(np.nanargmax(numbers))
        return Peak(last, float(numbers[low]), float(times[low]), float(numbers[high]), float(times[high]))


def to_pandas(table: NDArray[Any]) -> Any:
    """A structured array as a data frame of pandas."""
    try:
        import pandas
    except ImportError:
        raise missing("to_pandas", "pandas", "pandas") from None
    return pandas.DataFrame({name: table[name] for name in table.dtype.names or ()})


def structured(rows: NDArray[np.float64], columns: Iterable[tuple[str, bool]]) -> NDArray[Any]:
    """Rows of numbers as a structured array; a column is named and may be of whole numbers, or of `LIMITS`."""
    kinds = [(name, "U11" if name == "limited_by" else np.int64 if whole else np.float64) for name, whole in columns]
    table = np.empty(len(rows), dtype=kinds)
    for index, (name, _) in enumerate(kinds):
        column = rows[:, index]
        # At the start nothing limits a step.
        table[name] = [LIMITS[int(own)] if own >= 0 else "" for own in column] if name == "limited_by" else column
    return table


def record_array(columns: dict[str, list[Any]]) -> NDArray[Any]:
    """Columns of numbers or words as a structured array."""
    arrays = {name: np.asarray(_simple(values)) for name, values in columns.items()}
    length = len(next(iter(arrays.values()), np.zeros(0)))
    table = np.empty(length, dtype=[(name, array.dtype) for name, array in arrays.items()])
    for name, array in arrays.items():
        table[name] = array
    return table


def _simple(values: list[Any]) -> list[Any]:
    """Numbers and words as they are, anything else as text."""
    is_simple = all(isinstance(value, (bool, int, float, str, np.number)) for value in values)
    return values if is_simple and len({isinstance(value, str) for value in values}) < 2 else list(map(repr, values))
