"""Files of VTK and grids of PyVista."""

import itertools

import emmy
import numpy as np
import pyvista
import vtk
from bodies import CORNER_PLACES, KINDS, Body, bricks, places
from vtk.util.numpy_support import numpy_to_vtk
from wanted import cell_group, groups_of, node_group, of_body

TYPES = {
    "vertex": 1, "line2": 3, "line3": 21, "tri3": 5, "tri6": 22, "quad4": 9, "quad8": 23, "quad9": 28, "tet4": 10,
    "tet10": 24, "hex8": 12, "hex20": 25, "hex27": 29, "wedge6": 13, "wedge15": 26, "pyramid5": 14, "pyramid13": 27,
}  # fmt: skip
# VTK has a number for Lagrange pyramids, but no class.
LAGRANGE = {
    "line2": (68, vtk.vtkLagrangeCurve), "line3": (68, vtk.vtkLagrangeCurve), "tri3": (69, vtk.vtkLagrangeTriangle),
    "tri6": (69, vtk.vtkLagrangeTriangle), "quad4": (70, vtk.vtkLagrangeQuadrilateral), "quad9": (70, vtk.vtkLagrangeQuadrilateral),
    "tet4": (71, vtk.vtkLagrangeTetra), "tet10": (71, vtk.vtkLagrangeTetra), "hex8": (72, vtk.vtkLagrangeHexahedron),
    "hex27": (72, vtk.vtkLagrangeHexahedron), "wedge6": (73, vtk.vtkLagrangeWedge),
}  # fmt: skip
SINGLE = {"tri3": 7, "quad4": 7, "line2": 4}  # polygons and polylines of so many nodes
SINGLE_PRECISION = 1e-6
PARTS = {"left": 1, "right part": 2, "base": 3, "rim": 4, "tip": 5}


def lagrange_order(kind):
    """For each node of a Lagrange cell its number in the other order, by the places that VTK gives."""
    shape, n_nodes, _ = KINDS[kind]
    cell = LAGRANGE[kind][1]()
    cell.GetPointIds().SetNumberOfIds(n_nodes)
    cell.GetPoints().SetNumberOfPoints(n_nodes)
    for i in range(n_nodes):
        cell.GetPointIds().SetId(i, i)
    if hasattr(cell, "SetUniformOrderFromNumPoints"):
        cell.SetUniformOrderFromNumPoints(n_nodes)
    else:
        cell.Initialize()
    flat = cell.GetParametricCoords()
    local = np.reshape([flat[i] for i in range(3 * n_nodes)], (n_nodes, 3))
    own = places(kind, CORNER_PLACES[shape])
    numbers = [int(np.argmin(np.abs(own - place).sum(axis=1))) for place in local]
    assert sorted(numbers) == list(range(n_nodes)) and np.allclose(own[numbers], local), kind
    return numbers


def grid_of(body, types=None, dtype=np.int32, single=False):
    """The grid with arrays of groups, and the groups. `types`: other types and orders of cells."""
    types = types or {}
    left = set(body.cell_groups["left"])
    rows = [("left" if number in left else "right part", kind, nodes) for number, (kind, nodes) in enumerate(body.cells)]
    for groups in (body.facet_groups, body.line_groups):
        rows += [(name, kind, nodes) for name, own in groups.items() for kind, nodes in own]
    rows += [(name, "vertex", (node,)) for name, own in body.node_groups.items() for node in own]
    grid = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(body.points.astype(np.float32 if single else np.float64), deep=True))
    grid.SetPoints(points)
    for _, kind, nodes in rows:
        number, order = types.get(kind, (TYPES[kind], range(len(nodes))))
        grid.InsertNextCell(number, len(nodes), [int(nodes[i]) for i in order])
    groups = groups_of(body)
    some = groups.pop("some")
    of_parts = {f"part={PARTS[name]}": group for name, group in groups.items()}
    names = np.array([name for name, _, _ in rows])
    add(grid.GetCellData(), "part", np.array([PARTS[name] for name in names]).astype(dtype))
    for name in groups:
        add(grid.GetCellData(), f"group:{name}", (names == name).astype(dtype))
    inside = np.zeros(len(rows), dtype)
    inside[sorted(some["cells"])] = 1
    add(grid.GetCellData(), "group:some", inside)
    tip = np.zeros(len(body.points), dtype)
    tip[body.node_groups["tip"]] = 7
    add(grid.GetPointData(), "place", tip)
    others = node_group(set(range(len(body.points))) - set(body.node_groups["tip"]) - spare(body))
    more = {"some": some, "place=7": node_group(body.node_groups["tip"]), "place=0": others}
    if body.dimension == 1:
        more["links"] = cell_group(range(len(body.cells)))
    return grid, groups | of_parts | more


