"""Small bodies of every kind of cell with groups, and their volumes, without Emmy.

Nodes are in the order of VTK. Bodies are made of bricks whose nodes are then moved by a smooth map: the edges of
quadratic cells are curved.
"""

import dataclasses
import itertools

import numpy as np

# Edges and faces of the linear cells in the order of VTK, by their corners; outward normals.
QUAD_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0)]
SHAPES = {
    "line": ([(0, 1)], []),
    "triangle": ([(0, 1), (1, 2), (2, 0)], []),
    "quadrilateral": (QUAD_EDGES, []),
    "tetrahedron": (
        [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
        [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)],
    ),
    "hexahedron": (
        QUAD_EDGES + [(4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)],
        # In the order of the centres of faces of a cell with 27 nodes.
        [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (2, 3, 7, 6), (0, 3, 2, 1), (4, 5, 6, 7)],
    ),
    "wedge": (
        [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
        [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    ),
    "pyramid": (
        QUAD_EDGES + [(0, 4), (1, 4), (2, 4), (3, 4)],
        [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    ),
}
CORNERS = {"line": 2, "triangle": 3, "quadrilateral": 4, "tetrahedron": 4, "hexahedron": 8, "wedge": 6, "pyramid": 5}

# Name: shape, number of nodes, dimension.
KINDS = {
    "vertex": (None, 1, 0),
    "line2": ("line", 2, 1),
    "line3": ("line", 3, 1),
    "tri3": ("triangle", 3, 2),
    "tri6": ("triangle", 6, 2),
    "quad4": ("quadrilateral", 4, 2),
    "quad8": ("quadrilateral", 8, 2),
    "quad9": ("quadrilateral", 9, 2),
    "tet4": ("tetrahedron", 4, 3),
    "tet10": ("tetrahedron", 10, 3),
    "hex8": ("hexahedron", 8, 3),
    "hex20": ("hexahedron", 20, 3),
    "hex27": ("hexahedron", 27, 3),
    "wedge6": ("wedge", 6, 3),
    "wedge15": ("wedge", 15, 3),
    "pyramid5": ("pyramid", 5, 3),
    "pyramid13": ("pyramid", 13, 3),
}
# Corners of the reference cells.
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
CORNER_PLACES = {
    "line": [(0, 0, 0), (1, 0, 0)],
    "triangle": [(0, 0, 0), (1, 0, 0), (0, 1, 0)],
    "quadrilateral": [(x, y, 0) for x, y in SQUARE],
    "tetrahedron": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    "hexahedron": [(x, y, z) for z in (0, 1) for x, y in SQUARE],
    "wedge": [(x, y, z) for z in (0, 1) for x, y in [(0, 0), (1, 0), (0, 1)]],
    "pyramid": [(x, y, 0) for x, y in SQUARE] + [(0.5, 0.5, 1)],
}


def places(kind, corners):
    """Places of all nodes of a cell with straight edges, from those of its corners."""
    shape, n_nodes, _ = KINDS[kind]
    corners = np.asarray(corners, dtype=float)
    if shape is None or n_nodes == len(corners):
        return corners
    edges, faces = SHAPES[shape]
    rows = [*corners, *(corners[list(edge)].mean(axis=0) for edge in edges)]
    if kind == "quad9":
        rows.append(corners.mean(axis=0))
    if kind == "hex27":
        rows += [*(corners[list(face)].mean(axis=0) for face in faces), corners.mean(axis=0)]
    return np.array(rows)


def facets(kind):
    """Kind and local nodes of each facet of a cell: faces, or edges of a plane cell."""
    shape, n_nodes, dimension = KINDS[kind]
    edges, faces = SHAPES[shape]
    n_corners = CORNERS[shape]
    middle = {frozenset(edge): n_corners + i for i, edge in enumerate(edges)}
    is_quadratic = n_nodes > n_corners
    if dimension == 2:
        return [("line3", (*edge, middle[frozenset(edge)])) if is_quadratic else ("line2", edge) for edge in edges]
    rows = []
    for number, face in enumerate(faces):
        nodes = list(face)
        if is_quadratic:
            nodes += [middle[frozenset((a, b))] for a, b in zip(face, face[1:] + face[:1], strict=True)]
        if kind == "hex27":
            nodes.append(20 + number)
        name = "tri" if len(face) == 3 else "quad"
        rows.append((f"{name}{len(nodes)}", tuple(nodes)))
    return rows


@dataclasses.dataclass
class Body:
    """A mesh with groups; the cells are counted over all blocks."""

    name: str
    points: np.ndarray
    blocks: list
    cell_groups: dict
    facet_groups: dict  # name: [(kind, nodes)]
    line_groups: dict  # name: [(kind, nodes)], edges of a solid body
    node_groups: dict  # name: [node]
    turned: bool = False  # whether cells are numbered the other way round

    @property
    def cells(self):
        """Kind and nodes of each cell."""
        return [(kind, tuple(row)) for kind, rows in self.blocks for row in rows.tolist()]

    @property
    def dimension(self):
        return max(KINDS[kind][2] for kind, _ in self.blocks)

    @property
    def kinds(self):
        return {kind for kind, _ in self.blocks}


def build(name, cells, bend=0.08):
    """A body of cells, given by the reference places of their corners."""
    index, blocks = {}, {}
    for kind, corners in cells:
        rows = [tuple(place) for place in np.round(places(kind, corners), 9).tolist()]
        blocks.setdefault(kind, []).append([index.setdefault(place, len(index)) for place in rows])
    flat = np.array(list(index))
    is_plane = all(KINDS[kind][2] == 2 for kind, _ in cells)
    x, y, z = flat.T
    shift = np.column_stack([np.sin(1.3 * y + 0.7 * z), np.sin(1.1 * x + 0.9 * z + 0.4), np.sin(0.8 * x + 1.2 * y + 0.2)])
    if is_plane:
        shift[:, 2] = 0
    points = np.column_stack([1.1 * x, 0.9 * y, 1.2 * z]) + bend * shift
    if is_plane:
        points[:, 2] = 0
    blocks = [(kind, np.array(rows)) for kind, rows in blocks.items()]
    body = Body(name, points, blocks, {}, {}, {}, {})
    add_groups(body, flat)
    return body


def add_groups(body, flat):
    """Groups of each kind of members: by halves, at the bottom, at an edge, at a corner."""
    cells = body.cells
    centres = np.array([flat[list(nodes)].mean(axis=0) for _, nodes in cells])
    order = np.argsort(centres[:, 0], kind="stable")
    half = max(1, len(cells) // 2)
    body.cell_groups = {"left": sorted(order[:half].tolist()), "some": sorted(order[: half + len(cells) // 4].tolist())}
    if len(cells) > 1:
        body.cell_groups["right part"] = sorted(order[half:].tolist())
    axis = 1 if body.dimension == 2 else 2
    faces = {}
    for kind, nodes in cells:
        for facet_kind, local in facets(kind) if body.dimension > 1 else []:
            own = tuple(nodes[i] for i in local)
            if np.all(flat[list(own), axis] == 0):
                faces[frozenset(own)] = (facet_kind, own)
    if faces:
        body.facet_groups = {"base": list(faces.values())}
    lines = {}
    for kind, nodes in cells if body.dimension == 3 else []:
        shape, n_nodes, _ = KINDS[kind]
        n_corners = CORNERS[shape]
        for i, edge in enumerate(SHAPES[shape][0]):
            own = tuple(nodes[j] for j in edge) + ((nodes[n_corners + i],) if n_nodes > n_corners else ())
            if np.all(flat[list(own), 1:] == 0):
                lines[frozenset(own)] = ("line3" if len(own) == 3 else "line2", own)
    if lines:
        body.line_groups = {"rim": list(lines.values())}
    body.node_groups = {"tip": [int(np.argmax(flat @ [1.0, 2.0, 3.0]))]}


def bricks(n):
    """Corners of the bricks of a grid, in the order of VTK."""
    for z, y, x in itertools.product(*(range(count) for count in reversed(n))):
        yield [(x + a, y + b, z + c) for a, b, c in CORNER_PLACES["hexahedron"]]


def split(kind, corners):
    """A brick as cells of a kind."""
    shape = KINDS[kind][0]
    c = corners
    if shape == "hexahedron":
        return [(kind, c)]
    if shape == "wedge":
        return [(kind, [c[i] for i in own]) for own in [(0, 1, 3, 4, 5, 7), (1, 2, 3, 5, 6, 7)]]
    if shape == "pyramid":
        centre = tuple(np.mean(c, axis=0))
        # The faces, seen from inside.
        return [(kind, [*(c[i] for i in reversed(face)), centre]) for face in SHAPES["hexahedron"][1]]
    paths = [(1, 2), (1, 5), (3, 2), (3, 7), (4, 5), (4, 7)]
    cells = [[c[0], c[a], c[b], c[6]] for a, b in paths]
    return [(kind, own if det(own) > 0 else [own[0], own[2], own[1], own[3]]) for own in cells]


def det(corners):
    a, b, c, d = np.asarray(corners, dtype=float)
    return float(np.linalg.det([b - a, c - a, d - a]))


def plane(kind, n):
    for y, x in itertools.product(range(n[1]), range(n[0])):
        c = [(x + a, y + b, 0) for a, b in SQUARE]
        if KINDS[kind][0] == "quadrilateral":
            yield kind, c
        else:
            yield from [(kind, [c[0], c[1], c[2]]), (kind, [c[0], c[2], c[3]])]


def mixed(kinds):
    """A brick, a wedge beside it, a pyramid on it and a tetrahedron on the pyramid."""
    hexahedron, wedge, pyramid, tetrahedron = kinds
    brick = next(bricks((1, 1, 1)))
    apex = (0.5, 0.5, 2)
    return [
        (hexahedron, brick),
        (wedge, [(1, 0, 0), (2, 0, 0), (1, 1, 0), (1, 0, 1), (2, 0, 1), (1, 1, 1)]),
        (pyramid, [*brick[4:], apex]),
        (tetrahedron, [brick[5], (1.75, 0.5, 1.75), brick[6], apex]),
    ]


def turned(body):
    """The body with every cell numbered the other way round."""
    blocks = []
    for kind, rows in body.blocks:
        own = places(kind, CORNER_PLACES[KINDS[kind][0]])
        other = own[:, [1, 0, 2]]
        order = [int(np.argmin(np.abs(own - place).sum(axis=1))) for place in other]
        blocks.append((kind, rows[:, order]))
    return dataclasses.replace(body, name=f"{body.name}-turned", blocks=blocks, turned=True)


def with_spare_nodes(body):
    """The body with nodes that no cell uses, before, between and after the others."""
    n = len(body.points)
    places = np.insert(body.points, [0, n // 2, n], [[7, 8, 9], [7, 8, 8], [7, 8, 7]], axis=0)
    of = np.arange(n) + 1 + (np.arange(n) >= n // 2)
    renumbered = {name: [(kind, tuple(of[list(nodes)])) for kind, nodes in rows] for name, rows in body.facet_groups.items()}
    lines = {name: [(kind, tuple(of[list(nodes)])) for kind, nodes in rows] for name, rows in body.line_groups.items()}
    nodes = {name: of[rows].tolist() for name, rows in body.node_groups.items()}
    blocks = [(kind, of[rows]) for kind, rows in body.blocks]
    return dataclasses.replace(
        body, name=f"{body.name}-spare", points=places, blocks=blocks, facet_groups=renumbered, line_groups=lines, node_groups=nodes
    )


def in_blocks(body):
    """The body with the cells of each kind in two blocks."""
    blocks = [part for kind, rows in body.blocks for part in ((kind, rows[: len(rows) // 2]), (kind, rows[len(rows) // 2 :]))]
    blocks = [(kind, rows) for kind, rows in blocks if len(rows)]
    return dataclasses.replace(body, name=f"{body.name}-blocks", blocks=blocks)


SOLID = ["tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15", "pyramid5", "pyramid13"]
PLANE = ["tri3", "tri6", "quad4", "quad8", "quad9"]


def all_bodies():
    """Bodies of every kind of cell, alone and mixed; mirrored, with several blocks, with nodes of no cell."""
    bodies = []
    for kind in SOLID:
        n = (2, 2, 1) if KINDS[kind][0] in ("hexahedron", "wedge") else (2, 1, 1)
        bodies.append(build(kind, [cell for corners in bricks(n) for cell in split(kind, corners)]))
    bodies += [build(kind, list(plane(kind, (3, 2)))) for kind in PLANE]
    bodies.append(build("mixed-linear", mixed(["hex8", "wedge6", "pyramid5", "tet4"])))
    bodies.append(build("mixed-quadratic", mixed(["hex20", "wedge15", "pyramid13", "tet10"])))
    ring = [(0, 0, 0), (1, 0, 0), (2, 0, 1), (2, 1, 1), (1, 2, 0), (0, 1, 2)]
    bodies.append(build("line2", [("line2", ends) for ends in itertools.combinations(ring, 2)]))
    half = list(plane("tri3", (1, 2))), list(plane("quad4", (3, 2)))
    bodies.append(build("mixed-plane", half[0] + [cell for cell in half[1] if cell[1][0][0] >= 1]))
    half = list(plane("tri6", (1, 2))), list(plane("quad8", (3, 2)))
    bodies.append(build("mixed-plane-quadratic", half[0] + [cell for cell in half[1] if cell[1][0][0] >= 1]))
    return (
        bodies
        + [in_blocks(body) for body in bodies]
        + [turned(body) for body in bodies if body.dimension > 1]
        + [with_spare_nodes(body) for body in bodies]
    )
