"""Natural modes about states, and their residuals."""

import numpy as np
import pytest

import emmy


def chain() -> emmy.Body:
    """A mass of 0.5 between two springs of stiffness 3 and rest length 1, whose other ends are held."""
    mesh = emmy.Mesh.network([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1), (1, 2)], groups={"ends": [0, 2], "middle": [1]})
    return emmy.Body(
        mesh,
        emmy.Region(emmy.Spring(stiffness=3.0)),
        supports=emmy.Support("ends", fix="xyz"),
        masses=[emmy.Mass("ends", mass=1.0), emmy.Mass("middle", mass=0.5)],
    )


def test_a_state_and_a_snapshot_count():
    # Both springs are stretched to 1.1: the tension 0.3 holds the mass across with 4 T/L.
    body = chain()
    u = np.array([[0.0, 0, 0], [0.1, 0, 0], [0.2, 0, 0]])
    zero = np.zeros((3, 3))
    state = emmy.State(0.0, u, zero, zero)
    expected = np.sqrt(4 * 0.3 / 2.2 / 0.5) / (2 * np.pi)
    motion = emmy.Motion(body, steps=(1.0, 0.1), start=state)
    for about in (state, motion.snapshot()):
        modes = emmy.modes(body, 1, state=about)
        assert modes.frequencies[0] == pytest.approx(expected, rel=1e-12)
        assert modes.residuals.shape == (1,) and modes.residuals[0] < 1e-6
    assert emmy.modes(body, 3).rigid == 2
    assert emmy.modes(body, 3).frequencies[2] == pytest.approx(np.sqrt(6 / 0.5) / (2 * np.pi), rel=1e-12)


def test_two_masses_on_a_spring():
    # omega^2 = k (1/m_1 + 1/m_2), whatever the number of modes.
    mesh = emmy.Mesh.network([(0, 0, 0), (1, 2, 0.5)], [(0, 1)], groups={"a": [0], "b": [1]})
    masses = [emmy.Mass("a", mass=2.0), emmy.Mass("b", mass=3.0)]
    body = emmy.Body(mesh, emmy.Region(emmy.Spring(stiffness=12.0)), masses=masses)
    for count in range(1, 7):
        modes = emmy.modes(body, count)
        assert modes.rigid == min(count, 5) and np.all(modes.residuals < 1e-6)
    assert modes.frequencies[5] == pytest.approx(np.sqrt(10.0) / (2 * np.pi), rel=1e-12)


def test_states_have_incompatible_modes():
    # A state in balance stays at rest, and its modes are those about the snapshot.
    mesh = emmy.Mesh.box((10, 1, 1), (10, 1, 1))
    material = emmy.NeoHooke(youngs_modulus=1e4, poissons_ratio=0.3)
    region = emmy.Region(material, density=1.0, formulation="incompatible-modes")
    body = emmy.Body(mesh, region, emmy.Support("x-min", fix="xyz"), emmy.Load("x-max", force=(0, 0, -2.0)))
    state = emmy.equilibrium(body)
    assert state.modes.shape == (3 * 10, 3)
    motion = emmy.Motion(body, start=state)
    same = emmy.Motion(body, equilibrium=True)
    assert motion.record.strain_energy == pytest.approx(same.record.strain_energy, rel=1e-12)
    # The work of the force on a cantilever: F w / 2, but for its shortening.
    w = -state.displacement[mesh.nearest_node((10, 0, 0)), 2]
    assert motion.record.strain_energy == pytest.approx(w, rel=0.02)
    for _ in range(5):
        assert motion.step(0.5).kinetic_energy < 1e-18
    assert np.allclose(motion.displacement, state.displacement, atol=1e-11)
    about = [emmy.modes(body, 3, state=about).frequencies for about in (state, same.snapshot(), motion.state)]
    assert np.allclose(about[0], about[1], rtol=1e-9) and np.allclose(about[2], about[1], rtol=1e-9)
    standard = emmy.Body(mesh, emmy.Region(material, density=1.0), emmy.Support("x-min", fix="xyz"))
    with pytest.raises(emmy.InputError, match="start.modes: 30 vectors given, but the incompatible modes"):
        emmy.Motion(standard, start=state)


def test_an_observer_that_turns_sees_masses_thrown_out():
    # r = k r_0/(k - m Omega^2), and frequencies omega_0 -+ Omega, with omega_0 along the axis.
    body = emmy.Body(
        rigid=emmy.Rigid("ball", mass=2.0, centre=(1.0, 0.0, 0.0)),
        supports=emmy.Support("ball", spring=18.0),
        loads=emmy.Load(rotation={"axis": (0, 0, 5), "speed": 1.0}),
    )
    state = emmy.equilibrium(body, 2)
    assert state.displacement[0] == pytest.approx([2.0 / 16.0, 0.0, 0.0], abs=1e-14)
    modes = emmy.modes(body, 3, state=state)
    assert modes.frequencies * 2 * np.pi == pytest.approx([2.0, 3.0, 4.0], rel=1e-12)
    assert np.all(modes.residuals < 1e-12) and modes.effective_masses.sum(axis=0) == pytest.approx(2.0)
    assert emmy.modes(body, 3).frequencies * 2 * np.pi == pytest.approx(3.0, rel=1e-12)     # without loads
    # About a line that is not through the origin.
    moved = emmy.Load(rotation={"axis": np.array([0.0, 0.0, 1.0]), "about": (1.0, 0.0, 0.0), "speed": 1.0})
    ball = emmy.Rigid("ball", mass=2.0, centre=(1.0, 0.0, 0.0))
    body = emmy.Body(rigid=ball, supports=emmy.Support("ball", spring=18.0), loads=moved)
    assert np.abs(emmy.equilibrium(body, 1).displacement).max() < 1e-15


def test_motions_and_fast_observers_are_refused():
    def ball(**rotation):
        return emmy.Body(
            rigid=emmy.Rigid("ball", mass=2.0, centre=(1.0, 0.0, 0.0)),
            supports=emmy.Support("ball", spring=18.0),
            loads=emmy.Load(rotation={"axis": (0, 0, 1), **rotation}),
        )

    with pytest.raises(emmy.InputError, match="the body itself turns"):
        emmy.Motion(ball(speed=1.0), steps=(1.0, 0.1))
    with pytest.raises(emmy.ConvergenceError, match="softens the body more than it is stiff"):
        emmy.equilibrium(ball(speed=5.0))
    zero = np.zeros((1, 3))
    with pytest.raises(emmy.ConvergenceError, match="limit of static stability"):
        emmy.modes(ball(speed=4.0), 1, state=emmy.State(0.0, zero, zero, zero))
    with pytest.raises(emmy.InputError, match="speed"):
        emmy.Load(rotation={"axis": (0, 0, 1), "speed": 0.0})
    with pytest.raises(emmy.InputError, match="direction"):
        emmy.Load(rotation={"axis": (0, 0, 0), "speed": 1.0})
