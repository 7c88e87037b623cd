"""Materials of solid and plane cells."""

# Energies, parameters, errors and fields are written by EMMY_UPDATE_DOCS=1 cargo test -p emmy-io --lib reference.

from __future__ import annotations

from ._materials import Material
from ._words import Vector


class SaintVenantKirchhoff(Material):
    """Saint Venant and Kirchhoff: large rotation, small strain.

    ``W = lambda/2 (tr E)^2 + mu E : E``

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

    Raises
    ------
    InputError
        If not exactly two of lambda_, mu, youngs_modulus, poissons_ratio, bulk_modulus are given,
        or a value is out of its range.

    Examples
    --------
    >>> emmy.SaintVenantKirchhoff(youngs_modulus=210e3, poissons_ratio=0.3)
    SaintVenantKirchhoff(youngs_modulus=210000.0, poissons_ratio=0.3)
    """

    model = "saint-venant-kirchhoff"
    lambda_: float | None = None
    mu: float | None = None
    youngs_modulus: float | None = None
    poissons_ratio: float | None = None
    bulk_modulus: float | None = None


class NeoHooke(Material):
    """Neo-Hooke, compressible: large strain.

    ``W = mu/2 (tr C - 3) + lambda/2 (ln J)^2 - mu ln J``

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

    Raises
    ------
    InputError
        If not exactly two of lambda_, mu, youngs_modulus, poissons_ratio, bulk_modulus are given,
        or a value is out of its range.

    Examples
    --------
    >>> float(emmy.NeoHooke(lambda_=1000.0, mu=500.0).energy(np.zeros((3, 3))))
    0.0
    """

    model = "neo-hooke"
    lambda_: float | None = None
    mu: float | None = None
    youngs_modulus: float | None = None
    poissons_ratio: float | None = None
    bulk_modulus: float | None = None


class CiarletGeymonat(Material):
    """Ciarlet and Geymonat: large strain, strong compression.

    ``W = mu/2 (tr C - 3) + lambda/4 (J^2 - 1) - (lambda/2 + mu) ln J``

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

    Raises
    ------
    InputError
        If not exactly two of lambda_, mu, youngs_modulus, poissons_ratio, bulk_modulus are given,
        or a value is out of its range.

    Examples
    --------
    >>> emmy.CiarletGeymonat(lambda_=2.0, mu=1.0) == emmy.CiarletGeymonat(mu=1, lambda_=2)
    True
    """

    model = "ciarlet-geymonat"
    lambda_: float | None = None
    mu: float | None = None
    youngs_modulus: float | None = None
    poissons_ratio: float | None = None
    bulk_modulus: float | None = None


class Hencky(Material):
    """Hencky: quadratic in the logarithmic strain h, for stretches from 0.7 to 1.3.

    ``W = lambda/2 (tr h)^2 + mu h : h``

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

    Raises
    ------
    InputError
        If not exactly two of lambda_, mu, youngs_modulus, poissons_ratio, bulk_modulus are given,
        or a value is out of its range.

    Examples
    --------
    >>> stretch = np.diag(np.exp([0.2, -0.1, -0.1]))
    >>> W = emmy.Hencky(lambda_=5.0, mu=1.0).energy((stretch @ stretch - np.eye(3)) / 2)
    >>> round(float(W), 12)
    0.06
    """

    model = "hencky"
    lambda_: float | None = None
    mu: float | None = None
    youngs_modulus: float | None = None
    poissons_ratio: float | None = None
    bulk_modulus: float | None = None


class Orthotropic(Material):
    """Orthotropic elasticity with a positive definite D: wood, plies, bone; large rotation, small strain.

    ``W = E : D : E / 2``

    Parameters
    ----------
    youngs_modulus_1 : float > 0
        Young's modulus E_1 along axis 1.
    youngs_modulus_2 : float > 0
        Young's modulus E_2 along axis 2.
    youngs_modulus_3 : float > 0
        Young's modulus E_3 along axis 3.
    poissons_ratio_12 : float
        Contraction along axis 2 over extension along axis 1, under tension along 1.
    poissons_ratio_23 : float
        Contraction along axis 3 over extension along axis 2, under tension along 2.
    poissons_ratio_13 : float
        Contraction along axis 3 over extension along axis 1, under tension along 1.
    mu_12 : float > 0
        Shear modulus in the plane of axes 1 and 2.
    mu_23 : float > 0
        Shear modulus in the plane of axes 2 and 3.
    mu_13 : float > 0
        Shear modulus in the plane of axes 1 and 3.
    axis_1 : vector, optional
        Direction of axis 1; [1, 0, 0] if not given.
    axis_2 : vector, optional
        A direction in the plane of axes 1 and 2, on the side of axis 2; axis 3 is across them; [0, 1, 0] if not given.

    Raises
    ------
    InputError
        If a value is out of its range, or the stiffness is not positive definite.

    Examples
    --------
    >>> wood = emmy.Orthotropic(youngs_modulus_1=12e3, youngs_modulus_2=900.0, youngs_modulus_3=500.0,
    ...                         poissons_ratio_12=0.4, poissons_ratio_23=0.3, poissons_ratio_13=0.4,
    ...                         mu_12=700.0, mu_23=50.0, mu_13=700.0)
    >>> round(float(wood.stress([[0, 0.01, 0], [0.01, 0, 0], [0, 0, 0]])[0, 1]), 12)
    14.0
    """

    model = "orthotropic"
    youngs_modulus_1: float
    youngs_modulus_2: float
    youngs_modulus_3: float
    poissons_ratio_12: float
    poissons_ratio_23: float
    poissons_ratio_13: float
    mu_12: float
    mu_23: float
    mu_13: float
    axis_1: Vector | None = None
    axis_2: Vector | None = None
