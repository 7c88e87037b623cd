"""Sweeps."""

import csv
import re
import threading
from pathlib import Path

import emmy
import numpy as np
import pytest

from bodies import free_block, rubber


def make(speed, size=0.5):
    return emmy.Motion(free_block(), steps=(1.0, size), initial=emmy.Initial(velocity=(speed, 0, 0)))


VALUES = {"speed": [1.0, 2.0, 3.0], "size": [0.5, 0.25]}


@pytest.mark.parametrize("workers", [1, 3])
def test_order_is_that_of_the_parameters(workers):
    sweep = emmy.sweep(make, VALUES, workers=workers)
    assert sweep.table["speed"].tolist() == [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]
    assert sweep.table["size"].tolist() == [0.5, 0.25] * 3
    assert sweep.table["step"].tolist() == [2, 4] * 3
    # A block of mass 2 in free flight.
    assert sweep.table["kinetic_energy"] == pytest.approx(sweep.table["speed"] ** 2, rel=1e-12)
    assert sweep.failures == {} and "linear_momentum_x" in sweep.columns and len(sweep) == 6


def test_failed_runs_have_a_message():
    def sometimes(limit):
        initial = emmy.Initial(angular_velocity=(1, 2, 3))
        return emmy.Motion(free_block(), "FE(1)", steps=(1.0, 0.1), initial=initial, limits={"energy": limit})

    sweep = emmy.sweep(sometimes, {"limit": [1e-16, 1.0]})
    assert list(sweep.failures) == [0] and "limit" in sweep.failures[0]
    assert sweep.table["time"][1] == 1.0 and sweep.table["time"][0] < 1.0


def test_bad_parameters_are_failures_and_bugs_are_not():
    def dense(density):
        body = emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), emmy.Region(rubber(), density=density))
        return emmy.Motion(body, steps=(1.0, 0.5), initial=emmy.Initial(velocity=(1, 0, 0)))

    sweep = emmy.sweep(dense, {"density": [1.0, -1.0]})
    assert "density" in sweep.failures[1] and np.isnan(sweep.table["kinetic_energy"][1])
    with pytest.raises(ZeroDivisionError):
        emmy.sweep(lambda x: make(1 / x), {"x": [1.0, 0.0]})
    with pytest.raises(TypeError, match="must return an emmy.Motion, not NoneType"):
        emmy.sweep(lambda x: None, {"x": [1.0]})


def bounced(speed, size=0.01):
    """A mass of 1 on a spring of stiffness 4 pi^2 along x: its deflection is v/(2 pi) sin(2 pi t)."""
    ends = {"foot": [0], "mass": [1]}
    mesh = emmy.Mesh([(0, 0, 0), (1, 0, 0)], {"line2": [(0, 1)]}, node_groups=ends)
    body = emmy.Body(
        mesh,
        emmy.Region(emmy.Spring(stiffness=4 * np.pi**2)),
        masses=emmy.Mass(group="mass", mass=1.0),
        supports=emmy.Support("foot", fix=("x", "y", "z")),
    )
    return emmy.Motion(
        body,
        degree=3,
        steps=(0.9, size),
        initial=emmy.Initial(group="mass", velocity=(speed, 0, 0)),
        tolerance=1e-13,
        probes={"mass": {"point": (1, 0, 0), "quantities": ["displacement"]}},
        reactions=["foot"],
    )


def test_peaks_are_amplitudes_and_their_times():
    speeds = [0.1, 0.2]
    sweep = emmy.sweep(bounced, {"speed": speeds}, output="sweep.csv")
    amplitudes = np.array(speeds) / (2 * np.pi)
    table = sweep.table
    assert table["mass_displacement_x_max"] == pytest.approx(amplitudes, abs=1e-10)
    assert table["mass_displacement_x_min"] == pytest.approx(-amplitudes, abs=1e-10)
    assert table["mass_displacement_x_max_time"] == pytest.approx(0.25, abs=1e-12)
    assert table["mass_displacement_x_min_time"] == pytest.approx(0.75, abs=1e-12)
    assert table["mass_displacement_x"] == pytest.approx(amplitudes * np.sin(1.8 * np.pi), abs=1e-10)
    # The mean of k A sin(omega t) over the step before the quarter of the period, or after it; the start has no reaction.
    force = 4 * np.pi**2 * amplitudes * np.sin(0.02 * np.pi) / (0.02 * np.pi)
    assert table["foot_force_x_max"] == pytest.approx(force, abs=1e-9)
    again = emmy.sweep(bounced, {"speed": speeds}, output="sweep.csv", resume=True)
    assert again.table["mass_displacement_x_max"].tolist() == table["mass_displacement_x_max"].tolist()


