"""The same grid through every door: files, PyVista, meshio and arrays."""

import warnings

import emmy
import numpy as np
import pytest

pyvista = pytest.importorskip("pyvista")
meshio = pytest.importorskip("meshio")

# A brick [0, 1]^3 with a pyramid on it, a wedge beside it and a tetrahedron on the slope of the wedge: the volume is
# 1 + 1/3 + 1/2 + 1/6. The bottom of the brick as a quadrilateral, an edge of it as a line, its corner as a vertex.
POINTS = np.array([
    (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1),
    (0.5, 0.5, 2), (2, 0, 0), (2, 0, 1), (2, 1, 1),
], dtype=float)  # fmt: skip
CELLS = [
    (12, [0, 1, 2, 3, 4, 5, 6, 7]), (14, [4, 5, 6, 7, 8]), (13, [1, 9, 2, 5, 10, 6]), (10, [6, 9, 11, 10]),
    (9, [0, 3, 2, 1]), (3, [0, 1]), (1, [3]),
]  # fmt: skip
NOTE = "arrays that are left out, because they have other values than up to 64 whole numbers: "


def grid():
    cells = np.hstack([[len(nodes), *nodes] for _, nodes in CELLS])
    grid = pyvista.UnstructuredGrid(cells, np.array([kind for kind, _ in CELLS], np.uint8), POINTS)
    grid.cell_data["material"] = np.array([1, 1, 2, 2, 7, 8, 9])
    grid.cell_data["as_real"] = np.array([1, 1, 2, 2, np.nan, np.nan, np.nan])
    grid.cell_data["group:top"] = np.array([0, 1, 0, 0, 0, 0, 0])
    grid.cell_data["facets:left"] = np.array([1, 0, 0, 0, 0, 0, 0])
    grid.cell_data["is_solid"] = np.array([True, True, True, True, False, False, False])
    grid.cell_data["stiffness"] = np.linspace(0.1, 0.2, 7)
    grid.point_data["tags"] = np.array([3] * 4 + [4] * 8)
    grid.point_data["heat"] = np.zeros((12, 3))
    return grid


def groups(mesh):
    """Places of the nodes of each group, and its kinds: files may number nodes in another order."""
    places = {name: sorted(map(tuple, mesh.points[mesh.group_nodes(name)].tolist())) for name in mesh.groups}
    return {name: (kinds, places[name]) for name, kinds in mesh.groups.items()}


def quiet(make):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return make()


def from_arrays():
    cells = {"hex8": [CELLS[0][1]], "pyramid5": [CELLS[1][1]], "wedge6": [CELLS[2][1]], "tet4": [CELLS[3][1]]}
    first, second, all_cells, floor = [0, 1], [2, 3], [0, 1, 2, 3], [[0, 3, 2, 1]]
    return emmy.Mesh(
        POINTS,
        cells,
        cell_groups={
            "material=1": first,
            "material=2": second,
            "as_real=1": first,
            "as_real=2": second,
            "top": [1],
            "is_solid=1": all_cells,
        },
        facet_groups={"material=7": floor, "is_solid=0": floor, "left": [[0, 3, 7, 4]]},
        node_groups={
            "material=8": [0, 1],
            "material=9": [3],
            "is_solid=0": [0, 1, 3],
            "tags=3": [0, 1, 2, 3],
            "tags=4": [4, 5, 6, 7, 8, 9, 10, 11],
        },
    )


DOORS = ["pyvista", "vtu", "vtk", "vtk-ascii", "meshio", "meshio-vtu", "meshio-vtk"]


def through(door):
    given = grid()
    of_meshio = quiet(lambda: pyvista.to_meshio(given))
    match door:
        case "pyvista":
            return emmy.Mesh.from_pyvista(given)
        case "meshio":
            return emmy.Mesh.from_meshio(of_meshio)
        case "vtu" | "vtk" | "vtk-ascii":
            name = f"grid.{door[:3]}"
            given.save(name, binary=door != "vtk-ascii")
        case _:
            name = f"grid.{door[7:]}"
            # meshio cannot write truth values.
            of_meshio.cell_data["is_solid"] = [values.astype(int) for values in of_meshio.cell_data["is_solid"]]
            of_meshio.write(name)
    return emmy.Mesh.read(name)


