"""Exceptions and warnings."""

from __future__ import annotations

import os
import re
import stat
import sys
import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray


class EmmyWarning(UserWarning):
    """A note on the input, the mesh or a run that is no error.

    Examples
    --------
    >>> import warnings
    >>> warnings.simplefilter("ignore", emmy.EmmyWarning)
    """


class Fault(NamedTuple):
    """One mistake in the input.

    Attributes
    ----------
    place : str
        Argument or key, such as ``loads[1].group``; line and column in a file; may be empty.
    message : str
        The mistake.
    help : str
        Advice; may be empty.
    group : str or None
        Name of a group that is not in the mesh.
    available : tuple of str or None
        Names that the mesh has in its place.

    Examples
    --------
    >>> print(emmy.Fault("degree", "must be at least 1"))
    degree: must be at least 1
    """

    place: str
    message: str
    help: str = ""
    group: str | None = None
    available: tuple[str, ...] | None = None

    def __str__(self) -> str:
        place = f"{self.place}: " if self.place else ""
        return place + self.message + (f"; {self.help}" if self.help else "")


class Error(Exception):
    """Base class of the errors of Emmy.

    Examples
    --------
    >>> issubclass(emmy.ConvergenceError, emmy.Error)
    True
    """


class InputError(Error, ValueError):
    """Bad input: everything that the reader has found, not only the first mistake.

    Parameters
    ----------
    faults : list of Fault
        The mistakes.

    Examples
    --------
    >>> try:
    ...     emmy.NeoHooke(youngs_modulus=1000.0, poissons_ratio=0.5)
    ... except emmy.InputError as error:
    ...     print(error.faults[0].place)
    poissons_ratio
    """

    def __init__(self, faults: list[Fault]) -> None:
        self.faults: list[Fault] = [fault if isinstance(fault, Fault) else _fault(fault) for fault in faults]
        super().__init__(self.faults)

    def __str__(self) -> str:
        return "\n".join(map(str, self.faults))


class MeshError(InputError):
    """A mesh that cannot be read, or has bad cells.

    Parameters
    ----------
    faults : list of Fault
        The mistakes.

    Examples
    --------
    >>> issubclass(emmy.MeshError, emmy.InputError)
    True
    """


class UnknownGroupError(InputError):
    """A group that the mesh does not have.

    Parameters
    ----------
    faults : list of Fault
        The mistakes.

    Attributes
    ----------
    group : str
        The name.
    available : tuple of str
        Names that the mesh has.

    Examples
    --------
    >>> steel = emmy.Region(emmy.NeoHooke(lambda_=1.0, mu=1.0), density=1.0)
    >>> try:
    ...     emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), steel, emmy.Support("y-mim", fix="xyz"))
    ... except emmy.UnknownGroupError as error:
    ...     print(error.group, "y-min" in error.available)
    y-mim True
    """

    @property
    def group(self) -> str:
        """Name of the first group that the mesh does not have."""
        return next((fault.group for fault in self.faults if fault.group is not None), "")

    @property
    def available(self) -> tuple[str, ...]:
        """Names of the groups that the mesh has in its place."""
        return next((tuple(fault.available) for fault in self.faults if fault.available is not None), ())


class ConvergenceError(Error, RuntimeError):
    """A step that cannot be done. The motion is at the last good step and can go on with other steps.

    Attributes
    ----------
    step, time : int, float, or None
        Step and time that were to be reached.
    node : int or None
        Node with the largest residual.
    position : array (3,) or None
        Its position, or that of the inverted cell, at the end of the last good step.
    cause : str
        Why the last attempt failed.

    Examples
    --------
    >>> emmy.ConvergenceError("no convergence", 3, 0.2).step
    3
    """

    def __init__(
        self,
        message: str,
        step: int | None = None,
        time: float | None = None,
        node: int | None = None,
        position: Sequence[float] | NDArray[np.float64] | None = None,
        cause: str = "",
    ) -> None:
        message = _calls(message)
        super().__init__(message, step, time, node, position, cause)
        self.message = message
        self.step = step
        self.time = time
        self.node = node
        self.position: NDArray[np.float64] | None = None if position is None else np.asarray(position, dtype=np.float64)
        self.cause = cause

    def __str__(self) -> str:
        return self.message


class LimitExceeded(Error):
    """A limit on the energy or the angular momentum was exceeded.

    Examples
    --------
    >>> issubclass(emmy.LimitExceeded, emmy.Error)
    True
    """


class ResultsError(Error, OSError):
    """Results that cannot be read or written.

    Examples
    --------
    >>> issubclass(emmy.ResultsError, OSError)
    True
    """

    def __str__(self) -> str:
        return _calls(super().__str__())


# Tracebacks name the public place.
for _public in (
    EmmyWarning, Fault, Error, InputError, MeshError, UnknownGroupError, ConvergenceError, LimitExceeded, ResultsError,
):  # fmt: skip
    _public.__module__ = "emmy"


def fault(place: str, message: str, help: str = "") -> InputError:
    """An error with one mistake."""
    return InputError([Fault(place, message, help)])


def missing(function: str, module: str, extra: str) -> ImportError:
    """The error for an optional package that is not installed."""
    return ImportError(f"{function} needs {module}: pip install {extra}")


