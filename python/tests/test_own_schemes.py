"""Forces and matrices of bodies, and the equations of a step, for schemes outside of Emmy."""

import dataclasses

import emmy
import numpy as np
import pytest

from bodies import rubber, spinning_block

MESH = emmy.Mesh.box((1, 2, 1), (1, 2, 1))
N = MESH.n_nodes


def body(supports=(), **region):
    load = emmy.Load("z-max", pressure=40.0, history=[(0, 1), (1, 3)])
    return emmy.Body(MESH, emmy.Region(rubber(), density=1.0, **region), supports, load)


def displacement(seed=1, size=0.05):
    return size * np.random.default_rng(seed).standard_normal((N, 3))


def test_flat_arrays_are_taken_and_returned():
    own, u = body(), displacement()
    flat = u.ravel()
    for use in (own.internal_force, lambda u: own.external_force(0.5, u)):
        assert use(flat).shape == (3 * N,) and use(u).shape == (N, 3)
        assert np.array_equal(use(flat), use(u).ravel())
    assert own.external_force(0.5).shape == (N, 3)
    assert own.strain_energy(flat) == own.strain_energy(u) > 0.0
    state = emmy.Motion(own).state
    moved = dataclasses.replace(state, velocity=flat, momentum=None)
    assert np.array_equal(moved.velocity, u)
    motion = emmy.Motion(own, start=moved)
    x = np.array([0.1 * u])
    whole = motion.residual(x, 0.1)
    assert whole.shape == (1, N, 3)
    assert np.array_equal(motion.residual(0.1 * u, 0.1), whole[0])
    assert np.array_equal(motion.residual(0.1 * flat, 0.1), whole.ravel())
    pytest.importorskip("scipy")
    assert (own.stiffness(flat) != own.stiffness(u)).nnz == 0
    assert (motion.tangent(0.1 * flat, 0.1) != motion.tangent(x, 0.1)).nnz == 0


@pytest.mark.parametrize("wrong", [np.zeros(3 * N - 3), np.zeros((3, N)), np.zeros((N, 3, 1))])
def test_other_shapes_are_refused(wrong):
    own = body()
    motion = emmy.Motion(own, degree=2)
    for use in (own.internal_force, own.stiffness, own.strain_energy, lambda u: own.external_force(0.0, u)):
        with pytest.raises(emmy.InputError, match=rf"^u: expected an array of shape \({N}, 3\)"):
            use(wrong)
    for use in (motion.residual, motion.tangent):
        with pytest.raises(emmy.InputError, match="^x: expected an array of shape"):
            use(wrong, 0.1)
        shapes = rf"\(2, {N}, 3\) or \(2, {3 * N}\) or \({6 * N},\)"
        with pytest.raises(emmy.InputError, match=rf"^x: expected an array of shape {shapes}, found \({N}, 3\)"):
            use(np.zeros((N, 3)), 0.1)  # degree 2
        with pytest.raises(emmy.InputError, match="^step_size: must be positive, not -1.0"):
            use(np.zeros((2, N, 3)), -1)


def test_loads_follow_the_body_and_the_time():
    own = body()
    # The face z-max has the area 2, stretched by 1.5 along y, under twice the pressure of 40 at t = 0.5.
    stretched = MESH.points * [0.0, 0.5, 0.0]
    assert own.external_force(0.5, stretched).sum(axis=0) == pytest.approx([0.0, 0.0, -2 * 1.5 * 2 * 40], abs=1e-12)
    assert own.external_force(0.0).sum(axis=0) == pytest.approx([0.0, 0.0, -80.0], abs=1e-12)


def test_given_motions():
    support = emmy.Support("y-min", move={"y": "0.1*sin(3*t)"}, until=2.0)
    given = body(support).prescribed(0.7)
    assert isinstance(given, emmy.Prescribed)
    assert sorted(given.dofs) == list(3 * MESH.group_nodes("y-min") + 1)
    assert given.displacement == pytest.approx([0.1 * np.sin(2.1)] * 4, rel=1e-14)
    assert given.velocity == pytest.approx([0.3 * np.cos(2.1)] * 4, rel=1e-14)
    assert body(support).prescribed(2.0).dofs.size == 0
    assert all(own.size == 0 for own in body().prescribed(0.0))


def test_damping_is_a_multiple_of_stiffness_and_mass():
    pytest.importorskip("scipy")
    own = body(viscosity=emmy.Viscosity(time=0.02))
    difference = own.damping() - 0.02 * own.stiffness()
    assert abs(difference).max() < 1e-14 * abs(own.damping()).max()
    assert body().damping().nnz == 0


@pytest.mark.parametrize(("scheme", "degree"), [("DGM", 1), ("DGM", 2), ("AS(4)", 3), ("FE(2)", 2)])
@pytest.mark.parametrize("formulation", ["standard", "projected-volume"])
def test_tangents_are_derivatives_of_residuals(scheme, degree, formulation):
    pytest.importorskip("scipy")
    own = body(emmy.Support("y-min", fix="xyz"), viscosity=emmy.Viscosity(time=0.02), formulation=formulation)
    motion = emmy.Motion(own, scheme=scheme, degree=degree)
    rng = np.random.default_rng(3)
    x, direction = (size * rng.standard_normal((degree, N, 3)) for size in (0.02, 1.0))
    d, h = 1e-5, 0.05
    difference = (motion.residual(x + d * direction, h) - motion.residual(x - d * direction, h)) / (2 * d)
    exact = motion.tangent(x, h) @ direction.ravel()
    assert exact == pytest.approx(difference.ravel(), abs=1e-7 * abs(exact).max())


def test_the_residual_is_inertia_and_forces():
    pytest.importorskip("scipy")
    motion = spinning_block(scheme="FE(1)")
    own, h, x = motion.body, 0.05, displacement(2)
    momentum, middle = motion.momentum, motion.displacement + x / 2
    expected = 2 * (own.mass() @ x.ravel() - h * momentum.ravel()) + h**2 * own.internal_force(middle.ravel())
    assert motion.residual(x, h).ravel() == pytest.approx(expected, abs=1e-13 * abs(expected).max())


def test_only_time_elements_have_equations():
    own = body()
    x = np.zeros((N, 3))
    motion = emmy.Motion(own, scheme="Newmark(0.25, 0.5)")
    with pytest.raises(emmy.InputError, match="need a time element"):
        motion.residual(x, 0.1)
    with pytest.raises(emmy.InputError, match="not sparse"):
        emmy.Motion(own, scheme="DGM(0.8)").tangent(x, 0.1)
    with pytest.raises(emmy.InputError, match="internal nodes"):
        emmy.Motion(body(formulation="incompatible-modes")).residual(x, 0.1)


def test_an_inverting_rate_is_an_error_and_the_motion_goes_on():
    motion, other = spinning_block(), spinning_block()
    with pytest.raises(emmy.MeshError, match="turned inside out"):
        motion.residual(np.where(motion.body.mesh.points[:, 1:2] > 1.5, [0.0, -9.0, 0.0], 0.0), 0.1)
    assert motion.step(0.05).total_energy == other.step(0.05).total_energy
    assert np.array_equal(motion.displacement, other.displacement)


def test_an_exception_in_a_function_is_raised():
    def broken(t):
        if t > 0.5:
            raise ZeroDivisionError("mine")
        return 0.0

    load = emmy.Load("z-max", traction=(0, 0, 1), history=broken)
    own = emmy.Body(MESH, emmy.Region(rubber(), density=1.0), loads=load)
    assert not own.external_force(0.2).any()
    with pytest.raises(ZeroDivisionError, match="mine"):
        own.external_force(1.0)
