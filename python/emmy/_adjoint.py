"""Gradients and errors of a goal, from the adjoint of a motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from . import _emmy
from . import _words as words
from ._body import Body

if TYPE_CHECKING:
    from ._motion import Motion


class Goal:
    """A quantity at the end of a motion, linear in its state; made by `displacement_at` and `velocity_at`.

    Examples
    --------
    >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
    >>> motion = emmy.Motion(body, steps=(1.0, 0.1), initial=emmy.Initial(velocity=(2, 0, 0)))
    >>> history = motion.run()
    >>> round(emmy.Goal.displacement_at(body, node=0, direction=(1, 0, 0)).value(motion), 12)
    2.0
    """

    def __init__(self, native: _emmy.Goal) -> None:
        self._native = native

    @classmethod
    def displacement_at(cls, body: Body, node: int, direction: words.Vector) -> Self:
        """Displacement of a node along a direction.

        Parameters
        ----------
        body : Body
            Body.
        node : int
            Node.
        direction : vector
            Direction.

        Returns
        -------
        Goal

        Raises
        ------
        InputError
            If there is no such node, or the direction has not three finite numbers.
        TypeError
            If `body` is not a `Body`, or `node` is not a whole number.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> emmy.Goal.displacement_at(body, node=0, direction=(0, 1, 0)).value(emmy.Motion(body))
        0.0
        """
        own = words.count(node, 0, "node")
        along = words.finite(direction, (3,), "direction").tolist()
        return cls(_emmy.Goal.displacement_at(words.one(body, Body, "body")._native, own, along))

    @classmethod
    def velocity_at(cls, body: Body, node: int, direction: words.Vector) -> Self:
        """Velocity of a node along a direction.

        Parameters
        ----------
        body : Body
            Body.
        node : int
            Node.
        direction : vector
            Direction.

        Returns
        -------
        Goal

        Raises
        ------
        InputError
            If there is no such node, or the direction has not three finite numbers.
        TypeError
            If `body` is not a `Body`, or `node` is not a whole number.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> motion = emmy.Motion(body, initial=emmy.Initial(velocity=(0, 3, 0)))
        >>> emmy.Goal.velocity_at(body, node=0, direction=(0, 1, 0)).value(motion)
        3.0
        """
        own = words.count(node, 0, "node")
        along = words.finite(direction, (3,), "direction").tolist()
        return cls(_emmy.Goal.velocity_at(words.one(body, Body, "body")._native, own, along))

    def value(self, motion: Motion) -> float:
        """Value at the present state of a motion.

        Parameters
        ----------
        motion : Motion
            Motion.

        Returns
        -------
        float

        Raises
        ------
        InputError
            If the motion is of a body with another number of nodes.
        TypeError
            If `motion` is not a `Motion`.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> goal = emmy.Goal.velocity_at(body, node=0, direction=(0, 0, 1))
        >>> goal.value(emmy.Motion(body, initial=emmy.Initial(velocity=(0, 0, 2))))
        2.0
        """
        # At the head of the file this import would be a cycle.
        from ._motion import Motion

        return self._native.value(words.one(motion, Motion, "motion")._native)


class Parameter:
    """A parameter of a body, by which a goal is differentiated.

    Parameters
    ----------
    value : float
        Its value.
    body : function
        Makes the body for a value.
    linear : bool, optional
        Whether the forces are linear in the parameter, as in Lame's parameters, densities and dead loads; then one wide
        difference is exact, of two bodies in place of six. In anything else, such as an exponent, Poisson's ratio or
        the place of a node, it would be wrong.
    scale : float, optional
        Size of a significant change; the value if not given. Bodies are made for values up to 3/200 of it away, with
        ``linear=True`` half of it.

    Raises
    ------
    InputError
        If the scale is not positive.
    TypeError
        If `body` does not return a `Body`.

    Examples
    --------
    >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    >>> def block(mu):
    ...     return emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1.0, mu=mu), density=1.0))
    >>> emmy.Parameter(2.0, block).value
    2.0
    """

    def __init__(
        self, value: float, body: Callable[[float], Body], *, linear: bool = False, scale: float | None = None
    ) -> None:
        def native(varied: float) -> _emmy.Body:
            try:
                made = body(varied)
            except Exception as error:
                error.add_note(
                    f"Parameter: this is the body for {varied:.6g}; a smaller `scale` stays closer to {value:.6g}"
                )
                raise
            if not isinstance(made, Body):
                raise TypeError(
                    f"body: the function {words.name_of(body)} returned {words.class_name(type(made))} in place of an "
                    "emmy.Body"
                )
            return made._native

        self._native = _emmy.Parameter(value, native, linear, abs(value) if scale is None else scale)
        self._value = value

    @property
    def value(self) -> float:
        """The value."""
        return self._value


@dataclass(frozen=True, eq=False)
class Gradient:
    """Derivatives of a goal.

    Attributes
    ----------
    displacement, velocity, momentum : array (n, 3)
        By the state at the start.
    parameters : array (m,)
        By the parameters. With ``equilibrium=True`` the displacement at the start changes with them; any other start
        does not.

    Examples
    --------
    >>> emmy.Gradient.__annotations__["parameters"]
    'NDArray[np.float64]'
    """

    displacement: NDArray[np.float64]
    velocity: NDArray[np.float64]
    momentum: NDArray[np.float64]
    parameters: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GoalError:
    """Estimated error of a goal by the steps in time.

    Attributes
    ----------
    steps : array
        Contribution of each step.
    total : float
        Their sum.
    size : float
        Sum of their absolute values.

    Examples
    --------
    >>> emmy.GoalError(np.array([1.0, -3.0]), -2.0, 4.0).total
    -2.0
    """

    steps: NDArray[np.float64]
    total: float
    size: float


def gradient(motion: Motion, goal: Goal, parameters: Sequence[Parameter]) -> Gradient:
    """The gradient of a goal at the end of a motion."""
    natives = [parameter._native for parameter in words.each(parameters, Parameter, "parameters")]
    own = motion._native.gradient(words.one(goal, Goal, "goal")._native, natives)
    return Gradient(own.displacement, own.velocity, own.momentum, own.parameters)


def goal_error(motion: Motion, goal: Goal) -> GoalError:
    """The error of a goal at the end of a motion."""
    own = motion._native.goal_error(words.one(goal, Goal, "goal")._native)
    return GoalError(own.steps, own.total, own.size)