def test_peaks_of_motions_histories_and_runs():
    motion = bounced(0.1)
    history = motion.run(output="spring", every=0)
    peak = motion.peak("mass_displacement_x")
    assert isinstance(history, emmy.History) and type(history["time"]) is np.ndarray
    assert peak == history.peak("mass_displacement_x") == emmy.Run("spring").history.peak("mass_displacement_x")
    assert peak.largest == pytest.approx(0.05 / np.pi, abs=1e-10) and peak.smallest_time == pytest.approx(0.75)
    summary = emmy.Run("spring").summary
    names = ["mass_displacement_x" + end for end in ("", "_min", "_min_time", "_max", "_max_time")]
    assert [summary[name] for name in names] == list(peak)
    # Of the second half alone; of the columns of the whole body, too.
    assert history[50:].peak("mass_displacement_x").largest < 1e-10
    assert motion.peak("kinetic_energy").largest == pytest.approx(0.005, rel=1e-12)
    empty = history[:1].peak("foot_force_x")
    assert all(np.isnan(number) for number in empty)
    with pytest.raises(emmy.InputError, match="'mass_x' is not a column; there is step, time"):
        motion.peak("mass_x")


def test_measures_and_ends():
    sweep = emmy.sweep(
        make, {"speed": [1.0, 2.0]}, until=0.5, measure=lambda motion: {"way": motion.displacement[0, 0]}
    )
    assert sweep.table["way"] == pytest.approx([0.5, 1.0], rel=1e-12)
    assert sweep.columns[-1] == "way"


def test_measures_have_names_of_their_own():
    for name in ("time", "speed", "run", "until", "message", "newton_iterations"):
        with pytest.raises(TypeError, match=f"measure: the name '{name}' is that of a parameter or of a column"):
            emmy.sweep(make, {"speed": [1.0]}, measure=lambda motion, name=name: {name: 1.0})
    with pytest.raises(TypeError, match="measure: the name 1 is not text"):
        emmy.sweep(make, {"speed": [1.0]}, measure=lambda motion: {1: 1.0})


def test_measures_come_back_from_the_file():
    def measure(motion):
        return {"cuts": motion.record.cuts, "mode": 3, "iteration": 0.5, "free": float("inf")}

    values = {"speed": np.linspace(1.0, 2.0, 3), "size": (0.5, np.float32(0.25))}
    sweep = emmy.sweep(make, values, measure=measure, output="sweep.csv")
    rows = list(csv.DictReader(Path("sweep.csv").read_text().splitlines()))
    assert [row["speed"] for row in rows] == ["1.0", "1.0", "1.5", "1.5", "2.0", "2.0"]
    assert {row["size"] for row in rows} == {"0.5", "0.25"}
    again = emmy.sweep(
        lambda speed, size: pytest.fail("a run"), values, measure=measure, output="sweep.csv", resume=True
    )
    assert again.table.dtype == sweep.table.dtype and np.array_equal(again.table, sweep.table)
    assert sweep.table["mode"].tolist() == [3.0] * 6 and sweep.table["iteration"].tolist() == [0.5] * 6
    assert sweep.parameters == {"speed": [1.0, 1.5, 2.0], "size": [0.5, 0.25]}


def test_parameters_that_are_lists_are_text_without_types():
    values = {"speed": [1.0], "unused": [np.array([1.0, 2.0]), (np.float64(3.0), "a")]}
    emmy.sweep(lambda speed, unused: make(speed), values, output="sweep.csv")
    rows = list(csv.DictReader(Path("sweep.csv").read_text().splitlines()))
    assert [row["unused"] for row in rows] == ["[1.0, 2.0]", "[3.0, 'a']"]


