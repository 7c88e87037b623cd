"""Long motions keep no memory but their history."""

from pathlib import Path

import emmy
import numpy as np
import pytest

from bodies import rubber

STEPS = 50_000


def resident():
    """Resident memory in bytes."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="reads the memory of Linux")
@pytest.mark.parametrize("scheme", ["DGM", "Newmark(0.25, 0.5)"])
def test_a_hundred_thousand_steps_need_the_memory_of_their_history(scheme):
    mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    load = emmy.Load("x-max", force=(0.1, 0.2, 0.3), history=np.sin)
    body = emmy.Body(mesh, emmy.Region(rubber(), density=1.0), loads=load)
    initial = emmy.Initial(angular_velocity=(0.1, 0.2, 0.3))
    motion = emmy.Motion(body, scheme, steps=(STEPS * 0.01, 0.01), initial=initial)
    early = STEPS // 10
    for step in motion:
        positions = motion.positions
        if step.number == early:
            before = resident()
    assert motion.number == STEPS and positions.shape == (8, 3)
    # A number of 8 bytes for each column, in a list whose capacity doubles; 4 MB for the allocators.
    history = 8 * len(motion.columns) * (STEPS - early)
    assert resident() - before < 2 * history + 4e6
