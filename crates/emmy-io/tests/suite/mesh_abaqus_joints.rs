//! Masses, springs, dampers and connectors of Abaqus input, as tables of Emmy's.

use crate::mesh_abaqus_bodies::{BRICKS, assert_entry, assert_note, bricks};
use crate::meshes::parse_text;

/// Rigid ends of the bricks about the nodes 21 and 22.
const ENDS: &str = "*RIGID BODY, REF NODE=21, NSET=end\n*RIGID BODY, REF NODE=22, NSET=start\n";

fn is_left_out(file: &emmy_io::mesh::MeshFile, what: &str, which: &str, reason: &str) {
    assert_note(file, &format!("{what}: 1 is left out, though it may change the motion: {which} ({reason})"));
}

#[test]
fn masses_are_at_nodes_at_points_or_free() {
    let file = bricks(&format!(
        "{ENDS}*NODE\n31, 7, 8, 9\n*ELEMENT, TYPE=MASS, ELSET=lump\n51, 12\n52, 11\n53, 21\n54, 31\n*MASS, ELSET=lump\n2.5,\n\
         *ELEMENT, TYPE=ROTARYI, ELSET=turn\n61, 21\n62, 12\n63, 22\n*ROTARY INERTIA, ELSET=turn\n2., 3., 4., 0.1, 0.2, 0.3\n"
    ));
    assert_entry(&file, "mass-lump", "mass", "group = \"mass-lump-nodes\"\nmass = 2.5");
    assert_eq!(file.mesh.groups().nodes["mass-lump-nodes"].len(), 2);
    let table =
        "group = \"rigid-end\"\nmass = 2.5\ninertia = [[2.0, 0.1, 0.2], [0.1, 3.0, 0.3], [0.2, 0.3, 4.0]]";
    assert_entry(&file, "rigid-end-mass", "mass", table);
    assert_entry(&file, "mass-54", "rigid", "name = \"mass-54\"\nmass = 2.5\ncentre = [7.0, 8.0, 9.0]");
    assert_note(&file, "*MASS: 2 masses act: mass-lump, rigid-end-mass (mesh.leave_out switches them off)");
    assert_note(&file, "*MASS: 1 point mass acts: mass-54 (mesh.leave_out switches it off)");
    is_left_out(&file, "ROTARYI", "element 62", "a node of a cell has no rotation");
    is_left_out(&file, "ROTARYI", "element 63", "inertia without a mass");
    assert!(!file.notes.iter().any(|note| note.contains("belongs to no cell") || note.contains("1 MASS")));
}

#[test]
fn masses_that_are_left_out_are_named() {
    let file = bricks(
        "*ELEMENT, TYPE=MASS, ELSET=a\n51, 12\n*MASS, ELSET=a, TYPE=ANISOTROPIC\n1., 2., 3.\n*ELEMENT, TYPE=MASS, ELSET=b\n52, 12\n\
         *MASS, ELSET=b\nheavy\n*MASS, ELSET=none\n1.\n*ELEMENT, TYPE=MASS, ELSET=c\n53, 99\n*MASS, ELSET=c\n1.\n\
         *ELEMENT, TYPE=ROTARYI, ELSET=d\n54, 21\n*ROTARY INERTIA, ELSET=d\n1., 1., 9.\n",
    );
    assert_eq!(file.entries, []);
    is_left_out(&file, "MASS", "element 51", "the mass is not alike in x, y and z");
    is_left_out(&file, "MASS", "element 52", "its mass is not a number from 0 on");
    is_left_out(&file, "MASS", "element 53", "its node is not in the file");
    is_left_out(&file, "ROTARYI", "element 54", "no mass has such moments of inertia");
    assert_note(&file, "left out, though it may change the motion: 1 *MASS");
}

#[test]
fn inertia_turns_with_its_instance() {
    let text = format!(
        "*PART, NAME=P\n{BRICKS}*RIGID BODY, REF NODE=21, NSET=end\n*ELEMENT, TYPE=MASS, ELSET=m\n51, 21\n*MASS, ELSET=m\n1.\n\
         *ELEMENT, TYPE=ROTARYI, ELSET=r\n52, 21\n*ROTARY INERTIA, ELSET=r\n2., 3., 4.\n*END PART\n\
         *INSTANCE, NAME=P-1, PART=P\n0., 0., 0.\n0., 0., 0., 0., 0., 1., 90.\n*END INSTANCE\n"
    );
    let file = parse_text("a.inp", &text).unwrap();
    let table =
        "group = \"rigid-end\"\nmass = 1.0\ninertia = [[3.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 4.0]]";
    assert_entry(&file, "rigid-end-mass", "mass", table);
}

