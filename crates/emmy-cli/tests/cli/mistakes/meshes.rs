//! Meshes, built in and from files.

use super::{FIX, MESH, Mistake, changed};

/// A change of the built-in mesh.
fn built_in(name: &str, to: &str) -> Mistake {
    changed(name, MESH, to)
}

/// A mesh file with a text instead of the built-in mesh.
fn file(name: &str, file: &'static str, text: impl Into<Vec<u8>>) -> Mistake {
    changed(name, MESH, &format!("file = \"{file}\"")).beside(file, text).unseen()
}

const NODES: &str = "*Node\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n5, 0, 0, -1\n";
const LOAD: &str =
    "[[load]]\ngroup = \"y-max\"\ntraction = [0.0, 0.0, 10.0]\nhistory = [[0.0, 0.0], [0.5, 1.0]]\n\n";
const GMSH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const GMSH_NODES: &str = "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";

/// A tetrahedron with the group `slope` of its oblique face.
const SLOPE: &str = "*Element, type=C3D4, elset=body\n1, 1, 2, 3, 4\n*Surface, name=slope\n1, S3\n";

fn abaqus(name: &str, elements: &str) -> Mistake {
    file(name, "part.inp", format!("{NODES}{elements}"))
}

fn gmsh(name: &str, rest: &str) -> Mistake {
    file(name, "part.msh", format!("{GMSH}{rest}"))
}

fn nastran(name: &str, cards: &str) -> Mistake {
    let nodes = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\n";
    file(name, "part.bdf", format!("{nodes}{cards}"))
}

fn vtu(name: &str, text: &str) -> Mistake {
    file(name, "part.vtu", text)
}

pub(super) const NETWORK: &str = "network = { points = [[0, 0, 0], [0, 1, 0]], links = [[0, 1]] }";

pub(super) fn all() -> Vec<Mistake> {
    [built_ins(), round_shapes(), parts(), formats(), contents()].into_iter().flatten().collect()
}

fn built_ins() -> Vec<Mistake> {
    let network = |name: &str, from: &str, to: &str| built_in(name, &NETWORK.replacen(from, to, 1));
    vec![
        built_in("two-meshes", &format!("{MESH}\nl-block = {{ cell_size = 1 }}")),
        built_in("no-mesh", ""),
        built_in("mesh-misspelt", "bocks = { size = [1, 2, 1], cells = [1, 2, 1] }"),
        built_in("negative-edge", "box = { size = [1, -2, 1], cells = [1, 2, 1] }"),
        built_in("no-cells", "box = { size = [1, 2, 1], cells = [1, 0, 1] }"),
        built_in("half-a-cell", "box = { size = [1, 2, 1], cells = [1, 2.5, 1] }"),
        built_in("more-cells-than-memory", "box = { size = [1, 2, 1], cells = [100000, 100000, 1] }")
            .unseen(),
        built_in("box-in-the-plane", "box = { size = [1, 2], cells = [1, 2] }"),
        built_in("cells-that-do-not-fit", "l-block = { cell_size = 0.3 }").unseen(),
        built_in("rectangle-in-space", "rectangle = { size = [1, 2, 1], cells = [1, 2] }"),
        built_in("rectangle-without-height", "rectangle = { size = [1, 0], cells = [1, 2] }"),
        built_in("rectangle-without-cells", "rectangle = { size = [1, 1], cells = [1, 0] }"),
        built_in("rectangle-misspelt", "rectangel = { size = [1, 1], cells = [1, 1] }"),
        built_in("key-of-a-rectangle-misspelt", "rectangle = { siez = [1, 1], cells = [1, 1] }"),
        built_in("cells-misspelt", &MESH.replacen("cells", "cels", 1)),
        built_in("l-block-of-more-cells-than-memory", "l-block = { cell_size = 1e-9 }").unseen(),
        built_in("mesh-built-in-and-from-a-file", "l-block.cell_size = 1\nfile = \"a.msh\""),
        built_in("mesh-file-missing-and-none-like-it", "file = \"none.msh\"").unseen(),
        changed("no-source-of-a-mesh", &format!("{MESH}\n"), ""),
        changed("scale-of-zero", "[[region]]", "scale = 0.0\n[[region]]"),
        built_in("scale-of-nothing", &format!("{MESH}\nscale = 0")),
        network("link-to-nowhere", "[[0, 1]]", "[[0, 2]]").unseen(),
        network("link-to-itself", "[[0, 1]]", "[[1, 1]]").unseen(),
        network("no-links", "[[0, 1]]", "[]"),
        network("group-of-points-that-are-not-there", "links =", "groups = { end = [7] }, links =").unseen(),
        built_in("links-of-a-solid-material", NETWORK)
            .with(&["--set", "region.0.group=links", "--set", "support=[]", "--set", "load=[]"])
            .unseen(),
    ]
}