def spare(body):
    """Nodes of no cell."""
    return set(range(len(body.points))) - {node for _, nodes in body.cells for node in nodes}


def add(data, name, values):
    array = numpy_to_vtk(values, deep=True)
    array.SetName(name)
    data.AddArray(array)
    return array


def add_fields(grid):
    """Fields that are no groups, in every role that VTK has."""
    n = grid.GetNumberOfPoints()
    values = np.linspace(0.1, 0.7, 9 * n)
    data = grid.GetPointData()
    data.SetScalars(add(data, "heat", values[:n]))
    data.SetVectors(add(data, "speed", values[: 3 * n].reshape(n, 3)))
    data.SetTensors(add(data, "stress", values.reshape(n, 9)))
    data.SetNormals(add(data, "normals", np.tile([0.0, 0.0, 1.0], (n, 1))))
    data.SetTCoords(add(data, "texture", values[: 2 * n].reshape(n, 2)))
    cells = grid.GetCellData()
    cells.SetScalars(cells.GetArray("part"))
    text = vtk.vtkStringArray()
    text.SetName("remark")
    text.InsertNextValue("two words")
    grid.GetFieldData().AddArray(text)


XML = {
    "ascii": {"mode": "Ascii"}, "base64": {"mode": "Binary", "compressor": "None"}, "base64-zlib": {"mode": "Binary"},
    "appended-base64": {"encode": True, "compressor": "None"}, "appended-base64-zlib": {"encode": True},
    "raw": {"compressor": "None"}, "raw-zlib": {}, "raw-zlib-blocks": {"block": 128}, "raw-64": {"compressor": "None", "header": 64},
    "raw-zlib-64": {"header": 64}, "base64-zlib-64": {"mode": "Binary", "header": 64}, "ids-32": {"ids": 32},
    "big-endian": {"big": True}, "big-endian-raw": {"big": True, "compressor": "None"}, "base64-big-endian": {"mode": "Binary", "big": True},
    "raw-lz4": {"compressor": "LZ4"}, "raw-lzma": {"compressor": "LZMA"}, "base64-lz4": {"mode": "Binary", "compressor": "LZ4"},
    "pieces": {"pieces": 3}, "pieces-ascii": {"pieces": 2, "mode": "Ascii"},
}  # fmt: skip


def configure(writer, mode="Appended", encode=False, compressor="ZLib", header=32, big=False, ids=64, block=0, pieces=1):
    getattr(writer, f"SetDataModeTo{mode}")()
    writer.SetEncodeAppendedData(encode)
    getattr(writer, f"SetCompressorTypeTo{compressor}")()
    getattr(writer, f"SetHeaderTypeToUInt{header}")()
    (writer.SetByteOrderToBigEndian if big else writer.SetByteOrderToLittleEndian)()
    getattr(writer, f"SetIdTypeToInt{ids}")()
    if block:
        writer.SetBlockSize(block)


def extracted(grid):
    """A source of the pieces of a grid, with points in single precision."""
    pieces = vtk.vtkExtractUnstructuredGridPiece()
    pieces.SetInputData(grid)
    return pieces


def write_xml(grid, path, **options):
    writer, source = vtk.vtkXMLUnstructuredGridWriter(), extracted(grid)
    configure(writer, **options)
    if options.get("pieces", 1) > 1:
        writer.SetInputConnection(source.GetOutputPort())
        writer.SetNumberOfPieces(options["pieces"])
    else:
        writer.SetInputData(grid)
    writer.SetFileName(str(path))
    assert writer.Write() == 1


def to_vtu(corpus):
    for name, options in XML.items():
        way = f"vtk/vtu-{name}"
        for body in corpus.bodies(way):
            grid, groups = grid_of(body)
            add_fields(grid)
            path = corpus.path(way, f"{body.name}.vtu")
            write_xml(grid, path, **options)
            compressor = options.get("compressor", "ZLib")
            if compressor.startswith("LZ"):
                corpus.refused(way, path, f"compressed by vtk{compressor}DataCompressor; save it compressed by ZLib")
            else:
                tolerance = SINGLE_PRECISION if "pieces" in options else 1e-10 if name == "ascii" else 1e-12
                corpus.file(way, path, of_body(body, groups, tolerance))


