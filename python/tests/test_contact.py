"""Contact with obstacles and of bodies with each other."""

import pickle
from pathlib import Path

import emmy
import numpy as np
import pytest

from bodies import rubber

FLOOR = emmy.Plane((0, 0, -0.1), (0, 0, 2))
REGION = emmy.Region(rubber(), density=1.0)
SPIN = emmy.Initial(velocity=(0.3, 0.1, -2.0), angular_velocity=(3.0, 0.5, 0.0), about=(0.5, 0.5, 0.5))


def block(*contacts):
    return emmy.Body(emmy.Mesh.box((1, 1, 1), (2, 2, 2)), REGION, contacts=contacts)


def above(obstacle=FLOOR, **arguments):
    return block(emmy.Contact("all", obstacle, **{"name": "floor", "distance": 0.05} | arguments))


def momentum(history):
    return np.stack([history[f"linear_momentum_{axis}"] for axis in "xyz"], axis=1)


def angular_momentum(history):
    return np.stack([history[f"angular_momentum_{axis}"] for axis in "xyz"], axis=1)


@pytest.mark.parametrize(("degree", "size"), [(1, 0.005), (2, 0.005), (3, 0.01)])
def test_a_block_bounces_off_a_plane(degree, size):
    motion = emmy.Motion(above(), "DGM", degree=degree, steps=(0.2, size), initial=SPIN)
    history = motion.run()
    energy = history["total_energy"]
    assert np.ptp(energy) < 1e-12 * energy[0]
    parts = history["kinetic_energy"] + history["strain_energy"] + history["contact_energy"]
    np.testing.assert_allclose(parts, energy, rtol=1e-14)
    # Before and after the impact the layer is empty; in it, the plane is nearer than its thickness.
    assert history["contact_energy"][[0, -1]].tolist() == [0.0, 0.0]
    assert history["contact_energy"].max() > 0.05 * energy[0]
    assert 0.1 < np.nanmin(history["smallest_gap"]) < 1.0
    before, after = momentum(history)[[0, -1]]
    assert before[2] == pytest.approx(-2.0, rel=1e-12) and after[2] > 1.0
    # The plane exerts no force along itself.
    np.testing.assert_allclose(after[:2], before[:2], atol=1e-12)
    # The impulse of the floor, and that of its moment, which is about the origin.
    for kind, of_block in (("force", momentum(history)), ("moment", angular_momentum(history))):
        means = np.stack([history[f"floor_{kind}_{axis}"][1:] for axis in "xyz"], axis=1)
        impulses = means * history["step_size"][1:, None]
        np.testing.assert_allclose(np.diff(of_block, axis=0), impulses, atol=1e-12)


def test_the_columns_of_a_step():
    motion = emmy.Motion(above(), steps=(0.1, 0.005), initial=SPIN)
    start = motion.record
    assert np.isnan(start.smallest_gap) and start.contact_points == 0 and start.contact_energy == 0.0
    assert pickle.loads(pickle.dumps(start)) == start
    while (step := next(motion)).contact_energy == 0.0:
        pass
    assert step["floor_force_z"] > 0.0 and 0.0 < step.smallest_gap < 1.0
    assert type(step.contact_points) is int and step.contact_points > 0
    history = motion.history
    assert history["contact_points"].dtype == np.int64 and history["contact_points"][-1] == step.contact_points
    assert np.isnan(history["smallest_gap"][0]) and history["smallest_gap"][-1] == step.smallest_gap
    # In a file the missing numbers are empty.
    motion.run(output="out")
    there = emmy.Run("out").history
    assert there["contact_points"].dtype == np.int64
    rows = len(there)
    for name in ("contact_energy", "smallest_gap", "contact_points", "floor_force_z"):
        np.testing.assert_array_equal(there[name], motion.history[name][-rows:])


