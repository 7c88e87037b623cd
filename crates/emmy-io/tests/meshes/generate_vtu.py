"""Writes the small VTU meshes of the tests. Needs VTK and meshio: `pip install vtk meshio`; run it in this directory.

One mesh in every way of writing: a brick [0, 1]^3 with a pyramid on it (apex at z = 2), a wedge beside it (x from 1 to 2),
a tetrahedron on the slope of the wedge, and the bottom of the brick as a quadrilateral. Cell data: "region" (0: brick and
pyramid, 1: wedge and tetrahedron, 5: quadrilateral), "group:top" (pyramid), "group:bottom" (quadrilateral),
"facets:left" (face 0 of the brick, x = 0), "quality" (not whole). Point data: "group:apex" (that of the pyramid).
mirrored.vtu has the wedge with its base the other way round, quadratic.vtu one of each quadratic cell from VTK's own
parametric coordinates, lagrange.vtu the same of Lagrange cells of the orders 1 and 2 (and lagrange-old.vtk in the order
of files before version 5). two-pieces.vtu has the mesh in two pieces with a ghost cell, parallel.pvtu in two files
without. Legacy files: the one mesh, and regular grids of 3 x 2 x 2 cells of [0, 3] x [0, 2] x [0, 2].
"""

import os

import meshio
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

POINTS = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1],
          [0.5, 0.5, 2], [2, 0, 0], [2, 0, 1], [2, 1, 1]]
CELLS = [(vtk.VTK_HEXAHEDRON, [0, 1, 2, 3, 4, 5, 6, 7]), (vtk.VTK_PYRAMID, [4, 5, 6, 7, 8]),
         (vtk.VTK_WEDGE, [1, 9, 2, 5, 10, 6]), (vtk.VTK_TETRA, [6, 9, 11, 10]), (vtk.VTK_QUAD, [0, 3, 2, 1])]
CELL_DATA = {"region": np.array([0, 0, 1, 1, 5], np.int64), "group:top": np.array([0, 1, 0, 0, 0], np.uint8),
             "group:bottom": np.array([0, 0, 0, 0, 1], np.int32), "facets:left": np.array([1, 0, 0, 0, 0], np.uint8),
             "quality": np.array([1, 0.8, 0.7, 0.6, 0], np.float64)}
POINT_DATA = {"group:apex": np.array([0] * 8 + [1] + [0] * 3, np.int8)}


def grid(points, cells, cell_data, point_data):
    """An unstructured grid of VTK."""
    grid, array = vtk.vtkUnstructuredGrid(), vtk.vtkPoints()
    array.SetDataTypeToDouble()
    for point in points:
        array.InsertNextPoint(point)
    grid.SetPoints(array)
    for kind, nodes in cells:
        grid.InsertNextCell(kind, len(nodes), nodes)
    for data, arrays in [(grid.GetCellData(), cell_data), (grid.GetPointData(), point_data)]:
        for name, values in arrays.items():
            values = numpy_to_vtk(values, deep=True)
            values.SetName(name)
            data.AddArray(values)
    return grid


def write(name, data, mode="Ascii", compressed=False, encoded=False, header=32, big_endian=False):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(data)
    getattr(writer, f"SetDataModeTo{mode}")()
    writer.SetCompressorTypeToZLib() if compressed else writer.SetCompressorTypeToNone()
    writer.SetBlockSize(64)
    writer.SetEncodeAppendedData(encoded)
    writer.SetHeaderTypeToUInt64() if header == 64 else writer.SetHeaderTypeToUInt32()
    writer.SetByteOrderToBigEndian() if big_endian else writer.SetByteOrderToLittleEndian()
    writer.SetFileName(name + ".vtu")
    writer.Write()


