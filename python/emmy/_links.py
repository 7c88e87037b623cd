"""Materials of links, which are cells of two nodes."""

# Energies, parameters, errors and fields are written by EMMY_UPDATE_DOCS=1 cargo test -p emmy-io --lib reference.

from __future__ import annotations

from ._materials import Material


class Bar(Material):
    """A bar of a truss, or a cable under tension; its density is a mass per volume.

    ``V = E A L e^2/2, e = (l^2/L^2 - 1)/2``, of the whole link.

    Parameters
    ----------
    youngs_modulus : float > 0
        Young's modulus E.
    area : float > 0
        Cross section A.

    Raises
    ------
    InputError
        If a value is out of its range.

    Examples
    --------
    >>> emmy.Bar(youngs_modulus=1e4, area=0.01)
    Bar(youngs_modulus=10000.0, area=0.01)
    """

    model = "bar"
    youngs_modulus: float
    area: float


class Spring(Material):
    """A spring without mass.

    ``V = k/2 (l - l_0)^2``, of the whole link.

    Parameters
    ----------
    stiffness : float > 0
        Stiffness k.
    rest_length : float ≥ 0, optional
        Length l_0 without force; the reference length of each link if not given.

    Raises
    ------
    InputError
        If a value is out of its range.

    Examples
    --------
    >>> emmy.Spring(stiffness=20.0, rest_length=1.2).rest_length
    1.2
    """

    model = "spring"
    stiffness: float
    rest_length: float | None = None


class Attraction(Material):
    """Attraction of two masses, such as gravitation; without mass.

    ``V = -g/l``, of the whole link.

    Parameters
    ----------
    strength : float ≠ 0
        Strength g, of two masses that attract each other G m_1 m_2; negative: repulsion.

    Raises
    ------
    InputError
        If a value is out of its range.

    Examples
    --------
    >>> emmy.Attraction(strength=6.0)
    Attraction(strength=6.0)
    """

    model = "attraction"
    strength: float
