"""Mistakes of callers: each is named at its argument, and none is passed over in silence."""

import copy
import dataclasses
import pickle
import shutil
from pathlib import Path

import emmy
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bodies import free_block, rubber, spinning_block


def held_block():
    mesh = emmy.Mesh.box((1, 2, 1), (1, 2, 1))
    pull = emmy.Load("y-max", force=(0, 1, 0))
    return emmy.Body(mesh, emmy.Region(rubber(), density=1.0), emmy.Support("y-min", fix="xyz"), pull)


def places(error):
    return [fault.place for fault in error.faults]


@pytest.mark.parametrize(
    ("make", "place"),
    [
        # Keys of a table that are also tables of a whole input.
        (lambda: emmy.Viscosity(time=-1.0), "time"),
        (lambda: emmy.Region(rubber(), density=1.0, viscosity=emmy.Viscosity(time=1e-3), group=""), "group"),
        (lambda: emmy.Adaptive(1e-4, min_size=-1.0), "min_size"),
        (lambda: emmy.NeoHooke(lambda_=-1.0, mu=1.0), "lambda_"),
        (lambda: emmy.Energy("lambda/2*ln(J)^2", lambda_=-1.0), "formula"),
        # Keys of a whole input.
        (lambda: emmy.Motion(free_block(), steps=(0.0, 0.1)), "steps[0]"),
        (lambda: emmy.Motion(free_block(), steps=(1.0, 0.1), max_iterations=0), "max_iterations"),
        (lambda: emmy.Motion(free_block(), steps=(1.0, 0.1), solver="lu"), "solver"),
        (lambda: emmy.Motion(free_block(), steps=(1.0, 0.1), extremes=["nonsense"]), "extremes[0]"),
        (lambda: emmy.equilibrium(held_block(), tolerance=-1.0), "tolerance"),
        (lambda: spinning_block().extend(2.0, -1.0), "steps[1]"),
    ],
)
def test_places_are_arguments(make, place):
    with pytest.raises(emmy.InputError) as raised:
        make()
    assert places(raised.value) == [place], raised.value
    again = pickle.loads(pickle.dumps(raised.value))
    assert again.faults == raised.value.faults and type(again) is type(raised.value)


@pytest.mark.parametrize("equilibrium", [True, np.True_, 5, {}, {"load_steps": 5}])
def test_a_motion_has_one_start(equilibrium):
    body = held_block()
    state = emmy.equilibrium(body)
    moving = emmy.Initial(velocity=(1, 0, 0))
    velocity = np.tile([1.0, 0.0, 0.0], (12, 1))
    snapshot = emmy.Motion(body, steps=(1.0, 0.1)).snapshot()
    for start in (state, snapshot):
        for initial in (moving, [moving], velocity):
            with pytest.raises(TypeError, match="start and initial exclude each other"):
                emmy.Motion(body, steps=(1.0, 0.1), start=start, initial=initial)
        with pytest.raises(TypeError, match="start and equilibrium exclude each other"):
            emmy.Motion(body, steps=(1.0, 0.1), start=start, equilibrium=equilibrium)
        assert emmy.Motion(body, steps=(1.0, 0.1), start=start, initial=(), equilibrium=False).number == 0
    with pytest.raises(TypeError, match="an array as initial and equilibrium exclude each other"):
        emmy.Motion(body, steps=(1.0, 0.1), initial=velocity, equilibrium=equilibrium)
    # Velocities of an equilibrium.
    motion = emmy.Motion(body, steps=(1.0, 0.1), initial=moving, equilibrium=equilibrium)
    assert np.abs(motion.displacement).max() > 0.0 and motion.velocity[-1, 0] == 1.0


@pytest.mark.parametrize("equilibrium", [True, np.True_, 10, np.int64(10), {}, {"load_steps": 10}])
def test_an_equilibrium_at_the_start(equilibrium):
    body = held_block()
    motion = emmy.Motion(body, steps=(1.0, 0.1), equilibrium=equilibrium)
    assert np.array_equal(motion.displacement, emmy.equilibrium(body).displacement)
    assert motion.displacement[:, 1].max() > 0.0