#[test]
fn a_rigid_body_without_cells_has_the_mass_of_its_reference_node() {
    let shell = "*NODE\n31, 5, 0, 0\n32, 6, 0, 0\n33, 6, 1, 0\n34, 5, 1, 0\n35, 5.5, 0.5, 0\n*ELEMENT, TYPE=R3D4, ELSET=plate\n\
                 71, 31, 32, 33, 34\n*RIGID BODY, REF NODE=35, ELSET=plate\n";
    let mass = "*ELEMENT, TYPE=MASS, ELSET=m\n51, 35\n*MASS, ELSET=m\n1.\n*ELEMENT, TYPE=ROTARYI, ELSET=r\n52, 35\n\
                *ROTARY INERTIA, ELSET=r\n2., 3., 4.\n*ELEMENT, TYPE=MASS, ELSET=n\n53, 32\n*MASS, ELSET=n\n4.\n";
    let file = bricks(&format!("{shell}{mass}"));
    let table = "name = \"rigid-plate\"\nmass = 1.0\ncentre = [5.5, 0.5, 0.0]\n\
                 inertia = [[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]]";
    assert_entry(&file, "rigid-plate", "rigid", table);
    // A mass at another node of the body is a point that is joined to it.
    assert_entry(&file, "mass-53", "rigid", "name = \"mass-53\"\nmass = 4.0\ncentre = [6.0, 0.0, 0.0]");
    let table = "name = \"mass-53-joint\"\n[spherical]\nbetween = [\"mass-53\", \"rigid-plate\"]\nat = [6.0, 0.0, 0.0]";
    assert_entry(&file, "mass-53-joint", "joint", table);
    let file = bricks(shell);
    let reason = "no node of it belongs to a cell, and its reference node has no mass";
    is_left_out(&file, "*RIGID BODY", "plate", reason);
}

#[test]
fn springs_are_joints_or_supports() {
    let file = bricks(&format!(
        "{ENDS}*ELEMENT, TYPE=SPRINGA, ELSET=axial\n51, 21, 22\n52, 1, 12\n*SPRING, ELSET=axial\n\n100.\n\
         *ELEMENT, TYPE=DASHPOTA, ELSET=damper\n53, 22, 21\n*DASHPOT, ELSET=damper\n,\n3.\n\
         *ELEMENT, TYPE=SPRING2, ELSET=along\n54, 2, 6\n*SPRING, ELSET=along\n3, 3\n7.\n\
         *ELEMENT, TYPE=SPRING2, ELSET=across\n55, 2, 6\n*SPRING, ELSET=across\n1, 1\n7.\n"
    ));
    let table = "name = \"axial-51\"\ndamping = 3.0\n[line]\nbetween = [\"rigid-end\", \"rigid-start\"]\n\
                 points = [[3.0, 0.5, 0.5], [-1.0, 0.5, 0.5]]\n[spring]\nstiffness = 100.0";
    assert_entry(&file, "axial-51", "joint", table);
    let table = "name = \"along-54\"\n[line]\nbetween = [\"node-2\", \"node-6\"]\npoints = [[1.0, 0.0, 0.0], [1.0, 0.0, 1.0]]\n\
                 [spring]\nstiffness = 7.0";
    assert_entry(&file, "along-54", "joint", table);
    let note = "*SPRING, *DASHPOT: 1 spring with a damper acts: axial-51 (mesh.leave_out switches it off)";
    assert_note(&file, note);
    is_left_out(&file, "SPRING2", "element 55", "it does not act along the line between its nodes");
    assert_eq!(file.entries.iter().filter(|entry| entry.section == "joint").count(), 3);
    let grounded: String = (1..=3)
        .map(|dof| format!("*ELEMENT, TYPE=SPRING1, ELSET=g{dof}\n6{dof}, 12\n7{dof}, 21\n*SPRING, ELSET=g{dof}\n{dof}\n5.\n"))
        .collect();
    let one = "*ELEMENT, TYPE=SPRING1, ELSET=one\n81, 9\n*SPRING, ELSET=one\n1\n5.\n*ELEMENT, TYPE=DASHPOT1, ELSET=two\n82, 9\n\
               *DASHPOT, ELSET=two\n1\n5.\n*ELEMENT, TYPE=SPRINGA, ELSET=three\n83, 1, 7\n*SPRING, ELSET=three, NONLINEAR\n0., 0.\n\
               1., 1.\n";
    let file = bricks(&format!("*RIGID BODY, REF NODE=21, NSET=start\n{grounded}{one}"));
    assert_entry(&file, "spring-g1", "support", "group = \"spring-g1-nodes\"\nspring = 5.0");
    assert_entry(&file, "rigid-start-spring", "support", "group = \"rigid-start\"\nspring = 5.0");
    is_left_out(&file, "SPRING1", "element 81", "springs to the ground that are not alike in x, y and z");
    is_left_out(&file, "DASHPOT1", "element 82", "it is a damper to the ground");
    is_left_out(&file, "SPRINGA", "element 83", "it is not linear");
}

