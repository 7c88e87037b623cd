"""Files of Gmsh: of given bodies, and of meshes that Gmsh makes."""

import collections
import itertools

import emmy
import gmsh
import numpy as np
from bodies import CORNER_PLACES, KINDS, Body, places
from wanted import cell_group, ends_of, facet_group, groups_of, node_group, of_body

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


def wanted(body, groups, tolerance=1e-12):
    right = of_body(body, groups, tolerance)
    # Its pyramids of 13 nodes have other functions inside.
    if body.dimension > 1 and "pyramid13" not in body.kinds:
        right.volume = volume()
    return right


def links(body):
    return list(body.cell_groups) if body.dimension == 1 else []


MSH = list(itertools.product([1.0, 2.0, 2.1, 2.2, 4.0, 4.1], [0, 1]))


def writes(version, binary):
    """Whether Gmsh has a version in binary form."""
    return not (binary and version in (1.0, 4.0))


def write_msh(corpus, way, body, version, binary, groups, **options):
    """Writes and compares a file."""
    set_options(MshFileVersion=version, Binary=binary, **options)
    path = corpus.path(way, f"{body.name}.msh")
    gmsh.write(str(path))
    if version == 1.0:
        # Groups have numbers alone there, the same one in several dimensions.
        numbers = {}
        for dimension, tag in gmsh.model.getPhysicalGroups():
            members = groups.get(gmsh.model.getPhysicalName(dimension, tag), {})
            for kind, own in members.items():
                numbers.setdefault(str(tag), {}).setdefault(kind, set()).update(own)
        groups = numbers
    corpus.file(way, path, wanted(body, groups), links=list(groups) if body.dimension == 1 else [])


def to_msh(corpus):
    for version, binary in MSH:
        way = f"gmsh/{version}-{'binary' if binary else 'ascii'}"
        if not writes(version, binary):
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
    if lacks(corpus, way, body, path):
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
        own = [number for number in range(len(body.cells)) if {name for name, cells in body.cell_groups.items() if number in cells} == set(of_entity)]
        groups[f"{names[body.dimension]}{tag}"] = cell_group(own)
    for rows, dimension in ((body.facet_groups, body.dimension - 1), (body.line_groups, 1)):
        for tag, name in zip([tag for _, tag in gmsh.model.getEntities(dimension)], rows, strict=False):
            # The node set of the name is not one of the entity.
            group = facet_group(rows[name]) if rows is body.facet_groups else groups_of(body)[name]
            groups[f"{names[dimension]}{tag}"] = group
    groups = {name.replace(" ", "_"): group for name, group in groups.items()}
    shells = "plane-strain" if body.dimension == 2 else None
    corpus.file(way, path, wanted(body, groups), shells=shells, links=list(groups) if body.dimension == 1 else [])


def lacks(corpus, way, body, path):
    """Whether cells of the body are not in a file of text: Gmsh leaves out those that the format has not."""
    text = path.read_text()
    count = sum(1 for line in text.splitlines() if line[:1].isdigit() or line[:1] == "C") if path.suffix == ".inp" else text.count("\nC")
    given = sum(len(own) for _, own, _ in (gmsh.model.mesh.getElements(d)[:3] for d in range(1, 4)) for own in own)
    missing = [kind for kind in body.kinds if not has(kind, path.suffix)]
    if missing:
        corpus.cannot(way, body.name, f"Gmsh leaves out {', '.join(sorted(missing))}")
    return bool(missing)


def has(kind, suffix):
    lacking = {".inp": ["quad9", "hex27", "pyramid5", "pyramid13"], ".bdf": ["quad9", "hex27", "pyramid13"]}
    return kind not in lacking[suffix]


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
            if lacks(corpus, way, body, path):
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


# Meshes that Gmsh makes.


def shapes():
    """Names and makers of models with the physical groups `body` and `skin`."""
    occ = gmsh.model.occ

    def tetrahedra():
        occ.addSphere(0, 0, 0, 1)
        occ.addBox(0, 0, 0, 2, 1, 1)
        occ.fuse([(3, 1)], [(3, 2)])

    def extruded(recombined):
        def make():
            disk = occ.addDisk(0, 0, 0, 1, 0.7)
            occ.extrude([(2, disk)], 0.2, 0, 1.1, numElements=[2], recombine=recombined)

        return make

    def revolved():
        rectangle = occ.addRectangle(1, 0, 0, 1, 1)
        occ.revolve([(2, rectangle)], 0, 0, 0, 0, 1, 0, 1.2, numElements=[4], recombine=True)

    def disk():
        occ.addDisk(0, 0, 0, 1, 0.7)

    return [
        ("sphere and box", tetrahedra, False, 3), ("wedges", extruded(True), False, 3), ("bricks", extruded(True), True, 3),
        ("revolved", revolved, True, 3), ("disk", disk, False, 2), ("recombined disk", disk, True, 2),
    ]  # fmt: skip


