"""Mechanisms in EXUDYN: `exudyn_mechanism.py pendulum|four-bars|four-bars-3d|heavy-top SOLVER STEPS`.

The problems are those of `validation/data/mechanisms.toml`: a point mass on a rigid link (A01) and two four-bar linkages
(A02) for ten seconds, and the heavy top for two. Solvers: `trapezoidal`, the trapezoidal rule with constraints of index
2; `alpha`, the generalized-alpha method with spectral radius 0.9 and constraints of index 3.

`four-bars` has bodies of the plane, without redundant constraints; `four-bars-3d` has bodies of space on hinges, whose
redundant constraints a dense solver leaves out.

The tolerance of Newton's iteration is 1e-10, or 1e-8 where that fails. Prints one line of JSON: error of the position at the end, CPU seconds of the steps.
"""
import json
import sys
import time
import warnings

import exudyn as exu
import numpy as np
from exudyn import itemInterface as item
from exudyn.rigidBodyUtilities import RigidBodyInertia

warnings.simplefilter("ignore")

GRAVITY = 9.81
ENDS = {"pendulum": 10.0, "four-bars": 10.0, "four-bars-3d": 10.0, "heavy-top": 2.0}
EXACT = {
    "pendulum": [-0.275087462576, -0.961419205099, 0.0],
    "four-bars": [0.328458111539, 0.944518538179, 0.0],
    "four-bars-3d": [0.328458111539, 0.944518538179, 0.0],
    "heavy-top": [-0.150416822746, -0.724165591637, -0.673022269560],
}


def pendulum(system, ground):
    """Point mass of 1 kg on a link."""
    node = system.AddNode(item.NodePoint2D(referenceCoordinates=[-1, 0]))
    body = system.AddObject(item.ObjectMassPoint2D(physicsMass=1, nodeNumber=node))
    end = system.AddMarker(item.MarkerBodyPosition(bodyNumber=body))
    pivot = system.AddMarker(item.MarkerBodyPosition(bodyNumber=ground))
    system.AddObject(item.ObjectConnectorDistance(markerNumbers=[pivot, end], distance=1))
    weigh(system, body, [0, -GRAVITY, 0])
    return body


def rods(n):
    """Centres, velocities and spins of the cranks and couplers."""
    cranks = [([i, 0.5, 0], [0.5, 0, 0], -1) for i in range(n + 1)]
    return cranks + [([i + 0.5, 1, 0], [1, 0, 0], 0) for i in range(n)]


def hinges(n):
    """Pairs of bodies, by their numbers, and places; -1 is the ground."""
    feet = [(i, -1, [i, 0, 0]) for i in range(n + 1)]
    return feet + [(n + 1 + i, side, [side, 1, 0]) for i in range(n) for side in (i, i + 1)]


def four_bars(system, ground, n=2):
    """Four-bar linkages of bodies of the plane."""
    bodies = []
    for centre, velocity, spin in rods(n):
        node = system.AddNode(
            item.NodeRigidBody2D(
                referenceCoordinates=[*centre[:2], 0], initialVelocities=[*velocity[:2], spin]
            )
        )
        body = item.ObjectRigidBody2D(physicsMass=1, physicsInertia=1 / 12, nodeNumber=node)
        bodies.append(system.AddObject(body))
        weigh(system, bodies[-1], [0, -GRAVITY, 0])
    join(system, ground, n, bodies, item.ObjectJointRevolute2D, {})
    return bodies[0]


def four_bars_3d(system, ground, n=2):
    """Four-bar linkages of bodies of space."""
    bodies = []
    for number, (centre, velocity, spin) in enumerate(rods(n)):
        across, about = 1 / 12, 1e-3
        moments = [across, about, across] if number <= n else [about, across, across]
        inertia = RigidBodyInertia(mass=1, inertiaTensor=np.diag(moments))
        created = system.CreateRigidBody(
            inertia=inertia,
            referencePosition=centre,
            initialVelocity=velocity,
            initialAngularVelocity=[0, 0, spin],
            gravity=[0, -GRAVITY, 0],
            nodeType=exu.NodeType.RotationEulerParameters,
            returnDict=True,
        )
        bodies.append(created["bodyNumber"])
    join(system, ground, n, bodies, item.GenericJoint, {"constrainedAxes": [1, 1, 1, 1, 1, 0]})
    return bodies[0]


