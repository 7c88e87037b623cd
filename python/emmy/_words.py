"""The input as Python objects: tables with checked keys, which turn into the tree of the input."""

from __future__ import annotations

import dataclasses
import difflib
import functools
import math
import numbers
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, ClassVar, TypeAlias, TypeVar, dataclass_transform

import numpy as np
from numpy.typing import NDArray

from . import _emmy
from ._errors import fault

#: Three numbers.
Vector: TypeAlias = Sequence[float] | NDArray[Any]
#: A function of the time.
Function: TypeAlias = Callable[[float], float]
#: A function of the points `(n, 3)` and the time with a vector for each point, `(n, 3)`.
VectorField: TypeAlias = Callable[[NDArray[np.float64], float], NDArray[np.float64]]
#: A factor over time: a number, pairs of time and factor, an expression, two columns of a file, or a function.
History: TypeAlias = float | str | Sequence[Sequence[float]] | NDArray[Any] | Mapping[str, Any] | Function
#: A history whose rate matters: a function comes with its rate.
Path: TypeAlias = float | str | Sequence[Sequence[float]] | NDArray[Any] | Mapping[str, Any] | tuple[Function, Function]

#: Largest number of a node or cell.
LARGEST = 2**32 - 2

T = TypeVar("T")


@dataclass_transform(kw_only_default=True, frozen_default=True, field_specifiers=(dataclasses.field,))
class Table:
    """A table of the input: a frozen dataclass, whose values the reader of the input checks when it is made."""

    #: Name of the table in the input.
    _section: ClassVar[str]

    def __init_subclass__(cls, **arguments: Any) -> None:
        super().__init_subclass__(**arguments)
        is_own = "__init__" in cls.__dict__
        dataclasses.dataclass(frozen=True, kw_only=True, repr=False)(cls)
        if is_own:
            return
        init = cls.__init__
        names = [field.name for field in _fields(cls)]

        @functools.wraps(init)
        def checked(self: Table, *values: Any, **keywords: Any) -> None:
            for name in keywords:
                if name not in names:
                    raise TypeError(_unknown(type(self), name, names))
            init(self, *values, **keywords)

        setattr(cls, "__init__", checked)

    def __post_init__(self) -> None:
        for field in _fields(self):
            object.__setattr__(self, field.name, plain(getattr(self, field.name), field.name))
        self._check()

    def _check(self) -> None:
        _emmy.check(self._section, self._tree())

    def _given(self) -> dict[str, Any]:
        """The arguments that are not at their default, by name."""
        values = ((field, getattr(self, field.name)) for field in _fields(self))
        return {
            field.name: value
            for field, value in values
            if field.default is dataclasses.MISSING or not same(value, field.default)
        }

    def _tree(self) -> dict[str, Any]:
        """The table in the words of the input."""
        return {name.rstrip("_"): tree(value, name) for name, value in self._given().items()}

    def __repr__(self) -> str:
        arguments = ", ".join(f"{name}={value!r}" for name, value in self._given().items())
        return f"{type(self).__name__}({arguments})"


def same(value: object, default: object) -> bool:
    """True if `value` is the default. 1 and 1.0 are equal, 1 and True are not."""
    return value is default or (type(value) is type(default) and value == default) or are_equal_numbers(value, default)


def are_equal_numbers(value: object, default: object) -> bool:
    """Whether both are equal numbers, one a float and the other an int."""
    numbers = (int, float)
    return type(value) in numbers and type(default) in numbers and value == default


def plain(value: Any, place: str) -> Any:
    """The value without arrays: numbers, text, tuples, dicts, tables and functions, which compare and print well."""
    if isinstance(value, np.generic):
        # `item` of a long double is a long double.
        return plain(float(value) if isinstance(value, np.floating) else value.item(), place)
    if isinstance(value, int):
        try:
            float(value)
        except OverflowError:
            raise fault(place, "the number is too large") from None
        return value
    if value is None or isinstance(value, (float, str, Table)):
        return value
    if isinstance(value, np.ndarray):
        if value.dtype.kind not in "fiub":
            raise TypeError(f"{place}: an array of {value.dtype} in place of numbers")
        return plain(value.tolist(), place)
    if isinstance(value, Mapping):
        return {str(key): plain(item, f"{place}.{key}") for key, item in value.items()}
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if callable(value):
        return value
    if isinstance(value, (bytes, bytearray)):
        raise TypeError(f"{place}: bytes in place of text")
    if isinstance(value, (set, frozenset)):
        return tuple(sorted(value))
    if isinstance(value, Iterable):
        return tuple(plain(item, f"{place}[{index}]") for index, item in enumerate(value))
    raise TypeError(f"{place}: {type(value).__name__} is neither a number nor text, a list, a table or a function")