def test_a_floor_that_comes_up_is_one_that_a_block_falls_on():
    falls = emmy.Initial(velocity=(0, 0, -2.0))
    at_rest = emmy.Motion(above(), steps=(0.2, 0.005), initial=falls).run()
    for path in ("2*t", (lambda t: 2 * t, lambda t: 2.0)):
        rises = emmy.Plane((0, 0, -0.1), (0, 0, 2), move={"z": path})
        body = above(rises)
        assert rises.move == {"z": path} and body.contacts[0].opponent == rises
        assert body.n_nodes == 28
        history = emmy.Motion(body, steps=(0.2, 0.005)).run()
        np.testing.assert_allclose(history["contact_energy"], at_rest["contact_energy"], atol=1e-10)
        np.testing.assert_allclose(history["linear_momentum_z"] - 2, at_rest["linear_momentum_z"], atol=1e-10)
        work = history["total_energy"] - history["external_work"]
        assert np.ptp(work) < 1e-12 and history["external_work"][-1] > 1.0
        np.testing.assert_allclose(history["floor-obstacle_force_z"], history["floor_force_z"], atol=1e-10)
    with pytest.raises(TypeError, match="move: str in place of a dict"):
        emmy.Plane((0, 0, 0), (0, 0, 1), move="t")
    with pytest.raises(emmy.InputError, match="w"):
        emmy.Plane((0, 0, 0), (0, 0, 1), move={"w": "t"})
    assert emmy.Plane((0, 0, 0), (0, 0, 1), move={}) == emmy.Plane((0, 0, 0), (0, 0, 1))


def test_a_body_without_contact_has_no_columns_of_it():
    assert not [name for name in emmy.Motion(block()).history.dtype.names if "contact" in name or "gap" in name]


def test_a_sphere_around_a_block_exerts_no_moment_about_its_centre():
    centre = np.array([0.5, 0.5, 0.5])
    body = above(emmy.Sphere(centre, 1.1, inside=True), name="bowl")
    thrown = emmy.Initial(velocity=(2.0, 0.5, 0.3), angular_velocity=(1.0, 2.0, 3.0), about=centre)
    history = emmy.Motion(body, steps=(0.6, 0.005), initial=thrown).run()
    assert history["contact_energy"].max() > 0.01
    assert np.abs(momentum(history) - momentum(history)[0]).max() > 0.5
    about_centre = angular_momentum(history) - np.cross(centre, momentum(history))
    np.testing.assert_allclose(about_centre, np.tile(about_centre[0], (len(history), 1)), atol=1e-11)
    assert np.ptp(history["total_energy"]) < 1e-12 * history["total_energy"][0]


def test_a_cylinder_as_an_axle():
    # A rod along x below the block, which falls onto it.
    body = above(emmy.Cylinder((0, 0.4, -0.45), (3, 0, 0), 0.4), name=None)
    falls = emmy.Initial(velocity=(0.3, 0, -2.0))
    history = emmy.Motion(body, steps=(0.2, 0.005), initial=falls).run()
    assert history["contact_energy"].max() > 0.01 and history["contact-1_force_z"][1:].max() > 0.0
    # It exerts no force along its axis, and it pushes the block aside.
    np.testing.assert_allclose(history["linear_momentum_x"], 0.3, atol=1e-12)
    assert abs(history["linear_momentum_y"][-1]) > 0.05
    assert np.ptp(history["total_energy"]) < 1e-12 * history["total_energy"][0]


def test_the_floor_bears_the_weight():
    weight = emmy.Load(acceleration=(0, 0, -10.0))
    mesh = emmy.Mesh.box((1, 1, 1), (2, 2, 2))
    guide = [emmy.Support("x-min", fix="x"), emmy.Support("y-min", fix="y")]
    floor = emmy.Contact("z-min", emmy.Plane((0, 0, -0.049), (0, 0, 1)), name="floor", distance=0.05)
    body = emmy.Body(mesh, REGION, guide, weight, contacts=floor)
    motion = emmy.Motion(body, steps=(0.1, 0.02), start=emmy.equilibrium(body))
    history = motion.run()
    np.testing.assert_allclose(history["floor_force_z"][1:], 10.0, rtol=1e-8)
    assert history["kinetic_energy"].max() < 1e-16


