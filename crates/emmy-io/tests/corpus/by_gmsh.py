"""Files of Gmsh."""

import collections
import itertools

import gmsh
import numpy as np
from bodies import CORNER_PLACES, KINDS, places
from wanted import cell_group, ends_of, facet_group, groups_of, of_body

TYPES = {
    "vertex": 15, "line2": 1, "line3": 8, "tri3": 2, "tri6": 9, "quad4": 3, "quad8": 16, "quad9": 10, "tet4": 4,
    "tet10": 11, "hex8": 5, "hex20": 17, "hex27": 12, "wedge6": 6, "wedge15": 18, "pyramid5": 7, "pyramid13": 19,
}  # fmt: skip
KIND_OF = {number: kind for kind, number in TYPES.items()}
# The reference cells of Gmsh as those of the bodies.
CENTRED = {"line": [1, 0, 0], "quadrilateral": [1, 1, 0], "hexahedron": [1, 1, 1], "wedge": [0, 0, 1], "pyramid": [1, 1, 0]}


def order(kind):
    """For each node of Gmsh its number in the order of VTK, by the places that Gmsh gives."""
    shape, n_nodes, dimension = KINDS[kind]
    if shape is None:
        return [0]
    flat = np.reshape(gmsh.model.mesh.getElementProperties(TYPES[kind])[4], (n_nodes, dimension))
    local = np.zeros((n_nodes, 3))
    local[:, :dimension] = flat
    for axis, is_centred in enumerate(CENTRED.get(shape, ())):
        if is_centred:
            local[:, axis] = (local[:, axis] + 1) / 2
    own = places(kind, CORNER_PLACES[shape])
    numbers = [int(np.argmin(np.abs(own - place).sum(axis=1))) for place in local]
    assert sorted(numbers) == list(range(n_nodes)) and np.allclose(own[numbers], local), kind
    return numbers


def make_model(body):
    """The body as discrete entities; the numbers of its nodes have gaps. Returns the groups of each entity of cells."""
    gmsh.clear()
    gmsh.model.add(body.name)
    mesh = gmsh.model.mesh
    tag_of = 3 * np.arange(len(body.points)) + 7
    memberships = [frozenset(name for name, cells in body.cell_groups.items() if cell in cells) for cell in range(len(body.cells))]
    entities = {}
    for dimension, rows in [
        (body.dimension, [(memberships[number], kind, nodes) for number, (kind, nodes) in enumerate(body.cells)]),
        (body.dimension - 1, [(frozenset([name]), kind, nodes) for name, own in body.facet_groups.items() for kind, nodes in own]),
        (1, [(frozenset([name]), kind, nodes) for name, own in body.line_groups.items() for kind, nodes in own]),
        (0, [(frozenset([name]), "vertex", (node,)) for name, own in body.node_groups.items() for node in own]),
    ]:
        groups = collections.defaultdict(list)
        for names, members in itertools.groupby(sorted(rows, key=lambda row: sorted(row[0])), key=lambda row: sorted(row[0])):
            tag = gmsh.model.addDiscreteEntity(dimension)
            if dimension == body.dimension:
                entities[tag] = names
            if not gmsh.model.mesh.getNodes()[0].size:
                mesh.addNodes(dimension, tag, tag_of, body.points.ravel())
            for kind, own in itertools.groupby(list(members), key=lambda row: row[1]):
                nodes = tag_of[np.array([row[2] for row in own])[:, order(kind)]]
                mesh.addElementsByType(tag, TYPES[kind], [], nodes.ravel())
            for name in names:
                groups[name].append(tag)
        for name, tags in sorted(groups.items()):
            gmsh.model.addPhysicalGroup(dimension, tags, name=name)
    return entities


def volume():
    """The volume by the Jacobians of Gmsh."""
    total = 0.0
    for number in gmsh.model.mesh.getElementTypes(gmsh.model.getDimension()):
        places, weights = gmsh.model.mesh.getIntegrationPoints(number, "CompositeGauss8")
        _, jacobians, _ = gmsh.model.mesh.getJacobians(number, places)
        total += float(np.abs(jacobians.reshape(-1, len(weights)) @ weights).sum())
    return total


def set_options(**options):
    for name, value in options.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)


