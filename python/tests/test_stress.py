"""Long motions keep no memory but their history."""

import ctypes
import multiprocessing
from pathlib import Path

import emmy
import numpy as np
import pytest

from bodies import rubber

STEPS, EARLY = 100_000, 10_000
RESIDENT = Path("/proc/self/statm")
#: Steps to tell a leak by: the smallest object of Python has 24 bytes.
SMALLEST_LEAK = 24 * (STEPS - EARLY)


def resident():
    """Resident memory in bytes."""
    return int(RESIDENT.read_text().split()[1]) * 4096


def motion(scheme, size, **load):
    mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    body = emmy.Body(mesh, emmy.Region(rubber(), density=1.0), loads=[emmy.Load("x-max", **load)] if load else [])
    initial = emmy.Initial(angular_velocity=(0.1, 0.2, 0.3))
    # Few iterations: the test is of memory.
    return emmy.Motion(body, scheme, steps=(STEPS * size, size), initial=initial, tolerance=1e-5)


def growth():
    """Growth of the memory, and the size of the history, in bytes, from an early step to the last."""
    # Huge pages would be resident before they are used: PR_SET_THP_DISABLE.
    ctypes.CDLL(None).prctl(41, 1, 0, 0, 0)
    motions = [motion("DGM", 0.002), motion("central-differences", 0.002, force=(0.1, 0.2, 0.3), history=np.sin)]
    for steps in zip(*motions, strict=True):
        positions = [own.positions for own in motions]
        if steps[0].number == EARLY:
            before = resident()
    after = resident()
    assert [step.number for step in steps] == [STEPS, STEPS] and positions[1].shape == (8, 3)
    # A number of 8 bytes for each column.
    return after - before, sum(8 * len(own.columns) * (STEPS - EARLY) for own in motions)


@pytest.mark.skipif(not RESIDENT.exists(), reason="reads the memory of Linux")
def test_a_hundred_thousand_steps_need_the_memory_of_their_history():
    # In a process of its own, which has no memory to spare from other tests.
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        grown, history = pool.apply(growth)
    assert abs(grown - history) < SMALLEST_LEAK
