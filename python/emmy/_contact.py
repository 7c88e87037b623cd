"""Contact of surfaces with obstacles and with each other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any, TypeAlias

from . import _emmy
from . import _words as words
from ._words import Path, Table, Vector


class _Obstacle(Table):
    """What obstacles have in common: they may move."""

    @property
    def _motion(self) -> Mapping[str, Path] | None:
        return getattr(self, "move", None)

    def __post_init__(self) -> None:
        if self._motion is not None and not isinstance(self._motion, Mapping):
            raise TypeError(f"move: {type(self._motion).__name__} in place of a dict")
        if not self._motion:
            object.__setattr__(self, "move", None)
        super().__post_init__()

    def _check(self) -> None:
        super()._check()
        _emmy.check("obstacle", self._of_contact())

    def _tree(self) -> dict[str, Any]:
        return {name: words.tree(value, name) for name, value in self._given().items() if name != "move"}

    def _of_contact(self) -> dict[str, Any]:
        """The obstacle with its motion in the words of the input."""
        moved = {axis: words.path(value, f"move.{axis}") for axis, value in (self._motion or {}).items()}
        shape = {self._section.removeprefix("obstacle."): self._tree()}
        return shape | ({"move": moved} if moved else {})


class Plane(_Obstacle):
    """An obstacle that fills a half-space.

    Parameters
    ----------
    point : vector
        A point of its surface.
    normal : vector
        Direction out of it, towards the body, of any length.
    move : dict, optional
        Displacement over time of components "x", "y", "z" by name, as in `Support`; the others are at rest.

    Raises
    ------
    InputError
        If a value is not three finite numbers; in `Body`, if `normal` has no direction.

    Examples
    --------
    >>> emmy.Plane((0, 0, 0), (0, 0, 1))
    Plane(point=(0, 0, 0), normal=(0, 0, 1))
    >>> emmy.Plane((0, 0, 1), (0, 0, -1), move={"z": "-0.1*t"}).move
    {'z': '-0.1*t'}
    """

    _section = "obstacle.plane"
    point: Vector = field(kw_only=False)
    normal: Vector = field(kw_only=False)
    move: Mapping[str, Path] | None = None


class Sphere(_Obstacle):
    """A sphere as an obstacle, with the body outside or inside.

    Parameters
    ----------
    centre : vector
        Its centre.
    radius : float
        Its radius.
    inside : bool, optional
        Whether the body is inside.
    move : dict, optional
        Displacement over time of components "x", "y", "z" by name, as in `Support`; the others are at rest.

    Raises
    ------
    InputError
        If `centre` is not three finite numbers, or `radius` is not positive.

    Examples
    --------
    >>> emmy.Sphere((0, 0, 0), 2.0, inside=True)
    Sphere(centre=(0, 0, 0), radius=2.0, inside=True)
    """

    _section = "obstacle.sphere"
    centre: Vector = field(kw_only=False)
    radius: float = field(kw_only=False)
    inside: bool = field(default=False, kw_only=False)
    move: Mapping[str, Path] | None = None


class Cylinder(_Obstacle):
    """A cylinder without ends as an obstacle, with the body outside or inside.

    Parameters
    ----------
    point : vector
        A point of its axis.
    axis : vector
        Direction of its axis, of any length.
    radius : float
        Its radius.
    inside : bool, optional
        Whether the body is inside.
    move : dict, optional
        Displacement over time of components "x", "y", "z" by name, as in `Support`; the others are at rest.

    Raises
    ------
    InputError
        If a vector is not three finite numbers, or `radius` is not positive; in `Body`, if `axis` has no direction.

    Examples
    --------
    >>> emmy.Cylinder((0, 0, 0), (0, 0, 1), 0.5)
    Cylinder(point=(0, 0, 0), axis=(0, 0, 1), radius=0.5)
    """

    _section = "obstacle.cylinder"
    point: Vector = field(kw_only=False)
    axis: Vector = field(kw_only=False)
    radius: float = field(kw_only=False)
    inside: bool = field(default=False, kw_only=False)
    move: Mapping[str, Path] | None = None


Obstacle: TypeAlias = Plane | Sphere | Cylinder
OBSTACLES = (Plane, Sphere, Cylinder)


class Contact(Table):
    """Surfaces that meet, without friction: a thin layer on them stores energy where something is near.

    A surface meets an obstacle or another surface, or all bodies that are not connected meet each other.

    The energy-momentum schemes conserve the sum of all energies, the ``contact_energy`` of the layer included. The
    history also has ``smallest_gap``, relative to the thickness of the layer and NaN where nothing is near,
    ``contact_points``, and the mean force and moment on the first surface in each step, ``NAME_force_x`` to
    ``NAME_moment_z``; of all bodies together, on the first of them.
    ``"contacts"`` in `Run.summary` has the largest force, how often it touches (``"intervals"``), and the times. The
    fields ``contact_pressure`` and ``contact_gap`` show where the surface is pressed, and how near it is.

    Parameters
    ----------
    surface : str
        Group of facets, or of cells, whose facets on the boundary are meant; "all": the whole boundary.
    opponent : str, Plane, Sphere or Cylinder, optional
        Group of another surface, or an obstacle, outside of which the surface begins. If not given, the bodies of which
        the surface consists meet each other.
    name : str, optional
        Name of its forces in the history; ``contact-1``, ``contact-2``, ... by its place if not given.
    stiffness : float, optional
        Modulus of the layer; the smallest Young's modulus of the cells at the surface if not given.
    distance : float, optional
        Thickness of the layer: nearer than this, it pushes. A tenth of the median edge of the facets if not given, at
        most half of the smallest gap at the start.
    law : str, optional
        "smooth" (default): the pressure sets in softly, with few corrections; "linear": it sets in as that of an
        elastic layer, for slow impacts.

    Raises
    ------
    InputError
        If a value is out of its range; in `Body`, if there is no such group, the surface is not outside of the
        obstacle, or two surfaces intersect.
    TypeError
        If `opponent` is neither the name of a surface nor an obstacle.

    Examples
    --------
    >>> floor = emmy.Contact("all", emmy.Plane((0, 0, -0.1), (0, 0, 1)), name="floor")
    >>> floor
    Contact(surface='all', opponent=Plane(point=(0, 0, -0.1), normal=(0, 0, 1)), name='floor')
    >>> cube = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    >>> body = emmy.Body(cube, emmy.Region(emmy.NeoHooke(lambda_=1000, mu=500), density=1), contacts=floor)
    >>> falls = emmy.Initial(velocity=(0, 0, -1))
    >>> history = emmy.Motion(body, steps=(0.4, 0.02), initial=falls).run()
    >>> float(history["linear_momentum_z"][-1].round(1))                   # it bounces, from -1.0
    0.8
    >>> bool(np.ptp(history["total_energy"]) < 1e-13)
    True
    """

    _section = "contact"
    surface: str = field(kw_only=False)
    opponent: str | Obstacle | None = field(default=None, kw_only=False)
    name: str | None = None
    stiffness: float | None = None
    distance: float | None = None
    law: str = "smooth"

    def _check(self) -> None:
        if self.opponent is not None and not isinstance(self.opponent, (str, *OBSTACLES)):
            kind = words.class_name(type(self.opponent))
            raise TypeError(f"opponent: {kind} is neither the name of a surface nor an obstacle, such as emmy.Plane")
        super()._check()

    def _tree(self) -> dict[str, Any]:
        own = super()._tree()
        surface, opponent = own.pop("surface"), own.pop("opponent", None)
        if self.opponent is None:
            return {"surfaces": surface} | own
        if isinstance(self.opponent, str):
            return {"surfaces": [surface, opponent]} | own
        return {"surfaces": surface, "obstacle": self.opponent._of_contact()} | own