fn round_shapes() -> Vec<Mistake> {
    let ring = |name: &str, radii: &str, cells: &str| {
        built_in(name, &format!("ring = {{ {radii}, height = 1, cells = {cells} }}"))
    };
    vec![
        ring("ring-without-a-wall", "inner = 2, outer = 2", "[1, 8, 1]").unseen(),
        ring("ring-with-a-negative-radius", "inner = -1, outer = 2", "[1, 8, 1]"),
        ring("ring-of-two-cells-around", "inner = 1, outer = 2", "[1, 2, 1]").unseen(),
        ring("ring-without-cells-around", "inner = 1, outer = 2", "[1, 0, 1]"),
        ring("ring-of-more-cells-than-memory", "inner = 1, outer = 2", "[1000, 1000, 1000]").unseen(),
        ring("ring-with-a-radius", "radius = 2", "[1, 8, 1]"),
        built_in("cylinder-without-height", "cylinder = { radius = 1, cells = [2, 2] }"),
        built_in("cylinder-of-height-zero", "cylinder = { radius = 1, height = 0, cells = [2, 2] }"),
        built_in("cylinder-with-three-numbers", "cylinder = { radius = 1, height = 1, cells = [2, 8, 2] }"),
        built_in("cylinder-of-many-cells", "cylinder = { radius = 1, height = 1, cells = [9999, 9] }")
            .unseen(),
        built_in("ball-with-a-list", "ball = { radius = 1, cells = [4, 4, 4] }"),
        built_in("ball-without-cells", "ball = { radius = 1, cells = 0 }"),
        built_in("ball-of-more-cells-than-memory", "ball = { radius = 1, cells = 1000 }").unseen(),
        built_in("ball-called-sphere", "sphere = { radius = 1, cells = 4 }"),
    ]
}

/// Two boxes as parts, with keys of the second.
fn two_boxes(second: &str) -> String {
    let cube = "box = { size = [1, 1, 1], cells = [1, 1, 1] }";
    format!("parts = [\n    {{ name = \"left\", {cube} }},\n    {{ {second}, {cube} }},\n]")
}

