"""Pickles, copies and snapshots."""

import copy
import dataclasses
import os
import pickle
from pathlib import Path

import emmy
import numpy as np
import pytest

from bodies import rubber, spinning_block


def again(value):
    return pickle.loads(pickle.dumps(value))


def ramp(t):
    return min(t, 1.0)


def test_parts():
    load = emmy.Load("y-max", force=np.array([1.0, 0.0, 0.0]), history=[(0, 0), (1, 1)])
    parts = [
        rubber(),
        emmy.Ogden(mu=[1.0, -0.5], alpha=[2.0, -2.0], bulk_modulus=10.0),
        emmy.Region(rubber(), density=1.0, group="body", viscosity=emmy.Viscosity(time=1e-3)),
        emmy.Support("y-min", fix="xyz"),
        load,
        emmy.Mass("y-max", 2.0),
        emmy.Tie("y-max", "y-min"),
        emmy.Contact("all", emmy.Sphere((0, 0, 0), 2.0, inside=True), stiffness=800, law="linear"),
        emmy.Rigid("hub", mass=5.0, centre=(0, 0, 0), inertia=(1.2, 1.0, 1.5)),
        emmy.Joint.revolute("hinge", between=("hub", "ground"), at=(0, 0, 0), axis=(0, 0, 1), angle="t^2"),
        emmy.Initial(velocity=(1, 2, 3)),
        emmy.Adaptive(1e-4, max_size=0.1),
    ]
    for part in parts:
        assert again(part) == part
        assert eval(repr(part), vars(emmy)) == part


def test_body(beam):
    own = emmy.Body(beam.mesh, beam.regions, beam.supports, emmy.Load("y-max", force=(1, 0, 0), history=ramp))
    other = again(own)
    assert other.regions == own.regions and other.loads == own.loads
    assert np.array_equal(other.mesh.points, own.mesh.points) and other.mesh.groups == own.mesh.groups
    one, two = (emmy.Motion(body, steps=(0.2, 0.05)) for body in (own, other))
    one.run(), two.run()
    assert np.array_equal(one.displacement, two.displacement)


def test_mesh_of_links():
    mesh = emmy.Mesh.network([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1], [1, 2]], {"end": [2]}, {"first": [0]})
    other = again(mesh)
    assert other.groups == mesh.groups and np.array_equal(other.cells["line2"], mesh.cells["line2"])


def test_mesh_of_solid_cells_and_links():
    # The cable begins at the tip of the tetrahedron; a link group keeps its name and stays a group of cells.
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 3)]
    mesh = emmy.Mesh(points, {"tet4": [(0, 1, 2, 3)], "line2": [(3, 4)]}, cell_groups={"solid": [0], "cable": [1]})
    for copied in (again(mesh), copy.copy(mesh)):
        assert copied.n_nodes == 5 and list(copied.cells) == ["tet4", "line2"]
        assert copied.groups == mesh.groups and copied.cells["line2"].tolist() == [[3, 4]]


def test_state_step_and_history(spinning):
    spinning.run()
    step, state = again(spinning.record), again(spinning.state)
    assert step == spinning.record and step.time == spinning.time
    assert np.array_equal(state.displacement, spinning.displacement) and state.step == 20
    assert np.array_equal(again(spinning.history), spinning.history)


def test_motion(spinning):
    with pytest.raises(TypeError, match=r"a Motion cannot be pickled; pickle motion.snapshot\(\) and the body"):
        pickle.dumps(spinning)


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy])
def test_copy(spinning, copied):
    for _ in range(7):
        next(spinning)
    other = copied(spinning)
    assert other.time == spinning.time and other.number == 7
    next(spinning)
    assert other.number == 7
    spinning.run(), other.run()
    assert np.array_equal(other.displacement, spinning.displacement)


def test_copy_of_an_extended_motion(spinning):
    spinning.run()
    spinning.extend(1.5, 0.1)
    other = copy.copy(spinning)
    spinning.run(), other.run()
    assert other.time == 1.5 and np.array_equal(other.displacement, spinning.displacement)


def shaken_beam():
    """A held beam under a load that changes its direction: the work of the load differs from step to step."""
    mesh = emmy.Mesh.box((1, 4, 1), (1, 4, 1))
    shake = emmy.Load("y-max", force=(30.0, 5.0, 20.0), history="sin(9*t)")
    return emmy.Body(mesh, emmy.Region(rubber(), density=1.0), emmy.Support("y-min", fix="xyz"), shake)


