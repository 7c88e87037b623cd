"""The block in Emmy: `emmy_block.py r [binary]`.

Emmy prints one line a step; the CPU clock of its process is read at each.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import block

ROOT = pathlib.Path(__file__).resolve().parents[2]


def cpu_clock(pid):
    """Clock of the CPU time of another process: Linux's clock_getcpuclockid(3)."""
    return (~pid << 3) | 2


def main(r, binary=ROOT / "target/release/emmy"):
    """Run Emmy with one thread and report."""
    with tempfile.TemporaryDirectory() as directory:
        command = [binary, "run", ROOT / "benches/spinning-block.toml", "--threads", "1",
                   "--set", f"mesh.l-block.cell_size={1 / r!r}",
                   "--output", f"{directory}/run", "--json", "--quiet"]
        times, rows = [], []
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as emmy:
            clock = cpu_clock(emmy.pid)
            for line in emmy.stdout:
                row = json.loads(line)
                if "step" not in row:
                    summary = row
                    break
                times.append(time.clock_gettime(clock))
                if len(times) == block.STEPS:  # one step to go: the process still lives
                    megabytes = block.peak_megabytes(emmy.pid)
                rows.append(row)
        if emmy.returncode:
            sys.exit(emmy.returncode)
    last = rows[-1]
    seconds = [after - before for before, after in zip(times, times[1:])]
    block.report(
        f"Emmy {summary['version']}", "own", r, summary["dofs"], seconds,
        [row["newton_iterations"] for row in rows[1:]],
        (last["kinetic_energy"], last["strain_energy"]),
        [last[f"tip_{axis}"] for axis in "xyz"], megabytes)


if __name__ == "__main__":
    main(int(sys.argv[1]), *sys.argv[2:])
