"""Where meshes come from."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _convert, _emmy
from . import _words as words
from ._errors import fault, warn


class Sources:
    """Where meshes come from."""

    _native: _emmy.Mesh

    def __init__(
        self,
        points: ArrayLike,
        cells: Mapping[str, ArrayLike],
        *,
        cell_groups: Mapping[str, ArrayLike] | None = None,
        facet_groups: Mapping[str, Any] | None = None,
        node_groups: Mapping[str, ArrayLike] | None = None,
    ) -> None:
        blocks = [
            (kind, words.integers(nodes, f"cells.{kind}")) for kind, nodes in words.mapping(cells, "cells").items()
        ]
        for kind, nodes in blocks:
            if nodes.ndim != 2:
                raise fault(f"cells.{kind}", f"expected an array of shape (n, nodes), found {nodes.shape}")
        nodes_of_mesh = words.array(points, (None, 3), "points")
        for kind, nodes in blocks:
            wrong = nodes >= len(nodes_of_mesh)
            if wrong.any():
                row = int(np.argmax(wrong.any(axis=1)))
                number = nodes[row][wrong[row]][0]
                raise fault(f"cells.{kind}[{row}]", f"there is no node {number} among {len(nodes_of_mesh)} points")
        is_plane = not any(_convert.dimension(kind) == 3 for kind, _ in blocks)
        self._native = _emmy.Mesh.from_arrays(
            nodes_of_mesh,
            blocks,
            _groups(cell_groups, sum(len(nodes) for _, nodes in blocks), "cell_groups"),
            {
                name: _facets(group, f"facet_groups.{name}", is_plane)
                for name, group in words.mapping(facet_groups or {}, "facet_groups").items()
            },
            _groups(node_groups, len(nodes_of_mesh), "node_groups"),
        )
        warn(self._native.notes)

    @classmethod
    def _of(cls, native: _emmy.Mesh) -> Self:
        mesh = cls.__new__(cls)
        mesh._native = native
        return mesh

    @classmethod
    def _from_grid(cls, name: str, grid: _convert.Grid, links: Sequence[str]) -> Self:
        mesh = cls._of(_emmy.Mesh.from_grid(name, *grid, list(links)))
        warn(mesh._native.notes)
        return mesh

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str],
        links: Sequence[str] = (),
        *,
        shells: Literal["plane-strain"] | None = None,
        leave_out: Sequence[str] = (),
    ) -> Self:
        """Mesh from a file of Gmsh, Abaqus, Nastran or VTK.

        Parameters
        ----------
        path : str or path
            File.
        links : list of str, optional
            Groups of lines that are links, not edges.
        shells : {"plane-strain"}, optional
            What the shells of a Nastran or Abaqus file without solid cells are: cells in plane strain, without their
            thickness. Without it they are an error.
        leave_out : list of str, optional
            Names of rigid elements, couplings, ties, masses, springs and joints of a Nastran or Abaqus file that do not
            act in a body of this mesh, nor do others that name them; `Mesh.entries` has those that act.

        Returns
        -------
        Mesh

        Raises
        ------
        MeshError
            If the file cannot be read.
        InputError
            If ``shells`` is another word, or the file has nothing of a name in `leave_out`.

        Examples
        --------
        >>> path = emmy.Mesh.box((2, 1, 1), (2, 1, 1)).write("box.vtu")
        >>> emmy.Mesh.read(path).n_cells
        2
        """
        if shells not in (None, "plane-strain"):
            raise fault("shells", f'expected "plane-strain" or None, not {shells!r}')
        native = _emmy.Mesh.read(os.fspath(path), list(links), shells is not None)
        names = [tomllib.loads(entry)["name"] for entry in native.entries]
        for name in leave_out:
            if name not in names:
                known = f"there is {', '.join(names)}" if names else "the file has a mesh alone"
                raise fault("leave_out", f"the mesh has nothing that is named {name!r}; {known}")
        mesh = cls._of(native.acting(list(leave_out)))
        warn(mesh._native.notes)
        return mesh

    def write(self, path: str | os.PathLike[str]) -> str:
        """Writes the mesh with all groups as a VTU file.

        Parameters
        ----------
        path : str or path
            File ``NAME.vtu``, which must not exist.

        Returns
        -------
        str
            The path.

        Raises
        ------
        InputError
            If the name has another ending.
        FileExistsError
            If the file exists.

        Examples
        --------
        >>> emmy.Mesh.l_block(1.0).write("l-block.vtu")
        'l-block.vtu'
        """
        if os.path.splitext(os.fspath(path))[1].lower() != ".vtu":
            raise fault("path", "meshes are written as .vtu", "Mesh.to_meshio leads to other formats")
        with open(path, "xb") as file:
            file.write(self._native.vtu())
        return os.fspath(path)

    @classmethod
    def from_gmsh(cls, model: str | None = None, *, links: Sequence[str] = ()) -> Self:
        """Mesh of the current model of Gmsh, or of a named one, with its physical groups.

        Parameters
        ----------
        model : str, optional
            Name of the model.
        links : list of str, optional
            Groups of lines that are links, not edges.

        Returns
        -------
        Mesh

        Raises
        ------
        ImportError
            If Gmsh is not installed.
        MeshError
            If the mesh cannot be used.

        Examples
        --------
        >>> import gmsh
        >>> gmsh.initialize(interruptible=False)
        >>> gmsh.option.setNumber("General.Terminal", 0)
        >>> _ = gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
        >>> gmsh.model.occ.synchronize()
        >>> _ = gmsh.model.addPhysicalGroup(3, [1], name="body")
        >>> gmsh.model.mesh.generate(3)
        >>> list(emmy.Mesh.from_gmsh().cells)
        ['tet4']
        >>> gmsh.finalize()
        """
        return _convert.from_gmsh(cls.read, model, links)

    @classmethod
    def from_meshio(cls, mesh: Any, *, links: Sequence[str] = ()) -> Self:
        """Mesh of meshio; its cell sets, point sets, physical groups and other arrays of whole numbers become groups.

        They are the groups that `read` takes from a file of VTK with the same arrays: ``ARRAY=VALUE`` for each of up to
        64 values. `notes` names the arrays and counts the cells that are left out.

        Parameters
        ----------
        mesh : meshio.Mesh
            The mesh. Cells of lower dimension are facets, edges and points of groups.
        links : list of str, optional
            Groups of lines that are links, not edges.

        Returns
        -------
        Mesh

        Raises
        ------
        MeshError
            If it has solid cells that Emmy does not have.

        Examples
        --------
        >>> box = emmy.Mesh.box((1, 1, 1), (2, 2, 2))
        >>> emmy.Mesh.from_meshio(box.to_meshio()).groups == box.groups
        True
        """
        return cls._from_grid("the mesh of meshio", _convert.from_meshio(mesh), links)

    @classmethod
    def from_pyvista(cls, grid: Any, *, links: Sequence[str] = ()) -> Self:
        """Mesh of PyVista; arrays of whole numbers become groups.

        They are the groups that `read` takes from a file of the grid: ``NAME`` for arrays ``group:NAME`` and
        ``facets:NAME``, else ``ARRAY=VALUE`` for each of up to 64 values. `notes` names the arrays and counts the cells
        that are left out.

        Parameters
        ----------
        grid : pyvista.DataSet
            The grid.
        links : list of str, optional
            Groups of lines that are links, not edges.

        Returns
        -------
        Mesh

        Raises
        ------
        MeshError
            If it has solid cells that Emmy does not have.

        Examples
        --------
        >>> box = emmy.Mesh.box((1, 1, 1), (2, 2, 2))
        >>> emmy.Mesh.from_pyvista(box.to_pyvista()).groups == box.groups
        True
        >>> import numpy as np
        >>> import pyvista
        >>> image = pyvista.ImageData(dimensions=(3, 2, 2))
        >>> image.cell_data["material"] = np.array([1, 2])
        >>> emmy.Mesh.from_pyvista(image).groups
        {'material=1': ('cells',), 'material=2': ('cells',)}
        """
        return cls._from_grid("the grid", _convert.from_pyvista(grid), links)

    @classmethod
    def l_block(cls, cell_size: float) -> Self:
        """The L-shaped block of Betsch and Steinmann (2001); groups "body", "face-a" (y = 10), "face-b" (x = 6).

        Parameters
        ----------
        cell_size : float
            Edge of its hex8 cells: 1, 1/2, 1/3, ...

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            For another cell size.

        Examples
        --------
        >>> emmy.Mesh.l_block(cell_size=1.0).n_cells
        117
        """
        return cls._of(_emmy.Mesh.l_block(cell_size))

    @classmethod
    def box(cls, size: Sequence[float], cells: Sequence[int]) -> Self:
        """A block of hex8 cells with a corner at the origin; groups "body", "x-min", "x-max", ... "z-max".

        Parameters
        ----------
        size : vector
            Its edges.
        cells : three int
            Number of cells along each edge.

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            If a size or a number is not positive.

        Examples
        --------
        >>> emmy.Mesh.box((2, 8, 2), (2, 8, 2)).n_nodes
        81
        """
        return cls._of(_emmy.Mesh.box(words.array(size, (3,), "size").tolist(), words.counts(cells, 3, "cells")))

    @classmethod
    def ring(cls, inner: float, outer: float, height: float, cells: Sequence[int]) -> Self:
        """A ring of hex8 cells about the z axis, base at z = 0; groups "body", "inner", "outer", "z-min", "z-max".

        Parameters
        ----------
        inner, outer : float
            Radii of its sides, where their nodes lie; the facets between them are plane.
        height : float
            Length along the axis.
        cells : three int
            Number of cells along the radius, around the axis (at least 3) and along it.

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            If a size or a number is not positive, or the inner radius is not the smaller one.

        Examples
        --------
        >>> mesh = emmy.Mesh.ring(1.0, 2.0, 0.5, (1, 6, 1))
        >>> round(mesh.quality["volume"], 6)
        3.897114
        """
        radii = [words.real(inner, "inner"), words.real(outer, "outer")]
        return cls._of(_emmy.Mesh.ring(radii, words.real(height, "height"), words.counts(cells, 3, "cells")))

    @classmethod
    def cylinder(cls, radius: float, height: float, cells: Sequence[int]) -> Self:
        """A cylinder of hex8 cells about the z axis, base at z = 0; groups "body", "side", "z-min", "z-max".

        Half of the cells along the radius, rounded up, lie in a square core with rounded sides, the others in layers
        around it.

        Parameters
        ----------
        radius : float
            Radius of its side, where the nodes lie; the facets between them are plane.
        height : float
            Length along the axis.
        cells : two int
            Number of cells from the axis to the side, and along the axis.

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            If a size or a number is not positive.

        Examples
        --------
        >>> emmy.Mesh.cylinder(1.0, 3.0, (2, 5)).n_cells
        60
        """
        own, along = words.real(radius, "radius"), words.real(height, "height")
        return cls._of(_emmy.Mesh.cylinder(own, along, words.counts(cells, 2, "cells")))

    @classmethod
    def ball(cls, radius: float, cells: int) -> Self:
        """A ball of hex8 cells about the origin; groups "body", "surface".

        Half of the cells from the centre to the surface, rounded up, lie in a cube with rounded sides, the others in
        layers around it.

        Parameters
        ----------
        radius : float
            Radius of its surface, where the nodes lie.
        cells : int
            Number of cells from the centre to the surface.

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            If a size or a number is not positive.

        Examples
        --------
        >>> emmy.Mesh.ball(0.5, 4).n_cells
        256
        """
        return cls._of(_emmy.Mesh.ball(words.real(radius, "radius"), words.count(cells, 1, "cells")))

    @classmethod
    def joined(cls, parts: Mapping[str, Any]) -> Self:
        """One mesh of several, each a part with a name.

        The cells of a part form the group of its name, and its groups get the name before theirs: ``left``,
        ``left-x-min``. A group ``body`` of all cells is the part itself. `notes` and `entries` get the name as well.
        Parts that touch are separate bodies; `merged` joins them where nodes meet.

        Parameters
        ----------
        parts : dict of str to Mesh
            Parts by their names, of letters, digits, ``_`` and ``-``; `placed` puts each at its place.

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            If a name has other characters, or two parts have one name of a group, or if one part is in plane strain and
            another one is solid.
        TypeError
            If a part is no mesh.

        Examples
        --------
        >>> box, ball = emmy.Mesh.box((1, 1, 1), (2, 2, 2)), emmy.Mesh.ball(0.5, 2)
        >>> mesh = emmy.Mesh.joined({"base": box, "ball": ball.placed((0.5, 0.5, 2.0))})
        >>> list(mesh.groups)[:3]
        ['ball', 'ball-surface', 'base']
        """
        given = words.mapping(parts, "parts")
        if not given:
            raise fault("parts", "there are no parts")
        own = [(name, words.one(part, cls, f"parts.{name}")._native) for name, part in given.items()]
        mesh = cls._of(_emmy.Mesh.joined(own))
        known = {f"{name}: {note}" for name, part in own for note in part.notes}
        warn([note for note in mesh._native.notes if note not in known])
        return mesh

    @classmethod
    def rectangle(cls, size: Sequence[float], cells: Sequence[int]) -> Self:
        """A body in plane strain of quad4 cells with a corner at the origin; groups "body", "x-min", ... "y-max".

        Parameters
        ----------
        size : two float
            Its edges.
        cells : two int
            Number of cells along each edge.

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            If a size or a number is not positive.

        Examples
        --------
        >>> list(emmy.Mesh.rectangle((2, 1), (4, 2)).cells)
        ['quad4']
        """
        sizes = words.array(size, (2,), "size").tolist()
        return cls._of(_emmy.Mesh.rectangle(sizes, words.counts(cells, 2, "cells")))

    @classmethod
    def network(
        cls,
        points: ArrayLike,
        links: ArrayLike,
        groups: Mapping[str, ArrayLike] | None = None,
        link_groups: Mapping[str, ArrayLike] | None = None,
    ) -> Self:
        """Links between points; group "links" of all of them.

        Parameters
        ----------
        points : array (n, 3)
            Points.
        links : array of int (m, 2)
            Pairs of points.
        groups, link_groups : dict of str to array of int or bool, optional
            Groups of points and of links: their numbers, or a mask of all of them.

        Returns
        -------
        Mesh

        Raises
        ------
        InputError
            If a link or a group names a point or link that is not there, or an array has the wrong shape.

        Examples
        --------
        >>> emmy.Mesh.network([[0, 0, 0], [1, 0, 0]], [[0, 1]], groups={"star": [0]}).group_nodes("star").tolist()
        [0]
        """
        nodes = words.array(points, (None, 3), "points")
        pairs = words.integers(links, "links")
        if pairs.ndim != 2 or pairs.shape[1] != 2:
            raise fault("links", f"expected an array of shape (m, 2), found {pairs.shape}")
        own, own_links = _groups(groups, len(nodes), "groups"), _groups(link_groups, len(pairs), "link_groups")
        mesh = cls._of(_emmy.Mesh.network(nodes, pairs, own, own_links))
        warn(mesh._native.notes)
        return mesh


# `Mesh` alone is public: messages about wrong arguments name it.
for _name, _member in vars(Sources).items():
    if isinstance(_member, (classmethod, staticmethod)):
        _member.__func__.__qualname__ = f"Mesh.{_name}"


def _groups(groups: Mapping[str, ArrayLike] | None, n: int, place: str) -> dict[str, NDArray[np.int64]]:
    """Groups of some of n nodes or cells."""
    given = words.mapping(groups or {}, place)
    return {name: words.members(group, n, f"{place}.{name}") for name, group in given.items()}


def _is_named(part: Any) -> bool:
    """Whether it is a pair of a word and an array of facets."""
    return isinstance(part, tuple) and bool(part) and isinstance(part[0], str)


def _facets(group: Any, place: str, is_plane: bool) -> list[tuple[str, NDArray[np.int64]]]:
    """Arrays of facets, each with the meaning of its rows: node numbers, or cell and face."""
    if _is_named(group):
        if group[0] not in ("nodes", "faces"):
            raise fault(place, f"the rows are `nodes` or `faces`, not `{group[0]}`")
        if len(group) != 2:
            raise fault(place, f"expected a pair (`{group[0]}`, rows), found a tuple of {len(group)}")
        return [(group[0], words.integers(group[1], place))]
    # An array of facets has two axes, the row of one facet has one.
    if (
        isinstance(group, (list, tuple))
        and group
        and all(_is_named(part) or words.regular(part, place).ndim == 2 for part in group)
    ):
        return [facets for part in group for facets in _facets(part, place, is_plane)]
    rows = words.integers(group, place)
    if rows.ndim != 2:
        raise fault(place, f"expected an array of shape (n, corners) or (n, 2), found {rows.shape}")
    return [("faces" if rows.shape[1] == 2 and not is_plane else "nodes", rows)]
