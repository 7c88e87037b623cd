"""Files: inputs as objects, runs, results."""

import dataclasses
import itertools
import subprocess
import sys
import tomllib
from pathlib import Path

import emmy
import numpy as np
import pytest

from bodies import rubber, spinning_block

FOLDER = Path(__file__).parents[2] / "examples"
INPUTS = sorted(FOLDER.glob("*.toml"))


def without_time(history):
    return {name: history[name] for name in history.dtype.names if name != "wall_seconds"}


def assert_equal(one, other):
    one, other = without_time(one), without_time(other)
    assert list(one) == list(other)
    for name in one:
        assert np.array_equal(one[name], other[name], equal_nan=one[name].dtype.kind == "f"), name


def end(tree):
    """So late that a few steps are done."""
    time = tree["time"]
    return 10 * time["steps"][0]["size"] if "steps" in time else time["until"] / 50


def motion(body, tree):
    """A motion by its arguments, from the tables of an input."""
    time, output = tree["time"], tree.get("output", {})
    steps = [(phase["until"], phase["size"]) for phase in time["steps"]] if "steps" in time else None
    adaptive = dict(time["adaptive"]) if "adaptive" in time else None
    initial = tree.get("initial", [])
    return emmy.Motion(
        body,
        time["scheme"],
        time["degree"],
        steps=steps,
        until=time.get("until"),
        adaptive=emmy.Adaptive(adaptive.pop("tolerance"), **adaptive) if adaptive else None,
        smallest_step=time.get("smallest_step"),
        initial=[emmy.Initial(**own) for own in ([initial] if isinstance(initial, dict) else initial)],
        equilibrium=tree.get("equilibrium"),
        limits=tree.get("limits"),
        solver=tree.get("solver", {}).get("kind", "auto"),
        probes={probe["name"]: {**probe} for probe in output.get("probes", [])},
        extremes=output.get("extremes"),
        values=output.get("values"),
        relative_to=output.get("relative_to"),
        reactions=output.get("reactions"),
        joints=output.get("joints"),
        **tree["newton"],
    )


@pytest.mark.filterwarnings("ignore:.*the run ends at t =")
@pytest.mark.parametrize("path", INPUTS, ids=lambda path: path.stem)
def test_inputs_as_objects(path):
    if "time" not in tomllib.loads(path.read_text()):
        pytest.skip("a static analysis")
    problem = emmy.load(path)
    until = end(tomllib.loads(problem.toml))
    problem = emmy.load(path, until=until)
    tree = tomllib.loads(problem.toml)
    changes = {"output.interval": None} if "interval" in tree["output"] else {}
    there = emmy.run(path, until=until, set=changes | {"output.every": 0}, output="run").history
    assert len(there) > 1
    assert_equal(problem.motion().run(), there)
    own = problem.body
    parts = (own.regions, own.supports, own.loads, own.masses, own.ties, own.rigid, own.joints, own.couplings)
    body = emmy.Body(own.mesh, *parts, own.contacts)
    assert_equal(motion(body, tree).run(), there)


def test_files_of_a_motion_are_those_of_a_run():
    emmy.new("l-block")
    problem = emmy.load("l-block.toml", until=0.1)
    problem.motion().run(output="own", every=2)
    run = emmy.run("l-block.toml", until=0.1, output="run")
    own = emmy.Run("own")
    assert_equal(own.history, run.history)
    assert np.array_equal(own.newton, run.newton)
    assert own.frames.times.tolist() == run.frames.times.tolist()
    for one, other in zip(own.frames, run.frames, strict=True):
        assert one.path.read_bytes() == other.path.read_bytes()
    assert own.status == run.status == "done"


def test_a_motion_from_memory_can_be_resumed(spinning):
    spinning.run(output="out", until=0.5, checkpoint_every=1)
    assert emmy.Run("out").history["time"][-1] == 0.5
    run = emmy.resume("out", until=1.0)
    spinning.run()
    assert_equal(run.history, spinning.history)
    assert emmy.report("out").exists()


