"""Bodies."""

from __future__ import annotations

import numbers
import tomllib
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _emmy
from . import _words as words
from ._contact import Contact
from ._errors import fault, missing, of_whole_input, warn
from ._joints import Joint
from ._mesh import Mesh
from ._parts import Coupling, Load, Mass, Region, Rigid, Support, Tie


class Prescribed(NamedTuple):
    """Given motion of a body at a time, from `Body.prescribed`.

    Attributes
    ----------
    dofs : array (m,)
        Driven degrees of freedom, three times the number of the node plus that of the component.
    displacement, velocity : array (m,)
        Displacement and velocity of each.

    Examples
    --------
    >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    >>> emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=2)).prescribed(0.0).dofs.tolist()
    []
    """

    dofs: NDArray[np.int64]
    displacement: NDArray[np.float64]
    velocity: NDArray[np.float64]


class Mobility(NamedTuple):
    """How many ways a mechanism can move where it is drawn, from `Body.mobility`.

    Attributes
    ----------
    n_bodies, n_joints : int
        Number of rigid bodies, point masses included, and of joints.
    n_constraints, n_redundant : int
        Number of the constraints of all joints, drives included, and of those that follow from the others.
    degrees_of_freedom : int or None
        Degrees of freedom, given motions included; None if joints have nodes of elastic parts, which deform.
    n_driven : int
        Number of these that have a given motion.
    redundant : tuple of str
        Names of the joints whose constraints, some of them at least, follow from those of the joints before them.
    indeterminate, indeterminate_drives : tuple of str
        Names of the joints whose single forces are not unique, and of those of them with a given motion whose torque or
        force is not.

    Examples
    --------
    >>> door = emmy.Rigid("door", mass=20.0, centre=(0.5, 0, 1), inertia=(7, 9, 3))
    >>> hinges = [emmy.Joint.revolute(f"hinge-{z}", between=("door", "ground"), at=(0, 0, z), axis=(0, 0, 1))
    ...           for z in (0, 2)]
    >>> mobility = emmy.Body(rigid=door, joints=hinges).mobility
    >>> mobility.degrees_of_freedom, mobility.n_redundant, mobility.redundant
    (1, 5, ('hinge-2',))
    >>> mobility.indeterminate
    ('hinge-0', 'hinge-2')
    """

    n_bodies: int
    n_joints: int
    n_constraints: int
    n_redundant: int
    degrees_of_freedom: int | None
    n_driven: int
    redundant: tuple[str, ...]
    indeterminate: tuple[str, ...] = ()
    indeterminate_drives: tuple[str, ...] = ()


