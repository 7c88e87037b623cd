"""Run the block in every program that is installed, turn about, and print a table.

Each run has one thread on one core. A ratio is CPU time to that of Emmy in the same round.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
TIMES = ("cpu_seconds_per_step", "cpu_seconds_per_step_mean")


def arguments():
    """Options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("r", type=int, help="cells per unit length; 1, 2 and 4 are checked")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--core", type=int, default=0, help="core that everything runs on")
    parser.add_argument("--emmy", default=HERE.parents[1] / "target/release/emmy")
    parser.add_argument("--dolfinx-python", default="/usr/bin/python3")
    parser.add_argument("--felupe-python", default=sys.executable)
    parser.add_argument("--skip-direct", action="store_true", help="leave out LU factorisations")
    return parser.parse_args()


def programs(options):
    """Commands of what is installed; a line about what is not."""
    if not pathlib.Path(options.emmy).is_file():
        sys.exit(f"{options.emmy} is not there: cargo build --release")
    r = str(options.r)
    commands = [[sys.executable, HERE / "emmy_block.py", r, options.emmy]]
    others = (("dolfinx", options.dolfinx_python, ("cg", "lu")),
              ("felupe", options.felupe_python, ("cg", "superlu")))
    for module, python, solvers in others:
        if not installed(module, python):
            print(f"skipped: {module} is not installed for {python} (--{module}-python)")
            continue
        chosen = solvers[:1] if options.skip_direct else solvers
        commands += [[python, HERE / f"{module}_block.py", r, solver] for solver in chosen]
    return commands


def installed(module, python):
    """Whether an interpreter is there and can import a module."""
    try:
        trial = subprocess.run([python, "-c", f"import {module}"], capture_output=True)
    except OSError:
        return False
    return trial.returncode == 0


def result(command, core):
    """What one run prints."""
    environment = os.environ | dict.fromkeys(THREADS, "1")
    pinned = ["taskset", "-c", str(core), *command]
    run = subprocess.run(pinned, env=environment, capture_output=True, text=True)
    if run.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{run.stdout}{run.stderr}")
    return json.loads(run.stdout.splitlines()[-1])


def main():
    """Run and print."""
    options = arguments()
    commands = programs(options)
    rounds = [[result(command, options.core) for command in commands]
              for _ in range(options.rounds)]
    print(f"r = {options.r}, {rounds[0][0]['dofs']} dofs, {options.rounds} rounds, "
          "CPU seconds per step, medians of the rounds\n")
    print("| program | solver | median step | mean step | mean / Emmy's | Newton | peak MB |")
    print("|---|---|--:|--:|--:|--:|--:|")
    for runs in zip(*rounds):
        typical, mean = (statistics.median(run[time] for run in runs) for time in TIMES)
        ratio = statistics.median(
            run[TIMES[1]] / first[0][TIMES[1]] for run, first in zip(runs, rounds))
        last = runs[-1]
        print(f"| {last['program']} | {last['solver']} | {typical:.4f} | {mean:.4f} | {ratio:.2f} "
              f"| {last['newton_per_step']:.2f} | {last['peak_megabytes']} |")


if __name__ == "__main__":
    main()
