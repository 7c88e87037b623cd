"""Meshes of Gmsh, meshio and PyVista."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from . import _emmy
from ._errors import Fault, MeshError, fault, missing

M = TypeVar("M")
Array = NDArray[Any]


class Kind(NamedTuple):
    """A kind of cell: its names and its dimension."""

    name: str
    meshio: str
    vtk: int
    dimension: int


KINDS = [
    Kind("hex8", "hexahedron", 12, 3),
    Kind("hex20", "hexahedron20", 25, 3),
    Kind("hex27", "hexahedron27", 29, 3),
    Kind("tet4", "tetra", 10, 3),
    Kind("tet10", "tetra10", 24, 3),
    Kind("wedge6", "wedge", 13, 3),
    Kind("wedge15", "wedge15", 26, 3),
    Kind("pyramid5", "pyramid", 14, 3),
    Kind("pyramid13", "pyramid13", 27, 3),
    Kind("tri3", "triangle", 5, 2),
    Kind("tri6", "triangle6", 22, 2),
    Kind("quad4", "quad", 9, 2),
    Kind("quad8", "quad8", 23, 2),
    Kind("quad9", "quad9", 28, 2),
    Kind("line2", "line", 3, 1),
    Kind("line3", "line3", 21, 1),
    Kind("vertex", "vertex", 1, 0),
]
OF_NAME = {kind.name: kind for kind in KINDS}

# Types of VTK for the other cells of meshio. Those of higher order are Lagrange cells there.
OTHERS = {
    "polygon": 7,
    "pixel": 8,
    "voxel": 11,
    "penta_prism": 15,
    "hexa_prism": 16,
    "quad6": 30,
    "wedge12": 31,
    "wedge18": 32,
    "hexahedron24": 33,
    "triangle7": 34,
    "line4": 35,
}
LAGRANGE = {"line": 68, "triangle": 69, "quad": 70, "tetra": 71, "hexahedron": 72, "wedge": 73, "pyramid": 74}
ORDERS = {"CURVE": 0, "TRIANGLE": 1, "QUADRILATERAL": 2, "TETRAHEDRON": 3, "HEXAHEDRON": 4, "WEDGE": 5, "PYRAMID": 6}
OF_MESHIO = {
    **{kind.meshio: kind.vtk for kind in KINDS},
    **OTHERS,
    **{f"VTK_LAGRANGE_{name}": 68 + number for name, number in ORDERS.items()},
    **{f"VTK_BEZIER_{name}": 75 + number for name, number in ORDERS.items()},
}


def dimension(name: str) -> int:
    """Dimension of a kind; of an unknown one 0, which the library reports."""
    return OF_NAME[name].dimension if name in OF_NAME else 0


Arrays = list[tuple[str, Array | None]]


class Grid(NamedTuple):
    """An unstructured grid as VTK has it; what its arrays and cells become is decided in one place for all sources."""

    points: Array
    types: Array
    ends: Array
    connectivity: Array
    cell_arrays: Arrays
    point_arrays: Arrays


def from_gmsh(read: Callable[[str, Sequence[str]], M], model: str | None, links: Sequence[str]) -> M:
    """Reads a model of Gmsh through a temporary file, so that there is one reader with one set of messages."""
    try:
        import gmsh
    except ImportError:
        raise missing("from_gmsh", "Gmsh", "gmsh") from None
    if not gmsh.isInitialized():
        raise RuntimeError("Gmsh has no model: call gmsh.initialize() and make a mesh first")
    if model is not None and not isinstance(model, str):
        raise TypeError(
            f"model: {type(model).__name__} is not the name of a model of Gmsh; without a name it is the current model"
        )
    if model is not None and model not in gmsh.model.list():
        raise fault("model", f"Gmsh has no model {model!r}, only {', '.join(map(repr, gmsh.model.list()))}")
    before = gmsh.model.getCurrent()
    options = {"Mesh.Binary": 1.0, "Mesh.MshFileVersion": 4.1}
    kept = {name: gmsh.option.getNumber(name) for name in options}
    try:
        if model is not None:
            gmsh.model.setCurrent(model)
        for name, value in options.items():
            gmsh.option.setNumber(name, value)
        with tempfile.TemporaryDirectory() as directory:
            path = os.path.join(directory, "model.msh")
            gmsh.write(path)
            return read(path, links)
    finally:
        for name, value in kept.items():
            gmsh.option.setNumber(name, value)
        gmsh.model.setCurrent(before)


def from_meshio(mesh: Any) -> Grid:
    """The grid of a mesh of meshio; its sets are arrays ``group:NAME``, without the blanks that fill names in files."""
    if not all(hasattr(mesh, part) for part in ("points", "cells", "cell_sets", "field_data")):
        help = "; Mesh.read reads files" if isinstance(mesh, (str, os.PathLike)) else ""
        raise TypeError(f"mesh: {type(mesh).__name__} is not a meshio.Mesh{help}")
    types, sizes, connectivity = [], [], [np.zeros(0, dtype=np.int64)]
    for cells in mesh.cells:
        rows = _rows(cells)
        types.append(np.full(len(rows), _vtk_type(cells.type), dtype=np.int64))
        sizes.append(np.array([len(row) for row in rows], dtype=np.int64))
        connectivity.extend(rows if isinstance(rows, list) else [rows.ravel()])
    starts = np.cumsum([0, *(len(own) for own in types)])
    n_cells = int(starts[-1])
    # Arrays of meshio's reader of MSH files, whose names belong to the numbers of physical groups.
    is_msh = bool(mesh.field_data) or any(name.startswith("gmsh:") for name in mesh.cell_sets)
    cell_arrays = []
    for name, blocks in mesh.cell_data.items():
        values = np.concatenate([np.asarray(block) for block in blocks]) if blocks else np.zeros(0)
        if name == "gmsh:physical":
            dimensions = [getattr(cells, "dim", 0) for cells in mesh.cells]
            cell_arrays += _physical(mesh, values, np.repeat(dimensions, np.diff(starts)))
        if not (is_msh and name.startswith("gmsh:")):
            cell_arrays.append((name, _numbers(values)))
    for name, blocks in mesh.cell_sets.items():
        if not name.startswith("gmsh:"):
            inside = np.zeros(n_cells, dtype=np.int64)
            for start, members in zip(starts, blocks, strict=False):
                if members is not None and len(members):
                    inside[start + np.asarray(members, dtype=np.int64)] = 1
            cell_arrays.append((f"group:{name.rstrip()}", inside))
    points = _in_space(mesh.points)
    point_arrays = [(name, _numbers(values)) for name, values in mesh.point_data.items()]
    for name, members in mesh.point_sets.items():
        inside = np.zeros(len(points), dtype=np.int64)
        inside[np.asarray(members, dtype=np.int64)] = 1
        point_arrays.append((f"group:{name.rstrip()}", inside))
    ends = np.cumsum(np.concatenate([np.zeros(0, dtype=np.int64), *sizes]), dtype=np.int64)
    all_types = np.concatenate([np.zeros(0, dtype=np.int64), *types])
    nodes = np.concatenate([np.asarray(rows, dtype=np.int64) for rows in connectivity])
    return Grid(points, all_types, ends, nodes, cell_arrays, point_arrays)


def _rows(cells: Any) -> Any:
    """Nodes of each cell: an array, or a list of arrays of a polyhedron's nodes."""
    if cells.type.startswith("polyhedron"):
        return [np.unique(np.concatenate([np.ravel(face) for face in cell])) for cell in cells.data]
    try:
        return np.asarray(cells.data, dtype=np.int64)
    except ValueError:
        return [np.asarray(row, dtype=np.int64) for row in cells.data]


