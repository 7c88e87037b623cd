"""Files and meshes of meshio, and meshes of arrays."""

import contextlib
import dataclasses
import functools
import io
import itertools

import emmy
import meshio
import numpy as np
from wanted import cell_group, ends_of, facet_group, groups_of, node_group, of_body

NAMES = {
    "vertex": "vertex", "line2": "line", "line3": "line3", "tri3": "triangle", "tri6": "triangle6", "quad4": "quad",
    "quad8": "quad8", "quad9": "quad9", "tet4": "tetra", "tet10": "tetra10", "hex8": "hexahedron",
    "hex20": "hexahedron20", "hex27": "hexahedron27", "wedge6": "wedge", "wedge15": "wedge15", "pyramid5": "pyramid",
    "pyramid13": "pyramid13",
}  # fmt: skip


def bodies(corpus, way):
    """The bodies with cells that meshio has."""
    for body in corpus.bodies(way):
        unknown = {NAMES[kind] for kind in body.kinds} - set(meshio._mesh.topological_dimension)
        if unknown:
            corpus.cannot(way.partition("-")[0], body.name, f"meshio has no {', '.join(sorted(unknown))}")
        else:
            yield body


def lower(body, vertices=True):
    """Blocks of faces, edges and points: group, kind, nodes."""
    rows = [(name, kind, nodes) for groups in (body.facet_groups, body.line_groups) for name, own in groups.items() for kind, nodes in own]
    rows += [(name, "vertex", (node,)) for name, nodes in body.node_groups.items() for node in nodes if vertices]
    for (name, kind), own in itertools.groupby(sorted(rows, key=lambda row: row[:2]), key=lambda row: row[:2]):
        yield name, kind, np.array([nodes for _, _, nodes in own])


def with_blocks(body, blocks):
    return meshio.Mesh(body.points, [(NAMES[kind], rows) for kind, rows in blocks])


def links(body, groups):
    """Groups of lines that are cells."""
    return list(groups) if body.dimension == 1 else []


def of_all_links(body):
    """The group of the links of a grid."""
    return {"links": cell_group(range(len(body.cells)))} if body.dimension == 1 else {}


def written(corpus, way, body, mesh, path, **options):
    """Whether meshio has written a file."""
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            meshio.write(path, mesh, **options)
    except Exception as error:
        corpus.cannot(way.removesuffix("-one-pid"), body.name, f"{type(error).__name__}: {error}")
        return False
    return True


def sides(body):
    """Blocks of cells that are wholly in one of the two parts, with the number of the part."""
    start = 0
    for kind, rows in body.blocks:
        inside = np.isin(np.arange(start, start + len(rows)), body.cell_groups["left"])
        start += len(rows)
        yield from [(tag, kind, rows[own]) for tag, own in ((1, inside), (2, ~inside)) if own.any()]


def parts(body):
    """Groups of cells that do not overlap."""
    return {name: cell_group(members) for name, members in body.cell_groups.items() if name != "some"}


def tagged(body, vertices):
    """A mesh with one number for each cell: 1 and 2 for the parts, 3 for faces, 4 for edges, 5 for points."""
    number = {"base": 3, "rim": 4, "tip": 5}
    blocks = [*sides(body), *((number[name], kind, rows) for name, kind, rows in lower(body, vertices))]
    mesh = with_blocks(body, [(kind, rows) for _, kind, rows in blocks])
    return mesh, [np.full(len(rows), tag) for tag, _, rows in blocks]


def names_of_tags(body):
    """Name and dimension of the group of each number."""
    dimension = body.dimension
    names = {1: ("left", dimension), 2: ("right part", dimension), 5: ("tip", 0)}
    names |= {3: ("base", dimension - 1)} if body.facet_groups else {}
    return names | ({4: ("rim", 1)} if body.line_groups else {})


def to_gmsh(corpus):
    for version, binary, named in itertools.product(["2.2", "4.0", "4.1"], [False, True], [True, False]):
        if version == "4.0" and not named:
            continue
        way = f"meshio/gmsh-{version}-{'binary' if binary else 'ascii'}{'' if named else '-unnamed'}"
        for body in bodies(corpus, way):
            if version == "4.0" and body.dimension == 1:
                corpus.cannot(way, body.name, "without groups no lines are links")
                continue
            mesh, tags = tagged(body, vertices=True)
            mesh.cell_data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
            if version == "4.0":
                # It writes no entities, and so no groups.
                mesh = with_blocks(body, body.blocks)
            elif version == "4.1":
                # Every block is an entity of its own, which has nodes.
                entities = [np.full(len(own), i + 1) for i, own in enumerate(tags)]
                mesh.cell_data["gmsh:geometrical"] = entities
                owner = np.full((len(body.points), 2), -1)
                for i, block in sorted(enumerate(mesh.cells), key=lambda pair: pair[1].dim):
                    free = [node for node in np.unique(block.data) if owner[node, 0] < 0] or [np.unique(block.data)[0]]
                    owner[free[:1] if i < len(mesh.cells) else free] = (block.dim, i + 1)
                owner[owner[:, 0] < 0] = (mesh.cells[0].dim, 1)
                if len(np.unique(owner, axis=0)) < len(mesh.cells):
                    corpus.cannot(way, body.name, "an entity without a node of its own has no physical group")
                    continue
                mesh.point_data = {"gmsh:dim_tags": owner}
            names = names_of_tags(body) if version != "4.0" else {}
            if named:
                mesh.field_data = {name: np.array([tag, dim]) for tag, (name, dim) in names.items()}
            groups = parts(body) | groups_of(body, cells=False) if names else {}
            if not named:
                groups = {str(tag): groups[name] for tag, (name, _) in names.items() if name in groups}
            path = corpus.path(way, f"{body.name}.msh")
            # The format of 4.0 can be had by its module alone.
            writer = meshio.gmsh.main._writers[version]
            try:
                writer.write(path, mesh, binary=binary, float_fmt=".16e")
            except Exception as error:
                corpus.cannot(way, body.name, f"{type(error).__name__}: {error}")
                continue
            corpus.file(way, path, of_body(body, groups), links=links(body, groups))


