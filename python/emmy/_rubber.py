"""Materials that hardly change their volume: rubber and soft tissue."""

# Energies, parameters, errors and fields are written by EMMY_UPDATE_DOCS=1 cargo test -p emmy-io --lib reference.

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from ._materials import Material
from ._words import Vector


class NeoHookeIsochoric(Material):
    """Neo-Hooke with separate volume: nearly incompressible rubber, moderate strain.

    ``W = mu/2 (I1bar - 3) + W_vol(J)``

    Parameters
    ----------
    lambda_ : float, optional
        First Lamé parameter, above -2/3 `mu`.
    mu : float > 0, optional
        Shear modulus G at small strain.
    youngs_modulus : float > 0, optional
        Young's modulus E at small strain.
    poissons_ratio : float between -1 and 0.5, optional
        Poisson's ratio nu at small strain.
    bulk_modulus : float > 0, optional
        Bulk modulus K; at small strain nu = (3 K - 2 mu) / (6 K + 2 mu).
    volumetric : {"logarithmic", "quadratic", "simo-taylor", "miehe", "liu"}, optional
        Law of volume W_vol(J); "simo-taylor" if not given.

    Raises
    ------
    InputError
        If not exactly two of lambda_, mu, youngs_modulus, poissons_ratio, bulk_modulus are given,
        or a value is out of its range.

    Examples
    --------
    >>> emmy.NeoHookeIsochoric(mu=0.5, bulk_modulus=1000.0, volumetric="quadratic")
    NeoHookeIsochoric(mu=0.5, bulk_modulus=1000.0, volumetric='quadratic')
    """

    model = "neo-hooke-isochoric"
    lambda_: float | None = None
    mu: float | None = None
    youngs_modulus: float | None = None
    poissons_ratio: float | None = None
    bulk_modulus: float | None = None
    volumetric: str | None = None


class MooneyRivlin(Material):
    """Mooney and Rivlin: rubber, moderate strain.

    ``W = c10 (I1bar - 3) + c01 (I2bar - 3) + W_vol(J)``

    Parameters
    ----------
    c10 : float
        Modulus of the first invariant; mu = 2 (c10 + c01) > 0.
    c01 : float
        Modulus of the second invariant; neither should be negative.
    bulk_modulus : float > 0
        Bulk modulus K; at small strain nu = (3 K - 2 mu) / (6 K + 2 mu).
    volumetric : {"logarithmic", "quadratic", "simo-taylor", "miehe", "liu"}, optional
        Law of volume W_vol(J); "simo-taylor" if not given.

    Raises
    ------
    InputError
        If a value is out of its range.

    Examples
    --------
    >>> E = np.diag([0.2, 0.1, -0.1])
    >>> rubber = emmy.MooneyRivlin(c10=0.25, c01=0.0, bulk_modulus=100.0)
    >>> bool(np.isclose(rubber.energy(E), emmy.NeoHookeIsochoric(mu=0.5, bulk_modulus=100.0).energy(E)))
    True
    """

    model = "mooney-rivlin"
    c10: float
    c01: float
    bulk_modulus: float
    volumetric: str | None = None


class Yeoh(Material):
    """Yeoh: filled rubber.

    ``W = c10 (I1bar - 3) + c20 (I1bar - 3)^2 + c30 (I1bar - 3)^3 + W_vol(J)``

    Parameters
    ----------
    c10 : float > 0
        Linear modulus; mu = 2 c10.
    c20 : float
        Quadratic modulus.
    c30 : float
        Cubic modulus.
    bulk_modulus : float > 0
        Bulk modulus K; at small strain nu = (3 K - 2 mu) / (6 K + 2 mu).
    volumetric : {"logarithmic", "quadratic", "simo-taylor", "miehe", "liu"}, optional
        Law of volume W_vol(J); "simo-taylor" if not given.

    Raises
    ------
    InputError
        If a value is out of its range.

    Examples
    --------
    >>> emmy.Yeoh(c10=0.3, c20=-0.01, c30=0.001, bulk_modulus=500.0).c20
    -0.01
    """

    model = "yeoh"
    c10: float
    c20: float
    c30: float
    bulk_modulus: float
    volumetric: str | None = None


class Gent(Material):
    """Gent: rubber with limited extensibility. A step in which I1bar - 3 reaches `jm` fails.

    ``W = -mu jm/2 ln(1 - (I1bar - 3)/jm) + W_vol(J)``

    Parameters
    ----------
    jm : float > 0
        Limit of I1bar - 3; steps that reach it fail.
    lambda_ : float, optional
        First Lamé parameter, above -2/3 `mu`.
    mu : float > 0, optional
        Shear modulus G at small strain.
    youngs_modulus : float > 0, optional
        Young's modulus E at small strain.
    poissons_ratio : float between -1 and 0.5, optional
        Poisson's ratio nu at small strain.
    bulk_modulus : float > 0, optional
        Bulk modulus K; at small strain nu = (3 K - 2 mu) / (6 K + 2 mu).
    volumetric : {"logarithmic", "quadratic", "simo-taylor", "miehe", "liu"}, optional
        Law of volume W_vol(J); "simo-taylor" if not given.

    Raises
    ------
    InputError
        If not exactly two of lambda_, mu, youngs_modulus, poissons_ratio, bulk_modulus are given,
        or a value is out of its range.

    Examples
    --------
    >>> emmy.Gent(mu=0.5, jm=50.0, bulk_modulus=500.0).jm
    50.0
    """

    model = "gent"
    jm: float
    lambda_: float | None = None
    mu: float | None = None
    youngs_modulus: float | None = None
    poissons_ratio: float | None = None
    bulk_modulus: float | None = None
    volumetric: str | None = None


