"""Progress: a bar of tqdm if it is installed, else a line on the standard error."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import Any, Self


class Progress:
    """Progress display between `start` and `total`."""

    def __init__(self, is_on: bool, total: float, unit: str, start: float = 0.0) -> None:
        self._total, self._unit, self._at = total, unit, start
        self._is_on = is_on
        self._bar: Any = None
        if is_on:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                return
            form = "{l_bar}{bar}| {n:.6g}/{total:.6g} [{elapsed}<{remaining}{postfix}]"
            self._bar = tqdm(total=total, initial=start, desc=unit, bar_format=form, leave=True)

    def to(self, at: float, note: str) -> None:
        """Moves to a place."""
        if self._bar is not None:
            self._bar.update(max(at - self._at, 0.0))
            self._bar.set_postfix_str(note)
        elif self._is_on:
            print(f"\r{self._unit} {at:.6g} of {self._total:.6g}  {note}   ", end="", file=sys.stderr, flush=True)
        self._at = at

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.close()
        elif self._is_on:
            print(file=sys.stderr)
