# %% [markdown]
# # A rubber mount
#
# A block of rubber, 40 x 40 x 20 mm, between two steel plates: pressed by 3 mm, then sheared back and forth at 50 Hz.
# Rubber changes its shape two thousand times more easily than its volume, and ordinary cells *lock*. The formulation
# `projected-volume` prevents locking and keeps all balances.
#
# This script works with an input file, the template `rubber-mount`. `emmy.run` writes what `emmy run` writes; `set`
# changes keys of the file.

# %%
import tempfile
from pathlib import Path

import emmy
import numpy as np
from pictures import plotter, screenshot

folder = Path(tempfile.mkdtemp())
template = emmy.new("rubber-mount").rename(folder / "rubber-mount.toml")
runs = {
    "projected volume": emmy.run(template, output=folder / "projected"),
    "standard": emmy.run(template, set={"region.0.formulation": "standard"}, until=2e-3, output=folder / "standard"),
}

# %% [markdown]
# The first row of the column `z-max_force_z` is the force of the upper plate in equilibrium. FElupe, another program,
# has -800.10 N and -19,156.4 N with the same cells: the ordinary ones are 24 times too stiff.

# %%
force = {name: run.history["z-max_force_z"][0] for name, run in runs.items()}
for name, value in force.items():
    print(f"{name:18} {value:12.3f} N")
assert abs(force["projected volume"] + 800.10) < 0.01
assert abs(force["standard"] + 19_156.4) < 0.1

history = runs["projected volume"].history
stored = history["total_energy"] - history["total_energy"][0]
assert np.abs(stored - history["external_work"]).max() < 1e-11 * history["total_energy"][0]

# %% [markdown]
# `frames` are the frames of the run; `frames[0]` is the equilibrium. One half of each mount shows the pressure in the
# cells.

# %%
view = plotter(shape=(1, 2), window_size=(1000, 420))
view.background_color = "white"
for column, (name, run) in enumerate(runs.items()):
    grid = run.frames[0].to_pyvista()
    half = grid.extract_cells(grid.cell_centers().points[:, 1] > 20)
    bar = {"title": f"pressure in MPa, {name}", "n_labels": 2, "fmt": "%.1f", "color": "black",
           "label_font_size": 16, "title_font_size": 16}  # fmt: skip
    view.subplot(0, column)
    view.add_text(f"{name}: {-force[name]:.0f} N", font_size=10, color="black")
    bent = half.warp_by_vector("displacement")
    view.add_mesh(bent, scalars="cell_pressure", show_edges=True, lighting=False, scalar_bar_args=bar)
    view.camera_position = [(35, -100, 35), (20, 20, 6), (0, 0, 1)]
    view.enable_parallel_projection()
    view.camera.parallel_scale = 22
screenshot(view, "rubber-mount")
