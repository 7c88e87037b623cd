"""Meshes."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from . import _convert, _emmy
from . import _words as words
from ._errors import Fault, UnknownGroupError, fault
from ._sources import Sources


class Mesh(Sources):
    """Nodes, cells, and named groups of them. It cannot be changed.

    Parameters
    ----------
    points : array (n, 3)
        Nodes.
    cells : dict of str to array of int (m, nodes)
        Nodes of the cells of each kind, in the order of VTK; `elements` lists the kinds. Cells are numbered in the
        order of the dict. Triangles and quadrilaterals beside solid cells are their faces for `cell_groups`.
    cell_groups : dict of str to array of int or bool, optional
        Cells of each group: their numbers, or a mask with a truth value for each cell.
    facet_groups : dict of str to array of int, optional
        Facets of each group: rows of node numbers (the corners suffice) or rows ``(cell, face)``; or a list of such
        arrays. Rows of two numbers are edges in a mesh in plane strain and ``(cell, face)`` otherwise.
    node_groups : dict of str to array of int or bool, optional
        Nodes of each group: their numbers, or a mask with a truth value for each node.

    Raises
    ------
    MeshError
        If a cell is inverted, or occurs twice.
    InputError
        If an array has the wrong shape, or names a node or cell that is not there.
    TypeError
        If an array has the wrong type.

    Examples
    --------
    >>> points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> mesh = emmy.Mesh(points, {"tet4": [[0, 1, 2, 3]]}, facet_groups={"base": [[0, 1, 2]]})
    >>> mesh
    <emmy.Mesh: 4 nodes, 1 cell (1 tet4)>
    >>> mesh.groups
    {'base': ('facets',)}

    Groups by masks:

    >>> points = np.array(points)
    >>> mesh = emmy.Mesh(points, {"tet4": [[0, 1, 2, 3]]}, node_groups={"base": points[:, 2] == 0})
    >>> mesh.group_nodes("base").tolist()
    [0, 1, 2]
    """

    @property
    def points(self) -> NDArray[np.float64]:
        """Nodes in the reference configuration, array (n, 3)."""
        return self._native.points

    @property
    def cells(self) -> dict[str, NDArray[np.int64]]:
        """Nodes of the cells of each kind, arrays (m, nodes)."""
        return self._native.cells

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return self._native.n_nodes

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return self._native.n_cells

    @property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """Names of the groups, each with what it holds: "cells", "facets", "nodes"."""
        return {name: tuple(kinds) for name, kinds in self._native.group_names.items()}

    @property
    def quality(self) -> dict[str, Any]:
        """Measures of the shape of the cells, as `emmy check` prints them."""
        return self._native.quality()

    @property
    def notes(self) -> list[str]:
        """Notes of the reader on the mesh."""
        return self._native.notes

    def group_nodes(self, name: str) -> NDArray[np.int64]:
        """Nodes of the facets of a group; without facets its nodes, else those of its cells; in ascending order.

        Parameters
        ----------
        name : str
            Name of the group; ``cells:NAME``, ``facets:NAME`` and ``nodes:NAME`` choose one kind of members.

        Returns
        -------
        array of int

        Raises
        ------
        UnknownGroupError
            If there is no such group.

        Examples
        --------
        >>> emmy.Mesh.box((1, 1, 1), (1, 1, 1)).group_nodes("x-min").size
        4
        """
        self._check_group(name, "name")
        return self._native.group_nodes(name)

    def _check_group(self, name: str, place: str) -> None:
        kind, _, plain = words.one(name, str, place).partition(":")
        if name not in self._native.group_names and kind not in self._native.group_names.get(plain, ()):
            available = tuple(self._native.group_names)
            chosen = [f"{kind}:{own}" for own, kinds in self.groups.items() for kind in kinds if ":" in name]
            near = difflib.get_close_matches(name, [*available, *chosen], n=1)
            groups = "groups: " + ", ".join(f"`{own}`" for own in available)
            help = f"did you mean `{near[0]}`?" if near else groups
            raise UnknownGroupError([Fault(place, f"the mesh has no group `{name}`", help, name, available)])

    def nearest_node(self, point: Sequence[float]) -> int:
        """The node that is nearest to a point.

        Parameters
        ----------
        point : vector
            Point in the reference configuration.

        Returns
        -------
        int

        Raises
        ------
        InputError
            If the point does not have three finite coordinates.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> mesh.points[mesh.nearest_node((0.9, 1.2, 0.1))].tolist()
        [1.0, 1.0, 0.0]
        """
        place = words.array(point, (3,), "point")
        if not np.isfinite(place).all():
            raise fault("point", f"{place.tolist()} is not finite")
        return self._native.nearest_node(place.tolist())

    def boundary(self) -> list[NDArray[np.int64]]:
        """Corner nodes of the facets on the surface.

        Returns
        -------
        list of array of int

        Examples
        --------
        >>> len(emmy.Mesh.box((1, 1, 1), (2, 2, 2)).boundary())
        24
        """
        return [np.asarray(nodes, dtype=np.int64) for nodes in self._native.boundary()]

    @property
    def entries(self) -> dict[str, dict[str, Any]]:
        """Rigid elements, couplings, ties, masses, springs and joints of a deck by name.

        They act in every body of this mesh. Each is the table of the input that it stands for, with its ``section``.
        """
        own = map(tomllib.loads, self._native.entries)
        return {entry["name"]: {"section": entry["section"]} | entry["table"] for entry in own}

    def scaled(self, factor: float) -> Self:
        """The mesh with all coordinates multiplied by a factor.

        Parameters
        ----------
        factor : float
            Positive factor.

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            If the factor is not positive.

        Examples
        --------
        >>> float(emmy.Mesh.box((1, 1, 1), (1, 1, 1)).scaled(1e-3).points.max())
        0.001
        """
        return self._of(self._native.scaled(factor))

    def merged(self, within: float) -> Self:
        """The mesh in which nodes at most a distance apart are one, so that the cells on both sides are joined.

        Parameters
        ----------
        within : float
            The distance.

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            If the distance is not positive, or two nodes of a cell would be one.

        Examples
        --------
        >>> points = [(0, 0, 0), (1, 0, 0), (1.001, 0, 0), (2, 0, 0)]
        >>> emmy.Mesh(points, {"line2": [(0, 1), (2, 3)]}).merged(0.01).n_nodes
        3
        """
        return self._of(self._native.merged(within))

    def placed(self, at: Sequence[float] = (0.0, 0.0, 0.0), *, turn: Mapping[str, Any] | None = None) -> Self:
        """The mesh at another place, with the points, axes and inertias of its `entries`.

        Parameters
        ----------
        at : vector, optional
            Shift: the place of the origin.
        turn : dict, optional
            Rotation before the shift: ``axis``, a vector of any length, ``angle`` in radians, counter-clockwise seen
            from the tip of the axis, and ``about``, a point of the axis (the origin if not given).

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            If the axis has no direction, or cells in plane strain are turned about another axis than z.

        Examples
        --------
        >>> from math import pi
        >>> box = emmy.Mesh.box((2, 1, 1), (1, 1, 1)).placed((5, 0, 0), turn={"axis": (0, 0, 1), "angle": pi / 2})
        >>> box.points.min(axis=0).tolist(), box.points.max(axis=0).tolist()
        ([4.0, 0.0, 0.0], [5.0, 2.0, 1.0])
        """
        shift = words.finite(at, (3,), "at").tolist()
        if turn is None:
            return self._of(self._native.placed(None, shift))
        given = words.mapping(turn, "turn")
        unknown = [key for key in given if key not in ("axis", "angle", "about")]
        if unknown:
            raise fault(f"turn.{unknown[0]}", "a rotation has the keys axis, angle and about")
        missing = [key for key in ("axis", "angle") if key not in given]
        if missing:
            raise fault("turn", f"`{missing[0]}` is missing")
        axis = words.finite(given["axis"], (3,), "turn.axis").tolist()
        about = words.finite(given.get("about", (0.0, 0.0, 0.0)), (3,), "turn.about").tolist()
        return self._of(self._native.placed((axis, words.real(given["angle"], "turn.angle"), about), shift))

    def to_meshio(self) -> Any:
        """The mesh as a `meshio.Mesh`, with groups as cell sets and point sets, and facets of groups as cells.

        Returns
        -------
        meshio.Mesh

        Raises
        ------
        ImportError
            If meshio is not installed.
        InputError
            If meshio has no such cells: its version 5.3 lacks wedge15 and pyramid13.

        Examples
        --------
        >>> emmy.Mesh.box((1, 1, 1), (1, 1, 1)).to_meshio().cells[0].type
        'hexahedron'
        """
        return _convert.to_meshio(self._native)

    def to_pyvista(self, group: str | None = None) -> Any:
        """The mesh as a grid of PyVista, with groups as arrays ``group:NAME`` and ``facets:NAME``.

        Parameters
        ----------
        group : str, optional
            Group whose cells alone are in the grid; without cells its facets, else its nodes.

        Returns
        -------
        pyvista.UnstructuredGrid

        Raises
        ------
        ImportError
            If PyVista is not installed.
        UnknownGroupError
            If the mesh does not have the group.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (2, 2, 2))
        >>> mesh.to_pyvista().n_cells, mesh.to_pyvista("x-max").n_cells
        (8, 4)
        """
        grid = _convert.to_pyvista(self._native)
        return grid if group is None else self._part(grid, group)

    def _part(self, grid: Any, group: str) -> Any:
        """The members of a group in a grid of the whole mesh."""
        self._check_group(group, "group")
        return _convert.part(self._native, grid, group)

    def __repr__(self) -> str:
        count, kinds = self.n_cells, ", ".join(f"{len(nodes)} {kind}" for kind, nodes in self.cells.items())
        return f"<emmy.Mesh: {self.n_nodes} nodes, {count} cell{'' if count == 1 else 's'} ({kinds})>"

    def __reduce__(self) -> tuple[Any, ...]:
        if self.n_cells == 0:
            return _empty, ()
        return _from_vtu, (bytes(self._native.vtu()), self._native.link_groups, self._native.entries)


def _empty() -> Mesh:
    return Mesh._of(_emmy.Mesh.empty())


def _from_vtu(content: bytes, links: list[str], entries: list[str]) -> Mesh:
    return Mesh._of(_emmy.Mesh.from_vtu(content, links).with_entries(entries))