@pytest.mark.parametrize(
    ("make", "place", "words"),
    [
        (lambda: above(stiffness=-1.0), "stiffness", "must be positive, not -1"),
        (lambda: above(distance=0.0), "distance", "must be positive, not 0"),
        (lambda: above(law="soft"), "law", "`soft` is not a law; there is `smooth`, `linear`"),
        (lambda: above(name=""), "name", "name"),
        (lambda: emmy.Plane((0, 0), (0, 0, 1)), "point", "3 numbers"),
        (lambda: emmy.Plane((0, 0, 0), (0, 0, np.nan)), "normal", "finite"),
        (lambda: emmy.Sphere((0, 0, 0), 0.0), "radius", "must be positive, not 0"),
        (lambda: emmy.Cylinder((0, 0, 0), (0, 0, 1), -2.0), "radius", "must be positive, not -2"),
        (lambda: above(emmy.Plane((0, 0, 0), (0, 0, 0))), "contacts[0].opponent.normal", "the normal of its obstacle"),
        (lambda: above(emmy.Cylinder((0, 0, -9), (0, 0, 0), 1)), "contacts[0].opponent.axis", "the axis of its obstacle has no"),
        (lambda: above(emmy.Plane((0, 0, -0.1), (0, 0, -2))), "contacts[0].opponent.normal", "opposite one, [0, 0, 2]"),
        (lambda: above(emmy.Sphere((0, 0, 0), 1)), "contacts[0].opponent", "is not outside of the obstacle"),
        (lambda: block(emmy.Contact("z-mni", FLOOR)), "contacts[0].surfaces", "did you mean `z-min`"),
        (
            lambda: block(*2 * [emmy.Contact("all", FLOOR, name="floor")]),
            "contacts[",
            "contacts 1 and 2 both have this name",
        ),
    ],
)  # fmt: skip
def test_impossible_contacts(make, place, words):
    with pytest.raises(emmy.InputError) as raised:
        make()
    (fault,) = raised.value.faults
    assert fault.place.startswith(place) and words in str(raised.value), raised.value


@pytest.mark.parametrize(
    "opponent", [(FLOOR, emmy.Sphere((0, 0, -2), 1)), {"plane": {}}, 1.0], ids=lambda own: type(own).__name__
)
def test_opponents_are_obstacles_or_surfaces(opponent):
    with pytest.raises(TypeError, match=r"opponent: \w+ is neither the name of a surface nor an obstacle, such as"):
        emmy.Contact("all", opponent)
    with pytest.raises(TypeError, match=r"contacts\[0\]: emmy.Plane in place of emmy.Contact"):
        block(FLOOR)


INPUT = """
mesh.box = { size = [1, 1, 1], cells = [2, 2, 2] }
region = { material.neo-hooke = { lambda = 1000, mu = 500 }, density = 1 }
initial = { velocity = [0, 0, -2] }
time = { scheme = "DGM", steps = [{ until = 0.1, size = 0.005 }] }
output.every = 0

[[contact]]
surfaces = "all"
obstacle.plane = { point = [0, 0, -0.1], normal = [0, 0, 1] }
name = "floor"
distance = 0.05

[[contact]]
surfaces = "z-max"
obstacle.sphere = { centre = [0.5, 0.5, 0.5], radius = 3, inside = true }
stiffness = 800
law = "linear"

[[contact]]
surfaces = "x-max"
obstacle.cylinder = { point = [4, 0, 0], axis = [0, 0, 1], radius = 0.5 }
"""


