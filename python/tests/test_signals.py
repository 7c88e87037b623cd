"""Ctrl-C: the motion stands after a good step and can go on, and so can a run from its files."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
import traceback

import emmy
import numpy as np
import pytest

from bodies import rubber

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="sends signals to itself")

START = emmy.Initial(angular_velocity=(0.3, 0.5, 0.8))


def long_motion(until=1000.0):
    body = emmy.Body(emmy.Mesh.l_block(1.0), emmy.Region(rubber(), density=0.5))
    return emmy.Motion(body, steps=(until, 0.02), initial=START)


def interrupt_after(seconds):
    def send():
        time.sleep(seconds)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=send, daemon=True).start()


def test_run():
    motion = long_motion()
    interrupt_after(0.3)
    start = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        motion.run()
    assert time.perf_counter() - start < 5.0
    number = motion.number
    assert 0 < number < 50_000 and len(motion.history) == number + 1
    assert next(motion).number == number + 1


def test_loop():
    motion = long_motion()
    interrupt_after(0.3)
    seen = 0
    with pytest.raises(KeyboardInterrupt):
        for step in motion:
            seen = step.number
    assert motion.number in (seen, seen + 1)


def test_files_go_on_to_equal_bits():
    motion = long_motion()
    interrupt_after(0.5)
    with pytest.raises(KeyboardInterrupt):
        motion.run(output="out", every=0)
    run = emmy.Run("out")
    assert run.status == "interrupted"
    assert run.history["step"][-1] == motion.number
    until = motion.time + 1.0
    resumed = emmy.resume("out", until=until)
    motion.run(until=until)
    assert np.array_equal(resumed.history["total_energy"], motion.history["total_energy"])


def test_the_command_line_in_process():
    emmy.new("spinning-block")
    interrupt_after(0.5)
    with pytest.raises(KeyboardInterrupt):
        emmy.run("spinning-block.toml", until=5000.0, set={"output.every": 0}, output="out")
    assert emmy.Run("out").status == "interrupted"


def test_a_process_ends_by_its_signal():
    script = """
        import emmy
        body = emmy.Body(emmy.Mesh.l_block(1.0), emmy.Region(emmy.NeoHooke(lambda_=1000.0, mu=500.0), density=0.5))
        motion = emmy.Motion(body, steps=(1000.0, 0.02), initial=emmy.Initial(angular_velocity=(0, 0, 1)))
        print("ready", flush=True)
        motion.run()
    """
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(script)], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    with process:
        assert process.stdout.readline().strip() == b"ready"
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=20)
    assert b"KeyboardInterrupt" in errors and process.returncode != 0


def test_body_of_a_large_mesh():
    """Making a body is one piece of work: Ctrl-C is heard at its end, and the package goes on."""
    mesh = emmy.Mesh.box((1, 1, 1), (28, 28, 28))
    region = emmy.Region(rubber(), density=1.0)
    emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), region)
    start = time.perf_counter()
    emmy.Body(mesh, region)
    alone = time.perf_counter() - start
    # On a busy machine the signal may miss the body.
    for _ in range(10):
        interrupt_after(alone / 4)
        with pytest.raises(KeyboardInterrupt) as raised:
            emmy.Body(mesh, region)
            time.sleep(60)
        inner = traceback.extract_tb(raised.tb)
        if any(frame.filename == emmy.Body.__init__.__code__.co_filename for frame in inner):
            break
    else:
        pytest.fail("no signal came while a body was made")
    assert emmy.Body(mesh, region).n_dofs == 3 * 29**3


def test_making_a_large_mesh():
    # 3.4 million cells take seconds.
    interrupt_after(0.3)
    start = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        emmy.Mesh.box((1, 1, 1), (150, 150, 150))
    assert time.perf_counter() - start < 1.5
