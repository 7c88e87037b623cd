"""The block in NGSolve: `ngsolve_block.py r [cg|sparsecholesky]`.

cg: conjugate gradients with Jacobi; sparsecholesky: NGSolve's own factorisation, analysed once.
The integrands are compiled to machine code.
"""
import os
import pathlib
import sys
import time

# The compiler that NGSolve calls for its integrands is in the folder of the interpreter.
os.environ["PATH"] = f"{pathlib.Path(sys.executable).parent}:{os.environ['PATH']}"

import netgen.meshing as netgen
import ngsolve
from ngsolve import CF, HEX, Det, Grad, Id, InnerProduct, log, x, y, z
from ngsolve.krylovspace import CGSolver

import block

H = block.STEP_SIZE


def hexahedra(points, cells):
    """NGSolve's mesh of points and cells."""
    mesh = netgen.Mesh(dim=3)
    numbers = [mesh.Add(netgen.MeshPoint(netgen.Pnt(*point))) for point in points]
    mesh.Add(netgen.FaceDescriptor(bc=1, domin=1, surfnr=1))
    for cell in cells:
        mesh.Add(netgen.Element3D(1, [numbers[node] for node in cell]))
    return ngsolve.Mesh(mesh)


def strain_energy(u):
    """mu/2 (tr C - 3) + lambda/2 ln(J)^2 - mu ln J."""
    F = Id(3) + Grad(u)
    log_J = log(Det(F))
    return (block.MU / 2 * (InnerProduct(F, F) - 3) + block.LAMBDA / 2 * log_J**2
            - block.MU * log_J)


def linear_solver(name, form, free):
    """The function b -> x for the matrix of a form, called after each assembly."""
    factor = None

    def direct(right):
        nonlocal factor
        if factor is None:
            factor = form.mat.Inverse(free, inverse="sparsecholesky")
        else:
            factor.Update()
        return factor * right

    def iterative(right):
        jacobi = form.mat.CreateSmoother(free)
        return CGSolver(form.mat, jacobi, tol=block.INNER, maxiter=500, printrates=False) * right

    return {"cg": iterative, "sparsecholesky": direct}[name]


def main(r, solver="cg"):
    """Run the block and report."""
    points, cells = block.mesh(r)
    mesh = hexahedra(points, cells)
    space = ngsolve.VectorH1(mesh, order=1)
    trial, test = space.TnT()
    dx = ngsolve.dx(intrules={HEX: ngsolve.IntegrationRule(HEX, 3)})  # 2 x 2 x 2
    inertia = 2 * block.DENSITY / H**2
    form = ngsolve.BilinearForm(space, symmetric=solver == "sparsecholesky")
    form += ngsolve.Variation(strain_energy(trial).Compile(True, wait=True) * dx)
    form += ngsolve.Variation(inertia * InnerProduct(trial, trial) * dx)
    mass = ngsolve.BilinearForm(block.DENSITY * InnerProduct(trial, test) * dx).Assemble().mat
    u, v, middle = (ngsolve.GridFunction(space) for _ in range(3))
    v.Set(CF(block.velocity(x, y, z)))
    inertial, residual, change = (u.vec.CreateVector() for _ in range(3))
    solve = linear_solver(solver, form, space.FreeDofs())

    seconds, iterations = [], []
    for _ in range(block.STEPS):
        start = time.process_time()
        middle.vec.data = u.vec
        inertial.data = mass * (4 / H**2 * u.vec + 2 / H * v.vec)
        first, count = None, 0
        while True:
            form.Apply(middle.vec, residual)
            residual.data -= inertial
            norm = ngsolve.Norm(residual)
            first = first or norm
            if block.converged(norm, first):
                break
            form.AssembleLinearization(middle.vec)
            change.data = solve(residual)
            middle.vec.data -= change
            count += 1
        change.data = middle.vec - u.vec
        v.vec.data *= -1  # in place: a vector must not stand on both sides
        v.vec.data += 4 / H * change
        u.vec.data += 2 * change
        seconds.append(time.process_time() - start)
        iterations.append(count)

    change.data = mass * v.vec
    energies = (InnerProduct(v.vec, change) / 2,
                ngsolve.Integrate(strain_energy(u), mesh, order=3))
    corner = points.index(block.TIP)
    tip = [block.TIP[i] + u.components[i].vec[corner] for i in range(3)]

    def assemble():
        form.Apply(middle.vec, residual)
        form.AssembleLinearization(middle.vec)

    rate = block.assembly_rate(len(cells), assemble)
    block.report(f"NGSolve {ngsolve.__version__}", solver, r, len(cells), 3 * len(points), seconds,
                 iterations, energies, tip, rate)


if __name__ == "__main__":
    ngsolve.SetNumThreads(1)
    with ngsolve.TaskManager():
        main(int(sys.argv[1]), *sys.argv[2:])