def test_an_interrupted_sweep_goes_on():
    calls = []

    def counted(speed, size):
        calls.append((speed, size))
        return make(speed, size)

    def stopped(speed, size):
        if speed == 3.0:
            raise KeyboardInterrupt
        return counted(speed, size)

    with pytest.raises(KeyboardInterrupt):
        emmy.sweep(stopped, VALUES, workers=1, output="sweep.csv")
    with pytest.raises(emmy.ResultsError, match="resume=True"):
        emmy.sweep(counted, VALUES, output="sweep.csv")
    # A line that was cut when the process was killed.
    with open("sweep.csv", "a") as file:
        file.write("5,3.0,0.")
    calls.clear()
    sweep = emmy.sweep(counted, VALUES, output="sweep.csv", resume=True)
    assert sorted(calls) == [(3.0, 0.25), (3.0, 0.5)]
    whole = emmy.sweep(make, VALUES)
    for name in whole.table.dtype.names:
        if name != "wall_seconds":
            assert np.array_equal(sweep.table[name], whole.table[name]), name
    rows = list(csv.DictReader(Path("sweep.csv").read_text().splitlines()))
    assert [row["run"] for row in rows] == ["1", "2", "3", "4", "5", "6"]
    with pytest.raises(emmy.ResultsError, match="another sweep"):
        emmy.sweep(make, {"speed": [7.0], "size": [0.5]}, output="sweep.csv", resume=True)


def test_a_sweep_is_not_continued_with_another_end_or_in_another_file():
    values = {"speed": [1.0, 2.0], "size": [0.5]}
    for first, then, message in [
        (None, 0.5, "its first columns are not run, speed, size, until"),
        (0.5, None, "its runs have until = 0.5"),
        (0.5, 1.0, "run 1 has 1.0, 0.5, 0.5"),
    ]:
        emmy.sweep(make, values, until=first, output="sweep.csv")
        text = Path("sweep.csv").read_text()
        with pytest.raises(emmy.ResultsError, match="sweep.csv is of another sweep: " + re.escape(message)):
            emmy.sweep(make, values, until=then, output="sweep.csv", resume=True)
        assert Path("sweep.csv").read_text() == text
        again = emmy.sweep(make, values, until=first, output="sweep.csv", resume=True)
        assert again.columns == emmy.sweep(make, values, until=first).columns
        Path("sweep.csv").unlink()
    for text in ["my notes", "my notes\n", "\xff"]:
        Path("notes.csv").write_text(text, encoding="latin-1")
        with pytest.raises(emmy.ResultsError, match="is of another sweep"):
            emmy.sweep(make, values, output="notes.csv", resume=True)
        assert Path("notes.csv").read_text(encoding="latin-1") == text


def test_runs_are_side_by_side():
    meeting = threading.Barrier(2, timeout=20)

    def meet(x):
        meeting.wait()
        return make(x)

    assert emmy.sweep(meet, {"x": [1.0, 2.0]}, workers=2).failures == {}


def test_a_file():
    path = emmy.new("spinning-block")
    values = {"region.0.density": [0.5, 2.0], "time.scheme": ["DGM", "AS(5)"]}
    sweep = emmy.sweep(path, values, until=0.5, output="sweep")
    assert sweep.table["region.0.density"].tolist() == [0.5, 0.5, 2.0, 2.0]
    assert sweep.table["time.scheme"].tolist() == ["DGM", "AS(5)"] * 2
    alone = emmy.load(path, set={"region.0.density": 2.0}, until=0.5).motion().run()
    assert sweep.table["total_energy"][2] == alone["total_energy"][-1]
    again = emmy.sweep(emmy.load(path), values, until=0.5, output="sweep", resume=True)
    assert np.array_equal(again.table["total_energy"], sweep.table["total_energy"])


def test_a_file_with_failures():
    path = emmy.new("spinning-block")
    sweep = emmy.sweep(path, {"newton.max_iterations": [1, 20]}, until=0.2, output="sweep")
    assert list(sweep.failures) == [0] and "step" in sweep.failures[0]
    assert sweep.table["status"].tolist() == ["failed", "done"]


def test_kept_runs_and_comparisons_of_sweeps():
    path = emmy.new("spinning-block")
    for scheme in ("DGM", "AS(5)"):
        problem = emmy.load(path, set={"time.scheme": scheme})
        emmy.sweep(problem, {"region.0.density": [1.0, 2.0]}, until=0.2, output=scheme, keep=True)
    runs = [emmy.Run(f"DGM/runs/{number}") for number in (1, 2)]
    assert [run.status for run in runs] == ["done", "done"]
    assert runs[1].history["time"][-1] == 0.2
    comparison = emmy.compare(["DGM", "AS(5)"])
    assert comparison.report.name == "compare.csv" and comparison.report.exists()
    assert [row["sweep"] for row in comparison.summaries] == ["DGM", "DGM", "AS(5)", "AS(5)"]
    assert len(emmy.compare(["DGM/runs/1", "DGM/runs/2"], output="runs").summaries) == 2
    with pytest.raises(emmy.ResultsError, match="holds a sweep"):
        emmy.compare(["DGM", "DGM/runs/1"])
    with pytest.raises(TypeError, match="keep: only with an input file"):
        emmy.sweep(make, {"speed": [1.0]}, keep=True)