@pytest.mark.parametrize("door", DOORS)
def test_one_grid_has_the_same_cells_and_groups(door, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mesh, wanted = quiet(lambda: through(door)), from_arrays()
    assert {kind: len(nodes) for kind, nodes in mesh.cells.items()} == dict.fromkeys(
        ["hex8", "pyramid5", "wedge6", "tet4"], 1
    )
    assert mesh.quality["volume"] == pytest.approx(1 + 1 / 3 + 1 / 2 + 1 / 6, rel=1e-14)
    assert groups(mesh) == groups(wanted)
    notes = [note for note in mesh.notes if note.startswith(NOTE)]
    assert [set(note.removeprefix(NOTE).split(", ")) for note in notes] == [{"stiffness", "heat (points)"}]


@pytest.mark.parametrize("door", ["pyvista", "vtu", "meshio"])
def test_regular_grids_have_a_cell_for_each_voxel(door, tmp_path):
    image = pyvista.ImageData(dimensions=(4, 3, 3), spacing=(1.0, 2.0, 0.5)).cast_to_unstructured_grid()
    assert set(image.celltypes.tolist()) == {11}
    if door == "vtu":
        image.save(tmp_path / "image.vtu")
        mesh = emmy.Mesh.read(tmp_path / "image.vtu")
    else:
        mesh = emmy.Mesh.from_pyvista(image) if door == "pyvista" else emmy.Mesh.from_meshio(pyvista.to_meshio(image))
    assert mesh.cells["hex8"].shape == (12, 8)
    assert mesh.quality["volume"] == pytest.approx(12.0, rel=1e-14)


def with_shell_and_spline():
    """A brick, and apart from it a quadrilateral, and a line of three points."""
    points = np.vstack([POINTS[:8], POINTS[:4] + 5, POINTS[:3] + 9])
    cells = [8, *range(8), 4, 8, 9, 10, 11, 3, 12, 13, 14]
    grid = pyvista.UnstructuredGrid(np.array(cells), np.array([12, 9, 4], np.uint8), points)
    grid.cell_data["group:all"] = np.array([1, 1, 1])
    return grid


@pytest.mark.parametrize("door", ["pyvista", "vtu"])
def test_cells_that_are_not_of_the_body_are_counted(door, tmp_path):
    given = with_shell_and_spline()
    given.save(tmp_path / "grid.vtu")
    path = tmp_path / "grid.vtu"
    mesh = quiet(lambda: emmy.Mesh.from_pyvista(given) if door == "pyvista" else emmy.Mesh.read(path))
    assert (mesh.n_cells, mesh.n_nodes, mesh.groups["all"][0]) == (1, 8, "cells")
    left_out = "left out, though it may change the motion: 1 VTK type 4 (polyline), 1 VTK type 9 (quadrilateral)"
    assert left_out in mesh.notes


@pytest.mark.parametrize(
    ("type_of_meshio", "n", "name"),
    [
        ("wedge18", 18, r"VTK type 32 \(biquadratic wedge\)"),
        ("tetra20", 20, r"VTK type 71 \(Lagrange tetrahedron of 20 nodes\)"),
        ("pyramid14", 14, r"VTK type 74 \(Lagrange pyramid of 14 nodes\)"),
        ("polyhedron8", 8, r"VTK type 42 \(polyhedron of 8 nodes\)"),
    ],
)
def test_solid_cells_of_other_kinds_are_named(type_of_meshio, n, name):
    points = np.random.default_rng(1).random((n, 3))
    nodes = [[[0, 1, 2, 3], [4, 5, 6, 7]]] if type_of_meshio == "polyhedron8" else np.arange(n)[None]
    mesh = meshio.Mesh(points, [(type_of_meshio, nodes)])
    with pytest.raises(emmy.MeshError, match=name):
        emmy.Mesh.from_meshio(mesh)


def test_lagrange_cells_of_meshio():
    box = emmy.Mesh.box((2, 1, 1), (2, 1, 1))
    given = meshio.Mesh(box.points, [("VTK_LAGRANGE_HEXAHEDRON", box.cells["hex8"])])
    assert emmy.Mesh.from_meshio(given).cells["hex8"].tolist() == box.cells["hex8"].tolist()


def test_ghost_cells_are_left_out():
    given = pyvista.ImageData(dimensions=(3, 2, 2)).cast_to_unstructured_grid()
    given.cell_data["vtkGhostType"] = np.array([0, 1], np.uint8)
    mesh = quiet(lambda: emmy.Mesh.from_pyvista(given))
    assert (mesh.n_cells, mesh.n_nodes) == (1, 8)
    assert "1 ghost or hidden cell is left out" in mesh.notes


def test_names_lose_the_blanks_that_fill_them():
    box = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    given = meshio.Mesh(
        box.points,
        [("hexahedron", box.cells["hex8"])],
        cell_sets={"body  ": [np.array([0])]},
        point_sets={"tip ": np.array([7])},
    )
    assert emmy.Mesh.from_meshio(given).groups == {"body": ("cells",), "tip": ("nodes",)}
    tagged = meshio.Mesh(
        box.points,
        [("hexahedron", box.cells["hex8"])],
        cell_data={"gmsh:physical": [np.array([5])]},
        field_data={"left part   ": np.array([5, 3])},
    )
    assert emmy.Mesh.from_meshio(tagged).groups == {"left part": ("cells",)}


def test_what_is_no_data_set_of_pyvista_is_told():
    image = pyvista.ImageData(dimensions=(3, 2, 2))
    blocks = pyvista.MultiBlock([image])
    with pytest.raises(TypeError, match=r"^grid: MultiBlock is not .*; take one of its blocks, or join .* combine"):
        emmy.Mesh.from_pyvista(blocks)
    assert emmy.Mesh.from_pyvista(blocks.combine()).n_cells == 2
    raw = pyvista._vtk.vtkUnstructuredGrid()
    with pytest.raises(TypeError, match=r"^grid: vtkUnstructuredGrid is not .*; pyvista.wrap makes one"):
        emmy.Mesh.from_pyvista(raw)


def test_what_is_no_name_of_a_model_is_told():
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.model.add("block")
        with pytest.raises(TypeError, match=r"^model: type is not the name of a model of Gmsh"):
            emmy.Mesh.from_gmsh(gmsh.model)
        with pytest.raises(emmy.InputError, match=r"^model: Gmsh has no model 'blok', only .*'block'"):
            emmy.Mesh.from_gmsh("blok")
    finally:
        gmsh.finalize()