def to_pvtu(corpus):
    for ghosts, ids, mode in itertools.product([0, 1], [False, True], ["Ascii", "Appended"]):
        way = f"vtk/pvtu-{'ghosts' if ghosts else 'plain'}{'-ids' if ids else ''}-{mode.lower()}"
        for body in corpus.bodies(way):
            grid, groups = grid_of(body)
            if ids:
                grid.GetPointData().SetGlobalIds(
                    add(grid.GetPointData(), "GlobalNodeIds", np.arange(grid.GetNumberOfPoints(), dtype=np.int64) + 5)
                )
            # The writer does not keep its source.
            writer, source = vtk.vtkXMLPUnstructuredGridWriter(), extracted(grid)
            writer.SetInputConnection(source.GetOutputPort())
            configure(writer, mode=mode)
            writer.SetNumberOfPieces(3)
            writer.SetStartPiece(0)
            writer.SetEndPiece(2)
            writer.SetGhostLevel(ghosts)
            path = corpus.path(way, f"{body.name}.pvtu")
            writer.SetFileName(str(path))
            assert writer.Write() == 1
            corpus.file(way, path, of_body(body, groups, SINGLE_PRECISION))


# Versions as the header of a file has them, and the version that VTK writes them as.
LEGACY = {"2.0": 42, "3.0": 42, "4.0": 42, "4.1": 42, "4.2": 42, "5.0": 51, "5.1": 51}


def to_legacy(corpus):
    for (version, own), binary in itertools.product(LEGACY.items(), [False, True]):
        way = f"vtk/legacy-{version}-{'binary' if binary else 'ascii'}"
        # Headers alone differ.
        for body in corpus.bodies(way, few=version not in ("4.2", "5.1")):
            grid, groups = grid_of(body)
            add_fields(grid)
            writer = vtk.vtkUnstructuredGridWriter()
            save_legacy(writer, grid, corpus.path(way, f"{body.name}.vtk"), own, binary)
            path = corpus.path(way, f"{body.name}.vtk")
            # These versions have the same form.
            text = path.read_bytes()
            path.write_bytes(b"# vtk DataFile Version " + version.encode() + text[text.index(b"\n") :])
            # As text VTK writes 11 digits.
            corpus.file(way, path, of_body(body, groups, 1e-12 if binary else 1e-10))


