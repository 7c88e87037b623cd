"""Functions of Python as histories and fields."""

import gc
import re
import threading
import weakref

import emmy
import numpy as np
import pytest

from bodies import free_block, rubber


def beam(**load):
    mesh = emmy.Mesh.box((1, 4, 1), (1, 4, 1))
    return emmy.Body(
        mesh, emmy.Region(rubber(), density=1.0), emmy.Support("y-min", fix="xyz"), emmy.Load("y-max", **load)
    )


def pushed(until=0.5, **load):
    return emmy.Motion(beam(**load), degree=2, steps=(until, 0.05))


def test_a_function_that_says_1_is_no_history():
    one, other = pushed(force=(1, 0, 3), history=lambda t: 1.0), pushed(force=(1, 0, 3))
    one.run(), other.run()
    energy = other.history["total_energy"]
    assert one.history["total_energy"] == pytest.approx(energy, abs=1e-12 * energy.max())


def test_a_function_is_its_expression():
    one = pushed(force=(1, 0, 3), history=lambda t: np.sin(4 * t))
    other = pushed(force=(1, 0, 3), history="sin(4*t)")
    one.run(), other.run()
    assert one.displacement == pytest.approx(other.displacement, abs=1e-12)


def test_splines_of_scipy():
    interpolate = pytest.importorskip("scipy.interpolate")
    times = np.linspace(0.0, 1.0, 6)
    # A spline through the points of a cubic is the cubic, and a line is a line.
    for spline, formula in (
        (interpolate.CubicSpline(times, times**3 - times), "t^3 - t"),
        (interpolate.interp1d(times, 2 * times), "2*t"),
    ):
        assert isinstance(spline(0.0), np.ndarray)
        one, other = pushed(force=(1, 0, 3), history=spline), pushed(force=(1, 0, 3), history=formula)
        one.run(), other.run()
        assert one.displacement == pytest.approx(other.displacement, abs=1e-12)
        assert np.abs(one.displacement).max() > 1e-4


def test_scalars_of_numpy():
    one, other = pushed(force=(1, 0, 3), history=lambda t: np.float32(0.5)), pushed(force=(1, 0, 3), history=0.5)
    one.run(), other.run()
    assert one.displacement == pytest.approx(other.displacement, abs=1e-12)


def test_a_field_of_the_traction():
    area = 1.0
    one = pushed(traction=lambda points, t: np.tile([1.0 / area, 0.0, 0.0], (len(points), 1)) * np.sin(4 * t))
    other = pushed(force=(1, 0, 0), history="sin(4*t)")
    one.run(), other.run()
    assert one.displacement == pytest.approx(other.displacement, abs=1e-10)


def test_a_driven_support():
    mesh = emmy.Mesh.box((1, 4, 1), (1, 4, 1))
    region = emmy.Region(rubber(), density=1.0)

    def motion(move):
        body = emmy.Body(mesh, region, emmy.Support("y-min", fix="xz", move={"y": move}))
        motion = emmy.Motion(body, degree=2, steps=(0.5, 0.05))
        motion.run()
        return motion.displacement

    one = motion((lambda t: 0.1 * t**2, lambda t: 0.2 * t))
    assert one == pytest.approx(motion("0.1*t^2"), abs=1e-12)


class Mine(Exception):
    pass


def fails_at(time):
    def history(t):
        if t > time:
            raise Mine(f"at {t}")
        return 1.0

    return history


@pytest.mark.parametrize("plan", [{"steps": (0.5, 0.05)}, {"until": 0.5, "adaptive": 1e-3}])
@pytest.mark.parametrize("observers", [[], [lambda step, motion: False]])
def test_an_exception_comes_out_as_it_is(plan, observers):
    motion = emmy.Motion(beam(force=(1, 0, 0), history=fails_at(0.2)), **plan)
    with pytest.raises(Mine, match="at 0.2") as raised:
        motion.run(observers=observers)
    assert any("loads[0].history" in note for note in raised.value.__notes__)
    # The steps before it are done, although a plan looks ahead.
    # A first adaptive step may be tried beyond that time.
    earliest = 0.15 if "steps" in plan else 0.0
    assert earliest - 1e-12 <= motion.time <= 0.2 + 1e-12


@pytest.mark.parametrize(
    ("value", "error"),
    [(None, TypeError), (np.ones(2), TypeError), ("1", TypeError), (True, TypeError), (1j, TypeError)],
)
def test_what_is_no_number_shows_in_the_body(value, error):
    with pytest.raises(error, match=r"loads\[0\].history"):
        beam(force=(1, 0, 0), history=lambda t: value)