# From keys of any table to arguments, in this order.
_WORDS = [
    (r"^mesh\.(?=cells|cell_groups|facet_groups|node_groups|points)", ""),
    (r"\bmaterial\.[a-z][a-z-]*", "material"),
    (r"(^|\.)lambda$", r"\1lambda_"),
    (
        r"^(joint\[\d+\]\.|)(spherical|revolute|universal|cylindrical|prismatic|inline|planar|fixed|distance|line)\.",
        r"\1",
    ),
]

# From tables of a whole input to arguments of `Body` and `Motion`, in this order.
_WORDS_OF_WHOLE = [
    (r"^(contact|joint|load|region|support|tie)(?=\[)", r"\1s"),
    (r"^(contacts\[\d+\])\.obstacle(\.(plane|sphere|cylinder))?", r"\1.opponent"),
    (r"^mass(?=\[)", "masses"),
    (r"^time\.steps(\[\d+\])?(\.\w+)?", r"steps\1"),
    (r"^time$", "steps"),
    (r"^output\.directory$", "output"),
    (r"^(time|newton|output)\.", ""),
    (r"^solver\.kind", "solver"),
    (r"^units\.system", "units"),
]


def in_words_of_python(place: str) -> str:
    """The argument of `Body` or `Motion` for a key of a whole input; other places, such as lines of files, stay."""
    return _replaced(_replaced(place, _WORDS), _WORDS_OF_WHOLE)


@contextmanager
def of_whole_input() -> Iterator[None]:
    """Turns the places of faults in a whole input into arguments of `Body` and `Motion`."""
    try:
        yield
    except InputError as error:
        # The words of single tables are replaced already.
        places = [_replaced(fault.place, _WORDS_OF_WHOLE) for fault in error.faults]
        error.faults[:] = [fault._replace(place=place) for fault, place in zip(error.faults, places, strict=True)]
        raise


def _replaced(place: str, words: Iterable[tuple[str, str]]) -> str:
    if re.search(r":\d+(:\d+)?$", place):
        return place
    for pattern, replacement in words:
        place = re.sub(pattern, replacement, place)
    return place


def _fault(fault: tuple[Any, ...]) -> Fault:
    """A fault of the reader."""
    place, message, help, group, available = fault
    place, message = _argument(place, message)
    place, message = _replaced(place, _WORDS), _calls(message)
    # A scheme names itself in its message.
    message = message.removeprefix("scheme ") if place.endswith("scheme") else message
    return Fault(place, message, _calls(help or ""), group, None if available is None else tuple(available))


def _argument(place: str, message: str) -> tuple[str, str]:
    """The place and the message of a fault in a flag of the command line, which is an argument here."""
    own = re.fullmatch(r"--([a-z-]+):\d+:\d+", place)
    message = message.removesuffix("\n\nFor more information, try '--help'.")
    # As the parser of the command line has it.
    found = re.match(r"(invalid value '.*') for '--([a-z-]+) <.*?>'(?=: )", message, flags=re.S)
    if found:
        return _name(found[2]), found[1] + message[found.end() :]
    found = re.match(r"--([a-z-]+)(?::| (?=\S+: ))\s*", message)
    if found and (own or not place):
        return _name(found[1]), message[found.end() :]
    return (_name(own[1]), message) if own else (place, message)


def _name(flag: str) -> str:
    """The argument for a flag of the command line."""
    return "start" if flag == "from" else flag.replace("-", "_")


# Flags that arguments stand for, in messages.
_FLAGS = "set|until|step|output|threads|resume|estimate-error|sizes|window|from|to|reference(?:-scheme|-degree)?"


def _calls(text: str) -> str:
    """Commands and flags that have a function or an argument, as calls and arguments."""
    text = re.sub(r"`emmy list (schemes|materials|elements|meshes|fields|solvers|examples)`", r"`emmy.\1()`", text)
    value = r"(?: '?([\w.]+)=([^\s`';]*)'?| ([-\d.,]*\d|T\b|DGM\b))?"
    return re.sub(rf"(?<![\w-])--({_FLAGS})(?![\w-]){value}", _as_argument, text)


def _as_argument(flag: re.Match[str]) -> str:
    name, key, item, value = _name(flag[1]), flag[2], flag[3], flag[4]
    if name == "set" and key is not None:
        item = f"[{item}]" if "," in item else item or "None"
        return f'set={{"{key}": {item}}}'
    if name in ("resume", "estimate_error"):
        return f"{name}=True{flag[0][2 + len(flag[1]) :]}"
    return f"{name}={f'[{value}]' if value and ',' in value else value or ''}"


_PACKAGE = os.path.dirname(__file__) + os.sep


def regular(path: str | os.PathLike[str]) -> Path:
    """The path of a file to be read, which is no device and no pipe: these may never end."""
    mode = os.stat(path).st_mode
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        raise ResultsError(f"{os.fspath(path)}: it is a device or a pipe, not a regular file")
    return Path(path)


def warn(messages: Iterable[str]) -> None:
    """Warns at the line that called the package."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        level, frame = level + 1, frame.f_back
    for message in messages:
        # Constraints that follow from others are the rule; the notes and the mobility of the body have them.
        if not message.startswith("single forces and moments of the joint"):
            warnings.warn(message, EmmyWarning, stacklevel=level)