# Types whose faces and plane cells Abaqus has; meshio would write axisymmetric and rigid elements.
ABAQUS_FACES = {"tri3": "S3", "tri6": "STRI65", "quad4": "S4R", "quad8": "S8R"}
ABAQUS_CELLS = {"line2": "T3D2", "pyramid5": "C3D5", "tri3": "CPE3", "tri6": "CPE6", "quad4": "CPE4R", "quad8": "CPE8"}


def to_abaqus(corpus):
    for faces in (False, True):
        way = f"meshio/abaqus{'-faces' if faces else ''}"
        for body in bodies(corpus, way):
            others = [block for block in lower(body, vertices=False) if block[1] in ABAQUS_FACES] if faces else []
            mesh = with_blocks(body, [*body.blocks, *(block[1:] for block in others)])
            names = ABAQUS_CELLS
            for block, (kind, _) in zip(mesh.cells, body.blocks, strict=False):
                block.type = names.get(kind, meshio.abaqus._abaqus.meshio_to_abaqus_type.get(block.type, block.type))
            for block, (_, kind, _) in zip(mesh.cells[len(body.blocks) :], others, strict=True):
                block.type = ABAQUS_FACES[kind]
            if any(name.type in NAMES.values() for name in mesh.cells):
                corpus.cannot(way, body.name, "Abaqus has no such cell")
                continue
            ends = np.cumsum([len(rows) for _, rows in body.blocks])
            for name, members in body.cell_groups.items():
                members = np.array(members)
                own = [
                    members[(members >= end - len(rows)) & (members < end)] - (end - len(rows))
                    for end, (_, rows) in zip(ends, body.blocks, strict=True)
                ]
                mesh.cell_sets[name] = own + [np.zeros(0, int)] * len(others)
            for name in {name for name, _, _ in others}:
                mesh.cell_sets[name] = [np.zeros(0, int)] * len(body.blocks) + [
                    np.arange(len(rows) if own == name else 0) for own, _, rows in others
                ]
            mesh.point_sets = dict(body.node_groups)
            path = corpus.path(way, f"{body.name}.inp")
            groups = groups_of(body, edges=False, faces=bool(others))
            if written(corpus, way, body, mesh, path, translate_cell_names=False):
                shells = "plane-strain" if "quad9" in body.kinds else None
                corpus.file(way, path, of_body(body, groups), shells=shells, links=links(body, groups))


def to_nastran(corpus):
    formats = ["free", "fixed-small", "fixed-large"]
    for points, cells, one_number in itertools.product(formats, formats, [False, True]):
        way = f"meshio/nastran-{points}-{cells}{'-one-pid' if one_number else ''}"
        for body in bodies(corpus, way):
            # It has no lines of three nodes, and its longest numbers are too long for it.
            has_lines = all(
                kind == "line2"
                for kind, _ in (*body.line_groups.get("rim", []), *body.facet_groups.get("base", []))
                if kind.startswith("line")
            )
            faces = {} if not has_lines and body.dimension == 2 else body.facet_groups
            body = dataclasses.replace(
                body, points=body.points.round(6), facet_groups=faces, line_groups=body.line_groups if has_lines else {}
            )
            mesh, tags = tagged(body, vertices=False)
            mesh.cell_data = {"nastran:ref": [np.minimum(tag, 1) for tag in tags] if one_number else tags}
            path = corpus.path(way, f"{body.name}.bdf")
            groups = {"pid_1": parts(body)["left"]}
            if body.facet_groups:
                groups["pid_3"] = facet_group(body.facet_groups["base"])
            if "right part" in body.cell_groups:
                groups["pid_2"] = parts(body)["right part"]
            lines = body.line_groups.get("rim", [])
            if lines:
                groups["pid_4"] = ends_of(lines)
            if one_number:
                faces = "pid_1-lines" if body.dimension == 2 else "pid_1-faces"
                groups = {"pid_1": cell_group(range(len(body.cells)))} | ({faces: groups["pid_3"]} if body.facet_groups else {})
                groups |= {"pid_1-lines": ends_of(lines)} if lines else {}
            tolerance = 2e-5 if points == "fixed-small" else 1e-10
            if not written(corpus, way, body, mesh, path, file_format="nastran", point_format=points, cell_format=cells):
                continue
            if "hex20" in body.kinds and cells == "fixed-large":
                corpus.refused(way, path, "meshio changes the order of their nodes in large fields")
            else:
                corpus.file(way, path, of_body(body, groups, tolerance), links=links(body, groups))