@pytest.mark.filterwarnings("ignore:failed steps were halved:emmy.EmmyWarning")
@pytest.mark.parametrize(
    ("plan", "cuts"),
    [
        ({"steps": (1.0, 0.05)}, False),
        ({"steps": (1.0, 0.05), "max_iterations": 2}, True),
        ({"until": 1.0, "adaptive": 1e-4}, False),
        ({"steps": (1.0, 0.05), "degree": 2}, False),
    ],
    ids=["planned", "cut", "adaptive", "degree 2"],
)
def test_a_snapshot_goes_on_in_every_bit(plan, cuts):
    whole = emmy.Motion(shaken_beam(), **plan)
    steps = []
    while whole.time < 0.41:
        steps.append(next(whole))
    snapshot = whole.snapshot()
    snapshot.save("a.emmy")
    history = whole.run()
    at_cut = [event.step for event in whole.events if event.kind == "cut"]
    # There are cuts before the snapshot and after it, and it lies inside a planned step.
    assert not cuts or (at_cut[0] <= snapshot.number < at_cut[-1] and abs(snapshot.time / 0.05 % 1 - 0.5) < 0.3)
    for start in (snapshot, again(snapshot), emmy.Snapshot.load("a.emmy")):
        rest = emmy.Motion(whole.body, **plan, start=start)
        assert rest.time == snapshot.time and rest.number == snapshot.number == steps[-1].number
        rest.run()
        for name in ("displacement", "velocity", "momentum"):
            assert np.array_equal(getattr(rest, name), getattr(whole, name)), name
        own, there = rest.history[1:], history[len(steps) + 1 :]
        assert len(own) == len(there) > 5
        for name in set(own.dtype.names) - {"wall_seconds"}:
            assert np.array_equal(own[name], there[name], equal_nan=own[name].dtype.kind == "f"), name


def test_a_state_as_the_start(spinning):
    for _ in range(10):
        next(spinning)
    rest = emmy.Motion(spinning.body, steps=(1.0, 0.05), start=spinning.state)
    spinning.run(), rest.run()
    assert rest.displacement == pytest.approx(spinning.displacement, abs=1e-9)


