"""Rigid bodies and joints."""

import pickle

import emmy
import numpy as np
import pytest

GRAVITY = emmy.Load(acceleration=(0, 0, -9.81))
AXIS = np.array([0.0, -np.sin(0.6), np.cos(0.6)])


def heavy_top():
    top = emmy.Rigid("top", mass=1.0, centre=AXIS, inertia=0.2 * np.outer(AXIS, AXIS) + 0.3 * np.eye(3))
    tip = emmy.Joint.spherical("tip", between=("top", "ground"), at=(0, 0, 0))
    return emmy.Body(rigid=top, joints=tip, loads=GRAVITY)


def test_a_heavy_top_without_a_mesh():
    body = heavy_top()
    assert repr(body) == "<emmy.Body: 1 rigid body, 1 joint, 12 degrees of freedom, 0 fixed>"
    assert pickle.loads(pickle.dumps(body.mesh)).n_nodes == 0
    assert (body.mesh.n_cells, body.mesh.n_nodes, body.n_nodes) == (0, 0, 4)
    assert body.total_mass == pytest.approx(1.0, rel=1e-14)
    np.testing.assert_allclose(body.center_of_mass, AXIS, atol=1e-14)
    assert body.mobility == emmy.Mobility(1, 1, 3, 0, 3, 0, ())
    motion = emmy.Motion(body, degree=2, steps=(1.0, 0.01), initial=emmy.Initial(angular_velocity=20 * AXIS))
    history = motion.run()
    place = [history[f"top_{axis}"][-1] for axis in "xyz"]
    # Elliptic functions, and the error of an independent implementation.
    exact = [0.5095952148872175, -0.24667568140632803, 0.8242959572670331]
    assert np.linalg.norm(np.subtract(place, exact)) == pytest.approx(2.152286e-6, rel=0.02)
    np.testing.assert_allclose(motion.positions[0], place, rtol=1e-14)
    assert history["constraint_residual"].max() < 1e-13
    assert np.abs(history["energy_residual"]).max() < 1e-11
    assert np.isnan(history["tip_force_z"][0]) and np.isnan(history["tip_moment_x"][0])
    step = next(iter(emmy.Motion(body, steps=(0.1, 0.01))))
    assert step["tip_force_z"] == step.tip_force_z > 0


def test_a_driven_hinge_turns_by_its_angle():
    def angle(t):
        return 2 * np.pi * t - 2 * np.sin(np.pi * t)

    def rate(t):
        return 2 * np.pi * (1 - np.cos(np.pi * t))

    bodies = [
        emmy.Rigid("a", mass=2.0, centre=(1.0, 0.0, 0.3), inertia=(0.5, 0.6, 0.8)),
        emmy.Rigid("b", mass=1.0, centre=(-0.7, 0.4, 0.0), inertia=(0.3, 0.25, 0.2)),
    ]
    place = {"between": ("a", "b"), "at": (0.4, 0.1, -0.2), "axis": (0.3, -0.2, 0.9)}
    flies = emmy.Initial(angular_velocity=(0.7, -1.1, 0.9))
    histories = []
    for given in ((angle, rate), "2*pi*t - 2*sin(pi*t)"):
        body = emmy.Body(rigid=bodies, joints=emmy.Joint.revolute("drive", **place, angle=given))
        assert body.mobility.n_constraints == 6
        histories.append(emmy.Motion(body, degree=2, steps=(2.0, 0.05), initial=flies).run())
    history = histories[0]
    assert history["drive_angle"][-1] == pytest.approx(4 * np.pi, rel=1e-12)
    work = history["external_work"][-1]
    assert history["total_energy"][-1] - history["total_energy"][0] == pytest.approx(work, rel=1e-10)
    momentum = np.stack([history[f"angular_momentum_{axis}"] for axis in "xyz"])
    np.testing.assert_allclose(momentum - momentum[:, :1], 0.0, atol=1e-12)
    np.testing.assert_allclose(histories[1]["drive_torque"][1:], history["drive_torque"][1:], rtol=1e-9)
    assert history.peak("drive_torque").largest > 0


