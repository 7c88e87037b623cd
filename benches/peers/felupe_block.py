"""The block in FElupe: `felupe_block.py r [cg|superlu]`.

cg: conjugate gradients with Jacobi; superlu: SciPy's LU in its mode for symmetric matrices.
"""
import sys
import time

import felupe
import numpy as np
from scipy.sparse import diags
from scipy.sparse.linalg import cg, splu

import block


def linear_solver(name):
    """The function (A, b) -> x."""
    def iterative(matrix, right):
        matrix = matrix.tocsr()
        solution, failed = cg(matrix, right, rtol=block.INNER, M=diags(1 / matrix.diagonal()))
        assert not failed
        return solution

    def direct(matrix, right):
        factors = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
                       options={"SymmetricMode": True})
        return factors.solve(right)

    return {"cg": iterative, "superlu": direct}[name]


def strain_energy(field, region):
    """Integral of mu/2 (tr C - 3) + lambda/2 ln(J)^2 - mu ln J."""
    F = field.extract()[0]
    log_J = np.log(np.linalg.det(F.transpose(2, 3, 0, 1)))
    density = (block.MU * (((F**2).sum(axis=(0, 1)) - 3) / 2 - log_J)
               + block.LAMBDA / 2 * log_J**2)
    return (density * region.dV).sum()


def main(r, solver="cg"):
    """Run the block and report."""
    solve = linear_solver(solver)
    points, cells = map(np.array, block.mesh(r))
    region = felupe.RegionHexahedron(felupe.Mesh(points, cells, "hexahedron"))
    displacement = felupe.Field(region, dim=3)
    field = felupe.FieldContainer([displacement])
    material = felupe.NeoHookeCompressible(mu=block.MU, lmbda=block.LAMBDA)
    body = felupe.SolidBody(material, field, density=block.DENSITY)
    mass = body.assemble.mass().tocsr()
    inertia = 4 / block.STEP_SIZE**2 * mass

    u = np.zeros(points.size)
    v = np.column_stack(block.velocity(*points.T)).ravel()
    seconds, iterations = [], []
    for _ in range(block.STEPS):
        start = time.process_time()
        middle, inertial = u.copy(), u + block.STEP_SIZE / 2 * v
        first, count = None, 0
        while True:
            displacement.values[:] = middle.reshape(-1, 3)
            force = body.assemble.vector(field).toarray().ravel()
            residual = force + inertia @ (middle - inertial)
            norm = np.linalg.norm(residual)
            first = first or norm
            if block.converged(norm, first):
                break
            middle -= solve(body.assemble.matrix(field) + inertia, residual)
            count += 1
        v = 4 / block.STEP_SIZE * (middle - u) - v
        u = 2 * middle - u
        seconds.append(time.process_time() - start)
        iterations.append(count)

    displacement.values[:] = u.reshape(-1, 3)
    tip = np.flatnonzero((points == block.TIP).all(axis=1))[0]
    rate = block.assembly_rate(
        len(cells), lambda: (body.assemble.vector(field), body.assemble.matrix(field)))
    block.report(f"FElupe {felupe.__version__}", solver, r, len(cells), u.size, seconds, iterations,
                 (v @ (mass @ v) / 2, strain_energy(field, region)),
                 (points + u.reshape(-1, 3))[tip], rate)


if __name__ == "__main__":
    main(int(sys.argv[1]), *sys.argv[2:])
