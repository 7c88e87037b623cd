"""The squeezed mount with a projected volume and with the standard formulation, side by side; run it where the book's runs are."""

import csv

import pyvista

plotter = pyvista.Plotter(off_screen=True, shape=(1, 2), window_size=(1200, 460), border=False)
for column, (run, name) in enumerate([("rubber-mount", "projected volume"), ("locked", "standard")]):
    with open(f"{run}/history.csv") as file:
        force = float(next(csv.DictReader(file))["z-max_force_z"])
    reader = pyvista.get_reader(f"{run}/{run}.pvd")
    reader.set_active_time_value(0.0)
    mount = reader.read()[0]
    print(f"{name}: force {force:.0f} N, pressures in cells from {mount['cell_pressure'].min():.2f} to {mount['cell_pressure'].max():.2f} MPa")
    # One half, so that the inner cells are seen.
    half = mount.extract_cells(mount.cell_centers().points[:, 1] > 20)
    plotter.subplot(0, column)
    plotter.add_text(f"{name}: {-force:.0f} N", font_size=10)
    bar = {"title": f"pressure in MPa, {name}", "n_labels": 2, "title_font_size": 16, "label_font_size": 16}
    plotter.add_mesh(half.warp_by_vector("displacement"), scalars="cell_pressure", show_edges=True, lighting=False, scalar_bar_args=bar)
    plotter.camera_position = [(35, -100, 35), (20, 20, 6), (0, 0, 1)]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = 19
plotter.screenshot("rubber-mount.png")
