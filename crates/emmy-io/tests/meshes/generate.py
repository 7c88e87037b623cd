"""Writes the small Gmsh meshes of the tests. Needs Gmsh: `pip install gmsh`; run it in this directory.

KIND-VERSION-ENCODING.msh for each kind of cell: a box [0, 2] x [0, 1] x [0, 1] of two parts at x = 1.
Physical groups: volumes "left part", "right part" and "whole" (both, so every cell is in two groups); surfaces "clamp"
(x = 0), "tip" (x = 2), "skin" (x = 2 and z = 1) and one without a name, number 7 (the inner one at x = 1); curve
"edge" (y = z = 0); point "corner" (the origin). hex20 also with parametric coordinates, partitioned, and without groups
but with all elements (all-VERSION.msh), and in MSH 1 and 4.0. mixed-VERSION-ENCODING.msh is the same box with hexahedra in the left part, and
pyramids and tetrahedra in the right one, quadratic-mixed-VERSION-ENCODING.msh the same with quadratic cells. gmsh-solid.inp and gmsh-solid-quadratic.inp are a box [0, 1] x [0, 1] x [0, 2] as
Gmsh writes it for Abaqus, with its faces; surfaces-alone.msh has its ends without its volume. nastran-KIND.bdf
(free, small and large fields: nastran-FORMAT.bdf of tet10) are the box [0, 2] x [0, 1] x [0, 1] as Gmsh writes it for Nastran. wedge18.msh is for the errors.
"""

import struct

import gmsh

KINDS = {"tet4": (1, 0), "tet10": (2, 0), "hex8": (1, 0), "hex20": (2, 1), "hex27": (2, 0),
         "wedge6": (1, 0), "wedge15": (2, 1), "mixed": (1, 0), "quadratic-mixed": (2, 1)}
FORMATS = {"22": 2.2, "41": 4.1}


def box(kind):
    """Two unit cubes side by side."""
    gmsh.clear()
    hexahedra = kind.startswith("hex")
    corners = [gmsh.model.occ.addPoint(0, y, z) for y, z in [(0, 0), (1, 0), (1, 1), (0, 1)]]
    edges = [gmsh.model.occ.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1])]
    square = gmsh.model.occ.addPlaneSurface([gmsh.model.occ.addCurveLoop(edges)])
    layers = {} if kind.startswith("tet") else {"numElements": [1], "recombine": True}
    gmsh.model.occ.extrude([(2, square)], 1, 0, 0, **layers)
    gmsh.model.occ.synchronize()
    mixed = kind.endswith("mixed")
    layers = {} if mixed else layers
    gmsh.model.occ.extrude([(2, tag) for tag in on(2, x=1)], 1, 0, 0, **layers)
    gmsh.model.occ.synchronize()
    left = on(2, x=0) if mixed else []
    along_y = on(1, y=0.5)
    for _, curve in gmsh.model.getEntities(1):
        gmsh.model.mesh.setTransfiniteCurve(curve, 3 if hexahedra and curve in along_y else 2)
    quadrilaterals = [surface for _, surface in gmsh.model.getEntities(2)] if hexahedra else left
    for surface in quadrilaterals:
        gmsh.model.mesh.setTransfiniteSurface(surface)
        gmsh.model.mesh.setRecombine(2, surface)


def centre(dim, tag):
    return gmsh.model.occ.getCenterOfMass(dim, tag)


def on(dim, **at):
    """Numbers of the entities of a dimension whose centre lies in given planes."""
    def lies(tag):
        return all(abs(centre(dim, tag)["xyz".index(axis)] - value) < 1e-6 for axis, value in at.items())
    return [tag for _, tag in gmsh.model.getEntities(dim) if lies(tag)]


def groups():
    gmsh.model.addPhysicalGroup(3, on(3, x=0.5), name="left part")
    gmsh.model.addPhysicalGroup(3, on(3, x=1.5), name="right part")
    gmsh.model.addPhysicalGroup(3, on(3), name="whole")
    gmsh.model.addPhysicalGroup(2, on(2, x=0), name="clamp")
    gmsh.model.addPhysicalGroup(2, on(2, x=2), name="tip")
    gmsh.model.addPhysicalGroup(2, on(2, x=2) + on(2, z=1), name="skin")
    gmsh.model.addPhysicalGroup(2, on(2, x=1), tag=7)
    gmsh.model.addPhysicalGroup(1, on(1, y=0, z=0), name="edge")
    origin = [t for _, t in gmsh.model.getEntities(0) if not any(gmsh.model.getValue(0, t, []))]
    gmsh.model.addPhysicalGroup(0, origin, name="corner")


