# %% [markdown]
# # The block of Betsch and Steinmann
#
# An L-shaped block of rubber is pushed by two opposite tractions for one unit of time and then flies. The resultant of
# the loads is zero, so its centre of mass rests; its energy and angular momentum are constant once the loads have gone.
# Strains are large, and the step, 0.04, is far longer than the periods of the fastest modes.
#
# Three schemes of second order do the same steps: the mid-point rule `FE(1)`, the assumed strain method `AS(5)` of the
# paper (2001), and the discrete gradient `DGM`.

# %%
import emmy
import matplotlib.pyplot as plt
import numpy as np
from pictures import finish

force = np.array([256.0, 512.0, 768.0])
hat = [(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)]
body = emmy.Body(
    emmy.Mesh.l_block(cell_size=1.0),
    emmy.Region(emmy.NeoHooke(lambda_=1000.0, mu=500.0), density=0.5),
    loads=[
        emmy.Load("face-a", traction=force / 9, history=hat),
        emmy.Load("face-b", traction=-force / 9, history=hat),
    ],
)
histories = {}
for scheme in ("FE(1)", "AS(5)", "DGM"):
    motion = emmy.Motion(body, scheme=scheme, steps=[(1.0, 0.01), (8.0, 0.04)])
    histories[scheme] = motion.run()

# %% [markdown]
# `motion.history` is a structured NumPy array with the columns of `history.csv`. Momenta are conserved by all three
# schemes; the energy only by the last two.

# %%
figure, (left, middle, right) = plt.subplots(1, 3, figsize=(8.6, 2.6))
for scheme, history in histories.items():
    free = history[history["time"] >= 1.0]
    change = 100 * (free["total_energy"] / free["total_energy"][0] - 1)
    middle.plot(free["time"], change, "--" if scheme == "DGM" else "-", label=scheme)
middle.set(xlabel="time", title="Change of T + V in flight, %")
middle.legend()
history = histories["DGM"]
for name, key in {"T + V": "total_energy", "T": "kinetic_energy", "V": "strain_energy"}.items():
    left.plot(history["time"], history[key], label=name)
left.set(xlabel="time", title="Energies, DGM", ylim=(-300, 9500))
left.legend(ncols=3, columnspacing=1.0, loc="upper right")
for axis in "xyz":
    right.plot(history["time"], history[f"angular_momentum_{axis}"], label=f"$L_{axis}$")
right.set(xlabel="time", title="Angular momentum, DGM")
right.legend()
finish(figure, "block")

# %% [markdown]
# Theory asks for three things. Opposite forces leave the linear momentum at zero. Without a moment the angular momentum
# stays, without work the energy. And the energy is the work of the loads.

# %%
drift = {}
for scheme, history in histories.items():
    free = history[history["time"] >= 1.0]
    drift[scheme] = np.ptp(free["total_energy"]) / free["total_energy"][0]
    turns = np.stack([free[f"angular_momentum_{axis}"] for axis in "xyz"])
    pushed = np.stack([history[f"linear_momentum_{axis}"] for axis in "xyz"])
    turned = np.ptp(turns, axis=1).max() / np.abs(turns).max()
    print(f"{scheme:6} relative change in free flight: energy {drift[scheme]:.1e}, angular momentum {turned:.1e}")
    assert turned < 1e-10
    assert np.abs(pushed).max() < 1e-9
    if scheme != "FE(1)":
        assert abs(free["total_energy"][-1] - free["external_work"][-1]) < 1e-9 * free["external_work"][-1]
assert drift["DGM"] < 1e-12 and drift["AS(5)"] < 1e-10 and drift["FE(1)"] > 1e-3
