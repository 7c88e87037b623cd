"""The settings of a motion in the words of the input."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from . import _words as words
from ._errors import fault
from ._parts import Adaptive, Initial


def tree(
    *,
    scheme: str,
    degree: int,
    steps: Any,
    until: float | None,
    adaptive: float | Adaptive | None,
    smallest_step: float | None,
    tolerance: float,
    max_iterations: int,
    solver: str,
    initial: Iterable[Initial],
    equilibrium: bool | int | Mapping[str, Any] | None,
    limits: Mapping[str, float] | None,
    outputs: Mapping[str, Any],
    title: str | None,
    units: str | None,
) -> dict[str, Any]:
    """The tree of all tables of an input but those of the body."""
    time = {"scheme": scheme, "degree": degree, "until": until, "smallest_step": smallest_step}
    if steps is not None:
        time["steps"] = phases(steps)
    if adaptive is not None:
        if until is None:
            raise fault("until", "adaptive steps need the end of the motion")
        time["adaptive"] = adaptive._tree() if isinstance(adaptive, Adaptive) else {"tolerance": adaptive}
    elif until is not None and steps is None:
        raise fault(
            "until", "the steps to this time are missing", "give steps=(until, size), or adaptive=1e-4 beside until"
        )
    own: dict[str, Any] = {
        "time": time,
        "newton": {"tolerance": tolerance, "max_iterations": max_iterations},
        "solver": {"kind": solver},
        "initial": [item._tree() for item in initial] or None,
        "equilibrium": _equilibrium(equilibrium) if is_given(equilibrium) else None,
        "limits": limits,
        "output": output(outputs),
        "title": title,
        "units": None if units is None else {"system": units},
    }
    return {key: words.tree(words.plain(value, key), key) for key, value in own.items() if value is not None}


def phases(steps: Any) -> list[dict[str, Any]]:
    """Phases of steps from `(until, size)` or a list of such pairs."""
    expected = "expected a pair (until, size), or a list of pairs"
    given = words.plain(steps, "steps")
    if not isinstance(given, tuple):
        raise TypeError(f"steps: {expected}, found {steps!r}")
    is_pair = not any(isinstance(item, tuple) for item in given)
    for index, pair in enumerate([given] if is_pair else given):
        if not isinstance(pair, tuple) or len(pair) != 2:
            raise fault("steps" if is_pair else f"steps[{index}]", f"{expected}, found {pair!r}")
    return [{"until": until, "size": size} for until, size in ([given] if is_pair else given)]


def is_given(equilibrium: object) -> bool:
    """Whether the motion starts from an equilibrium; an empty table means one with all defaults."""
    return equilibrium is not None and not (isinstance(equilibrium, (bool, np.bool_)) and not equilibrium)


def _equilibrium(value: Any) -> Mapping[str, Any]:
    if isinstance(value, (bool, np.bool_)):
        return {}
    return value if isinstance(value, Mapping) else {"load_steps": value}


def output(given: Mapping[str, Any]) -> dict[str, Any] | None:
    """The table of outputs; probes and values may be named by a dict."""
    own = {key: value for key, value in given.items() if value is not None}
    if "probes" in own:
        own["probes"] = [_named(name, probe, "point") for name, probe in _items(own["probes"])]
    if "values" in own:
        own["values"] = [_named(name, value, "quantity") for name, value in _items(own["values"])]
    if "directory" in own:
        own["directory"] = os.fspath(own["directory"])
    return {key: value for key, value in own.items() if not (key in ("probes", "values") and not value)} or None


def _items(given: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> list[tuple[str | None, Any]]:
    return list(given.items()) if isinstance(given, Mapping) else [(None, item) for item in given]


def _named(name: str | None, value: Any, key: str) -> dict[str, Any]:
    own = dict(value) if isinstance(value, Mapping) else {key: value}
    return own if name is None else {"name": name} | own
