"""Materials: energies and stresses against formulas."""

import emmy
import numpy as np
import pytest

STRAINS = np.random.default_rng(3).uniform(-0.1, 0.2, (5, 2, 3, 3))
STRAINS = (STRAINS + STRAINS.swapaxes(-1, -2)) / 2
C = 2 * STRAINS + np.eye(3)
J = np.sqrt(np.linalg.det(C))
I1 = np.trace(C, axis1=-2, axis2=-1)
LAMBDA, MU, K = 1000.0, 500.0, 2000.0
VOLUME = K / 4 * (J**2 - 1 - 2 * np.log(J))
I1_BAR = J ** (-2 / 3) * I1
I2_BAR = J ** (-4 / 3) * (I1**2 - np.trace(C @ C, axis1=-2, axis2=-1)) / 2

CASES = [
    (
        emmy.SaintVenantKirchhoff(lambda_=LAMBDA, mu=MU),
        LAMBDA / 2 * np.trace(STRAINS, axis1=-2, axis2=-1) ** 2 + MU * (STRAINS**2).sum(axis=(-1, -2)),
    ),
    (emmy.NeoHooke(lambda_=LAMBDA, mu=MU), MU / 2 * (I1 - 3) - MU * np.log(J) + LAMBDA / 2 * np.log(J) ** 2),
    (emmy.NeoHookeIsochoric(mu=MU, bulk_modulus=K), MU / 2 * (I1_BAR - 3) + VOLUME),
    (
        emmy.CiarletGeymonat(lambda_=LAMBDA, mu=MU),
        MU / 2 * (I1 - 3) + LAMBDA / 4 * (J**2 - 1) - (LAMBDA / 2 + MU) * np.log(J),
    ),
    (emmy.MooneyRivlin(c10=200.0, c01=50.0, bulk_modulus=K), 200 * (I1_BAR - 3) + 50 * (I2_BAR - 3) + VOLUME),
    (
        emmy.Yeoh(c10=200.0, c20=-3.0, c30=0.5, bulk_modulus=K),
        200 * (I1_BAR - 3) - 3 * (I1_BAR - 3) ** 2 + 0.5 * (I1_BAR - 3) ** 3 + VOLUME,
    ),
    (emmy.Gent(mu=MU, jm=30.0, bulk_modulus=K), -MU * 15 * np.log(1 - (I1_BAR - 3) / 30) + VOLUME),
    (emmy.Ogden(mu=[MU], alpha=[2.0], bulk_modulus=K), MU / 2 * (I1_BAR - 3) + VOLUME),
    (
        emmy.Hencky(lambda_=LAMBDA, mu=MU),
        LAMBDA / 2 * np.log(J) ** 2 + MU * ((0.5 * np.log(np.linalg.eigvalsh(C))) ** 2).sum(axis=-1),
    ),
]


@pytest.mark.parametrize(("material", "energy"), CASES, ids=lambda case: getattr(case, "model", ""))
def test_energies(material, energy):
    assert material.energy(STRAINS) == pytest.approx(energy, rel=1e-11)


@pytest.mark.parametrize("material", [case[0] for case in CASES], ids=lambda case: case.model)
def test_stresses_are_derivatives(material):
    direction = np.random.default_rng(4).uniform(-1, 1, (3, 3))
    direction += direction.T
    size = 1e-5
    difference = (material.energy(STRAINS + size * direction) - material.energy(STRAINS - size * direction)) / (
        2 * size
    )
    assert (material.stress(STRAINS) * direction).sum(axis=(-1, -2)) == pytest.approx(difference, rel=1e-7, abs=1e-4)


def test_shapes():
    material = emmy.NeoHooke(lambda_=LAMBDA, mu=MU)
    assert material.energy(np.zeros((3, 3))).shape == ()
    assert material.stress(np.zeros((2, 0, 3, 3))).shape == (2, 0, 3, 3)


def test_links_have_no_strain_tensor():
    with pytest.raises(emmy.InputError):
        emmy.Bar(youngs_modulus=1.0, area=1.0).energy(np.zeros((3, 3)))


def test_equality_and_hash():
    one, other = emmy.NeoHooke(lambda_=1000, mu=500), emmy.NeoHooke(mu=500.0, lambda_=1000.0)
    assert one == other and hash(one) == hash(other) and one != emmy.NeoHooke(lambda_=1000, mu=501)
    assert one != emmy.CiarletGeymonat(lambda_=1000, mu=500)
    with pytest.raises(AttributeError):
        one.mu = 3.0


def test_energies_by_formula():
    formula = "mu/2*(I1 - 3) - mu*ln(J) + lambda/2*ln(J)^2"
    own = emmy.Energy(formula, mu=MU, lambda_=LAMBDA)
    assert own == emmy.Energy(formula, mu=MU, **{"lambda": LAMBDA}) and hash(own) == hash(eval(repr(own), vars(emmy)))
    assert eval(repr(own), vars(emmy)) == own
    assert own.energy(STRAINS) == pytest.approx(CASES[1][1], rel=1e-11)
    with pytest.raises(emmy.InputError, match="I9"):
        emmy.Energy("mu*(I9 - 3)", mu=1.0)