def meshio_files():
    names = {vtk.VTK_HEXAHEDRON: "hexahedron", vtk.VTK_PYRAMID: "pyramid", vtk.VTK_WEDGE: "wedge",
             vtk.VTK_TETRA: "tetra", vtk.VTK_QUAD: "quad"}
    cells = [(names[kind], [nodes]) for kind, nodes in CELLS]
    cell_data = {name: [values[i:i + 1] for i in range(len(cells))] for name, values in CELL_DATA.items()}
    mesh = meshio.Mesh(np.array(POINTS, float), cells, cell_data=cell_data, point_data=POINT_DATA)
    mesh.write("meshio-ascii.vtu", binary=False)
    mesh.write("meshio-zlib.vtu")
    mesh.write("meshio-plain.vtu", compression=None)


def quadratic():
    """Each kind in VTK's parametric coordinates, side by side."""
    points, cells = [], []
    for kind, cell in [(vtk.VTK_QUADRATIC_HEXAHEDRON, vtk.vtkQuadraticHexahedron()),
                       (vtk.VTK_TRIQUADRATIC_HEXAHEDRON, vtk.vtkTriQuadraticHexahedron()),
                       (vtk.VTK_QUADRATIC_TETRA, vtk.vtkQuadraticTetra()),
                       (vtk.VTK_QUADRATIC_WEDGE, vtk.vtkQuadraticWedge()), (vtk.VTK_VOXEL, vtk.vtkVoxel())]:
        n, start = cell.GetNumberOfPoints(), len(points)
        coordinates = cell.GetParametricCoords()
        for i in range(n):
            x, y, z = coordinates[3 * i:3 * i + 3]
            points.append([x + 2 * len(cells), y, z])
        cells.append((kind, list(range(start, start + n))))
    write("quadratic", grid(points, cells, {}, {}))


def lagrange():
    """Lagrange cells in VTK's parametric coordinates, side by side."""
    points, cells = [], []

    def add(kind, cell, n):
        cell.GetPointIds().SetNumberOfIds(n)
        cell.GetPoints().SetNumberOfPoints(n)
        cell.Initialize() if hasattr(cell, "Initialize") else None
        coordinates, start = cell.GetParametricCoords(), len(points)
        for i in range(n):
            x, y, z = coordinates[3 * i:3 * i + 3]
            points.append([x + 2 * len(cells), y, z])
        cells.append((kind, list(range(start, start + n))))

    for n, order in [(8, 1), (27, 2)]:
        cell = vtk.vtkLagrangeHexahedron()
        cell.SetOrder(order, order, order)
        add(vtk.VTK_LAGRANGE_HEXAHEDRON, cell, n)
    for n in (4, 10):
        add(vtk.VTK_LAGRANGE_TETRAHEDRON, vtk.vtkLagrangeTetra(), n)
    wedge = vtk.vtkLagrangeWedge()
    wedge.SetOrder(1, 1, 1, 6)
    add(vtk.VTK_LAGRANGE_WEDGE, wedge, 6)
    grid_ = grid(points, cells, {}, {})
    write("lagrange", grid_)
    legacy("lagrange-old", grid_, version=42)
    # Before version 5 the last two vertical edges were exchanged; the writer does not exchange them.
    text = open("lagrange-old.vtk").read()
    edges = " ".join(str(node) for node in range(8 + 16, 8 + 20))
    exchanged = " ".join(str(8 + node) for node in (16, 17, 19, 18))
    assert text.count(edges) == 1
    open("lagrange-old.vtk", "w").write(text.replace(edges, exchanged))


def legacy(name, data, binary=False, version=51):
    writer = vtk.vtkUnstructuredGridWriter()
    if not isinstance(data, vtk.vtkUnstructuredGrid):
        writer = vtk.vtkDataSetWriter()
    writer.SetInputData(data)
    writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
    writer.SetFileVersion(version)
    writer.SetFileName(name + ".vtk")
    writer.Write()


