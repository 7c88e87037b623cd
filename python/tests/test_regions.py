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


def test_a_picture_of_a_group_or_a_region():
    pytest.importorskip("pyvista")
    body = two_cubes()
    stretched, rest = np.array(POINTS) * [1.0, 0.0, 0.0], np.zeros((12, 3))
    motion = emmy.Motion(body, steps=(1.0, 0.1), start=emmy.State(0.0, stretched, rest, rest, 0))
    # mu (a^2 - 1)/a for a stretch of 2 along x, at the common face as well.
    for part, mu, cell in (({"group": "soft"}, 5.0, 0), ({"region": 1}, 500.0, 1)):
        grid = motion.to_pyvista("von_mises_stress", "cell_von_mises_stress", **part)
        assert grid.volume == pytest.approx(1.0, rel=1e-13) and grid.n_points == 8
        assert grid.point_data["von_mises_stress"] == pytest.approx(1.5 * mu, rel=1e-12)
        assert grid.cell_data["cell_von_mises_stress"] == pytest.approx([1.5 * mu], rel=1e-12)
        nodes = grid.point_data["vtkOriginalPointIds"]
        assert np.array_equal(grid.points, np.array(POINTS)[nodes])
        assert np.array_equal(grid.point_data["displacement"], stretched[nodes])
        assert grid.cell_data["vtkOriginalCellIds"].tolist() == [cell]
    assert motion.to_pyvista().volume == pytest.approx(2.0, rel=1e-13)
    with pytest.raises(emmy.UnknownGroupError, match="^group: the mesh has no group `sift`; did you mean `soft`"):
        motion.to_pyvista(group="sift")
    with pytest.raises(emmy.InputError, match="^region: there is no region 2; the body has 2, counted from 0$"):
        motion.to_pyvista(region=2)
    with pytest.raises(TypeError, match="exclude each other"):
        motion.to_pyvista(group="soft", region=0)


def test_a_picture_of_facets_or_nodes():
    pytest.importorskip("pyvista")
    box = emmy.Mesh.box((2, 3, 5), (2, 3, 5))
    face = box.to_pyvista("x-max")
    assert face.n_cells == 15 and face.area == pytest.approx(15.0, rel=1e-13)
    assert np.all(face.points[:, 0] == 2.0) and face.n_points == 24
    mesh = emmy.Mesh(box.points, box.cells, node_groups={"edge": [0, 1, 2]})
    assert np.array_equal(mesh.to_pyvista("edge").points, box.points[:3])
    body = emmy.Body(box, emmy.Region(emmy.NeoHooke(lambda_=0.0, mu=5.0), density=1.0))
    turned = emmy.Motion(body, initial=emmy.Initial(angular_velocity=(1, 0, 0)))
    velocity = turned.to_pyvista("velocity", group="x-max").point_data["velocity"]
    assert velocity == pytest.approx(np.cross([1.0, 0.0, 0.0], face.points), abs=1e-14)
    plane = emmy.Mesh.rectangle((2, 1), (4, 2)).to_pyvista("x-max")
    assert plane.n_cells == 2 and plane.length == pytest.approx(1.0, rel=1e-13)
