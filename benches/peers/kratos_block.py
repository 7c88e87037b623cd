"""The block in Kratos: `kratos_block.py r [amgcl]`, conjugate gradients with algebraic multigrid.

Kratos has no mid-point rule: Newmark's method (its Bossak scheme with alpha = 0) does the same work
with other energies.
"""
import itertools
import json
import sys
import time

import KratosMultiphysics as kratos
import KratosMultiphysics.ConstitutiveLawsApplication as laws
import KratosMultiphysics.LinearSolversApplication
import KratosMultiphysics.StructuralMechanicsApplication
import numpy as np
from KratosMultiphysics.python_linear_solver_factory import ConstructSolver

import block

SOLVERS = {"amgcl": {
    "solver_type": "amgcl", "krylov_type": "cg", "smoother_type": "spai0",
    "tolerance": block.INNER, "max_iteration": 500, "block_size": 3,
    "use_block_matrices_if_possible": True}}
VARIABLES = (kratos.DISPLACEMENT, kratos.VELOCITY, kratos.ACCELERATION, kratos.REACTION,
             kratos.VOLUME_ACCELERATION)
DOFS = ((kratos.DISPLACEMENT_X, kratos.REACTION_X), (kratos.DISPLACEMENT_Y, kratos.REACTION_Y),
        (kratos.DISPLACEMENT_Z, kratos.REACTION_Z))


def body(points, cells):
    """Kratos's model and the part that is the block."""
    model = kratos.Model()
    part = model.CreateModelPart("block")
    part.SetBufferSize(2)
    part.ProcessInfo[kratos.DOMAIN_SIZE] = 3
    part.ProcessInfo[kratos.DELTA_TIME] = block.STEP_SIZE
    for variable in VARIABLES:
        part.AddNodalSolutionStepVariable(variable)
    properties = part.CreateNewProperties(1)
    total = block.LAMBDA + block.MU
    properties[kratos.YOUNG_MODULUS] = block.MU * (3 * block.LAMBDA + 2 * block.MU) / total
    properties[kratos.POISSON_RATIO] = block.LAMBDA / (2 * total)
    properties[kratos.DENSITY] = block.DENSITY
    properties[kratos.CONSTITUTIVE_LAW] = laws.HyperElastic3DLaw()
    for index, point in enumerate(points, 1):
        part.CreateNewNode(index, *point)
    for index, cell in enumerate(cells, 1):
        nodes = [node + 1 for node in cell]
        part.CreateNewElement("TotalLagrangianElement3D8N", index, nodes, properties)
    for dof, reaction in DOFS:
        kratos.VariableUtils().AddDof(dof, reaction, part)
    return model, part


def newton(part, scheme, solver):
    """Kratos's Newton iteration with its linear solver, and what assembles for it."""
    builder = kratos.ResidualBasedBlockBuilderAndSolver(
        ConstructSolver(kratos.Parameters(json.dumps(SOLVERS[solver]))))
    criterion = kratos.ResidualCriteria(block.RELATIVE, 1e-12)
    strategy = kratos.ResidualBasedNewtonRaphsonStrategy(
        part, scheme, criterion, builder, 20, False, False, True)
    strategy.SetEchoLevel(0)
    strategy.Initialize()
    return strategy, builder


def energies(points, cells, displacement, velocity):
    """Kinetic and strain energy by 2 x 2 x 2 Gauss points in cubes of one size."""
    points, cells = np.array(points), np.array(cells)
    corners = 2 * np.array(block.CORNERS) - 1
    edge = np.ptp(points[cells[0], 0])
    kinetic = strain = 0.0
    for gauss in itertools.product((-(3**-0.5), 3**-0.5), repeat=3):
        factors = (1 + corners * gauss) / 2
        shape = factors.prod(axis=1)
        gradient = np.column_stack(
            [corners[:, i] / edge * np.delete(factors, i, axis=1).prod(axis=1) for i in range(3)])
        F = np.eye(3) + np.einsum("cni,nj->cij", displacement[cells], gradient)
        log_J = np.log(np.linalg.det(F))
        v = np.einsum("cni,n->ci", velocity[cells], shape)
        density = (block.MU * (((F**2).sum(axis=(1, 2)) - 3) / 2 - log_J)
                   + block.LAMBDA / 2 * log_J**2)
        kinetic += (edge / 2) ** 3 * block.DENSITY / 2 * (v**2).sum()
        strain += (edge / 2) ** 3 * density.sum()
    return kinetic, strain


def main(r, solver="amgcl"):
    """Run the block and report."""
    kratos.Logger.GetDefaultOutput().SetSeverity(kratos.Logger.Severity.WARNING)
    kratos.ParallelUtilities.SetNumThreads(1)
    points, cells = block.mesh(r)
    _model, part = body(points, cells)
    scheme = kratos.ResidualBasedBossakDisplacementScheme(0.0)
    strategy, builder = newton(part, scheme, solver)
    for node, point in zip(part.Nodes, points):
        for past in range(2):
            node.SetSolutionStepValue(kratos.VELOCITY, past, list(block.velocity(*point)))

    seconds, iterations = [], []
    for step in range(1, block.STEPS + 1):
        start = time.process_time()
        part.CloneTimeStep(step * block.STEP_SIZE)
        part.ProcessInfo[kratos.STEP] = step
        strategy.InitializeSolutionStep()
        strategy.Predict()
        assert strategy.SolveSolutionStep()
        strategy.FinalizeSolutionStep()
        seconds.append(time.process_time() - start)
        iterations.append(part.ProcessInfo[kratos.NL_ITERATION_NUMBER])

    def nodal(variable):
        return np.array([list(node.GetSolutionStepValue(variable)) for node in part.Nodes])

    def assemble():
        matrix, vector = strategy.GetSystemMatrix(), strategy.GetSystemVector()
        kratos.UblasSparseSpace().SetToZeroMatrix(matrix)
        kratos.UblasSparseSpace().SetToZeroVector(vector)
        builder.Build(scheme, part, matrix, vector)

    version = kratos.Kernel.Version().split("--")[0].replace('"', "")
    displacement = nodal(kratos.DISPLACEMENT)
    tip = points.index(block.TIP)
    block.report(f"Kratos {version}", solver, r, len(cells), 3 * len(points),
                 seconds, iterations,
                 energies(points, cells, displacement, nodal(kratos.VELOCITY)),
                 np.array(block.TIP) + displacement[tip], block.assembly_rate(len(cells), assemble),
                 same=False)


if __name__ == "__main__":
    main(int(sys.argv[1]), *sys.argv[2:])