def test_an_error_is_not_hidden_by_an_older_sweep():
    path = emmy.new("spinning-block")
    assert emmy.sweep(path, {"newton.max_iterations": [1, 20]}, until=0.2, output="sweep").failures
    table = Path("sweep/sweep.csv").read_bytes()
    with pytest.raises(emmy.InputError, match="nonsense"):
        emmy.sweep(path, {"nonsense": [1]}, until=0.2, output="sweep")
    with pytest.raises(emmy.Error, match="another input"):
        emmy.sweep(path, {"newton.max_iterations": [2, 20]}, until=0.2, output="sweep", resume=True)
    assert Path("sweep/sweep.csv").read_bytes() == table
    again = emmy.sweep(path, {"newton.max_iterations": [1, 20]}, until=0.2, output="sweep", resume=True)
    assert list(again.failures) == [0] and Path("sweep/sweep.csv").read_bytes() == table


def test_the_directory_of_a_file():
    path = emmy.new("spinning-block")
    text = path.read_text()
    assert text.count('directory = "spinning-block"') == 1
    path.write_text(text.replace('directory = "spinning-block"', 'directory = "flights"'))
    sweep = emmy.sweep(path, {"region.0.density": [0.5]}, until=0.1)
    assert sweep.path == Path("flights-sweep/sweep.csv") and sweep.path.exists()
    problem = emmy.load(path, set={"output.directory": "others"})
    assert emmy.sweep(problem, {"region.0.density": [0.5]}, until=0.1).path == Path("others-sweep/sweep.csv")
    assert Path("others-sweep/sweep.csv").exists()
    assert sorted(own.name for own in Path().iterdir()) == ["flights-sweep", "others-sweep", "spinning-block.toml"]


def test_mistakes():
    with pytest.raises(emmy.InputError, match="nonsense"):
        emmy.sweep(emmy.new("spinning-block"), {"nonsense": [1]}, until=0.2)
    with pytest.raises(emmy.InputError, match="no values"):
        emmy.sweep(make, {"speed": []})
    with pytest.raises(TypeError, match="^measure: 5 is neither the name of a result, nor a list of names, nor a f"):
        emmy.sweep(make, {"speed": [1.0]}, measure=5)
    with pytest.raises(TypeError, match="^measure: not a function with modes"):
        emmy.sweep("spinning-block.toml", {"region.0.density": [1.0]}, measure=dict, modes=7)
    with pytest.raises(emmy.InputError, match="^measure: 'speed' is a parameter"):
        emmy.sweep(make, {"speed": [1.0]}, measure=["step", "speed"])
    with pytest.raises(emmy.InputError, match="^measure: 'sped' is no result; there is step, time, step_size"):
        emmy.sweep(make, {"speed": [1.0]}, measure="sped")
    with pytest.raises(emmy.InputError, match="^set.time.degree: is one of the parameters"):
        emmy.sweep("spinning-block.toml", {"time.degree": [1]}, set={"time.degree": 2})
    with pytest.raises(TypeError, match="^set: only with an input file"):
        emmy.sweep(make, {"speed": [1.0]}, set={"size": 0.5})


def test_results_by_their_names():
    names = ["mass_displacement_x_max", "kinetic_energy", "kinetic_energy_max", "kinetic_energy_min_time", "step"]
    sweep = emmy.sweep(bounced, {"speed": [0.1, 0.2]}, measure=names, output="sweep.csv")
    assert sweep.columns == names and sweep.table.dtype.names == ("speed", *names)
    speeds = np.array([0.1, 0.2])
    assert sweep.table["mass_displacement_x_max"] == pytest.approx(speeds / (2 * np.pi), abs=1e-10)
    assert sweep.table["kinetic_energy"] == pytest.approx(speeds**2 / 2 * np.cos(1.8 * np.pi) ** 2, rel=1e-9)
    assert sweep.table["kinetic_energy_max"] == pytest.approx(speeds**2 / 2, rel=1e-12)
    # It turns around after a quarter of the period, or after three.
    assert np.all(np.isclose(sweep.table["kinetic_energy_min_time"] % 0.5, 0.25))
    assert sweep.table["step"].tolist() == [90, 90]
    again = emmy.sweep(bounced, {"speed": [0.1, 0.2]}, measure=names, output="sweep.csv", resume=True)
    assert np.array_equal(again.table, sweep.table)


