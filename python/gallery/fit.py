# %% [markdown]
# # Material parameters from a measured motion
#
# A beam of rubber is held at one end and pushed at the other. From the places of two nodes at its tip after three
# units of time we find both Lamé parameters, with `scipy.optimize.least_squares`. The Jacobian comes from the discrete
# adjoint: one motion backwards for each measured number, whatever the number of parameters.

# %%
import emmy
import matplotlib.pyplot as plt
import numpy as np
import scipy.optimize
from pictures import finish


def pulse(t):
    """Without kinks, which would excite modes that no step resolves."""
    return np.sin(0.5 * np.pi * t) ** 4 if t < 2 else 0.0


mesh = emmy.Mesh.box((4, 1, 1), (4, 1, 1))
nodes = [mesh.nearest_node(corner) for corner in [(4, 0, 0), (4, 1, 1)]]


def beam(lam, mu):
    return emmy.Body(
        mesh,
        emmy.Region(emmy.NeoHooke(lambda_=lam, mu=mu), density=1.0),
        emmy.Support("x-min", fix="xyz"),
        emmy.Load("x-max", traction=(0, 8, 3), history=pulse),
    )


def moved(p, degree=2, size=0.06, adjoint=False):
    motion = emmy.Motion(beam(*p), "DGM", degree, steps=(3.0, size), tolerance=1e-12, adjoint=adjoint)
    motion.run()
    return motion


# %% [markdown]
# The "measurement" is a motion with much finer steps of a higher degree, so that the fit has an error of its own: that
# of its steps.

# %%
TRUE = np.array([600.0, 300.0])
measured = moved(TRUE, degree=3, size=0.025).displacement[nodes]
track = []


def misfit(p):
    motion = moved(p, adjoint=True)
    parameters = [
        emmy.Parameter(p[0], lambda lam: beam(lam, p[1])),
        emmy.Parameter(p[1], lambda mu: beam(p[0], mu)),
    ]
    rows = []
    for node in nodes:
        for direction in np.eye(3):
            goal = emmy.Goal.displacement_at(motion.body, node, direction)
            rows.append(motion.gradient(goal, parameters).parameters)
    jacobian[:] = rows
    track.append(p.copy())
    return (motion.displacement[nodes] - measured).ravel()


jacobian = np.zeros((6, 2))
start = np.array([900.0, 240.0])
fit = scipy.optimize.least_squares(misfit, start, jac=lambda p: jacobian.copy(), x_scale=TRUE, xtol=1e-10)
print(f"lambda, mu = {fit.x} after {fit.nfev} motions; true {TRUE}; misfit {np.sqrt(2 * fit.cost):.1e}")

# %% [markdown]
# The Jacobian agrees with differences of whole motions. The parameters agree with the true ones up to the error of the
# steps, where the curves below end: bending hardly depends on $\lambda$, so this error counts more there.

# %%
misfit(fit.x)
for index in range(2):
    shift = np.zeros(2)
    shift[index] = 1e-4 * fit.x[index]
    difference = (moved(fit.x + shift).displacement[nodes] - moved(fit.x - shift).displacement[nodes]).ravel()
    assert np.allclose(jacobian[:, index], difference / (2 * shift[index]), rtol=1e-4, atol=1e-9)
assert np.abs(fit.x / TRUE - 1).max() < 5e-3
track.pop()

figure, axes = plt.subplots(figsize=(4.6, 2.8))
errors = np.abs(np.array(track) / TRUE - 1)
for index, name in enumerate([r"$\lambda$", r"$\mu$"]):
    axes.semilogy(range(1, len(errors) + 1), errors[:, index], "o-", markersize=3, label=name)
axes.set(xlabel="motion", ylabel="relative error", title="Lamé parameters from the tip")
axes.legend()
finish(figure, "fit")
