"""Joints between rigid bodies, nodes and the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any, Self

from . import _words as words
from ._words import History, Path, Table, Vector

#: Kinds of joints, with the arguments of each besides `between`.
KINDS: dict[str, tuple[str, ...]] = {
    "spherical": ("at",),
    "revolute": ("at", "axis"),
    "universal": ("at", "axes"),
    "cylindrical": ("at", "axis"),
    "prismatic": ("at", "axis"),
    "inline": ("at", "axis"),
    "planar": ("at", "axis"),
    "fixed": ("at",),
    "distance": ("points", "length"),
    "line": ("points",),
}


class Joint(Table):
    """A joint of two bodies, as they are drawn. One of its methods makes it, such as `Joint.revolute`.

    Parameters
    ----------
    name : str or None
        Its name in the columns of the history; ``joint-1``, ``joint-2``, ... by its place in the body if None.
    kind : str
        "spherical", "revolute", "universal", "cylindrical", "prismatic", "inline", "planar", "fixed",
        "distance" or "line".
    between : pair of str
        The two bodies: names of rigid bodies, "ground", or for spherical joints, distances, lines and (the first one)
        inline joints groups of the mesh, of which the node at the place of the joint is meant.
    at : vector, optional
        The point in common.
    axis : vector, optional
        Direction of the axis; its length does not matter.
    axes : pair of vectors, optional
        Directions of an axis of the first and of one of the second body.
    points : pair of vectors, optional
        A point of the first and one of the second body.
    length : float or history, optional
        Length of the link; a history begins with the distance of the points.
    angle : history, optional
        Given angle of the first body relative to the second about the axis, counter-clockwise seen from its tip, from 0
        on. A function comes with its rate, as a pair ``(function, rate)``.
    slide : history, optional
        Given slide of the first body relative to the second along the axis, from 0 on.
    spring : dict, optional
        A spring in the angle, over any number of turns, the slide or the length of a line: its ``stiffness``,
        and ``rest``, the angle or slide from the drawing, or the length, at which it has no force; as drawn if not
        given.
    damping : float, optional
        Force over the rate of the slide or the length, torque over that of the angle.
    torque : history, optional
        Torque on the first body about the axis.
    force : history, optional
        Force on the first body along the axis, or force that lengthens a line.
    until : float, optional
        Time of release, from which on it exerts nothing.

    Raises
    ------
    InputError
        If an argument is missing, has no place in the kind, or is out of its range.
    TypeError
        If a function in `angle`, `slide` or `length` comes without its rate.

    Examples
    --------
    >>> emmy.Joint.spherical("tip", between=("top", "ground"), at=(0, 0, 0))
    Joint.spherical('tip', between=('top', 'ground'), at=(0, 0, 0))
    """

    _section = "joint"
    name: str | None = field(kw_only=False)
    kind: str
    between: Sequence[str]
    at: Vector | None = None
    axis: Vector | None = None
    axes: Sequence[Vector] | None = None
    points: Sequence[Vector] | None = None
    length: Path | None = None
    angle: Path | None = None
    slide: Path | None = None
    spring: Mapping[str, float] | None = None
    damping: float | None = None
    torque: History | None = None
    force: History | None = None
    until: float | None = None

    def _tree(self) -> dict[str, Any]:
        own: dict[str, Any] = {}
        inner: dict[str, Any] = {}
        for key, value in self._given().items():
            if key in ("angle", "slide"):
                own[key] = words.path(value, key)
            elif key in ("torque", "force"):
                own[key] = words.history(value, key)
            elif key in ("name", "spring", "damping", "until"):
                own[key] = words.tree(value, key)
            elif key == "length":
                # A number is the length as drawn, a history begins with it.
                inner[key] = value if isinstance(value, (int, float)) else words.path(value, key)
            elif key != "kind":
                inner[key] = words.tree(value, key)
        return {key: value for key, value in own.items() if value is not None} | {str(self.kind): inner}

    def __repr__(self) -> str:
        given = self._given()
        name = "" if given.pop("name", None) is None else f"{self.name!r}, "
        kind = given.pop("kind")
        return f"Joint.{kind}({name}{', '.join(f'{key}={value!r}' for key, value in given.items())})"

    @classmethod
    def spherical(
        cls,
        name: str | None = None,
        *,
        between: Sequence[str],
        at: Vector,
        until: float | None = None,
    ) -> Self:
        """A point in common.

        Parameters
        ----------
        name : str or None, optional
            Name in the columns of the history; ``joint-1``, ... by its place if not given.
        between : pair of str
            Names of the two bodies.
        at : vector
            The point in common.
        until : float, optional
            Time of release.

        Returns
        -------
        Joint

        Raises
        ------
        InputError
            If a value is out of its range.

        Examples
        --------
        >>> emmy.Joint.spherical(between=("tip", "ball"), at=(1, 0, 0)).kind
        'spherical'
        """
        return cls(name, kind="spherical", between=between, at=at, until=until)

    @classmethod
    def revolute(
        cls,
        name: str | None = None,
        *,
        between: Sequence[str],
        at: Vector,
        axis: Vector,
        angle: Path | None = None,
        spring: Mapping[str, float] | None = None,
        damping: float | None = None,
        torque: History | None = None,
        until: float | None = None,
    ) -> Self:
        """A hinge: a point and an axis in common.

        Parameters
        ----------
        name : str or None, optional
            Name in the columns of the history; ``joint-1``, ... by its place if not given.
        between : pair of str
            Names of the two bodies.
        at : vector
            The point in common.
        axis : vector
            Direction of the axis.
        angle : history, optional
            Given angle, from 0 on.
        spring : dict, optional
            A spring: ``stiffness`` and ``rest``.
        damping : float, optional
            Damping.
        torque : history, optional
            Torque on the first body.
        until : float, optional
            Time of release.

        Returns
        -------
        Joint

        Raises
        ------
        InputError
            If a value is out of its range.
        TypeError
            If a given motion is a function without its rate.

        Examples
        --------
        >>> emmy.Joint.revolute("hinge", between=("door", "ground"), at=(0, 0, 0), axis=(0, 0, 1), angle="t^2")
        Joint.revolute('hinge', between=('door', 'ground'), at=(0, 0, 0), axis=(0, 0, 1), angle='t^2')
        """
        return cls(
            name, kind="revolute", between=between, at=at, axis=axis, angle=angle, spring=spring, damping=damping,
            torque=torque, until=until,
        )  # fmt: skip

    @classmethod
    def universal(
        cls,
        name: str | None = None,
        *,
        between: Sequence[str],
        at: Vector,
        axes: Sequence[Vector],
        until: float | None = None,
    ) -> Self:
        """A point in common, and an angle between an axis of each.

        Parameters
        ----------
        name : str or None, optional
            Name in the columns of the history; ``joint-1``, ... by its place if not given.
        between : pair of str
            Names of the two bodies.
        at : vector
            The point in common.
        axes : pair of vectors
            Directions of an axis of the first and of one of the second body.
        until : float, optional
            Time of release.

        Returns
        -------
        Joint

        Raises
        ------
        InputError
            If a value is out of its range.

        Examples
        --------
        >>> emmy.Joint.universal("cross", between=("a", "b"), at=(0, 0, 0), axes=[(1, 0, 0), (0, 1, 0)]).axes
        ((1, 0, 0), (0, 1, 0))
        """
        return cls(name, kind="universal", between=between, at=at, axes=axes, until=until)

    @classmethod
    def cylindrical(
        cls,
        name: str | None = None,
        *,
        between: Sequence[str],
        at: Vector,
        axis: Vector,
        angle: Path | None = None,
        spring: Mapping[str, float] | None = None,
        damping: float | None = None,
        torque: History | None = None,
        until: float | None = None,
    ) -> Self:
        """An axis in common, about which they turn and along which they slide.

        Parameters
        ----------
        name : str or None, optional
            Name in the columns of the history; ``joint-1``, ... by its place if not given.
        between : pair of str
            Names of the two bodies.
        at : vector
            The point in common.
        axis : vector
            Direction of the axis.
        angle : history, optional
            Given angle, from 0 on.
        spring : dict, optional
            A spring: ``stiffness`` and ``rest``.
        damping : float, optional
            Damping.
        torque : history, optional
            Torque on the first body.
        until : float, optional
            Time of release.

        Returns
        -------
        Joint

        Raises
        ------
        InputError
            If a value is out of its range.
        TypeError
            If a given motion is a function without its rate.

        Examples
        --------
        >>> emmy.Joint.cylindrical("bush", between=("ring", "ground"), at=(0, 0, 0), axis=(0, 0, 1)).axis
        (0, 0, 1)
        """
        return cls(
            name, kind="cylindrical", between=between, at=at, axis=axis, angle=angle, spring=spring, damping=damping,
            torque=torque, until=until,
        )  # fmt: skip

    @classmethod
    def prismatic(
        cls,
        name: str | None = None,
        *,
        between: Sequence[str],
        at: Vector,
        axis: Vector,
        slide: Path | None = None,
        spring: Mapping[str, float] | None = None,
        damping: float | None = None,
        force: History | None = None,
        until: float | None = None,
    ) -> Self:
        """A slider: an axis in common, along which they slide without turning.

        Parameters
        ----------
        name : str or None, optional
            Name in the columns of the history; ``joint-1``, ... by its place if not given.
        between : pair of str
            Names of the two bodies.
        at : vector
            The point in common.
        axis : vector
            Direction of the axis.
        slide : history, optional
            Given slide, from 0 on.
        spring : dict, optional
            A spring: ``stiffness`` and ``rest``.
        damping : float, optional
            Damping.
        force : history, optional
            Force on the first body.
        until : float, optional
            Time of release.

        Returns
        -------
        Joint

        Raises
        ------
        InputError
            If a value is out of its range.
        TypeError
            If a given motion is a function without its rate.

        Examples
        --------
        >>> ends = ("cart", "ground")
        >>> emmy.Joint.prismatic("rail", between=ends, at=(0, 0, 0), axis=(1, 0, 0), slide="0.1*t^2").slide
        '0.1*t^2'
        """
        return cls(
            name, kind="prismatic", between=between, at=at, axis=axis, slide=slide, spring=spring, damping=damping,
            force=force, until=until,
        )  # fmt: skip

    @classmethod
    def inline(
        cls,
        name: str | None = None,
        *,
        between: Sequence[str],
        at: Vector,
        axis: Vector,
        until: float | None = None,
    ) -> Self:
        """A point of the first body on an axis of the second.

        Parameters
        ----------
        name : str or None, optional
            Name in the columns of the history; ``joint-1``, ... by its place if not given.
        between : pair of str
            Names of the two bodies.
        at : vector
            The point in common.
        axis : vector
            Direction of the axis.
        until : float, optional
            Time of release.

        Returns
        -------
        Joint

        Raises
        ------
        InputError
            If a value is out of its range.

        Examples
        --------
        >>> emmy.Joint.inline("slot", between=("pin", "ground"), at=(0, 0, 0), axis=(1, 0, 0)).kind
        'inline'
        """
        return cls(name, kind="inline", between=between, at=at, axis=axis, until=until)

    @classmethod
    def planar(
        cls,
        name: str | None = None,
        *,
        between: Sequence[str],
        at: Vector,
        axis: Vector,
        until: float | None = None,
    ) -> Self:
        """A plane in common, normal to the axis.

        Parameters
        ----------
        name : str or None, optional
            Name in the columns of the history; ``joint-1``, ... by its place if not given.
        between : pair of str
            Names of the two bodies.
        at : vector
            The point in common.
        axis : vector
            Direction of the axis.
        until : float, optional
            Time of release.

        Returns
        -------
        Joint

        Raises
        ------
        InputError
            If a value is out of its range.

        Examples
        --------
        >>> emmy.Joint.planar("table", between=("puck", "ground"), at=(0, 0, 0), axis=(0, 0, 1)).kind
        'planar'
        """
        return cls(name, kind="planar", between=between, at=at, axis=axis, until=until)

    @classmethod
    def fixed(
        cls,
        name: str | None = None,
        *,
        between: Sequence[str],
        at: Vector,
        until: float | None = None,
    ) -> Self:
        """Two bodies made one.

        Parameters
        ----------
        name : str or None, optional
            Name in the columns of the history; ``joint-1``, ... by its place if not given.
        between : pair of str
            Names of the two bodies.
        at : vector
            The point in common.
        until : float, optional
            Time of release.

        Returns
        -------
        Joint

        Raises
        ------
        InputError
            If a value is out of its range.

        Examples
        --------
        >>> emmy.Joint.fixed("weld", between=("arm", "hand"), at=(1, 0, 0)).between
        ('arm', 'hand')
        """
        return cls(name, kind="fixed", between=between, at=at, until=until)

    @classmethod
    def distance(
        cls,
        name: str | None = None,
        *,
        between: Sequence[str],
        points: Sequence[Vector],
        length: Path | None = None,
        until: float | None = None,
    ) -> Self:
        """A rigid link without mass between two points.

        Parameters
        ----------
        name : str or None, optional
            Name in the columns of the history; ``joint-1``, ... by its place if not given.
        between : pair of str
            Names of the two bodies.
        points : pair of vectors
            A point of the first and one of the second body.
        length : float or history, optional
            Length of the link; a history begins with the distance of the points.
        until : float, optional
            Time of release.

        Returns
        -------
        Joint

        Raises
        ------
        InputError
            If a value is out of its range.
        TypeError
            If a given motion is a function without its rate.

        Examples
        --------
        >>> emmy.Joint.distance("rod", between=("bob", "ground"), points=[(0, 0, -1), (0, 0, 0)]).points
        ((0, 0, -1), (0, 0, 0))
        """
        return cls(name, kind="distance", between=between, points=points, length=length, until=until)

    @classmethod
    def line(
        cls,
        name: str | None = None,
        *,
        between: Sequence[str],
        points: Sequence[Vector],
        spring: Mapping[str, float] | None = None,
        damping: float | None = None,
        force: History | None = None,
        until: float | None = None,
    ) -> Self:
        """No constraint: a line between two points with a spring, a damping or a force.

        Parameters
        ----------
        name : str or None, optional
            Name in the columns of the history; ``joint-1``, ... by its place if not given.
        between : pair of str
            Names of the two bodies.
        points : pair of vectors
            A point of the first and one of the second body.
        spring : dict, optional
            A spring: ``stiffness`` and ``rest``.
        damping : float, optional
            Damping.
        force : history, optional
            Force on the first body.
        until : float, optional
            Time of release.

        Returns
        -------
        Joint

        Raises
        ------
        InputError
            If a value is out of its range.

        Examples
        --------
        >>> points = [(0, 0, -1), (0, 0, 0)]
        >>> emmy.Joint.line("strut", between=("bob", "ground"), points=points, spring={"stiffness": 40.0}).spring
        {'stiffness': 40.0}
        """
        return cls(
            name, kind="line", between=between, points=points, spring=spring, damping=damping, force=force, until=until,
        )  # fmt: skip
