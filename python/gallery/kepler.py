# %% [markdown]
# # Kepler's problem
#
# Two masses that attract each other: a network of one link. Their orbit about each other is an ellipse with the
# semi-axis $a$, and closes after the period $2 \pi \sqrt{\mu a^3 / g}$. Here $g = G m_1 m_2$ is the strength, and
# $\mu = m_1 m_2 / (m_1 + m_2)$ the reduced mass.
#
# `DGM` conserves energy and angular momentum at every step size and degree. These fix the size and the shape of the
# ellipse, but not the direction of its axis: with coarse steps of degree 1 it turns.

# %%
import emmy
import matplotlib.pyplot as plt
import numpy as np
from pictures import finish

STAR, PLANET, STRENGTH = 2.0, 1.0, 6.0
mesh = emmy.Mesh.network([[0.5, 0, 0], [-1.0, 0, 0]], [[0, 1]], groups={"star": [0], "planet": [1]})
body = emmy.Body(
    mesh,
    emmy.Region(emmy.Attraction(strength=STRENGTH)),
    masses=[emmy.Mass("star", STAR), emmy.Mass("planet", PLANET)],
)
start = [emmy.Initial(group="star", velocity=(0, -0.5, 0)), emmy.Initial(group="planet", velocity=(0, 1, 0))]

# The ellipse, by the energy of the relative motion.
reduced = STAR * PLANET / (STAR + PLANET)
distance, speed = 1.5, 1.5
axis = 1 / (2 / distance - reduced * speed**2 / STRENGTH)
period = 2 * np.pi * np.sqrt(reduced * axis**3 / STRENGTH)
eccentricity = distance / axis - 1
print(f"semi-axis {axis:.6f}, eccentricity {eccentricity:.3f}, period {period:.6f}")


# %%
def orbit(degree, steps_per_period, revolutions=4):
    """Path of the planet about the star, a row for each step."""
    size = period / steps_per_period
    motion = emmy.Motion(body, "DGM", degree, steps=(revolutions * period, size), initial=start, tolerance=1e-13)
    path = [motion.positions[1] - motion.positions[0]]
    for _ in motion:
        path.append(motion.positions[1] - motion.positions[0])
    return np.array(path), motion.history


figure, axes = plt.subplots(1, 2, figsize=(7.4, 3.0), width_ratios=[1.4, 1])
angle = np.linspace(0, 2 * np.pi, 400)
axes[0].plot(
    axis * (np.cos(angle) - eccentricity), axis * np.sqrt(1 - eccentricity**2) * np.sin(angle),
    color="black", linewidth=4, alpha=0.15, label="ellipse",
)  # fmt: skip
for degree in (1, 2, 3):
    path, history = orbit(degree, 40)
    axes[0].plot(path[:, 0], path[:, 1], linewidth=0.8, label=f"degree {degree}")
    # Energy and angular momentum: to round-off, at each degree.
    assert np.ptp(history["total_energy"]) < 1e-10
    assert np.ptp(history["angular_momentum_z"]) < 1e-10
axes[0].plot(0, 0, "o", color="black")
axes[0].set(aspect="equal", title="Four revolutions, 40 steps each", xlim=(-1.6, 2.2))
axes[0].legend(loc="center right", fontsize=7)

# %% [markdown]
# The distance from the starting point after one period is the error of the scheme: of order 2, 4 and 6 in the step.

# %%
counts = np.array([100, 200, 400])
for degree in (1, 2, 3):
    errors = [np.linalg.norm(orbit(degree, n, 1)[0][-1] - [-distance, 0, 0]) for n in counts]
    order = np.log2(np.divide(errors[:-1], errors[1:]))
    axes[1].loglog(counts, errors, "o-", label=f"degree {degree}: order {order[-1]:.2f}")
    print(f"degree {degree}: errors after one period {np.array(errors)}, order {order}")
    assert abs(order[-1] - 2 * degree) < 0.3
axes[1].set(xlabel="steps per period", title="Error after one period", ylim=(1e-13, None))
axes[1].set_xticks(counts, [str(n) for n in counts], minor=False)
axes[1].minorticks_off()
axes[1].legend(fontsize=7)
finish(figure, "kepler")