def test_an_input_as_objects():
    Path("bounce.toml").write_text(INPUT)
    problem = emmy.load("bounce.toml")
    body = problem.body
    assert body.contacts == (
        emmy.Contact("all", emmy.Plane((0, 0, -0.1), (0, 0, 1)), name="floor", distance=0.05),
        emmy.Contact("z-max", emmy.Sphere((0.5, 0.5, 0.5), 3, inside=True), stiffness=800, law="linear"),
        emmy.Contact("x-max", emmy.Cylinder((4, 0, 0), (0, 0, 1), 0.5)),
    )
    text = body.to_toml()
    assert text.count("[[contact]]") == 3 and text.count("inside = true") == 1
    again = emmy.Body(body.mesh, body.regions, contacts=body.contacts)
    assert again.to_toml() == text
    there = emmy.run("bounce.toml", output="run").history
    motion = emmy.Motion(again, "DGM", steps=(0.1, 0.005), initial=emmy.Initial(velocity=(0, 0, -2)))
    for own in (problem.motion().run(), motion.run()):
        assert own["contact_energy"].max() > 0.0
        for name in own.dtype.names:
            if name != "wall_seconds":
                np.testing.assert_array_equal(own[name], there[name])


def test_two_obstacles_of_one_contact():
    shapes = "obstacle.plane = { point = [0, 0, -0.1], normal = [0, 0, 1] }"
    two = f"{shapes}\nobstacle.sphere = {{ centre = [0, 0, -3], radius = 1 }}"
    Path("two.toml").write_text(INPUT.replace(shapes, two))
    with pytest.raises(emmy.InputError, match=r"`plane`.*`sphere`"):
        emmy.load("two.toml")


def test_a_body_with_contacts_travels():
    body = above(stiffness=2000.0)
    assert repr(body) == "<emmy.Body: 8 cells, 1 contact, 81 degrees of freedom, 0 fixed>"
    other = pickle.loads(pickle.dumps(body))
    floor = emmy.Contact("all", FLOOR, name="floor", distance=0.05, stiffness=2000)
    assert other.contacts == body.contacts == (floor,)
    assert eval(repr(floor), vars(emmy)) == floor and hash(floor) == hash(other.contacts[0])
    assert floor != emmy.Contact("all", FLOOR, name="floor", distance=0.05)
    histories = [emmy.Motion(own, steps=(0.1, 0.005), initial=SPIN).run() for own in (body, other)]
    np.testing.assert_array_equal(*(history["total_energy"] for history in histories))
    assert "floor" in str(body)


def test_a_motion_in_an_impact_is_resumed_from_a_snapshot():
    motion = emmy.Motion(above(), steps=(0.2, 0.005), initial=SPIN)
    while next(motion).contact_energy == 0.0:
        pass
    other = emmy.Motion(motion.body, steps=(0.2, 0.005), start=pickle.loads(pickle.dumps(motion.snapshot())))
    rest, again = motion.run(), other.run()
    np.testing.assert_array_equal(rest["total_energy"][-len(again) :], again["total_energy"])
    np.testing.assert_array_equal(motion.displacement, other.displacement)


def test_the_summary_has_the_force_and_the_times_of_a_contact():
    motion = emmy.Motion(above(), steps=(0.2, 0.005), initial=SPIN)
    history = motion.run(output="out")
    (floor,) = emmy.Run("out").summary["contacts"]
    force = np.sqrt(sum(np.nan_to_num(history[f"floor_force_{axis}"]) ** 2 for axis in "xyz"))
    touches = force > 0.0
    assert floor["name"] == "floor" and touches.any()
    assert floor["largest_force"] == pytest.approx(force.max(), rel=1e-12)
    assert floor["largest_force_time"] == history["time"][force.argmax()]
    assert floor["intervals"] == np.count_nonzero(touches[1:] & ~touches[:-1]) > 0
    first, last = history["time"][touches][[0, -1]]
    assert floor["first_time"] == pytest.approx(first - 0.005, rel=1e-12) and floor["last_time"] == last
    assert floor["duration"] == pytest.approx(0.005 * touches.sum(), rel=1e-12)