@pytest.mark.parametrize("equilibrium", [None, False, np.False_])
def test_no_equilibrium_at_the_start(equilibrium):
    motion = emmy.Motion(held_block(), steps=(1.0, 0.1), equilibrium=equilibrium)
    assert np.array_equal(motion.displacement, np.zeros((12, 3)))


def test_a_start_is_a_snapshot_or_a_state():
    with pytest.raises(TypeError, match=r"start: int is neither an emmy.Snapshot nor an emmy.State"):
        emmy.Motion(free_block(), steps=(1.0, 0.1), start=5)


HUGE = 2**70


@pytest.mark.parametrize(
    ("use", "place", "least"),
    [
        (lambda n: emmy.Goal.displacement_at(free_block(), node=n, direction=(1, 0, 0)), "node", 0),
        (lambda n: emmy.Goal.velocity_at(free_block(), node=n, direction=(1, 0, 0)), "node", 0),
        (lambda n: emmy.modes(held_block(), count=n), "count", 1),
        (lambda n: emmy.equilibrium(held_block(), load_steps=n), "load_steps", 1),
        (lambda n: emmy.Mesh.box((1, 1, 1), (1, n, 1)), "cells[1]", 1),
        (lambda n: emmy.Mesh.rectangle((1, 1), (1, n)), "cells[1]", 1),
        (lambda n: emmy.set_threads(n), "number", 1),
        (lambda n: emmy.State(0.0, np.zeros((1, 3)), np.zeros((1, 3)), np.zeros((1, 3)), n), "step", 0),
        (lambda n: emmy.sweep(lambda x: spinning_block(), {"x": [1]}, workers=n), "workers", 1),
    ],
    ids=["displacement_at", "velocity_at", "modes", "equilibrium", "box", "rectangle", "threads", "state", "sweep"],
)
def test_whole_numbers(use, place, least):
    for number in (-1, least - 1, HUGE, np.int64(-1)):
        with pytest.raises(
            emmy.InputError, match=rf"must be a whole number from {least} to \d+, not {number}$"
        ) as raised:
            use(number)
        assert places(raised.value) == [place]
    for value in (1.0, True, np.True_, "1", None if place != "workers" else 2.5):
        with pytest.raises(TypeError, match=f"{place.replace('[', '.').replace(']', '.')}: "):
            use(value)


def test_whole_numbers_of_numpy_are_taken():
    assert emmy.Mesh.box((1, 1, 1), np.array([1, 2, 1])).n_cells == 2
    assert emmy.modes(held_block(), count=np.int32(2)).frequencies.shape == (2,)
    for make, wanted in ((emmy.Mesh.box, 3), (emmy.Mesh.rectangle, 2)):
        with pytest.raises(emmy.InputError, match=f"expected {wanted} whole numbers, found 4"):
            make((1,) * wanted, (1, 1, 1, 1))
        with pytest.raises(emmy.InputError, match="size: expected an array of shape"):
            make((1,), (1,) * wanted)


@pytest.mark.parametrize("scheme", ["FE(1)", "AS(5)", "AS(5, 0.8)", "DGM", "DGM(0.8)", "trapezoidal", "Bathe"])
def test_the_scheme_of_a_motion_is_the_word_that_makes_it(scheme):
    motion = emmy.Motion(free_block(), scheme)
    assert motion.scheme == scheme and motion.degree == 1
    assert emmy.Motion(free_block(), motion.scheme, motion.degree).scheme == scheme