def test_measures_of_a_file():
    path = emmy.new("spinning-block")
    values, fixed = {"region.0.density": [0.5, 2.0]}, {"time.scheme": "AS(5)", "time.steps.0.size": 0.05}
    names = ["scheme_is_not_there"]
    with pytest.raises(emmy.InputError, match="^measure: 'scheme_is_not_there' is no result; there is status"):
        emmy.sweep(path, values, set=fixed, until=0.2, measure=names, output="sweep")
    # The results are there, and nothing runs again.
    names = ["steps", "total_energy", "linear_momentum_x_max", "dofs"]
    sweep = emmy.sweep(path, values, set=fixed, until=0.2, measure=names, output="sweep", resume=True)
    assert sweep.columns == names
    table = sweep.table
    assert table["steps"].tolist() == [4, 4] and table["dofs"].tolist() == [672, 672]
    # Both are proportional to the density, from one start; the body is free.
    assert table["linear_momentum_x_max"][1] == pytest.approx(4 * table["linear_momentum_x_max"][0], rel=1e-9)
    alone = emmy.run(path, set=fixed | {"region.0.density": 2.0}, until=0.2, output="alone")
    assert table["total_energy"][1] == alone.history["total_energy"][-1]

    def tip(run):
        return {"path": np.abs(np.diff(run.history["tip_z"])).sum(), "rows": len(run.history)}

    measured = emmy.sweep(path, values, set=fixed, until=0.2, measure=tip, output="sweep", resume=True)
    assert measured.table["rows"].tolist() == [5, 5] and "steps" in measured.columns
    assert measured.table["path"][1] == tip(alone)["path"]


def test_failed_runs_of_a_file_have_no_measures():
    path = emmy.new("spinning-block")
    values = {"newton.max_iterations": [1, 20]}
    sweep = emmy.sweep(path, values, until=0.2, output="sweep", measure=lambda run: {"rows": len(run.history)})
    assert list(sweep.failures) == [0]
    assert np.isnan(sweep.table["rows"][0]) and sweep.table["rows"][1] == 3
    named = emmy.sweep(path, values, until=0.2, output="sweep", measure=["steps", "kinetic_energy_max"], resume=True)
    assert np.isnan(named.table["kinetic_energy_max"][0]) and named.table["kinetic_energy_max"][1] > 0.0


def test_names_of_modes():
    path = emmy.new("spinning-block")
    sweep = emmy.sweep(path, {"region.0.density": [0.5, 2.0]}, modes=7, measure="frequency_7", output="sweep")
    assert sweep.columns == ["frequency_7"]
    # The frequency falls with the root of the mass.
    assert sweep.table["frequency_7"][0] == pytest.approx(2 * sweep.table["frequency_7"][1], rel=1e-6)


def test_a_sweep_as_a_data_frame():
    pytest.importorskip("pandas")
    frame = emmy.sweep(make, VALUES).to_pandas()
    assert frame.columns[:2].tolist() == ["speed", "size"] and len(frame) == 6
    # A block of mass 2 in free flight.
    assert frame.groupby("speed")["kinetic_energy"].mean().tolist() == pytest.approx([1.0, 4.0, 9.0], rel=1e-12)


def test_parameters_are_those_of_the_function():
    with pytest.raises(TypeError, match="parameters: got an unexpected keyword argument 'sped'"):
        emmy.sweep(lambda speed: pytest.fail("a run"), {"speed": [1.0], "sped": [1.0]})
    with pytest.raises(TypeError, match="parameters: missing a required argument: 'size'"):
        emmy.sweep(lambda speed, size: pytest.fail("a run"), {"speed": [1.0]})


def test_a_sweep_shows_itself_in_a_line():
    assert (
        repr(emmy.sweep(make, {"speed": [1.0, 2.0], "size": [0.5]}))
        == "<emmy.Sweep over speed, size: 2 runs, 0 failed>"
    )
