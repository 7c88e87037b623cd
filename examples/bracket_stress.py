"""The frame with the largest von Mises stress, as a picture; run it where `emmy run bracket.toml` was run.

Another run is named behind it: `python bracket_stress.py steel-bracket`.
"""

import sys

import pyvista

name = sys.argv[1] if len(sys.argv) > 1 else "bracket"
reader = pyvista.get_reader(f"{name}/{name}.pvd")


def frame(time):
    reader.set_active_time_value(time)
    return reader.read()[0]


peaks = [(frame(time)["von_mises_stress"].max(), time) for time in reader.time_values]
stress, time = max(peaks)
print(f"largest von Mises stress at a node: {stress:.0f} MPa at {1e3 * time:.2f} ms")

plotter = pyvista.Plotter(off_screen=True)
plotter.add_mesh(frame(time).warp_by_vector("displacement", factor=5), scalars="von_mises_stress", scalar_bar_args={"vertical": True, "title": "MPa", "position_x": 0.85})
plotter.camera_position = "iso"
plotter.screenshot(f"{name}.png")