def test_the_fields_of_contact():
    motion = emmy.Motion(above(), steps=(0.2, 0.005), initial=emmy.Initial(velocity=(0, 0, -2)))
    assert {"contact_pressure", "contact_gap"} <= set(motion.fields())
    heights = motion.body.mesh.points[:, 2]
    while next(motion).contact_energy == 0.0:
        pass
    pressure, gap = motion.field("contact_pressure"), motion.field("contact_gap")
    below = heights == 0.0
    # The distance to the floor, and what the layer does there.
    np.testing.assert_allclose(gap[below], 0.1 + motion.displacement[below, 2], rtol=1e-12)
    assert np.isnan(gap[~below]).all() and (pressure[~below] == 0.0).all() and (pressure[below] > 0.0).all()
    assert "contact_pressure" not in emmy.Motion(block()).fields()


def two_blocks(contact):
    lower = emmy.Mesh.box((1, 1, 1), (2, 2, 2))
    upper = emmy.Mesh.box((1, 1, 1), (3, 3, 3)).placed(at=(0.23, 1.07, 0.17))
    return emmy.Body(emmy.Mesh.joined({"lower": lower, "upper": upper}), REGION, contacts=contact)


MEET = (
    emmy.Initial(group="lower", velocity=(0, 1, 0), angular_velocity=(0.5, -0.3, 0.8), about=(0.5, 0.5, 0.5)),
    emmy.Initial(group="upper", velocity=(0.1, -1, 0), angular_velocity=(-0.35, 0.21, -0.56), about=(0.73, 1.57, 0.67)),
)


def test_two_blocks_meet():
    """The energies of an independent implementation."""
    for contact in (
        emmy.Contact("lower", "upper", name="impact", distance=0.05, stiffness=1333),
        emmy.Contact("all", name="impact", distance=0.05, stiffness=1333),
    ):
        history = emmy.Motion(two_blocks(contact), "DGM", steps=(0.15, 0.01), initial=MEET).run()
        energy = history["total_energy"]
        assert np.ptp(energy) < 1e-11 * energy[0]
        assert history["kinetic_energy"][-1] == pytest.approx(0.9954634056121302, abs=1e-7)
        assert history["strain_energy"][-1] == pytest.approx(0.1312199277209123, abs=1e-7)
        assert np.nanmin(history["smallest_gap"]) == pytest.approx(0.032798664072127656 / 0.05, abs=1e-7)
        for axis, momentum in zip("xyz", (0.1, 0.0, 0.0)):
            assert np.allclose(history[f"linear_momentum_{axis}"], momentum, atol=1e-12)
        # The lower block ends with the momentum -0.735 along y.
        assert 0.01 * history["impact_force_y"][1:].sum() == pytest.approx(-1.7350550149609543, abs=1e-7)


def test_two_surfaces_as_objects():
    contact = emmy.Contact("lower", "upper", name="impact", distance=0.05)
    body = two_blocks(contact)
    assert 'surfaces = ["lower", "upper"]' in body.to_toml()
    assert repr(contact) == "Contact(surface='lower', opponent='upper', name='impact', distance=0.05)"
    with pytest.raises(emmy.InputError, match="share a node"):
        block(emmy.Contact("x-max", "z-max"))
    with pytest.raises(emmy.InputError, match="contact of a body with itself is not there yet"):
        block(emmy.Contact("all"))
    with pytest.raises(emmy.InputError, match="intersect at .* inside the other body"):
        lower = emmy.Mesh.box((1, 1, 1), (2, 2, 2))
        mesh = emmy.Mesh.joined({"a": lower, "b": lower.placed(at=(0.4, 0.3, 0.45))})
        emmy.Body(mesh, REGION, contacts=emmy.Contact("a", "b"))
