"""Files of pyNastran."""

import itertools

import numpy as np
from bodies import KINDS
from pyNastran.bdf.bdf import BDF
from wanted import cell_group, ends_of, facet_group, node_group, of_body

# Number of Nastran for each place in a card (QRG): midside nodes of the bottom, of the vertical edges, of the top.
HEX20 = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]
WEDGE15 = [*range(9), 12, 13, 14, 9, 10, 11]
CARDS = {
    "tet4": "CTETRA", "tet10": "CTETRA", "hex8": "CHEXA", "hex20": "CHEXA", "wedge6": "CPENTA", "wedge15": "CPENTA",
    "pyramid5": "CPYRAM", "pyramid13": "CPYRAM", "tri3": "CTRIA3", "tri6": "CTRIA6", "quad4": "CQUAD4", "quad8": "CQUAD8",
    "line2": "CBAR", "line3": "CBAR",
}  # fmt: skip
# Properties of the parts, of faces and of edges.
PID = {"left": 11, "right part": 22, "base": 33, "rim": 44}


def numbers(body, first=1):
    """Numbers of the nodes, with gaps and not ascending."""
    n = len(body.points)
    return (7 * ((5 * np.arange(n) + 3) % n if n % 5 else np.arange(n)) + first).tolist()


def model_of(body, own, system):
    """The model, with nodes of these numbers, which may be in a system of coordinates."""
    model = BDF(debug=None)
    model.sol = 101
    places = body.points
    cid = 0
    if system:
        cid = 5
        add_system(model, cid, system)
        model.cross_reference()
        places = [model.coords[cid].transform_node_to_local(place) for place in body.points]
        model.uncross_reference()
    if system == "GRDSET":
        # Nodes have no system of their own.
        model.add_grdset(cid, 0, "", 0)
        cid = 0
    for number, place in zip(own, places, strict=True):
        model.add_grid(number, place, cp=cid)
    add_cells(model, body, own)
    return model


def add_system(model, cid, system):
    """A system of coordinates, which is oblique and not at the origin."""
    place, axis, in_plane = [0.3, -0.7, 0.2], [0.5, -0.1, 1.4], [1.7, -0.2, 0.4]
    if system == "GRDSET":
        model.add_cord2r(cid, place, axis, in_plane)
    elif system == "nested":
        model.add_cord2s(7, place, axis, in_plane)
        model.add_cord2c(6, [0.9, 40.0, 20.0], [0.4, 70.0, 35.0], [1.2, 60.0, -10.0], rid=7)
        model.add_cord2r(cid, [0.9, 40.0, 0.5], [0.4, 70.0, 1.5], [1.2, -60.0, -1.0], rid=6)
    elif system.startswith("CORD1"):
        for grid, at in zip((9001, 9002, 9003), (place, axis, in_plane), strict=True):
            model.add_grid(grid, at)
        getattr(model, f"add_{system.lower()}")(cid, 9001, 9002, 9003)
    else:
        getattr(model, f"add_{system.lower()}")(cid, place, axis, in_plane)


def add_cells(model, body, own):
    element = itertools.count(100, 3)

    def add(kind, nodes, pid):
        order = {"hex20": HEX20, "wedge15": WEDGE15}.get(kind, range(KINDS[kind][1]))
        nodes = [own[nodes[i]] for i in order]
        card = CARDS[kind]
        number = next(element)
        if card == "CBAR":
            model.add_card(["CBAR", number, pid, *nodes[:2], 0.0, 0.3, 0.9], "CBAR")
        else:
            model.add_card([card, number, pid, *nodes], card)

    left = set(body.cell_groups["left"])
    for number, (kind, nodes) in enumerate(body.cells):
        add(kind, nodes, PID["left" if number in left else "right part"])
    for groups in (body.facet_groups, body.line_groups):
        for name, rows in groups.items():
            for kind, nodes in rows:
                add(kind, nodes, PID[name])


def groups(body):
    found = {f"pid_{PID[name]}": cell_group(body.cell_groups[name]) for name in ("left", "right part") if name in body.cell_groups}
    if body.facet_groups:
        found[f"pid_{PID['base']}"] = facet_group(body.facet_groups["base"])
    for rows in body.line_groups.values():
        found[f"pid_{PID['rim']}"] = ends_of(rows)
    return found


