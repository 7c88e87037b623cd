"""States and snapshots of motions."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from . import _emmy
from . import _words as words
from ._errors import regular


@dataclass(frozen=True, eq=False)
class State:
    """Positions and velocities of a body at a time.

    Parameters
    ----------
    time : float
        Time.
    displacement, velocity : array (n, 3) or (3 n,)
        Displacement and velocity of the nodes.
    momentum : array (n, 3) or (3 n,), optional
        Momentum of the nodes, ``p = M v``. Without it a motion that starts here computes it from the velocity with the
        masses of its body, and nodes that its supports hold begin at rest.
    step : int
        Number of the step at whose end they hold.
    displacement_low : array (n, 3) or (3 n,), optional
        Low part of the displacement, by which it is known beyond double precision.
    modes : array (m, 3) or (3 m,), optional
        Displacements of the internal nodes of incompatible modes, minus the mean over their cell; zero if not given. A
        state from `emmy.equilibrium` contains them.
    coordinates : array (n_joints,), optional
        Angles, slides and distances of the joints. Without them each angle is within half a turn of the drawing.

    Raises
    ------
    InputError
        If an array has another shape, or a number is not finite.
    TypeError
        If the time is not a number, the step no whole number, or an array does not hold numbers.

    Examples
    --------
    >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
    >>> emmy.Motion(body).state.displacement.shape
    (8, 3)

    A kick: another velocity, and the momentum that belongs to it.

    >>> import dataclasses
    >>> state = emmy.Motion(body).state
    >>> kicked = dataclasses.replace(state, velocity=state.velocity + [0.0, 2.0, 0.0], momentum=None)
    >>> round(emmy.Motion(body, start=kicked).record.kinetic_energy, 12)
    2.0
    """

    time: float
    displacement: NDArray[np.float64]
    velocity: NDArray[np.float64]
    momentum: NDArray[np.float64] | None = None
    step: int = 0
    displacement_low: NDArray[np.float64] | None = None
    modes: NDArray[np.float64] | None = None
    coordinates: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "time", words.real(self.time, "time"))
        for name in ("displacement", "velocity", "momentum", "displacement_low", "modes"):
            value = getattr(self, name)
            if value is not None or name in ("displacement", "velocity"):
                object.__setattr__(self, name, words.vectors(value, None, name))
        if self.coordinates is not None:
            object.__setattr__(self, "coordinates", words.finite(self.coordinates, (None,), "coordinates"))
        object.__setattr__(self, "step", words.count(self.step, 0, "step"))

    def _tuple(self) -> tuple[Any, ...]:
        low, modes = self.displacement_low, self.modes
        return (self.time, self.displacement, self.velocity, self.momentum, self.step, low, modes, self.coordinates)


class Snapshot:
    """Everything that determines the rest of a motion; a motion continued from it is bit-identical.

    Its body has the same mesh and masses; with other loads, supports or materials the motion goes on from its state.

    `Motion.snapshot` makes it. It can be pickled.

    Examples
    --------
    >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
    >>> motion = emmy.Motion(body, steps=(1.0, 0.1), initial=emmy.Initial(velocity=(1, 0, 0)))
    >>> step = motion.step(0.1)
    >>> emmy.Motion(body, steps=(1.0, 0.1), start=motion.snapshot()).time
    0.1
    """

    def __init__(self, native: _emmy.Snapshot) -> None:
        self._native = native

    @property
    def time(self) -> float:
        """Time of the snapshot."""
        return self._native.time

    @property
    def number(self) -> int:
        """Number of the step at whose end it was made."""
        return self._native.number

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the snapshot to a file.

        Parameters
        ----------
        path : str or path
            File; one that exists is replaced once the new one is complete.

        Raises
        ------
        OSError
            If the file cannot be written.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> emmy.Motion(body).snapshot().save("start.emmy")
        >>> emmy.Snapshot.load("start.emmy")
        <emmy.Snapshot: step 0, t = 0.0>
        """
        part = f"{os.fspath(path)}.part"
        with open(part, "wb") as file:
            file.write(bytes(self))
        os.replace(part, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Reads a snapshot that `save` has written.

        Parameters
        ----------
        path : str or path
            File.

        Returns
        -------
        Snapshot

        Raises
        ------
        ResultsError
            If the file is no snapshot, damaged, a device or a pipe.
        OSError
            If it cannot be read.

        Examples
        --------
        >>> import pathlib
        >>> _ = pathlib.Path("damaged.emmy").write_bytes(b"nothing")
        >>> try:
        ...     emmy.Snapshot.load("damaged.emmy")
        ... except emmy.ResultsError:
        ...     print("damaged")
        damaged
        """
        with open(regular(path), "rb") as file:
            return cls(_emmy.Snapshot.from_bytes(file.read()))

    def __bytes__(self) -> bytes:
        return bytes(self._native)

    def __reduce__(self) -> tuple[Any, ...]:
        return _from_bytes, (bytes(self),)

    def __repr__(self) -> str:
        return f"<emmy.Snapshot: step {self.number}, t = {self.time}>"


def _from_bytes(content: bytes) -> Snapshot:
    return Snapshot(_emmy.Snapshot.from_bytes(content))
