# %% [markdown]
# # Orders of convergence by a sweep
#
# Time elements of degree $k$ are of order $2k$. `emmy.sweep` calls a function with every combination of degree and
# step size, runs the motions side by side on threads, and makes a table with the last row of each history and with
# whatever `measure` adds.

# %%
import emmy
import matplotlib.pyplot as plt
import numpy as np
from pictures import finish

mesh = emmy.Mesh.box((1, 2, 1), (1, 2, 1))
block = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=20.0, mu=10.0), density=1.0))
initial = emmy.Initial(angular_velocity=(0.5, 1.0, 2.0), gradient=np.diag([0.6, -0.6, 0.0]))
corner = mesh.nearest_node((1, 2, 1))


def make(degree, size, scheme="DGM"):
    return emmy.Motion(block, scheme, degree, steps=(1.0, size), initial=initial, tolerance=1e-13)


def place(motion):
    return dict(zip("xyz", motion.positions[corner], strict=True))


reference = make(4, 0.01)
reference.run()
exact = reference.positions[corner]

sizes = [0.1, 0.05, 0.025, 0.0125]
study = emmy.sweep(make, {"degree": [1, 2, 3], "size": sizes}, measure=place)
assert not study.failures

# %% [markdown]
# The table is a structured array, ready for pandas. The order is the slope between the two smallest steps whose error
# is above round-off.

# %%
table = study.table
error = np.linalg.norm(np.stack([table[axis] for axis in "xyz"], axis=1) - exact, axis=1)
figure, axes = plt.subplots(figsize=(4.6, 3.0))
for degree in (1, 2, 3):
    own = error[table["degree"] == degree]
    used = own[own > 1e-11]
    order = np.log2(used[-2] / used[-1])
    axes.loglog(sizes, own, "o-", markersize=3, label=f"degree {degree}: order {order:.2f}")
    print(f"degree {degree}: errors {own}, order {order:.3f}")
    assert abs(order - 2 * degree) < 0.2
axes.set(xlabel="step size", ylabel="error of a corner", title="Orders of DGM")
axes.set_xticks(sizes, map(str, sizes))
axes.minorticks_off()
axes.legend()
finish(figure, "orders")

# Conserved at every size and degree; the measured scatter is round-off.
assert np.ptp(table["total_energy"]) < 1e-11 * table["total_energy"][0]