def test_wrong_types_are_named():
    block = free_block()
    goal = emmy.Goal.displacement_at(block, node=0, direction=(1, 0, 0))
    motion = emmy.Motion(block, adjoint=True)
    for use, place in (
        (lambda: motion.gradient(5), "goal"),
        (lambda: motion.goal_error(None), "goal"),
        (lambda: motion.gradient(goal, [5]), r"parameters\[0\]"),
        (lambda: goal.value(5), "motion"),
        (lambda: emmy.Goal.displacement_at("x", node=0, direction=(1, 0, 0)), "body"),
        (lambda: emmy.Goal.velocity_at(None, node=0, direction=(1, 0, 0)), "body"),
        (lambda: emmy.modes(block, state=5), "state"),
        (lambda: emmy.modes("x"), "body"),
        (lambda: emmy.equilibrium(None), "body"),
        (lambda: spinning_block().run(observers=5), "observers"),
        (lambda: spinning_block().run(observers=[print, 5]), r"observers\[1\]"),
        (lambda: emmy.Motion(block, steps=(1.0, 0.1), initial=5), "initial"),
        (lambda: emmy.Mesh(np.zeros((1, 3)), [[0, 1, 2, 3]]), "cells"),
        (lambda: emmy.Mesh(np.zeros((1, 3)), {}, cell_groups=[0]), "cell_groups"),
        (lambda: emmy.Mesh(np.zeros((1, 3)), {}, facet_groups=[0]), "facet_groups"),
        (lambda: emmy.Mesh(np.zeros((1, 3)), {}, node_groups=[0]), "node_groups"),
        (lambda: emmy.Mesh.network([[0, 0, 0], [1, 0, 0]], [[0, 1]], groups=[0]), "groups"),
        (lambda: emmy.sweep("none.toml", [1]), "parameters"),
        (lambda: emmy.sweep("none.toml", {"x": 1}), "parameters.x"),
        (lambda: emmy.sweep("none.toml", {"x": "ab"}), "parameters.x"),
        (lambda: emmy.sweep("none.toml", {"x": [1, None]}), r"parameters.x\[1\]"),
        (lambda: emmy.check("none.toml", set=[1]), "set"),
        (lambda: emmy.check("none.toml", set={"a.b": [1, None]}), r"set.a.b\[1\]"),
        (lambda: emmy.State("0", *[np.zeros((1, 3))] * 3), "time"),
        (lambda: emmy.State(True, *[np.zeros((1, 3))] * 3), "time"),
        (lambda: emmy.State(None, *[np.zeros((1, 3))] * 3), "time"),
        (lambda: rubber().energy("text"), "strain"),
        (lambda: rubber().stress([[None] * 3] * 3), "strain"),
    ):
        with pytest.raises(TypeError, match=f"^{place}: "):
            use()


@pytest.mark.parametrize("missing", ["displacement", "velocity"])
def test_states_have_displacement_and_velocity(missing):
    arrays = dict.fromkeys(("displacement", "velocity"), np.zeros((8, 3))) | {missing: None}
    with pytest.raises(TypeError, match=f"^{missing}: NoneType in place of numbers$"):
        emmy.State(0.0, **arrays)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -np.inf])
def test_states_are_finite(value):
    wrong = np.zeros((8, 3))
    wrong[3, 1] = value
    for name in ("displacement", "velocity", "momentum", "displacement_low", "modes"):
        arrays = dict.fromkeys(("displacement", "velocity", "momentum"), np.zeros((8, 3))) | {name: wrong}
        with pytest.raises(emmy.InputError, match=f"^{name}: must be finite$"):
            emmy.State(0.0, **arrays)
    with pytest.raises(emmy.InputError, match="^time: must be finite, not"):
        emmy.State(value, *[np.zeros((8, 3))] * 3)
    velocity = np.zeros((free_block().mesh.n_nodes, 3))
    velocity[1, 2] = value
    with pytest.raises(emmy.InputError, match="^initial: must be finite$"):
        emmy.Motion(free_block(), initial=velocity)
    for use in (free_block().internal_force, free_block().strain_energy):
        with pytest.raises(emmy.InputError, match="^u: must be finite$"):
            use(velocity)
    with pytest.raises(emmy.InputError, match="^x: must be finite$"):
        emmy.Motion(free_block()).residual(velocity, 0.1)
    for goal in (emmy.Goal.displacement_at, emmy.Goal.velocity_at):
        with pytest.raises(emmy.InputError, match="^direction: must be finite$"):
            goal(free_block(), node=0, direction=(1, value, 0))


