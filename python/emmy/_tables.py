"""Regions, supports, loads, masses, ties, contacts and the parts of mechanisms from the tables of an input file."""

from __future__ import annotations

from typing import Any

from ._contact import OBSTACLES, Contact
from ._joints import KINDS, Joint
from ._materials import Material
from ._parts import Coupling, Load, Mass, Region, Rigid, Support, Tie, Viscosity


def material(tree: dict[str, Any]) -> Material:
    """The material of a table such as `{"neo-hooke": {...}}`."""
    ((model, parameters),) = tree.items()
    own = next(own for own in Material.__subclasses__() if own.model == model)
    return own(**{"lambda_" if key == "lambda" else key: value for key, value in parameters.items()})


def regions(tree: dict[str, Any]) -> tuple[Region, ...]:
    """The regions of an input."""
    return tuple(map(_region, _tables(tree, "region")))


def supports(tree: dict[str, Any]) -> tuple[Support, ...]:
    """The supports of an input."""
    return tuple(Support(**table) for table in _tables(tree, "support"))


def loads(tree: dict[str, Any]) -> tuple[Load, ...]:
    """The loads of an input."""
    return tuple(_load(table, tree) for table in _tables(tree, "load"))


def masses(tree: dict[str, Any]) -> tuple[Mass, ...]:
    """The point masses of an input."""
    return tuple(Mass(**table) for table in _tables(tree, "mass"))


def ties(tree: dict[str, Any]) -> tuple[Tie, ...]:
    """The ties of an input."""
    return tuple(Tie(**table) for table in _tables(tree, "tie"))


def contacts(tree: dict[str, Any]) -> tuple[Contact, ...]:
    """The contacts of an input."""
    return tuple(map(_contact, _tables(tree, "contact")))


def rigid(tree: dict[str, Any]) -> tuple[Rigid, ...]:
    """The rigid bodies of an input."""
    return tuple(Rigid(**table) for table in _tables(tree, "rigid"))


def couplings(tree: dict[str, Any]) -> tuple[Coupling, ...]:
    """The couplings of an input."""
    return tuple(Coupling(**table) for table in _tables(tree, "coupling"))


def joints(tree: dict[str, Any]) -> tuple[Joint, ...]:
    """The joints of an input."""
    return tuple(map(_joint, _tables(tree, "joint")))


def _contact(table: dict[str, Any]) -> Contact:
    others = {key: value for key, value in table.items() if key not in ("surfaces", "obstacle")}
    surfaces = table["surfaces"]
    surface, opponent = (surfaces, None) if isinstance(surfaces, str) else surfaces
    if "obstacle" in table:
        obstacle = dict(table["obstacle"])
        motion = obstacle.pop("move", None)
        ((shape, own),) = obstacle.items()
        (kind,) = (kind for kind in OBSTACLES if kind._section == f"obstacle.{shape}")
        opponent = kind(**own, move=motion)
    return Contact(surface, opponent, **others)


def _load(table: dict[str, Any], tree: dict[str, Any]) -> Load:
    others = {key: value for key, value in table.items() if key != "gravity"}
    if "gravity" in table:
        return Load.gravity(table["gravity"], units=tree["units"]["system"], **others)
    return Load(**others)


def _joint(table: dict[str, Any]) -> Joint:
    ((kind, own),) = ((key, value) for key, value in table.items() if key in KINDS)
    others = {key: value for key, value in table.items() if key not in KINDS}
    return Joint(others.pop("name", None), kind=kind, **others, **own)


def _tables(tree: dict[str, Any], key: str) -> list[dict[str, Any]]:
    given = tree.get(key, [])
    return [given] if isinstance(given, dict) else given


def _region(table: dict[str, Any]) -> Region:
    own = dict(table)
    if "viscosity" in own:
        own["viscosity"] = Viscosity(**own["viscosity"])
    return Region(material(own.pop("material")), **own)
