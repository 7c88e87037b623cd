"""Accelerations, and motions relative to the base."""

import emmy
import numpy as np
import pytest


def rubber():
    return emmy.Region(emmy.NeoHooke(lambda_=1000.0, mu=500.0), density=2.0)


def test_a_falling_body_has_the_acceleration_of_gravity():
    body = emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), rubber(), loads=[emmy.Load(acceleration=(1, 2, -9))])
    motion = emmy.Motion(body, steps=(0.1, 0.01))
    assert np.isnan(motion.field("acceleration")).all()
    motion.step(0.01)
    np.testing.assert_allclose(motion.field("acceleration"), np.tile([1.0, 2.0, -9.0], (8, 1)), atol=1e-10)


def test_the_motion_of_the_base_is_taken_off():
    """The base moves by 2 t^2: its relative displacement is zero, and all others differ by this path."""
    supports = [emmy.Support("x-min", move={"x": "2*t^2"}, fix="yz")]
    body = emmy.Body(emmy.Mesh.box((2, 1, 1), (2, 1, 1)), rubber(), supports=supports)
    probes = {"tip": (2, 0, 0), "seen": {"point": (2, 0, 0), "relative_to": "ground"}}
    told = emmy.Motion(body, steps=(0.1, 0.01), probes=probes, relative_to="base")
    absolute = emmy.Motion(body, steps=(0.1, 0.01))
    history = told.run()
    absolute.run()
    difference = absolute.field("displacement") - told.field("displacement")
    np.testing.assert_allclose(difference, np.tile([0.02, 0.0, 0.0], (12, 1)), atol=1e-13)
    difference = absolute.field("acceleration") - told.field("acceleration")
    np.testing.assert_allclose(difference, np.tile([4.0, 0.0, 0.0], (12, 1)), atol=1e-9)
    times = history["time"]
    np.testing.assert_allclose(history["seen_x"] - history["tip_x"], 2 * times**2, atol=1e-12)
    np.testing.assert_array_equal(told.field("von_mises_stress"), absolute.field("von_mises_stress"))


def test_a_body_at_rest_has_no_base():
    body = emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), rubber(), supports=[emmy.Support("x-min", fix="xyz")])
    with pytest.raises(emmy.InputError, match="no support moves"):
        emmy.Motion(body, steps=(0.1, 0.01), relative_to="base")


def test_pictures_are_seen_from_the_base():
    pytest.importorskip("pyvista")
    supports = [emmy.Support("x-min", move={"x": "2*t^2"}, fix="yz")]
    body = emmy.Body(
        emmy.Mesh.box((2, 1, 1), (2, 1, 1)), rubber(), supports=supports,
        masses=emmy.Mass("x-max", mass=1.0, at=(3, 0.5, 0.5), inertia=(1, 1, 1), name="head"),
    )  # fmt: skip
    motion = emmy.Motion(body, steps=(0.1, 0.01), relative_to="base")
    motion.run()
    grid = motion.to_pyvista(group="body")
    # Without the nodes of the mass.
    assert grid.n_points == 12
    held = grid.points[:, 0] == 0.0
    np.testing.assert_allclose(grid.point_data["displacement"][held], 0.0, atol=1e-15)
    np.testing.assert_allclose(motion.displacement[:12][held], np.tile([0.02, 0, 0], (4, 1)), atol=1e-15)
    # The head is seen from there, too.
    path = motion.field("displacement")[body.mesh.group_nodes("x-max")].mean(axis=0)
    assert abs(motion.history["head_x"][-1] - 3.0 - path[0]) < 1e-3
