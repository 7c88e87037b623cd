"""The block in DOLFINx 0.5.2 with PETSc: `dolfinx_block.py r [lu|cholesky|icc|jacobi]`.

lu: forms with -O2, LU of MUMPS: the usual set-up. The others: forms with all optimisations, and
Cholesky of MUMPS, or conjugate gradients with an incomplete Cholesky factor or the diagonal.
"""
import pathlib
import sys
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
H = block.STEP_SIZE


def strain_energy(u):
    """mu/2 (tr C - 3) + lambda/2 ln(J)^2 - mu ln J."""
    F = ufl.Identity(3) + ufl.grad(u)
    log_J = ufl.ln(ufl.det(F))
    return (block.MU / 2 * (ufl.tr(F.T * F) - 3) + block.LAMBDA / 2 * log_J**2
            - block.MU * log_J)


def label(solver):
    """Name of the solver; says so if MUMPS has only the slow reference BLAS to work with."""
    slow = "/blas/libblas" in pathlib.Path("/proc/self/maps").read_text(encoding="utf-8")
    return f"{solver}, reference BLAS" if solver in ("lu", "cholesky") and slow else solver


def linear_solver(name, matrix):
    """PETSc's solver of the linear systems."""
    solver = PETSc.KSP().create(matrix.comm)
    solver.setOperators(matrix)
    solver.setErrorIfNotConverged(True)
    if name in ("lu", "cholesky"):
        solver.setType("preonly")
        solver.pc.setType(name)
        solver.pc.setFactorSolverType("mumps")
    else:
        solver.setType("cg")
        solver.pc.setType({"icc": "icc", "jacobi": "jacobi"}[name])
        solver.setTolerances(rtol=block.INNER)
    if name != "lu":
        matrix.setOption(PETSc.Mat.Option.SPD, True)
    return solver


def main(r, solver="lu"):
    """Run the block and report."""
    points, cells = map(np.array, block.mesh(r))
    shape = ufl.Mesh(ufl.VectorElement("Lagrange", "hexahedron", 1))
    mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells[:, TENSOR_ORDER], points, shape)
    space = fem.VectorFunctionSpace(mesh, ("Lagrange", 1))
    dx = ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": 3})  # 2 x 2 x 2

    # Unknown: u in the middle; `inertial` is where it would be without forces.
    u, v, middle, inertial = (fem.Function(space) for _ in range(4))
    v.interpolate(lambda x: np.array(block.velocity(*x)))
    acceleration = 4 / H**2 * (middle - inertial)
    R = (ufl.derivative(strain_energy(middle) * dx, middle)
         + block.DENSITY * ufl.inner(acceleration, ufl.TestFunction(space)) * dx)
    flags = {"cffi_extra_compile_args": USUAL if solver == "lu" else TUNED}
    residual = fem.form(R, jit_params=flags)
    tangent = fem.form(ufl.derivative(R, middle), jit_params=flags)
    matrix, vector = petsc.create_matrix(tangent), petsc.create_vector(residual)
    correction = vector.duplicate()
    ksp = linear_solver(solver, matrix)

    def assemble_residual():
        vector.set(0.0)
        petsc.assemble_vector(vector, residual)

    def assemble_tangent():
        matrix.zeroEntries()
        petsc.assemble_matrix(matrix, tangent)
        matrix.assemble()

    seconds, iterations = [], []
    for _ in range(block.STEPS):
        start = time.process_time()
        middle.x.array[:] = u.x.array
        inertial.x.array[:] = u.x.array + H / 2 * v.x.array
        first, count = None, 0
        while True:
            assemble_residual()
            norm = vector.norm()
            first = first or norm
            if block.converged(norm, first):
                break
            assemble_tangent()
            ksp.solve(vector, correction)
            middle.x.array[:] -= correction.array_r
            count += 1
        v.x.array[:] = 4 / H * (middle.x.array - u.x.array) - v.x.array
        u.x.array[:] = 2 * middle.x.array - u.x.array
        seconds.append(time.process_time() - start)
        iterations.append(count)

    kinetic = block.DENSITY / 2 * ufl.inner(v, v)
    energies = [fem.assemble_scalar(fem.form(density * dx))
                for density in (kinetic, strain_energy(u))]
    nodes = space.tabulate_dof_coordinates()
    tip = np.flatnonzero(np.isclose(nodes, block.TIP).all(axis=1))[0]
    rate = block.assembly_rate(len(cells), lambda: (assemble_residual(), assemble_tangent()))
    block.report(f"DOLFINx {dolfinx.__version__}", label(solver), r, len(cells), 3 * len(points),
                 seconds, iterations, energies, (nodes + u.x.array.reshape(-1, 3))[tip], rate)


if __name__ == "__main__":
    main(int(sys.argv[1]), *sys.argv[2:])
