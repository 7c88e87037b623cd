# %% [markdown]
# # A steel bracket, from Gmsh to PyVista
#
# An angle of spring steel, 6 mm thick, is held at its foot and struck at its tip with 2 kN for a millisecond. Lengths
# are in millimetres, masses in tonnes, times in seconds; so forces are in newtons and stresses in megapascals.

# %%
import emmy
import gmsh
import matplotlib.pyplot as plt
import numpy as np
from pictures import finish, plotter, screenshot

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ, model = gmsh.model.occ, gmsh.model
occ.fuse([(3, occ.addBox(0, 0, 0, 6, 30, 60))], [(3, occ.addBox(0, 0, 54, 60, 30, 6))])
occ.synchronize()


def faces(*box):
    """Surfaces inside of a box: its smallest and its largest corner."""
    return [tag for _, tag in model.getEntitiesInBoundingBox(*box, 2)]


model.addPhysicalGroup(3, [tag for _, tag in model.getEntities(3)], name="steel")
model.addPhysicalGroup(2, faces(-1, -1, -1, 7, 31, 1), name="foot")
model.addPhysicalGroup(2, faces(59, -1, 53, 61, 31, 61), name="tip")
gmsh.option.setNumber("Mesh.MeshSizeMax", 10.0)
gmsh.option.setNumber("Mesh.ElementOrder", 2)
model.mesh.generate(3)
mesh = emmy.Mesh.from_gmsh()
gmsh.finalize()
print(mesh, mesh.groups)

# %% [markdown]
# Steps are chosen by their error. The probe adds the path of the tip to the history.

# %%
YOUNG, DENSITY = 210e3, 7.85e-9
steel = emmy.SaintVenantKirchhoff(youngs_modulus=YOUNG, poissons_ratio=0.3)


def bracket(history):
    """The bracket with a force on its tip."""
    return emmy.Body(
        mesh,
        emmy.Region(steel, density=DENSITY, group="steel"),
        emmy.Support("foot", fix="xyz"),
        emmy.Load("tip", force=(0, 0, -2000), history=history),
    )


body = bracket([(0, 0), (5e-4, 1), (1e-3, 0)])
motion = emmy.Motion(body, "DGM", until=5e-3, adaptive=1e-3, probes={"tip": (60, 15, 60)})
motion.run(until=9e-4)
grid = motion.to_pyvista("von_mises_stress")
history = motion.run()
print(f"{motion.number} steps; the tip goes down by {60 - history['tip_z'].min():.2f} mm")

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 2.5), width_ratios=[1.6, 1])
left.plot(1e3 * history["time"], history["tip_z"] - 60)
left.set(xlabel="time in ms", ylabel="mm", title="Deflection of the tip")
right.plot(1e3 * history["time"][1:], 1e6 * history["step_size"][1:], ".-", markersize=3, linewidth=0.5)
right.set(xlabel="time in ms", ylabel="microseconds", title="Step size", ylim=(0, None))
finish(figure, "bracket-tip")

view = plotter(window_size=(860, 560))
view.background_color = "white"
bar = {"title": "von Mises, MPa\n", "n_labels": 3, "fmt": "%.0f", "color": "black", "vertical": True,
       "position_x": 0.86, "position_y": 0.25, "title_font_size": 15, "label_font_size": 15}  # fmt: skip
bent = grid.warp_by_vector("displacement", factor=3)
view.add_mesh(bent, scalars="von_mises_stress", cmap="viridis", lighting=False, scalar_bar_args=bar)
view.add_mesh(grid.extract_feature_edges(), color="grey")
view.camera_position = [(115, -130, 80), (42, 15, 30), (0, 0, 1)]
screenshot(view, "bracket-stress")

# %% [markdown]
# Three numbers from elsewhere. Two beams of 30 x 6 mm^2 bend by $F a^3/(3 E I) + F a^2 h/(E I)$ under a force at rest.
# The free bracket rings in its lowest mode, so its tip passes the rest position once a period. And once the load has
# gone, the energy is constant.

# %%
arm, inertia = 57.0, 30 * 6**3 / 12
beams = 2000 * arm**3 * (1 / 3 + 1) / (YOUNG * inertia)
rest = emmy.equilibrium(bracket(1))
sag = -rest.displacement[mesh.nearest_node((60, 15, 60)), 2]
print(f"at rest under 2 kN: {sag:.2f} mm; two beams: {beams:.2f} mm")
assert abs(sag / beams - 1) < 0.1

modes = emmy.modes(body, count=3)
free = history[history["time"] > 1e-3]
tip = free["tip_z"] - 60
rising = np.nonzero((tip[:-1] < 0) & (tip[1:] >= 0))[0]
times = free["time"][rising] - tip[rising] * np.diff(free["time"])[rising] / np.diff(tip)[rising]
print(f"period {1e3 * np.diff(times).mean():.3f} ms; lowest mode {1e3 / modes.frequencies[0]:.3f} ms")
assert abs(np.diff(times).mean() * modes.frequencies[0] - 1) < 0.05
assert np.ptp(free["total_energy"]) < 1e-10 * free["total_energy"][0]
