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
    """A kind of cell: its names, its dimension and its number of corners."""

    name: str
    meshio: str
    vtk: int
    dimension: int
    corners: int


KINDS = [
    Kind("hex8", "hexahedron", 12, 3, 8),
    Kind("hex20", "hexahedron20", 25, 3, 8),
    Kind("hex27", "hexahedron27", 29, 3, 8),
    Kind("tet4", "tetra", 10, 3, 4),
    Kind("tet10", "tetra10", 24, 3, 4),
    Kind("wedge6", "wedge", 13, 3, 6),
    Kind("wedge15", "wedge15", 26, 3, 6),
    Kind("pyramid5", "pyramid", 14, 3, 5),
    Kind("pyramid13", "pyramid13", 27, 3, 5),
    Kind("tri3", "triangle", 5, 2, 3),
    Kind("tri6", "triangle6", 22, 2, 3),
    Kind("quad4", "quad", 9, 2, 4),
    Kind("quad8", "quad8", 23, 2, 4),
    Kind("quad9", "quad9", 28, 2, 4),
    Kind("line2", "line", 3, 1, 2),
    Kind("line3", "line3", 21, 1, 2),
    Kind("vertex", "vertex", 1, 0, 1),
]
OF_NAME = {kind.name: kind for kind in KINDS}
OF_MESHIO = {kind.meshio: kind for kind in KINDS}
OF_VTK = {kind.vtk: kind for kind in KINDS}


def dimension(name: str) -> int:
    """Dimension of a kind; of an unknown one 0, which the library reports."""
    return OF_NAME[name].dimension if name in OF_NAME else 0


class Block(NamedTuple):
    """Cells of one kind in a foreign mesh, with their members in each group, and faces by bits."""

    kind: Kind
    nodes: Array
    groups: dict[str, Array]
    facets: dict[str, Array]


def assemble(points: Array, blocks: list[Block], nodes: dict[str, Array], links: Sequence[str]) -> dict[str, Any]:
    """The arguments of a mesh: cells of the highest dimension, the others as facets or nodes of their groups."""
    top = max((block.kind.dimension for block in blocks), default=0)
    if top == 0:
        raise MeshError([Fault("", "the mesh has no cells")])
    parts = [part for block in blocks for part in _divided(block, links, top)]
    own = [block for is_cell, block in parts if is_cell]
    order = list(dict.fromkeys(block.kind.name for block in own))
    own.sort(key=lambda block: order.index(block.kind.name))
    cells = {name: np.concatenate([block.nodes for block in own if block.kind.name == name]) for name in order}
    cell_groups: dict[str, list[Array]] = {}
    facet_groups: dict[str, list[tuple[str, Array]]] = {}
    node_groups: dict[str, list[Array]] = {name: [members] for name, members in nodes.items()}
    first = 0
    for block in own:
        for name, members in block.groups.items():
            cell_groups.setdefault(name, []).append(first + np.flatnonzero(members))
        for name, bits in block.facets.items():
            pairs = [(first + np.flatnonzero(bits >> face & 1), face) for face in range(6)]
            rows = np.concatenate([np.column_stack([cell, np.full_like(cell, face)]) for cell, face in pairs])
            facet_groups.setdefault(name, []).append(("faces", rows))
        first += len(block.nodes)
    for is_cell, block in parts:
        for name, members in () if is_cell else block.groups.items():
            rows = block.nodes[members][:, : block.kind.corners]
            # A mesh of lines has no facets.
            if top > 1 and block.kind.dimension == top - 1:
                facet_groups.setdefault(name, []).append(("nodes", rows))
            else:
                node_groups.setdefault(name, []).append(block.nodes[members].ravel())
    return {
        "points": points,
        "cells": cells,
        "cell_groups": {name: np.unique(np.concatenate(members)) for name, members in cell_groups.items()},
        "facet_groups": {name: [part for part in parts_ if len(part[1])] for name, parts_ in facet_groups.items()},
        "node_groups": {name: np.unique(np.concatenate(members)) for name, members in node_groups.items()},
    }


