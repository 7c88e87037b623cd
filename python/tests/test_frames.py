"""Frames in memory and in files."""

import emmy
import numpy as np
import pytest

from bodies import free_block, rubber

TIMES = np.arange(0.0, 1.01, 0.2)


def falling(**arguments):
    """A free block under gravity, whose motion u = -g t^2/2 time elements have exactly."""
    mesh = emmy.Mesh.box((1, 2, 1), (1, 2, 1))
    weight = emmy.Load.gravity("-z", units="m-kg-s")
    body = emmy.Body(mesh, emmy.Region(rubber(), density=1.0), loads=weight)
    return emmy.Motion(body, **{"steps": (1.0, 0.1), "units": "m-kg-s"} | arguments)


def test_frames_in_memory_are_those_of_a_fall():
    motion = falling()
    assert len(motion.frames) == 0
    motion.run(every=2, fields=["acceleration", "cell_volume_ratio"])
    frames = motion.frames
    assert frames.times == pytest.approx(TIMES, abs=1e-14)
    assert frames.displacement.shape == frames.velocity.shape == (6, 12, 3)
    z = np.array([0.0, 0.0, 1.0])
    assert frames.displacement == pytest.approx(-9.80665 / 2 * TIMES[:, None, None] ** 2 * z * np.ones((12, 1)))
    assert frames.velocity == pytest.approx(-9.80665 * TIMES[:, None, None] * z * np.ones((12, 1)))
    assert frames.field("cell_volume_ratio") == pytest.approx(np.ones((6, 2)))
    assert motion.field("velocity", time=0.4) == pytest.approx(-9.80665 * 0.4 * z * np.ones((12, 1)))
    assert motion.field("acceleration", time=1.0)[:, 2] == pytest.approx(-9.80665)
    assert np.array_equal(motion.field("displacement", time=1.0), motion.displacement)
    kept = frames[3].displacement
    kept[:] = 0.0
    assert np.abs(motion.frames[3].displacement).max() > 1.0


def test_frames_in_memory_are_those_of_the_files():
    pytest.importorskip("pyvista")
    names = ["von_mises_stress", "cell_cauchy_stress"]
    start = emmy.Initial(angular_velocity=(0.5, 1.0, 2.0), gradient=np.diag([0.3, -0.3, 0.0]))
    motions = [emmy.Motion(free_block(), steps=(0.5, 0.1), initial=start) for _ in range(2)]
    motions[0].run(every=3, fields=names)
    motions[1].run(every=3, fields=["displacement", "velocity", *names], output="out")
    run = emmy.Run("out")
    # The first and the last state, too.
    assert motions[0].frames.times.tolist() == run.frames.times.tolist() == pytest.approx([0.0, 0.3, 0.5])
    for name in ("displacement", "velocity", *names):
        assert np.array_equal(motions[0].field(name, time=0.3), run.field(name, time=0.3))
        assert np.array_equal(motions[0].field(name), run.field(name))
    assert np.array_equal(motions[0].frames.velocity, run.frames.velocity)
    kept, read = motions[0].frames[1].to_pyvista(), run.frames[1].to_pyvista()
    assert np.array_equal(kept.point_data["displacement"], read.point_data["displacement"])
    assert np.array_equal(kept.cell_data["cell_cauchy_stress"], read.cell_data["cell_cauchy_stress"])
    assert repr(motions[0].frames[1]) == "<emmy.Frame: t = 0.3, in memory>"


def test_parts_of_a_run_do_not_repeat_frames():
    motion = falling()
    motion.run(until=0.4, every=2)
    motion.run(until=0.5, every=2)
    motion.run()
    assert motion.frames.times == pytest.approx([0.0, 0.2, 0.4, 0.5])
    stopped = falling()
    stopped.run(every=4, observers=lambda step, motion: step.number == 3)
    assert stopped.frames.times == pytest.approx([0.0, 0.3])


def test_mistakes_with_frames():
    motion = falling()
    with pytest.raises(emmy.InputError, match="^time: there are no frames; `every` of `Motion.run`"):
        motion.field("velocity", time=0.0)
    with pytest.raises(emmy.InputError, match='^fields: "nonsense" is not a field; there is displacement'):
        motion.run(every=1, fields=["nonsense"])
    with pytest.raises(TypeError, match="^fields: only with every="):
        motion.run(fields=["velocity"])
    with pytest.raises(TypeError, match="^fields: str in place of a list of names$"):
        motion.run(every=1, fields="velocity")
    with pytest.raises(TypeError, match="^interval, format: only with output="):
        motion.run(every=1, interval=0.1, format="vtu")
    motion.run(every=5)
    with pytest.raises(emmy.InputError, match="^time: there is no frame at t = 0.4; the nearest one is at t = 0.5$"):
        motion.field("velocity", time=0.4)
    with pytest.raises(emmy.InputError, match="^name: the frame has no field 'cell_cauchy_stress'; there is d"):
        motion.field("cell_cauchy_stress", time=0.5)
    with pytest.raises(TypeError, match="^group: not with time"):
        motion.field("velocity", "x-max", time=0.5)
