"""The block in CalculiX (the program `ccx`): `calculix_block.py R [SOLVER] [--cells KIND] ...`.

The equations are CalculiX's own: St. Venant-Kirchhoff material (`*ELASTIC` with NLGEOM) and the
trapezoidal rule (`*DYNAMIC` with ALPHA = 0, Newmark's method with beta 1/4 and gamma 1/2). With
`--mesh` a clamped bracket, not the block.
"""
import argparse
import math
import pathlib
import re
import resource
import subprocess
import tempfile

import block

SOLVERS = {"spooles": "SPOOLES", "scaling": "ITERATIVE SCALING", "cholesky": "ITERATIVE CHOLESKY"}
# CalculiX's name of a cell, and the corners between which its other nodes lie.
BOTTOM, TOP, SIDES = ([(0, 1), (1, 2), (2, 3), (0, 3)], [(4, 5), (5, 6), (6, 7), (4, 7)],
                      [(0, 4), (1, 5), (2, 6), (3, 7)])
KINDS = {"hex8": ("C3D8", []), "hex20": ("C3D20", BOTTOM + TOP + SIDES),
         "tet10": ("C3D10", [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)])}
# The foot of the bracket (z = 0) is clamped, a force (0, 0, -F) is spread over its tip (x = 60).
TIP = 60.0
PULSE = (0.0, 0.0), (5e-4, 1.0), (1e-3, 0.0)


def arguments():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("r", type=int, help="cells a unit length of the block")
    parser.add_argument("solver", nargs="?", default="spooles", choices=SOLVERS)
    parser.add_argument("--cells", default="hex8", choices=KINDS)
    parser.add_argument("--mesh", help="Gmsh file of a bracket of tet10")
    parser.add_argument("--force", type=float, default=0.0, help="largest force on its tip")
    parser.add_argument("--moduli", type=float, nargs=2, default=(block.LAMBDA, block.MU),
                        metavar=("LAMBDA", "MU"))
    parser.add_argument("--density", type=float, default=block.DENSITY)
    parser.add_argument("--step-size", type=float, default=block.STEP_SIZE)
    parser.add_argument("--steps", type=int, default=block.STEPS)
    parser.add_argument("--tolerance", type=float, default=1e-8,
                        help="of Newton, relative to the mean force")
    return parser.parse_args()


def body(wanted):
    """Points and cells, with the nodes of quadratic cells in the middle of straight edges."""
    if wanted.mesh:
        points, cells = block.gmsh_tetrahedra(wanted.mesh)
    else:
        points, cells = block.mesh(wanted.r)
        cells = block.tetrahedra(cells) if wanted.cells == "tet10" else cells
    points, numbers = list(points), {}
    if wanted.cells == "tet10":
        cells = [cell if volume(points, cell) > 0 else [cell[i] for i in (0, 2, 1, 3)]
                 for cell in cells]
    for cell in cells:
        for a, b in KINDS[wanted.cells][1]:
            edge = tuple(sorted((cell[a], cell[b])))
            if edge not in numbers:
                numbers[edge] = len(points)
                points.append(tuple((x + y) / 2 for x, y in zip(points[edge[0]], points[edge[1]])))
    middles = KINDS[wanted.cells][1]
    return points, [list(cell) + [numbers[tuple(sorted((cell[a], cell[b])))] for a, b in middles]
                    for cell in cells]


def volume(points, cell):
    """Six times the volume of a tetrahedron."""
    (a, b, c), (d, e, f), (g, h, i) = ([x - y for x, y in zip(points[node], points[cell[0]])]
                                       for node in cell[1:4])
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def tip_shares(points, cells):
    """Share of each node in a force spread over the tip: a third of a triangle for each middle."""
    shares, total = {}, 0.0
    for cell in cells:
        corners = [node for node in cell[:4] if abs(points[node][0] - TIP) < 1e-6]
        if len(corners) < 3:
            continue
        (y, z), (p, q) = ([points[corners[i]][d] - points[corners[0]][d] for d in (1, 2)]
                          for i in (1, 2))
        area = abs(y * q - z * p) / 2
        total += area
        for node in cell[4:]:
            if abs(points[node][0] - TIP) < 1e-6:
                shares[node] = shares.get(node, 0.0) + area / 3
    return {node: share / total for node, share in shares.items()}


