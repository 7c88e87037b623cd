"""Motions and runs in notebooks: a verdict and charts, drawn as SVG without further packages."""

from __future__ import annotations

import html
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._errors import ResultsError, regular

if TYPE_CHECKING:
    from ._results import Run
    from ._view import MotionView

WIDTH, HEIGHT, LEFT, TOP, BOTTOM = 460, 200, 64, 24, 28
COLORS = ("#1f77b4", "#d95f02", "#1b9e77")
MOST_POINTS = 800


def motion(view: MotionView) -> str:
    """A motion: where it stands, the verdict, and charts."""
    size = f"{view.body.mesh.n_cells} cells, {view.body.n_dofs} degrees of freedom"
    scheme = f"{html.escape(view.scheme)}, degree {view.degree}"
    head = f"<b>emmy.Motion</b>: {scheme}; {size}; step {view.number}, t = {view.time:.6g}"
    scales = (view._native.energy_scale, view._native.angular_momentum_scale)
    return _page(head, view.history, view.accuracy, scales)


def run(results: Run) -> str:
    """A run: how it ended, the verdict, charts, and its report."""
    head = f"<b>emmy.Run</b>: {html.escape(str(results.directory))}"
    if results._has_summary:
        head += f", {html.escape(results.status)}"
    try:
        accuracy, scales = "", (0.0, 0.0)
        if results._has_summary:
            accuracy, summary = results.accuracy, results.summary
            scales = (summary.get("energy_scale") or 0.0, summary.get("angular_momentum_scale") or 0.0)
        page = _page(head, results.history, accuracy, scales)
    except ResultsError:
        # A run that has just begun has no history yet.
        return html.escape(repr(results))
    if not results.report.exists():
        return page
    regular(results.report)
    report = html.escape(results.report.read_text(encoding="utf-8"), quote=True)
    frame = f'<iframe srcdoc="{report}" style="width:100%;height:640px;border:1px solid #ccc" title="report"></iframe>'
    return page + f"<details><summary>Report</summary>{frame}</details>"


#: An angular momentum below this part of the largest possible one is round-off.
AT_REST = 1e-9

#: An energy below this part of the possible one is round-off.
ENERGY_AT_REST = 1e-24


def verdict(history: NDArray[Any], scales: tuple[float, float]) -> str:
    """How well the balances were kept, in a sentence; `scales`: possible energy, largest possible angular momentum."""
    if len(history) < 2:
        return "no step yet"
    possible, scale = scales
    energies = np.abs(history["kinetic_energy"]) + np.abs(history["strain_energy"])
    if np.nanmax(energies) < ENERGY_AT_REST * possible:
        energy = _over(np.abs(history["energy_residual"]), np.array([possible]), "possible value")
    else:
        energy = _over(np.abs(history["energy_residual"]), energies)
    components = np.stack([history[f"angular_momentum_{axis}"] for axis in "xyz"])
    momentum = np.sqrt((components**2).sum(axis=0))
    if np.nanmax(momentum) > AT_REST * scale:
        angular = _over(history["angular_momentum_residual"], momentum)
    else:
        angular = _over(history["angular_momentum_residual"], np.array([scale]), "largest possible value")
    return f"worst energy residual of a step {energy}; worst angular momentum residual {angular}"


def _over(residual: NDArray[np.float64], scale: NDArray[np.float64], of: str = "largest value") -> str:
    largest, worst = float(np.nanmax(scale)), float(np.nanmax(residual))
    if largest > 0.0:
        return f"{worst / largest:.1e} of the {of}"
    return f"{worst:.1e} (the quantity itself is 0)"


def _page(head: str, history: NDArray[Any], accuracy: str, scales: tuple[float, float]) -> str:
    known = f"; accuracy in time: {html.escape(accuracy)}" if accuracy else ""
    parts = [f"<div><p>{head}<br>{verdict(history, scales)}{known}</p>"]
    if len(history) > 1:
        time = history["time"]
        parts.append(chart("Energy", time, energies_of(history)))
        parts.append(
            chart(
                "Energy residual of a step", time[1:], {"residual": np.abs(history["energy_residual"][1:])}, is_log=True
            )
        )
    return "".join(parts) + "</div>"