def with_arrays(body):
    """A mesh with arrays of groups, as the formats of VTK have them, and the groups."""
    mesh, tags = tagged(body, vertices=True)
    number = {"base": 3, "rim": 4, "tip": 5}
    mesh.cell_data = {"part": tags}
    groups = parts(body) | groups_of(body, cells=False)
    wanted = {f"part={tag}": groups[name] for tag, (name, _) in names_of_tags(body).items() if name in groups}
    for name in ("base", "rim", "tip"):
        if name in groups:
            mesh.cell_data[f"group:{name}"] = [(tag == number[name]).astype(int) for tag in tags]
            wanted[name] = groups[name]
    some = {frozenset(body.cells[cell][1]) for cell in body.cell_groups["some"]}
    mesh.cell_data["group:some"] = [np.array([frozenset(row) in some for row in block.data.tolist()]).astype(int) for block in mesh.cells]
    wanted["some"] = cell_group(body.cell_groups["some"])
    corner = np.zeros(len(body.points), int)
    corner[body.node_groups["tip"]] = 1
    mesh.point_data = {"group:at_point": corner}
    wanted["at_point"] = node_group(body.node_groups["tip"])
    return mesh, wanted | of_all_links(body)


def to_vtk(corpus):
    ways = {
        f"vtk-{v}-{'binary' if b else 'ascii'}": ("vtk", {"file_format": f"vtk{v.replace('.', '')}", "binary": b})
        for v in ("4.2", "5.1")
        for b in (True, False)
    }
    ways["vtu-ascii"] = ("vtu", {"binary": False})
    for compression, header in itertools.product([None, "zlib", "lzma"], ["UInt32", "UInt64"]):
        ways[f"vtu-{compression}-{header}"] = ("vtu", {"compression": compression, "header_type": header})
    for name, (suffix, options) in ways.items():
        way = f"meshio/{name}"
        for body in bodies(corpus, way):
            mesh, groups = with_arrays(body)
            path = corpus.path(way, f"{body.name}.{suffix}")
            if not written(corpus, way, body, mesh, path, **options):
                continue
            if "lzma" in name:
                corpus.refused(way, path, "compressed by vtkLZMADataCompressor; save it compressed by ZLib")
            else:
                corpus.file(way, path, of_body(body, groups, 1e-10 if name == "vtu-ascii" else 1e-12))


def from_memory(corpus):
    for way, make in {"arrays": with_arrays, "sets": with_sets}.items():
        way = f"meshio/memory-{way}"
        for body in bodies(corpus, way):
            mesh, groups = make(body)
            corpus.check(way, body.name, of_body(body, groups), lambda mesh=mesh: emmy.Mesh.from_meshio(mesh))


def with_sets(body):
    """A mesh with sets of cells and points, and the groups."""
    mesh, _ = tagged(body, vertices=False)
    cells = body.cells
    members = {name: [cells[number][1] for number in numbers] for name, numbers in body.cell_groups.items()}
    members |= {name: [nodes for _, nodes in rows] for name, rows in {**body.facet_groups, **body.line_groups}.items()}
    for name, rows in members.items():
        own = {frozenset(row) for row in rows}
        mesh.cell_sets[name] = [np.flatnonzero([frozenset(row) in own for row in block.data.tolist()]) for block in mesh.cells]
    mesh.point_sets = dict(body.node_groups)
    return mesh, groups_of(body) | of_all_links(body)


def of_arrays(corpus):
    way = "arrays"
    for body in corpus.bodies(way):
        mesh = functools.partial(mesh_of_arrays, body)
        corpus.check(way, body.name, of_body(body, groups_of(body, edges=False) | of_all_links(body)), mesh)


def mesh_of_arrays(body):
    """The mesh of arrays by the kinds of cells, which number the cells in this order."""
    cells = {}
    for kind, rows in body.blocks:
        cells.setdefault(kind, []).extend(rows.tolist())
    order = [tuple(row) for rows in cells.values() for row in rows]
    groups = {name: [order.index(body.cells[cell][1]) for cell in members] for name, members in body.cell_groups.items()}
    faces = {}
    for name, rows in body.facet_groups.items():
        kinds = sorted({kind for kind, _ in rows})
        faces[name] = [np.array([nodes for kind, nodes in rows if kind == own]) for own in kinds]
    return emmy.Mesh(body.points, cells, cell_groups=groups, facet_groups=faces, node_groups=body.node_groups)


def write_all(corpus):
    for write in (to_gmsh, to_abaqus, to_nastran, to_vtk, from_memory, of_arrays):
        write(corpus)
