"""Frames as PyVista and h5py read them, against numbers from theory.

    pip install -r crates/emmy-cli/tests/pyvista/requirements.txt
    cargo build -p emmy-cli
    python crates/emmy-cli/tests/pyvista/frames.py target/debug/emmy

A block whose nodes all lie on two faces, one held and one moved: F is known at every time and place, and with it every field.
"""

import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np
import pyvista
import vtk
from numpy.testing import assert_allclose, assert_array_equal

LAMBDA, MU, DENSITY = 1000.0, 500.0, 2.0

SHEARED = f"""
mesh.box = {{ size = [1, 2, 1], cells = [1, 3, 2] }}
region = [{{ density = {DENSITY}, material.neo-hooke = {{ lambda = {LAMBDA}, mu = {MU} }} }}]
time = {{ scheme = "DGM", steps = [{{ until = 1.0, size = 0.25 }}] }}
support = [
    {{ group = "x-min", fix = ["x", "y", "z"] }},
    {{ group = "x-max", fix = ["z"], move = {{ x = "0.3*t", y = "0.2*t" }} }},
]
"""

LONG = """
mesh.box = { size = [1, 1, 1], cells = [4, 4, 4] }
region = [{ density = 1, material.neo-hooke = { lambda = 10, mu = 5 } }]
initial = { angular_velocity = [0, 0, 1] }
time = { scheme = "DGM", steps = [{ until = 1e4, size = 0.01 }] }
# A frame in each step, although all of them would be large.
output = { every = 1, precision = "double", fields = ["displacement", "cauchy_stress"] }
"""

DOOR = """
rigid = [
    { name = "door", mass = 20, centre = [0.5, 0, 1], inertia = [7, 9, 3] },
    { name = "ball", mass = 1, centre = [2, 0, 0] },
]
joint = [{ name = "hinge", revolute = { between = ["door", "ground"], at = [0, 0, 1], axis = [0, 0, 1] }, angle = "t^2" }]
load = [{ acceleration = [0, 0, -2] }]
time = { scheme = "DGM", degree = 2, steps = [{ until = 1.0, size = 0.25 }] }
"""

COMPONENTS = {
    "displacement": 3,
    "velocity": 3,
    "momentum_density": 3,
    "cauchy_stress": 6,
    "second_piola_kirchhoff_stress": 6,
    "von_mises_stress": 1,
    "principal_stretches": 3,
    "strain_energy_density": 1,
}
CELLS = ["cell_cauchy_stress", "cell_strain_energy_density", "cell_volume_ratio"]
# VTK's order of symmetric tensors.
PAIRS = ([0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2])


def expected(t, points):
    """All fields at a time: neo-Hookean material at F = I + t (0.3 e1 + 0.2 e2) (x) e1."""
    rate = np.outer([0.3, 0.2, 0.0], [1.0, 0.0, 0.0])
    F = np.eye(3) + t * rate
    J, C = np.linalg.det(F), F.T @ F
    cauchy = (MU * (F @ F.T - np.eye(3)) + LAMBDA * np.log(J) * np.eye(3)) / J
    second = J * np.linalg.inv(F) @ cauchy @ np.linalg.inv(F).T
    deviator = cauchy - np.trace(cauchy) / 3 * np.eye(3)
    energy = MU / 2 * (np.trace(C) - 3) - MU * np.log(J) + LAMBDA / 2 * np.log(J) ** 2
    # The block starts from rest, and then has the velocity of its faces.
    velocity = points @ rate.T
    return {
        "displacement": t * points @ rate.T,
        "velocity": velocity,
        "momentum_density": DENSITY * velocity,
        "cauchy_stress": cauchy[PAIRS],
        "second_piola_kirchhoff_stress": second[PAIRS],
        "von_mises_stress": np.sqrt(1.5 * np.sum(deviator**2)),
        "principal_stretches": np.linalg.svd(F, compute_uv=False),
        "strain_energy_density": energy,
        "cell_cauchy_stress": cauchy[PAIRS],
        "cell_strain_energy_density": energy,
        "cell_volume_ratio": J,
    }