def test_slides_and_distances():
    body = emmy.Body(
        rigid=[
            emmy.Rigid("cart", mass=2.0, centre=(1, 0, 0), inertia=(0.5, 0.6, 0.8)),
            emmy.Rigid("ball", mass=3.0, centre=(2, 0, 0)),
        ],
        joints=[
            emmy.Joint.prismatic("s", between=("cart", "ground"), at=(0, 0, 0), axis=(0, 0.6, 0.8), slide="0.3*t^2"),
            emmy.Joint.distance(between=("ball", "ground"), points=[(2, 0, 0), (0, 0, 0)], length="2 + 0.3*t^2"),
        ],
    )
    step = emmy.Motion(body, degree=2, steps=(1.0, 0.1)).run()[-1]
    assert [step[name] for name in ("cart_x", "cart_y", "cart_z")] == pytest.approx([1, 0.18, 0.24], abs=1e-12)
    # The masses 2 and 3 at an acceleration of 0.6.
    assert step["s_drive_force"] == pytest.approx(1.2, abs=1e-10)
    assert step["joint-2_drive_force"] == pytest.approx(1.8, abs=1e-10)
    assert step["joint-2_distance"] == pytest.approx(2.3, abs=1e-12)
    names = step.dtype.names
    assert "ball_x" in names and "ball_spin_x" not in names and "joint-2_moment_z" in names


def test_an_elastic_block_on_a_link():
    mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    link = emmy.Joint.distance("link", between=("x-min", "ground"), points=[(0, 0, 1), (0, 0, 3)])
    rubber = emmy.Region(emmy.NeoHooke(lambda_=1000.0, mu=500.0), density=1.0)
    bob = emmy.Rigid("bob", mass=0.5, centre=(1, 0, -1))
    rod = emmy.Joint.distance("rod", between=("x-max", "bob"), points=[(1, 0, 0), (1, 0, -1)])
    body = emmy.Body(mesh, rubber, loads=GRAVITY, rigid=bob, joints=[link, rod])
    assert body.mesh is mesh and body.mobility.degrees_of_freedom is None
    assert repr(body).startswith("<emmy.Body: 1 cells, 1 rigid body, 2 joints, 27 degrees of freedom")
    motion = emmy.Motion(body, degree=2, steps=(0.2, 0.01))
    history = motion.run()
    assert motion.displacement.shape == (9, 3) and body.n_nodes == 9
    assert history["link_distance"][-1] == pytest.approx(2.0, abs=1e-13)
    np.testing.assert_allclose(motion.positions[8], [history[f"bob_{axis}"][-1] for axis in "xyz"], atol=1e-14)
    grid = motion.to_pyvista()
    assert grid.n_points == 9 and grid.n_cells == 1


def test_faces_of_a_mesh_are_rigid_bodies():
    mesh = emmy.Mesh.box((1, 2, 1), (1, 2, 1))
    rubber = emmy.Region(emmy.NeoHooke(lambda_=1000.0, mu=500.0), density=2.0)
    plate = emmy.Rigid("plate", group="y-max", mass=0.5)
    hinge = emmy.Joint.revolute("hinge", between=("plate", "ground"), at=(0.5, 2, 0.5), axis=(1, 0, 0))
    body = emmy.Body(mesh, rubber, rigid=plate, joints=hinge, loads=GRAVITY)
    assert body.mobility.degrees_of_freedom is None and body.n_nodes == 12 + 4
    motion = emmy.Motion(body, degree=2, steps=(0.2, 0.05))
    history = motion.run()
    np.testing.assert_allclose(history["plate_z"], 0.5, atol=1e-14)
    energy = history["total_energy"] - history["external_work"]
    np.testing.assert_allclose(energy, energy[0], atol=1e-12)
    # The nodes of the face keep their distances.
    face = np.flatnonzero(mesh.points[:, 1] == 2.0)
    sides = [np.linalg.norm(points[face][:, None] - points[face], axis=2) for points in (mesh.points, motion.positions)]
    np.testing.assert_allclose(sides[0], sides[1], atol=1e-13)


def test_kinds_of_joints_have_their_keys():
    tables = emmy.schema()["properties"]["joint"]["properties"]
    kinds = {key for key, table in tables.items() if "between" in table.get("properties", {})}
    fields = set(emmy.Joint.__dataclass_fields__)
    assert fields - {"kind"} >= set(tables) - kinds
    for kind in kinds:
        assert set(tables[kind]["properties"]) <= fields, kind
        assert callable(getattr(emmy.Joint, kind))