def _vtk_type(name: str) -> int:
    """VTK's type for a type of meshio."""
    if name.startswith("polyhedron"):
        return 42
    shape = name.rstrip("0123456789")
    if name not in OF_MESHIO and shape not in LAGRANGE:
        raise MeshError([Fault("", f"Emmy has no cells like {name!r} of meshio")])
    return OF_MESHIO[name] if name in OF_MESHIO else LAGRANGE[shape]


def _physical(mesh: Any, tags: Array, dimensions: Array) -> Arrays:
    """The physical groups of Gmsh; the name of an unnamed one is its number."""
    names = {(int(tag), int(dim)): name.rstrip() for name, (tag, dim) in mesh.field_data.items()}
    groups: dict[str, Array] = {}
    for tag, dim in np.unique(np.column_stack([tags, dimensions]), axis=0).astype(np.int64).tolist():
        if tag:
            name, members = names.get((tag, dim), str(tag)), (tags == tag) & (dimensions == dim)
            groups[name] = groups.get(name, np.zeros(len(tags), dtype=np.int64)) | members
    return [(f"group:{name}", members) for name, members in groups.items()]


def from_pyvista(grid: Any) -> Grid:
    """The grid of a data set of PyVista."""
    if not hasattr(grid, "cast_to_unstructured_grid"):
        if isinstance(grid, (str, os.PathLike)):
            help = "Mesh.read reads files"
        elif hasattr(grid, "combine"):
            help = "take one of its blocks, or join them with its method combine()"
        else:
            help = "pyvista.wrap makes one of a data set of VTK"
        raise TypeError(f"grid: {type(grid).__name__} is not a data set of PyVista; {help}")
    grid = grid.cast_to_unstructured_grid()
    return Grid(
        np.asarray(grid.points, dtype=np.float64),
        np.asarray(grid.celltypes, dtype=np.int64),
        np.asarray(_offsets(grid), dtype=np.int64)[1:],
        np.asarray(grid.cell_connectivity, dtype=np.int64),
        [(name, _numbers(grid.cell_data[name])) for name in grid.cell_data.keys()],
        [(name, _numbers(grid.point_data[name])) for name in grid.point_data.keys()],
    )


