"""Cost of Python in a step of the block of 672 degrees of freedom: a loop, a loop that reads the displacement, an observer;
and of a function as the history or the field of a load.

    python python/benches/overhead.py [THREADS]

Each way does the same steps in turn, in CPU time of the process, on one thread or more. `run` marches in slices inside of
Rust and is the measure of the others: the median of the ratios of all rounds counts, because a machine may be faster in
some of them. Exit code 1 if a way costs more than 5 % more.
"""

import math
import statistics
import sys
import time
from collections.abc import Callable

import emmy
import numpy as np

STEPS = 100
ROUNDS = 60
GOAL = 1.05


def motion(load: emmy.Load | tuple[()] = ()) -> emmy.Motion:
    """A soft block in free flight: cheap steps, in which the costs of Python weigh most."""
    region = emmy.Region(emmy.NeoHooke(lambda_=1000.0, mu=500.0), density=0.5)
    body = emmy.Body(emmy.Mesh.l_block(cell_size=1.0), region, loads=load)
    initial = emmy.Initial(angular_velocity=(0.3, 0.5, 0.8))
    return emmy.Motion(body, steps=(STEPS * 0.01, 0.01), initial=initial)


def run(own: emmy.Motion) -> None:
    """In slices."""
    own.run()


def loop(own: emmy.Motion) -> None:
    """Step by step."""
    for _ in own:
        pass


def loop_with_displacement(own: emmy.Motion) -> None:
    """Step by step, with a copy of the displacement."""
    largest = 0.0
    for _ in own:
        largest = max(largest, own.displacement[0, 0])


def observed(own: emmy.Motion) -> None:
    """With an observer."""
    own.run(observers=[lambda step, motion: step.time < 0.0])


def cpu_seconds(way: Callable[[emmy.Motion], None], load: emmy.Load | tuple[()] = ()) -> float:
    """CPU time of all steps."""
    own = motion(load)
    start = time.process_time()
    way(own)
    return time.process_time() - start


def functions() -> dict[str, emmy.Load]:
    """One small load, given in four ways."""
    return {
        "expression": emmy.Load("face-a", traction=(0, 0, 1e-3), history="sin(t)"),
        "function of the time": emmy.Load("face-a", traction=(0, 0, 1e-3), history=math.sin),
        "expression in space": emmy.Load(body_force=(0, 0, "1e-3*sin(t)")),
        "function of points": emmy.Load(body_force=lambda points, t: 1e-3 * math.sin(t) * np.eye(3)[2] + 0 * points),
    }


def cost_of_functions() -> None:
    """Prints what functions cost beside expressions."""
    seconds: dict[str, list[float]] = {name: [] for name in functions()}
    for _ in range(ROUNDS):
        for name, load in functions().items():
            seconds[name].append(cpu_seconds(run, load))
    times = iter(seconds.items())
    for (_, expression), (name, function) in zip(times, times, strict=True):
        cost = statistics.median(f - e for f, e in zip(function, expression, strict=True))
        print(f"{name:24} {1e6 * cost / STEPS:8.1f} us a step more than an expression")


def main() -> int:
    """Prints a line for each way."""
    emmy.set_threads(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
    ways = [run, loop, loop_with_displacement, observed]
    seconds: dict[Callable[[emmy.Motion], None], list[float]] = {way: [] for way in ways}
    for _ in range(ROUNDS):
        for way in ways:
            seconds[way].append(cpu_seconds(way))
    is_reached = True
    for way, own in seconds.items():
        ratio = statistics.median(t / measure for t, measure in zip(own, seconds[run], strict=True))
        is_reached &= ratio <= GOAL
        print(f"{way.__name__:24} {1e6 * statistics.median(own) / STEPS:8.1f} us a step  {ratio:.3f} of run")
    cost_of_functions()
    print(f"goal: at most {GOAL} of run: {'reached' if is_reached else 'missed'}")
    return 0 if is_reached else 1


if __name__ == "__main__":
    sys.exit(main())