def tree(value: Any, place: str) -> Any:
    """A plain value in the words of the input."""
    if isinstance(value, Table):
        return value._tree()
    if isinstance(value, Mapping):
        return {key.rstrip("_"): tree(item, f"{place}.{key}") for key, item in value.items() if item is not None}
    if isinstance(value, tuple):
        return [tree(item, f"{place}[{index}]") for index, item in enumerate(value)]
    if callable(value):
        raise TypeError(f"{place}: cannot be a function")
    return value


def history(value: Any, place: str) -> Any:
    """A plain history in the words of the input."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return [[0.0, value]]
    if callable(value):
        return _emmy.Function(value, None, name_of(value))
    return tree(value, place)


def path(value: Any, place: str) -> Any:
    """A plain history whose rate matters in the words of the input."""
    if callable(value):
        raise TypeError(
            f"{place}: a function comes with its rate, as a pair (function, rate): the method needs the velocity"
        )
    if isinstance(value, tuple) and len(value) == 2 and all(map(callable, value)):
        return _emmy.Function(value[0], value[1], name_of(value[0]))
    return history(value, place)


def field(value: Any, place: str) -> Any:
    """A plain vector, or a function of points and time, in the words of the input."""
    if callable(value):
        return _emmy.Field(value, name_of(value))
    return tree(value, place)


def functions(value: Any) -> list[Callable[..., Any]]:
    """All functions in a plain value."""
    if isinstance(value, Mapping):
        return [function for item in value.values() for function in functions(item)]
    if isinstance(value, tuple):
        return [function for item in value for function in functions(item)]
    return [value] if callable(value) and not isinstance(value, Table) else []


def name_of(function: Callable[..., Any]) -> str:
    """Name of a function for messages."""
    return str(getattr(function, "__qualname__", None) or type(function).__qualname__)


def each(value: T | Iterable[T], kind: type[T], place: str) -> tuple[T, ...]:
    """One or several objects of a class as a tuple."""
    if isinstance(value, kind):
        return (value,)
    if not isinstance(value, Iterable):
        raise TypeError(f"{place}: {class_name(type(value))} in place of {class_name(kind)} or a list of them")
    items = tuple(value)
    for index, item in enumerate(items):
        if not isinstance(item, kind):
            raise TypeError(f"{place}[{index}]: {class_name(type(item))} in place of {class_name(kind)}")
    return items


def one(value: Any, kind: type[T], place: str) -> T:
    """An object of a class."""
    if not isinstance(value, kind):
        raise TypeError(f"{place}: {class_name(type(value))} in place of {class_name(kind)}")
    return value


def class_name(kind: type) -> str:
    """Name of a class for messages, one of the package by its public place."""
    return f"emmy.{kind.__name__}" if kind.__module__.partition(".")[0] == "emmy" else kind.__name__


def mapping(value: Any, place: str) -> Mapping[str, Any]:
    """A dict."""
    if not isinstance(value, Mapping):
        raise TypeError(f"{place}: {type(value).__name__} in place of a dict")
    return value


def real(value: Any, place: str) -> float:
    """A finite number."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise TypeError(f"{place}: {type(value).__name__} in place of a number")
    own = float(plain(value, place))
    if not math.isfinite(own):
        raise fault(place, f"must be finite, not {own}")
    return own


def finite(value: Any, shape: tuple[int | None, ...], place: str) -> NDArray[np.float64]:
    """Finite numbers as a contiguous array of a shape; `None` is any length."""
    given = array(value, shape, place)
    if not np.isfinite(given).all():
        raise fault(place, "must be finite")
    return given


