"""Writes the small VTU meshes of the tests. Needs VTK and meshio: `pip install vtk meshio`; run it in this directory.

One mesh in every way of writing: a brick [0, 1]^3 with a pyramid on it (apex at z = 2), a wedge beside it (x from 1 to 2),
a tetrahedron on the slope of the wedge, and the bottom of the brick as a quadrilateral. Cell data: "region" (0: brick and
pyramid, 1: wedge and tetrahedron, 5: quadrilateral), "group:top" (pyramid), "group:bottom" (quadrilateral),
"facets:left" (face 0 of the brick, x = 0), "quality" (not whole). Point data: "group:apex" (that of the pyramid).
mirrored.vtu has the wedge with its base the other way round, quadratic.vtu one of each quadratic cell from VTK's own
parametric coordinates, two-pieces.vtu is for the errors.
"""

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
    text = open("vtk-ascii.vtu").read()
    start, end = text.index("    <Piece"), text.index("  </UnstructuredGrid>")
    open("two-pieces.vtu", "w").write(text[:end] + text[start:end] + text[end:])


if __name__ == "__main__":
    main()