def _offsets(grid: Any) -> Any:
    # PyVista 0.49 has renamed them.
    return grid.cell_offsets if hasattr(grid, "cell_offsets") else grid.offset


def _numbers(values: Any) -> Array | None:
    """One number of each cell or point, whole or real; None if there are several, or texts."""
    values = np.asarray(values)
    if values.ndim == 2 and values.shape[1] == 1:
        values = values[:, 0]
    if values.ndim != 1 or values.dtype.kind not in "biuf":
        return None
    return np.ascontiguousarray(values, dtype=np.float64 if values.dtype.kind == "f" else np.int64)


def _in_space(points: Any) -> Array:
    points = np.asarray(points, dtype=np.float64)
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1]))) if points.shape[1] < 3 else points


def _members(mesh: _emmy.Mesh, what: str) -> list[str]:
    return [name for name, kinds in mesh.group_names.items() if what in kinds]


def _facet_kind(nodes: Sequence[int], is_plane: bool) -> Kind:
    names = {2: "line2", 3: "line3"} if is_plane else {3: "tri3", 4: "quad4", 6: "tri6", 8: "quad8", 9: "quad9"}
    return OF_NAME[names[len(nodes)]]


def to_meshio(mesh: _emmy.Mesh) -> Any:
    """A mesh of meshio."""
    try:
        import meshio
    except ImportError:
        raise missing("to_meshio", "meshio", "emmy-fem[meshio]") from None
    blocks = [(OF_NAME[name].meshio, nodes) for name, nodes in mesh.cells.items()]
    numbers = list(mesh.cell_numbers.values())
    sets: dict[str, list[tuple[int, Array]]] = {}
    for name in _members(mesh, "cells"):
        inside = np.isin(np.arange(mesh.n_cells), mesh.cell_group(name))
        sets.setdefault(name, []).extend((index, np.flatnonzero(inside[own])) for index, own in enumerate(numbers))
    is_plane = all(dimension(name) < 3 for name in mesh.cells)
    for name in _members(mesh, "facets"):
        facets: dict[str, list[Sequence[int]]] = {}
        for nodes in mesh.facet_nodes(name):
            facets.setdefault(_facet_kind(nodes, is_plane).meshio, []).append(nodes)
        for kind, rows in facets.items():
            sets.setdefault(name, []).append((len(blocks), np.arange(len(rows))))
            blocks.append((kind, np.array(rows)))
    cell_sets = {}
    for name, parts in sets.items():
        cell_sets[name] = [np.zeros(0, dtype=np.int64) for _ in blocks]
        for index, members in parts:
            cell_sets[name][index] = members
    point_sets = {name: mesh.node_group(name) for name in _members(mesh, "nodes")}
    try:
        return meshio.Mesh(mesh.points, blocks, cell_sets=cell_sets, point_sets=point_sets)
    except KeyError as error:
        # meshio 5.3 lacks wedge15 and pyramid13 in a table of dimensions.
        raise fault("mesh", f"meshio {meshio.__version__} cannot hold cells of the kind {error}") from None


