"""Lists of names, examples, the schema, and threads."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, NamedTuple

from . import _emmy
from . import _words as words
from ._errors import warn
from ._run import call


class Named(NamedTuple):
    """A name with its description.

    Attributes
    ----------
    name : str
        Name, as in the input.
    description : str
        Description in a line.

    Examples
    --------
    >>> emmy.schemes()[2].name
    'DGM'
    """

    name: str
    description: str


def _listed(what: str) -> list[Named]:
    return [Named(**item) for item in json.loads(_emmy.verb(["list", what, "--json"], None))]


def schemes() -> list[Named]:
    """Schemes in time.

    Returns
    -------
    list of Named

    Examples
    --------
    >>> [scheme.name for scheme in emmy.schemes()][:3]
    ['FE(n)', 'AS(n)', 'DGM']
    """
    return _listed("schemes")


def materials() -> list[Named]:
    """Models of materials.

    Returns
    -------
    list of Named

    Examples
    --------
    >>> "neo-hooke" in [material.name for material in emmy.materials()]
    True
    """
    return _listed("materials")


def elements() -> list[Named]:
    """Kinds of cells.

    Returns
    -------
    list of Named

    Examples
    --------
    >>> emmy.elements()[0].name
    'hex8'
    """
    return _listed("elements")


def meshes() -> list[Named]:
    """Sources of meshes.

    Returns
    -------
    list of Named

    Examples
    --------
    >>> [mesh.name for mesh in emmy.meshes()][:2]
    ['l-block', 'box']
    """
    return _listed("meshes")


def fields() -> list[Named]:
    """Output fields.

    Returns
    -------
    list of Named

    Examples
    --------
    >>> emmy.fields()[0].name
    'displacement'
    """
    return _listed("fields")


def solvers() -> list[Named]:
    """Solvers of the linear systems.

    Returns
    -------
    list of Named

    Examples
    --------
    >>> [solver.name for solver in emmy.solvers()]
    ['auto', 'direct', 'iterative', 'multigrid']
    """
    return _listed("solvers")


def examples() -> list[Named]:
    """Examples that `new` writes.

    Returns
    -------
    list of Named

    Examples
    --------
    >>> emmy.examples()[0].name
    'l-block'
    """
    return _listed("templates")


def new(name: str) -> Path:
    """Writes a commented example into the working directory, as `emmy new`.

    Parameters
    ----------
    name : str
        Name of the example.

    Returns
    -------
    pathlib.Path
        The input file.

    Raises
    ------
    InputError
        If there is no such example.
    ResultsError
        If the file exists.

    Examples
    --------
    >>> emmy.new("two-body").name
    'two-body.toml'
    """
    call("new", name, progress=False)
    return Path(re.sub(r"(\.toml)*$", ".toml", name, count=1))


def schema() -> dict[str, Any]:
    """JSON schema of the input.

    Returns
    -------
    dict

    Examples
    --------
    >>> "mesh" in emmy.schema()["properties"]
    True
    """
    own: dict[str, Any] = json.loads(_emmy.verb(["schema"], None))
    return own


def set_threads(number: int) -> None:
    """Sets the number of threads, at most one a core. Results do not depend on it.

    Parameters
    ----------
    number : int
        Number of threads; more than there are cores are capped with a warning.

    Raises
    ------
    InputError
        If it is not between 1 and 65535.

    Examples
    --------
    >>> emmy.set_threads(1)
    >>> emmy.threads()
    1
    """
    _emmy.set_threads(words.count(number, 1, "number", most=65535))
    if _emmy.threads() < number:
        warn([f"number: {number} threads on {_emmy.threads()} cores; one thread a core is used"])


def threads() -> int:
    """Number of threads: ``EMMY_NUM_THREADS``, or by default the number of cores, which is also the limit.

    Returns
    -------
    int

    Raises
    ------
    ValueError
        If ``EMMY_NUM_THREADS`` is not a positive whole number.

    Examples
    --------
    >>> emmy.threads() >= 1
    True
    """
    return _emmy.threads()