def make_shape(maker, recombine, dimension, quadratic, incomplete):
    gmsh.clear()
    gmsh.model.add("made")
    set_options(ElementOrder=2 if quadratic else 1, SecondOrderIncomplete=incomplete, RecombineAll=recombine, MeshSizeMax=0.7, MeshSizeMin=0.5, HighOrderOptimize=0)
    maker()
    gmsh.model.occ.synchronize()
    tops = [tag for _, tag in gmsh.model.getEntities(dimension)]
    gmsh.model.addPhysicalGroup(dimension, tops, 7, "body")
    sides = [tag for _, tag in gmsh.model.getEntities(dimension - 1)]
    gmsh.model.addPhysicalGroup(dimension - 1, sides[:2], 7, "skin")
    gmsh.model.addPhysicalGroup(0, [gmsh.model.getEntities(0)[0][1]], 3, "start")
    if dimension == 3:
        gmsh.model.addPhysicalGroup(1, [gmsh.model.getEntities(1)[0][1]], 4, "edge")
    gmsh.model.mesh.generate(dimension)


def as_body(name, dimension):
    """The model as a body, and the number of each node of Gmsh in it."""
    tags, points, _ = gmsh.model.mesh.getNodes()
    index = {int(tag): number for number, tag in enumerate(tags)}
    blocks = collections.defaultdict(list)
    for _, tag in gmsh.model.getEntities(dimension):
        for kind, nodes in elements(dimension, tag):
            blocks[kind].append([index[node] for node in nodes])
    body = Body(name, points.reshape(-1, 3), [(kind, np.array(rows)) for kind, rows in blocks.items()], {}, {}, {}, {})
    body.cell_groups = {"body": list(range(len(body.cells)))}
    for own_dimension, tag in gmsh.model.getPhysicalGroups():
        name = gmsh.model.getPhysicalName(own_dimension, tag)
        rows = [(kind, tuple(index[node] for node in nodes)) for entity in gmsh.model.getEntitiesForPhysicalGroup(own_dimension, tag) for kind, nodes in elements(own_dimension, entity)]
        if own_dimension == dimension - 1:
            body.facet_groups[name] = rows
        elif own_dimension == 0:
            body.node_groups[name] = [nodes[0] for _, nodes in rows]
        elif own_dimension == 1:
            body.line_groups[name] = rows
    return body


def made(corpus):
    if corpus.only and corpus.only not in "gmsh/made":
        return
    order_of = [(False, 0), (True, 1)]
    for (name, maker, recombine, dimension), (quadratic, incomplete) in itertools.product(shapes(), order_of):
        make_shape(maker, recombine, dimension, quadratic, incomplete)
        body = as_body(f"{name.replace(' ', '-')}-{2 if quadratic else 1}", dimension)
        for variant in ["plain", "all", "parametric", "partitioned"]:
            if variant == "partitioned":
                set_options(PartitionCreateGhostCells=1, PartitionCreateTopology=0, PartitionSplitMeshFiles=0, PartitionCreatePhysicals=0)
                gmsh.model.mesh.partition(2)
            for version, binary in MSH:
                if not writes(version, binary) or version == 1.0 and variant == "partitioned" or corpus.quick and (version, binary) not in [(2.2, 0), (4.1, 1)]:
                    continue
                way = f"gmsh/made-{variant}-{version}-{'binary' if binary else 'ascii'}"
                options = {"SaveAll": variant == "all", "SaveParametric": variant == "parametric"}
                # In older versions everything is saved without groups.
                groups = {} if variant == "all" and version < 4 else groups_of(body)
                write_msh(corpus, way, body, version, binary, groups, **options)
            if variant == "plain":
                corpus.check("gmsh/from_gmsh", body.name, wanted(body, groups_of(body)), lambda: emmy.Mesh.from_gmsh())
        set_options(SaveAll=0, SaveParametric=0)


def write_all(corpus):
    gmsh.initialize(readConfigFiles=False)
    gmsh.option.setNumber("General.Verbosity", 1)
    for write in (to_msh, to_inp, to_bdf, to_vtk, made):
        write(corpus)
    gmsh.finalize()
