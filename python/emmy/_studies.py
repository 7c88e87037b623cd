"""Studies and parts of runs: convergence, modes, equilibrium, inputs as problems."""

from __future__ import annotations

import json
import os
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _emmy
from . import _words as words
from ._body import Body
from ._errors import ConvergenceError, of_whole_input, regular, warn
from ._history import record_array, to_pandas
from ._mesh import Mesh
from ._motion import Motion
from ._results import read_table, stamp
from ._run import StrPath, call, directory_of, flags
from ._state import Snapshot, State
from ._tables import contacts, couplings, joints, loads, masses, regions, rigid, supports, ties

#: Tables of the input that describe the body.
BODY_KEYS = ("mesh", "region", "support", "load", "mass", "tie", "rigid", "joint", "coupling", "contact")


@dataclass(frozen=True, eq=False)
class Convergence:
    """Errors over step sizes.

    Attributes
    ----------
    table : structured array
        A row for each size: ``step_size``, ``error``, ``order``, ``relative_error``, ``newton_iterations``,
        ``wall_seconds``; NaN where there is no value. If a size failed, only ``convergence.csv`` is read, which has no
        ``relative_error`` and no ``newton_iterations``.
    reference : dict
        The reference: its scheme, degree and step size.
    failures : dict of float to str
        Message of each size that failed.

    Examples
    --------
    >>> study = emmy.converge(emmy.new("spinning-block"), sizes=[0.004, 0.002], reference=0.0005, to=0.04)
    >>> bool(1.9 < study.order[-1] < 2.1)                      # a scheme of second order
    True
    """

    table: NDArray[Any]
    reference: dict[str, Any]
    failures: dict[float, str]

    def to_pandas(self) -> Any:
        """The table as a data frame of pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each size.

        Raises
        ------
        ImportError
            If pandas is not installed.

        Examples
        --------
        >>> study = emmy.converge(emmy.new("spinning-block"), sizes=[0.004, 0.002], reference=0.0005, to=0.04)
        >>> study.to_pandas()["step_size"].tolist()
        [0.004, 0.002]
        """
        return to_pandas(self.table)

    @property
    def step_size(self) -> NDArray[np.float64]:
        """Step sizes."""
        own: NDArray[np.float64] = self.table["step_size"]
        return own

    @property
    def error(self) -> NDArray[np.float64]:
        """Errors."""
        own: NDArray[np.float64] = self.table["error"]
        return own

    @property
    def order(self) -> NDArray[np.float64]:
        """Order of convergence from each size to the next smaller one; NaN in the first row."""
        own: NDArray[np.float64] = self.table["order"]
        return own


