"""Round shapes, and meshes of several parts."""

from math import pi, sin

import emmy
import numpy as np
import pytest

RUBBER = emmy.NeoHooke(lambda_=1000.0, mu=500.0)


def test_round_shapes_have_the_volumes_of_their_polygons():
    def polygon(n):
        return n / 2 * sin(2 * pi / n)

    ring = emmy.Mesh.ring(1.0, 2.0, 3.0, (2, 12, 1))
    assert ring.quality["volume"] == pytest.approx(3 * 3.0 * polygon(12), rel=1e-13)
    assert set(ring.groups) == {"body", "inner", "outer", "z-min", "z-max"}
    cylinder = emmy.Mesh.cylinder(2.0, 3.0, (4, 1))
    assert cylinder.quality["volume"] == pytest.approx(4 * 3.0 * polygon(16), rel=1e-13)
    errors = [1 - emmy.Mesh.ball(1.0, n).quality["volume"] / (4 / 3 * pi) for n in (4, 8)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.05)


def test_placed_turns_then_shifts():
    box = emmy.Mesh.box((1, 2, 3), (1, 1, 1))
    turn = {"axis": (0, 0, 7.0), "angle": pi / 2, "about": (0.5, 1, 0)}
    moved = box.placed((10, 0, 0), turn=turn)
    assert np.allclose(moved.points.mean(axis=0), (10.5, 1, 1.5), atol=1e-14)
    assert np.allclose(np.ptp(moved.points, axis=0), (2, 1, 3), atol=1e-14)
    assert moved.groups == box.groups
    assert np.array_equal(box.placed().points, box.points)
    face = moved.points[moved.group_nodes("x-max")]
    assert np.allclose(face[:, 1], 1.5)


def test_parts_are_bodies_of_one_mesh():
    box = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    with pytest.warns(emmy.EmmyWarning, match="4 nodes lie where another one does"):
        mesh = emmy.Mesh.joined({"left": box, "right": box.placed((1, 0, 0))})
    assert list(mesh.groups)[:2] == ["left", "left-x-max"]
    assert mesh.n_nodes == 16 and mesh.merged(1e-9).n_nodes == 12
    regions = [emmy.Region(RUBBER, density=2.0, group="left"), emmy.Region(RUBBER, density=3.0, group="right")]
    body = emmy.Body(mesh.merged(1e-9), regions)
    initial = emmy.Initial(angular_velocity=(1, 2, 3), gradient=np.diag([0.3, -0.3, 0.0]))
    motion = emmy.Motion(body, scheme="DGM", steps=(0.5, 0.05), initial=initial)
    motion.run()
    for name in ("linear_momentum", "angular_momentum"):
        own = np.stack([motion.history[f"{name}_{axis}"] for axis in "xyz"])
        assert np.ptp(own, axis=1) == pytest.approx(0, abs=1e-11)
    assert np.ptp(motion.history["total_energy"]) == pytest.approx(0, abs=1e-10)
    # A mean strain of a percent in the volume of 2.
    assert motion.history["strain_energy"].max() > 0.1


@pytest.mark.parametrize(
    "make, place, message",
    [
        (lambda box: emmy.Mesh.joined({}), "parts", "there are no parts"),
        (lambda box: emmy.Mesh.joined({"a b": box}), "parts", "only letters, digits"),
        (lambda box: emmy.Mesh.joined({"a": box, "a-x-min": box}), "parts", 'there is a group "a-x-min" already'),
        (lambda box: emmy.Mesh.joined({"a": box, "b": emmy.Mesh.rectangle((1, 1), (1, 1))}), "parts", "plane strain"),
        (lambda box: box.placed((1, 2)), "at", "shape"),
        (lambda box: box.placed(turn={"axis": (0, 0, 0), "angle": 1}), "turn", "not 0"),
        (lambda box: box.placed(turn={"axis": (0, 0, 1)}), "turn", "`angle` is missing"),
        (lambda box: box.placed(turn={"axis": (0, 0, 1), "angle": 1, "abuot": 1}), "turn.abuot", "keys axis"),
        (lambda box: emmy.Mesh.ring(2, 1, 1, (1, 8, 1)), "", "inner radius 2 must be smaller"),
        (lambda box: emmy.Mesh.ring(1, 2, 1, (1, 2, 1)), "", "at least 3 cells around"),
        (lambda box: emmy.Mesh.ball(-1, 2), "", "positive"),
        (lambda box: emmy.Mesh.ball(1, 10**4), "mesh", "limit is 2e7"),
        (lambda box: emmy.Mesh.cylinder(1, 0, (1, 1)), "", "positive"),
        (
            lambda box: emmy.Mesh.rectangle((1, 1), (1, 1)).placed(turn={"axis": (1, 0, 0), "angle": 1}),
            "turn",
            "about the z axis only",
        ),
    ],
)
def test_bad_parts_are_named(make, place, message):
    with pytest.raises(emmy.InputError, match=message) as error:
        make(emmy.Mesh.box((1, 1, 1), (1, 1, 1)))
    assert [fault.place for fault in error.value.faults] == [place]


def test_a_part_must_be_a_mesh():
    with pytest.raises(TypeError, match="parts.a: int in place of emmy.Mesh"):
        emmy.Mesh.joined({"a": 1})