def add_supports(model, body, own):
    """Supports; their grid points are groups."""
    first, second = list(body.node_groups["tip"]), sorted({node for _, nodes in body.cells[:1] for node in nodes})
    model.add_spc1(8, "123", [own[node] for node in second])
    model.add_spc(9, [own[node] for node in first], ["3"], [0.0])
    # In a plane, z is fixed anyway.
    model.nodes[own[first[0]]].ps = "13"
    return {"spc_8": node_group(second), "spc_9": node_group(first), ("ps_1" if body.dimension == 2 else "ps_13"): node_group(first)}


WAYS = {
    "small": {"size": 8}, "large": {"size": 16}, "double": {"size": 16, "is_double": True},
    "small-interspersed": {"size": 8, "interspersed": True}, "large-not-interspersed": {"size": 16, "interspersed": False},
    "supports": {"size": 16}, "properties": {"size": 8}, "include": {"size": 16}, "long-ids": {"size": 16},
    "long-ids-small": {"size": 8},
    "CORD1R": {"size": 16}, "CORD2R": {"size": 16}, "CORD2C": {"size": 16}, "CORD2S": {"size": 16}, "CORD2R-small": {"size": 8},
}  # fmt: skip


def lacking(body):
    """Kinds that Nastran has not."""
    rows = [*body.cells, *(row for rows in body.facet_groups.values() for row in rows)]
    return sorted({kind for kind, _ in rows if kind not in CARDS})


def write_all(corpus):
    for name, options in WAYS.items():
        way = f"pyNastran/{name}"
        for body in corpus.bodies(way):
            missing = lacking(body)
            if missing:
                corpus.cannot("pyNastran", body.name, f"Nastran has no {', '.join(missing)}")
                continue
            if name == "CORD2R-small" and body.dimension == 2:
                corpus.cannot(way, body.name, "with 8 characters in turned coordinates a plane is not flat")
                continue
            system = name.removesuffix("-small") if name.startswith(("CORD", "GRDSET", "nested")) else None
            # The largest have 8 digits.
            own = numbers(body, 99_000_000 if name.startswith("long-ids") else 1)
            model = model_of(body, own, system)
            wanted_groups = groups(body)
            if name == "supports":
                wanted_groups |= add_supports(model, body, own)
            if name == "properties":
                add_properties(model, body)
            path = corpus.path(way, f"{body.name}.bdf")
            try:
                write(model, path, name, options)
            except Exception as error:
                corpus.cannot(way, body.name, f"{type(error).__name__}: {error}")
                continue
            tolerance = 1e-9 if options["size"] == 16 else 2e-5
            if system:
                tolerance *= 10
            links = list(wanted_groups) if body.dimension == 1 else []
            corpus.file(way, path, of_body(body, wanted_groups, tolerance), links=links)


def add_properties(model, body):
    """Properties and a material; plane cells in plane strain."""
    model.add_mat1(1, 2.1e11, None, 0.3)
    for name, pid in PID.items():
        if (
            name in body.line_groups
            or body.dimension == 1
            and name in body.cell_groups
            or body.dimension == 2
            and name in body.facet_groups
        ):
            model.add_pbar(pid, 1, 0.1, 0.1, 0.1, 0.1)
        elif name in body.facet_groups:
            model.add_pshell(pid, 1, 0.1)
        elif name in body.cell_groups and body.dimension == 2:
            model.add_plplane(pid, 1)
        elif name in body.cell_groups:
            model.add_psolid(pid, 1)


def write(model, path, name, options):
    if name != "include":
        model.write_bdf(str(path), **options)
        return
    # Nodes in a file of their own.
    part = path.with_name(f"{path.stem}-nodes.inc")
    model.write_bdf(str(path), **options)
    lines = path.read_text().splitlines(keepends=True)
    start = next(i for i, line in enumerate(lines) if line.startswith("GRID"))
    end = max(i for i, line in enumerate(lines) if line.startswith("GRID")) + 2
    part.write_text("".join(lines[start:end]))
    path.write_text("".join(lines[:start]) + f"INCLUDE '{part.name}'\n" + "".join(lines[end:]))
