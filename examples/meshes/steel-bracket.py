"""Writes steel-bracket.msh, a bent bracket of 60 x 30 x 60 mm, 6 mm thick: quadratic tetrahedra, millimetres.

Needs Gmsh: `pip install gmsh`; run it in this directory.
"""

import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Verbosity", 2)
occ, model = gmsh.model.occ, gmsh.model
occ.fuse([(3, occ.addBox(0, 0, 0, 6, 30, 60))], [(3, occ.addBox(0, 0, 54, 60, 30, 6))])
occ.synchronize()


def faces(*box):
    """Surfaces in a box of two corners."""
    return [tag for _, tag in model.getEntitiesInBoundingBox(*box, 2)]


model.addPhysicalGroup(3, [tag for _, tag in model.getEntities(3)], name="steel")
model.addPhysicalGroup(2, faces(-1, -1, -1, 7, 31, 1), name="foot")
model.addPhysicalGroup(2, faces(59, -1, 53, 61, 31, 61), name="tip")
gmsh.option.setNumber("Mesh.MeshSizeMax", 5.0)
gmsh.option.setNumber("Mesh.ElementOrder", 2)
gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
model.mesh.generate(3)
gmsh.write("steel-bracket.msh")
gmsh.finalize()
