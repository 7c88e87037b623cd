"""Arrays, and meshes of other packages."""

import emmy
import numpy as np
import pytest

from bodies import rubber

#: Corners, edges and faces of the cells, in the order of VTK.
HEX = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
HEX_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
HEX_FACES = [(0, 3, 7, 4), (1, 2, 6, 5), (0, 1, 5, 4), (3, 2, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7)]
TET = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
TET_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
WEDGE = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
WEDGE_EDGES = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]
PYRAMID = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)]
PYRAMID_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)]
TRI = TET[:3]
QUAD = HEX[:4]

KINDS = {
    "hex8": (HEX, []),
    "hex20": (HEX, HEX_EDGES),
    "hex27": (HEX, [*HEX_EDGES, *HEX_FACES, tuple(range(8))]),
    "tet4": (TET, []),
    "tet10": (TET, TET_EDGES),
    "wedge6": (WEDGE, []),
    "wedge15": (WEDGE, WEDGE_EDGES),
    "pyramid5": (PYRAMID, []),
    "pyramid13": (PYRAMID, PYRAMID_EDGES),
    "tri3": (TRI, []),
    "tri6": (TRI, TET_EDGES[:3]),
    "quad4": (QUAD, []),
    "quad8": (QUAD, HEX_EDGES[:4]),
    "quad9": (QUAD, [*HEX_EDGES[:4], (0, 1, 2, 3)]),
}


def one_cell(kind):
    """A mesh of one cell with groups of every kind; its first facet is in a group."""
    corners, between = KINDS[kind]
    corners = np.array(corners, dtype=float)
    points = np.vstack([corners, *(corners[list(nodes)].mean(axis=0) for nodes in between)])
    is_plane = kind.startswith(("tri", "quad"))
    first = {"tet": [0, 1, 3], "wed": [0, 1, 2]}.get(kind[:3], [0, 1] if is_plane else [0, 1, 2, 3])
    return emmy.Mesh(
        points,
        {kind: [range(len(points))]},
        cell_groups={"all of it": [0]},
        facet_groups={"face": [first]},
        node_groups={"corner": [0]},
    )


def assert_same(one, other):
    assert np.array_equal(one.points, other.points)
    assert list(one.cells) == list(other.cells)
    for kind, nodes in one.cells.items():
        assert np.array_equal(nodes, other.cells[kind])
    assert one.groups == other.groups
    for name in one.groups:
        assert np.array_equal(one.group_nodes(name), other.group_nodes(name))


@pytest.mark.parametrize("kind", KINDS)
def test_round_trips(kind, tmp_path):
    mesh = one_cell(kind)
    assert mesh.groups == {"all of it": ("cells",), "corner": ("nodes",), "face": ("facets",)}
    mesh.write("mesh.vtu")
    assert_same(mesh, emmy.Mesh.read("mesh.vtu"))
    pytest.importorskip("meshio")
    from emmy import _convert
    from meshio._mesh import topological_dimension

    if _convert.OF_NAME[kind].meshio in topological_dimension:
        assert_same(mesh, emmy.Mesh.from_meshio(mesh.to_meshio()))
    else:
        with pytest.raises(emmy.InputError, match=f"meshio .* cannot hold cells of the kind '{kind}'"):
            mesh.to_meshio()
    pytest.importorskip("pyvista")
    assert_same(mesh, emmy.Mesh.from_pyvista(mesh.to_pyvista()))


def test_round_trip_of_built_in_meshes():
    pytest.importorskip("meshio")
    pytest.importorskip("pyvista")
    for mesh in (emmy.Mesh.l_block(1.0), emmy.Mesh.box((1, 2, 3), (2, 3, 4)), emmy.Mesh.rectangle((1, 2), (3, 4))):
        assert_same(mesh, emmy.Mesh.from_meshio(mesh.to_meshio()))
        assert_same(mesh, emmy.Mesh.from_pyvista(mesh.to_pyvista()))


def network_with_a_vertex(package):
    """A network of two lines with a vertex cell in a group, in another package."""
    points = np.array([(0.0, 0, 0), (1, 0, 0), (2, 0, 0)])
    lines = np.array([(0, 1), (1, 2)])
    if package == "meshio":
        meshio = pytest.importorskip("meshio")
        sets = {"wire": [[0, 1], []], "end": [[], [0]]}
        return meshio.Mesh(points, [("line", lines), ("vertex", np.array([[2]]))], cell_sets=sets)
    pyvista = pytest.importorskip("pyvista")
    cells = np.array([2, 0, 1, 2, 1, 2, 1, 2])
    grid = pyvista.UnstructuredGrid(cells, np.array([3, 3, 1], dtype=np.uint8), points)
    grid.cell_data["group:wire"] = np.array([1, 1, 0], dtype=np.uint8)
    grid.cell_data["group:end"] = np.array([0, 0, 1], dtype=np.uint8)
    return grid