def test_the_time_of_a_state_is_a_number_of_any_kind():
    for time in (1, 1.0, np.float32(1), np.int64(1)):
        assert emmy.State(time, *[np.zeros((1, 3))] * 3).time == 1.0
    with pytest.raises(emmy.InputError, match="^time: the number is too large"):
        emmy.State(10**400, *[np.zeros((1, 3))] * 3)


def test_an_observer_needs_no_list():
    seen = []
    spinning_block().run(until=0.1, observers=lambda step, motion: seen.append(step.number))
    assert seen == [1, 2]


def test_results_of_a_motion_are_not_replaced_by_its_later_steps():
    motion = spinning_block()
    motion.run(until=0.25, output="o", every=1)
    kept = {path: path.read_bytes() for path in Path("o").rglob("*") if path.is_file()}
    message = "o holds the steps 0 to 5 of this motion; name another directory, or continue it with emmy.resume$"
    for again, name in ((motion, "o"), (motion, Path.cwd() / "o"), (motion, "p/../o"), (copy.copy(motion), "o")):
        # A later end would be a change as well.
        with pytest.raises(emmy.ResultsError, match=message):
            again.run(until=5.0, output=name)
        assert {path: path.read_bytes() for path in Path("o").rglob("*") if path.is_file()} == kept
    motion.run(until=0.5)
    with pytest.raises(emmy.ResultsError, match=message):
        motion.run(output="o")
    motion.run(output="p")
    assert emmy.Run("p").history["step"].tolist() == list(range(10, 21))
    with pytest.raises(emmy.ResultsError, match="p holds the steps 10 to 20 of this motion"):
        motion.run(until=2.0, output="p")
    # The whole motion again: an earlier run is replaced.
    spinning_block().run(until=0.1, output="o")
    assert emmy.Run("o").history["step"].tolist() == [0, 1, 2]


def test_results_without_steps_are_replaced():
    motion = spinning_block()

    def stop(step, motion):
        raise ZeroDivisionError

    motion.run(until=0.0, output="o")
    motion.run(until=0.1, output="o")
    assert emmy.Run("o").history["step"].tolist() == [0, 1, 2]
    with pytest.raises(ZeroDivisionError):
        motion.run(until=0.5, output="p", observers=stop)
    with pytest.raises(emmy.ResultsError, match="p holds the steps 2 to 3 of this motion"):
        motion.run(output="p")
    shutil.rmtree("p")
    motion.run(output="p")
    assert emmy.Run("p").history["step"][0] == 3


@pytest.mark.parametrize("value", [5, 0, "x", [1], True])
def test_an_output_that_is_no_table_is_named_by_the_reader(value):
    path = emmy.new("spinning-block")
    text = path.read_text().split("[output]")[0]
    line = str(value).lower() if isinstance(value, bool) else repr(value)
    Path("other.toml").write_text(f"output = {line}\n{text}")
    Path("third.toml").write_text(f"{text}\n[output]\ndirectory = 5\n")
    for run in (emmy.run, lambda *a, **k: emmy.converge(*a, [0.1, 0.2], **k)):
        with pytest.raises(emmy.InputError, match="^set: `output` must be a table"):
            run(path, set={"output": value})
        with pytest.raises(emmy.InputError, match="other.toml.*`output` must be a table"):
            run("other.toml")
        with pytest.raises(emmy.InputError, match="third.toml.*`directory` must be"):
            run("third.toml")
        with pytest.raises(emmy.InputError, match="^set: `directory` must be"):
            run(path, set={"output.directory": 5})
    with pytest.raises(emmy.InputError, match="`output` must be a table"):
        emmy.sweep("other.toml", {"region.0.density": [1, 2]})
    assert {own.name for own in Path.cwd().iterdir()} == {path.name, "other.toml", "third.toml"}