def test_nan_ends_the_step():
    motion = pushed(force=(1, 0, 0), history=lambda t: 1.0 if t < 0.2 else float("nan"))
    with pytest.raises(emmy.ConvergenceError, match=r"loads\[0\].history.*nan"):
        motion.run()
    assert 0.1 < motion.time <= 0.2 + 1e-12


def test_a_field_of_the_wrong_shape():
    shapes = ["an array of shape (3,)", "an array of shape (1, 3)", "NoneType", "str"]
    for value, found in zip((np.zeros(3), np.zeros((1, 3)), None, "text"), shapes, strict=True):
        message = f"<lambda> returned {found} in place of an array of shape (4, 3)"
        with pytest.raises(TypeError, match=re.escape(message)) as raised:
            beam(traction=lambda points, t, value=value: value)
        assert any("loads[0].traction" in note for note in raised.value.__notes__)


def test_a_complex_field_is_rejected():
    kind = "<lambda> returned an array of complex128 in place of an array of shape (4, 3)"
    message = r"loads\[0\].traction: .*" + re.escape(kind)
    for value in (lambda points, t: points * 1j, lambda points, t: [[1, 2, 3j]] * len(points)):
        with pytest.raises(TypeError, match=message):
            beam(traction=value)


def test_a_function_that_is_not_finite_outside_of_steps_is_bad_input():
    nan = float("nan")
    for load in ({"force": (1, 0, 0), "history": lambda t: nan}, {"traction": lambda points, t: points * nan}):
        with pytest.raises(emmy.InputError, match=r"loads\[0\].*returned NaN at t = 0"):
            beam(**load)
    body = beam(force=(1, 0, 0), history=lambda t: nan if t > 0.2 else 1.0)
    with pytest.raises(emmy.InputError, match=r"returned NaN at t = 0.5") as raised:
        body.external_force(0.5)
    assert [fault.place for fault in raised.value.faults] == ["loads[0].history"]
    assert body.external_force(0.0)[:, 0].sum() == pytest.approx(1.0)


def test_a_motion_in_a_function_fails_in_its_own_step():
    # The reading of the body asks the function, which steps another motion; that step fails as one.
    inner = emmy.Motion(beam(force=(1, 0, 0), history=lambda t: 1.0 if t == 0 else float("nan")))
    with pytest.raises(emmy.ConvergenceError, match=r"loads\[0\].history: .* returned NaN at t = 0.0"):
        beam(force=(1, 0, 0), history=lambda t: inner.step(0.1).time)


def test_a_wrong_signature_shows_in_the_body():
    with pytest.raises(TypeError):
        beam(force=(1, 0, 0), history=lambda: 1.0)


def test_a_motion_at_work_is_not_asked():
    motions = []

    def history(t):
        return motions[0].time if motions else 1.0

    motions.append(pushed(force=(1, 0, 0), history=history))
    with pytest.raises(RuntimeError, match="at work"):
        motions[0].run()


def test_a_function_may_have_other_values_in_another_motion():
    # Twice the force moves a body at rest twice as far, up to the square of the small strain.
    factor = 1.0
    body = beam(force=(1e-6, 0, 0), history=lambda t: factor)
    tips = []
    for factor in (1.0, 2.0):
        motion = emmy.Motion(body)
        motion.step(0.1)
        tips.append(motion.displacement[-1, 0])
    assert tips[1] == pytest.approx(2 * tips[0], rel=1e-6)
    tips = []
    for factor in (1.0, 2.0):
        tips.append(emmy.equilibrium(body).displacement[-1, 0])
    assert tips[1] == pytest.approx(2 * tips[0], rel=1e-5)


def test_a_cycle_is_collected():
    class History:
        def __call__(self, t):
            return 1.0

    history = History()
    body = beam(force=(1, 0, 0), history=history)
    history.body = body
    gone = weakref.ref(history)
    del body, history
    gc.collect()
    assert gone() is None


def cyclic_motion(n):
    """A weak reference to a motion of 3 (n + 1)^3 degrees of freedom, to which a function of its body refers."""
    own = []
    load = emmy.Load("y-max", traction=(1, 0, 0), history=lambda t: 1.0 if own is not None else 0.0)
    region = emmy.Region(emmy.NeoHooke(youngs_modulus=1000.0, poissons_ratio=0.3), density=1.0)
    motion = emmy.Motion(emmy.Body(emmy.Mesh.box((1, 1, 1), (n, n, n)), region, loads=load), steps=(0.01, 0.01))
    own.append(motion)
    motion.run()
    return weakref.ref(motion)