def check(grid, t):
    """A frame against theory: names, shapes, numbers."""
    values = expected(t, grid.points)
    assert set(COMPONENTS) <= set(grid.point_data), list(grid.point_data)
    for name, components in COMPONENTS.items():
        array = grid.point_data[name]
        assert array.dtype == np.float64
        assert array.shape == ((grid.n_points,) if components == 1 else (grid.n_points, components)), name
        assert_allclose(array, np.broadcast_to(values[name], array.shape), rtol=0, atol=1e-10, err_msg=name)
    for name in CELLS:
        array = grid.cell_data[name]
        assert_allclose(array, np.broadcast_to(values[name], array.shape), rtol=0, atol=1e-10, err_msg=name)
    assert_array_equal(grid.cell_data["region"], 0)
    assert_array_equal(grid.cell_data["group:body"], 1)


def steps(path):
    """The frames of a `.vtkhdf`, one after the other."""
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    for step in range(reader.GetNumberOfSteps()):
        reader.SetStep(step)
        reader.Update()
        yield reader.GetTimeValue(), pyvista.wrap(reader.GetOutput()).copy()


def run(emmy, directory, text, *flags):
    (directory / "block.toml").write_text(text)
    command = [emmy, "run", "block.toml", "--quiet", *flags]
    subprocess.run(command, cwd=directory, check=True)


def collection(emmy, directory):
    """The collection and its frames: as theory says."""
    fields = [*COMPONENTS, *CELLS]
    run(emmy, directory, SHEARED, "--set", f"output.fields={fields}")
    reader = pyvista.get_reader(str(directory / "block/block.pvd"))
    assert_allclose(reader.time_values, [0, 0.25, 0.5, 0.75, 1], rtol=0, atol=1e-14)
    frames = []
    for t in reader.time_values:
        reader.set_active_time_value(t)
        [grid] = reader.read()
        check(grid, t)
        frames.append(grid)
    first = pyvista.read(directory / "block/frames/block_000000.vtu")
    assert first.field_data["TimeValue"] == [0.0]
    tensor = first.GetPointData().GetArray("cauchy_stress")
    assert [tensor.GetComponentName(i) for i in range(6)] == ["xx", "yy", "zz", "xy", "yz", "xz"]
    return frames


def series(emmy, directory, frames):
    """One file: as theory says, and bit by bit what the collection has."""
    fields = [*COMPONENTS, *CELLS]
    run(emmy, directory, SHEARED, "--set", f"output.fields={fields}", "--set", "output.format=vtkhdf", "--output", "one")
    path = directory / "one/one.vtkhdf"
    # One file of frames, and nothing half-written.
    names = [p.name for p in path.parent.iterdir()]
    assert "one.vtkhdf" in names and "frames" not in names and not any(".part" in name for name in names), names
    for (t, grid), frame in zip(steps(path), frames, strict=True):
        check(grid, t)
        assert_array_equal(grid.points, frame.points)
        assert_array_equal(grid.cells, frame.cells)
        assert_array_equal(grid.celltypes, frame.celltypes)
        for name in frame.point_data:
            assert_array_equal(grid.point_data[name], frame.point_data[name], err_msg=name)
        for name in frame.cell_data:
            assert_array_equal(grid.cell_data[name], frame.cell_data[name], err_msg=name)
    assert pyvista.read(path).n_points == frames[0].n_points
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        assert list(root.attrs["Version"]) == [2, 0]
        kind = root.attrs.get_id("Type").get_type()
        assert kind.get_cset() == h5py.h5t.CSET_ASCII and not kind.is_variable_str()
        assert root.attrs["Type"] == b"UnstructuredGrid"
        assert root["Steps"].attrs["NSteps"] == 5
        assert root["Points"].shape == (frames[0].n_points, 3), "the mesh is there once"
        stress = root["PointData/cauchy_stress"]
        assert stress.compression == "gzip" and stress.shuffle
        last = root["Steps/PointDataOffsets/cauchy_stress"][4]
        assert_array_equal(stress[last : last + frames[4].n_points], frames[4]["cauchy_stress"])


def rigid_bodies(emmy, directory):
    """A rigid body is a vertex at its centre and lines along its axes, a point mass a vertex; no cell is needed."""
    run(emmy, directory, DOOR, "--output", "door")
    run(emmy, directory, DOOR, "--set", "output.format=vtkhdf", "--output", "whole")
    reader = pyvista.get_reader(str(directory / "door/door.pvd"))
    for t, (time, whole) in zip(reader.time_values, steps(directory / "whole/whole.vtkhdf"), strict=True):
        reader.set_active_time_value(t)
        [grid] = reader.read()
        assert_allclose(time, t, rtol=0, atol=1e-14)
        for own in (grid, whole):
            assert_array_equal(own.celltypes, [1, 3, 3, 3, 1])
            assert_array_equal(own.cell_data["region"], -1)
            assert_array_equal(own.point_data["group:ball"], [0, 0, 0, 0, 1])
            places = own.points + own.point_data["displacement"]
            across = np.array([-np.sin(t**2), np.cos(t**2), 0])
            centre = np.array([0.5 * np.cos(t**2), 0.5 * np.sin(t**2), 1])
            # The radius of gyration.
            size = np.sqrt(0.5 * (7 + 9 + 3) / 20)
            assert_allclose(places[[0, 2]], [centre, centre + size * across], rtol=0, atol=1e-12)
            assert_allclose(places[4], [2, 0, -(t**2)], rtol=0, atol=1e-12)