def test_facet_groups():
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]

    def mesh(group):
        return emmy.Mesh(points, {"tet4": [[0, 1, 2, 3]]}, facet_groups={"a": group})

    for group in ([[0, 1, 2]], ("nodes", [[0, 1, 2]]), [("nodes", [[0, 1, 2]])], [[[0, 1, 2]]]):
        assert mesh(group).group_nodes("a").tolist() == [0, 1, 2]
    assert mesh([[[0, 1, 2]], ("faces", [[0, 1]])]).group_nodes("a").tolist() == [0, 1, 2, 3]
    for group in ([[[0, 1, 2], [0, 1]]], [[0, 1, 2], [0, 1]], [("nodes", [[0, 1, 2], [0, 1]])]):
        with pytest.raises(emmy.InputError, match=r"^facet_groups.a: its rows have different lengths"):
            mesh(group)
    for group in (("foo", [[0, 1, 2]]), [("foo", [[0, 1, 2]])], ("", [[0, 1]])):
        with pytest.raises(emmy.InputError, match=r"^facet_groups.a: the rows are `nodes` or `faces`, not `(foo|)`$"):
            mesh(group)
    for group in (("nodes",), ("faces", [[0, 1]], [[0, 1]])):
        with pytest.raises(emmy.InputError, match=r"^facet_groups.a: expected a pair \(`(nodes|faces)`, rows\)"):
            mesh(group)


@pytest.mark.parametrize("name", ["part.msh", "part", "part.inp", ".vtu"])
def test_meshes_are_written_as_vtu(name):
    with pytest.raises(emmy.InputError, match=r"^path: meshes are written as .vtu") as raised:
        emmy.Mesh.box((1, 1, 1), (1, 1, 1)).write(name)
    assert places(raised.value) == ["path"] and not Path(name).exists()
    assert emmy.Mesh.box((1, 1, 1), (1, 1, 1)).write(Path("part.VTU")) == "part.VTU"


def test_replacing_a_part_of_an_energy():
    own = emmy.Energy("mu/2*(I1 - 3) - mu*ln(J) + lambda/2*ln(J)^2", mu=500.0, lambda_=1000.0)
    assert dataclasses.replace(own) == own and pickle.loads(pickle.dumps(own)) == own
    stiffer = dataclasses.replace(own, mu=600.0)
    assert stiffer == emmy.Energy(own.formula, lambda_=1000.0, mu=600.0)
    other = "mu/2*(I1 - 3) - mu*ln(J) + lambda/4*(J^2 - 1) - lambda/2*ln(J)"
    assert dataclasses.replace(own, formula=other) == emmy.Energy(other, mu=500.0, lambda_=1000.0)
    named = emmy.Energy("parameters/2*(I1 - 3) - parameters*ln(J) + 5*ln(J)^2", parameters=500.0)
    assert dataclasses.replace(named, parameters=600.0).parameters == (("parameters", 600.0),)


def test_numbers_that_are_too_large():
    with pytest.raises(emmy.InputError, match="density: the number is too large"):
        emmy.Region(rubber(), density=10**400)
    with pytest.raises(emmy.InputError, match="degree"):
        emmy.Motion(free_block(), degree=10**400, steps=(1.0, 0.1))


@pytest.mark.parametrize(
    ("steps", "error", "place"),
    [
        ({"until": 1.0, "size": 0.1}, TypeError, "steps"),
        ("1.0", TypeError, "steps"),
        (1.0, TypeError, "steps"),
        ((), emmy.InputError, "steps"),
        ((1.0, 0.1, 0.1), emmy.InputError, "steps"),
        ([(1.0, 0.1), 2.0], emmy.InputError, r"steps\[1\]"),
        ([(1.0, 0.1), (2.0,)], emmy.InputError, r"steps\[1\]"),
    ],
)
def test_steps_are_pairs(steps, error, place):
    with pytest.raises(error, match=rf"^{place}: expected a pair \(until, size\), or a list of pairs, found "):
        emmy.Motion(free_block(), steps=steps)


