"""Motions."""

from __future__ import annotations

import gc
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from numbers import Real
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _adjoint, _emmy, _plan
from . import _words as words
from ._adjoint import Goal, GoalError, Gradient, Parameter
from ._body import Body
from ._emmy import Step
from ._errors import ConvergenceError, InputError, LimitExceeded, ResultsError, fault, of_whole_input, warn
from ._history import History
from ._march import march
from ._parts import Adaptive, Initial
from ._state import Snapshot, State
from ._view import MotionView

NO_PLAN = "the motion has no plan; give steps=... or until=... with adaptive=..., or use motion.step(size)"

#: Sees each step; a true answer stops the run.
Observer = Callable[[Step, "Motion"], object]


class Motion(MotionView):
    """A body in motion. A loop over it does the steps of its plan; one that was left can be resumed.

    Parameters
    ----------
    body : Body
        Body.
    scheme : str, optional
        Scheme in time; `schemes` lists them.
    degree : int, optional
        Degree of the time elements.
    steps : pair or list of pairs, optional
        Plan: ``(until, size)`` for each phase.
    until : float, optional
        End of adaptive steps.
    adaptive : float or Adaptive, optional
        Tolerance of adaptive steps, in place of `steps`.
    initial : Initial, list of Initial or array (n, 3) or (3 n,), optional
        Velocities at the start; at rest if not given.
    start : Snapshot or State, optional
        Where the motion goes on, in place of `initial`: of a body with the same mesh and masses, and with its held
        nodes at rest. `State` tells how to give a kick.
    tolerance, max_iterations : float, int, optional
        End of Newton's iteration in a step.
    solver : str, optional
        "auto", "direct", "iterative" or "multigrid".
    smallest_step : float, optional
        Size down to which a failing step is halved.
    probes : dict, optional
        Nodes whose path goes into the history: points by name, or dicts of ``point``, ``quantities`` and
        ``relative_to``.
    reactions, joints, extremes, values : optional
        Groups of supports and names of contacts, names of joints, fields and means of fields for the history, as in the
        input.
    relative_to : str, optional
        Frame of reference of displacement, velocity, acceleration and position in the history and of `field`: "base",
        the mean motion of the driven nodes; "rigid-motion", the rigid motion that fits the body best; or the name of a
        group, the mean motion of its nodes.
    equilibrium : bool, int or dict, optional
        Whether to start from the static equilibrium; or the number of load steps.
    limits : dict, optional
        Largest ``energy`` and ``angular_momentum`` residual.
    title, units : str, optional
        Title, and system of units such as "mm-t-s".
    adjoint : bool, optional
        Whether the steps are kept for `gradient` and `goal_error`.

    Raises
    ------
    InputError
        If an argument is out of its range.
    TypeError
        If an argument has another type, or two starts are given.

    Notes
    -----
    A motion is used by one thread at a time. While it does a step, every other use raises `RuntimeError`.

    ``copy.copy(motion)`` gives a motion that continues from the same state; its history, events and adjoint begin
    there.

    Examples
    --------
    >>> body = emmy.Body(emmy.Mesh.box((1, 4, 1), (1, 4, 1)),
    ...                  emmy.Region(emmy.NeoHooke(lambda_=1000.0, mu=500.0), density=1.0))
    >>> motion = emmy.Motion(body, steps=(1.0, 0.1), initial=emmy.Initial(angular_velocity=(0, 0, 1)))
    >>> worst = max(abs(step.energy_residual) for step in motion)
    >>> worst < 1e-12 and motion.number == 10
    True
    """

    def __init__(
        self,
        body: Body,
        scheme: str = "DGM",
        degree: int = 1,
        *,
        steps: tuple[float, float] | Sequence[tuple[float, float]] | NDArray[Any] | None = None,
        until: float | None = None,
        adaptive: float | Adaptive | None = None,
        initial: Initial | Iterable[Initial] | ArrayLike = (),
        start: Snapshot | State | None = None,
        tolerance: float = 1e-10,
        max_iterations: int = 20,
        solver: str = "auto",
        smallest_step: float | None = None,
        probes: Mapping[str, Any] | None = None,
        reactions: Sequence[str] | None = None,
        joints: Sequence[str] | None = None,
        extremes: Sequence[str] | None = None,
        values: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        relative_to: str | None = None,
        equilibrium: bool | int | Mapping[str, Any] | None = None,
        limits: Mapping[str, float] | None = None,
        title: str | None = None,
        units: str | None = None,
        adjoint: bool = False,
    ) -> None:
        if not isinstance(body, Body):
            raise TypeError(f"body: {words.class_name(type(body))} is not an emmy.Body")
        if start is not None and not isinstance(start, (Snapshot, State)):
            raise TypeError(f"start: {words.class_name(type(start))} is neither an emmy.Snapshot nor an emmy.State")
        velocity, tables = _initial(initial)
        _check_one_start(start, velocity, tables, equilibrium)
        given: Snapshot | State | NDArray[np.float64] | None = start
        if velocity is not None:
            given = words.vectors(velocity, body.n_nodes, "initial")
        outputs = {
            "probes": probes, "reactions": reactions, "joints": joints, "extremes": extremes, "values": values,
            "relative_to": relative_to,
        }  # fmt: skip
        tree = _plan.tree(
            scheme=scheme, degree=degree, steps=steps, until=until, adaptive=adaptive, smallest_step=smallest_step,
            tolerance=tolerance, max_iterations=max_iterations, solver=solver, initial=tables, equilibrium=equilibrium,
            limits=limits, outputs=outputs, title=title, units=units,
        )  # fmt: skip
        self._make(body, tree, given, adjoint)
        warn(self.notes)

    def _make(
        self, body: Body, tree: dict[str, Any], start: Snapshot | State | NDArray[np.float64] | None, adjoint: bool
    ) -> None:
        _collect(body)
        native: Any = start
        if isinstance(start, Snapshot):
            native = start._native
        elif isinstance(start, State):
            native = start._tuple()
        with of_whole_input():
            self._body, self._native = body, _emmy.Motion(tree, body._native, native, adjoint)
        self._rows = self._native.rows(0)
        self._kept = []
        self._written: dict[Path, tuple[int, int]] = {}

    @classmethod
    def _of(cls, body: Body, tree: dict[str, Any], adjoint: bool) -> Motion:
        motion = cls.__new__(cls)
        motion._make(body, tree, None, adjoint)
        return motion

    def __iter__(self) -> Iterator[Step]:
        if not self._native.has_plan:
            raise RuntimeError(NO_PLAN)
        return self

    def __next__(self) -> Step:
        step = self._native.next()
        if step is None:
            if not self._native.has_plan:
                raise RuntimeError(NO_PLAN)
            warn(self._native.warnings())
            raise StopIteration
        return step

    def step(self, size: float) -> Step:
        """Does one step.

        A released support still holds during a step that begins before the release. A plan ends a step at the release.

        Parameters
        ----------
        size : float
            Its size.

        Returns
        -------
        Step

        Raises
        ------
        ConvergenceError
            If it cannot be done; the motion stays at its last step.
        LimitExceeded
            If a limit is exceeded; the step is done, see `record`.
        InputError
            If the size is not positive.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> emmy.Motion(body).step(0.1).time
        0.1
        """
        return self._native.step(size)

    def extend(self, until: float, size: float | None = None) -> None:
        """Moves the end of the plan.

        Parameters
        ----------
        until : float
            New end, after the present time.
        size : float, optional
            Size of the steps from the old end on; as before if not given.

        Raises
        ------
        InputError
            If the end lies before the present time, or the size is not positive.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> motion = emmy.Motion(body, steps=(0.2, 0.1), initial=emmy.Initial(velocity=(0, 0, 1)))
        >>> motion.extend(0.4)
        >>> len(list(motion))
        4
        """
        with of_whole_input():
            self._native.extend(until, size)

    def run(
        self,
        until: float | None = None,
        *,
        observers: Observer | Iterable[Observer] = (),
        progress: bool = False,
        output: str | os.PathLike[str] | None = None,
        every: int | None = None,
        interval: float | None = None,
        fields: Sequence[str] | None = None,
        format: Literal["vtu", "vtkhdf"] | None = None,
        precision: Literal["double", "single"] | None = None,
        checkpoint_every: int | None = None,
        log_every: int | None = None,
    ) -> History:
        """Does the steps of the plan to its end.

        Ctrl-C stops after a good step with `KeyboardInterrupt`; the motion can go on.

        Parameters
        ----------
        until : float, optional
            Time at which to stop; beyond the plan its last steps are continued. If it lies within a planned step, that
            step is cut, and later steps differ from those of a motion that does not stop.
        observers : function or list of function, optional
            Functions ``f(step, motion)``, called after each step; a true answer stops the run.
        progress : bool, optional
            Whether to show a bar, of tqdm if it is installed.
        output : str or path, optional
            Directory for everything that `emmy run` writes; `emmy.Run` reads it, `emmy resume` continues it. An earlier
            run in it is replaced, but not steps that this motion has written.
        every, interval, fields, format, precision, checkpoint_every, log_every : optional
            Frames and other files in `output`, as in the table ``[output]`` of the input. Without `output`, frames
            are kept in memory if `every` is given: the first and the last state and those after each so many steps,
            with displacement, velocity and the fields that are named in `fields`; `frames` has them.

        Returns
        -------
        History

        Raises
        ------
        ConvergenceError
            If a step cannot be done.
        LimitExceeded
            If a limit is exceeded.
        RuntimeError
            If the motion has no plan, or is at work in another thread.
        InputError
            If `until` is not finite, a setting of the files is out of its range, or the body does not have a field.
        TypeError
            If files are described without `output`, or fields without frames, or an observer is not a function.
        ResultsError
            If the files cannot be written, or `output` holds steps of this motion.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> motion = emmy.Motion(body, steps=(1.0, 0.1), initial=emmy.Initial(velocity=(0, 0, 1)))
        >>> history = motion.run(output="flight")
        >>> emmy.Run("flight").status, len(history)
        ('done', 11)
        """
        if not self._native.has_plan:
            raise RuntimeError(NO_PLAN)
        if until is not None and not math.isfinite(until):
            raise fault("until", f"must be finite, not {until}")
        functions = _functions(observers)
        directory = None if output is None else self._new_directory(output)
        if until is not None and until > self._native.end:
            self.extend(until)
        files = {
            "directory": output, "every": every, "interval": interval, "fields": fields, "format": format,
            "precision": precision, "checkpoint_every": checkpoint_every, "log_every": log_every,
        }  # fmt: skip
        given = _plan.output(files)
        if directory is None:
            self._run_in_memory(until, functions, progress, given or {})
            warn(self._native.warnings())
            return self.history
        with of_whole_input():
            self._native.open(words.tree(words.plain(given, "output"), "output"))
        first = self.number
        try:
            is_done = march(self, until, functions, progress)
        except BaseException as error:
            try:
                self._native.close(*_ending(error))
            except Exception as closing:
                # The first failure is the one to mend.
                error.add_note(f"then {type(closing).__name__}: {closing}")
            raise
        finally:
            self._written[directory] = (first, self.number)
        self._native.close("done" if is_done else "interrupted", None)
        warn(self._native.warnings())
        return self.history

    def _run_in_memory(
        self, until: float | None, observers: Sequence[Observer], progress: bool, given: Mapping[str, Any]
    ) -> None:
        others = [name for name in given if name not in ("every", "fields")]
        if others:
            raise TypeError(f"{', '.join(others)}: only with output=..., the directory of the files")
        if "fields" in given and "every" not in given:
            raise TypeError("fields: only with every=..., the steps between frames, or output=..., their directory")
        if isinstance(given.get("fields"), str):
            raise TypeError("fields: str in place of a list of names")
        every, names = words.count(given.get("every", 0), 0, "every"), tuple(given.get("fields", ()))
        if every == 0:
            march(self, until, observers, progress)
            return

        def keep(step: Step, motion: Motion) -> None:
            if step.number % every == 0:
                self._keep(names)

        try:
            self._keep(names)
        except InputError as error:
            error.faults[:] = [own._replace(place="fields") for own in error.faults]
            raise
        try:
            march(self, until, (keep, *observers), progress)
        finally:
            self._keep(names)

    def _new_directory(self, output: str | os.PathLike[str]) -> Path:
        """The directory of results, unless it holds steps of this motion, which new results would replace."""
        directory = Path(output).resolve()
        first, last = self._written.get(directory, (0, 0))
        if last > first and (directory / "history.csv").exists():
            raise ResultsError(
                f"{os.fspath(output)} holds the steps {first} to {last} of this motion; "
                "name another directory, or continue it with emmy.resume"
            )
        return directory

    def gradient(self, goal: Goal, parameters: Sequence[Parameter] = ()) -> Gradient:
        """Derivatives of a goal by the state at the start and by parameters of the body.

        Parameters
        ----------
        goal : Goal
            Quantity at the present state.
        parameters : list of Parameter, optional
            Parameters.

        Returns
        -------
        Gradient

        Raises
        ------
        RuntimeError
            If the motion was made without ``adjoint=True``, or has done no step.
        InputError
            If the adjoint does not cover the body.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> motion = emmy.Motion(body, steps=(1.0, 0.5), initial=emmy.Initial(velocity=(1, 0, 0)), adjoint=True)
        >>> history = motion.run()
        >>> goal = emmy.Goal.displacement_at(body, node=0, direction=(1, 0, 0))
        >>> round(float(motion.gradient(goal).velocity[:, 0].sum()), 9)       # a free flight of 1
        1.0
        """
        return _adjoint.gradient(self, goal, parameters)

    def goal_error(self, goal: Goal) -> GoalError:
        """Estimated error of a goal by the steps in time.

        Parameters
        ----------
        goal : Goal
            Quantity at the present state.

        Returns
        -------
        GoalError

        Raises
        ------
        RuntimeError
            If the motion was made without ``adjoint=True``, or has done no step.
        InputError
            If the adjoint does not cover the body.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> motion = emmy.Motion(body, steps=(1.0, 0.5), initial=emmy.Initial(velocity=(1, 0, 0)), adjoint=True)
        >>> history = motion.run()
        >>> goal = emmy.Goal.displacement_at(body, node=0, direction=(1, 0, 0))
        >>> motion.goal_error(goal).size < 1e-12                              # exact: nothing deforms
        True
        """
        return _adjoint.goal_error(self, goal)

    def __copy__(self) -> Motion:
        motion = type(self).__new__(type(self))
        motion._body, motion._native = self._body, self._native.copy()
        motion._rows = motion._native.rows(0)
        motion._kept = []
        motion._written = dict(self._written)
        return motion

    def __deepcopy__(self, memory: dict[int, Any]) -> Motion:
        return self.__copy__()

    def __reduce__(self) -> tuple[Any, ...]:
        raise TypeError("a Motion cannot be pickled; pickle motion.snapshot() and the body")


