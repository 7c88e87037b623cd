"""The block in PyMFEM: `mfem_block.py r [cg]`, conjugate gradients with Jacobi, both of MFEM.

The material is the nearest that MFEM has, mu/2 (tr C / J^(2/3) - 3) + K/2 (J - 1)^2: the work is
the same, the energies are not.
"""
import sys
import time

import mfem.ser as mfem
import numpy as np
from scipy.sparse import csr_matrix

import block

H = block.STEP_SIZE


def hexahedra(points, cells):
    """MFEM's mesh of points and cells."""
    mesh = mfem.Mesh(3, len(points), len(cells), 0, 3)
    for point in points:
        mesh.AddVertex(*point)
    for cell in cells:
        mesh.AddHex(*cell)
    mesh.FinalizeHexMesh(1, 0, False)
    return mesh


def scipy_matrix(matrix):
    """A view of MFEM's matrix."""
    arrays = matrix.GetDataArray(), matrix.GetJArray(), matrix.GetIArray()
    return csr_matrix(arrays, shape=(matrix.Height(), matrix.Width()))


def linear_solver(name):
    """MFEM's solver of the linear systems with its preconditioner."""
    if name != "cg":
        sys.exit(f"no solver {name}: there is cg")
    jacobi, solver = mfem.DSmoother(), mfem.CGSolver()
    solver.SetRelTol(block.INNER)
    solver.SetMaxIter(500)
    solver.SetPrintLevel(-1)
    solver.SetPreconditioner(jacobi)
    return solver, jacobi


def main(r, solver="cg"):
    """Run the block and report."""
    points, cells = block.mesh(r)
    mesh = hexahedra(points, cells)
    space = mfem.FiniteElementSpace(mesh, mfem.H1_FECollection(1, 3), 3, mfem.Ordering.byVDIM)
    rule = mfem.IntRules.Get(mfem.Geometry.CUBE, 3)  # 2 x 2 x 2
    model = mfem.NeoHookeanModel(block.MU, block.LAMBDA + 2 * block.MU / 3)
    elastic = mfem.HyperelasticNLFIntegrator(model)
    inertial = mfem.VectorMassIntegrator(mfem.ConstantCoefficient(block.DENSITY))
    for integrator in elastic, inertial:
        integrator.SetIntRule(rule)
    force = mfem.NonlinearForm(space)
    force.AddDomainIntegrator(elastic)
    form = mfem.BilinearForm(space)
    form.AddDomainIntegrator(inertial)
    form.Assemble(0)  # zeros stay: the pattern belongs to the tangent
    form.Finalize(0)
    mass = scipy_matrix(form.SpMat())
    krylov, _jacobi = linear_solver(solver)
    vector, result, change = (mfem.Vector(3 * len(points)) for _ in range(3))

    def internal_force(q):
        vector.Assign(q)
        force.Mult(vector, result)
        return result.GetDataArray()

    def tangent(q):
        vector.Assign(q)
        return mfem.Opr2SparseMat(force.GetGradient(vector))

    reference = np.array(points)
    q, v = reference.ravel().copy(), np.column_stack(block.velocity(*reference.T)).ravel()
    seconds, iterations = [], []
    for _ in range(block.STEPS):
        start = time.process_time()
        middle, flying = q.copy(), q + H / 2 * v
        first, count = None, 0
        while True:
            residual = internal_force(middle) + 4 / H**2 * (mass @ (middle - flying))
            norm = np.linalg.norm(residual)
            first = first or norm
            if block.converged(norm, first):
                break
            matrix = tangent(middle)
            matrix.Add(4 / H**2, form.SpMat())
            krylov.SetOperator(matrix)
            vector.Assign(residual)
            change.Assign(0.0)
            krylov.Mult(vector, change)
            assert krylov.GetConverged()
            middle -= change.GetDataArray()
            count += 1
        v = 4 / H * (middle - q) - v
        q = 2 * middle - q
        seconds.append(time.process_time() - start)
        iterations.append(count)

    vector.Assign(q)
    energies = v @ (mass @ v) / 2, force.GetEnergy(vector)
    tip = q.reshape(-1, 3)[points.index(block.TIP)]
    rate = block.assembly_rate(len(cells), lambda: (internal_force(q), tangent(q)))
    block.report("PyMFEM 4.10", solver, r, len(cells), q.size, seconds, iterations, energies, tip,
                 rate, same=False)


if __name__ == "__main__":
    main(int(sys.argv[1]), *sys.argv[2:])
