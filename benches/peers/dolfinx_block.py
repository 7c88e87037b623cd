"""The block in DOLFINx 0.5.2 with PETSc: `dolfinx_block.py R [SOLVER] [--cells KIND] ...`.

lu: forms with -O2, LU of MUMPS: the usual set-up. The others: forms with all optimisations, and
Cholesky of MUMPS, or conjugate gradients with an incomplete Cholesky factor, the diagonal, PETSc's
smoothed aggregation (gamg) or BoomerAMG (hypre). With `--mesh` a clamped bracket, not the block.
"""
import argparse
import pathlib
import time

import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import petsc
from mpi4py import MPI
from petsc4py import PETSc

import block

USUAL, TUNED = ["-O2"], ["-O3", "-march=native", "-ffast-math"]
TENSOR_ORDER = [0, 1, 3, 2, 4, 5, 7, 6]  # from the order of VTK
# Cell, family and degree of the displacement, degrees of the quadrature of strain energy and mass:
# Emmy's points in all of them.
KINDS = {"hex8": ("hexahedron", "Lagrange", 1, 3, 3),
         "hex20": ("hexahedron", "S", 2, 5, 5),
         "tet10": ("tetrahedron", "Lagrange", 2, 2, 4)}
# The foot of the bracket (z = 0) is clamped, a force (0, 0, -F) is spread over its tip (x = 60).
TIP, TIP_AREA = 60.0, 180.0
PULSE = [0.0, 5e-4, 1e-3], [0.0, 1.0, 0.0]

CG = {"ksp_type": "cg"}
DIRECT = {"ksp_type": "preonly", "pc_factor_mat_solver_type": "mumps"}
# Of multigrid the options that were fastest on the stiff block.
OPTIONS = {
    "lu": DIRECT | {"pc_type": "lu"},
    "cholesky": DIRECT | {"pc_type": "cholesky"},
    "icc": CG | {"pc_type": "icc"},
    "jacobi": CG | {"pc_type": "jacobi"},
    "gamg": CG | {"pc_type": "gamg", "pc_gamg_threshold": 0.01,
                  "mg_levels_ksp_type": "chebyshev", "mg_levels_pc_type": "jacobi"},
    "hypre": CG | {"pc_type": "hypre", "pc_hypre_type": "boomeramg",
                   "pc_hypre_boomeramg_strong_threshold": 0.7,
                   "pc_hypre_boomeramg_agg_nl": 1,
                   "pc_hypre_boomeramg_coarsen_type": "HMIS",
                   "pc_hypre_boomeramg_interp_type": "ext+i",
                   "pc_hypre_boomeramg_P_max": 4},
}


def arguments(words=None):
    """The command line, or these words."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("r", type=int, help="cells a unit length of the block")
    parser.add_argument("solver", nargs="?", default="lu", choices=OPTIONS)
    parser.add_argument("--cells", default="hex8", choices=KINDS)
    parser.add_argument("--mesh", help="Gmsh file of a bracket of tet10")
    parser.add_argument("--force", type=float, default=0.0, help="largest force on its tip")
    parser.add_argument("--material", default="neo-hooke",
                        choices=("neo-hooke", "saint-venant-kirchhoff"))
    parser.add_argument("--moduli", type=float, nargs=2, default=(block.LAMBDA, block.MU),
                        metavar=("LAMBDA", "MU"))
    parser.add_argument("--density", type=float, default=block.DENSITY)
    parser.add_argument("--step-size", type=float, default=block.STEP_SIZE)
    parser.add_argument("--steps", type=int, default=block.STEPS)
    parser.add_argument("--tolerance", type=float, default=block.RELATIVE,
                        help="of Newton, relative to inertia and load at the start")
    parser.add_argument("--guess", type=float, default=0.0,
                        help="of the middle: this part of a step straight on")
    parser.add_argument("--inner", type=float, default=block.INNER, help="tolerance of CG")
    parser.add_argument("--petsc", nargs=2, action="append", default=[], metavar=("KEY", "VALUE"),
                        help="any option of PETSc")
    return parser.parse_args(words)


def strain_energy(u, wanted):
    """Strain energy density of the material."""
    lam, mu = wanted.moduli
    F = ufl.Identity(3) + ufl.grad(u)
    if wanted.material == "saint-venant-kirchhoff":
        E = (F.T * F - ufl.Identity(3)) / 2
        return lam / 2 * ufl.tr(E)**2 + mu * ufl.inner(E, E)
    log_J = ufl.ln(ufl.det(F))
    return mu / 2 * (ufl.tr(F.T * F) - 3) + lam / 2 * log_J**2 - mu * log_J


def label(solver):
    """Name of the solver; says so if MUMPS has only the slow reference BLAS to work with."""
    slow = "/blas/libblas" in pathlib.Path("/proc/self/maps").read_text(encoding="utf-8")
    return f"{solver}, reference BLAS" if solver in ("lu", "cholesky") and slow else solver


def rigid_modes(space):
    """The six rigid motions, orthonormal: algebraic multigrid needs them."""
    def motion(i):
        """Translation along axis i, or rotation about axis i - 3."""
        axis = np.eye(3)[i % 3]
        return lambda x: (np.cross(axis, x.T) if i > 2 else axis + 0 * x.T).T

    modes = []
    for i in range(6):
        function = fem.Function(space)
        function.interpolate(motion(i))
        vector = function.vector.copy()
        for other in modes:
            vector.axpy(-vector.dot(other), other)
        vector.normalize()
        modes.append(vector)
    return PETSc.NullSpace().create(vectors=modes)


def linear_solver(wanted, matrix, space):
    """PETSc's solver of the linear systems."""
    options = PETSc.Options()
    for key, value in (OPTIONS[wanted.solver] | dict(wanted.petsc)).items():
        options[key] = value
    if wanted.solver != "lu":
        matrix.setOption(PETSc.Mat.Option.SPD, True)
    if wanted.solver == "gamg":
        matrix.setNearNullSpace(rigid_modes(space))
    solver = PETSc.KSP().create(matrix.comm)
    solver.setOperators(matrix)
    solver.setErrorIfNotConverged(True)
    solver.setTolerances(rtol=wanted.inner)
    solver.setFromOptions()
    return solver


