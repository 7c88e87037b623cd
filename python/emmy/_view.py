"""Read access to the present state of a motion."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _emmy, _notebook
from . import _words as words
from ._body import Body, sparse
from ._emmy import Step
from ._errors import fault
from ._history import Event, History, Peak, structured
from ._mesh import Mesh
from ._results import Frame, Frames, KeptFrame
from ._state import Snapshot, State


class MotionView:
    """State, history and fields of a motion."""

    _body: Body
    _native: _emmy.Motion
    _rows: NDArray[np.float64]
    _kept: list[KeptFrame]

    @property
    def body(self) -> Body:
        """The body."""
        return self._body

    @property
    def time(self) -> float:
        """Time reached."""
        return self._native.time

    @property
    def number(self) -> int:
        """Number of the last step."""
        return self._native.number

    @property
    def scheme(self) -> str:
        """Scheme in time."""
        # The library names a time element with its degree.
        return self._native.scheme.removesuffix(f", degree {self.degree}")

    @property
    def degree(self) -> int:
        """Degree of the time elements."""
        return self._native.degree

    @property
    def record(self) -> Step:
        """The last step, or the start."""
        return self._native.record()

    @property
    def displacement(self) -> NDArray[np.float64]:
        """Displacement of the nodes relative to the ground, array (n, 3), a copy; `field` has that of `relative_to`."""
        return self._native.displacement

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Velocity of the nodes relative to the ground, array (n, 3), a copy; `field` has that of `relative_to`."""
        return self._native.velocity

    @property
    def momentum(self) -> NDArray[np.float64]:
        """Momentum of the nodes, array (n, 3), a copy."""
        return self._native.momentum

    @property
    def positions(self) -> NDArray[np.float64]:
        """Current positions of the nodes, array (n, 3), a copy."""
        return self._native.positions

    @property
    def state(self) -> State:
        """Displacements and velocities, a copy."""
        return State(*self._native.state())

    @property
    def history(self) -> History:
        """The columns of `history.csv`, a structured array with a row for the start and one a step."""
        # Another thread may ask for the history too.
        rows = self._rows
        rows = np.concatenate([rows, self._native.rows(len(rows))])
        self._rows = rows
        return structured(rows, [(name, is_whole) for name, _, _, is_whole in self._native.columns]).view(History)

    def peak(self, name: str) -> Peak:
        """Last, smallest and largest number of a column of the history, with times.

        Parameters
        ----------
        name : str
            Name of the column; `columns` lists them.

        Returns
        -------
        Peak

        Raises
        ------
        InputError
            If there is no such column.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> rises = emmy.Initial(velocity=(0, 0, 1))
        >>> motion = emmy.Motion(body, steps=(1.0, 0.5), initial=rises, probes={"o": (0, 0, 0)})
        >>> history = motion.run()
        >>> peak = motion.peak("o_z")
        >>> round(peak.largest, 9), peak.largest_time
        (1.0, 1.0)
        """
        return self.history.peak(name)

    @property
    def columns(self) -> dict[str, tuple[str, str]]:
        """Dimension and meaning of each column of the history."""
        return {name: (dimension, meaning) for name, dimension, meaning, _ in self._native.columns}

    @property
    def events(self) -> list[Event]:
        """Steps that were cut or rejected, supports and joints that were released, and more."""
        return [Event(*event) for event in self._native.events()]

    @property
    def accuracy(self) -> str:
        """Accuracy in time, as far as it is known: "estimated ...", "not estimated ..." or "coarse ...".

        Balances close with steps of any size, so they say nothing about it. Empty before the first step, and in a
        static analysis.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> motion = emmy.Motion(body, initial=emmy.Initial(velocity=(0, 0, 1)))
        >>> step = motion.step(0.1)
        >>> motion.accuracy
        'not estimated; `emmy converge` or `--estimate-error` measures it'
        """
        return self._native.accuracy() or ""

    @property
    def notes(self) -> list[str]:
        """Notes of the reader on the motion."""
        return self._native.notes

    @property
    def newton_residuals(self) -> NDArray[np.float64]:
        """Residuals of Newton's iteration in the last step."""
        return np.asarray(self._native.newton_residuals, dtype=np.float64)

    def residual(self, x: ArrayLike, step_size: float) -> NDArray[np.float64]:
        """Residual of the equations of a step of the time element from the present state. The motion does not change.

        Parameters
        ----------
        x : array (degree, n, 3), (degree, 3 n) or (3 n degree,)
            Rates of the displacement, its derivatives with respect to the fraction of the step, at the Gauss points of
            the time element; for degree 1 also an array (n, 3).
        step_size : float
            Size of the step.

        Returns
        -------
        array of the same shape
            ``R_i = sum_j (a^-1)_ij (M x_j - h p) + h^2 (f_i - F_i)``, with the averages f and F of the internal forces
            and of the loads. At held components it is ``h^2`` times the reaction.

        Raises
        ------
        InputError
            If the scheme is not a time element, the array has another shape or a number that is not finite, or the
            step size is not positive.
        MeshError
            If a cell is inverted by the rates.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=2))
        >>> motion = emmy.Motion(body, initial=emmy.Initial(velocity=(3, 0, 0)))
        >>> bool(np.abs(motion.residual(0.1 * motion.velocity, 0.1)).max() < 1e-15)       # x = h v: it flies
        True
        """
        return self._native.residual(self._rates(x), _step_size(step_size)).reshape(np.shape(x))

    def tangent(self, x: ArrayLike, step_size: float) -> Any:
        """Derivative of `residual` by the rates. Held components are included.

        Parameters
        ----------
        x : array (degree, n, 3), (degree, 3 n) or (3 n degree,)
            Rates, as in `residual`.
        step_size : float
            Size of the step.

        Returns
        -------
        scipy.sparse.csr_array (3 n degree, 3 n degree)

        Raises
        ------
        ImportError
            If SciPy is not installed.
        InputError
            As `residual`, and if the scheme dissipates: its projection couples all nodes.
        MeshError
            If a cell is inverted by the rates.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=2))
        >>> tangent = emmy.Motion(body).tangent(np.zeros((8, 3)), 0.1)
        >>> bool(np.abs(tangent - (2 * body.mass() + 0.1**2 / 2 * body.stiffness())).max() < 1e-15)
        True
        """
        return sparse(self._native.tangent(self._rates(x), _step_size(step_size)))

    def _rates(self, x: ArrayLike) -> NDArray[np.float64]:
        """Rates as an array (degree n, 3)."""
        k, n, given = self.degree, self.body.n_nodes, words.reals(x, "x")
        shapes = [(k, n, 3), (k, 3 * n), (3 * n * k,), *([(n, 3)] if k == 1 else [])]
        if given.shape not in shapes:
            wanted = " or ".join(map(str, shapes))
            raise fault("x", f"expected an array of shape {wanted}, found {given.shape}")
        return words.vectors(given.reshape(-1, 3), k * n, "x")

    @property
    def frames(self) -> Frames:
        """Frames in memory, which `run` keeps if it is called with ``every`` and without ``output``.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> motion = emmy.Motion(body, steps=(1.0, 0.25), initial=emmy.Initial(velocity=(0, 0, 1)))
        >>> history = motion.run(every=2, fields=["cell_volume_ratio"])
        >>> motion.frames.times.tolist(), motion.frames.velocity.shape
        ([0.0, 0.5, 1.0], (3, 8, 3))
        """
        kept: list[Frame] = [*self._kept]
        return Frames(kept)

    def _keep(self, names: Iterable[str]) -> None:
        """Keeps the present state as a frame, once a step."""
        if self._kept and self._kept[-1].number == self.number:
            return
        fields = {name: self._native.field(name) for name in ("displacement", "velocity", *names)}
        body, fields_at = self._body, self._native.fields_at
        self._kept.append(KeptFrame(self.time, self.number, fields, lambda: _grid(body, fields, fields_at)))

    def field(self, name: str, group: str | None = None, *, time: float | None = None) -> NDArray[np.float64]:
        """A field at the present state, or in a frame.

        Parameters
        ----------
        name : str
            Name; `fields` lists them.
        group : str, optional
            Group of cells, facets or nodes. Fields at the nodes of a group of cells come from these cells alone: its
            own side where regions meet. Without a group, a node there has the mean of the sides by volume.
        time : float, optional
            Time of one of the `frames`, which has the field; without `group`.

        Returns
        -------
        array (n,) or (n, components)
            Values at the nodes, or in the cells; of a group in the order of `Mesh.group_nodes`, or of its cells; a
            name of several kinds means its cells.

        Raises
        ------
        InputError
            If there is no such field, group or frame, or the body cannot have the field, or the group has no cells for
            it.
        TypeError
            If both `group` and `time` are given.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> emmy.Motion(body).field("cell_volume_ratio").tolist()
        [1.0]
        >>> emmy.Motion(body).field("displacement", group="x-max").shape
        (4, 3)
        """
        if time is None:
            return self._native.field(name, group)
        if group is not None:
            raise TypeError("group: not with time; Mesh.group_nodes has the rows of a group in the field of a frame")
        return self.frames.at(time).field(name)

    def fields(self, *names: str) -> dict[str, NDArray[np.float64]]:
        """Several fields at the present state; without names all that the body can have.

        Parameters
        ----------
        *names : str
            Names.

        Returns
        -------
        dict of str to array

        Raises
        ------
        InputError
            As `field`.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> emmy.Motion(body).fields("velocity")["velocity"].shape
        (8, 3)
        """
        return {name: self._native.field(name) for name in names or self._native.field_names()}

    def to_pyvista(self, *names: str, group: str | None = None, region: int | None = None) -> Any:
        """Reference points, displacement, groups and the fields asked for, as a grid of PyVista.

        The displacement is that of `field`, relative to the frame of reference of the motion.

        Parameters
        ----------
        *names : str
            Names of fields.
        group : str, optional
            Group: its cells alone, at whose nodes fields have the values of these cells; without cells its facets,
            else its nodes.
        region : int, optional
            Number of a region of the body from 0, whose cells alone are in the grid.

        Returns
        -------
        pyvista.UnstructuredGrid

        Raises
        ------
        ImportError
            If PyVista is not installed.
        InputError
            As `field`; if there is no such region.
        UnknownGroupError
            If the mesh does not have the group.
        TypeError
            If both `group` and `region` are given.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> emmy.Motion(body).to_pyvista("cell_volume_ratio").cell_data["cell_volume_ratio"].tolist()
        [1.0]
        >>> emmy.Motion(body).to_pyvista(group="x-max").area
        1.0
        """
        if region is not None:
            if group is not None:
                raise TypeError("group and region exclude each other")
            regions = self._body.regions
            if words.count(region, 0, "region") >= len(regions):
                raise fault("region", f"there is no region {region}; the body has {len(regions)}, counted from 0")
            group = regions[region].group
        mesh, fields_at = Mesh._of(self._body._native.mesh), self._native.fields_at
        # In the frame of reference of the motion, as in frames.
        fields = {name: self._native.field(name) for name in dict.fromkeys(("displacement", *names))}
        if group is not None and "cells" in mesh.groups.get(group, ()):
            for name in names:
                if fields_at[name] == "nodes":
                    fields[name][mesh.group_nodes(f"cells:{group}")] = self._native.field(name, group)
        grid = _grid(self._body, fields, fields_at)
        return grid if group is None else mesh._part(grid, group)

    def snapshot(self) -> Snapshot:
        """Everything that determines the rest of the motion.

        Returns
        -------
        Snapshot

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> emmy.Motion(body).snapshot().number
        0
        """
        return Snapshot(self._native.snapshot())

    def __repr__(self) -> str:
        return f"<emmy.Motion: {self.scheme}, degree {self.degree}, step {self.number}, t = {self.time:.6g}>"

    def _repr_html_(self) -> str:
        return _notebook.motion(self)


def _grid(body: Body, fields: Mapping[str, NDArray[Any]], fields_at: Mapping[str, str]) -> Any:
    """A grid of PyVista with fields, at nodes or in cells by their names."""
    # With the nodes of rigid bodies.
    grid = Mesh._of(body._native.mesh).to_pyvista()
    for name, values in fields.items():
        (grid.cell_data if fields_at[name] == "cells" else grid.point_data)[name] = values
    return grid


def _step_size(value: float) -> float:
    size = words.real(value, "step_size")
    if size <= 0:
        raise fault("step_size", f"must be positive, not {size}")
    return size
