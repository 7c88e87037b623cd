"""Gravity in a system of units."""

from pathlib import Path

import emmy
import numpy as np
import pytest

from bodies import rubber

#: 9.80665 m/s^2 in each system: mm/ms^2, mm/s^2, um/ms^2.
NUMBERS = {"m-kg-s": 9.80665, "mm-kg-ms": 9.80665e-3, "mm-t-s": 9806.65, "um-mg-ms": 9.80665}


@pytest.mark.parametrize("units", NUMBERS)
def test_numbers(units):
    g = NUMBERS[units]
    assert emmy.Load.gravity("-z", units=units).acceleration == (0.0, 0.0, -g)
    assert emmy.Load.gravity("x", units=units).acceleration == (g, 0.0, 0.0)
    assert emmy.Load.gravity("+y", units=units).acceleration == (0.0, g, 0.0)


def test_weight_of_a_group():
    mesh = emmy.Mesh(
        emmy.Mesh.box((1, 2, 1), (1, 2, 1)).points,
        emmy.Mesh.box((1, 2, 1), (1, 2, 1)).cells,
        cell_groups={"lower": np.array([True, False])},
    )
    load = emmy.Load.gravity("-y", units="mm-t-s", group="lower", history=2.0)
    body = emmy.Body(mesh, emmy.Region(rubber(), density=3e-6), loads=load)
    assert body.external_force(0.0).sum(axis=0) == pytest.approx([0.0, -2 * 3e-6 * 9806.65, 0.0], rel=1e-13)


def test_gravity_of_a_file_is_the_same():
    path = Path("fall.toml")
    path.write_text(
        'mesh.box = { size = [1, 1, 1], cells = [1, 1, 1] }'
        '\ntime = { scheme = "DGM", steps = [{ until = 1, size = 0.5 }] }'
        '\nunits = { system = "mm-kg-ms" }\nload = [{ gravity = "-Z", history = "2" }]'
        '\nregion = [{ density = 7.85e-6, material.neo-hooke = { youngs_modulus = 210, poissons_ratio = 0.3 } }]\n'
    )
    problem = emmy.load(path)
    (load,) = problem.body.loads
    assert load.acceleration == (0.0, 0.0, -9.80665e-3)
    motion = problem.motion()
    motion.run()
    # g t^2/2 with twice the gravity.
    assert motion.displacement[:, 2] == pytest.approx(-9.80665e-3, rel=1e-12)
    assert np.array_equal(motion.history["total_energy"], emmy.run(path).history["total_energy"])


def test_mistakes():
    with pytest.raises(emmy.InputError, match="^direction: 'down' is not a direction along an axis"):
        emmy.Load.gravity("down", units="m-kg-s")
    with pytest.raises(emmy.InputError, match='^units: "SI" is not a system of units; there is m-kg-s, mm'):
        emmy.Load.gravity("-z", units="SI")
    with pytest.raises(TypeError, match="^Load has no argument gravity; .*; see Load.gravity$"):
        emmy.Load(gravity="-z")
