"""The base class of the materials, and energies by formula."""

from __future__ import annotations

import keyword
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _emmy
from ._errors import InputError, fault
from ._words import Table, Vector, plain, reals, tree


class Material(Table):
    """A strain energy W(E) with its parameters, which are those of the input: the base class of the materials.

    Raises
    ------
    InputError
        If a value is out of its range.

    Examples
    --------
    >>> isinstance(emmy.Yeoh(c10=0.3, c20=-0.01, c30=0.001, bulk_modulus=500.0), emmy.Material)
    True
    """

    _section: ClassVar[str] = "material"
    #: Name of the model in the input.
    model: ClassVar[str]

    def _check(self) -> None:
        try:
            _emmy.check(self._section, self._as_material())
        except InputError as error:
            # The class says which model it is.
            places = [item.place.removeprefix(self.model).removeprefix(".") for item in error.faults]
            faults = [item._replace(place=place) for item, place in zip(error.faults, places, strict=True)]
            raise InputError(faults) from None

    def _as_material(self) -> dict[str, Any]:
        return {self.model: self._tree()}

    def energy(self, strain: ArrayLike) -> NDArray[np.float64]:
        """Strain energy per reference volume.

        Parameters
        ----------
        strain : array (..., 3, 3)
            Green-Lagrange strain E.

        Returns
        -------
        array (...)
            W(E).

        Raises
        ------
        InputError
            If the last axes are not 3 and 3, the material is one of links, or it has no energy at a strain.
        TypeError
            If the array does not hold numbers.

        Examples
        --------
        >>> energy = emmy.SaintVenantKirchhoff(lambda_=3.0, mu=1.0).energy(np.diag([0.1, 0.0, 0.0]))
        >>> round(float(energy), 12)
        0.025
        """
        strains = _strains(strain)
        return _emmy.energy(self._as_material(), strains.reshape(-1, 3, 3)).reshape(strains.shape[:-2])

    def stress(self, strain: ArrayLike) -> NDArray[np.float64]:
        """Second Piola-Kirchhoff stress S = dW/dE.

        Parameters
        ----------
        strain : array (..., 3, 3)
            Green-Lagrange strain E.

        Returns
        -------
        array (..., 3, 3)
            S(E).

        Raises
        ------
        InputError
            If the last axes are not 3 and 3, the material is one of links, or it has no energy at a strain.
        TypeError
            If the array does not hold numbers.

        Examples
        --------
        >>> stress = emmy.SaintVenantKirchhoff(lambda_=3.0, mu=1.0).stress(np.diag([0.1, 0.0, 0.0]))
        >>> np.round(np.diag(stress), 12).tolist()
        [0.5, 0.3, 0.3]
        """
        strains = _strains(strain)
        return _emmy.stress(self._as_material(), strains.reshape(-1, 3, 3)).reshape(strains.shape)


def _strains(strain: ArrayLike) -> NDArray[np.float64]:
    strains = reals(strain, "strain")
    if strains.shape[-2:] != (3, 3):
        raise fault("strain", f"expected an array of shape (..., 3, 3), found {strains.shape}")
    return strains


class Energy(Material):
    """A strain energy given by a formula, which is differentiated and compiled.

    Parameters
    ----------
    formula : str
        Expression in the invariants ``I1, I2, I3, J, I1_bar, I2_bar``, with a fibre also ``I4, I4_bar``, and in the
        parameters.
    fibre : vector, optional
        Direction of the fibres.
    **parameters : float
        Values of the other names in the formula; a trailing underscore after a Python keyword is dropped, so that
        ``lambda_`` is ``lambda``.

    Raises
    ------
    InputError
        If the formula is not an energy: unknown names, stress at rest, moduli that are not positive.

    Examples
    --------
    >>> formula = "mu/2*(I1 - 3) - mu*ln(J) + lambda/2*ln(J)^2"
    >>> own = emmy.Energy(formula, mu=500.0, lambda_=1000.0)
    >>> E = [[0.1, 0.02, 0.0], [0.02, -0.05, 0.01], [0.0, 0.01, 0.2]]
    >>> bool(np.isclose(own.energy(E), emmy.NeoHooke(lambda_=1000.0, mu=500.0).energy(E), rtol=1e-12))
    True
    """

    model = "energy"
    formula: str
    fibre: Vector | None
    parameters: tuple[tuple[str, float], ...]

    def __init__(self, formula: str, *, fibre: Vector | None = None, **parameters: float) -> None:
        # `dataclasses.replace` gives the field of this name beside the changes.
        kept: Any = parameters.pop("parameters") if isinstance(parameters.get("parameters"), tuple) else ()
        names = dict(kept) | {
            name.removesuffix("_") if keyword.iskeyword(name[:-1]) else name: value
            for name, value in parameters.items()
        }
        object.__setattr__(self, "formula", formula)
        object.__setattr__(self, "fibre", plain(fibre, "fibre"))
        object.__setattr__(
            self, "parameters", tuple((name, plain(value, name)) for name, value in sorted(names.items()))
        )
        self._check()

    def _tree(self) -> dict[str, Any]:
        direction = {} if self.fibre is None else {"fibre": tree(self.fibre, "fibre")}
        return {"formula": self.formula} | direction | dict(self.parameters)

    def __repr__(self) -> str:
        given: dict[str, object] = {} if self.fibre is None else {"fibre": self.fibre}
        given |= {f"{name}_" if keyword.iskeyword(name) else name: value for name, value in self.parameters}
        arguments = "".join(f", {name}={value!r}" for name, value in given.items())
        return f"Energy({self.formula!r}{arguments})"