def wanted(body, groups, tolerance=1e-12, known=None):
    """What the body must be, with the volume by Gmsh, or a known one."""
    right = of_body(body, groups, tolerance)
    # Its pyramids of 13 nodes have other functions inside.
    if body.dimension > 1 and "pyramid13" not in body.kinds:
        right.volume = known or volume()
    return right


MSH = list(itertools.product([1.0, 2.0, 2.1, 2.2, 4.0, 4.1], [0, 1]))


def writes(version, binary):
    """Whether Gmsh has a version in binary form."""
    return not (binary and version in (1.0, 4.0))


def write_msh(corpus, way, body, version, binary, groups, known=None, **options):
    """Writes and compares a file."""
    set_options(MshFileVersion=version, Binary=binary, **options)
    path = corpus.path(way, f"{body.name}.msh")
    gmsh.write(str(path))
    if version == 1.0:
        # Groups have numbers alone there, the same one in several dimensions.
        numbers = {}
        for dimension, tag in gmsh.model.getPhysicalGroups():
            members = groups.get(gmsh.model.getPhysicalName(dimension, tag), {})
            kind = "cells" if dimension == body.dimension else "facets" if 0 < dimension == body.dimension - 1 else "nodes"
            if kind in members:
                numbers.setdefault(str(tag), {}).setdefault(kind, set()).update(members[kind])
        groups = numbers
    corpus.file(way, path, wanted(body, groups, known=known), links=list(groups) if body.dimension == 1 else [])


def to_msh(corpus):
    for version, binary in MSH:
        way = f"gmsh/{version}-{'binary' if binary else 'ascii'}"
        if not writes(version, binary):
            if corpus.bodies(way):
                corpus.cannot(way, "all", "Gmsh writes this version as text alone")
            continue
        for body in corpus.bodies(way):
            make_model(body)
            write_msh(corpus, way, body, version, binary, groups_of(body))


def to_inp(corpus):
    for node_sets in (0, 1):
        way = f"gmsh/inp{'-nsets' if node_sets else ''}"
        for body in corpus.bodies(way):
            entities = make_model(body)
            set_options(SaveGroupsOfNodes=node_sets)
            path = corpus.path(way, f"{body.name}.inp")
            gmsh.write(str(path))
            check_inp(corpus, way, body, path, entities, node_sets)


def check_inp(corpus, way, body, path, entities, node_sets):
    if is_refused(corpus, way, body, path):
        return
    groups = groups_of(body, nodes=False)
    if node_sets:
        # Node sets of the same names.
        cells = body.cells
        nodes = {name: {node for cell in members for node in cells[cell][1]} for name, members in body.cell_groups.items()}
        for rows in (body.facet_groups, body.line_groups):
            nodes |= {name: {node for _, own in members for node in own} for name, members in rows.items()}
        nodes |= {name: set(own) for name, own in body.node_groups.items()}
        for name, own in nodes.items():
            groups.setdefault(name, {})["nodes"] = own
    # Element sets of the entities.
    names = ["Point", "Line", "Surface", "Volume"]
    for tag, of_entity in entities.items():
        own = [
            number
            for number in range(len(body.cells))
            if {name for name, cells in body.cell_groups.items() if number in cells} == set(of_entity)
        ]
        groups[f"{names[body.dimension]}{tag}"] = cell_group(own)
    for rows, dimension in ((body.facet_groups, body.dimension - 1), (body.line_groups, 1)):
        for tag, name in zip([tag for _, tag in gmsh.model.getEntities(dimension)], rows, strict=False):
            # The node set of the name is not one of the entity.
            group = facet_group(rows[name]) if rows is body.facet_groups else groups_of(body)[name]
            groups[f"{names[dimension]}{tag}"] = group
    groups = {name.replace(" ", "_"): group for name, group in groups.items()}
    shells = "plane-strain" if body.dimension == 2 else None
    corpus.file(way, path, wanted(body, groups), shells=shells, links=list(groups) if body.dimension == 1 else [])


# What Emmy says where Gmsh writes cells that the format has not.
NOT_OF_FORMAT = {
    (".inp", "hex27"): "elements of type C3D27 are not supported",
    (".bdf", "hex27"): "has 27 nodes instead of 8 or 20",
}


