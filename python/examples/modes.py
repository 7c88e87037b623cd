"""The lowest natural modes of the bracket by SciPy, from the matrices of the body."""

import emmy, gmsh
gmsh.initialize()
occ, model = gmsh.model.occ, gmsh.model
occ.fuse([(3, occ.addBox(0, 0, 0, 6, 30, 60))], [(3, occ.addBox(0, 0, 54, 60, 30, 6))])
occ.synchronize()
face = lambda *box: [tag for _, tag in model.getEntitiesInBoundingBox(*box, 2)]
model.addPhysicalGroup(3, [tag for _, tag in model.getEntities(3)], name="steel")
model.addPhysicalGroup(2, face(-1, -1, -1, 7, 31, 1), name="foot")
model.addPhysicalGroup(2, face(59, -1, 53, 61, 31, 61), name="tip")
gmsh.option.setNumber("Mesh.MeshSizeMax", 5.0)
gmsh.option.setNumber("Mesh.ElementOrder", 2)
model.mesh.generate(3)
mesh = emmy.Mesh.from_gmsh()                    # the current model; or Mesh.read("bracket.msh" | ".inp" | ".vtu"), from_meshio(m), from_pyvista(grid)

steel = emmy.SaintVenantKirchhoff(youngs_modulus=210e3, poissons_ratio=0.3)
body = emmy.Body(mesh, regions=emmy.Region(steel, density=7.85e-9, group="steel"),
                 supports=emmy.Support("foot", fix="xyz"),
                 loads=emmy.Load("tip", force=[0, 0, -2000], history=[(0, 0), (5e-4, 1), (1e-3, 0)]))
print(body)                                     # what `emmy check` prints: masses, resultants, groups, quality
import scipy.sparse.linalg as sla
K, M, free = body.stiffness(), body.mass(), ~body.fixed.ravel()           # scipy.sparse CSR arrays
w2, _ = sla.eigsh(K[free][:, free], 6, M=M[free][:, free], sigma=0.0)
