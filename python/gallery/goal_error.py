# %% [markdown]
# # The error of a goal
#
# How large is the error of the tip of a beam after three units of time, by the steps in time? `motion.goal_error`
# estimates it from one adjoint motion, step by step; here it is compared with the true error, from a much finer motion.

# %%
import emmy
import matplotlib.pyplot as plt
import numpy as np
from pictures import finish


def pulse(t):
    """Without kinks, which would excite modes that no step resolves."""
    return np.sin(0.5 * np.pi * t) ** 4 if t < 2 else 0.0


beam = emmy.Body(
    emmy.Mesh.box((4, 1, 1), (4, 1, 1)),
    emmy.Region(emmy.NeoHooke(lambda_=600.0, mu=300.0), density=1.0),
    emmy.Support("x-min", fix="xyz"),
    emmy.Load("x-max", traction=(0, 8, 3), history=pulse),
)
goal = emmy.Goal.displacement_at(beam, node=beam.mesh.nearest_node((4, 1, 1)), direction=(0, 1, 0))


def moved(degree, size, adjoint=True):
    motion = emmy.Motion(beam, "DGM", degree, steps=(3.0, size), tolerance=1e-12, adjoint=adjoint)
    motion.run()
    return motion


exact = goal.value(moved(4, 0.025, adjoint=False))

# %%
sizes = np.array([0.12, 0.06, 0.03])
true, estimated = np.zeros((2, 3)), np.zeros((2, 3))
for row, degree in enumerate((1, 2)):
    for column, size in enumerate(sizes):
        motion = moved(degree, size)
        error = motion.goal_error(goal)
        true[row, column] = goal.value(motion) - exact
        estimated[row, column] = error.total
        print(f"degree {degree}, h = {size}: true {true[row, column]:+.3e}, estimated {error.total:+.3e}")
        if (degree, size) == (2, 0.03):
            parts = error.steps

# %% [markdown]
# The ratio of both tends to one, and each error falls with its order, 2 and 4. The estimate has a sign: subtract it for
# a better value. The contributions of the steps (here of degree 2, h = 0.03) show where smaller steps pay.

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 2.7))
for row, degree in enumerate((1, 2)):
    (line,) = left.loglog(sizes, np.abs(true[row]), "o-", label=f"degree {degree}: true")
    left.loglog(sizes, np.abs(estimated[row]), "x--", color=line.get_color(), label="estimated")
left.set(xlabel="step size", title="Error of the tip")
left.set_xticks(sizes, map(str, sizes))
left.minorticks_off()
left.legend(fontsize=7)
right.stairs(parts, np.linspace(0.0, 3.0, len(parts) + 1), fill=True)
right.set(xlabel="time", title="Contributions of the steps")
finish(figure, "goal-error")

ratio = estimated / true
assert np.abs(ratio[:, -1] - 1).max() < 0.1
for row, degree in enumerate((1, 2)):
    order = np.log2(np.abs(true[row, -2] / true[row, -1]))
    print(f"degree {degree}: order {order:.2f}; estimated over true {ratio[row]}")
    assert abs(order - 2 * degree) < 0.4
