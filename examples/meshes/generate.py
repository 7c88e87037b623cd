"""Writes the meshes of the examples. Needs Gmsh: `pip install gmsh`; run it in this directory.

tuning-fork.msh: quadratic tetrahedra, millimetres; volume "steel", surfaces "handle-end" and "tine-tips".
two-materials.msh: 20-node hexahedra; volumes "stiff" and "soft" side by side, surfaces "clamp" and "tip".
rubber-beam-hex20.msh, rubber-beam-hex27.msh: five quadratic hexahedra in a row, with the groups of a built-in box.
"""

import gmsh


def surfaces_at(axis, value, tolerance=1e-6):
    """Surfaces whose bounding box is flat at a coordinate."""
    found = []
    for _, tag in gmsh.model.getEntities(2):
        box = gmsh.model.getBoundingBox(2, tag)
        if abs(box[axis] - value) < tolerance and abs(box[axis + 3] - value) < tolerance:
            found.append(tag)
    return found


def tuning_fork():
    """A round handle, a yoke and two square tines along y."""
    gmsh.clear()
    occ = gmsh.model.occ
    handle = occ.addCylinder(0, -30, 0, 0, 32, 0, 2.5)
    parts = [occ.addBox(-7, 0, -2, 14, 5, 4), occ.addBox(-7, 5, -2, 4, 55, 4), occ.addBox(3, 5, -2, 4, 55, 4)]
    occ.fuse([(3, handle)], [(3, part) for part in parts])
    occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="steel")
    gmsh.model.addPhysicalGroup(2, surfaces_at(1, -30), name="handle-end")
    gmsh.model.addPhysicalGroup(2, surfaces_at(1, 60), name="tine-tips")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 4.5)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 6)
    gmsh.option.setNumber("Mesh.HighOrderOptimize", 1)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write("tuning-fork.msh")


def two_materials():
    """A plate of 12 x 4 x 1, one half of another material."""
    gmsh.clear()
    occ = gmsh.model.occ
    square = occ.addRectangle(0, 0, 0, 6, 4)
    other = occ.addRectangle(6, 0, 0, 6, 4)
    occ.fragment([(2, square)], [(2, other)])
    halves = gmsh.model.occ.getEntities(2)
    occ.extrude(halves, 0, 0, 1, numElements=[1], recombine=True)
    occ.synchronize()
    volumes = sorted((gmsh.model.occ.getCenterOfMass(3, tag)[0], tag) for _, tag in gmsh.model.getEntities(3))
    gmsh.model.addPhysicalGroup(3, [volumes[0][1]], name="stiff")
    gmsh.model.addPhysicalGroup(3, [volumes[1][1]], name="soft")
    gmsh.model.addPhysicalGroup(2, surfaces_at(0, 0), name="clamp")
    gmsh.model.addPhysicalGroup(2, surfaces_at(0, 12), name="tip")
    for _, surface in gmsh.model.getEntities(2):
        gmsh.model.mesh.setTransfiniteSurface(surface)
        gmsh.model.mesh.setRecombine(2, surface)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 1.5)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 1.5)
    gmsh.model.mesh.generate(3)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
    gmsh.model.mesh.setOrder(2)
    gmsh.option.setNumber("Mesh.Binary", 0)
    gmsh.write("two-materials.msh")


def rubber_beam(name, incomplete):
    """A beam of 10 x 100 x 10, its cells twice as long as those of `rubber-beam.toml`."""
    gmsh.clear()
    occ = gmsh.model.occ
    occ.addRectangle(0, 0, 0, 10, 100)
    occ.synchronize()
    for _, curve in gmsh.model.getEntities(1):
        box = gmsh.model.getBoundingBox(1, curve)
        gmsh.model.mesh.setTransfiniteCurve(curve, 6 if box[4] - box[1] > 50 else 2)
    gmsh.model.mesh.setTransfiniteSurface(1)
    gmsh.model.mesh.setRecombine(2, 1)
    occ.extrude([(2, 1)], 0, 0, 10, numElements=[1], recombine=True)
    occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [1], name="body")
    gmsh.model.addPhysicalGroup(2, surfaces_at(1, 0), name="y-min")
    gmsh.model.addPhysicalGroup(2, surfaces_at(1, 100), name="y-max")
    gmsh.model.mesh.generate(3)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
    gmsh.model.mesh.setOrder(2)
    gmsh.option.setNumber("Mesh.Binary", 0)
    gmsh.write(name)


if __name__ == "__main__":
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 2)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    tuning_fork()
    two_materials()
    rubber_beam("rubber-beam-hex20.msh", 1)
    rubber_beam("rubber-beam-hex27.msh", 0)
    gmsh.finalize()