def test_damaged_snapshots(spinning):
    content = bytes(spinning.snapshot())
    for damaged in (b"", content[:-1], content[: len(content) // 2], bytes([content[0] ^ 1]) + content[1:]):
        Path("damaged.emmy").write_bytes(damaged)
        with pytest.raises(emmy.ResultsError):
            emmy.Snapshot.load("damaged.emmy")


def test_a_snapshot_of_another_body(spinning, beam):
    with pytest.raises(emmy.Error):
        emmy.Motion(beam, steps=(1.0, 0.1), start=spinning.snapshot())


def swinging(**arguments):
    body = spinning_block().body
    load = emmy.Load("x-max", force=(1, 2, 3), history="sin(9*t)")
    initial = emmy.Initial(angular_velocity=(0.5, 1.0, 2.0))
    return emmy.Motion(emmy.Body(body.mesh, body.regions, loads=load), initial=initial, **arguments)


def test_a_snapshot_stays_on_the_grid_of_the_plan():
    # 0.1 i differs from sums of 0.1 in its last bits.
    plan = (2.0, 0.1)
    whole = swinging(steps=plan).run()
    for steps in (1, 3, 6, 0):
        motion = swinging(steps=plan)
        for _ in range(steps):
            next(motion)
        if steps == 0:
            motion.run(until=0.95)
        snapshot = pickle.loads(pickle.dumps(motion.snapshot()))
        rest = emmy.Motion(motion.body, steps=plan, start=snapshot).run()
        if steps == 0:
            # Off the grid, the steps begin there.
            np.testing.assert_allclose(rest["time"][:3], [0.95, 1.05, 1.15], rtol=1e-15)
            continue
        first = len(whole) - len(rest)
        for name in ("time", "total_energy", "angular_momentum_x"):
            np.testing.assert_array_equal(rest[name], whole[name][first:])


def test_a_plan_may_begin_where_steps_by_hand_ended():
    motion = swinging()
    for _ in range(10):
        motion.step(0.1)
    assert motion.time == 0.9999999999999999
    other = emmy.Motion(motion.body, steps=[(1.0, 0.1), (2.0, 0.1)], start=motion.snapshot())
    other.run()
    assert other.number == 20 and other.time == 2.0


def test_a_start_before_the_plan():
    state = swinging().state
    early = emmy.State(-1.0, state.displacement, state.velocity, state.momentum)
    with pytest.raises(emmy.InputError, match="start: a plan begins at t = 0, but the state is one at t = -1"):
        emmy.Motion(swinging().body, steps=(1.0, 0.1), start=early)


def test_a_copy_keeps_a_plan_that_was_extended():
    motion = swinging(steps=(0.5, 0.1))
    motion.run(until=1.0)
    other = copy.copy(motion)
    assert other.time == 1.0 and list(other) == []
    motion.extend(1.5)
    again = copy.copy(motion)
    np.testing.assert_array_equal(again.run()["total_energy"][1:], motion.run()["total_energy"][-5:])


def test_velocities_of_driven_nodes_are_those_of_their_motion():
    mesh = emmy.Mesh.box((1, 2, 1), (1, 2, 1))
    support = emmy.Support("y-min", move={"x": "2*t"}, fix="yz")
    body = emmy.Body(mesh, emmy.Region(rubber(), density=1.0), support)
    motion = emmy.Motion(body, steps=(1.0, 0.5), initial=np.tile([5.0, 5.0, 5.0], (12, 1)))
    driven = mesh.group_nodes("y-min")
    np.testing.assert_array_equal(motion.velocity[driven], np.tile([2.0, 0.0, 0.0], (4, 1)))
    np.testing.assert_array_equal(np.delete(motion.velocity, driven, axis=0), np.full((8, 3), 5.0))
    np.testing.assert_allclose(motion.momentum, (body.mass() @ motion.velocity.ravel()).reshape(-1, 3), atol=1e-14)


def box(density=1.0, **arguments):
    region = emmy.Region(emmy.NeoHooke(youngs_modulus=1000.0, poissons_ratio=0.3), density=density)
    return emmy.Body(emmy.Mesh.box((1, 2, 1), (1, 2, 1)), region, **arguments)


@pytest.mark.parametrize("scheme", ["DGM", "DGM(0.5)", "trapezoidal", "Bathe", "central-differences"])
def test_a_kick_is_a_velocity_whose_momentum_follows(scheme):
    body, plan = box(), {"scheme": scheme, "steps": (0.1, 0.01)}
    first = emmy.Motion(body, **plan, initial=emmy.Initial(velocity=(1, 0, 0)))
    next(first)
    kicked = dataclasses.replace(first.state, velocity=first.state.velocity + np.array([0, 2.0, 0]))
    with pytest.raises(emmy.InputError, match="start: momentum and velocity of the start do not belong together"):
        emmy.Motion(body, **plan, start=kicked)
    history = (second := emmy.Motion(body, **plan, start=dataclasses.replace(kicked, momentum=None))).run()
    # m v^2/2 with m = 2 and v = (1, 2, 0).
    assert history["kinetic_energy"] == pytest.approx(5.0, abs=1e-11)
    assert second.velocity[0] == pytest.approx([1, 2, 0], abs=1e-11) and second.number == 10
    assert abs(history["energy_residual"]).max() < 1e-11
    # A momentum alone is no kick.
    pushed = dataclasses.replace(first.state, momentum=2 * first.state.momentum)
    with pytest.raises(emmy.InputError, match="do not belong together"):
        emmy.Motion(body, **plan, start=pushed)


def test_a_start_of_a_body_of_other_masses():
    plan = {"steps": (1.0, 0.1)}
    first = emmy.Motion(box(), **plan, initial=emmy.Initial(velocity=(1, 0, 0), angular_velocity=(0, 0, 1)))
    next(first), next(first)
    for start in (first.snapshot(), first.state):
        with pytest.raises(emmy.InputError, match="do not belong together"):
            emmy.Motion(box(density=3.0), **plan, start=start)
    heavy = emmy.Motion(box(density=3.0), **plan, start=dataclasses.replace(first.state, momentum=None))
    assert heavy.record.kinetic_energy == pytest.approx(3 * first.record.kinetic_energy, rel=1e-12)
    # Held nodes are at rest.
    held = box(supports=emmy.Support("y-min", fix="xyz"))
    with pytest.raises(emmy.InputError, match="start: the start does not belong to the body: node .* moves"):
        emmy.Motion(held, **plan, start=first.snapshot())
    rest = emmy.Motion(held, **plan, start=dataclasses.replace(first.state, momentum=None))
    assert np.all(rest.velocity[held.mesh.points[:, 1] == 0] == 0) and rest.number == 2


@pytest.mark.parametrize("scheme", ["HHT(0.1)", "generalized-alpha(0.8)", "Bathe", "central-differences", "DGM"])
def test_a_snapshot_of_other_loads_has_accelerations_of_its_own(scheme):
    # These schemes remember the acceleration, which other loads change. The speed a t stays in free flight.
    plan = {"scheme": scheme, "steps": (0.2, 0.01)}
    first = emmy.Motion(box(loads=emmy.Load("body", acceleration=(3, 0, 0))), **plan)
    next(first)
    second = emmy.Motion(box(), **plan, start=first.snapshot())
    second.run()
    assert second.velocity[:, 0] == pytest.approx(0.03, abs=1e-12)


def test_a_snapshot_with_functions_goes_on_in_every_bit_in_a_body_made_again():
    def body():
        return box(loads=emmy.Load("y-max", traction=(1, 2, 0), history=ramp), supports=emmy.Support("y-min", fix="xyz"))

    plan = {"scheme": "generalized-alpha(0.8)", "steps": (0.2, 0.01)}
    first = emmy.Motion(body(), **plan)
    next(first)
    second = emmy.Motion(body(), **plan, start=again(first.snapshot()))
    first.run(), second.run()
    assert np.array_equal(first.velocity, second.velocity)


def test_a_device_or_a_pipe_is_no_snapshot():
    os.mkfifo("pipe.emmy")
    for path in ("/dev/zero", "pipe.emmy"):
        with pytest.raises(emmy.ResultsError, match=f"{path}: it is a device or a pipe, not a regular file"):
            emmy.Snapshot.load(path)
