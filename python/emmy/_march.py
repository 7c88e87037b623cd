"""Marching along the plan of a motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ._progress import Progress

if TYPE_CHECKING:
    from ._motion import Motion, Observer

# Wall time of a slice in seconds: between slices Python handles signals and other threads get their turn at once.
SLICE = 0.05


def march(motion: Motion, until: float | None, observers: Sequence[Observer], progress: bool) -> bool:
    """Marches to the end of the plan or to `until`; returns True if it got there."""
    native = motion._native
    end = native.end if until is None else min(until, native.end)
    with Progress(progress, end, "t", start=native.time) as bar:
        while native.advance(0.0 if observers else SLICE, until):
            step = native.record()
            if progress:
                bar.to(native.time, f"step {native.number}, energy balance {step.energy_residual:.0e}")
            # Every observer sees the step, also if an earlier one stops the run.
            if any([observer(step, motion) for observer in observers]):  # noqa: C419
                return native.time >= end
    return True