def is_refused(corpus, way, body, path):
    """Whether a file has cells that the format has not; checks the message then."""
    texts = [text for (suffix, kind), text in NOT_OF_FORMAT.items() if suffix == path.suffix and kind in body.kinds]
    if texts:
        corpus.refused(way, path, texts[0])
    return bool(texts)


def to_bdf(corpus):
    for field, tags in itertools.product([0, 1, 2], [1, 2]):
        way = f"gmsh/bdf-fields{field}-{'physical' if tags == 2 else 'entities'}"
        for body in corpus.bodies(way):
            make_model(body)
            for tag in [tag for d, tag in gmsh.model.getPhysicalGroups(body.dimension) if gmsh.model.getPhysicalName(d, tag) == "some"]:
                gmsh.model.removePhysicalGroups([(body.dimension, tag)])
            set_options(BdfFieldFormat=field, SaveElementTagType=tags)
            path = corpus.path(way, f"{body.name}.bdf")
            gmsh.write(str(path))
            if is_refused(corpus, way, body, path):
                continue
            groups = pids(body, tags == 2)
            corpus.file(way, path, wanted(body, groups, 1e-8 if field == 2 else 2e-5), links=list(groups) if body.dimension == 1 else [])


def pids(body, physical):
    """Groups of the property numbers: of the physical groups or the entities."""
    rows = collections.defaultdict(list)
    index = {frozenset(nodes): number for number, (_, nodes) in enumerate(body.cells)}
    for dimension in range(1, body.dimension + 1):
        for _, tag in gmsh.model.getEntities(dimension):
            number = gmsh.model.getPhysicalGroupsForEntity(dimension, tag)[0] if physical else tag
            for kind, nodes in elements(dimension, tag):
                rows[dimension, int(number)].append((kind, tuple((node - 7) // 3 for node in nodes)))
    groups = {}
    for (dimension, number), own in rows.items():
        # Of several groups with one number, those below the cells have names of their own.
        is_shared = any((higher, number) in rows for higher in range(dimension + 1, body.dimension + 1))
        suffix = ("-lines" if dimension == 1 else "-faces") if is_shared else ""
        if dimension == body.dimension:
            members = cell_group(index[frozenset(nodes)] for _, nodes in own)
        else:
            members = facet_group(own) if dimension == body.dimension - 1 else ends_of(own)
        groups[f"pid_{number}{suffix}"] = members
    return groups


def elements(dimension, tag):
    """Kind and nodes of the elements of an entity, in the order of VTK."""
    for number, _, nodes in zip(*gmsh.model.mesh.getElements(dimension, tag), strict=True):
        kind = KIND_OF[int(number)]
        for row in nodes.reshape(-1, KINDS[kind][1]).astype(int):
            own = np.empty_like(row)
            own[order(kind)] = row
            yield kind, tuple(own.tolist())


def to_vtk(corpus):
    for binary in (0, 1):
        way = f"gmsh/vtk-{'binary' if binary else 'ascii'}"
        for body in corpus.bodies(way):
            make_model(body)
            for tag in [tag for d, tag in gmsh.model.getPhysicalGroups(body.dimension) if gmsh.model.getPhysicalName(d, tag) == "some"]:
                gmsh.model.removePhysicalGroups([(body.dimension, tag)])
            set_options(Binary=binary)
            path = corpus.path(way, f"{body.name}.vtk")
            gmsh.write(str(path))
            if "pyramid13" in body.kinds:
                corpus.cannot(way, body.name, "Gmsh writes pyramids of 13 nodes as type 14, which has 5")
                continue
            groups = collections.defaultdict(dict)
            own = groups_of(body)
            for dimension, tag in gmsh.model.getPhysicalGroups():
                for kind, members in own[gmsh.model.getPhysicalName(dimension, tag)].items():
                    groups[f"CellEntityIds={tag}"].setdefault(kind, set()).update(members)
            if body.dimension == 1:
                groups["links"] = cell_group(range(len(body.cells)))
            corpus.file(way, path, wanted(body, dict(groups), 1e-12))


def write_all(corpus):
    import gmsh_made  # it needs this module

    gmsh.initialize(readConfigFiles=False)
    gmsh.option.setNumber("General.Verbosity", 1)
    for write in (to_msh, to_inp, to_bdf, to_vtk):
        write(corpus)
    gmsh_made.write_all(corpus)
    gmsh.finalize()
