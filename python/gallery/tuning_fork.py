# %% [markdown]
# # The spectrum of a tuning fork
#
# One tine of a steel fork is struck. The spectrum of its tip has peaks at the natural frequencies, which `emmy.modes`
# computes from stiffness and mass.

# %%
import emmy
import gmsh
import matplotlib.pyplot as plt
import numpy as np
from pictures import finish

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
handle = occ.addBox(-2, -30, -2, 4, 32, 4)
tines = [occ.addBox(-7, 0, -2, 14, 5, 4), occ.addBox(-7, 5, -2, 4, 55, 4), occ.addBox(3, 5, -2, 4, 55, 4)]
occ.fuse([(3, handle)], [(3, part) for part in tines])
occ.synchronize()
ends = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(-9, -31, -9, 9, -29, 9, 2)]
gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="steel")
gmsh.model.addPhysicalGroup(2, ends, name="handle-end")
gmsh.option.setNumber("Mesh.MeshSizeMax", 9.0)
gmsh.option.setNumber("Mesh.ElementOrder", 2)
gmsh.model.mesh.generate(3)
mesh = emmy.Mesh.from_gmsh()
gmsh.finalize()

fork = emmy.Body(
    mesh,
    emmy.Region(emmy.NeoHooke(youngs_modulus=210e3, poissons_ratio=0.3), density=7.85e-9, group="steel"),
    emmy.Support("handle-end", fix="xyz"),
)
modes = emmy.modes(fork, count=4)
print(fork.n_dofs, "degrees of freedom; frequencies in Hz:", np.round(modes.frequencies, 2))

# %% [markdown]
# Initial velocities may be an array, here of one tine: 0.2 m/s at its tip, along x and a third of it along z. The
# displacements are small, so the motion is a sum of modes.

# %%
points = mesh.points
velocity = np.zeros_like(points)
struck = (points[:, 0] > 0) & (points[:, 1] > 5)
height = (points[struck, 1, None] - 5) / 55
velocity[struck] = 200.0 * height**2 * [1.0, 0.0, 1 / 3]

size, count = 4e-5, 512
motion = emmy.Motion(fork, "DGM", steps=(count * size, size), initial=velocity, probes={"tip": (7, 60, 2)})
history = motion.run()
path = np.stack([history["tip_x"], history["tip_z"]], axis=1)[:count]

# %% [markdown]
# `DGM` of degree 1 turns a linear oscillator with $\omega h$ a step by the angle $2 \arctan(\omega h / 2)$ in place of
# $\omega h$. So theory says where the line of each mode lies.

# %%
window = np.blackman(count + 1)[:count, None]
amplitude = np.abs(np.fft.rfft(window * (path - path.mean(axis=0)), 32 * count, axis=0))
frequency = np.fft.rfftfreq(32 * count, size)
amplitude, frequency = amplitude[frequency < 1300] / amplitude.max(), frequency[frequency < 1300]
expected = np.arctan(np.pi * modes.frequencies * size) / (np.pi * size)
# Each mode is seen along the axis in which it moves the tip.
tip = mesh.nearest_node((7, 60, 2))
along = np.argmax(np.abs(modes.shapes[:, tip][:, [0, 2]]), axis=1)

figure, axes = plt.subplots(figsize=(7.4, 2.8))
for axis, name in enumerate("xz"):
    axes.semilogy(frequency, amplitude[:, axis], label=f"tip, {name}")
for number, line in enumerate(expected):
    axes.axvline(line, color="black", linewidth=0.6, linestyle=":", label="modes" if number == 0 else None)
axes.set(xlim=(0, 1300), ylim=(1e-4, 3), xlabel="Hz", title="Spectrum of a tine")
axes.legend(loc="upper center")
finish(figure, "tuning-fork")

# %%
for number, line in enumerate(expected):
    near = np.abs(frequency - line) < 40
    peak = frequency[near][amplitude[near, along[number]].argmax()]
    exact = modes.frequencies[number]
    print(f"mode {number + 1}: {exact:7.2f} Hz, with this step {line:7.2f} Hz, in the spectrum {peak:7.2f} Hz")
    assert abs(peak - line) < 3.0
# A clamped tine alone would ring at 1105 Hz (Euler and Bernoulli); the yoke gives way.
tine = 1.8751**2 / (2 * np.pi) * np.sqrt(210e3 / (12 * 7.85e-9)) * 4 / 55**2
assert 0.8 < modes.frequencies[3] / tine < 1.0
