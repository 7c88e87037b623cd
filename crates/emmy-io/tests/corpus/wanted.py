"""What a reader must find in a file, and the differences from it."""

import dataclasses

import numpy as np
from bodies import CORNER_PLACES, KINDS, facets, places

# Monomials of the functions of faces and plane cells.
MONOMIALS = {
    "tri3": [(0, 0), (1, 0), (0, 1)],
    "tri6": [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)],
    "quad4": [(0, 0), (1, 0), (0, 1), (1, 1)],
    "quad8": [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (2, 1), (1, 2)],
    "quad9": [(i, j) for i in range(3) for j in range(3)],
}


def rule(kind):
    """Points and weights that are exact for polynomials up to degree 9, Gauss on the square or collapsed."""
    x, w = np.polynomial.legendre.leggauss(6)
    x, w = (x + 1) / 2, w / 2
    u, v = (grid.ravel() for grid in np.meshgrid(x, x))
    weights = np.outer(w, w).ravel()
    return (u, v, weights) if kind.startswith("quad") else (u, v * (1 - u), weights * (1 - u))


def gradients(kind):
    """Functions and both derivatives at the points of the rule, and its weights."""
    powers = MONOMIALS[kind]
    nodes = places(kind, CORNER_PLACES[KINDS[kind][0]])[:, :2]
    inverse = np.linalg.inv([[x**i * y**j for i, j in powers] for x, y in nodes])
    u, v, weights = rule(kind)
    value = np.column_stack([u**i * v**j for i, j in powers]) @ inverse
    by_u = np.column_stack([i * u ** max(i - 1, 0) * v**j for i, j in powers]) @ inverse
    by_v = np.column_stack([j * u**i * v ** max(j - 1, 0) for i, j in powers]) @ inverse
    return value, by_u, by_v, weights


def surface(kind, points):
    """Integrals over a face: of its normal, and of place times normal over 3."""
    value, by_u, by_v, weights = gradients(kind)
    normal = np.cross(by_u @ points, by_v @ points)
    return weights @ normal, weights @ np.sum((value @ points) * normal, axis=1) / 3


def volume(points, cells):
    """Volume of cells as the integral over their faces (Gauss), and area of plane cells; links have none."""
    total = 0.0
    for kind, nodes in cells:
        if KINDS[kind][2] == 3:
            rows = [(facet, [nodes[i] for i in local]) for facet, local in facets(kind)]
            total += abs(sum(surface(facet, points[own])[1] for facet, own in rows))
        elif KINDS[kind][2] == 2:
            total += abs(surface(kind, points[list(nodes)])[0][2])
    return float(total)


@dataclasses.dataclass
class Wanted:
    """A mesh by the library that wrote it. Groups: name to members by their kind, `cells` by number, `facets` and
    `nodes` by their nodes."""

    points: np.ndarray
    cells: list
    groups: dict
    tolerance: float = 1e-12
    ordered: bool = True
    volume: float | None = None


def of_body(body, groups, tolerance=1e-12):
    return Wanted(body.points, body.cells, groups, tolerance, not body.turned)


def cell_group(members):
    return {"cells": set(members)}


def facet_group(rows):
    return {"facets": {frozenset(map(int, nodes)) for _, nodes in rows}}


def node_group(nodes):
    return {"nodes": set(map(int, nodes))}


def nodes_of(rows):
    """The group of the nodes of edges."""
    return node_group({node for _, nodes in rows for node in nodes})


def ends_of(rows):
    """The group of the nodes at the ends of edges."""
    return node_group({node for _, nodes in rows for node in nodes[:2]})


def groups_of(body, lines=nodes_of, cells=True, faces=True, edges=True, nodes=True):
    """All groups of a body under their names."""
    parts = [
        (body.cell_groups, cell_group, cells),
        (body.facet_groups, facet_group, faces),
        (body.line_groups, lines, edges),
        (body.node_groups, node_group, nodes),
    ]
    groups = {}
    for own, group, is_there in parts:
        for name, members in own.items() if is_there else ():
            groups.setdefault(name, {}).update(group(members))
    return groups


def differences(mesh, wanted):
    """Sentences on what a mesh of Emmy has otherwise."""
    used = sorted({node for _, nodes in wanted.cells for node in nodes})
    points = wanted.points[used]
    size = np.ptp(points, axis=0).max()
    if mesh.n_nodes != len(used):
        return [f"{mesh.n_nodes} nodes for {len(used)}"]
    distance = np.linalg.norm(mesh.points[:, None, :] - points[None, :, :], axis=2)
    nearest = distance.argmin(axis=1)
    worst = distance[np.arange(len(used)), nearest].max()
    if worst > wanted.tolerance * size or len(set(nearest.tolist())) != len(used):
        return [f"nodes are {worst:.2e} away from their places"]
    node = np.array(used)[nearest]
    found = []

    # Cells: each has its nodes, in their order.
    native = mesh._native
    number_of = {(kind, frozenset(nodes)): number for number, (kind, nodes) in enumerate(wanted.cells)}
    own = {}
    for kind, rows in mesh.cells.items():
        for number, row in zip(native.cell_numbers[kind], node[rows].tolist(), strict=True):
            match = number_of.get((kind, frozenset(row)))
            if match is None:
                return [f"there is no {kind} of the nodes {row}"]
            own[int(number)] = match
            if wanted.ordered and tuple(row) != tuple(wanted.cells[match][1]):
                found.append(f"a {kind} has its nodes in another order: {row} for {wanted.cells[match][1]}")
    if len(own) != len(wanted.cells) or len(set(own.values())) != len(own):
        found.append(f"{len(own)} cells for {len(wanted.cells)}")
    right = volume(wanted.points, wanted.cells) if wanted.volume is None else wanted.volume
    if right and abs(mesh.quality["volume"] - right) > 10 * wanted.tolerance * size * right:
        found.append(f"volume {mesh.quality['volume']} for {right}")

    members = {
        "cells": lambda name: {own[int(cell)] for cell in native.cell_group(name)},
        "facets": lambda name: {frozenset(node[list(row)].tolist()) for row in native.facet_nodes(name)},
        "nodes": lambda name: set(node[native.node_group(name)].tolist()),
    }
    groups = {name: {kind: members[kind](name) for kind in kinds} for name, kinds in mesh.groups.items()}
    for name in sorted(groups.keys() | wanted.groups.keys()):
        a, b = groups.get(name), wanted.groups.get(name)
        if a != b:
            found.append(f"group {name!r}: {short(a)} for {short(b)}")
    return found


def short(group):
    if group is None:
        return "nothing"
    return ", ".join(f"{len(members)} {kind} {sorted(map(str, members))[:4]}" for kind, members in group.items())
