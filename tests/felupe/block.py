"""Reference numbers of crates/emmy/tests/suite/equilibrium/felupe.rs, computed with felupe.

A block of rubber, clamped at x = 0, carries a dead traction at its end and a pressure on its top that follows the
surface; its cells, material and loads are those of the test. Run: python3 tests/felupe/block.py
"""

import felupe as fem
import numpy as np

LAMBDA, MU = 60.0, 30.0
TRACTION, PRESSURE = [0.5, 0.3, 0.8], 0.4

mesh = fem.Cube(b=(4, 1, 1), n=(9, 3, 3))
region = fem.RegionHexahedron(mesh)
field = fem.FieldContainer([fem.Field(region, dim=3)])
solid = fem.SolidBody(fem.NeoHookeCompressible(mu=MU, lmbda=LAMBDA), field)

x, y, z = mesh.points.T
top = fem.RegionHexahedronBoundary(mesh, mask=z > 1 - 1e-9, only_surface=True)
pressure = fem.SolidBodyPressure(fem.FieldContainer([fem.Field(top, dim=3)]))

# Shares of the end's area: 1/16 at corners, 1/8 at edges, 1/4 in the middle (2 x 2 cells).
end = np.flatnonzero(x > 4 - 1e-9)
share = lambda s: np.where(np.isclose(s, 0.5), 0.5, 0.25)
values = (share(y[end]) * share(z[end]))[:, None] * np.array(TRACTION)
dead = fem.PointLoad(field, end, values=values)

clamp = {"clamp": fem.Boundary(field[0], fx=0)}
n = 10
ramp = np.linspace(1 / n, 1, n)
step = fem.Step(
    items=[solid, pressure, dead],
    ramp={pressure: PRESSURE * ramp, dead: ramp[:, None, None] * values},
    boundaries=clamp,
)
fem.Job([step]).evaluate(tol=1e-11, verbose=0)

for corner in ([4, 0, 0], [4, 1, 0], [4, 0, 1], [4, 1, 1]):
    node = np.argmin(np.linalg.norm(mesh.points - corner, axis=1))
    print(corner, [f"{u:.12f}" for u in field[0].values[node]])
F = field.extract()[0]
J = np.linalg.det(np.moveaxis(F, (0, 1), (-2, -1)))
W = MU / 2 * ((F * F).sum(axis=(0, 1)) - 3) - MU * np.log(J) + LAMBDA / 2 * np.log(J) ** 2
print("strain energy", f"{(W * region.dV).sum():.12f}")