def test_a_history_that_refers_to_its_motion_is_collected():
    gone = [cyclic_motion(2) for _ in range(5)]
    gc.collect()
    assert [own() for own in gone] == [None] * 5


def test_motions_in_cycles_are_collected_by_their_size():
    # Python alone would wait for thousands of objects, whatever memory they hold.
    before = gc.get_threshold()
    gc.collect()
    gc.set_threshold(10**9)
    try:
        alive = [cyclic_motion(8) for _ in range(25)]
        # 2187 degrees of freedom each.
        assert sum(own() is not None for own in alive) <= 20_000 // 2187 + 1
    finally:
        gc.set_threshold(*before)


def test_observers_stop_and_see_every_step():
    motion = pushed(force=(1, 0, 0))
    seen = []
    motion.run(observers=[lambda step, motion: seen.append(step.number), lambda step, motion: step.number == 4])
    assert seen == [1, 2, 3, 4] and motion.number == 4
    motion.run()
    assert motion.time == pytest.approx(0.5)


def test_an_observer_may_look_at_the_motion():
    motion = pushed(force=(1, 0, 0))
    tips = []
    motion.run(observers=[lambda step, motion: tips.append(motion.displacement[:, 0].max())])
    assert len(tips) == 10 and tips[-1] == motion.displacement[:, 0].max()


def accelerated(history):
    mesh = emmy.Mesh.box((1, 2, 1), (1, 2, 1))
    return emmy.Body(mesh, emmy.Region(rubber(), density=1.0), emmy.Support("body", accelerate={"x": history}))


def test_an_acceleration_is_integrated_where_the_motion_comes():
    times = []

    def sine(t):
        times.append(t)
        if t > 0.9:
            raise Mine("later")
        return np.sin(5 * t)

    body = accelerated(sine)
    motion = emmy.Motion(body, steps=(1.0, 0.1))
    # Once, to see that it is a function.
    assert times == [0.0]
    motion.run(until=0.8)
    # u = t/5 - sin(5 t)/25 from rest.
    np.testing.assert_allclose(motion.displacement[:, 0], 0.8 / 5 - np.sin(4.0) / 25, atol=1e-14)
    # 10 points for each of 512 panels, of 531 samples of the plan, and of 18 times a step.
    assert len(times) < 10 * (512 + 531 + 18 * 8 + 50)
    with pytest.raises(Mine, match="later"):
        motion.run()
    assert 0.8 - 1e-12 <= motion.time <= 0.9 + 1e-12


def test_a_field_is_asked_where_the_motion_comes():
    times = []

    def force(points, t):
        times.append(t)
        if t > 0.3:
            raise Mine("later")
        return np.ones_like(points)

    motion = emmy.Motion(beam(traction=force), steps=(1.0, 0.1))
    assert set(times) == {0.0}
    with pytest.raises(Mine, match="later"):
        motion.run()
    assert 0.2 - 1e-12 <= motion.time <= 0.3 + 1e-12


def test_a_function_may_step_another_motion_of_its_body():
    inner = []

    def history(t):
        if inner:
            inner.pop().step(0.1)
        return np.cos(t)

    body = emmy.Body(free_block().mesh, emmy.Region(rubber(), density=1.0), loads=emmy.Load("x-max", force=(1, 0, 0), history=history))
    alone = emmy.Motion(body, steps=(0.5, 0.1))
    alone.run()
    one, other = emmy.Motion(body, steps=(0.5, 0.1)), emmy.Motion(body)
    inner.append(other)
    one.run()
    assert other.time == 0.1
    np.testing.assert_array_equal(one.displacement, alone.displacement)
    np.testing.assert_array_equal(other.record.total_energy, alone.history["total_energy"][1])


def test_an_exception_belongs_to_its_motion():
    def history(t):
        if t > 0.3 and bad.is_set():
            raise Mine("this one")
        return np.cos(t)

    bad = threading.Event()
    body = emmy.Body(free_block().mesh, emmy.Region(rubber(), density=1.0), loads=emmy.Load("x-max", force=(1, 0, 0), history=history))
    expected = emmy.Motion(body, steps=(0.5, 0.01)).run()["total_energy"]
    bad.set()
    failing = emmy.Motion(body, steps=(0.5, 0.01))
    with pytest.raises(Mine, match="this one"):
        failing.run()
    bad.clear()
    np.testing.assert_array_equal(emmy.Motion(body, steps=(0.5, 0.01)).run()["total_energy"], expected)
    # It goes on from its last good step.
    failing.run()
    assert failing.time == 0.5