def converge(
    path: StrPath,
    sizes: Sequence[float],
    *,
    reference: float | None = None,
    reference_scheme: str | None = None,
    reference_degree: int | None = None,
    start: float | None = None,
    to: float | None = None,
    window: tuple[float, float] | None = None,
    set: Mapping[str, Any] | None = None,
    output: StrPath | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> Convergence:
    """Measures the error over the step size, as `emmy converge`.

    Parameters
    ----------
    path : str or path
        Input file.
    sizes : list of float
        Step sizes.
    reference, reference_scheme, reference_degree : optional
        Step size, scheme and degree of the reference; a tenth of the smallest size, and those of the input.
    start : float, optional
        Time from which on each run has its own step size (the flag ``--from``); the start if not given.
    to, window : optional
        Time at which the runs end, and times between which the error is measured.
    set, output, threads, progress : optional
        As in `run`.

    Returns
    -------
    Convergence

    Raises
    ------
    InputError
        If the input or a size is bad.
    ConvergenceError
        If the reference cannot be computed; sizes that fail are in the failures of the study.
    ResultsError
        If the files cannot be written, or `output` holds other files.

    Examples
    --------
    >>> study = emmy.converge(emmy.new("spinning-block"), sizes=[0.004, 0.002], reference=0.0005, to=0.04)
    >>> study.step_size.tolist()
    [0.004, 0.002]
    """
    directory = Path(f"{directory_of(path, set or {})}-convergence" if output is None else output)
    before = stamp(directory / "convergence.csv")
    texts = {"sizes": ",".join(map(repr, map(float, sizes)))}
    if window is not None:
        texts["window"] = ",".join(map(repr, map(float, window)))
    given: dict[str, Any] = {
        "reference": reference, "reference_scheme": reference_scheme, "reference_degree": reference_degree,
        "from": start, "to": to, "set": set, "output": directory, "threads": threads,
    }  # fmt: skip
    try:
        study = json.loads(call("converge", path, progress=progress, quiet=not progress, json=True, **texts, **given))
    except ConvergenceError as error:
        # Failed sizes end a complete study with an error.
        if stamp(directory / "convergence.csv") == before:
            raise
        rows = read_table(directory / "convergence.csv")
        table = _table([dict(zip(rows.dtype.names or (), row.tolist(), strict=True)) for row in rows])
        time = tomllib.loads(regular(directory / "study.toml").read_text(encoding="utf-8"))["time"]
        own_reference = {
            "scheme": reference_scheme or time["scheme"],
            "degree": reference_degree or time["degree"],
            "step_size": reference or 0.1 * min(map(float, sizes)),
        }
        return Convergence(table, own_reference, _failures(table, error.message))
    return Convergence(_table(study["rows"]), study["reference"], {})


_COLUMNS = ("step_size", "error", "order", "relative_error", "newton_iterations", "wall_seconds")


def _table(rows: Sequence[Mapping[str, Any]]) -> NDArray[Any]:
    """The table of a study from its rows; a number that a row does not have is NaN."""
    numbers = {name: [row.get(name) for row in rows] for name in _COLUMNS}
    return record_array({name: [np.nan if own is None else float(own) for own in numbers[name]] for name in numbers})


def _failures(table: NDArray[Any], message: str) -> dict[float, str]:
    """The messages of the sizes that failed, which the message of the study lists in their order."""
    own = message.removesuffix("; the other members are written")
    messages = [part.strip() for part in re.split(r"^h = \S+: ", own, flags=re.M)[1:]]
    failed = table["step_size"][np.isnan(table["error"])]
    return dict(zip(failed.tolist(), messages, strict=True))


@dataclass(frozen=True, eq=False)
class Modes:
    """Natural modes.

    Attributes
    ----------
    frequencies : array (count,)
        Frequencies in cycles per time; 0 for a rigid mode.
    shapes : array (count, n, 3)
        Mode shapes v with v M v = 1; for an observer that turns one moment of each vibration, in which points run
        through ellipses.
    effective_masses : array (count, 3)
        Effective masses along x, y and z.
    rigid : int
        Number of rigid modes.
    residuals : array (count,)
        Relative residuals, at most 1e-6: about the relative errors that the iteration leaves in squared frequencies.
        For an observer that turns, those of the space of real modes, without bound.

    Examples
    --------
    >>> body = emmy.Body(emmy.Mesh.box((1, 4, 1), (1, 4, 1)), emmy.Region(emmy.NeoHooke(lambda_=10, mu=5), density=1))
    >>> emmy.modes(body).rigid                          # of a free body
    6
    """

    frequencies: NDArray[np.float64]
    shapes: NDArray[np.float64]
    effective_masses: NDArray[np.float64]
    rigid: int
    residuals: NDArray[np.float64]


def modes(body: Body, count: int = 10, *, state: State | Snapshot | None = None) -> Modes:
    """Natural modes of a body about its reference configuration, or about a state such as an equilibrium.

    With a load `rotation`, modes about a state have the frequencies that its observer sees, who turns: the centrifugal
    force softens the body, and the Coriolis force couples its modes. They are found in the space of twice as many real
    modes as are wanted, and `residuals` tell what the others would add.

    Parameters
    ----------
    body : Body
        Body.
    count : int, optional
        Number of modes, rigid ones included.
    state : State or Snapshot, optional
        Equilibrium, or another state whose positions count as those of a body at rest: its velocities have no effect.
        The body itself has no start; that of an input is ``problem.motion().state``.

    Returns
    -------
    Modes

    Raises
    ------
    InputError
        If the number is not positive.
    TypeError
        If `body` is not a `Body`, or `state` is neither a `State` nor a `Snapshot`.
    ConvergenceError
        If a residual exceeds 1e-6, or an observer turns faster than the body is stable.

    Examples
    --------
    >>> body = emmy.Body(emmy.Mesh.box((1, 4, 1), (1, 4, 1)), emmy.Region(emmy.NeoHooke(lambda_=10, mu=5), density=1))
    >>> modes = emmy.modes(body, count=7)
    >>> modes.shapes.shape, bool(modes.frequencies[6] > 0.0)
    ((7, 20, 3), True)
    """
    about: Any = state._native if isinstance(state, Snapshot) else None
    if about is None and state is not None:
        about = words.one(state, State, "state")._tuple()
    own = words.one(body, Body, "body")._native.modes(words.count(count, 1, "count"), about)
    return Modes(own["frequencies"], own["shapes"], own["effective_masses"], own["rigid"], own["residuals"])


def equilibrium(body: Body, load_steps: int = 10, *, tolerance: float = 1e-10, max_iterations: int = 20) -> State:
    """Static equilibrium under the loads at t = 0.

    Parameters
    ----------
    body : Body
        Body, which supports must hold.
    load_steps : int, optional
        Increments in which the loads grow.
    tolerance, max_iterations : float, int, optional
        End of Newton's iteration in an increment.

    Returns
    -------
    State

    Raises
    ------
    InputError
        If the body can move freely; the message names the rigid motions.
    ConvergenceError
        If there is no equilibrium.
    TypeError
        If `body` is not a `Body`.

    Examples
    --------
    >>> body = emmy.Body(emmy.Mesh.box((1, 1, 1), (2, 2, 2)), emmy.Region(emmy.NeoHooke(lambda_=10, mu=5), density=1),
    ...                  emmy.Support("z-min", fix="xyz"), emmy.Load(acceleration=(0, 0, -1)))
    >>> bool(emmy.equilibrium(body).displacement[:, 2].min() < 0)          # it sags
    True
    """
    settings = {"newton": {"tolerance": tolerance, "max_iterations": max_iterations}}
    with of_whole_input():
        native = words.one(body, Body, "body")._native
        return State(*native.equilibrium(words.count(load_steps, 1, "load_steps"), settings))


class Problem:
    """An input file that was read: a body and its motion.

    `load` makes it.

    Examples
    --------
    >>> problem = emmy.load(emmy.new("l-block"))
    >>> problem.title
    'L-shaped block, large strain'
    """

    def __init__(self, native: _emmy.Problem, path: Path, changes: Mapping[str, Any], until: float | None) -> None:
        self._native = native
        self._path, self._changes, self._until = path, dict(changes), until
        tree = tomllib.loads(native.toml)
        mesh = Mesh._of(native.mesh())
        self._body = Body(
            mesh,
            regions(tree),
            supports(tree),
            loads(tree),
            masses(tree),
            ties(tree),
            rigid(tree),
            joints(tree),
            couplings(tree),
            contacts(tree),
        )
        self._tree = {key: table for key, table in tree.items() if key not in BODY_KEYS}

    @property
    def path(self) -> Path:
        """The file."""
        return self._path

    @property
    def title(self) -> str | None:
        """Title of the input."""
        return self._native.title

    @property
    def body(self) -> Body:
        """The body."""
        return self._body

    @property
    def toml(self) -> str:
        """The input with all defaults and changes."""
        return self._native.toml

    @property
    def notes(self) -> list[str]:
        """Notes of the reader on the input."""
        return self._native.notes

    def motion(self, *, adjoint: bool = False) -> Motion:
        """A motion with all settings of the input, at its start.

        Parameters
        ----------
        adjoint : bool, optional
            Whether the steps are kept for `Motion.gradient`.

        Returns
        -------
        Motion

        Examples
        --------
        >>> motion = emmy.load(emmy.new("l-block")).motion()
        >>> next(motion).time
        0.01
        """
        motion = Motion._of(self._body, self._tree, adjoint)
        warn(motion.notes)
        return motion

    def __repr__(self) -> str:
        return f"<emmy.Problem: {self._path}>"


def load(path: StrPath, *, set: Mapping[str, Any] | None = None, until: float | None = None) -> Problem:
    """Reads an input file.

    Parameters
    ----------
    path : str or path
        Input file.
    set : dict, optional
        Values of dotted keys, as in `run`.
    until : float, optional
        End of the run.

    Returns
    -------
    Problem

    Raises
    ------
    InputError
        If the input is bad.

    Examples
    --------
    >>> emmy.load(emmy.new("l-block"), set={"mesh.l-block.cell_size": 0.5}).body.mesh.n_cells
    936
    """
    changes = [flag.removeprefix("--set=") for flag in flags(set=set)]
    return Problem(_emmy.Problem(os.fspath(path), changes, until), Path(path), set or {}, until)