def test_a_run_that_is_writing(spinning):
    spinning.run(output="out", until=0.2)
    run = emmy.Run("out")
    whole = run.history
    content = Path("out/history.csv").read_bytes()
    ends = [at + 1 for at, byte in enumerate(content) if byte == ord("\n")]
    assert len(ends) == 1 + 5
    for rows, (start, end) in enumerate(itertools.pairwise(ends)):
        for cut in (start, start + 1, (start + end) // 2, end - 1):
            Path("out/history.csv").write_bytes(content[:cut])
            assert np.array_equal(run.history, whole[:rows])
    for content in (b"", b"step,ti"):
        Path("out/history.csv").write_bytes(content)
        with pytest.raises(emmy.ResultsError, match=r"history.csv is still empty"):
            run.history


def test_new_with_an_ending():
    for name in ("two-body", "comet.toml", "balloon.toml.toml"):
        path = emmy.new(name)
        assert path == Path(f"{name.partition('.')[0]}.toml") and path.exists()


def test_sizes_that_fail_are_in_the_table():
    emmy.new("spinning-block")

    def study(iterations, **arguments):
        given = {"newton.max_iterations": iterations}
        return emmy.converge("spinning-block.toml", sizes=[0.2, 0.02, 0.01], to=0.2, set=given, **arguments)

    failed, whole = study(2, reference=0.001), study(20, reference=0.001)
    assert list(failed.failures) == [0.2] and whole.failures == {}
    assert failed.failures[0.2].startswith("no convergence in step 1, to t = 0.2")
    assert failed.table.dtype == whole.table.dtype
    assert failed.step_size.tolist() == [0.2, 0.02, 0.01]
    assert np.isnan(failed.error[0]) and np.isnan(failed.order[:2]).all()
    # Newton's iteration ends with the same digits.
    np.testing.assert_allclose(failed.error[1:], whole.error[1:], rtol=1e-6)
    np.testing.assert_allclose(failed.order[2], whole.order[2], rtol=1e-6)
    for name in ("scheme", "degree", "step_size"):
        assert failed.reference[name] == whole.reference[name], name
    assert study(3).reference["step_size"] == study(20).reference["step_size"]
    # An error of this call is not hidden by the table of an older one.
    with pytest.raises(emmy.ConvergenceError, match="the reference did not converge"):
        study(1, reference=0.005)


def test_a_run_of_nothing():
    with pytest.raises(emmy.ResultsError, match="holds no run"):
        emmy.Run(".")


def test_output_is_not_overwritten_in_silence(spinning):
    Path("out").mkdir()
    Path("out/thesis.tex").write_text("mine")
    with pytest.raises(emmy.ResultsError, match=r"^the directory out holds files .* \(such as thesis.tex\)"):
        spinning.run(output="out")
    assert [path.name for path in Path("out").iterdir()] == ["thesis.tex"]


def test_set_removes_and_sets_every_kind_of_value():
    emmy.new("l-block")
    text = emmy.load(
        "l-block.toml",
        set={
            "title": 'a "quote" and a \\',
            "newton.max_iterations": 30,
            "load.0.traction": np.array([1.0, 2.5, -3.0]),
            "output.probes": [{"name": "end", "point": (0, 10, 0)}],
            "output.every": None,
        },
    ).toml
    tree = tomllib.loads(text)
    assert tree["title"] == 'a "quote" and a \\'
    assert tree["newton"]["max_iterations"] == 30
    assert tree["load"][0]["traction"] == [1.0, 2.5, -3.0]
    assert tree["output"]["probes"][0]["name"] == "end"
    assert tree["output"]["every"] == 1


def test_the_command_line():
    answer = subprocess.run([sys.executable, "-m", "emmy", "--version"], capture_output=True, text=True)
    assert answer.returncode == 0 and answer.stdout.strip() == f"emmy {emmy.__version__}"
    answer = subprocess.run([sys.executable, "-m", "emmy", "run", "none.toml"], capture_output=True, text=True)
    assert answer.returncode == 2 and "none.toml" in answer.stderr and answer.stdout == ""


def test_lists():
    assert {item.name for item in emmy.materials()} >= {material.model for material in classes()}
    named = {item.name for item in emmy.materials()} - {"energy"}
    assert named == {material.model for material in classes()} - {"energy"}


def test_keys_of_tables_are_fields():
    tables = emmy.schema()["properties"]
    tables |= {"viscosity": tables["region"]["properties"]["viscosity"]}
    shapes = tables["contact"]["properties"]["obstacle"]["properties"]
    tables |= {f"obstacle.{shape}": own for shape, own in shapes.items()}
    tables |= {"adaptive": tables["time"]["properties"]["adaptive"]}
    for own in (
        emmy.Adaptive, emmy.Contact, emmy.Cylinder, emmy.Initial, emmy.Load, emmy.Mass, emmy.Plane, emmy.Region,
        emmy.Rigid, emmy.Sphere, emmy.Support, emmy.Tie, emmy.Viscosity,
    ):  # fmt: skip
        names = {field.name for field in dataclasses.fields(own)}
        if own is emmy.Contact:
            # One pair stands for a surface and its opponent, of either kind.
            names = names - {"surface", "opponent"} | {"surfaces", "obstacle"}
        if own in (emmy.Plane, emmy.Sphere, emmy.Cylinder):
            # The motion stands beside the shape.
            names -= {"move"}
            assert "move" in shapes
        if own is emmy.Load:
            # A body has no units before its motion.
            names |= {"gravity"}
        assert names == set(tables[own._section]["properties"])


def classes():
    own = [value for value in vars(emmy).values() if isinstance(value, type) and issubclass(value, emmy.Material)]
    return [value for value in own if value is not emmy.Material]


def test_frames_in_one_file():
    def fly(name, **files):
        body = emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        emmy.Motion(body, steps=(1.0, 0.25), initial=emmy.Initial(velocity=(0, 0, 1))).run(output=name, **files)
        return emmy.Run(name).frames

    frames, series = fly("frames", format="vtu"), fly("series", format="vtkhdf")
    assert frames.times.tolist() == series.times.tolist() == [0, 0.25, 0.5, 0.75, 1]
    for one, other in zip(frames, series, strict=True):
        one, other = one.to_pyvista(), other.to_pyvista()
        np.testing.assert_array_equal(one.point_data["displacement"], other.point_data["displacement"])
    # A free flight with velocity 1.
    np.testing.assert_allclose(
        series[-1].to_pyvista().point_data["displacement"], np.tile([0.0, 0.0, 1.0], (8, 1)), atol=1e-12
    )


def test_runs_without_frames():
    body = emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
    emmy.Motion(body, steps=(1.0, 0.5), initial=emmy.Initial(velocity=(0, 0, 1))).run(output="none", every=0)
    with pytest.raises(emmy.ResultsError, match="none has no frames"):
        emmy.Run("none").frames


def test_a_body_as_toml():
    path = emmy.new("spinning-block")
    problem = emmy.load(path)
    text = problem.body.to_toml()
    motion = """
time = { scheme = "DGM", steps = [{ until = 0.1, size = 0.05 }] }
"""
    Path("other.toml").write_text(motion + text)
    assert set(tomllib.loads(text)) <= {"mesh", "region", "support", "load", "mass"}
    problem.body.mesh.write("mesh.vtu")
    assert emmy.load("other.toml").body.to_toml() == text
    block = emmy.Body(
        emmy.Mesh.box((1, 1, 1), (1, 1, 1)),
        emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1),
        loads=emmy.Load("x-max", force=(1, 0, 0), history=abs),
    )
    assert block.to_toml().startswith("# `<function NAME>` stands for a function of a program")
    assert tomllib.loads(block.to_toml())["load"][0]["history"] == "<function abs>"


def test_a_local_function_keeps_its_whole_name():
    load = emmy.Load("y-max", force=(1, 0, 0), history=lambda t: t)
    block = emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), emmy.Region(rubber(), density=1.0), loads=load)
    name = "test_a_local_function_keeps_its_whole_name.<locals>.<lambda>"
    assert tomllib.loads(block.to_toml())["load"][0]["history"] == f"<function {name}>"


def test_every_and_interval_contradict_each_other(tmp_path):
    with pytest.raises(emmy.InputError, match="every"):
        spinning_block().run(output=tmp_path / "o", every=2, interval=0.1)
    assert not (tmp_path / "o").exists()


def test_frames_by_time_replace_frames_by_steps():
    problem = emmy.load(emmy.new("spinning-block"), until=0.2)
    problem.motion().run(output="out", interval=0.1)
    assert emmy.Run("out").frames.times.tolist() == [0.0, 0.1, 0.2]
