"""Histories as structured arrays."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

#: Columns of whole numbers in the files of a run.
WHOLE = {"step", "newton_iterations", "degree", "cuts", "iteration", "run", "mode"}


class Event(NamedTuple):
    """Something that happened in a step.

    Attributes
    ----------
    step : int
        Number of the step.
    time : float
        Its time.
    kind : str
        "cut", "grown", "rejected", "degree", "release", "lost-frames", "rounding-floor" or "unresolved".
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


#: What sets the sizes of adaptive steps, in the column `limited_by`: words in the files of a run, otherwise their places.
LIMITS = ("start", "error", "corrections", "kink", "load", "output", "phase", "max_size", "min_size")


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
