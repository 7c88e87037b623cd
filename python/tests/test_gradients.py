"""Gradients by the adjoint against differences of whole motions."""

import emmy
import pytest

MESH = emmy.Mesh.box((1, 2, 1), (1, 2, 1))


def body(material, density=1.2, factor=1.0, start=1.0):
    pull = emmy.Load("y-max", traction=(6 * factor, 3 * factor, 4 * factor), history=[(0, start), (0.5, 1), (1, 0)])
    weight = emmy.Load(acceleration=(0, -1, 0.5))
    return emmy.Body(MESH, emmy.Region(material, density=density), emmy.Support("y-min", fix="xyz"), [pull, weight])


def error(made, value, equilibrium, **how):
    """Relative difference between a gradient and a difference of whole motions, each from its own start."""

    def run(at):
        motion = emmy.Motion(
            made(at), "DGM", steps=(1.0, 0.05), tolerance=1e-13, equilibrium=equilibrium, adjoint=True
        )
        motion.run()
        return motion

    motion, d = run(value), 1e-4 * value
    goal = emmy.Goal.displacement_at(motion.body, MESH.nearest_node((1, 2, 1)), direction=(0.3, 1, -0.5))
    gradient = motion.gradient(goal, [emmy.Parameter(value, made, **how)]).parameters[0]
    difference = (goal.value(run(value + d)) - goal.value(run(value - d))) / (2 * d)
    return abs(gradient / difference - 1)


def rubber(mu):
    return emmy.NeoHooke(lambda_=60.0, mu=mu)


@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize(
    "made, value",
    [
        (lambda mu: body(rubber(mu)), 20.0),
        (lambda density: body(rubber(20.0), density=density), 1.2),
        (lambda factor: body(rubber(20.0), factor=factor), 1.0),
    ],
)
def test_a_start_from_the_equilibrium_depends_on_the_parameters(made, value, linear):
    assert error(made, value, True, linear=linear) < 1e-6


@pytest.mark.parametrize("equilibrium", [None, True])
def test_a_parameter_need_not_be_linear(equilibrium):
    def made(b):
        energy = emmy.Energy("c/b*(exp(b*(I1_bar - 3)) - 1) + K/2*ln(J)^2", c=10.0, b=b, K=80.0)
        return body(energy, start=0.0)

    assert error(made, 0.8, equilibrium) < 1e-6
    if not equilibrium:
        # With one wide difference it is wrong.
        assert error(made, 0.8, equilibrium, linear=True) > 1e-5


def test_a_snapshot_is_data():
    """The start of another motion, which does not change with the parameter."""
    first = emmy.Motion(body(rubber(20.0)), "DGM", steps=(1.0, 0.05), tolerance=1e-13, equilibrium=True)
    start = first.snapshot()

    def run(mu):
        motion = emmy.Motion(body(rubber(mu)), "DGM", steps=(1.0, 0.05), tolerance=1e-13, start=start, adjoint=True)
        motion.run()
        return motion

    motion = run(20.0)
    goal = emmy.Goal.displacement_at(motion.body, MESH.nearest_node((1, 2, 1)), direction=(0.3, 1, -0.5))
    gradient = motion.gradient(goal, [emmy.Parameter(20.0, lambda mu: body(rubber(mu)))]).parameters[0]
    difference = (goal.value(run(20.002)) - goal.value(run(19.998))) / 4e-3
    assert gradient == pytest.approx(difference, rel=1e-6)


def test_a_body_that_cannot_be_made_names_the_scale():
    def made(nu):
        if nu > 0.5:
            raise ValueError("no such material")
        return body(rubber(20.0))

    with pytest.raises(ValueError, match="no such material") as raised:
        emmy.Parameter(0.499, made)
    assert "scale" in raised.value.__notes__[0]