def lines(wanted, points, cells, steps):
    """The input of CalculiX, whose numbers have at most 20 characters."""
    lam, mu = wanted.moduli
    h = wanted.step_size
    yield "*NODE, NSET=ALL"
    yield from ("%d, %.12g, %.12g, %.12g" % (i, *point) for i, point in enumerate(points, 1))
    yield f"*ELEMENT, TYPE={KINDS[wanted.cells][0]}, ELSET=BODY"
    for i, cell in enumerate(cells, 1):
        words = [str(i)] + [str(node + 1) for node in cell]
        yield from (", ".join(words[:16]) + ("," if words[16:] else ""), ", ".join(words[16:]))
    youngs, poissons = mu * (3 * lam + 2 * mu) / (lam + mu), lam / (2 * (lam + mu))
    yield f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{youngs:.12g}, {poissons:.12g}"
    yield f"*DENSITY\n{wanted.density:.12g}\n*SOLID SECTION, ELSET=BODY, MATERIAL=SOLID"
    if wanted.mesh:
        yield "*BOUNDARY"
        yield from (f"{i}, 1, 3" for i, point in enumerate(points, 1) if abs(point[2]) < 1e-6)
        yield "*AMPLITUDE, NAME=PULSE"
        yield ", ".join("%g, %g" % entry for entry in PULSE)
    else:
        yield "*INITIAL CONDITIONS, TYPE=VELOCITY"
        for i, point in enumerate(points, 1):
            yield from ("%d, %d, %.12g" % (i, d, v)
                        for d, v in enumerate(block.velocity(*point), 1))
    yield f"*STEP, NLGEOM, INC={steps + 1}"
    yield f"*DYNAMIC, DIRECT, ALPHA=0., SOLVER={SOLVERS[wanted.solver]}"
    yield f"{h:.12g}, {h * steps:.12g}"
    yield f"*CONTROLS, PARAMETERS=FIELD\n{wanted.tolerance:g}, {wanted.tolerance:g},,,,,,,"
    if wanted.mesh:
        yield "*CLOAD, AMPLITUDE=PULSE"
        yield from ("%d, 3, %.12g" % (node + 1, -wanted.force * share)
                    for node, share in tip_shares(points, cells).items())
    yield f"*EL PRINT, ELSET=BODY, TOTALS=ONLY, FREQUENCY={steps}\nELSE, ELKE"
    yield f"*NODE PRINT, NSET=ALL, FREQUENCY={steps}\nU\n*END STEP"


def run(wanted, points, cells, steps):
    """CPU time of a run, iterations of its steps, and its results as text."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        text = "\n".join(line for line in lines(wanted, points, cells, steps) if line)
        (folder / "block.inp").write_text(text + "\n", encoding="ascii")
        before = cpu_of_children()
        done = subprocess.run(["ccx", "block"], cwd=folder, capture_output=True, text=True,
                              check=False)
        seconds = cpu_of_children() - before
        increments = (folder / "block.sta").read_text(encoding="ascii").splitlines()[2:]
        # The attempt of an increment that did not converge ends with a U.
        converged = [line for line in increments if line.split()[2].isdigit()]
        assert len(converged) == steps, done.stdout[-2000:]
        return (seconds, [int(line.split()[3]) for line in increments],
                (folder / "block.dat").read_text(encoding="ascii"))


def cpu_of_children():
    """CPU time of all processes that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def energy(results, kind):
    """A total energy in the printed results, which have seven digits."""
    return float(re.search(rf"total {kind} energy.*\n\n\s*(\S+)", results)[1])


def main(wanted):
    """Run the block and report. CalculiX prints no times: those of two steps are subtracted."""
    points, cells = body(wanted)
    start, _, _ = run(wanted, points, cells, 2)
    total, iterations, results = run(wanted, points, cells, wanted.steps)
    seconds = [start / 2] * 2 + [(total - start) / (wanted.steps - 2)] * (wanted.steps - 2)
    tip = None
    if not wanted.mesh:
        node = points.index(block.TIP) + 1
        moved = re.search(rf"^ +{node} +(\S+) +(\S+) +(\S+)", results, re.MULTILINE)
        tip = [x + float(u) for x, u in zip(block.TIP, moved.groups())]
    version = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout
    energies = [energy(results, kind) for kind in ("kinetic", "internal")]
    assert all(math.isfinite(value) for value in energies)
    unchanged = wanted.moduli == (block.LAMBDA, block.MU) and wanted.cells == "hex8"
    block.report(f"CalculiX {version.split()[-1]}", wanted.solver,
                 wanted.r if unchanged and wanted.steps == block.STEPS else None, len(cells),
                 3 * len(points), seconds, iterations, energies, tip, None, same=False,
                 total=total, peak=resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024)


if __name__ == "__main__":
    main(arguments())
