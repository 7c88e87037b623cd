"""Writes bushing.msh: a steel pin and a steel sleeve with rubber between them, quadratic tetrahedra, millimetres.

Needs Gmsh: `pip install gmsh`; run it in this directory.
"""

import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
pin = occ.addCylinder(0, 0, 0, 0, 0, 30, 6)
rubber = occ.addCylinder(0, 0, 0, 0, 0, 30, 15)
sleeve = occ.addCylinder(0, 0, 0, 0, 0, 30, 18)
_, parts = occ.fragment([(3, sleeve)], [(3, rubber), (3, pin)])
occ.synchronize()
volume = lambda entity: occ.getMass(3, entity)
tags = sorted({tag for _, tag in gmsh.model.getEntities(3)}, key=volume)
# pi 30 (36, 189, 99): the pin is the smallest, the rubber the largest.
for name, tag in zip(["pin", "sleeve", "rubber"], tags):
    gmsh.model.addPhysicalGroup(3, [tag], name=name)
outside = [tag for _, tag in gmsh.model.getEntities(2) if abs(gmsh.model.getBoundingBox(2, tag)[0] + 18) < 1e-3
           and gmsh.model.getBoundingBox(2, tag)[5] - gmsh.model.getBoundingBox(2, tag)[2] > 29]
gmsh.model.addPhysicalGroup(2, outside, name="outside")
# Pieces of the ends whose centre is that of the pin and whose box is as small as it.
box = lambda tag: gmsh.model.getBoundingBox(2, tag)
ends = [tag for _, tag in gmsh.model.getEntities(2) if box(tag)[5] - box(tag)[2] < 1e-3 and abs(box(tag)[0] + 6) < 1e-3]
gmsh.model.addPhysicalGroup(2, ends, name="pin-ends")
gmsh.option.setNumber("Mesh.MeshSizeMax", 5.5)
gmsh.model.mesh.generate(3)
gmsh.model.mesh.setOrder(2)
gmsh.option.setNumber("Mesh.Binary", 1)
gmsh.write("bushing.msh")