def test_every_kind_is_a_table_of_the_input(tmp_path):
    ends = {"between": ("a", "b")}
    place = ends | {"at": (0.4, 0.1, -0.2)}
    axis = place | {"axis": (0.3, -0.2, 0.9)}
    points = ends | {"points": [(0, 0, 0), (0.4, 0, 0)]}
    bodies = [
        emmy.Rigid("a", mass=2.0, centre=(1.0, 0.0, 0.3), inertia=(0.5, 0.6, 0.8)),
        emmy.Rigid("b", mass=1.0, centre=(-0.7, 0.4, 0.0), inertia=(0.3, 0.25, 0.2)),
    ]
    for joint in (
        emmy.Joint.spherical("j", **place),
        emmy.Joint.revolute("j", **axis),
        emmy.Joint.revolute("j", **axis, spring={"stiffness": 4.0}, damping=0.3, torque="0.5*sin(3*t)"),
        emmy.Joint.universal("j", **place, axes=[(1, 0, 0), (0, 1, 0)]),
        emmy.Joint.cylindrical("j", **axis, until=0.05),
        emmy.Joint.prismatic("j", **axis),
        emmy.Joint.inline("j", **axis),
        emmy.Joint.planar("j", **axis),
        emmy.Joint.fixed("j", **place),
        emmy.Joint.distance("j", **points),
        emmy.Joint.line("j", **points, spring={"stiffness": 40.0, "rest": 0.3}),
    ):
        body = emmy.Body(rigid=bodies, joints=joint, loads=GRAVITY)
        other = pickle.loads(pickle.dumps(body))
        assert other.joints == (joint,) and other.rigid == tuple(bodies)
        file = tmp_path / "body.toml"
        file.write_text(body.to_toml() + '[time]\nscheme = "DGM"\nsteps = [{ until = 0.1, size = 0.05 }]\n')
        problem = emmy.load(file)
        assert repr(problem.body.joints[0]) == repr(joint)
        history, there = emmy.Motion(body, steps=(0.1, 0.05)).run(), problem.motion().run()
        for name in history.dtype.names:
            if name != "wall_seconds":
                np.testing.assert_array_equal(there[name], history[name], err_msg=name)


def test_mistakes():
    arm = emmy.Rigid("arm", mass=1.0, centre=(1, 0, 0), inertia=(0.1, 0.2, 0.2))
    with pytest.raises(emmy.InputError, match="exceeds 0.3 \\+ 0.4") as raised:
        emmy.Rigid("arm", mass=1.0, centre=(0, 0, 0), inertia=(0.9, 0.3, 0.4))
    assert raised.value.faults[0].place == "inertia"
    with pytest.raises(emmy.InputError) as raised:
        emmy.Joint.revolute("hinge", between=("arm", "ground"), at=(0, 0, 0), axis=(0, 0, 0))
    assert raised.value.faults[0].place == "axis"
    with pytest.raises(TypeError, match="angle: a function comes with its rate"):
        emmy.Joint.revolute("hinge", between=("arm", "ground"), at=(0, 0, 0), axis=(0, 0, 1), angle=lambda t: t)
    with pytest.raises(emmy.InputError, match="no rigid body, coupling or group `arn`.*\n?") as raised:
        emmy.Body(rigid=arm, joints=emmy.Joint.spherical("tip", between=("arn", "ground"), at=(0, 0, 0)))
    assert raised.value.faults[0].place.startswith("joints[0].between")
    with pytest.raises(emmy.InputError, match="a body needs a mesh or a rigid body"):
        emmy.Body()
    with pytest.raises(emmy.InputError, match="needs? a time element"):
        emmy.Motion(emmy.Body(rigid=arm), scheme="Newmark(0.25,0.5)", steps=(1.0, 0.1))


def test_a_run_of_rigid_bodies(tmp_path):
    body = heavy_top()
    motion = emmy.Motion(body, degree=2, steps=(0.2, 0.02), initial=emmy.Initial(angular_velocity=20 * AXIS))
    motion.run(output=tmp_path / "out")
    results = emmy.Run(tmp_path / "out")
    assert results.summary["constraints"] == 3
    assert 0 < results.summary["worst_constraint_residual"] < 1e-13
    assert results.summary["tip_force_z_max"] > 0
    snapshot = motion.snapshot()
    again = emmy.Motion(body, degree=2, steps=(0.4, 0.02), start=snapshot)
    motion.extend(0.4)
    whole, later = motion.run(), again.run()
    assert later["top_x"][-1] == whole["top_x"][-1]


