"""Rubber mount and beam by FElupe and NumPy: the numbers that `examples.rs` compares with. Needs `pip install felupe`.

FElupe's `ThreeFieldVariation` on trilinear hexahedra has one pressure and one volume ratio in each cell, as
formulation = "projected-volume" has.
"""

import felupe as fem
import numpy as np

SHEAR = 0.5


def items(mesh, projected, bulk):
    """The body, and its fields."""
    region = fem.RegionHexahedron(mesh)
    material = fem.NeoHooke(mu=SHEAR, bulk=bulk)
    if projected:
        fields = fem.FieldsMixed(region, n=3)
        return fem.SolidBody(fem.ThreeFieldVariation(material), fields), fields
    fields = fem.FieldContainer([fem.Field(region, dim=3)])
    return fem.SolidBody(material, fields), fields


def mount(projected):
    """Force on the upper plate, pressed down by 3 mm."""
    body, fields = items(fem.Cube(a=(0, 0, 0), b=(40, 40, 20), n=(7, 7, 5)), projected, 1000.0)
    bounds = {
        "foot": fem.Boundary(fields[0], fz=0.0),
        "sideways": fem.Boundary(fields[0], fz=20.0, skip=(0, 0, 1)),
        "down": fem.Boundary(fields[0], fz=20.0, skip=(1, 1, 0)),
    }
    move = fem.math.linsteps([0, -3.0], num=5)[1:]
    step = fem.Step(items=[body], ramp={bounds["down"]: move}, boundaries=bounds)
    for state in step.generate(x0=fields, verbose=0, tol=1e-11):
        force = fem.tools.force(state.x, state.fun, bounds["down"])
    return force[2]


def beam(projected, n):
    """Deflection of a corner of the end; `n`: cells over the thickness."""
    mesh = fem.Cube(a=(0, 0, 0), b=(10, 100, 10), n=(n + 1, 10 * n + 1, n + 1))
    body, fields = items(mesh, projected, 2500.0)
    end = np.flatnonzero(mesh.points[:, 1] > 100 - 1e-9)
    share = np.where(np.isin(mesh.points[end][:, [0, 2]], (0.0, 10.0)), 0.5, 1.0).prod(axis=1) / n**2
    load = fem.PointLoad(fields, end, values=np.outer(share, [0.0, 0.0, 3.74975e-3]))
    bounds = {"clamp": fem.Boundary(fields[0], fy=0.0)}
    dof0, dof1 = fem.dof.partition(fields, bounds)
    start = fem.dof.apply(fields, bounds, dof0)
    fem.newtonraphson(items=[body, load], dof0=dof0, dof1=dof1, ext0=start, verbose=0, tol=1e-6, maxiter=30)
    return fields[0].values[mesh.points.sum(axis=1).argmax()][2]


def beam_with_modes(length=10.0, n=10, bulk=2500.0, load=3.74975e-3):
    """Deflection of a row of cubes with incompatible modes, clamped at one end, at small strain (NumPy)."""
    corners = np.array([[a, b, c] for b in (0, 1) for a in (0, 1) for c in (0, 1)]) * 2.0 - 1.0
    lame = bulk - 2 / 3 * SHEAR
    matrix = np.zeros((33, 33))
    for point in corners / np.sqrt(3.0):
        factors = 1 + corners * point
        gradients = [corners[:, i] * np.delete(factors, i, axis=1).prod(axis=1) / 8 for i in range(3)]
        # The modes are xi_m^2/2.
        gradients = np.vstack([np.transpose(gradients), np.diag(point)]) * 2 / length
        strains = np.einsum("Aj,ik->Akij", gradients, np.eye(3)).reshape(33, 3, 3)
        strains = (strains + strains.transpose(0, 2, 1)) / 2
        traces = np.einsum("aii->a", strains)
        energy = 2 * SHEAR * np.einsum("aij,bij->ab", strains, strains) + lame * np.outer(traces, traces)
        matrix += energy * (length / 2) ** 3
    cell, inner = slice(0, 24), slice(24, 33)
    matrix = matrix[cell, cell] - matrix[cell, inner] @ np.linalg.solve(matrix[inner, inner], matrix[inner, cell])
    stiffness = np.zeros((12 * (n + 1), 12 * (n + 1)))
    for i in range(n):
        own = slice(12 * i, 12 * i + 24)
        stiffness[own, own] += matrix
    force = np.zeros(12 * (n + 1))
    force[-10::3] = load / 4
    return np.linalg.solve(stiffness[12:, 12:], force[12:])[-1]


for projected in (True, False):
    print(f"mount, projected {projected}: {mount(projected):.6f} N")
print(f"beam with incompatible modes, at small strain: {beam_with_modes():.6f} mm")
for projected, n in ((False, 1), (True, 1), (True, 2), (True, 4), (True, 6)):
    print(f"beam, projected {projected}, {n} over the thickness: {beam(projected, n):.8f} mm", flush=True)