def write(name, version, binary, **options):
    options = {"MshFileVersion": version, "Binary": binary, "SaveAll": 0, "SaveParametric": 0} | options
    for option, value in options.items():
        gmsh.option.setNumber("Mesh." + option, value)
    gmsh.write(name + ".msh")


def partitions():
    gmsh.model.mesh.partition(2)
    write("partitioned-22", 2.2, 0)
    write("partitioned-40", 4.0, 0)
    write("partitioned-41", 4.1, 0)
    write("partitioned-41-binary", 4.1, 1)
    gmsh.model.mesh.unpartition()


def for_other_versions():
    """Versions that are seldom written today, and parametric nodes."""
    write("hex20-1", 1, 0)
    write("hex20-40-ascii", 4.0, 0)
    binary_40("hex20-40-ascii.msh", "hex20-40-binary.msh")
    write("parametric-22", 2.2, 0, SaveParametric=1)
    write("parametric-40", 4.0, 0, SaveParametric=1)


def binary_40(text, binary):
    """The binary form of a file of MSH 4.0 by the manual of Gmsh 4.0; later versions have text only."""
    with open(text, encoding="ascii") as file:
        head, rest = file.read().split("$Entities\n")
    words = iter(rest.split())
    out = bytearray(head.replace("4 0 8\n", "4 1 8\n").split("$EndMeshFormat")[0].encode())
    out += struct.pack("<i", 1) + b"\n$EndMeshFormat" + head.split("$EndMeshFormat")[1].encode() + b"$Entities\n"

    def take(format):
        values = [float(next(words)) if kind == "d" else int(next(words)) for kind in format]
        out.extend(struct.pack("<" + format, *values))
        return values

    for dim, count in enumerate(take("QQQQ")):
        for _ in range(count):
            take("i" * take("idddddd" + "Q")[-1])
            if dim > 0:
                take("i" * take("Q")[0])
    out += b"\n" + next(words).encode() + b"\n" + next(words).encode() + b"\n"
    for _ in range(take("QQ")[0]):
        for _ in range(take("iiiQ")[-1]):
            take("iddd")
    out += b"\n" + next(words).encode() + b"\n" + next(words).encode() + b"\n"
    nodes = {1: 2, 8: 3, 15: 1, 16: 8, 17: 20}
    for _ in range(take("QQ")[0]):
        _, _, kind, count = take("iiiQ")
        for _ in range(count):
            take("i" * (1 + nodes[kind]))
    out += b"\n" + next(words).encode() + b"\n"
    with open(binary, "wb") as file:
        file.write(out)


def for_errors():
    """A kind of cell that is not read, in binary."""
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 0)
    box("wedge18")
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    write("wedge18", 4.1, 1)


def for_abaqus():
    """A box with the groups body, foot (z = 0) and top (z = 2)."""
    for order, name, all_elements in [(1, "gmsh-solid", 1), (2, "gmsh-solid-quadratic", 0)]:
        gmsh.clear()
        gmsh.model.occ.addBox(0, 0, 0, 1, 1, 2)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [1], name="body")
        for group, z in [("foot", 0), ("top", 2)]:
            gmsh.model.addPhysicalGroup(2, on(2, z=z), name=group)
        gmsh.option.setNumber("Mesh.MeshSizeMin", 1)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 1)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(order)
        gmsh.option.setNumber("Mesh.SaveAll", all_elements)
        gmsh.write(f"{name}.inp")
        gmsh.option.setNumber("Mesh.SaveAll", 0)
        if order == 1:
            gmsh.model.removePhysicalGroups([(3, 1)])
            write("surfaces-alone", 4.1, 0)


def for_nastran(kind):
    """The box with its inner and outer surfaces; properties are the numbers of the entities."""
    gmsh.option.setNumber("Mesh.SaveAll", 1)
    for name, number in [("free", 0), ("small", 1), ("large", 2)] if kind == "tet10" else [(kind, 1)]:
        gmsh.option.setNumber("Mesh.BdfFieldFormat", number)
        gmsh.write(f"nastran-{name}.bdf")
    gmsh.option.setNumber("Mesh.SaveAll", 0)


def main():
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 2)
    for kind, (order, incomplete) in KINDS.items():
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
        box(kind)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(order)
        groups()
        for label, version in FORMATS.items():
            write(f"{kind}-{label}-ascii", version, 0)
            write(f"{kind}-{label}-binary", version, 1)
        if kind in ("tet10", "hex20", "wedge15"):
            for_nastran(kind)
        if kind == "hex20":
            write("parametric", 4.1, 0, SaveParametric=1)
            for_other_versions()
            partitions()
            gmsh.model.removePhysicalGroups()
            write("all-22", 2.2, 0, SaveAll=1)
            write("all-41", 4.1, 0, SaveAll=1)
    for_errors()
    for_abaqus()
    gmsh.finalize()


if __name__ == "__main__":
    main()
