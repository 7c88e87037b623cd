"""Threads and processes."""

import multiprocessing
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
    alone = spinning_block()
    alone.run()
    motions = [spinning_block() for _ in range(4)]
    threads = [threading.Thread(target=motion.run) for motion in motions]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for motion in motions:
        assert np.array_equal(motion.displacement, alone.displacement)


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
            emmy.set_threads(number)
            assert emmy.threads() == number
            motion = large_motion()
            motion.step(0.01)
            results.append(motion.displacement)
        assert np.array_equal(*results)
    finally:
        emmy.set_threads(before)


def tip():
    motion = spinning_block()
    motion.run()
    return motion.displacement


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
