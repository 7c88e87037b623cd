"""Fields of one region, and masses of groups."""

import emmy
import numpy as np
import pytest

POINTS = [[x, y, z] for y in (0.0, 1.0, 2.0) for z in (0.0, 1.0) for x in (0.0, 1.0)]


def two_cubes():
    """A soft and a stiff cube with a common face."""
    cells = [[0, 1, 5, 4, 2, 3, 7, 6], [4, 5, 9, 8, 6, 7, 11, 10]]
    mesh = emmy.Mesh(np.array(POINTS), {"hex8": cells}, cell_groups={"soft": [0], "stiff": [1]})
    regions = [
        emmy.Region(emmy.NeoHooke(lambda_=0.0, mu=mu), density=density, group=group)
        for group, mu, density in (("soft", 5.0, 2.0), ("stiff", 500.0, 6.0))
    ]
    return emmy.Body(mesh, regions)


def test_a_group_of_cells_has_its_own_stresses():
    body = two_cubes()
    stretched, rest = np.array(POINTS) * [1.0, 0.0, 0.0], np.zeros((12, 3))
    motion = emmy.Motion(body, steps=(1.0, 0.1), start=emmy.State(0.0, stretched, rest, rest, 0))
    flight = emmy.Motion(body, steps=(1.0, 0.1), initial=emmy.Initial(velocity=(3.0, 3.0, 3.0)))
    # mu (a^2 - 1)/a for a stretch of 2 along x.
    for group, mu, density in (("soft", 5.0, 2.0), ("stiff", 500.0, 6.0)):
        stress = motion.field("von_mises_stress", group=group)
        assert stress.shape == body.mesh.group_nodes(group).shape
        np.testing.assert_allclose(stress, 1.5 * mu, rtol=1e-12)
        np.testing.assert_allclose(flight.field("momentum_density", group), 3.0 * density, rtol=1e-14)
        np.testing.assert_allclose(motion.field("cell_von_mises_stress", group), [1.5 * mu], rtol=1e-12)
    # The mean of both sides by volume.
    np.testing.assert_allclose(motion.field("von_mises_stress")[4:8], 1.5 * 505.0 / 2.0, rtol=1e-12)
    for name, group in (("von_mises_stress", "sift"), ("cell_von_mises_stress", "x-min")):
        with pytest.raises(emmy.InputError, match="group"):
            motion.field(name, group)


def test_the_summary_has_a_row_for_each_region(tmp_path):
    body = two_cubes()
    flight = emmy.Initial(velocity=(1.0, 0.0, 0.0), gradient=np.diag([0.5, 0.0, 0.0]))
    motion = emmy.Motion(body, steps=(0.2, 0.1), initial=flight)
    motion.run(output=tmp_path / "out")
    rows = emmy.Run(tmp_path / "out").summary["largest_in_regions"]
    assert [(row["field"], row["region"]) for row in rows] == [
        ("von_mises_stress", "soft"),
        ("von_mises_stress", "stiff"),
    ]
    assert rows[1]["value"] == pytest.approx(motion.field("von_mises_stress", "stiff").max(), rel=1e-12)


def test_a_mass_of_a_group():
    mesh = emmy.Mesh.box((1, 4, 1), (1, 2, 1))
    region = emmy.Region(emmy.NeoHooke(lambda_=1.0, mu=1.0), density=2.0)
    body = emmy.Body(mesh, region, masses=emmy.Mass("x-max", total=3.0))
    motion = emmy.Motion(body, steps=(0.1, 0.1), initial=emmy.Initial(velocity=(2.0, 0.0, 0.0)))
    assert motion.momentum[:, 0].sum() == pytest.approx(2.0 * (8.0 + 3.0), rel=1e-13)
    for wrong in ({"mass": 1.0, "total": 1.0}, {}, {"total": 0.0}):
        with pytest.raises(emmy.InputError):
            emmy.Mass("x-max", **wrong)
