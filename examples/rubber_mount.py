"""The squeezed mount with a projected volume and with the standard formulation, side by side; run it where the book's runs are."""

import csv

import pyvista

plotter = pyvista.Plotter(off_screen=True, shape=(1, 2), window_size=(1200, 500), border=False)
for column, (run, name) in enumerate([("rubber-mount", "projected volume"), ("locked", "standard")]):
    with open(f"{run}/history.csv") as file:
        force = float(next(csv.DictReader(file))["z-max_force_z"])
    reader = pyvista.get_reader(f"{run}/{run}.pvd")
    reader.set_active_time_value(0.0)
    mount = reader.read()[0]
    print(f"{name}: force {force:.0f} N, pressures in cells from {mount['cell_pressure'].min():.1f} to {mount['cell_pressure'].max():.1f} MPa")
    # One half, so that the inner cells are seen.
    half = mount.extract_cells(mount.cell_centers().points[:, 1] > 20)
    plotter.subplot(0, column)
    plotter.add_text(f"{name}: {-force:.0f} N", font_size=12)
    bar = {"title": f"pressure, MPa ({name})", "n_labels": 3}
    plotter.add_mesh(half.warp_by_vector("displacement"), scalars="cell_pressure", show_edges=True, scalar_bar_args=bar)
    plotter.camera_position = [(45, -60, 45), (20, 30, 8), (0, 0, 1)]
plotter.screenshot("rubber-mount.png")
