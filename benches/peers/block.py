"""The work that every program here does, and the one line that each prints.

An L-shaped block of neo-Hooke material flies freely: 20 steps of the mid-point rule.
Nothing but the standard library is needed.
"""
import itertools
import json
import math
import pathlib
import statistics
import time

LAMBDA, MU, DENSITY = 1000.0, 500.0, 0.5
STEP_SIZE, STEPS = 0.02, 20
RELATIVE, ABSOLUTE = 1e-10, 1e-9  # Newton: of the first residual; at least
INNER = 1e-4  # relative tolerance of the iterative solvers
TIP = (0.0, 10.0, 0.0)

# Kinetic and strain energy at the end by r; all programs agree in these digits.
ENERGIES = json.loads(pathlib.Path(__file__).with_name("energies.json").read_text())
# Corners of a cell in the order of VTK.
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0),
           (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


def mesh(r):
    """Points, and hexahedra of edge 1/r: [0,3]x[0,10]x[0,3] and [3,6]x[0,3]x[0,3]."""
    numbers, cells = {}, []
    for first, last, height in (0, 3, 10), (3, 6, 3):
        for i in range(first * r, last * r):
            for j in range(height * r):
                for k in range(3 * r):
                    cells.append([numbers.setdefault((i + a, j + b, k + c), len(numbers))
                                  for a, b, c in CORNERS])
    return [(i / r, j / r, k / r) for i, j, k in numbers], cells


def tetrahedra(cells):
    """Six tetrahedra in the place of each hexahedron, along its diagonal from corner 0 to corner 6."""
    paths = [[0, 1 << a, (1 << a) + (1 << b), 7] for a, b, _ in itertools.permutations(range(3))]
    corner = {sum(bit << d for d, bit in enumerate(place)): i for i, place in enumerate(CORNERS)}
    return [[cell[corner[place]] for place in path] for cell in cells for path in paths]


def gmsh_tetrahedra(path):
    """Points and corners of the quadratic tetrahedra of a Gmsh file (text, version 4.1)."""
    lines = pathlib.Path(path).read_text(encoding="ascii").splitlines()
    points, cells = {}, []
    line = lines.index("$Nodes") + 2
    while lines[line] != "$EndNodes":
        count = int(lines[line].split()[3])
        names = lines[line + 1:line + 1 + count]
        places = lines[line + 1 + count:line + 1 + 2 * count]
        points.update((int(name), [float(x) for x in place.split()])
                      for name, place in zip(names, places))
        line += 1 + 2 * count
    line = lines.index("$Elements") + 2
    while lines[line] != "$EndElements":
        _, _, kind, count = map(int, lines[line].split())
        if kind == 11:
            cells += [[int(word) for word in cell.split()[1:5]]
                      for cell in lines[line + 1:line + 1 + count]]
        line += 1 + count
    numbers = {name: i for i, name in enumerate(sorted({name for cell in cells for name in cell}))}
    return [points[name] for name in numbers], [[numbers[name] for name in cell] for cell in cells]


def velocity(x, y, z):
    """v(X) = (0.3, 0.5, 0.8) x X + diag(0.2, -0.1, 0.02) X."""
    return (0.2 * x - 0.8 * y + 0.5 * z,
            0.8 * x - 0.1 * y - 0.3 * z,
            -0.5 * x + 0.3 * y + 0.02 * z)


def converged(residual, first, relative=RELATIVE):
    """Whether Newton's iteration may stop."""
    return residual <= max(relative * first, ABSOLUTE)


def assembly_rate(cells, assemble, times=5):
    """Cells a second in the assembly of residual and tangent, by CPU time."""
    seconds = []
    for _ in range(times):
        start = time.process_time()
        assemble()
        seconds.append(time.process_time() - start)
    return cells / statistics.median(seconds)


def peak_megabytes():
    """Largest resident memory of this process (Linux)."""
    with open("/proc/self/status", encoding="ascii") as status:
        kilobytes = next(line.split()[1] for line in status if line.startswith("VmHWM"))
    return int(kilobytes) / 1024


def report(program, solver, r, cells, dofs, seconds, iterations, energies, tip, rate, same=True,
           total=None, peak=None):
    """Print the results as one line of JSON; fail if the energies are not those of the table.

    `seconds` and `iterations` have one entry a step. The first two steps, with what is done only
    once, are left out of the times; `total` is the time of the whole run, `peak` the memory if
    another process did the work. `r` is None for another motion than the one of the table. `same`:
    whether material and scheme are those of the others; if not, the total energy only is compared,
    roughly.
    """
    later = seconds[2:] or seconds
    line = {
        "program": program,
        "solver": solver,
        "r": r,
        "cells": cells,
        "dofs": dofs,
        "threads": 1,
        "cpu_seconds_per_step": round(statistics.median(later), 6),
        "cpu_seconds_per_step_mean": round(statistics.fmean(later), 6),
        "cpu_seconds": round(sum(seconds), 6),
        "cpu_seconds_with_start": total and round(total, 6),
        "newton_per_step": statistics.fmean(iterations),
        "assembled_cells_per_second": rate and round(rate),
        "kinetic_energy": float(energies[0]),
        "strain_energy": float(energies[1]),
        "tip": None if tip is None else [float(x) for x in tip],
        "peak_megabytes": round(peak or peak_megabytes(), 1),
    }
    print(json.dumps(line), flush=True)
    expected = ENERGIES.get(str(r), energies)
    pairs = zip(energies, expected) if same else [(sum(energies), sum(expected))]
    for value, right in pairs:
        assert math.isclose(value, right, rel_tol=1e-8 if same else 1e-3), f"{value} is not {right}"