class Body:
    """A mesh with materials, supports, loads, further masses, ties and contacts; rigid bodies and joints.

    It cannot be changed.

    Arrays of all nodes have those of the mesh first. Then come those of the rigid bodies: the centre of each, and the
    ends of its three axes unless it is a point mass; and one for each obstacle that moves.

    Parameters
    ----------
    mesh : Mesh, optional
        Mesh; none for rigid bodies alone.
    regions : Region or list of Region
        Materials of the cells.
    supports : Support or list of Support, optional
        Nodes that are held or driven.
    loads : Load or list of Load, optional
        Loads.
    masses : Mass or list of Mass, optional
        Masses besides those of the cells.
    ties : Tie or list of Tie, optional
        Nodes that follow other parts of the body.
    rigid : Rigid or list of Rigid, optional
        Rigid bodies and point masses.
    joints : Joint or list of Joint, optional
        Joints between rigid bodies, nodes and the ground.
    couplings : Coupling or list of Coupling, optional
        Points that move with groups of the mesh.
    contacts : Contact or list of Contact, optional
        Surfaces that meet obstacles.

    Raises
    ------
    UnknownGroupError
        If the mesh lacks a group.
    InputError
        If anything else does not fit; all mistakes at once.
    TypeError
        If a function of a load or support returns something else than numbers at t = 0, or an argument has another
        type.

    Examples
    --------
    >>> mesh = emmy.Mesh.box((1, 4, 1), (1, 4, 1))
    >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1000.0, mu=500.0), density=0.5),
    ...                  emmy.Support("y-min", fix="xyz"))
    >>> body
    <emmy.Body: 4 cells, 60 degrees of freedom, 12 fixed>
    >>> round(body.total_mass, 12)
    2.0
    """

    def __init__(
        self,
        mesh: Mesh | None = None,
        regions: Region | Iterable[Region] = (),
        supports: Support | Iterable[Support] = (),
        loads: Load | Iterable[Load] = (),
        masses: Mass | Iterable[Mass] = (),
        ties: Tie | Iterable[Tie] = (),
        rigid: Rigid | Iterable[Rigid] = (),
        joints: Joint | Iterable[Joint] = (),
        couplings: Coupling | Iterable[Coupling] = (),
        contacts: Contact | Iterable[Contact] = (),
    ) -> None:
        if mesh is not None and not isinstance(mesh, Mesh):
            raise TypeError(
                f"mesh: {words.class_name(type(mesh))} is not an emmy.Mesh; see Mesh.read and Mesh.from_meshio"
            )
        self._mesh = Mesh._of(_emmy.Mesh.empty()) if mesh is None else mesh
        self._regions = words.each(regions, Region, "regions")
        self._supports = words.each(supports, Support, "supports")
        self._loads = words.each(loads, Load, "loads")
        self._masses = words.each(masses, Mass, "masses")
        self._ties = words.each(ties, Tie, "ties")
        self._rigid = words.each(rigid, Rigid, "rigid")
        self._joints = words.each(joints, Joint, "joints")
        self._couplings = words.each(couplings, Coupling, "couplings")
        self._contacts = words.each(contacts, Contact, "contacts")
        if self._mesh.n_cells == 0 and not self._rigid:
            raise fault("mesh", "a body needs a mesh or a rigid body")
        self._try_histories()
        parts: dict[str, tuple[words.Table, ...]] = {
            "region": self._regions,
            "support": self._supports,
            "load": self._loads,
            "mass": self._masses,
            "tie": self._ties,
            "contact": self._contacts,
            "rigid": self._rigid,
            "coupling": self._couplings,
            "joint": self._joints,
        }
        tables = {key: [part._tree() for part in own] for key, own in parts.items() if own}
        for entry in map(tomllib.loads, self._mesh._native.entries):
            tables.setdefault(entry["section"], []).append(entry["table"])
        cells = {"mesh": self._mesh._native} if self._mesh.n_cells > 0 else {}
        with of_whole_input():
            self._native = _emmy.Body(cells | tables)
        warn(self.notes)

    def _try_histories(self) -> None:
        for index, load in enumerate(self._loads):
            for function in words.functions(load.history):
                _try_history(function, f"loads[{index}].history")
        for index, support in enumerate(self._supports):
            for key in ("move", "accelerate", "rotate"):
                for function in words.functions(getattr(support, key)):
                    _try_history(function, f"supports[{index}].{key}")
        for index, joint in enumerate(self._joints):
            for key in ("angle", "slide", "length", "torque", "force"):
                for function in words.functions(getattr(joint, key)):
                    _try_history(function, f"joints[{index}].{key}")

    @property
    def mesh(self) -> Mesh:
        """The mesh, without the nodes of rigid bodies; of rigid bodies alone one without cells."""
        return self._mesh

    @property
    def regions(self) -> tuple[Region, ...]:
        """Materials of the cells."""
        return self._regions

    @property
    def supports(self) -> tuple[Support, ...]:
        """Nodes that are held or driven."""
        return self._supports

    @property
    def loads(self) -> tuple[Load, ...]:
        """Loads."""
        return self._loads

    @property
    def masses(self) -> tuple[Mass, ...]:
        """Masses besides those of the cells."""
        return self._masses

    @property
    def ties(self) -> tuple[Tie, ...]:
        """Nodes that follow other parts of the body."""
        return self._ties

    @property
    def rigid(self) -> tuple[Rigid, ...]:
        """Rigid bodies and point masses."""
        return self._rigid

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """Points that move with groups of the mesh."""
        return self._couplings

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """Surfaces that meet obstacles."""
        return self._contacts

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Joints."""
        return self._joints

    @property
    def mobility(self) -> Mobility:
        """How many ways the mechanism of rigid bodies and joints can move where it is drawn."""
        numbers, *names = self._native.mobility()
        return Mobility(*numbers, *names)

    @property
    def n_nodes(self) -> int:
        """Number of nodes, with those of rigid bodies."""
        return self._native.n_nodes

    @property
    def n_dofs(self) -> int:
        """Number of degrees of freedom; fixed and tied ones are counted."""
        return self._native.n_dofs

    @property
    def fixed(self) -> NDArray[np.bool_]:
        """Whether a component of a node is fixed, driven or tied, array (n, 3)."""
        return self._native.fixed

    @property
    def total_mass(self) -> float:
        """Mass."""
        return self._native.total_mass

    @property
    def center_of_mass(self) -> NDArray[np.float64]:
        """Centre of mass in the reference configuration, array (3,)."""
        return np.asarray(self._native.center_of_mass, dtype=np.float64)

    @property
    def notes(self) -> list[str]:
        """Notes of the reader on the body."""
        return self._native.notes

    def mass(self) -> Any:
        """Consistent mass matrix.

        Returns
        -------
        scipy.sparse.csr_array (3 n, 3 n)

        Raises
        ------
        ImportError
            If SciPy is not installed.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=6))
        >>> round(float(body.mass().sum()), 12)         # in three directions
        18.0
        """
        return sparse(self._native.mass())

    def stiffness(self, u: ArrayLike | None = None) -> Any:
        """Stiffness: derivative of the internal forces by the displacement.

        Parameters
        ----------
        u : array (n, 3) or (3 n,), optional
            Displacement at which to take it; the reference configuration if not given.

        Returns
        -------
        scipy.sparse.csr_array (3 n, 3 n)

        Raises
        ------
        ImportError
            If SciPy is not installed.
        InputError
            If the array has another shape, or a number is not finite.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> bool(np.abs(body.stiffness() @ np.tile([1.0, 0.0, 0.0], 8)).max() < 1e-14)      # no force in a translation
        True
        """
        return sparse(self._native.stiffness(None if u is None else self._nodal(u, "u")))

    def internal_force(self, u: ArrayLike) -> NDArray[np.float64]:
        """Internal forces, with those of contacts, and of springs and attractions to the ground, without loads.

        Parameters
        ----------
        u : array (n, 3) or (3 n,)
            Displacement of the nodes.

        Returns
        -------
        array of the same shape

        Raises
        ------
        InputError
            If the array has another shape, or a number is not finite.
        MeshError
            If a cell is inverted by the displacement.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> float(np.abs(body.internal_force(np.zeros((8, 3)))).max())
        0.0
        """
        return self._native.internal_force(self._nodal(u, "u")).reshape(np.shape(u))

    def external_force(self, time: float, u: ArrayLike | None = None) -> NDArray[np.float64]:
        """All loads at a time.

        Parameters
        ----------
        time : float
            Time; at a jump of a load the value after it counts.
        u : array (n, 3) or (3 n,), optional
            Displacement for loads that follow the body; the reference configuration if not given.

        Returns
        -------
        array of the shape of `u`, (n, 3) without it

        Raises
        ------
        InputError
            If the array has another shape, or a load is not a finite number.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> weight = emmy.Load(acceleration=(0, 0, -10))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=2), loads=weight)
        >>> round(float(body.external_force(0.0).sum()), 12)
        -20.0
        """
        force = self._native.external_force(words.real(time, "time"), None if u is None else self._nodal(u, "u"))
        return force if u is None else force.reshape(np.shape(u))

    def prescribed(self, time: float) -> Prescribed:
        """Given motion of the driven degrees of freedom at a time, without supports released by then.

        Parameters
        ----------
        time : float
            Time; at a kink the velocity is that after it.

        Returns
        -------
        Prescribed

        Raises
        ------
        InputError
            If a function of time is not finite there.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> shaken = emmy.Support("z-min", move={"z": "0.1*t^2"})
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=2), shaken)
        >>> given = body.prescribed(1.0)
        >>> u = np.zeros((8, 3))
        >>> u.flat[given.dofs] = given.displacement
        >>> u[0].tolist(), given.velocity.tolist()
        ([0.0, 0.0, 0.1], [0.2, 0.2, 0.2, 0.2])
        """
        return Prescribed(*self._native.prescribed(words.real(time, "time")))

    def damping(self) -> Any:
        """Damping matrix at rest: viscosity, and drag times the mass.

        At large strains a viscous force depends on the displacement, too; `Motion.residual` has it.

        Returns
        -------
        scipy.sparse.csr_array (3 n, 3 n)

        Raises
        ------
        ImportError
            If SciPy is not installed.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> viscous = emmy.Viscosity(time=0.02)
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1, viscosity=viscous))
        >>> bool(np.abs(body.damping() - 0.02 * body.stiffness()).max() < 1e-15)
        True
        """
        return sparse(self._native.damping())

    def strain_energy(self, u: ArrayLike) -> float:
        """Strain energy.

        Parameters
        ----------
        u : array (n, 3) or (3 n,)
            Displacement of the nodes.

        Returns
        -------
        float

        Raises
        ------
        InputError
            If the array has another shape, or a number is not finite.
        MeshError
            If a cell is inverted by the displacement.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.SaintVenantKirchhoff(lambda_=3.0, mu=1.0), density=1.0))
        >>> stretch = np.sqrt(1.2)                      # E_xx = 0.1
        >>> round(body.strain_energy(mesh.points * [stretch - 1, 0, 0]), 12)
        0.025
        """
        return self._native.strain_energy(self._nodal(u, "u"))

    def to_toml(self) -> str:
        """The body in the words of an input file. Functions have no place in a file: they are named.

        Returns
        -------
        str

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> "neo-hooke" in body.to_toml()
        True
        """
        return self._native.toml

    def _nodal(self, values: ArrayLike, place: str) -> NDArray[np.float64]:
        return words.vectors(values, self.n_nodes, place)

    def __str__(self) -> str:
        return self._native.report()

    def __repr__(self) -> str:
        tied = self._native.n_tied
        fixed = int(self.fixed.sum()) - tied
        of_ties = f", {tied} tied" if tied else ""
        counts = [f"{self.mesh.n_cells} cells"] if self.mesh.n_cells or not self._rigid else []
        counts += [_counted(len(self._rigid), "rigid body", "rigid bodies")] if self._rigid else []
        counts += [_counted(len(self._joints), "joint", "joints")] if self._joints else []
        counts += [_counted(len(self._contacts), "contact", "contacts")] if self._contacts else []
        return f"<emmy.Body: {', '.join(counts)}, {self.n_dofs} degrees of freedom, {fixed} fixed{of_ties}>"

    def __reduce__(self) -> tuple[Any, ...]:
        parts = (self._regions, self._supports, self._loads, self._masses, self._ties, self._rigid, self._joints)
        return Body, (self._mesh, *parts, self._couplings, self._contacts)


def _counted(n: int, one: str, many: str) -> str:
    return f"{n} {one if n == 1 else many}"


def sparse(parts: tuple[NDArray[np.float64], NDArray[Any], NDArray[Any], int]) -> Any:
    """The matrix of SciPy."""
    try:
        import scipy.sparse
    except ImportError:
        raise missing("a sparse matrix", "SciPy", "scipy") from None
    data, indices, pointers, size = parts
    return scipy.sparse.csr_array((data, indices, pointers), shape=(size, size))


def _try_history(function: Any, place: str) -> None:
    try:
        value = given = function(0.0)
    except Exception as error:
        error.add_note(f"in {place} ({words.name_of(function)}) at t = 0")
        raise
    if getattr(given, "ndim", None) == 0 and hasattr(given, "item"):
        # Splines of SciPy return arrays without axes.
        value = given.item()
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TypeError(
            f"{place}: {words.name_of(function)} returned {type(given).__name__} in place of a number"
        )