def killed(emmy, directory):
    """Runs that are killed at any time leave whole files, if only with one frame."""
    (directory / "long.toml").write_text(LONG)
    for number in range(8):
        for form, file in [("vtkhdf", "long.vtkhdf"), ("vtu", "long.pvd")]:
            command = [emmy, "run", "long.toml", "--quiet", "--set", f"output.format={form}"]
            process = subprocess.Popen(command, cwd=directory)
            path, history = directory / "long" / file, directory / "long/history.csv"
            wanted = time.monotonic() + 60
            # A row for the start and each step: killed while a step is written, at one time or another.
            while not (path.exists() and len(history.read_text().splitlines()) > 2 + 5 * number):
                assert process.poll() is None, f"the run ended with {process.poll()}"
                assert time.monotonic() < wanted, f"no {file} and row {5 * number} in a minute"
                time.sleep(0.003)
            time.sleep(0.001 * number)
            process.send_signal(signal.SIGKILL)
            process.wait()
            if form == "vtkhdf":
                frames = list(steps(path))
                assert all(np.isfinite(grid["cauchy_stress"]).all() for _, grid in frames)
            else:
                reader = pyvista.get_reader(str(path))
                reader.set_active_time_value(reader.time_values[-1])
                assert np.isfinite(reader.read()[0]["cauchy_stress"]).all()
                frames = reader.time_values
            print(f"killed with {form}: {len(frames)} frames")
            assert len(frames) > 0


def scripts_of_the_book(emmy, directory):
    """The Python programs in `examples`, on the runs that the book makes before them."""
    root = pathlib.Path(__file__).parents[4]
    page = (root / "book/src/quick-start.md").read_text()
    (directory / "first.toml").write_text(page.split("```toml first.toml\n")[1].split("```")[0])
    for run in ["first.toml", root / "examples/bracket.toml", root / "examples/steel-bracket.toml"]:
        subprocess.run([emmy, "run", run, "--quiet"], cwd=directory, check=True)

    def printed(page, name, *arguments):
        """What a program prints, which is also in the page; its small numbers are rounding."""
        command = [sys.executable, root / "examples" / name, *arguments]
        text = subprocess.run(command, cwd=directory, check=True, capture_output=True, text=True).stdout
        shown = (root / "book/src" / page).read_text().split(f"```text {' '.join([name, *arguments])}\n")[1].split("```")[0]
        assert re.sub(r"[0-9.]+e-[0-9]+", "#", text) == re.sub(r"[0-9.]+e-[0-9]+", "#", shown), text
        print(text, end="")
        return text

    printed("quick-start.md", "quick_start.py")
    balance = printed("bracket.md", "bracket_history.py").splitlines()[0]
    assert float(balance.split()[-3]) < 1e-9, balance
    printed("bracket.md", "bracket_stress.py")
    printed("bracket.md", "bracket_stress.py", "steel-bracket")
    mount = root / "examples/rubber-mount.toml"
    subprocess.run([emmy, "run", mount, "--quiet"], cwd=directory, check=True)
    locked = ["--until", "2e-3", "--output", "locked", "--set", "region.0.formulation=standard"]
    subprocess.run([emmy, "run", mount, "--quiet", *locked], cwd=directory, check=True)
    printed("which-element.md", "rubber_mount.py")
    for picture in ["bracket.png", "steel-bracket.png", "rubber-mount.png"]:
        assert (directory / picture).stat().st_size > 1000


def main():
    emmy = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as temp:
        directory = pathlib.Path(temp)
        frames = collection(emmy, directory)
        print(f".vtu and .pvd: {len(frames)} frames as theory says")
        series(emmy, directory, frames)
        print(".vtkhdf: the same")
        rigid_bodies(emmy, directory)
        print("rigid bodies: where they turn")
        killed(emmy, directory)
        scripts_of_the_book(emmy, directory)


main()