def legacy_files():
    plain = grid(POINTS, CELLS, CELL_DATA, POINT_DATA)
    text = vtk.vtkStringArray()
    text.SetName("a name of parts")
    [text.InsertNextValue(word) for word in ("brick and more", "b", "c", "d", "e")]
    plain.GetCellData().AddArray(text)
    vectors = numpy_to_vtk(np.arange(36.0).reshape(12, 3), deep=True)
    vectors.SetName("velocity")
    plain.GetPointData().SetVectors(vectors)
    for version in (42, 51):
        for binary in (False, True):
            legacy(f"legacy-{version}-{'binary' if binary else 'ascii'}", plain, binary, version)
    image = vtk.vtkImageData()
    image.SetDimensions(4, 3, 3)
    materials = numpy_to_vtk(np.array([1.0] * 6 + [2.0] * 6), deep=True)
    materials.SetName("material")
    image.GetCellData().SetScalars(materials)
    legacy("legacy-points", image)
    rectilinear = vtk.vtkRectilinearGrid()
    rectilinear.SetDimensions(4, 3, 3)
    for axis, n in (("X", 4), ("Y", 3), ("Z", 3)):
        getattr(rectilinear, f"Set{axis}Coordinates")(numpy_to_vtk(np.arange(float(n)), deep=True))
    rectilinear.GetCellData().SetScalars(materials)
    legacy("legacy-rectilinear", rectilinear, True)
    bent, array = vtk.vtkStructuredGrid(), vtk.vtkPoints()
    [array.InsertNextPoint(x, y, z) for z in range(3) for y in range(3) for x in range(4)]
    bent.SetDimensions(4, 3, 3)
    bent.SetPoints(array)
    bent.GetCellData().SetScalars(materials)
    legacy("legacy-structured", bent)


def piece(cells, ghosts=None):
    """Some cells of the mesh with their own points."""
    nodes = sorted({node for cell in cells for node in CELLS[cell][1]})
    cell_data = {name: values[cells] for name, values in CELL_DATA.items()}
    if ghosts is not None:
        cell_data["vtkGhostType"] = np.array(ghosts, np.uint8)
    own = [(CELLS[cell][0], [nodes.index(node) for node in CELLS[cell][1]]) for cell in cells]
    return grid([POINTS[node] for node in nodes], own, cell_data, {"group:apex": POINT_DATA["group:apex"][nodes]})


def pieces():
    texts = []
    # The second piece has the brick again, as a ghost.
    for cells, ghosts in [([0, 1], [0, 0]), ([0, 2, 3, 4], [1, 0, 0, 0])]:
        write("piece", piece(cells, ghosts))
        texts.append(open("piece.vtu").read())
    body = [text[text.index("    <Piece"):text.index("  </UnstructuredGrid>")] for text in texts]
    open("two-pieces.vtu", "w").write(texts[0].replace(body[0], body[0] + body[1]))
    os.remove("piece.vtu")
    for index, cells in enumerate([[0, 1], [2, 3, 4]]):
        write(f"parallel_{index}", piece(cells), "Appended")
    sources = "".join(f'<Piece Source="parallel_{index}.vtu"/>' for index in range(2))
    head = '<VTKFile type="PUnstructuredGrid" version="1.0" byte_order="LittleEndian">'
    points = '<PPoints><PDataArray type="Float64" NumberOfComponents="3"/></PPoints>'
    text = f"{head}<PUnstructuredGrid GhostLevel=\"0\">{points}{sources}</PUnstructuredGrid></VTKFile>\n"
    open("parallel.pvtu", "w").write(text)


def main():
    plain = grid(POINTS, CELLS, CELL_DATA, POINT_DATA)
    write("vtk-ascii", plain)
    write("vtk-inline-plain", plain, "Binary")
    write("vtk-inline-zlib", plain, "Binary", compressed=True, header=64)
    write("vtk-raw-plain", plain, "Appended", header=64)
    write("vtk-raw-zlib", plain, "Appended", compressed=True)
    write("vtk-base64-plain", plain, "Appended", encoded=True)
    write("vtk-base64-zlib", plain, "Appended", compressed=True, encoded=True, header=64)
    write("vtk-big-endian", plain, "Appended", compressed=True, big_endian=True)
    mirrored = [(kind, [1, 2, 9, 5, 6, 10] if kind == vtk.VTK_WEDGE else nodes) for kind, nodes in CELLS]
    write("mirrored", grid(POINTS, mirrored, CELL_DATA, POINT_DATA))
    quadratic()
    meshio_files()
    lagrange()
    legacy_files()
    pieces()


if __name__ == "__main__":
    main()
