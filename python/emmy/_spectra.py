"""Spectra of series, and harmonic responses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _emmy
from . import _words as words
from ._body import Body
from ._errors import fault, warn
from ._history import record_array
from ._state import Snapshot, State


def spectrum(
    time: ArrayLike,
    values: ArrayLike,
    *,
    kind: str = "psd",
    input: ArrayLike | None = None,
    window: str = "hann",
    segment: int | None = None,
    overlap: int | None = None,
    detrend: str = "constant",
    frequencies: ArrayLike | None = None,
    q: float = 10.0,
    derivative: int = 0,
    step: float | None = None,
) -> NDArray[Any]:
    """Spectrum of a column of a history, or of any series, as `emmy spectrum`.

    Averages over segments are those of `scipy.signal.welch`, `csd` and `coherence`; the shock response spectrum is that
    of the ramp-invariant filters of ISO 18431-4.

    Parameters
    ----------
    time : array (n,)
        Times, which grow. If their distances differ by more than 1e-6, values are interpolated, with a warning.
    values : array (n,)
        Values at these times. Leading ones that are not finite, such as an acceleration at the start, are left out.
    kind : str, optional
        ``"psd"``, ``"amplitude"``, ``"frf"``, ``"transmissibility"`` or ``"srs"``.
    input : array (n,), optional
        Input of ``frf`` and ``transmissibility``, to which the values are the response.
    window : str, optional
        Window of the segments: ``hann``, ``boxcar``, ``flattop`` or ``blackman``.
    segment, overlap : int, optional
        Samples of a segment, 256 if not given, or all of ``amplitude``; samples that it shares with the next one, half
        of it if not given.
    detrend : str, optional
        Trend that is taken out of each segment: ``constant``, ``linear`` or ``none``.
    frequencies : array, optional
        Frequencies of ``srs``; 120 in equal ratios if not given.
    q : float, optional
        Quality factor 1/(2 zeta) of the oscillators of ``srs``, which takes the values as accelerations.
    derivative : int, optional
        Number of derivatives in time that are taken first, as by `numpy.gradient`.
    step : float, optional
        Distance of the samples, between which values are interpolated.

    Returns
    -------
    structured array
        ``frequency``, and by kind ``psd``; ``amplitude``; ``amplitude``, ``phase``, ``coherence``;
        ``transmissibility``, ``coherence``; or ``acceleration_maximax``, ``acceleration_positive``,
        ``acceleration_negative`` and the same of ``displacement``.

    Raises
    ------
    InputError
        If a number or a word is bad.

    Examples
    --------
    >>> t = 0.01 * np.arange(400)
    >>> found = emmy.spectrum(t, 3.0 * np.sin(10 * np.pi * t), kind="amplitude")
    >>> peak = found[np.argmax(found["amplitude"])]
    >>> round(float(peak["frequency"]), 12), round(float(peak["amplitude"]), 12)
    (5.0, 3.0)
    """
    t = words.finite(time, (None,), "time")
    series = [words.array(values, (len(t),), "values")]
    if (kind in ("frf", "transmissibility")) != (input is not None):
        raise fault("input", "belongs to the kinds frf and transmissibility, which need it")
    if input is not None:
        series.append(words.array(input, (len(t),), "input"))
    # Some columns have no number at the start, such as accelerations.
    first = int(np.argmax(np.isfinite(series).all(axis=0)))
    t = t[first:]
    places = zip(series, ("values", "input"), strict=False)
    series = [words.finite(own[first:], (len(t),), place) for own, place in places]
    table, notes = _emmy.spectrum(
        t,
        series[0],
        series[1] if input is not None else None,
        (kind, window, detrend),
        (None if step is None else words.real(step, "step"), words.real(q, "q")),
        None if segment is None else words.count(segment, 1, "segment"),
        None if overlap is None else words.count(overlap, 0, "overlap"),
        None if frequencies is None else words.finite(frequencies, (None,), "frequencies"),
        words.count(derivative, 0, "derivative", 2),
    )
    warn(notes)
    return record_array({name: list(numbers) for name, numbers in table.items()})


@dataclass(frozen=True, eq=False)
class Response:
    """Steady vibration under harmonic excitation.

    Attributes
    ----------
    frequencies : array (m,)
        Frequencies in cycles per time.
    nodes : array (n,)
        Nodes.
    amplitudes : array (m, n, 3) or (m, n, 6), complex
        Complex amplitudes u of the nodes: the vibration is the real part of u exp(2 pi i f t). A stress has the
        components xx, yy, zz, xy, yz, xz.
    natural_frequencies : array (count,)
        Frequencies of the modes.
    damping_ratios : array (count,)
        Damping ratios of the modes; NaN for a rigid one.
    modal_forces : array (count,)
        Forces v . f on the modes, with v M v = 1.

    Examples
    --------
    >>> mesh = emmy.Mesh.network([(0, 0, 0), (1, 0, 0)], [(0, 1)], groups={"foot": [0], "head": [1]})
    >>> body = emmy.Body(mesh, emmy.Region(emmy.Spring(stiffness=18.0)), masses=emmy.Mass("head", mass=0.5),
    ...                  supports=[emmy.Support("foot", fix="xyz"), emmy.Support("head", fix="yz")])
    >>> emmy.response(body, [1.0], base="x", damping=0.05, count=1).natural_frequencies.round(4).tolist()
    [0.9549]
    """

    frequencies: NDArray[np.float64]
    nodes: NDArray[np.int64]
    amplitudes: NDArray[np.complex128]
    natural_frequencies: NDArray[np.float64]
    damping_ratios: NDArray[np.float64]
    modal_forces: NDArray[np.float64]


def response(
    body: Body,
    frequencies: ArrayLike,
    *,
    base: str | Sequence[float] | None = None,
    loads: Sequence[int] | None = None,
    damping: float | Sequence[float] | None = None,
    quantity: str = "displacement",
    relative: bool = False,
    nodes: ArrayLike | None = None,
    count: int = 10,
    state: State | Snapshot | None = None,
) -> Response:
    """Response of a body to harmonic excitation, by superposition of its modes and a static correction.

    Parameters
    ----------
    body : Body
        Body.
    frequencies : array (m,)
        Frequencies in cycles per time.
    base : str or (3,), optional
        Axis along which the supports shake with an acceleration of amplitude 1, or their acceleration.
    loads : list of int, optional
        Numbers of the loads that excite the body without `base`, at factor 1 in the reference configuration; all if not
        given.
    damping : float or list of float, optional
        Damping ratio of every mode, or of each, the last of which holds for all later ones; if not given, viscosity and
        drag of the body.
    quantity : str, optional
        ``"displacement"``, ``"velocity"`` or ``"acceleration"``; ``"cauchy_stress"`` or
        ``"second_piola_kirchhoff_stress"``, to first order about the state and without their viscous part.
    relative : bool, optional
        Whether amplitudes are relative to the base.
    nodes : array of int (n,) or of bool, optional
        Nodes: their numbers, or a mask with a truth value for each node; all of the mesh if not given.
    count : int, optional
        Number of modes.
    state : State or Snapshot, optional
        Equilibrium about which the body vibrates.

    Returns
    -------
    Response

    Raises
    ------
    InputError
        If an argument is bad, or the state is unstable.
    ConvergenceError
        If the modes are not found.

    Examples
    --------
    A mass on a spring at resonance has the amplitude F/(2 zeta k), a quarter of a period late:

    >>> mesh = emmy.Mesh.network([(0, 0, 0), (1, 0, 0)], [(0, 1)], groups={"foot": [0], "head": [1]})
    >>> body = emmy.Body(mesh, emmy.Region(emmy.Spring(stiffness=18.0)), masses=emmy.Mass("head", mass=0.5),
    ...                  supports=[emmy.Support("foot", fix="xyz"), emmy.Support("head", fix="yz")],
    ...                  loads=emmy.Load("head", nodal_force=(3.0, 0.0, 0.0)))
    >>> found = emmy.response(body, [6.0 / (2 * np.pi)], damping=0.05, nodes=[1], count=1)
    >>> bool(abs(found.amplitudes[0, 0, 0] - 3.0 / (0.1 * 18.0) * -1j) < 1e-9)
    True
    """
    own = words.one(body, Body, "body")._native
    f = words.finite(frequencies, (None,), "frequencies")
    if len(f) == 0 or f.min() <= 0.0:
        raise fault("frequencies", "must be positive")
    at = np.arange(own.n_nodes) if nodes is None else words.members(nodes, own.n_nodes, "nodes")
    if at.size and at.max() >= own.n_nodes:
        raise fault("nodes", f"{at.max()} is not the number of one of the {own.n_nodes} nodes")
    if isinstance(base, str):
        if base not in ("x", "y", "z"):
            raise fault("base", f"{base!r} is neither x, y nor z")
        base = [float(axis == base) for axis in "xyz"]
    about: Any = state._native if isinstance(state, Snapshot) else None
    if about is None and state is not None:
        about = words.one(state, State, "state")._tuple()
    request = {
        "frequencies": f.tolist(),
        "nodes": at.ravel().tolist(),
        "base": None if base is None else words.finite(base, (3,), "base").tolist(),
        "loads": None if loads is None else words.integers(loads, "loads").ravel().tolist(),
        "damping": None if damping is None else np.atleast_1d(words.reals(damping, "damping")).tolist(),
        "quantity": quantity,
        "relative": bool(relative),
        "count": words.count(count, 1, "count"),
    }
    table = own.response(request, about)
    return Response(f, at, **table)