class ArrudaBoyce(Material):
    """Arruda and Boyce: rubber, eight chains of rigid links.

    ``W = n(mu) sum_i C_i/lambda_m^(2i-2) (I1bar^i - 3^i) + W_vol(J), C = 1/2, 1/20, 11/1050, 19/7000, 519/673750``

    Parameters
    ----------
    lambda_m : float > 1
        Locking stretch of a chain.
    lambda_ : float, optional
        First Lamé parameter, above -2/3 `mu`.
    mu : float > 0, optional
        Shear modulus G at small strain.
    youngs_modulus : float > 0, optional
        Young's modulus E at small strain.
    poissons_ratio : float between -1 and 0.5, optional
        Poisson's ratio nu at small strain.
    bulk_modulus : float > 0, optional
        Bulk modulus K; at small strain nu = (3 K - 2 mu) / (6 K + 2 mu).
    volumetric : {"logarithmic", "quadratic", "simo-taylor", "miehe", "liu"}, optional
        Law of volume W_vol(J); "simo-taylor" if not given.

    Raises
    ------
    InputError
        If not exactly two of lambda_, mu, youngs_modulus, poissons_ratio, bulk_modulus are given,
        or a value is out of its range.

    Examples
    --------
    >>> emmy.ArrudaBoyce(mu=0.5, lambda_m=3.0, bulk_modulus=500.0).lambda_m
    3.0
    """

    model = "arruda-boyce"
    lambda_m: float
    lambda_: float | None = None
    mu: float | None = None
    youngs_modulus: float | None = None
    poissons_ratio: float | None = None
    bulk_modulus: float | None = None
    volumetric: str | None = None


class Ogden(Material):
    """Ogden: rubber, any strain.

    ``W = sum_p mu_p/alpha_p (l_1^alpha_p + l_2^alpha_p + l_3^alpha_p - 3) + W_vol(J)``

    Parameters
    ----------
    mu : list of float
        Moduli mu_p, one a term; half the sum of mu_p alpha_p is the shear modulus.
    alpha : list of float
        Exponents alpha_p, one a term, not 0.
    bulk_modulus : float > 0
        Bulk modulus K; at small strain nu = (3 K - 2 mu) / (6 K + 2 mu).
    volumetric : {"logarithmic", "quadratic", "simo-taylor", "miehe", "liu"}, optional
        Law of volume W_vol(J); "simo-taylor" if not given.

    Raises
    ------
    InputError
        If a value is out of its range, or the lists have different lengths.

    Examples
    --------
    >>> E = np.diag([0.2, 0.1, -0.1])
    >>> rubber = emmy.Ogden(mu=[0.5], alpha=[2.0], bulk_modulus=100.0)
    >>> bool(np.isclose(rubber.energy(E), emmy.NeoHookeIsochoric(mu=0.5, bulk_modulus=100.0).energy(E)))
    True
    """

    model = "ogden"
    mu: Sequence[float] | NDArray[Any]
    alpha: Sequence[float] | NDArray[Any]
    bulk_modulus: float
    volumetric: str | None = None


class HolzapfelGasserOgden(Material):
    """Holzapfel, Gasser and Ogden: soft tissue, a matrix with fibres that bear tension only.

    ``W = mu/2 (I1bar - 3) + k1/(2 k2) sum_f (exp(k2 <E_f>^2) - 1) + W_vol(J)``

    Parameters
    ----------
    mu : float > 0
        Shear modulus of the matrix.
    k1 : float > 0
        Stiffness of the fibres.
    k2 : float > 0
        Growth of their stiffness with the strain.
    fibres : list of vector
        Direction of each family of fibres, such as `[[1, 0, 0]]`.
    bulk_modulus : float > 0
        Bulk modulus K; at small strain nu = (3 K - 2 mu) / (6 K + 2 mu).
    kappa : float from 0 to 0.3333, optional
        Dispersion of the fibres: 0 parallel, 1/3 in all directions alike; 0.0 if not given.
    volumetric : {"logarithmic", "quadratic", "simo-taylor", "miehe", "liu"}, optional
        Law of volume W_vol(J); "simo-taylor" if not given.

    Raises
    ------
    InputError
        If a value is out of its range.

    Examples
    --------
    >>> artery = emmy.HolzapfelGasserOgden(mu=7.6e-3, k1=1.0, k2=0.8, bulk_modulus=10.0, fibres=[[1, 0, 0]])
    >>> artery.fibres
    ((1, 0, 0),)
    """

    model = "holzapfel-gasser-ogden"
    mu: float
    k1: float
    k2: float
    fibres: Sequence[Vector] | NDArray[Any]
    bulk_modulus: float
    kappa: float | None = None
    volumetric: str | None = None