def save_legacy(writer, grid, path, version, binary):
    writer.SetInputData(grid)
    writer.SetFileName(str(path))
    writer.SetFileVersion(version)
    (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
    assert writer.Write() == 1


def to_types(corpus):
    """Types of the values of arrays, single precision, other types of cells."""
    for dtype in [np.int8, np.uint8, np.int16, np.uint16, np.uint32, np.int64, np.uint64, np.float32, np.float64]:
        for suffix in ("vtu", "vtk", "memory"):
            save(corpus, f"vtk/{dtype.__name__}-{suffix}", suffix, lambda body, dtype=dtype: grid_of(body, dtype=dtype), few=True)
    orders = {kind: (number, lagrange_order(kind)) for kind, (number, _) in LAGRANGE.items()}
    single = {kind: (number, range(KINDS[kind][1])) for kind, number in SINGLE.items()}
    for suffix in ("vtu", "vtk", "memory"):
        save(corpus, f"vtk/single-precision-{suffix}", suffix, lambda body: grid_of(body, single=True), tolerance=SINGLE_PRECISION)
        save(corpus, f"vtk/lagrange-{suffix}", suffix, lambda body: grid_of(body, orders), lambda body: body.kinds & orders.keys())
        save(corpus, f"vtk/polygons-{suffix}", suffix, lambda body: grid_of(body, single), lambda body: body.kinds & single.keys())


def save(corpus, way, suffix, make, has=lambda body: True, tolerance=1e-12, few=False):
    for body in corpus.bodies(way, few):
        if not has(body):
            continue
        grid, groups = make(body)
        wanted = of_body(body, groups, tolerance)
        if suffix == "memory":
            corpus.check(way, body.name, wanted, lambda grid=grid: emmy.Mesh.from_pyvista(pyvista.wrap(grid)))
            continue
        path = corpus.path(way, f"{body.name}.{suffix}")
        write_xml(grid, path) if suffix == "vtu" else save_legacy(vtk.vtkUnstructuredGridWriter(), grid, path, 51, True)
        corpus.file(way, path, wanted)


def straight():
    """A body of bricks along the axes, with the numbers of a regular grid."""
    axes = [np.array([0.0, 0.5, 1.0, 1.5]), np.array([0.0, 0.4, 0.8]), np.array([0.0, 0.3, 0.6])]
    places = np.array([(x, y, z) for z in axes[2] for y in axes[1] for x in axes[0]])
    index = {(x, y, z): x + 4 * (y + 3 * z) for z in range(3) for y in range(3) for x in range(4)}
    cells = np.array([[index[place] for place in corners] for corners in bricks((3, 2, 2))])
    return axes, Body("regular", places, [("hex8", cells)], {"left": [], "some": []}, {}, {}, {})


def to_regular(corpus):
    """Regular grids, whose cells VTK numbers, and voxels."""
    axes, body = straight()
    part = (np.arange(12) % 3).astype(np.int32)
    groups = {f"part={value}": cell_group(np.flatnonzero(part == value).tolist()) for value in range(3)}
    image = vtk.vtkStructuredPoints()
    image.SetDimensions(4, 3, 3)
    image.SetSpacing(0.5, 0.4, 0.3)
    rectilinear = vtk.vtkRectilinearGrid()
    rectilinear.SetDimensions(4, 3, 3)
    for axis, values in zip("XYZ", axes, strict=True):
        getattr(rectilinear, f"Set{axis}Coordinates")(numpy_to_vtk(values, deep=True))
    structured = vtk.vtkStructuredGrid()
    structured.SetDimensions(4, 3, 3)
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(body.points, deep=True))
    structured.SetPoints(points)
    kinds = [
        ("points", image, vtk.vtkStructuredPointsWriter),
        ("rectilinear", rectilinear, vtk.vtkRectilinearGridWriter),
        ("grid", structured, vtk.vtkStructuredGridWriter),
    ]
    for (name, grid, writer), version, binary in itertools.product(kinds, (42, 51), (False, True)):
        way = f"vtk/regular-{name}"
        if not corpus.bodies(way):
            continue
        add(grid.GetCellData(), "part", part)
        path = corpus.path(way, f"{version}-{binary}.vtk")
        save_legacy(writer(), grid, path, version, binary)
        corpus.file(way, path, of_body(body, groups, SINGLE_PRECISION))
        corpus.check(way, "memory", of_body(body, groups, SINGLE_PRECISION), lambda grid=grid: emmy.Mesh.from_pyvista(pyvista.wrap(grid)))
        voxels = pyvista.wrap(grid).cast_to_unstructured_grid()
        for suffix in ("vtu", "vtk"):
            path = corpus.path(way, f"cast.{suffix}")
            voxels.save(path)
            corpus.file(way, path, of_body(body, groups, SINGLE_PRECISION))


def of_emmy(corpus):
    """Meshes of Emmy, written and given away by it, and read again."""
    for way in ("emmy/vtu", "emmy/pyvista", "emmy/meshio"):
        for body in corpus.bodies(way):
            grid, groups = grid_of(body)
            mesh = emmy.Mesh.from_pyvista(pyvista.wrap(grid))
            wanted = of_body(body, groups)
            if way == "emmy/vtu":
                path = corpus.path(way, f"{body.name}.vtu")
                path.unlink(missing_ok=True)
                mesh.write(path)
                corpus.file(way, path, wanted)
            elif way == "emmy/pyvista":
                corpus.check(way, body.name, wanted, lambda mesh=mesh: emmy.Mesh.from_pyvista(mesh.to_pyvista()))
            elif body.kinds & {"wedge15", "pyramid13"}:
                corpus.cannot(way, body.name, "meshio has no wedges of 15 and pyramids of 13 nodes")
            else:
                corpus.check(way, body.name, wanted, lambda mesh=mesh: emmy.Mesh.from_meshio(mesh.to_meshio()))


def write_all(corpus):
    for write in (to_vtu, to_pvtu, to_legacy, to_types, to_regular, of_emmy):
        write(corpus)