@pytest.mark.parametrize("steps", [[0.1, 0.05], np.array([0.1, 0.05]), [np.array([0.1, 0.05])], [[0.1, 0.05]]])
def test_forms_of_a_pair(steps):
    assert [step.time for step in spinning_block(steps=steps)] == [0.05, 0.1]


@pytest.mark.parametrize("until", [float("nan"), float("inf"), -float("inf"), np.nan])
def test_ends_are_finite(until):
    motion = spinning_block()
    with pytest.raises(emmy.InputError, match="until: must be finite, not"):
        motion.run(until)
    assert motion.number == 0
    with pytest.raises(emmy.InputError, match="until: must be finite, not"):
        emmy.sweep(lambda x: spinning_block(), {"x": [1]}, until=until)


def test_a_field_that_is_not_there():
    pytest.importorskip("pyvista")
    motion = spinning_block()
    for use in (motion.field, motion.fields, motion.to_pyvista):
        with pytest.raises(emmy.InputError, match='"nonsense" is not a field; there is displacement'):
            use("nonsense")


@pytest.mark.parametrize("value", [True, np.True_, np.array(True), np.ones(1), np.array(1j)])
def test_a_history_that_is_no_number(value):
    with pytest.raises(TypeError, match=r"^loads\[0\].history: .*<lambda> returned"):
        emmy.Body(
            emmy.Mesh.box((1, 1, 1), (1, 1, 1)),
            emmy.Region(rubber(), density=1.0),
            loads=emmy.Load("x-max", force=(1, 0, 0), history=lambda t: value),
        )


def test_a_convergence_error_has_the_place():
    motion = spinning_block(max_iterations=1, smallest_step=0.05)
    with pytest.raises(emmy.ConvergenceError) as raised:
        motion.run()
    error = raised.value
    assert isinstance(error.position, np.ndarray) and error.position.dtype == np.float64
    # It is that of the last good step, here the start.
    assert np.array_equal(error.position, motion.body.mesh.points[error.node])
    again = pickle.loads(pickle.dumps(error))
    assert np.array_equal(again.position, error.position) and again.node == error.node


def test_the_first_of_two_errors_comes_out():
    def break_it(step, motion):
        shutil.rmtree("out")
        raise ZeroDivisionError("mine")

    motion = spinning_block()
    with pytest.raises(ZeroDivisionError, match="mine") as raised:
        motion.run(output="out", observers=[break_it])
    (note,) = raised.value.__notes__
    assert note.startswith("then ResultsError: ")


def test_arguments_of_the_specification():
    body = held_block()
    u = 1e-3 * body.mesh.points
    assert body.internal_force(u=u).shape == (12, 3) and body.strain_energy(u=u) > 0.0
    for use in (body.internal_force, body.strain_energy):
        with pytest.raises(emmy.InputError, match=r"^u: expected an array of shape \(12, 3\), found \(3,\)"):
            use(u=np.zeros(3))
    pytest.importorskip("scipy")
    assert body.stiffness(u=u).shape == (36, 36)


def test_a_density_of_zero_is_named_as_it_was_given():
    with pytest.raises(emmy.InputError, match="must be positive, not 0"):
        emmy.Region(rubber(), density=0)


def test_a_motion_without_steps_has_no_steps_to_check(beam):
    # The critical step of such cells is far below 1; each step is checked by itself.
    motion = emmy.Motion(beam, "central-differences")
    with pytest.raises(emmy.ConvergenceError, match="critical step"):
        motion.step(1.0)
    assert motion.step(1e-6).number == 1
    with pytest.warns(emmy.EmmyWarning, match="the equilibrium is the undeformed body"):
        motion = emmy.Motion(beam, "central-differences", equilibrium=True)
    assert motion.step(1e-6).number == 1
    with pytest.raises(emmy.InputError, match="steps of 1 are unstable"):
        emmy.Motion(beam, "central-differences", steps=(1.0, 1.0))


