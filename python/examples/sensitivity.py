"""The tip of a beam by its material: value, gradient and estimated error, from one adjoint motion."""

import emmy
import numpy as np


def push(points, t):
    """Without kinks, which would excite modes that no step resolves."""
    strength = np.sin(0.5 * np.pi * t) ** 4 if t < 2 else 0.0
    return np.tile([0.0, 8.0 * strength, 3.0 * strength], (len(points), 1))


def beam(lam, mu):
    return emmy.Body(
        emmy.Mesh.box((4, 1, 1), (4, 1, 1)),
        emmy.Region(emmy.NeoHooke(lambda_=lam, mu=mu), density=1.0),
        emmy.Support("x-min", fix="xyz"),
        emmy.Load("x-max", traction=push),
    )


body = beam(600.0, 300.0)
goal = emmy.Goal.displacement_at(body, node=body.mesh.nearest_node((4, 1, 1)), direction=(0, 1, 0))
def tip(p):
    motion = emmy.Motion(beam(*p), scheme="DGM", degree=2, steps=[(3.0, 0.1)], tolerance=1e-12, adjoint=True)
    motion.run()
    gradient = motion.gradient(goal, [emmy.Parameter(p[0], lambda lam: beam(lam, p[1])), emmy.Parameter(p[1], lambda mu: beam(p[0], mu))])
    return goal.value(motion) , gradient.parameters      # for scipy.optimize.minimize(..., jac=True)

motion = emmy.Motion(body, scheme="DGM", degree=2, steps=[(3.0, 0.1)], tolerance=1e-12, adjoint=True)
motion.run()
motion.goal_error(goal).total                            # estimated error of the tip