#[test]
fn fixed_nodes_without_cells_are_the_ground() {
    let spring =
        "*ELEMENT, TYPE=SPRINGA, ELSET=s\n51, 12, 21\n*SPRING, ELSET=s\n\n100.\n*NSET, NSET=wall\n21\n";
    let table = "name = \"s-51\"\n[line]\nbetween = [\"node-12\", \"ground\"]\npoints = [[2.0, 1.0, 1.0], [3.0, 0.5, 0.5]]\n\
                 [spring]\nstiffness = 100.0";
    for fixed in ["wall, 1, 3", "21, 1, 2\n21, 3", "wall, ENCASTRE", "21, 1, 6, 0."] {
        let file = bricks(&format!("{spring}*BOUNDARY\n{fixed}\n"));
        assert_entry(&file, "s-51", "joint", table);
        let note = "*BOUNDARY: the node 21 without cells is fixed, and the ground of springs and joints";
        assert_note(&file, note);
        assert!(!file.notes.iter().any(|note| note.contains("wall")), "{:?}", file.notes);
    }
    for moved in ["wall, 1, 2", "wall, 1, 3, 0.5", "wall, XSYMM"] {
        let file = bricks(&format!("{spring}*BOUNDARY\n{moved}\n"));
        is_left_out(&file, "*SPRING", "element 51", "one of its nodes belongs to no cell, coupling or mass");
    }
}

#[test]
fn springs_that_are_links_stay_cells() {
    let text =
        "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n*ELEMENT, TYPE=SPRINGA, ELSET=s\n1, 1, 2\n*SPRING, ELSET=s\n\n100.\n";
    let file = parse_text("a.inp", text).unwrap();
    assert_eq!((file.mesh.n_cells(), file.entries.len()), (1, 0));
    assert_note(&file, "left out, though it may change the motion: 1 *SPRING");
}

/// The bricks with rigid ends and a connector between them, or from one to the ground.
fn connector(section: &str, nodes: &str, rest: &str) -> emmy_io::mesh::MeshFile {
    bricks(&format!(
        "{ENDS}*ORIENTATION, NAME=turned\n0., 0., 1., 0., 1., 0.\n*ELEMENT, TYPE=CONN3D2, ELSET=c\n51, {nodes}\n\
         *CONNECTOR SECTION, ELSET=c{section}\n{rest}"
    ))
}

