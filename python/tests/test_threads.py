"""Threads and processes."""

import multiprocessing
import os
import subprocess
import sys
import threading
import time

import emmy
import numpy as np
import pytest

from bodies import rubber, spinning_block


def large_motion():
    body = emmy.Body(emmy.Mesh.box((2, 2, 2), (14, 14, 14)), emmy.Region(rubber(), density=1.0))
    return emmy.Motion(body, steps=(1.0, 0.01), initial=emmy.Initial(angular_velocity=(0, 0, 1)))


def test_other_threads_run_during_a_step():
    motion = large_motion()
    wakes, stop = [], threading.Event()

    def wake():
        while not stop.is_set():
            time.sleep(0.002)
            wakes.append(time.perf_counter())

    thread = threading.Thread(target=wake)
    thread.start()
    start = time.perf_counter()
    motion.step(0.01)
    end = time.perf_counter()
    stop.set()
    thread.join()
    during = [at for at in wakes if start < at < end]
    # With the lock held there would be none but at the switches; half the rate leaves room for a busy machine.
    assert len(during) > (end - start) / 0.010


def test_motions_side_by_side_equal_those_alone():
    mesh = emmy.Mesh.box((1, 4, 1), (1, 4, 1))
    push = emmy.Load("y-max", force=(20.0, 0.0, 10.0), history=lambda t: np.sin(9 * t))
    body = emmy.Body(mesh, emmy.Region(rubber(), density=1.0), emmy.Support("y-min", fix="xyz"), push)

    def motion(**arguments):
        return emmy.Motion(body, steps=(1.0, 0.01), **arguments)

    alone = motion()
    alone.run()
    # One of them fails at once and again and again, while the others use the same body and function.
    motions = [motion() for _ in range(4)]
    failing = motion(max_iterations=1, smallest_step=0.01)
    meeting = threading.Barrier(5, timeout=60)
    failures = []

    def run(motion):
        meeting.wait()
        motion.run()

    def fail():
        meeting.wait()
        for _ in range(20):
            try:
                failing.run()
            except emmy.ConvergenceError as error:
                failures.append(error)

    threads = [threading.Thread(target=run, args=(own,)) for own in motions] + [threading.Thread(target=fail)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(failures) == 20 and failing.number == 0
    for own in motions:
        assert own.number == 100 and np.array_equal(own.displacement, alone.displacement)
        for name in set(alone.history.dtype.names) - {"wall_seconds"}:
            assert np.array_equal(own.history[name], alone.history[name], equal_nan=True), name


def test_a_motion_is_of_one_thread_at_a_time():
    motion = large_motion()
    thread = threading.Thread(target=lambda: motion.step(0.01))
    thread.start()
    raised = None
    while thread.is_alive() and raised is None:
        try:
            motion.displacement
        except RuntimeError as error:
            raised = error
    thread.join()
    assert raised is not None and "the motion is at work in another thread" in str(raised)
    assert motion.number == 1


def test_results_do_not_depend_on_the_number_of_threads():
    before = emmy.threads()
    try:
        results = []
        for number in (1, 2):
            emmy.set_threads(min(number, os.cpu_count()))
            assert emmy.threads() == min(number, os.cpu_count())
            motion = large_motion()
            motion.step(0.01)
            results.append(motion.displacement)
        assert np.array_equal(*results)
    finally:
        emmy.set_threads(before)


def test_threads_above_the_cores_are_capped():
    before, cores = emmy.threads(), len(os.sched_getaffinity(0))
    try:
        with pytest.warns(emmy.EmmyWarning, match=f"number: 65535 threads on {cores} cores; one thread a core is used"):
            emmy.set_threads(65535)
        assert emmy.threads() == cores
    finally:
        emmy.set_threads(before)
    # In a new process, since a pool that was made stays.
    code = "import emmy; print(emmy.threads())"
    environment = {**os.environ, "EMMY_NUM_THREADS": "65535"}
    shown = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert shown.stdout.split() == [str(cores)]


def tip():
    motion = spinning_block()
    motion.run()
    return motion.displacement


def test_every_thread_computes_after_the_number_has_changed():
    # The main thread belongs to its first pool for good; others share a pool, or have one each.
    before, here = emmy.threads(), tip()
    try:
        for number in (1, 2, 1, 2):
            emmy.set_threads(min(number, os.cpu_count()))
            found = [tip()]
            others = [threading.Thread(target=lambda: found.append(tip())) for _ in range(3)]
            for thread in others:
                thread.start()
            found.append(tip())
            for thread in others:
                thread.join(timeout=60)
            assert emmy.schemes() and len(found) == 5, number
            assert all(np.array_equal(there, here) for there in found)
    finally:
        emmy.set_threads(before)


METHODS = multiprocessing.get_all_start_methods()


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
@pytest.mark.parametrize("method", METHODS)
def test_processes(method):
    here = tip()
    with multiprocessing.get_context(method).Pool(2) as pool:
        for there in pool.starmap(tip, [(), ()]):
            assert np.array_equal(there, here)


def test_free_threading():
    if not hasattr(sys, "_is_gil_enabled"):
        pytest.skip("before Python 3.13")
    is_free = "t" in getattr(sys, "abiflags", "")
    assert sys._is_gil_enabled() is not is_free
