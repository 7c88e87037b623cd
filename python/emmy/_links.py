"""Materials of links, which are cells of two nodes."""

from __future__ import annotations

from ._materials import Material


class Bar(Material):
    """A bar of a truss, or a cable under tension; its density is a mass per volume.

    ``W = E A L e^2/2`` of the whole link, with ``e = (l^2/L^2 - 1)/2``.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus E.
    area : float
        Cross section A.

    Raises
    ------
    InputError
        If a value is not positive.

    Examples
    --------
    >>> emmy.Bar(youngs_modulus=1e4, area=0.01)
    Bar(youngs_modulus=10000.0, area=0.01)
    """

    model = "bar"
    youngs_modulus: float
    area: float


class Spring(Material):
    """A spring without mass, ``W = k/2 (l - l_0)^2``.

    Parameters
    ----------
    stiffness : float
        Stiffness k.
    rest_length : float, optional
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
    """Attraction of two masses, such as gravitation: ``W = -g/l``, without mass.

    Parameters
    ----------
    strength : float
        Strength g, of two masses G m_1 m_2; negative: repulsion.

    Raises
    ------
    InputError
        If the strength is 0.

    Examples
    --------
    >>> emmy.Attraction(strength=6.0)
    Attraction(strength=6.0)
    """

    model = "attraction"
    strength: float