@pytest.mark.parametrize("package", ["meshio", "pyvista"])
def test_vertices_of_a_network_are_nodes(package):
    given = network_with_a_vertex(package)
    mesh = emmy.Mesh.from_meshio(given) if package == "meshio" else emmy.Mesh.from_pyvista(given)
    assert mesh.cells["line2"].tolist() == [[0, 1], [1, 2]]
    # A mesh of lines from arrays has the group "links" as well.
    assert mesh.groups == {"end": ("nodes",), "links": ("cells",), "wire": ("cells",)}
    assert mesh.group_nodes("end").tolist() == [2]


def test_vertices_of_a_network_are_nodes_in_a_file():
    gmsh = pytest.importorskip("gmsh")
    meshio = pytest.importorskip("meshio")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        ends = [gmsh.model.geo.addPoint(x, 0, 0, 1.0) for x in (0.0, 2.0)]
        gmsh.model.addPhysicalGroup(1, [gmsh.model.geo.addLine(*ends)], name="wire")
        gmsh.model.addPhysicalGroup(0, ends[1:], name="end")
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.generate(1)
        gmsh.write("wire.msh")
    finally:
        gmsh.finalize()
    read, given = emmy.Mesh.read("wire.msh", links=["wire"]), emmy.Mesh.from_meshio(meshio.read("wire.msh"))
    assert read.groups == {"end": ("nodes",), "wire": ("cells",)}
    assert given.groups == {**read.groups, "links": ("cells",)}
    for name in read.groups:
        assert np.array_equal(given.points[given.group_nodes(name)], read.points[read.group_nodes(name)])


def test_gmsh():
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.occ.addBox(0, 0, 0, 2, 1, 1)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [1], name="body")
        gmsh.model.addPhysicalGroup(2, [1], name="x-min")
        gmsh.model.mesh.generate(3)
        before = gmsh.option.getNumber("Mesh.Binary")
        mesh = emmy.Mesh.from_gmsh()
        assert gmsh.option.getNumber("Mesh.Binary") == before
        assert mesh.groups == {"body": ("cells",), "x-min": ("facets",)}
        assert np.all(mesh.points[mesh.group_nodes("x-min"), 0] == 0.0)
        meshio = pytest.importorskip("meshio")
        gmsh.write("box.msh")
        assert emmy.Mesh.from_meshio(meshio.read("box.msh")).groups == mesh.groups
    finally:
        gmsh.finalize()


def test_gmsh_without_a_model():
    gmsh = pytest.importorskip("gmsh")
    assert not gmsh.isInitialized()
    with pytest.raises(RuntimeError, match="gmsh.initialize"):
        emmy.Mesh.from_gmsh()


@pytest.mark.parametrize(
    "points",
    [
        np.array(TET, dtype=np.float32),
        np.asfortranarray(np.array(TET, dtype=float)),
        np.repeat(np.array(TET, dtype=float), 2, axis=0)[::2],
        [list(point) for point in TET],
        np.array(TET, dtype=np.int32),
    ],
    ids=["float32", "Fortran", "strided", "lists", "int32"],
)
@pytest.mark.parametrize("kind", [np.int32, np.uint8, np.int64, np.uint64])
def test_arrays_that_are_taken(points, kind):
    mesh = emmy.Mesh(points, {"tet4": np.array([[0, 1, 2, 3]], dtype=kind)})
    assert np.array_equal(mesh.points, np.array(TET, dtype=float))
    assert mesh.points.dtype == np.float64 and mesh.points.flags.c_contiguous
    assert mesh.cells["tet4"].dtype == np.int64


def test_masks_are_groups():
    box = emmy.Mesh.box((2, 1, 1), (2, 1, 1))
    x = box.points[:, 0]
    cells = np.array([False, True])
    mesh = emmy.Mesh(box.points, box.cells, node_groups={"right": x == 2.0}, cell_groups={"far": cells, "near": ~cells})
    assert mesh.group_nodes("right").tolist() == np.flatnonzero(x == 2.0).tolist() and (x == 2.0).sum() == 4
    assert np.array_equal(mesh.group_nodes("far"), np.flatnonzero(x >= 1.0))
    body = emmy.Body(mesh, [emmy.Region(rubber(), density=d, group=g) for g, d in (("near", 1.0), ("far", 5.0))])
    assert body.total_mass == pytest.approx(6.0, rel=1e-13)
    network = emmy.Mesh.network(
        [(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1), (1, 2)], {"end": [False, False, True]}, {"last": [False, True]}
    )
    assert network.group_nodes("end").tolist() == [2] and network.group_nodes("last").tolist() == [1, 2]
    for groups, place, n in [("node_groups", "right", 12), ("cell_groups", "right", 2)]:
        expected = rf"^{groups}.{place}: expected a mask of shape \({n},\), found \(3,\)$"
        with pytest.raises(emmy.InputError, match=expected):
            emmy.Mesh(box.points, box.cells, **{groups: {place: [True, False, True]}})
    with pytest.raises(emmy.InputError, match=r"^node_groups.right: are 0 and 1 over and over.*astype\(bool\)$"):
        emmy.Mesh(box.points, box.cells, node_groups={"right": (box.points[:, 0] > 1.5).astype(int)})
    spring = emmy.Body(
        emmy.Mesh.network([(0, 0, 0), (1, 0, 0)], [(0, 1)], {"foot": [0], "head": [1]}),
        emmy.Region(emmy.Spring(stiffness=18.0)),
        masses=emmy.Mass("head", mass=0.5),
        supports=[emmy.Support("foot", fix="xyz"), emmy.Support("head", fix="yz")],
    )
    found = emmy.response(spring, [1.0], base="x", damping=0.05, count=1, nodes=np.array([False, True]))
    assert found.nodes.tolist() == [1] and found.amplitudes.shape == (1, 1, 3)
    with pytest.raises(emmy.InputError, match=r"^nodes: expected a mask of shape \(2,\), found \(3,\)$"):
        emmy.response(spring, [1.0], base="x", count=1, nodes=[True, False, True])