fn parts() -> Vec<Mistake> {
    let second = |name: &str, keys: &str| built_in(name, &two_boxes(keys));
    let after = |name: &str, keys: &str, rest: &str| built_in(name, &format!("{}\n{rest}", two_boxes(keys)));
    let parts = |name: &str, all: &str| built_in(name, &format!("parts = [{all}]"));
    let plane = "rectangle = { size = [1, 1], cells = [1, 1] }";
    vec![
        parts("no-parts", ""),
        built_in("part-without-brackets", "parts = { name = \"a\", ball = { radius = 1, cells = 1 } }"),
        parts("part-without-a-source", "{ name = \"a\" }"),
        parts("part-with-two-sources", &format!("{{ name = \"a\", {plane}, file = \"a.msh\" }}")),
        parts("part-in-a-part", "{ name = \"a\", parts = [] }"),
        parts("part-without-a-name", &format!("{{ {plane} }}")),
        second("part-with-an-empty-name", "name = \"\""),
        second("part-with-a-blank-in-its-name", "name = \"right arm\"").unseen(),
        second("part-named-twice", "name = \"left\"").unseen(),
        second("part-named-as-a-group", "name = \"left-x-max\"").unseen(),
        second("part-turned-about-nothing", "name = \"a\", turn = { axis = [0, 0, 0], angle = 1 }").unseen(),
        second("part-turned-without-an-angle", "name = \"a\", turn = { axis = [0, 0, 1] }"),
        second("part-turned-by-a-number", "name = \"a\", turn = 90"),
        second("part-shifted-in-the-plane", "name = \"a\", at = [1, 0]"),
        second("part-shifted-by-a-wrong-key", "name = \"a\", shift = [1, 0, 0]"),
        second("part-of-no-size", "name = \"a\", scale = 0"),
        second("part-too-far", "name = \"a\", at = [1e60, 0, 0]").unseen(),
        parts("part-whose-file-is-missing", "{ name = \"a\", file = \"prat.msh\" }").beside("part.msh", "").unseen(),
        parts("part-whose-file-is-damaged", "{ name = \"a\", file = \"part.msh\" }")
            .beside("part.msh", format!("{GMSH}$Nodes\n4\n1 0 0 0\n2 1 0"))
            .unseen(),
        parts(
            "parts-of-more-cells-than-memory",
            "\n    { name = \"a\", ball = { radius = 1, cells = 90 } },\n    { name = \"b\", ball = { radius = 1, cells \
             = 140 } },\n    { name = \"c\", ball = { radius = 1, cells = 120 } },\n",
        )
        .unseen(),
        parts(
            "parts-in-plane-strain-and-solid",
            &format!("{{ name = \"a\", ball = {{ radius = 1, cells = 1 }} }}, {{ name = \"b\", {plane} }}"),
        )
        .unseen(),
        parts(
            "parts-in-two-planes",
            &format!("{{ name = \"a\", {plane} }}, {{ name = \"b\", {plane}, at = [0, 0, 1] }}"),
        )
        .unseen(),
        parts(
            "part-turned-out-of-its-plane",
            &format!("{{ name = \"a\", {plane}, turn = {{ axis = [1, 0, 0], angle = 0.1 }} }}"),
        )
        .unseen(),
        second("group-of-a-part-misspelt", "name = \"right\"")
            .and("group = \"body\"", "group = \"rigth\"")
            .and("group = \"y-max\"", "group = \"right-y-mx\"")
            .and("group = \"y-min\"", "group = \"left-y-min\"")
            .unseen(),
        after("parts-on-top-of-each-other", "name = \"a\"", "merge = 1e-6").unseen(),
        after("shells-of-built-in-parts", "name = \"a\"", "shells = \"plane-strain\"").unseen(),
        after("entries-of-built-in-parts", "name = \"a\"", "leave_out = [\"a-rbe2_1\"]")
            .and("group = \"body\"", "group = \"a\"")
            .unseen(),
    ]
}

