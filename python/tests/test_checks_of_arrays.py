"""A mesh of arrays has the checks and the notes of a file."""

import warnings

import emmy
import numpy as np
import pytest

TET = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
# The corners of a unit cube.
CUBE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], dtype=float)
HEX = [list(range(8))]
FLOOR, LID, DIAGONAL = [0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 6, 7]


def made(*arrays, **groups):
    """The mesh; its notes are the warnings."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mesh = emmy.Mesh(*arrays, **groups)
    assert [str(own.message) for own in caught] == mesh.notes
    return mesh


def test_a_cell_that_occurs_twice():
    with pytest.raises(
        emmy.MeshError, match=r"^mesh: the arrays: cell 1 has the nodes of cell 0; remove one of the two"
    ):
        emmy.Mesh(TET, {"tet4": [[0, 1, 2, 3], [1, 2, 0, 3]]})


def test_points_that_no_cell_uses():
    far = np.full((1, 3), 9.0)
    mesh = made(np.vstack([far, TET]), {"tet4": [[1, 2, 3, 4]]}, node_groups={"tip": [4], "far": [0]})
    assert mesh.points.tolist() == TET.tolist() and mesh.group_nodes("tip").tolist() == [3]
    assert mesh.notes == [
        "1 node belongs to no cell and is left out",
        'node group "far" has no node of a cell',
        "node 1 is now node 0: without the nodes that are left out the later ones have other numbers; groups follow",
    ]
    # Behind all others it changes no number.
    assert made(np.vstack([TET, far]), {"tet4": [[0, 1, 2, 3]]}).notes == ["1 node belongs to no cell and is left out"]
    with pytest.warns(emmy.EmmyWarning, match="1 node belongs to no cell"):
        emmy.Mesh.network(TET[:3], [[0, 1]])


def test_coincident_nodes_and_collapsed_cells():
    points = np.vstack([TET, TET + np.array([1, 0, 0])])
    mesh = made(points, {"tet4": [[0, 1, 2, 3], [4, 5, 6, 7]]})
    assert [note[:36] for note in mesh.notes] == ["1 node lies where another one does, "]
    collapsed = CUBE.copy()
    collapsed[5] = collapsed[4]
    notes = made(collapsed, {"hex8": HEX}).notes
    assert any(note.startswith("1 cell has two corners at one place") and "cell 0 (hex8)" in note for note in notes)


def test_surfaces_beside_solid_cells_are_faces():
    cells = {"quad4": [FLOOR, LID], "hex8": HEX}
    mesh = made(CUBE, cells, cell_groups={"floor": [0], "all": [0, 1, 2]})
    assert mesh.groups == {"all": ("cells", "facets"), "floor": ("facets",)} and mesh.n_cells == 1
    assert mesh.group_nodes("floor").tolist() == [0, 1, 2, 3] and mesh.notes == []
    assert made(CUBE, cells).notes == ["2 cells that are not solid are in no group and ignored"]
    shell = made(CUBE, {"hex8": HEX, "quad4": [DIAGONAL]}, cell_groups={"cover": [1]})
    assert shell.group_nodes("cover").tolist() == [0, 1, 6, 7]
    assert [note[:48] for note in shell.notes] == ["1 facet is no face of a cell, such as a shell, a"]


def test_a_facet_that_is_no_face_is_an_error():
    with pytest.raises(
        emmy.MeshError, match=r'^mesh: group "cover": the facet with nodes \[0, 1, 6, 7\] is not a face'
    ):
        emmy.Mesh(CUBE, {"hex8": HEX}, facet_groups={"cover": [DIAGONAL]})
    with pytest.raises(emmy.MeshError, match=r"^facet_groups.floor: a row must be the number of a cell"):
        emmy.Mesh(CUBE, {"hex8": HEX, "quad4": [FLOOR]}, facet_groups={"floor": [[1, 0]]})
