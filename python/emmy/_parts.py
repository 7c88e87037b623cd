"""Parts of a body and its start: regions, supports, loads, masses, ties, rigid bodies, initial velocities."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any, Self

from numpy.typing import NDArray

from . import _emmy
from . import _words as words
from ._errors import fault
from ._materials import Material
from ._words import History, Path, Table, Vector, VectorField


class Viscosity(Table):
    """Viscosity of Kelvin and Voigt: the stress ``time D : E' + 2 shear dev E' + bulk tr(E') I``.

    Parameters
    ----------
    time : float, optional
        Time by which the stiffness at rest is multiplied: stiffness-proportional (Rayleigh) damping.
    shear, bulk : float, optional
        Shear and bulk viscosity.

    Raises
    ------
    InputError
        If none is given, or a value is not positive; in `Region`, if a material of links has another than ``time``.

    Examples
    --------
    >>> emmy.Viscosity(time=1e-3)
    Viscosity(time=0.001)
    """

    _section = "viscosity"
    time: float | None = None
    shear: float | None = None
    bulk: float | None = None


class Region(Table):
    """Cells with a material and a density.

    Parameters
    ----------
    material : Material
        Material, such as `NeoHooke`.
    density : float, optional
        Mass per reference volume; springs and attractions have none.
    group : str, optional
        Group of cells; with one region every cell.
    thickness : float, optional
        Thickness of cells in plane strain, 1 if not given.
    viscosity : Viscosity, optional
        Viscosity.
    formulation : str, optional
        "standard" (default), "projected-volume" or "incompatible-modes".
    pressure : str, optional
        "constant" or "linear", with "projected-volume".

    Raises
    ------
    InputError
        If a value is out of its range.
    TypeError
        If `material` is not a material.

    Examples
    --------
    >>> rubber = emmy.NeoHookeIsochoric(mu=0.5, bulk_modulus=1000.0)
    >>> emmy.Region(rubber, density=1.1e-9, formulation="projected-volume").density
    1.1e-09
    """

    _section = "region"
    material: Material = field(kw_only=False)
    density: float | None = None
    group: str | None = None
    thickness: float = 1.0
    viscosity: Viscosity | None = None
    formulation: str | None = None
    pressure: str | None = None

    def _check(self) -> None:
        if not isinstance(self.material, Material):
            raise TypeError(
                f"material: {words.class_name(type(self.material))} is not a material, such as emmy.NeoHooke"
            )
        super()._check()

    def _tree(self) -> dict[str, Any]:
        return super()._tree() | {"material": self.material._as_material()}


class Support(Table):
    """Nodes that are held or driven.

    Parameters
    ----------
    group : str
        Group of nodes, facets or cells.
    fix : str or list of str, optional
        Components that do not move, such as "xyz", "all" or ["x", "z"].
    move : dict, optional
        History of the displacement of components, such as ``{"x": "0.1*sin(5*t)"}``. A function comes with its
        rate, as a pair ``(function, rate)``: the method needs the velocity.
    accelerate : dict, optional
        History of the acceleration of components, from rest at the start.
    rotate : dict, optional
        Rotation of the group as a rigid body: ``axis``, ``about`` (the origin if not given), ``angle``, a history.
    symmetry : bool, optional
        Whether the facets of the group stay in their plane, which is normal to an axis.
    spring : float, optional
        Stiffness of springs to the ground, of each node; of facets per area.
    until : float, optional
        Time of release.

    Raises
    ------
    InputError
        If nothing is held or driven, or a value is out of its range.
    TypeError
        If a function in `move` or `rotate` comes without its rate.

    Examples
    --------
    >>> emmy.Support("foot", fix="xyz")
    Support(group='foot', fix=('x', 'y', 'z'))
    >>> emmy.Support("head", fix="y", move={"x": (lambda t: t**2, lambda t: 2 * t)}, until=1.0).until
    1.0
    """

    _section = "support"
    group: str = field(kw_only=False)
    fix: str | Sequence[str] = ()
    move: Mapping[str, Path] | None = None
    accelerate: Mapping[str, History] | None = None
    rotate: Mapping[str, Any] | None = None
    symmetry: bool = False
    spring: float | None = None
    until: float | None = None

    def __post_init__(self) -> None:
        if isinstance(self.fix, str):
            object.__setattr__(self, "fix", tuple("xyz" if self.fix.lower() == "all" else self.fix))
        for key in ("move", "accelerate", "rotate"):
            given = getattr(self, key)
            if given is not None and not isinstance(given, Mapping):
                raise TypeError(f"{key}: {type(given).__name__} in place of a dict")
            if not given:
                object.__setattr__(self, key, None)
        super().__post_init__()

    def _tree(self) -> dict[str, Any]:
        given = self._given()
        moved = {f"move.{axis}": words.path(value, f"move.{axis}") for axis, value in given.pop("move", {}).items()}
        driven = {
            axis: words.history(value, f"accelerate.{axis}") for axis, value in given.pop("accelerate", {}).items()
        }
        turned = dict(given.pop("rotate", {}))
        if "angle" in turned:
            turned["angle"] = words.path(turned["angle"], "rotate.angle")
        own = {key: words.tree(value, key) for key, value in given.items()}
        if moved:
            own["move"] = {key.removeprefix("move."): value for key, value in moved.items()}
        if driven:
            own["accelerate"] = driven
        if turned:
            own["rotate"] = {
                key: value if key == "angle" else words.tree(value, f"rotate.{key}") for key, value in turned.items()
            }
        return own


class Tie(Table):
    """Nodes that follow the points of another group, on which they lie.

    Parameters
    ----------
    follower : str
        Group of facets, nodes or cells, whose nodes follow.
    leader : str
        Group that they follow: its facets; if it has none its nodes, which they must meet, else its cells.
    kind : str, optional
        "mortar": by integrals over two surfaces, so that a uniform stress passes exactly between plane facets; "nodes":
        each node follows the nearest point of the leader. By default "mortar" where both groups have facets.
    tolerance : float, optional
        Largest shift of a follower onto the leader, relative to the longest edge of the facet or cell there; of a node
        onto a node, to the shortest edge at the follower.
    weights : list of float, optional
        For a follower of one node: weights of the nodes of the leader in ascending order, with the sum 1.
    partial : bool, optional
        Whether nodes beyond `tolerance`, and those of the leader itself, stay free; else they are an error.

    Raises
    ------
    InputError
        If a group follows itself, the kind is another word, or `tolerance` is negative.

    Examples
    --------
    >>> emmy.Tie("upper-face", "lower-face", tolerance=0.1)
    Tie(follower='upper-face', leader='lower-face', tolerance=0.1)
    """

    _section = "tie"
    follower: str = field(kw_only=False)
    leader: str = field(kw_only=False)
    kind: str | None = None
    tolerance: float = 0.05
    weights: Sequence[float] | NDArray[Any] | None = None
    partial: bool = False


class Rigid(Table):
    """A rigid body by its mass, a point mass, or a group of the mesh that moves as one.

    Parameters
    ----------
    name : str
        Its name in joints, columns, and as a group of one node, its centre, for loads, supports and initial velocities.
    group : str, optional
        Group of facets, nodes or cells that move with it, with their masses.
    mass : float, optional
        Mass; with `group` in addition to that of the nodes, and then not needed.
    centre : vector, optional
        Centre of mass; with `group` that of what is added and of the frame, by default the centre of mass of the cells
        of the group, of a face the mean of its nodes.
    inertia : vector or array (3, 3), optional
        Inertia about the centre: principal moments along x, y and z, or a symmetric matrix; without it and without a
        group it is a point mass.

    Raises
    ------
    InputError
        If a value is out of its range, or no body has the moments of inertia.

    Examples
    --------
    >>> emmy.Rigid("hub", mass=5.0, centre=(0, 0, 0), inertia=(1.2, 1.0, 1.5))
    Rigid(name='hub', mass=5.0, centre=(0, 0, 0), inertia=(1.2, 1.0, 1.5))
    >>> emmy.Rigid("root", group="root-face")
    Rigid(name='root', group='root-face')
    """

    _section = "rigid"
    name: str = field(kw_only=False)
    group: str | None = None
    mass: float | None = None
    centre: Vector | None = None
    inertia: Vector | Sequence[Vector] | NDArray[Any] | None = None


class Coupling(Table):
    """A point that moves with a group of the mesh, rigidly or with its mean.

    Parameters
    ----------
    name : str
        Its name, and that of a group of one node, the point, for loads, masses, springs, supports, probes and joints.
    group : str
        Group of facets, nodes or cells.
    point : vector
        The point, on the group or off it.
    kind : str
        "rigid": group and point are one rigid body (RBE2), which alone takes moments, inertias and joints with an axis;
        "distributing": the point follows the mean of the group, which keeps its freedom to deform (RBE3).
    weights : list of float, optional
        With "distributing": positive weights of the nodes in ascending order; if not given, areas of facets, else
        equal.

    Raises
    ------
    InputError
        If a value is out of its range, or a rigid coupling has weights.

    Examples
    --------
    >>> emmy.Coupling("bolt", group="hole", point=(40, 0, 12), kind="distributing").kind
    'distributing'
    """

    _section = "coupling"
    name: str = field(kw_only=False)
    group: str
    point: Vector
    kind: str
    weights: Sequence[float] | NDArray[Any] | None = None


class Load(Table):
    """A load on a group. Exactly one of the kinds must be given.

    Parameters
    ----------
    group : str, optional
        Group on which the load acts; with `acceleration`, `body_force` and `attraction` the whole body if not given;
        with `rotation` and `drag` always the whole body.
    traction : vector or function, optional
        Force per reference area of a group of facets; or a function ``f(points, t)`` that returns one vector per point,
        both ``(n, 3)``.
    force : vector, optional
        Resultant, spread evenly over a group of facets; on a rigid body or a coupling at its centre or point.
    nodal_force : vector, optional
        Force at each node of a group.
    moment : vector, optional
        Moment on a rigid body or a rigid coupling, whose name is `group`, in the axes of space.
    torque : dict, optional
        Moment about an ``axis`` of any length: its ``value``.
    pressure : float, optional
        Pressure on the current surface of a group of facets.
    acceleration : vector or function, optional
        Acceleration of every mass in a group of cells; or ``f(points, t)``.
    body_force : vector, list of expressions or function, optional
        Force per reference volume of a group of cells; or ``f(points, t)``.
    attraction : dict, optional
        Attraction to a point: ``centre`` and ``strength``.
    rotation : dict, optional
        Centrifugal force on all masses, for an observer that turns: ``axis``, ``speed`` in radians per time and, unless
        it is the origin, ``about``, a point of the axis. For `emmy.equilibrium` and `emmy.modes` about its state, which
        takes the Coriolis force; motions refuse it, since in them the body itself turns.
    drag : float, optional
        Rate of a force -rate M v on the whole body.
    history : history, optional
        Factor over time: a number, pairs ``[(time, factor), ...]``, an expression such as "sin(2*pi*t)" or
        "half_sine(t, 0, 0.011)", a dict of ``file``, ``time``, ``value`` and optionally ``factor``, ``low_pass`` and
        ``correct_baseline``, or a function of one number. A function must be smooth, since the scheme integrates it by
        Gauss points: write one with kinks as pairs, or as an expression with pulses.
    follow : bool, optional
        Whether a `force`, `moment` or `torque` turns with the rigid body on which it acts; its vector is that in the
        drawing.

    Raises
    ------
    InputError
        If not exactly one kind is given, or a value is out of its range.
    TypeError
        If a value has the wrong type.

    Examples
    --------
    >>> emmy.Load("tip", force=[0, 0, -2000], history=[(0, 0), (5e-4, 1), (1e-3, 0)])
    Load(group='tip', force=(0, 0, -2000), history=((0, 0), (0.0005, 1), (0.001, 0)))
    >>> emmy.Load(acceleration=(0, 0, -9.81)).group is None
    True
    """

    _section = "load"
    group: str | None = field(default=None, kw_only=False)
    traction: Vector | VectorField | None = None
    force: Vector | None = None
    nodal_force: Vector | None = None
    moment: Vector | None = None
    torque: Mapping[str, Any] | None = None
    pressure: float | None = None
    acceleration: Vector | VectorField | None = None
    body_force: Sequence[float | str] | NDArray[Any] | VectorField | None = None
    attraction: Mapping[str, Any] | None = None
    rotation: Mapping[str, Any] | None = None
    drag: float | None = None
    history: History = 1
    follow: bool = False

    @classmethod
    def gravity(cls, direction: str, *, units: str, group: str | None = None, history: History = 1) -> Self:
        """Standard gravity along an axis as an `acceleration`, 9.80665 m/s^2 in the units of the body.

        Parameters
        ----------
        direction : str
            Axis with or without a sign, such as "-z".
        units : str
            System of units, such as "m-kg-s" or "mm-t-s", as in `Motion`.
        group : str, optional
            Group of cells; all masses if not given.
        history : history, optional
            Factor over time.

        Returns
        -------
        Load

        Raises
        ------
        InputError
            If the direction is not along an axis, or there is no such system of units.

        Examples
        --------
        >>> emmy.Load.gravity("-z", units="mm-t-s")
        Load(acceleration=(0.0, 0.0, -9806.65))
        """
        size, found = _emmy.standard_gravity(units), re.fullmatch("([+-]?)([xyz])", str(direction))
        if found is None:
            raise fault("direction", f'{direction!r} is not a direction along an axis, such as "-z"')
        own = -size if found[1] == "-" else size
        return cls(group, acceleration=[own if axis == found[2] else 0.0 for axis in "xyz"], history=history)

    def _tree(self) -> dict[str, Any]:
        given = self._given()
        own: dict[str, Any] = {}
        for key, value in given.items():
            if key == "history":
                own[key] = words.history(value, key)
            elif key in ("traction", "acceleration", "body_force"):
                own[key] = words.field(value, key)
            else:
                own[key] = words.tree(value, key)
        return own


class Mass(Table):
    """A mass besides those of the cells: at each node of a group, spread over it, or at a place beside it.

    Parameters
    ----------
    group : str
        Group of nodes, facets or cells.
    mass : float, optional
        Mass at each of its nodes; several entries add up.
    total : float, optional
        Mass of the whole group in place of `mass`, without `at`, spread evenly over the area of its facets, else over
        the volume of its cells (the length of links), else over its nodes.
    at : vector, optional
        Place of one mass, `mass`, that is coupled to the group, as an engine to its plate.
    inertia : vector or array (3, 3), optional
        Inertia about `at`, or about the centre of a rigid body that `group` names: principal moments along x, y and z,
        or a symmetric matrix; needs a rigid coupling.
    coupling : str, optional
        With `at`: "rigid" (default), the group moves as one with the mass, or "distributing", the mass follows the mean
        of the group.
    name : str, optional
        With `at`: its name in joints and as a group of one node; ``mass-1``, ``mass-2``, ... if not given.

    Raises
    ------
    InputError
        If not exactly one of `mass` and `total` is given, it is not positive, or `total` has a place `at`.

    Examples
    --------
    >>> emmy.Mass("star", 2.0)
    Mass(group='star', mass=2.0)
    >>> emmy.Mass("lid", total=3.0)
    Mass(group='lid', total=3.0)
    >>> emmy.Mass("plate", 120.0, at=(0, 0, 0.4), inertia=(6, 8, 5)).at
    (0, 0, 0.4)
    """

    _section = "mass"
    group: str = field(kw_only=False)
    mass: float | None = field(default=None, kw_only=False)
    total: float | None = None
    at: Vector | None = None
    inertia: Vector | Sequence[Vector] | NDArray[Any] | None = None
    coupling: str | None = None
    name: str | None = None


class Initial(Table):
    """Velocities at the start: ``velocity + angular_velocity x (X - about) + gradient X``.

    Parameters
    ----------
    group : str, optional
        Group of nodes, facets or cells; all nodes if not given.
    velocity, angular_velocity, about : vector, optional
        Velocity, angular velocity and a point of the axis; 0 if not given.
    gradient : array (3, 3), optional
        Gradient of the velocity.
    state : str or path, optional
        Output directory of another run, whose last state is the start; alone in `Initial`.

    Raises
    ------
    InputError
        If a value is out of its range.

    Examples
    --------
    >>> emmy.Initial(angular_velocity=np.array([0.0, 0.0, 1.0]))
    Initial(angular_velocity=(0.0, 0.0, 1.0))
    """

    _section = "initial"
    group: str | None = None
    velocity: Vector | None = None
    angular_velocity: Vector | None = None
    about: Vector | None = None
    gradient: Sequence[Vector] | NDArray[Any] | None = None
    state: Any = None


class Adaptive(Table):
    """Steps whose sizes are chosen by the error.

    Parameters
    ----------
    tolerance : float
        Largest error of a step, relative to the scales.
    min_size, max_size, first_size : float, optional
        Smallest, largest and first step.
    length, velocity : float, optional
        Scales of the errors of positions and velocities.
    estimator : str, optional
        "difference", "sampled", "residual" or "element".
    min_degree, max_degree : int, optional
        Bounds of the automatic choice of the degree.

    Raises
    ------
    InputError
        If a value is out of its range.

    Examples
    --------
    >>> emmy.Adaptive(1e-4, max_size=0.2)
    Adaptive(tolerance=0.0001, max_size=0.2)
    """

    _section = "adaptive"
    tolerance: float = field(kw_only=False)
    min_size: float | None = None
    max_size: float | None = None
    first_size: float | None = None
    length: float | None = None
    velocity: float | None = None
    estimator: str | None = None
    min_degree: int | None = None
    max_degree: int | None = None