/// Files that are missing, of another format, or cut off.
fn formats() -> Vec<Mistake> {
    vec![
        built_in("mesh-file-missing", "file = \"prat.msh\"").beside("part.msh", "").unseen(),
        built_in("mesh-file-without-its-suffix", "file = \"part\"").beside("part.msh", "").unseen(),
        built_in("mesh-file-that-is-a-folder", "file = \".\"").unseen(),
        file("mesh-of-another-format", "part.stl", "solid part\n"),
        file("mesh-of-a-cad-program", "part.step", "ISO-10303-21;\n"),
        file("mesh-of-nastran-without-cells", "part.bdf", "$ Nastran\n"),
        nastran("nastran-in-another-system", "GRID,5,3,1.,0.,0.\n"),
        nastran("nastran-with-too-few-nodes", "CHEXA,1,1,1,2,3,4\n"),
        nastran("nastran-with-a-node-that-is-not-there", "CTETRA,1,1,1,2,3,9\n"),
        nastran("nastran-with-a-coordinate-that-is-none", "GRID,5,,1.,x,0.\n"),
        nastran("nastran-of-bars", "CBAR,1,1,1,2\n"),
        nastran("nastran-of-masses", "CONM2,1,1,,2.5\n"),
        nastran("nastran-of-shells", "CTRIA3,1,7,1,2,3\nPSHELL,7,1,.1\n"),
        nastran("nastran-with-an-unknown-solid", "CHEX8,1,1,1,2,3,4\n"),
        nastran("nastran-in-two-files", "INCLUDE 'part2.bdf'\n"),
        file("mesh-of-salome", "part.med", "HDF"),
        file("mesh-of-cgns", "part.cgns", "CDF"),
        file("results-of-nastran", "part.op2", "XXXX"),
        file("mesh-of-an-older-vtk", "part.vtk", "# vtk DataFile Version 2.0\n"),
        file("mesh-file-empty", "part.msh", ""),
        file("mesh-file-of-zeros", "part.msh", [0u8; 64]),
        file("gmsh-script", "part.geo", "Point(1) = {0, 0, 0, 1};\n"),
        file("gmsh-of-an-old-version", "part.msh", "$MeshFormat\n3 0 8\n$EndMeshFormat\n"),
        gmsh("gmsh-cut-off", "$Nodes\n4\n1 0 0 0\n2 1 0"),
        gmsh("gmsh-with-a-count-that-lies", "$Nodes\n4000000000\n1 0 0 0\n$EndNodes\n"),
        gmsh("gmsh-without-elements", GMSH_NODES),
        vtu("vtu-cut-off", "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece "),
        vtu("vtu-of-another-kind", "<VTKFile type=\"ImageData\"><ImageData/></VTKFile>"),
        vtu(
            "vtu-by-another-compressor",
            "<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkLZ4DataCompressor\">\
            <UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"1\"/></UnstructuredGrid></VTKFile>",
        ),
    ]
}

/// Invalid files.
fn contents() -> Vec<Mistake> {
    let tet = "$Elements\n1\n1 4 2 1 1 1 2 3 9\n$EndElements\n";
    vec![
        abaqus("cell-inverted", "*Element, type=C3D4, elset=body\n1, 1, 2, 3, 4\n2, 2, 4, 5, 1\n"),
        abaqus(
            "cell-inverted-without-loads",
            "*Element, type=C3D4, elset=body\n1, 1, 2, 3, 4\n2, 2, 4, 5, 1\n",
        )
        .and("y-min", "body")
        .and(LOAD, ""),
        abaqus("oblique-plane-of-symmetry", SLOPE)
            .and(FIX, "symmetry = true")
            .and("y-min", "slope")
            .and(LOAD, ""),
        abaqus("cell-twice", "*Element, type=C3D4, elset=body\n1, 1, 2, 3, 4\n2, 1, 2, 3, 4\n"),
        abaqus("element-number-twice", "*Element, type=C3D4, elset=body\n1, 1, 2, 3, 4\n1, 1, 3, 2, 5\n"),
        abaqus("element-with-too-few-nodes", "*Element, type=C3D4, elset=body\n1, 1, 2, 3\n"),
        abaqus("element-of-a-shell", "*Element, type=S4R, elset=body\n1, 1, 2, 3, 4\n"),
        abaqus(
            "set-of-elements-that-are-not-there",
            "*Element, type=C3D4, elset=body\n1, 1, 2, 3, 4\n*Elset, elset=left\n7\n",
        ),
        abaqus("include-that-is-not-there", "*Include, input=elements.inp\n"),
        abaqus("no-nodes-in-a-coordinate", "*Node\n6, 0, nan, 0\n"),
        gmsh("node-that-is-not-there", &format!("{GMSH_NODES}{tet}")),
        gmsh(
            "elements-of-high-order",
            &format!(
                "{GMSH_NODES}$Elements\n1\n1 29 2 1 1 1 2 3 4 1 2 3 4 1 2 3 4 1 2 3 4 1 2 3 4\n$EndElements\n"
            ),
        ),
        gmsh(
            "surfaces-without-a-volume",
            &format!("{GMSH_NODES}$Elements\n2\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 2 4\n$EndElements\n"),
        ),
        gmsh("groups-without-names", &format!("{GMSH_NODES}$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n")),
    ]
}
