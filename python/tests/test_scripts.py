"""The scripts of `examples`, with numbers."""

import runpy
from pathlib import Path

import emmy
import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


def run(name, *, before=None):
    """Runs a script, or the part of it before some text; its variables."""
    path = EXAMPLES / f"{name}.py"
    if before is None:
        return runpy.run_path(str(path))
    source = path.read_text()
    variables = {"__name__": "__main__"}
    exec(compile(source[: source.index(before)], path, "exec"), variables)
    return variables


def test_block(capsys):
    own = run("block")
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 1 + 175 // 25
    assert abs(own["history"]["total_energy"][-1] - 5500.150056) < 1e-5
    assert float(lines[-1]) < 1e-10
    # Work of the tractions is all that there is.
    assert abs(own["history"]["external_work"][-1] - 5500.150056) < 1e-5


def test_block_as_a_file():
    own = run("block")
    emmy.new("l-block")
    there = emmy.run("l-block.toml", set={"output.every": 0}).history
    for column in own["history"].dtype.names:
        if column != "wall_seconds":
            assert np.array_equal(own["history"][column], there[column]), column


def test_bracket():
    gmsh = pytest.importorskip("gmsh")
    own = run("bracket", before="import matplotlib")
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write("bracket.msh")
    gmsh.finalize()
    Path("bracket.toml").write_text(
        """
mesh.file = "bracket.msh"
[region]
group = "steel"
density = 7.85e-9
material.saint-venant-kirchhoff = { youngs_modulus = 210e3, poissons_ratio = 0.3 }
[support]
group = "foot"
fix = ["x", "y", "z"]
[load]
group = "tip"
force = [0, 0, -2000]
history = [[0, 0], [5e-4, 1], [1e-3, 0]]
[time]
scheme = "DGM"
until = 5e-3
adaptive = { tolerance = 1e-4 }
[output]
every = 0
probes = [{ name = "tip", point = [60, 15, 60] }]
"""
    )
    there = emmy.run("bracket.toml").history
    history = own["motion"].history
    assert np.array_equal(history["tip_z"], there["tip_z"])
    assert np.array_equal(history["time"], there["time"])
    # A static force of 2 kN bends the arm and the column, two beams of 30 x 6 mm^2, by about
    # F a^3/(3 E I) + F a^2 h/(E I) with a = h = 57 mm; a blow of 1 ms reaches about as far.
    static = 2000 * 57**3 * (1 / 3 + 1) / (210e3 * 30 * 6**3 / 12)
    assert 0.5 < (60 - history["tip_z"].min()) / static < 2.0


def test_bracket_in_pictures():
    for package in ("gmsh", "matplotlib", "pandas", "pyvista"):
        pytest.importorskip(package)
    import gmsh

    own = run("bracket")
    gmsh.finalize()
    assert own["grid"].point_data["von_mises_stress"].shape == (own["mesh"].n_nodes,)


def test_run_file():
    pytest.importorskip("pyvista")
    emmy.new("l-block")
    emmy.run("l-block.toml", until=0.5, output="other")
    own = run("run_file")
    result = own["run"]
    assert result.summary["worst_energy_residual"] < 1e-9
    assert result.history["time"][-1] == 4.0
    assert result.status == "done"
    assert result.frames.times[0] == 0.0
    assert Path("compare/report.html").exists()
    order = emmy.converge("l-block.toml", sizes=[0.04, 0.02, 0.01]).order
    # Towards the second order of the scheme.
    assert np.isnan(order[0]) and 1.5 < order[1] < order[2] < 2.1


def test_steps():
    own = run("steps")
    motion, other = own["motion"], own["other"]
    assert motion.time == pytest.approx(1.0)
    assert own["positions"].shape == (own["mesh"].n_nodes, 3)
    assert 2.0 < other.time < 2.05
    # The scheme is exact for the momentum: force times the mean of sin^4, 3/8, is the impulse on 9 of area.
    assert motion.momentum.sum(axis=0) == pytest.approx(own["force"] * 3 / 8, rel=1e-9)
    # Two motions from one snapshot are equal in every bit.
    here = emmy.Motion(own["body"], scheme="AS(5)", degree=2, steps=own["plan"], start=own["snapshot"])
    here.run(until=other.time)
    assert np.array_equal(here.displacement, other.displacement)
    other.run()
    assert other.time == 4.0
    energy = other.history["total_energy"]
    assert np.ptp(energy) < 1e-6 * energy[-1]


def test_sensitivity():
    own = run("sensitivity")
    value, gradient = own["tip"]([600.0, 300.0])
    for index, name in enumerate(["lambda", "mu"]):
        shift = np.zeros(2)
        shift[index] = 1e-4 * [600.0, 300.0][index]
        above, below = own["tip"](np.array([600.0, 300.0]) + shift)[0], own["tip"](np.array([600.0, 300.0]) - shift)[0]
        assert gradient[index] == pytest.approx((above - below) / (2 * shift[index]), rel=1e-5), name
    finer = emmy.Motion(own["body"], scheme="DGM", degree=3, steps=[(3.0, 0.05)], tolerance=1e-12)
    finer.run()
    error = value - own["goal"].value(finer)
    assert 0.8 < own["motion"].goal_error(own["goal"]).total / error < 1.25


def test_modes():
    for package in ("gmsh", "scipy"):
        pytest.importorskip(package)
    import gmsh

    own = run("modes")
    gmsh.finalize()
    frequencies = np.sqrt(np.sort(own["w2"])) / (2 * np.pi)
    assert frequencies == pytest.approx(emmy.modes(own["body"], count=6).frequencies, rel=1e-6)


def test_loop_and_run_are_equal_in_every_bit(spinning):
    from bodies import spinning_block

    other = spinning_block()
    steps = list(spinning)
    other.run()
    assert len(steps) == 20
    assert np.array_equal(spinning.displacement, other.displacement)
    assert np.array_equal(spinning.history["total_energy"], other.history["total_energy"])
    assert list(spinning) == []


def test_loop_goes_on_where_it_was_broken(spinning):
    for step in spinning:
        if step.number == 7:
            break
    assert next(spinning).number == 8
    assert [step.number for step in spinning][-1] == 20


def test_shock_mount(capsys):
    own = run("shock_mount")
    lines = capsys.readouterr().out.splitlines()
    # The mount is stiffer than the linear one, whose stroke is 2.631 mm and whose device feels 47.25 g.
    assert lines[:2] == ["stroke 2.362 mm", "acceleration of the device 50.4 g"]
    # Of an oscillator with the damping 4e-4 omega^2: |1 + i d| / |1 - r^2 + i d|, d = 4e-4 omega r.
    shaken = own["shaken"]
    omega = 2 * np.pi * shaken.natural_frequencies[5]
    ratio = shaken.frequencies / shaken.natural_frequencies[5]
    damping = 1j * 4e-4 * omega * ratio
    theory = np.abs((1 + damping) / (1 - ratio**2 + damping))
    near = shaken.frequencies < 100
    assert np.abs(own["amplitude"] / theory - 1)[near].max() < 0.01
    assert Path("stroke.png").exists() and Path("shock-mount/report.html").exists()