def test_volumes_of_round_meshes_converge():
    shapes = {
        "cylinder": (lambda n: emmy.Mesh.cylinder(2.0, 3.0, (n, 1)), np.pi * 4.0 * 3.0),
        "ring": (lambda n: emmy.Mesh.ring(1.0, 2.0, 3.0, (1, 4 * n, 1)), np.pi * (4.0 - 1.0) * 3.0),
        "ball": (lambda n: emmy.Mesh.ball(2.0, n), 4 / 3 * np.pi * 8.0),
    }
    for name, (make, volume) in shapes.items():
        errors = np.array([1 - make(n).quality["volume"] / volume for n in (4, 8, 16)])
        assert np.all(errors > 0.0), name
        assert np.log2(errors[:-1] / errors[1:]) == pytest.approx(2.0, abs=0.05), name
    assert list(emmy.Mesh.cylinder(2.0, 3.0, (2, 1)).groups) == ["body", "side", "z-max", "z-min"]
    assert list(emmy.Mesh.ring(1.0, 2.0, 3.0, (1, 8, 1)).groups) == ["body", "inner", "outer", "z-max", "z-min"]
    assert list(emmy.Mesh.ball(2.0, 2).groups) == ["body", "surface"]


def test_a_read_only_array_is_taken():
    points = np.array(TET, dtype=float)
    points.flags.writeable = False
    assert emmy.Mesh(points, {"tet4": [[0, 1, 2, 3]]}).n_nodes == 4


def test_arrays_of_a_motion_are_copies(spinning):
    kept = spinning.displacement
    before = kept.copy()
    spinning.step(0.05)
    assert np.array_equal(kept, before)
    changed = spinning.displacement
    changed[:] = 1e6
    assert np.abs(spinning.displacement).max() < 10
    assert changed.flags.c_contiguous and changed.flags.writeable


def test_history(spinning):
    history = spinning.run()
    assert history.shape == (21,)
    assert history["step"].dtype == np.int64 and history["newton_iterations"].dtype == np.int64
    assert history["step"].tolist() == list(range(21))
    assert history["time"] == pytest.approx(np.arange(21) * 0.05)
    assert set(spinning.columns) == set(history.dtype.names)
    pandas = pytest.importorskip("pandas")
    assert len(pandas.DataFrame(history)) == 21
    frame = history.to_pandas()
    assert frame.columns.tolist() == list(history.dtype.names) and frame["step"].dtype == np.int64
    assert np.array_equal(frame["time"], history["time"]) and len(history[:3].to_pandas()) == 3


def test_velocities_as_an_array():
    from bodies import free_block

    body = free_block()
    velocity = np.cross([0.0, 0.0, 2.0], body.mesh.points)
    one = emmy.Motion(body, steps=(0.5, 0.1), initial=velocity)
    for same in (velocity.ravel(), velocity.tolist(), velocity.ravel().tolist(), list(velocity)):
        assert np.array_equal(emmy.Motion(body, initial=same).velocity, one.velocity)
    for wrong in (velocity[:-1], [1.0, 2.0], velocity.T):
        with pytest.raises(emmy.InputError, match="^initial: expected an array of shape"):
            emmy.Motion(body, initial=wrong)
    other = emmy.Motion(body, steps=(0.5, 0.1), initial=emmy.Initial(angular_velocity=(0, 0, 2)))
    assert one.momentum == pytest.approx(other.momentum, abs=1e-14)
    one.run(), other.run()
    assert one.displacement == pytest.approx(other.displacement, abs=1e-12)


def test_matrices(beam):
    pytest.importorskip("scipy")
    mass, stiffness = beam.mass(), beam.stiffness()
    assert mass.shape == stiffness.shape == (beam.n_dofs, beam.n_dofs)
    # A rigid translation has the mass and no force.
    along = np.tile([0.0, 1.0, 0.0], beam.n_dofs // 3)
    assert along @ (mass @ along) == pytest.approx(4.0, rel=1e-13)
    assert np.abs(stiffness @ along).max() < 1e-9
    # Derivative of the internal force.
    rng = np.random.default_rng(1)
    shift = 1e-6 * rng.standard_normal((beam.n_dofs // 3, 3))
    difference = (beam.internal_force(shift) - beam.internal_force(-shift)).ravel() / 2
    assert difference == pytest.approx(stiffness @ shift.ravel(), abs=1e-9)