def test_a_wheel_that_is_turned_and_let_go():
    wheel = emmy.Rigid("wheel", mass=2.0, centre=(0, 0, 0), inertia=(0.1, 0.1, 0.18))
    axle = emmy.Joint.cylindrical("axle", between=("wheel", "ground"), at=(0, 0, 0), axis=(0, 0, 1), until=0.5)
    stop = emmy.Joint.line("stop", between=("wheel", "ground"), points=[(1, 0, 0), (2, 0, 0)], damping=1e-9)
    body = emmy.Body(rigid=wheel, joints=[axle, stop], loads=emmy.Load("wheel", moment=(0, 0, 0.36)))
    assert body.mobility[:6] == (1, 2, 4, 0, 2, 0)
    start = emmy.Initial(velocity=(0, 0, 0.2))
    motion = emmy.Motion(body, degree=2, steps=(1.0, 0.125), initial=start, joints=["axle"])
    history = motion.run()
    assert "axle_slide" in history.dtype.names and "stop_distance" not in history.dtype.names
    assert history["axle_slide"][-1] == pytest.approx(0.2, abs=1e-9)  # less what the damper takes
    assert history["angular_momentum_z"][-1] == pytest.approx(0.36, abs=1e-8)
    assert (history["axle_force_z"][5:] == 0).all()
    with pytest.raises(emmy.InputError, match="there is no joint `axel`"):
        emmy.Motion(body, steps=(1.0, 0.1), joints=["axel"])


def bar(**force):
    """A bar of 2 kg on a hinge in its end, with the inertia 0.4 + 2 * 0.25 about it."""
    own = emmy.Rigid("bar", mass=2.0, centre=(0.5, 0, 0), inertia=(0.1, 0.4, 0.4))
    hinge = emmy.Joint.revolute("hinge", between=("bar", "ground"), at=(0, 0, 0), axis=(0, 0, 1), **force)
    return emmy.Body(rigid=own, joints=hinge)


def test_modes_of_a_bar_on_a_spring():
    modes = emmy.modes(bar(spring={"stiffness": 7.0}), 1)
    np.testing.assert_allclose(2 * np.pi * modes.frequencies, [np.sqrt(7.0 / 0.9)], rtol=1e-12)


def test_a_spring_is_wound_up_over_full_turns():
    body = bar(spring={"stiffness": 0.05}, torque=0.4)
    state = emmy.equilibrium(body)
    np.testing.assert_allclose(state.coordinates, [8.0], rtol=1e-9)
    modes = emmy.modes(body, 1, state=state)
    np.testing.assert_allclose(2 * np.pi * modes.frequencies, [np.sqrt(0.05 / 0.9)], rtol=1e-8)
    history = emmy.Motion(body, degree=2, steps=(1.0, 0.1), start=state).run()
    np.testing.assert_allclose(history["hinge_angle"], 8.0, rtol=1e-9)
    np.testing.assert_allclose(history["strain_energy"], 0.5 * 0.05 * 64, rtol=1e-9)
    # Without the motor it unwinds: theta = 8 cos w t.
    start = emmy.State(0.0, state.displacement, state.velocity, coordinates=state.coordinates)
    history = emmy.Motion(bar(spring={"stiffness": 0.05}), degree=3, steps=(10.0, 0.1), start=start).run()
    exact = 8 * np.cos(np.sqrt(0.05 / 0.9) * history["time"])
    np.testing.assert_allclose(history["hinge_angle"], exact, atol=1e-5)
    with pytest.raises(emmy.InputError, match="2 numbers given, but the body has 1 joint"):
        wrong = emmy.State(0.0, state.displacement, state.velocity, coordinates=[1.0, 2.0])
        emmy.Motion(body, steps=(1.0, 0.1), start=wrong)


def test_forces_that_are_not_unique_are_in_the_notes():
    door = emmy.Rigid("door", mass=20.0, centre=(0.5, 0, 1), inertia=(7, 9, 3))
    hinges = [emmy.Joint.revolute(f"hinge-{z}", between=("door", "ground"), at=(0, 0, z), axis=(0, 0, 1)) for z in (0, 2)]
    body = emmy.Body(rigid=door, joints=hinges)                      # without a warning
    assert body.notes[0].startswith("single forces and moments of the joints `hinge-0`, `hinge-2` are not unique")
    assert body.mobility.indeterminate == ("hinge-0", "hinge-2")