ENERGIES = {"T + V": "total_energy", "T": "kinetic_energy", "V": "strain_energy"}
ENERGIES_WITH_CONTACT = {
    "H": "total_energy",
    "T": "kinetic_energy",
    "V": "strain_energy",
    "V_c": "contact_energy",
}


def energies_of(history: NDArray[Any]) -> dict[str, NDArray[np.float64]]:
    """The energies in a history by their letters."""
    names = ENERGIES_WITH_CONTACT if "contact_energy" in (history.dtype.names or ()) else ENERGIES
    return {name: history[key] for name, key in names.items()}


def chart(title: str, x: NDArray[np.float64], lines: dict[str, NDArray[np.float64]], *, is_log: bool = False) -> str:
    """Lines over time as an SVG picture; with `is_log` their decimal logarithms."""
    values = {name: _logarithm(own) if is_log else own for name, own in lines.items()}
    known = np.concatenate([own[np.isfinite(own)] for own in values.values()])
    if known.size == 0:
        return f"<p>{title}: 0 throughout</p>"
    low, high = (math.floor(known.min()), math.ceil(known.max())) if is_log else (known.min(), known.max())
    low, high = (low - 0.5, high + 0.5) if low == high else (low, high)
    start, end = float(x[0]), float(x[-1]) if x[-1] > x[0] else float(x[0]) + 1.0
    across, down = WIDTH - LEFT - 8, HEIGHT - TOP - BOTTOM

    def points(own: NDArray[np.float64]) -> str:
        chosen = _fewer(own)
        chosen = chosen[np.isfinite(own[chosen])]
        right = LEFT + (x[chosen] - start) / (end - start) * across
        up = TOP + (high - own[chosen]) / (high - low) * down
        return " ".join(f"{i:.1f},{j:.1f}" for i, j in zip(right, up, strict=True))

    def text(i: float, j: float, words: str, anchor: str, fill: str = "currentColor") -> str:
        return f'<text x="{i:.0f}" y="{j:.0f}" text-anchor="{anchor}" fill="{fill}">{html.escape(words)}</text>'

    frame = f'x="{LEFT}" y="{TOP}" width="{across}" height="{down}"'
    drawn = [f'<rect {frame} fill="none" stroke="currentColor" stroke-opacity="0.4"/>']
    for index, (name, own) in enumerate(values.items()):
        color = COLORS[index % len(COLORS)]
        drawn.append(f'<polyline points="{points(own)}" fill="none" stroke="{color}" stroke-width="1.3"/>')
        if len(values) > 1:
            drawn.append(text(WIDTH - 8 - 50 * index, 16, name, "end", color))
    for value, j in ((high, TOP + 10), (low, HEIGHT - BOTTOM)):
        drawn.append(text(LEFT - 6, j, f"1e{value:.0f}" if is_log else f"{value:.4g}", "end"))
    drawn += [text(LEFT, HEIGHT - 8, f"t = {start:.4g}", "start"), text(WIDTH - 8, HEIGHT - 8, f"{end:.4g}", "end")]
    drawn.append(text(LEFT, 16, title, "start"))
    style = "font:12px sans-serif;max-width:49%"
    return f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" role="img" style="{style}">{"".join(drawn)}</svg>'


def _logarithm(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.log10(values, out=np.full(len(values), np.nan), where=values > 0.0)


def _fewer(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Indices of so few points that a chart stays small, with the extremes of each part: no peak is lost."""
    if len(values) <= MOST_POINTS:
        return np.arange(len(values))
    parts = np.array_split(np.arange(len(values)), MOST_POINTS // 2)
    filled = np.nan_to_num(values, nan=float(np.nanmin(values)))
    return np.unique([index for part in parts for index in (part[filled[part].argmin()], part[filled[part].argmax()])])
