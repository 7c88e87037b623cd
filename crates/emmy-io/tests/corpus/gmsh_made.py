"""Files of meshes that Gmsh makes: of order 1 and 2, of tetrahedra, wedges, bricks and plane cells; in parts."""

import collections
import itertools

import emmy
import gmsh
import numpy as np
from bodies import Body
from by_gmsh import KIND_OF, MSH, elements, set_options, volume, wanted, write_msh, writes
from wanted import groups_of


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


def make_shape(maker, recombine, dimension, order, incomplete):
    gmsh.clear()
    gmsh.model.add("made")
    set_options(
        ElementOrder=order,
        SecondOrderIncomplete=incomplete,
        RecombineAll=recombine,
        MeshSizeMax=0.7,
        MeshSizeMin=0.5,
        HighOrderOptimize=0,
    )
    maker()
    gmsh.model.occ.synchronize()
    tops = [tag for _, tag in gmsh.model.getEntities(dimension)]
    gmsh.model.addPhysicalGroup(dimension, tops, 7, "body")
    sides = [tag for _, tag in gmsh.model.getEntities(dimension - 1)]
    gmsh.model.addPhysicalGroup(dimension - 1, sides[:2], 7, "skin")
    # A name of cells and of facets.
    gmsh.model.addPhysicalGroup(dimension - 1, sides[:1], 9, "body")
    gmsh.model.addPhysicalGroup(0, [gmsh.model.getEntities(0)[0][1]], 3, "start")
    if dimension == 3:
        gmsh.model.addPhysicalGroup(1, [gmsh.model.getEntities(1)[0][1]], 4, "edge")
    gmsh.model.mesh.generate(dimension)


def as_body(name, dimension):
    """The model as a body."""
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
        rows = [
            (kind, tuple(index[node] for node in nodes))
            for entity in gmsh.model.getEntitiesForPhysicalGroup(own_dimension, tag)
            for kind, nodes in elements(own_dimension, entity)
        ]
        if own_dimension == dimension - 1:
            body.facet_groups[name] = rows
        elif own_dimension == 0:
            body.node_groups[name] = [nodes[0] for _, nodes in rows]
        elif own_dimension == 1:
            body.line_groups[name] = rows
    return body


def write_all(corpus):
    if corpus.only and corpus.only not in "gmsh/made":
        return
    # Order, and whether the cells have no nodes in the middle of faces.
    orders = [(1, 0), (2, 1), (2, 0)]
    for (name, maker, recombine, dimension), (order, incomplete) in itertools.product(shapes(), orders):
        make_shape(maker, recombine, dimension, order, incomplete)
        label = f"{name.replace(' ', '-')}-{order}{'-complete' if order == 2 and not incomplete else ''}"
        if {int(number) for number in gmsh.model.mesh.getElementTypes()} - KIND_OF.keys():
            path = corpus.path("gmsh/made-complete", f"{label}.msh")
            gmsh.write(str(path))
            corpus.refused("gmsh/made-complete", path, "set `Mesh.SecondOrderIncomplete = 1` before meshing")
            continue
        body = as_body(label, dimension)
        # Later there are ghost cells, too.
        known = volume()
        for variant in ["plain", "all", "parametric", "partitioned"]:
            if variant == "partitioned":
                set_options(PartitionCreateGhostCells=1, PartitionCreateTopology=0, PartitionSplitMeshFiles=0, PartitionCreatePhysicals=0)
                gmsh.model.mesh.partition(2)
            for version, binary in MSH:
                if not writes(version, binary) or version == 1.0 and variant == "partitioned":
                    continue
                if corpus.quick and (version, binary) not in [(2.2, 0), (4.1, 1)]:
                    continue
                if version == 1.0 and variant == "parametric":
                    corpus.cannot("gmsh/made", body.name, "Gmsh writes parameters into $NOD of the format 1, which has none")
                    continue
                way = f"gmsh/made-{variant}-{version}-{'binary' if binary else 'ascii'}"
                options = {"SaveAll": variant == "all", "SaveParametric": variant == "parametric"}
                # In older versions everything is saved without groups.
                groups = {} if variant == "all" and version < 4 else groups_of(body)
                write_msh(corpus, way, body, version, binary, groups, known, **options)
            if variant == "plain":
                corpus.check("gmsh/from_gmsh", body.name, wanted(body, groups_of(body)), lambda: emmy.Mesh.from_gmsh())
        set_options(SaveAll=0, SaveParametric=0)
