"""The command line, for the script `emmy` and `python -m emmy`."""

from __future__ import annotations

import sys

from . import _emmy


def main() -> int:
    """Runs the command line with the arguments of the process.

    Returns
    -------
    int
        Exit code.
    """
    return _emmy.main(["emmy", *sys.argv[1:]])