def part(mesh: _emmy.Mesh, grid: Any, name: str) -> Any:
    """The members of a group in a grid of the whole mesh: its cells, else its facets, else its nodes."""
    import pyvista

    kinds = mesh.group_names[name]
    if "cells" in kinds:
        return _without_loose_points(grid.extract_cells(mesh.cell_group(name)))
    if "facets" in kinds:
        is_plane = all(dimension(kind) < 3 for kind in mesh.cells)
        rows = mesh.facet_nodes(name)
        types = [_facet_kind(row, is_plane).vtk for row in rows]
    else:
        rows = [[node] for node in mesh.node_group(name).tolist()]
        types = [OF_NAME["vertex"].vtk] * len(rows)
    # Without the nodes of other cells.
    nodes = np.unique(np.concatenate(rows))
    connectivity = np.concatenate([[len(row), *np.searchsorted(nodes, row)] for row in rows])
    members = pyvista.UnstructuredGrid(connectivity, np.array(types, dtype=np.uint8), mesh.points[nodes])
    for key in grid.point_data.keys():
        members.point_data[key] = grid.point_data[key][nodes]
    if "facets" in kinds:
        for key in grid.cell_data.keys():
            members.cell_data[key] = grid.cell_data[key][mesh.facet_group(name)[:, 0]]
    return members


def _without_loose_points(grid: Any) -> Any:
    """The grid without points of no cell, such as those of rigid bodies, which a selection of all cells keeps."""
    import pyvista

    used = np.unique(grid.cell_connectivity)
    if len(used) == grid.n_points:
        return grid
    offset = pyvista.convert_array(grid.GetCells().GetOffsetsArray())
    cells = np.insert(np.searchsorted(used, grid.cell_connectivity), offset[:-1], np.diff(offset))
    found = pyvista.UnstructuredGrid(cells, grid.celltypes, grid.points[used])
    for key in grid.point_data.keys():
        found.point_data[key] = grid.point_data[key][used]
    for key in grid.cell_data.keys():
        found.cell_data[key] = grid.cell_data[key]
    return found


def to_pyvista(mesh: _emmy.Mesh) -> Any:
    """A grid of PyVista, with cells in the order of their numbers."""
    try:
        import pyvista
    except ImportError:
        raise missing("to_pyvista", "PyVista", "emmy-fem[pyvista]") from None
    n_cells = mesh.n_cells
    sizes, types = np.zeros(n_cells, dtype=np.int64), np.zeros(n_cells, dtype=np.uint8)
    for name, numbers in mesh.cell_numbers.items():
        sizes[numbers], types[numbers] = 1 + mesh.cells[name].shape[1], OF_NAME[name].vtk
    ends = np.cumsum(sizes)
    connectivity = np.zeros(int(sizes.sum()), dtype=np.int64)
    for name, numbers in mesh.cell_numbers.items():
        rows = mesh.cells[name]
        places = (ends - sizes)[numbers][:, None] + np.arange(rows.shape[1] + 1)
        connectivity[places] = np.column_stack([np.full(len(rows), rows.shape[1]), rows])
    grid = pyvista.UnstructuredGrid(connectivity, types, mesh.points)
    for name in _members(mesh, "cells"):
        grid.cell_data[f"group:{name}"] = np.isin(np.arange(n_cells), mesh.cell_group(name)).astype(np.uint8)
    for name in _members(mesh, "facets"):
        bits = np.zeros(n_cells, dtype=np.uint8)
        pairs = mesh.facet_group(name)
        np.bitwise_or.at(bits, pairs[:, 0], (1 << pairs[:, 1]).astype(np.uint8))
        grid.cell_data[f"facets:{name}"] = bits
    for name in _members(mesh, "nodes"):
        inside = np.isin(np.arange(mesh.n_nodes), mesh.node_group(name))
        grid.point_data[f"group:{name}"] = inside.astype(np.uint8)
    return grid