def _divided(block: Block, links: Sequence[str], top: int) -> list[tuple[bool, Block]]:
    """A block, and whether it is of cells; lines are divided into links and edges."""
    if block.kind.name != "line2" or top == 1:
        return [(block.kind.dimension == top, block)]
    chosen = np.zeros(len(block.nodes), dtype=bool)
    for name in links:
        chosen |= block.groups.get(name, chosen)
    return [(is_link, _rows(block, chosen == is_link)) for is_link in (True, False) if (chosen == is_link).any()]


def _rows(block: Block, chosen: Array) -> Block:
    groups = {name: members[chosen] for name, members in block.groups.items() if members[chosen].any()}
    return Block(block.kind, block.nodes[chosen], groups, {name: bits[chosen] for name, bits in block.facets.items()})


def from_gmsh(read: Callable[[str, Sequence[str]], M], model: str | None, links: Sequence[str]) -> M:
    """Reads a model of Gmsh through a temporary file, so that there is one reader with one set of messages."""
    try:
        import gmsh
    except ImportError:
        raise missing("from_gmsh", "Gmsh", "gmsh") from None
    if not gmsh.isInitialized():
        raise RuntimeError("Gmsh has no model: call gmsh.initialize() and make a mesh first")
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


def from_meshio(mesh: Any, links: Sequence[str]) -> dict[str, Any]:
    """The arguments of a mesh for one of meshio."""
    tags = mesh.cell_data.get("gmsh:physical")
    names = {(int(tag), int(dim)): name for name, (tag, dim) in mesh.field_data.items()} if tags is not None else {}
    blocks = []
    for index, cells in enumerate(mesh.cells):
        kind = OF_MESHIO.get(cells.type)
        if kind is None:
            raise MeshError([Fault("", f"Emmy has no cells like {cells.type!r} of meshio")])
        groups: dict[str, Array] = {}
        for name, members in mesh.cell_sets.items():
            if not name.startswith("gmsh:") and members[index] is not None and len(members[index]):
                groups[name] = np.zeros(len(cells.data), dtype=bool)
                groups[name][np.asarray(members[index], dtype=np.int64)] = True
        if tags is not None:
            for tag in np.unique(tags[index]):
                name = names.get((int(tag), kind.dimension), str(int(tag)))
                if tag:
                    groups[name] = groups.get(name, False) | (tags[index] == tag)
        blocks.append(Block(kind, np.asarray(cells.data, dtype=np.int64), groups, {}))
    nodes = {name: np.asarray(members, dtype=np.int64) for name, members in mesh.point_sets.items()}
    return assemble(_in_space(mesh.points), blocks, nodes, links)


def from_pyvista(grid: Any, links: Sequence[str]) -> dict[str, Any]:
    """The arguments of a mesh for one of PyVista."""
    grid = grid.cast_to_unstructured_grid()
    blocks = []
    connectivity, starts = np.asarray(grid.cell_connectivity), np.asarray(_offsets(grid))
    for vtk in dict.fromkeys(grid.celltypes.tolist()):
        kind = OF_VTK.get(vtk)
        if kind is None:
            raise MeshError([Fault("", f"Emmy has no cells like those of type {vtk} of VTK")])
        chosen = np.asarray(grid.celltypes == vtk)
        length = int(np.diff(starts)[chosen][0])
        nodes = connectivity[starts[:-1][chosen][:, None] + np.arange(length)]
        groups = {name: values[chosen] != 0 for name, values in _named(grid.cell_data, "group:")}
        facets = {name: values[chosen].astype(np.int64) for name, values in _named(grid.cell_data, "facets:")}
        used = {name: members for name, members in groups.items() if members.any()}
        bits = {name: values for name, values in facets.items() if values.any()}
        blocks.append(Block(kind, np.asarray(nodes, dtype=np.int64), used, bits))
    members = {name: np.flatnonzero(values) for name, values in _named(grid.point_data, "group:")}
    return assemble(np.asarray(grid.points, dtype=np.float64), blocks, members, links)


def _offsets(grid: Any) -> Any:
    # PyVista 0.49 has renamed them.
    return grid.cell_offsets if hasattr(grid, "cell_offsets") else grid.offset


def _named(arrays: Any, prefix: str) -> list[tuple[str, Array]]:
    return [(name.removeprefix(prefix), np.asarray(arrays[name])) for name in arrays.keys() if name.startswith(prefix)]


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