def array(value: Any, shape: tuple[int | None, ...], place: str) -> NDArray[np.float64]:
    """Numbers as a contiguous array of a shape; `None` is any length."""
    given = reals(value, place)
    fits = given.ndim == len(shape) and all(want in (None, got) for want, got in zip(shape, given.shape, strict=True))
    if not fits:
        wanted = str(shape).replace("None", "n")
        raise fault(place, f"expected an array of shape {wanted}, found {given.shape}")
    return given


def vectors(value: Any, n: int | None, place: str) -> NDArray[np.float64]:
    """Finite vectors of n nodes as a contiguous array (n, 3), also from the flat array (3 n,); `None` is any number."""
    given = reals(value, place)
    if given.ndim == 1 and (given.size % 3 == 0 if n is None else given.size == 3 * n):
        given = given.reshape(-1, 3)
    return finite(given, (n, 3), place)


def reals(value: Any, place: str) -> NDArray[np.float64]:
    """Numbers as a contiguous array."""
    given = regular(value, place)
    if given.dtype.kind not in "fiub" and given.size:
        found = f"an array of {given.dtype}" if given.ndim else type(value).__name__
        raise TypeError(f"{place}: {found} in place of numbers")
    # `ascontiguousarray` would make a number an array of one dimension.
    return np.asarray(given, dtype=np.float64, order="C")


def count(value: Any, least: int, place: str, most: int = LARGEST) -> int:
    """A whole number within a range."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Integral):
        raise TypeError(f"{place}: {type(value).__name__} in place of a whole number")
    own = int(value)
    if not least <= own <= most:
        raise fault(place, f"must be a whole number from {least} to {most}, not {own}")
    return own


def counts(values: Any, length: int, place: str) -> list[int]:
    """Positive whole numbers."""
    own = [count(value, 1, f"{place}[{index}]") for index, value in enumerate(values)]
    if len(own) != length:
        raise fault(place, f"expected {length} whole numbers, found {len(own)}")
    return own


def regular(value: Any, place: str) -> NDArray[Any]:
    """An array of values, whose rows have one length."""
    try:
        return np.asarray(value)
    except ValueError:
        raise fault(place, "its rows have different lengths") from None


def integers(value: Any, place: str) -> NDArray[np.int64]:
    """Whole numbers as a contiguous array."""
    given = regular(value, place)
    if given.size == 0:
        return np.zeros(given.shape, dtype=np.int64)
    if given.dtype.kind not in "iu":
        raise TypeError(f"{place}: an array of {given.dtype} in place of whole numbers")
    wrong = (given < 0) | (given > LARGEST)
    if wrong.any():
        row, *_ = first = np.unravel_index(int(np.argmax(wrong)), given.shape)
        raise fault(f"{place}[{row}]", f"{given[first]} is not the number of a node or cell")
    return np.ascontiguousarray(given, dtype=np.int64)


def members(value: Any, n: int, place: str) -> NDArray[np.int64]:
    """Numbers of some of n nodes or cells; a mask with a truth value for each of them chooses those that are true."""
    given = regular(value, place)
    if given.dtype.kind != "b":
        numbers = integers(given, place)
        if n > 2 and numbers.shape == (n,) and np.isin(numbers, (0, 1)).all():
            raise fault(place, "are 0 and 1 over and over, as in a mask, which has values of type bool: astype(bool)")
        return numbers
    if given.shape != (n,):
        raise fault(place, f"expected a mask of shape ({n},), found {given.shape}")
    return np.flatnonzero(given).astype(np.int64)


def _fields(table: type[Table] | Table) -> tuple[dataclasses.Field[Any], ...]:
    return dataclasses.fields(table)  # type: ignore[arg-type]


def _unknown(table: type[Table], key: str, names: list[str]) -> str:
    name, near = table.__name__, difflib.get_close_matches(key, names, n=1)
    hint = f"; did you mean {near[0]}?" if near else ""
    # A key of the input for which there is a method.
    hint = f"; see {name}.{key}" if hasattr(table, key) else hint
    return f"{name} has no argument {key}; it has: {', '.join(names)}{hint}"
