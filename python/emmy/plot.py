"""Pictures of a motion over time, with Matplotlib: energies, residuals of the balances, and columns of the history.

Each function draws into the axes that it is given, or into new ones, and returns them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import fault, missing
from ._history import History
from ._motion import Motion
from ._notebook import energies_of
from ._results import Run
from ._words import class_name

__all__ = ["columns", "energies", "residuals"]

#: Names of the residuals by their columns.
RESIDUALS = {
    "energy_residual": "energy",
    "linear_momentum_residual": "linear momentum",
    "angular_momentum_residual": "angular momentum",
}


def energies(results: Motion | Run | History, *, ax: Any = None) -> Any:
    """Draws the energies over time: total, kinetic, strain and contact energy; work of loads and dissipated energy, D.

    Parameters
    ----------
    results : Motion, Run or History
        Whose history is drawn.
    ax : matplotlib.axes.Axes, optional
        Axes; new ones if not given.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    TypeError
        If `results` has no history.

    Examples
    --------
    >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=2))
    >>> motion = emmy.Motion(body, steps=(1.0, 0.5), initial=emmy.Initial(velocity=(3, 0, 0)))
    >>> history = motion.run()
    >>> axes = emmy.plot.energies(motion)               # of matplotlib
    >>> axes.lines[0].get_ydata().round(9).tolist()
    [9.0, 9.0, 9.0]
    """
    history, axes = _history(results), _axes(ax)
    lines = energies_of(history)
    if np.any(history["external_work"] != 0.0):
        lines["W"] = history["external_work"]
    if "dissipated_energy" in (history.dtype.names or ()):
        lines["D"] = history["dissipated_energy"]
    for label, values in lines.items():
        axes.plot(history["time"], values, label=label)
    axes.set(xlabel="time", ylabel="energy")
    axes.legend()
    return axes


def residuals(results: Motion | Run | History, *, ax: Any = None) -> Any:
    """Draws what each step leaves of the balances of energy, linear and angular momentum, on a logarithmic axis.

    Parameters
    ----------
    results : Motion, Run or History
        Whose history is drawn.
    ax : matplotlib.axes.Axes, optional
        Axes; new ones if not given.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    TypeError
        If `results` has no history.

    Examples
    --------
    >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=2))
    >>> motion = emmy.Motion(body, steps=(1.0, 0.1), initial=emmy.Initial(angular_velocity=(0, 0, 1)))
    >>> axes = emmy.plot.residuals(motion.run())        # of matplotlib
    >>> axes.get_yscale(), [line.get_label() for line in axes.lines]
    ('log', ['energy', 'linear momentum', 'angular momentum'])
    """
    history, axes = _history(results)[1:], _axes(ax)
    for column, label in RESIDUALS.items():
        sizes = np.abs(history[column])
        # Zero has no place on the axis.
        axes.plot(history["time"], np.where(sizes > 0.0, sizes, np.nan), label=label)
    axes.set(xlabel="time", ylabel="residual of a step", yscale="log")
    axes.legend()
    return axes


def columns(results: Motion | Run | History, *names: str, ax: Any = None) -> Any:
    """Draws columns of the history over time.

    Parameters
    ----------
    results : Motion, Run or History
        Whose history is drawn.
    *names : str
        Columns. Without a column X, X stands for the components X_x, X_y, X_z, such as those of a probe, else for all
        columns that begin with X_, such as those of a reaction or joint.
    ax : matplotlib.axes.Axes, optional
        Axes; new ones if not given.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    InputError
        If there is no such column, or it has words.
    TypeError
        If `results` has no history, or no name is given.

    Examples
    --------
    >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=2))
    >>> start = emmy.Initial(velocity=(0, 0, 3))
    >>> motion = emmy.Motion(body, steps=(1.0, 0.5), initial=start, probes={"corner": (1, 1, 1)})
    >>> axes = emmy.plot.columns(motion.run(), "corner")          # of matplotlib
    >>> [line.get_label() for line in axes.lines], axes.lines[2].get_ydata().round(9).tolist()
    (['corner_x', 'corner_y', 'corner_z'], [1.0, 2.5, 4.0])
    """
    if not names:
        raise TypeError("names: give at least one column")
    history = _history(results)
    known = history.dtype.names or ()
    chosen: list[str] = []
    for name in names:
        components = [f"{name}_{axis}" for axis in "xyz" if f"{name}_{axis}" in known]
        found = [name] if name in known else components or [own for own in known if own.startswith(f"{name}_")]
        if not found:
            raise fault("names", f"{name!r} is not a column; there is {', '.join(known)}")
        chosen += found
    for name in chosen:
        if history.dtype[name].kind == "U":
            raise fault("names", f"{name!r} has words, which cannot be drawn")
    axes = _axes(ax)
    for name in chosen:
        axes.plot(history["time"], history[name], label=name)
    axes.set(xlabel="time")
    axes.legend()
    return axes


def _history(results: Any) -> NDArray[Any]:
    if isinstance(results, (Motion, Run)):
        return results.history
    if isinstance(results, np.ndarray) and "time" in (results.dtype.names or ()):
        return results
    raise TypeError(f"results: {class_name(type(results))} in place of emmy.Motion, emmy.Run or emmy.History")


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise missing("emmy.plot", "Matplotlib", "matplotlib") from None
    return plt.subplots(layout="constrained")[1]