def build_mesh(wanted):
    """The mesh, with straight edges."""
    if wanted.mesh:
        points, cells = block.gmsh_tetrahedra(wanted.mesh)
    else:
        points, cells = block.mesh(wanted.r)
        cells = block.tetrahedra(cells) if wanted.cells == "tet10" else cells
    shape = KINDS[wanted.cells][0]
    cells = np.array(cells)
    cells = cells[:, TENSOR_ORDER] if shape == "hexahedron" else cells
    element = ufl.Mesh(ufl.VectorElement("Lagrange", shape, 1))
    return dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells, np.array(points), element), len(cells)


def bracket(mesh, space):
    """Support of the foot of the bracket, and the measure of its tip."""
    def facets(axis, place):
        return dolfinx.mesh.locate_entities_boundary(
            mesh, 2, lambda x: np.isclose(x[axis], place, atol=1e-6))

    zero = np.zeros(3, dtype=PETSc.ScalarType)
    foot = fem.dirichletbc(zero, fem.locate_dofs_topological(space, 2, facets(2, 0.0)), space)
    tip = np.sort(facets(0, TIP))
    tags = dolfinx.mesh.meshtags(mesh, 2, tip, np.ones(len(tip), dtype=np.int32))
    return [foot], ufl.Measure("ds", domain=mesh, subdomain_data=tags)(1)


def main(wanted):
    """Run the block and report."""
    begin = time.process_time()
    h, density = wanted.step_size, wanted.density
    mesh, n_cells = build_mesh(wanted)
    shape, family, degree, *quadrature = KINDS[wanted.cells]
    space = fem.FunctionSpace(mesh, ufl.VectorElement(family, shape, degree))
    dx, dx_mass = (ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": degree})
                   for degree in quadrature)

    # Unknown: u in the middle; `inertial` is where it would be without forces.
    u, v, middle, inertial = (fem.Function(space) for _ in range(4))
    test = ufl.TestFunction(space)
    acceleration = 4 / h**2 * (middle - inertial)
    R = (ufl.derivative(strain_energy(middle, wanted) * dx, middle)
         + density * ufl.inner(acceleration, test) * dx_mass)
    flags = {"cffi_extra_compile_args": USUAL if wanted.solver == "lu" else TUNED}
    compiling = time.process_time()
    residual = fem.form(R, jit_params=flags)
    tangent = fem.form(ufl.derivative(R, middle), jit_params=flags)
    begin += time.process_time() - compiling
    matrix, vector = petsc.create_matrix(tangent), petsc.create_vector(residual)
    correction, force, supports = vector.duplicate(), vector.duplicate(), []
    if wanted.mesh:
        supports, ds = bracket(mesh, space)
        traction = ufl.as_vector((0.0, 0.0, -wanted.force / TIP_AREA))
        petsc.assemble_vector(force, fem.form(ufl.inner(traction, test) * ds))
    else:
        v.interpolate(lambda x: np.array(block.velocity(*x)))
    ksp = linear_solver(wanted, matrix, space)

    def assemble_residual(factor):
        vector.set(0.0)
        petsc.assemble_vector(vector, residual)
        vector.axpy(-factor, force)
        petsc.set_bc(vector, supports)

    def assemble_tangent():
        matrix.zeroEntries()
        petsc.assemble_matrix(matrix, tangent, bcs=supports, diagonal=wanted.moduli[1])
        matrix.assemble()

    # Inertia and largest load at the start.
    inertial.x.array[:] = h / 2 * v.x.array
    assemble_residual(1.0)
    scale = vector.norm()
    seconds, iterations = [], []
    for step in range(wanted.steps):
        start = time.process_time()
        factor = np.interp((step + 0.5) * h, *PULSE)
        middle.x.array[:] = u.x.array + wanted.guess * h * v.x.array
        inertial.x.array[:] = u.x.array + h / 2 * v.x.array
        count = 0
        while True:
            assemble_residual(factor)
            if block.converged(vector.norm(), scale, wanted.tolerance):
                break
            assemble_tangent()
            # Multigrid keeps the hierarchy of the first iteration of a step.
            ksp.pc.setReusePreconditioner(wanted.solver in ("gamg", "hypre") and count > 0)
            ksp.solve(vector, correction)
            middle.x.array[:] -= correction.array_r
            count += 1
        v.x.array[:] = 4 / h * (middle.x.array - u.x.array) - v.x.array
        u.x.array[:] = 2 * middle.x.array - u.x.array
        seconds.append(time.process_time() - start)
        iterations.append(count)
    total = time.process_time() - begin

    kinetic = fem.form(density / 2 * ufl.inner(v, v) * dx_mass)
    energies = [fem.assemble_scalar(form)
                for form in (kinetic, fem.form(strain_energy(u, wanted) * dx))]
    rate = block.assembly_rate(n_cells, lambda: (assemble_residual(1.0), assemble_tangent()))
    unchanged = wanted == arguments([str(wanted.r), wanted.solver])
    block.report(f"DOLFINx {dolfinx.__version__}", label(wanted.solver),
                 wanted.r if unchanged else None, n_cells,
                 3 * space.dofmap.index_map.size_global, seconds, iterations, energies,
                 None, rate, total=total)


if __name__ == "__main__":
    main(arguments())
