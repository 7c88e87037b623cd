"""Pictures of Matplotlib."""

import emmy
import numpy as np
import pytest

from bodies import free_block, rubber

plt = pytest.importorskip("matplotlib.pyplot")


@pytest.fixture(autouse=True)
def no_figures():
    yield
    plt.close("all")


def lines(axes):
    return {line.get_label(): line.get_ydata() for line in axes.lines}


def thrown(**arguments):
    """A block of mass 2, which is thrown upwards at 3 and falls with 10."""
    weight = emmy.Load(acceleration=(0, 0, -10))
    body = emmy.Body(emmy.Mesh.box((1, 2, 1), (1, 2, 1)), emmy.Region(rubber(), density=1.0), loads=weight)
    up = emmy.Initial(velocity=(0, 0, 3))
    motion = emmy.Motion(body, steps=(0.6, 0.1), initial=up, probes={"o": (0, 0, 0)}, **arguments)
    motion.run(output="thrown", every=0)
    return motion


def test_energies_of_a_throw():
    motion = thrown()
    t = motion.history["time"]
    _, axes = plt.subplots()
    assert emmy.plot.energies(motion, ax=axes) is axes
    drawn = lines(axes)
    assert list(drawn) == ["T + V", "T", "V", "W"]
    assert drawn["T"] == pytest.approx((3 - 10 * t) ** 2, rel=1e-12)
    # The weight times the height.
    assert drawn["W"] == pytest.approx(-20 * (3 * t - 5 * t**2), abs=1e-12)
    assert axes.get_legend() is not None
    for results in (motion.history, emmy.Run("thrown")):
        assert np.array_equal(lines(emmy.plot.energies(results))["T"], drawn["T"])


def test_a_free_flight_has_no_work():
    flight = emmy.Motion(free_block(), steps=(1.0, 0.5), initial=emmy.Initial(velocity=(1, 0, 0)))
    assert list(lines(emmy.plot.energies(flight.run()))) == ["T + V", "T", "V"]


def test_dissipation_closes_the_energies():
    rubber = emmy.Region(emmy.NeoHooke(lambda_=1000.0, mu=500.0), density=2.0, viscosity=emmy.Viscosity(time=0.01))
    body = emmy.Body(emmy.Mesh.box((1, 1, 1), (2, 2, 2)), rubber)
    start = emmy.Initial(gradient=((2, 0, 0), (0, 0, 0), (0, 0, 0)))
    drawn = lines(emmy.plot.energies(emmy.Motion(body, steps=(0.2, 0.02), initial=start).run()))
    assert drawn["D"][-1] > 0.1 * drawn["T"][0]
    assert drawn["T + V"] + drawn["D"] == pytest.approx(drawn["T"][0], rel=1e-12)


def test_residuals():
    motion = thrown()
    axes = emmy.plot.residuals(motion)
    assert axes.get_yscale() == "log"
    for column, drawn in zip(emmy.plot.RESIDUALS, lines(axes).values(), strict=True):
        own = np.abs(motion.history[column][1:])
        assert np.array_equal(drawn, np.where(own > 0, own, np.nan), equal_nan=True)
        assert np.nanmax(drawn, initial=0.0) < 1e-12
    axes.figure.canvas.draw()


def test_columns():
    motion = thrown()
    drawn = lines(emmy.plot.columns(motion, "o", "kinetic_energy"))
    assert list(drawn) == ["o_x", "o_y", "o_z", "kinetic_energy"]
    t = motion.history["time"]
    assert drawn["o_z"] == pytest.approx(3 * t - 5 * t**2, abs=1e-12)
    drawn = lines(emmy.plot.columns(motion, "linear_momentum"))
    assert list(drawn) == ["linear_momentum_x", "linear_momentum_y", "linear_momentum_z"]
    assert drawn["linear_momentum_z"] == pytest.approx(2 * (3 - 10 * t), abs=1e-12)
    with pytest.raises(emmy.InputError, match="^names: 'q' is not a column; there is step, time"):
        emmy.plot.columns(motion, "q")
    with pytest.raises(TypeError, match="^names: give at least one column"):
        emmy.plot.columns(motion)
    with pytest.raises(TypeError, match="^results: emmy.Body in place of emmy.Motion, emmy.Run or emmy.History$"):
        emmy.plot.columns(motion.body, "o")


def test_words_are_not_drawn():
    weight = emmy.Load(acceleration=(0, 0, -10))
    body = emmy.Body(free_block().mesh, emmy.Region(rubber(), density=1.0), loads=weight)
    history = emmy.Motion(body, until=0.2, adaptive=1e-3).run()
    with pytest.raises(emmy.InputError, match="^names: 'limited_by' has words"):
        emmy.plot.columns(history, "limited_by")