#: Degrees of freedom of new motions between two collections, some 20 MB.
_BETWEEN_COLLECTIONS = 20_000

#: Degrees of freedom of motions of bodies with functions, since the last collection.
_new_dofs = 0


def _collect(body: Body) -> None:
    """Collects motions to which functions of their own bodies refer: Python counts their objects, not their memory."""
    global _new_dofs
    if not (body._native.has_functions and gc.isenabled()):
        return
    _new_dofs += body._native.n_dofs
    if _new_dofs > _BETWEEN_COLLECTIONS:
        _new_dofs = 0
        gc.collect()


def _ending(error: BaseException) -> tuple[str, str | None]:
    """Status and message of a run that ends with an exception."""
    match error:
        case KeyboardInterrupt():
            return "interrupted", None
        case ConvergenceError():
            return "no-convergence", str(error)
        case LimitExceeded():
            return "limit-exceeded", str(error)
    return "failed", f"{type(error).__name__}: {error}"


def _functions(observers: Observer | Iterable[Observer]) -> tuple[Observer, ...]:
    """Observers as a tuple."""
    if callable(observers):
        return (observers,)
    if not isinstance(observers, Iterable):
        raise TypeError(f"observers: {type(observers).__name__} in place of a function or a list of functions")
    functions = tuple(observers)
    for index, function in enumerate(functions):
        if not callable(function):
            raise TypeError(f"observers[{index}]: {type(function).__name__} in place of a function")
    return functions


def _initial(initial: Any) -> tuple[ArrayLike | None, tuple[Initial, ...]]:
    """Velocities as an array or nested lists, or else as tables."""
    if hasattr(initial, "__array__"):
        return initial, ()
    if isinstance(initial, Iterable) and not isinstance(initial, str):
        initial = tuple(initial)
        if initial and isinstance(initial[0], (Real, Sequence, np.ndarray)):
            return initial, ()
    return None, words.each(initial, Initial, "initial")


def _check_one_start(start: object, velocity: ArrayLike | None, tables: Sequence[Initial], equilibrium: object) -> None:
    """Velocities as an array and `start` are whole states, beside which there is no other start."""
    is_array = velocity is not None
    others = {"initial": is_array or len(tables) > 0, "equilibrium": _plan.is_given(equilibrium)}
    if start is not None:
        for name, is_given in others.items():
            if is_given:
                raise TypeError(f"start and {name} exclude each other: start has the displacements and velocities")
    if is_array and others["equilibrium"]:
        raise TypeError(
            "an array as initial and equilibrium exclude each other: the array belongs to the undeformed body; "
            "emmy.Initial gives velocities to an equilibrium"
        )
