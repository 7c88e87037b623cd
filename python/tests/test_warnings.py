"""What is doubtful is said in a warning."""

import copy
import warnings

import emmy
import numpy as np
import pytest

from bodies import free_block, spinning_block


def messages(work):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        work()
    assert all(issubclass(own.category, emmy.EmmyWarning) and own.filename == __file__ for own in caught)
    return [str(own.message) for own in caught]


def test_a_body_that_nothing_moves():
    told = messages(lambda: emmy.Motion(free_block(), steps=(1.0, 0.5)))
    assert told == ["nothing moves this body: there is no load, no support that moves, and no initial velocity"]
    moving = np.tile([1.0, 0.0, 0.0], (12, 1))
    assert messages(lambda: emmy.Motion(free_block(), steps=(1.0, 0.5), initial=moving)) == []


def test_a_note_is_at_the_line_of_the_caller():
    emmy.new("spinning-block")
    far = {"output.probes": [{"name": "far", "point": (90.0, 0.0, 0.0)}]}
    problem = emmy.load("spinning-block.toml", set=far, until=0.2)
    for work in (
        problem.motion,
        lambda: emmy.run("spinning-block.toml", set=far, until=0.2, output="run"),
        lambda: emmy.run("spinning-block.toml", set=far, until=0.2, output="run", progress=True),
    ):
        (told,) = messages(work)
        assert "far" in told


def test_progress_is_no_warning_and_a_warning_is_no_progress(capfd):
    emmy.new("spinning-block")
    far = {"output.probes": [{"name": "far", "point": (90.0, 0.0, 0.0)}]}
    told = messages(lambda: emmy.run("spinning-block.toml", set=far, until=0.2, output="run", progress=True))
    shown = capfd.readouterr()
    assert len(told) == 1 and told[0] not in shown.err and "note" not in shown.err
    assert "written: " in shown.err and shown.out == ""


def test_a_copy_is_silent():
    made = []
    assert len(messages(lambda: made.append(emmy.Motion(free_block(), steps=(1.0, 0.5))))) == 1
    assert messages(lambda: copy.copy(made[0])) == [] and messages(lambda: copy.deepcopy(made[0])) == []


def test_a_probe_far_from_its_node():
    made = []
    body, turning = free_block(), emmy.Initial(angular_velocity=(0, 0, 1))
    told = messages(
        lambda: made.append(emmy.Motion(body, steps=(1.0, 0.5), initial=turning, probes={"far": (9.0, 0.0, 0.0)}))
    )
    assert len(told) == 1 and "far" in told[0] and told == made[0].notes


def test_steps_that_were_halved():
    motion = spinning_block(steps=(2.0, 0.5), max_iterations=3)
    told = messages(motion.run)
    halvings = sum(event.kind == "cut" for event in motion.events)
    assert halvings > 0
    assert told == [f"failed steps were halved {halvings} times; see `motion.events`"]
    # Nothing new happens after the end.
    assert messages(motion.run) == []


@pytest.mark.parametrize("march", [emmy.Motion.run, list])
def test_steps_that_miss_a_pulse(march):
    pulse = emmy.Load("x-max", force=(1, 0, 0), history="exp(-((t - 0.53)/0.001)^2)")
    own = free_block()
    motion = emmy.Motion(emmy.Body(own.mesh, own.regions, loads=pulse), steps=(1.0, 0.1))
    told = messages(lambda: march(motion))
    assert told == ["1 of 10 steps did not resolve a load or a given motion; the first one is in the events"]
    (event,) = motion.events
    assert (event.step, event.kind) == (6, "unresolved")
    assert event.message.startswith("a step of 0.1 does not resolve load")


def test_velocities_as_an_array_with_incompatible_modes():
    mesh = emmy.Mesh.box((1, 2, 1), (1, 2, 1))
    rubber = emmy.NeoHooke(lambda_=1000.0, mu=500.0)
    body = emmy.Body(mesh, emmy.Region(rubber, density=1.0, formulation="incompatible-modes"))
    motion = emmy.Motion(body, steps=(1.0, 0.5), initial=np.tile([1.0, 0.0, 0.0], (12, 1)))
    assert body.mass().shape == (36, 36) and body.mass().sum() == pytest.approx(3 * 2.0)
    motion.run()
    # Free flight of a mass of 2.
    np.testing.assert_allclose(motion.displacement, np.tile([1.0, 0.0, 0.0], (12, 1)), atol=1e-12)
    assert motion.record.kinetic_energy == pytest.approx(1.0, abs=1e-12)


def test_steps_that_do_not_resolve_the_motion():
    mesh = emmy.Mesh.box((100, 10, 10), (10, 1, 1))
    steel = emmy.NeoHooke(youngs_modulus=2.1e5, poissons_ratio=0.3)
    body = emmy.Body(
        mesh,
        emmy.Region(steel, density=7.85e-9),
        supports=emmy.Support("x-min", fix="xyz"),
        loads=emmy.Load("x-max", force=(0, 0, -100)),
    )
    made = []
    assert messages(lambda: made.append(emmy.Motion(body, scheme="DGM", steps=(4e-3, 1e-3)))) == []
    # A statement of the results, and no fault of the steps.
    assert messages(made[0].run) == []
    assert made[0].accuracy.startswith("coarse") and "accuracy in time: coarse" in made[0]._repr_html_()
    fine = emmy.Motion(body, scheme="DGM", steps=(1e-4, 1e-5))
    assert messages(fine.run) == [] and fine.accuracy.startswith("not estimated (")
    (told,) = messages(lambda: emmy.Motion(body, scheme="DGM", steps=(1e-3, 1e-2)))
    assert "longer than its phase" in told


def test_a_table_that_starts_late():
    load = emmy.Load(acceleration=(0, 0, 1), history=[(0.5, 2.0), (1.0, 0.0)])
    region = emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1)
    told = messages(lambda: emmy.Motion(emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), region, loads=load), steps=(1.0, 0.5)))
    assert told == ["load 0: the table begins at t = 0.5; its first value, 2, acts from t = 0 on"]