#[test]
fn connectors_are_joints_with_the_axes_of_abaqus() {
    // Directions 1, 2 and 3 of the orientation: z, y and -x.
    let between = "between = [\"rigid-start\", \"rigid-end\"]\nat = [-1.0, 0.5, 0.5]";
    let axis = format!("{between}\naxis = [0.0, 0.0, 1.0]");
    let cases = [
        ("HINGE", "revolute", &axis),
        ("JOIN, REVOLUTE", "revolute", &axis),
        ("CYLINDRICAL", "cylindrical", &axis),
        ("TRANSLATOR", "prismatic", &axis),
        ("Slot, Align", "prismatic", &axis),
        ("PLANAR", "planar", &axis),
        ("SLOT", "inline", &axis),
        ("UJOINT", "universal", &format!("{between}\naxes = [[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]")),
        ("JOIN", "spherical", &between.to_string()),
        ("WELD", "fixed", &between.to_string()),
        ("BEAM", "fixed", &between.to_string()),
    ];
    for (kind, key, table) in cases {
        let file = connector("", "21, 22", &format!("{kind},\n\"turned\",\n"));
        assert_entry(&file, "c-51", "joint", &format!("name = \"c-51\"\n[{key}]\n{table}"));
        let kind = kind.to_uppercase();
        let note = format!("*CONNECTOR SECTION {kind}: 1 joint acts: c-51 (mesh.leave_out switches it off)");
        assert_note(&file, &note);
    }
    let file = connector("", ", 21", "HINGE\nturned\n");
    let table = "name = \"c-51\"\n[revolute]\nbetween = [\"rigid-end\", \"ground\"]\nat = [3.0, 0.5, 0.5]\naxis = [0.0, 0.0, 1.0]";
    assert_entry(&file, "c-51", "joint", table);
    // A node without cells that is fixed is the ground, too.
    let wall = "*NODE\n41, 3., 0.5, 0.5\n*BOUNDARY\n41, PINNED\n";
    let file = connector("", "41, 21", &format!("HINGE\nturned\n{wall}"));
    assert_entry(&file, "c-51", "joint", table);
    let file = connector("", "2, 7", "LINK\n");
    let table = "name = \"link-1\"\n[distance]\nbetween = [\"node-2\", \"node-7\"]\npoints = [[1.0, 0.0, 0.0], [1.0, 1.0, 1.0]]";
    assert_entry(&file, "link-1", "joint", table);
}

#[test]
fn behaviours_are_springs_and_dampers() {
    let of = |component: u8| {
        format!(
            "*CONNECTOR BEHAVIOR, NAME=soft\n*CONNECTOR ELASTICITY, COMPONENT={component}\n40.\n\
             *CONNECTOR DAMPING, COMPONENT={component}\n2.\n"
        )
    };
    let file = connector(", BEHAVIOR=soft", "21, 22", &format!("AXIAL\n{}", of(1)));
    let forces = "damping = 2.0\nspring = { stiffness = 40.0 }";
    let line = "between = [\"rigid-end\", \"rigid-start\"]\npoints = [[3.0, 0.5, 0.5], [-1.0, 0.5, 0.5]]";
    assert_entry(&file, "c-51", "joint", &format!("name = \"c-51\"\n{forces}\n[line]\n{line}"));
    let file = connector(", BEHAVIOR=soft", "21, 22", &format!("HINGE\nturned\n{}", of(4)));
    let hinge = "between = [\"rigid-start\", \"rigid-end\"]\nat = [-1.0, 0.5, 0.5]\naxis = [0.0, 0.0, 1.0]";
    assert_entry(&file, "c-51", "joint", &format!("name = \"c-51\"\n{forces}\n[revolute]\n{hinge}"));
    let file = connector(", BEHAVIOR=soft", "21, 22", &format!("HINGE\nturned\n{}", of(1)));
    assert_entry(&file, "c-51", "joint", &format!("name = \"c-51\"\n[revolute]\n{hinge}"));
    is_left_out(&file, "*CONNECTOR ELASTICITY", "line 39", "it is not in the coordinate of its joint");
}

#[test]
fn connectors_that_are_left_out_are_named() {
    let cases = [
        ("AXIAL\n", "21, 22", "it has no linear elasticity or damping along its line"),
        ("CARTESIAN\n", "21, 22", "its connection is not one of a joint"),
        ("HINGE\n", "21, 22", "it has no orientation at its first node"),
        ("HINGE\nnone\n", "21, 22", "its orientation is not in the file"),
        ("HINGE\nturned\n", "21, 1", "both of its nodes belong to one rigid body"),
        (
            "HINGE\nturned\n",
            "21, 2",
            "a node of it belongs to no coupling or rigid body, and has no directions",
        ),
        ("JOIN\n", "2, 3", "its nodes do not lie at one place"),
    ];
    for (data, nodes, reason) in cases {
        let nodes = if reason.starts_with("both") { "21, 9" } else { nodes };
        let file = connector("", nodes, data);
        let kind = data.lines().next().unwrap();
        is_left_out(&file, &format!("*CONNECTOR SECTION {kind}"), "element 51", reason);
        assert_eq!(file.entries.len(), 2, "{data}");
    }
}
