"""Small decks with rigid elements, couplings, equations, masses and springs, for Abaqus and Nastran, and their modes in
CalculiX: `python3 decks.py` writes the decks and, where `ccx` is installed, `calculix.toml`."""

import itertools
import pathlib
import subprocess
import tempfile

HERE = pathlib.Path(__file__).parent
N_MODES = 6
CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]


class Model:
    """Blocks of hexahedra, held at x = 0, with what is attached to them."""

    def __init__(self):
        self.points, self.cells, self.inp, self.bdf = [], [], [], []

    def block(self, n, size, origin=(0.0, 0.0, 0.0), quadratic=False):
        """Adds a block with nodes of its own."""
        numbers = {}

        def node(key):
            if key not in numbers:
                numbers[key] = len(self.points) + 1
                self.points.append(tuple(origin[d] + size[d] * key[d] / (2 * n[d]) for d in range(3)))
            return numbers[key]

        for at in itertools.product(*map(range, n)):
            corners = [tuple(2 * at[d] + corner[d] for d in range(3)) for corner in CORNERS]
            middles = [tuple((corners[a][d] + corners[b][d]) // 2 for d in range(3)) for a, b in EDGES]
            self.cells.append([node(key) for key in corners + (middles if quadratic else [])])
        return self

    def point(self, place):
        """Adds a node without cells."""
        self.points.append(tuple(map(float, place)))
        return len(self.points)

    def at(self, **where):
        """Numbers of the nodes of cells with some coordinates."""
        used = sorted({node for cell in self.cells for node in cell})
        axes = {"x": 0, "y": 1, "z": 2}
        is_there = lambda node: all(abs(self.points[node - 1][axes[a]] - v) < 1e-9 for a, v in where.items())
        return [node for node in used if is_there(node)]

    # What is attached, in both formats.

    def set_of(self, name, nodes):
        self.inp += [f"*NSET, NSET={name}", *lines(nodes)]

    def rigid(self, name, nodes, reference, number):
        self.set_of(name, nodes)
        rotation = self.point(self.points[reference - 1])
        self.inp.append(f"*RIGID BODY, NSET={name}, REF NODE={reference}, ROT NODE={rotation}")
        self.bdf += card("RBE2", number, reference, 123456, *nodes)

    def kinematic(self, name, nodes, reference, number):
        self.set_of(name, nodes)
        self.inp += [f"*SURFACE, NAME={name}-S, TYPE=NODE", f"{name}",
                     f"*COUPLING, CONSTRAINT NAME={name}-C, REF NODE={reference}, SURFACE={name}-S", "*KINEMATIC", "1, 3"]
        self.bdf += card("RBE2", number, reference, 123, *nodes)

    def distributing(self, name, nodes, reference, number):
        self.inp += [f"*ELEMENT, TYPE=DCOUP3D, ELSET={name}", f"{number}, {reference}",
                     f"*DISTRIBUTING COUPLING, ELSET={name}", *(f"{node}, 1." for node in nodes)]
        self.bdf += card("RBE3", number, "", reference, 123, 1.0, 123, *nodes)

    def equation(self, node, others, number):
        """u of a node is the weighted sum of others."""
        for axis in (1, 2, 3):
            terms = [(node, axis, -1.0), *((other, axis, weight) for other, weight in others)]
            self.inp += ["*EQUATION", str(len(terms)), *(f"{n}, {d}, {w}" for n, d, w in terms)]
            self.bdf += card("MPC", number, *equation_fields(terms))

    def mass(self, name, nodes, mass, number):
        self.inp += [f"*ELEMENT, TYPE=MASS, ELSET={name}", *(f"{number + i}, {node}" for i, node in enumerate(nodes)),
                     f"*MASS, ELSET={name}", f"{mass}"]
        for i, node in enumerate(nodes):
            self.bdf += card("CONM2", number + i, node, "", mass)

    def grounded(self, name, nodes, stiffness, number):
        """Springs to the ground, alike in all directions."""
        for axis in (1, 2, 3):
            own = f"{name}{axis}"
            first = number + 100 * axis
            self.inp += [f"*ELEMENT, TYPE=SPRING1, ELSET={own}",
                         *(f"{first + i}, {node}" for i, node in enumerate(nodes)),
                         f"*SPRING, ELSET={own}", f"{axis}", f"{stiffness}"]
            for i, node in enumerate(nodes):
                self.bdf += card("CELAS2", first + i, stiffness, node, axis)

    def axial(self, name, pairs, stiffness, number):
        """Springs along x between pairs of nodes."""
        self.inp += [f"*ELEMENT, TYPE=SPRINGA, ELSET={name}",
                     *(f"{number + i}, {a}, {b}" for i, (a, b) in enumerate(pairs)),
                     f"*SPRING, ELSET={name}", "", f"{stiffness}"]
        for i, (a, b) in enumerate(pairs):
            self.bdf += card("CELAS2", number + i, stiffness, a, 1, b, 1)

    # The decks.

    def abaqus(self):
        kind = "C3D20" if len(self.cells[0]) == 20 else "C3D8"
        text = ["*HEADING", "Written by decks.py", "*NODE, NSET=ALL"]
        text += [f"{i}, {x:.12g}, {y:.12g}, {z:.12g}" for i, (x, y, z) in enumerate(self.points, 1)]
        text.append(f"*ELEMENT, TYPE={kind}, ELSET=BODY")
        for number, cell in enumerate(self.cells, 1):
            text += lines([number, *cell], more=True)
        text += ["*NSET, NSET=FIX", *lines(self.at(x=0)), *self.inp,
                 "*MATERIAL, NAME=SOLID", "*ELASTIC", "2000., 0.3", "*DENSITY", "1.5",
                 "*SOLID SECTION, ELSET=BODY, MATERIAL=SOLID", "*BOUNDARY", "FIX, 1, 3",
                 "*STEP", "*FREQUENCY", f"{N_MODES}", "*END STEP"]
        return "\n".join(text) + "\n"

    def nastran(self):
        text = ["$ Written by decks.py", "SOL 103", "CEND", "SPC = 1", "MPC = 4", "BEGIN BULK"]
        for i, (x, y, z) in enumerate(self.points, 1):
            text += card("GRID", i, "", float(x), float(y), float(z))
        for number, cell in enumerate(self.cells, 1):
            # Nastran has the edges along the third axis before those of the top.
            order = [*range(12), *range(16, 20), *range(12, 16)] if len(cell) == 20 else range(8)
            text += card("CHEXA", number, 1, *(cell[i] for i in order))
        text += card("SPC1", 1, 123, *self.at(x=0))
        text += [*self.bdf, *card("PSOLID", 1, 1), *card("MAT1", 1, 2000.0, "", 0.3, 1.5), "ENDDATA"]
        return "\n".join(text) + "\n"


def lines(numbers, more=False):
    """Numbers in lines of ten; `more`: a comma at the end announces the next line."""
    rows = [numbers[i : i + 10] for i in range(0, len(numbers), 10)]
    return [", ".join(map(str, row)) + ("," if more and row is not rows[-1] else "") for row in rows]


def card(name, *fields):
    """A card in small fields of eight columns."""

    def shown(field):
        if not isinstance(field, float):
            return str(field)
        text = f"{field:.6g}"
        return text if "." in text or "e" in text else text + "."

    texts = [shown(field) for field in fields]
    rows = [texts[i : i + 8] for i in range(0, len(texts), 8)] or [[]]
    heads = [name] + ["+"] * (len(rows) - 1)
    return [head.ljust(8) + "".join(text.ljust(8) for text in row).rstrip() for head, row in zip(heads, rows)]


def equation_fields(terms):
    """Fields of an MPC: two terms a line, whose first and last fields are blank from the second line on."""
    fields = []
    for i, term in enumerate(terms):
        fields += term
        if i % 2 == 1 and i + 1 < len(terms):
            fields += ["", ""]
    return fields


def beam(quadratic=False):
    return Model().block((3, 2, 2), (3.0, 1.0, 1.0), quadratic=quadratic)


def rigid_mass():
    model = beam()
    reference = model.point((3.0, 0.5, 0.5))
    model.rigid("END", model.at(x=3), reference, 901)
    model.mass("LUMP", [reference], 2.0, 902)
    return model


def kinematic_offset():
    model = beam()
    reference = model.point((4.0, 0.5, 0.8))
    model.kinematic("END", model.at(x=3), reference, 901)
    model.mass("LUMP", [reference], 2.0, 902)
    return model


def distributing_mass():
    model = beam()
    reference = model.point((3.0, 0.5, 0.5))
    model.distributing("END", model.at(x=3), reference, 901)
    model.mass("LUMP", [reference], 2.0, 902)
    return model


def equations():
    model = beam().block((2, 2, 2), (2.0, 1.0, 1.0), (3.0, 0.0, 0.0))
    ends = model.at(x=3)
    first, second = ends[: len(ends) // 2], ends[len(ends) // 2 :]
    for node in second:
        model.equation(node, [(next(n for n in first if model.points[n - 1] == model.points[node - 1]), 1.0)], 4)
    return model


def hanging_nodes():
    model = beam().block((2, 4, 2), (2.0, 1.0, 1.0), (3.0, 0.0, 0.0))
    ends = model.at(x=3)
    first = {model.points[n - 1]: n for n in ends[:9]}
    for node in ends[9:]:
        x, y, z = model.points[node - 1]
        if (x, y, z) in first:
            model.equation(node, [(first[(x, y, z)], 1.0)], 4)
        else:
            model.equation(node, [(first[(x, y - 0.25, z)], 0.5), (first[(x, y + 0.25, z)], 0.5)], 4)
    return model


def masses():
    model = beam()
    model.mass("LUMPS", model.at(x=3, z=1), 0.4, 901)
    return model


def grounded_springs():
    model = beam()
    model.grounded("BED", model.at(x=3, y=1), 30.0, 1000)
    return model


def axial_springs():
    model = beam().block((1, 2, 2), (1.0, 1.0, 1.0), (4.0, 0.0, 0.0))
    model.grounded("BED", model.at(x=5), 20.0, 1000)
    pairs = zip(model.at(x=3), model.at(x=4))
    model.axial("RODS", list(pairs), 50.0, 901)
    return model


def rigid_cells():
    model = beam()
    nodes = model.at(x=2) + model.at(x=3)
    reference = model.point((2.5, 0.5, 0.5))
    model.rigid("HALF", nodes, reference, 901)
    model.mass("LUMP", [reference], 1.0, 902)
    return model


def quadratic_all():
    model = beam(quadratic=True)
    reference = model.point((3.0, 0.5, 0.5))
    model.rigid("END", model.at(x=3), reference, 901)
    model.mass("LUMP", [reference], 2.0, 902)
    model.grounded("BED", model.at(x=2, y=1, z=1), 30.0, 1000)
    model.mass("LUMPS", model.at(x=1, y=0, z=0), 0.5, 950)
    return model


MODELS = [rigid_mass, kinematic_offset, distributing_mass, equations, hanging_nodes, masses, grounded_springs,
          axial_springs, rigid_cells, quadratic_all]


def frequencies(text):
    """Natural frequencies by CalculiX."""
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "deck.inp").write_text(text)
        done = subprocess.run(["ccx", "deck"], cwd=folder, capture_output=True, text=True, check=False)
        if "*ERROR" in done.stdout:
            raise SystemExit(done.stdout)
        rows = [line.split() for line in (pathlib.Path(folder) / "deck.dat").read_text().splitlines()]
        return [float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()][:N_MODES]


def main():
    found = ["# Natural frequencies of the decks in this folder by CalculiX 2.20, written by decks.py."]
    for make in MODELS:
        name = make.__name__.replace("_", "-")
        model = make()
        (HERE / f"{name}.inp").write_text(model.abaqus())
        (HERE / f"{name}.bdf").write_text(model.nastran())
        found.append(f"{name} = {frequencies(model.abaqus())}")
        print(found[-1])
    (HERE / "calculix.toml").write_text("\n".join(found) + "\n")


if __name__ == "__main__":
    main()