def join(system, ground, n, bodies, joint, settings):
    """Hinges between the rods."""
    centres = [rod[0] for rod in rods(n)]
    for first, second, place in hinges(n):
        markers = []
        for number in (first, second):
            body, centre = (ground, [0, 0, 0]) if number < 0 else (bodies[number], centres[number])
            local = [p - c for p, c in zip(place, centre)]
            markers.append(system.AddMarker(item.MarkerBodyRigid(bodyNumber=body, localPosition=local)))
        system.AddObject(joint(markerNumbers=markers, **settings))


def heavy_top(system, ground):
    """The heavy top on a spherical joint."""
    spin, centre = [0, 150, -4.61538], [0, 1, 0]
    created = system.CreateRigidBody(
        inertia=RigidBodyInertia(mass=15, inertiaTensor=np.diag([0.234375, 0.46875, 0.234375])),
        referencePosition=centre,
        initialVelocity=list(np.cross(spin, centre)),
        initialAngularVelocity=spin,
        gravity=[0, 0, -GRAVITY],
        nodeType=exu.NodeType.RotationEulerParameters,
        returnDict=True,
    )
    body = created["bodyNumber"]
    tip = system.AddMarker(item.MarkerBodyRigid(bodyNumber=body, localPosition=[0, -1, 0]))
    pivot = system.AddMarker(item.MarkerBodyRigid(bodyNumber=ground))
    system.AddObject(item.ObjectJointSpherical(markerNumbers=[pivot, tip]))
    return body


def weigh(system, body, gravity):
    """Gravity on a body."""
    marker = system.AddMarker(item.MarkerBodyMass(bodyNumber=body))
    system.AddLoad(item.LoadMassProportional(markerNumber=marker, loadVector=gravity))


def settings_of(problem, steps, tolerance):
    """Simulation settings: `steps` equal steps, nothing written."""
    settings = exu.SimulationSettings()
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = 1e9
    integration = settings.timeIntegration
    integration.numberOfSteps = steps
    integration.endTime = ENDS[problem]
    integration.automaticStepSize = False
    integration.adaptiveStep = False
    integration.verboseMode = 0
    integration.newton.relativeTolerance = tolerance
    integration.newton.absoluteTolerance = tolerance
    settings.linearSolverType = exu.LinearSolverType.EXUdense
    if problem.startswith("four-bars"):
        # Redundant constraints, and dead points where the cranks lie level.
        settings.linearSolverType = exu.LinearSolverType.EigenDense
        settings.linearSolver.ignoreSingularJacobian = True
    integration.generalizedAlpha.spectralRadius = 0.9
    return settings


SOLVERS = {
    "trapezoidal": exu.DynamicSolverType.TrapezoidalIndex2,
    "alpha": exu.DynamicSolverType.GeneralizedAlpha,
}
MODELS = {
    "pendulum": (pendulum, [0, 0, 0]),
    "four-bars": (four_bars, [0, 0.5, 0]),
    "four-bars-3d": (four_bars_3d, [0, 0.5, 0]),
    "heavy-top": (heavy_top, [0, 0, 0]),
}


def run(problem, solver, steps, tolerance):
    """Error of the position at the end, and CPU seconds; None if the solver fails."""
    container = exu.SystemContainer()
    system = container.AddSystem()
    ground = system.AddObject(item.ObjectGround())
    model, point = MODELS[problem]
    body = model(system, ground)
    system.Assemble()
    settings = settings_of(problem, steps, tolerance)
    begin = time.process_time()
    try:
        system.SolveDynamic(settings, solverType=SOLVERS[solver])
    except exu.SolverError:
        return None
    seconds = time.process_time() - begin
    place = np.asarray(system.GetObjectOutputBody(body, exu.OutputVariableType.Position, point))
    return float(np.linalg.norm(place - EXACT[problem])), seconds


def main(problem, solver, steps):
    """Run a problem and report."""
    tried = (run(problem, solver, int(steps), tolerance) for tolerance in (1e-10, 1e-8))
    found = next((result for result in tried if result), None)
    if not found:
        sys.exit(f"{problem}, {solver}, {steps} steps: the solver fails")
    error, seconds = found
    report = {"problem": problem, "solver": solver, "steps": int(steps), "error": error, "cpu_seconds": seconds}
    print(json.dumps(report))


if __name__ == "__main__":
    main(*sys.argv[1:])