def test_a_point_that_is_not_finite_has_no_nearest_node():
    with pytest.raises(emmy.InputError, match=r"^point: \[nan, 0.0, 0.0\] is not finite"):
        emmy.Mesh.box((1, 1, 1), (1, 1, 1)).nearest_node((float("nan"), 0, 0))


def test_a_strain_beyond_the_range_of_a_material():
    # det(1 + 2 E) < 0: no deformation has this strain.
    for response in (rubber().energy, rubber().stress):
        with pytest.raises(emmy.InputError, match=r"^strain: the material has no energy at the strain \[\[-3, "):
            response([np.zeros((3, 3)), np.diag([-3.0, 0.0, 0.0])])


def test_a_cell_turned_inside_out_is_named():
    mesh = emmy.Mesh.box((1, 2, 1), (1, 2, 1))
    u = np.where(mesh.points[:, 1:2] > 1.5, [0.0, -3.0, 0.0], 0.0)
    for use in (held_block().strain_energy, held_block().internal_force):
        with pytest.raises(emmy.MeshError, match=r"cell 1 is turned inside out: det F = -2$"):
            use(u)


def test_a_run_without_a_summary(tmp_path):
    (tmp_path / "history.csv").write_text("step,time\n")
    assert repr(emmy.Run(tmp_path)) == f"<emmy.Run: {tmp_path}>"


VALUES = st.one_of(
    st.none(), st.booleans(), st.integers(), st.integers(min_value=2**60), st.floats(), st.text(max_size=5),
    st.binary(max_size=3), st.lists(st.floats(), max_size=4), st.lists(st.lists(st.integers(), max_size=4), max_size=3),
    st.lists(st.tuples(st.floats(0, 10), st.floats(0, 1)), max_size=3), st.complex_numbers(),
    st.dictionaries(st.sampled_from(["tip", "energy", "tolerance", "point"]), st.floats() | st.text(max_size=3)),
)  # fmt: skip
SETTINGS = [
    "scheme", "degree", "steps", "until", "adaptive", "initial", "start", "tolerance", "max_iterations", "solver",
    "smallest_step", "probes", "reactions", "extremes", "values", "limits", "title", "units", "adjoint",
]  # fmt: skip
BODY = held_block()
ENDS = []


@settings(max_examples=500, deadline=None)
@given(*[st.dictionaries(st.sampled_from(SETTINGS), VALUES, max_size=1)] * 2)
def random_motion(one, other):
    arguments = one | other
    try:
        emmy.Motion(BODY, **{"steps": (0.1, 0.1)} | arguments)
    except (emmy.InputError, TypeError) as error:
        ENDS.append(type(error))
    else:
        ENDS.append(None)


@pytest.mark.filterwarnings("ignore::emmy.EmmyWarning")
def test_random_settings_end_in_an_input_error_or_a_type_error():
    ENDS.clear()
    random_motion()
    # All ends are reached often.
    assert all(ENDS.count(end) >= 10 for end in (None, emmy.InputError, TypeError)), ENDS


@pytest.mark.parametrize(
    ("made", "count"),
    [
        (lambda: emmy.Mesh.box((1, 1, 1), (1000, 1000, 1000)), "1.0e9"),
        (lambda: emmy.Mesh.box((1, 1, 1), (10**6, 10**6, 10**6)), "1.0e18"),
        (lambda: emmy.Mesh.rectangle((1, 1), (10**5, 10**5)), "1.0e10"),
        (lambda: emmy.Mesh.l_block(1e-9), "1.2e29"),
    ],
)
def test_shapes_of_more_cells_than_memory_are_rejected_at_once(made, count):
    with pytest.raises(emmy.InputError, match=f"this makes {count} cells; the limit is 2e7"):
        made()
