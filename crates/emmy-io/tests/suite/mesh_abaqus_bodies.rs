//! Rigid bodies, couplings, ties and equations of Abaqus input, as tables of Emmy's.

use crate::meshes::parse_text;
use emmy_io::mesh::{MeshFile, acting_entries};

/// Two bricks from x = 0 to x = 2; the nodes 21 and 22 belong to no cell.
pub(crate) const BRICKS: &str = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n9,2,0,0\n\
    10,2,1,0\n11,2,0,1\n12,2,1,1\n21,3,0.5,0.5\n22,-1,0.5,0.5\n*ELEMENT, TYPE=C3D8, ELSET=beam\n\
    1,1,2,3,4,5,6,7,8\n2,2,9,10,3,6,11,12,7\n*NSET, NSET=end\n9, 10, 11, 12\n*NSET, NSET=start\n1, 4, 5, 8\n\
    *SURFACE, NAME=tip\n2, S4\n*SURFACE, NAME=foot\n1, S6\n*SURFACE, NAME=end-nodes, TYPE=NODE\nend,\n";

pub(crate) fn bricks(text: &str) -> MeshFile {
    parse_text("a.inp", &format!("{BRICKS}{text}")).unwrap_or_else(|error| panic!("{error}"))
}

/// Asserts the only entry of a name.
pub(crate) fn assert_entry(file: &MeshFile, name: &str, section: &str, table: &str) {
    let found: Vec<_> = file.entries.iter().filter(|entry| entry.name == name).collect();
    let names: Vec<&str> = file.entries.iter().map(|entry| entry.name.as_str()).collect();
    assert_eq!(found.len(), 1, "{name} in {names:?}\n{:?}", file.notes);
    assert_eq!(found[0].section, section);
    assert_eq!(found[0].table, table.parse::<toml::Table>().unwrap(), "{}", found[0].table);
}

/// Notes of a file and on the entries that act.
pub(crate) fn all_notes(file: &MeshFile) -> Vec<String> {
    let (_, of_entries) = acting_entries(&file.entries, &file.mesh, &[]);
    [&of_entries[..], &file.notes].concat()
}

pub(crate) fn assert_note(file: &MeshFile, note: &str) {
    let notes = all_notes(file);
    assert!(notes.iter().any(|own| own == note), "{note}\n{notes:#?}");
}

fn places(file: &MeshFile, group: &str) -> Vec<[f64; 3]> {
    file.mesh.groups().nodes[group].iter().map(|&node| file.mesh.points()[node as usize]).collect()
}

/// The note on nodes without cells that nothing uses.
const UNUSED: &str = "1 node belongs to no cell and is left out";

#[test]
fn a_kinematic_coupling_is_rigid_and_a_distributing_one_follows_the_mean() {
    let file = bricks(
        "*COUPLING, CONSTRAINT NAME=\"Load 1\", REF NODE=21, SURFACE=tip\n*KINEMATIC\n1, 6\n\
         *COUPLING, CONSTRAINT NAME=mean, REF NODE=22, SURFACE=foot\n*DISTRIBUTING, WEIGHTING METHOD=LINEAR\n1, 3\n",
    );
    let rigid = "name = \"Load-1\"\ngroup = \"tip\"\npoint = [3.0, 0.5, 0.5]\nkind = \"rigid\"";
    assert_entry(&file, "Load-1", "coupling", rigid);
    let mean = "name = \"mean\"\ngroup = \"foot\"\npoint = [-1.0, 0.5, 0.5]\nkind = \"distributing\"";
    assert_entry(&file, "mean", "coupling", mean);
    assert_eq!(file.entries[0].card(), "*COUPLING Load 1");
    assert_eq!(
        all_notes(&file),
        [
            "*COUPLING: 1 rigid coupling acts: Load-1 (mesh.leave_out switches it off)",
            "mean is left out: coupling \"mean\": the nodes of \"foot\" lie in a plane, and the point [-1, 0.5, 0.5] is 1 \
             off; put it there, or couple it rigidly",
            "*COUPLING mean: WEIGHTING METHOD=LINEAR is not read, the weights are uniform"
        ]
    );
}

#[test]
fn couplings_of_nodes_have_their_weights() {
    let text = "*SURFACE, NAME=weighted, TYPE=NODE\n9, 2.0\n12, 1.0\n10, 3.0\n\
                *COUPLING, CONSTRAINT NAME=w, REF NODE=21, SURFACE=weighted\n*DISTRIBUTING\n";
    let file = bricks(text);
    // Nodes in ascending order: 9, 10, 12.
    let table = "name = \"w\"\ngroup = \"weighted\"\npoint = [3.0, 0.5, 0.5]\nkind = \"distributing\"\n\
                 weights = [2.0, 3.0, 1.0]";
    assert_entry(&file, "w", "coupling", table);
    assert_note(&file, UNUSED);
    let dcoup = "*ELEMENT, TYPE=DCOUP3D, ELSET=E1\n7, 22\n*DISTRIBUTING COUPLING, ELSET=E1\nstart, 1.\n5, 2.\n\
                 *KINEMATIC COUPLING, REF NODE=21\nend, 1, 3\n";
    let file = bricks(dcoup);
    let table = "name = \"coupling-E1\"\ngroup = \"coupling-E1-nodes\"\npoint = [-1.0, 0.5, 0.5]\nkind = \"distributing\"\n\
                 weights = [1.0, 1.0, 3.0, 1.0]";
    assert_entry(&file, "coupling-E1", "coupling", table);
    assert_eq!(
        places(&file, "coupling-E1-nodes"),
        [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0]]
    );
    let table = "name = \"kinematic-coupling-1\"\ngroup = \"end\"\npoint = [3.0, 0.5, 0.5]\nkind = \"rigid\"";
    assert_entry(&file, "kinematic-coupling-1", "coupling", table);
    assert!(!file.notes.iter().any(|note| note.contains("DCOUP3D") || note.contains("belongs to no cell")));
}

#[test]
fn rigid_bodies_have_a_reference_node_or_their_centre_of_mass() {
    let file = bricks(
        "*RIGID BODY, REF NODE=21, PIN NSET=end\n*RIGID BODY, REF NODE=22, TIE NSET=start, POSITION=CENTER OF MASS\n",
    );
    let table = "name = \"rigid-end\"\ngroup = \"end\"\npoint = [3.0, 0.5, 0.5]\nkind = \"rigid\"";
    assert_entry(&file, "rigid-end", "coupling", table);
    assert_entry(&file, "rigid-start", "rigid", "name = \"rigid-start\"\ngroup = \"start\"");
    let file = bricks("*RIGID BODY, REF NODE=21, ELSET=beam\n");
    let table = "name = \"rigid-beam\"\ngroup = \"beam\"\npoint = [3.0, 0.5, 0.5]\nkind = \"rigid\"";
    assert_entry(&file, "rigid-beam", "coupling", table);
    // Two bodies that share the node 9, and one whose reference node is a node of a cell that its set does not have.
    let file = bricks(
        "*RIGID BODY, REF NODE=21, NSET=end\n*NSET, NSET=others\n9, 2, 3\n*RIGID BODY, REF NODE=22, NSET=others\n\
         *NSET, NSET=left\n4, 5, 8\n*RIGID BODY, REF NODE=1, NSET=left\n",
    );
    let table =
        "name = \"rigid-end\"\ngroup = \"rigid-end-nodes\"\npoint = [3.0, 0.5, 0.5]\nkind = \"rigid\"";
    assert_entry(&file, "rigid-end", "coupling", table);
    assert_eq!(file.mesh.groups().nodes["rigid-end-nodes"].len(), 6);
    assert_note(&file, "*RIGID BODY: end, others share nodes and are one rigid body, rigid-end");
    let table =
        "name = \"rigid-left\"\ngroup = \"rigid-left-nodes\"\npoint = [0.0, 0.0, 0.0]\nkind = \"rigid\"";
    assert_entry(&file, "rigid-left", "coupling", table);
    assert_eq!(file.mesh.groups().nodes["rigid-left-nodes"].len(), 4);
}

#[test]
fn couplings_that_are_left_out_are_named_with_the_reason() {
    let file = bricks(
        "*COUPLING, CONSTRAINT NAME=a, REF NODE=99, SURFACE=tip\n*KINEMATIC\n\
         *COUPLING, CONSTRAINT NAME=b, REF NODE=21, SURFACE=none\n*KINEMATIC\n\
         *COUPLING, CONSTRAINT NAME=c, REF NODE=21, SURFACE=tip\n*KINEMATIC\n1, 1\n\
         *COUPLING, CONSTRAINT NAME=d, REF NODE=21, SURFACE=tip\n*RIGID BODY, REF NODE=22, ANALYTICAL SURFACE=x\n\
         *RIGID BODY, REF NODE=22, NSET=none\n*NSET, NSET=edge\n1, 4\n*RIGID BODY, REF NODE=22, NSET=edge\n",
    );
    assert_eq!(file.entries, []);
    let notes = [
        "*COUPLING: 1 IS: a (the reference node is not in the file, or not one node)",
        "*COUPLING: 1 IS: b (its surface is not in the file, or is empty)",
        "*COUPLING: 1 IS: c (not all of x, y and z are coupled)",
        "*COUPLING: 1 IS: d (neither *KINEMATIC nor *DISTRIBUTING follows it)",
        "*RIGID BODY: 1 IS: line 37 (an analytical surface without nodes)",
        "*RIGID BODY: 1 IS: none (its set is not in the file, or is empty)",
        "*RIGID BODY: 1 IS: edge (its nodes of cells lie on one line)",
    ];
    notes.iter().for_each(|note| {
        assert_note(&file, &note.replace(": 1 IS: ", ": 1 is left out, though it may change the motion: "))
    });
}

#[test]
fn cards_of_instances_have_placed_points_and_qualified_groups() {
    let text = format!(
        "*PART, NAME=P\n{BRICKS}*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=P-1, PART=P\n*END INSTANCE\n\
         *INSTANCE, NAME=P-2, PART=P\n5., 0., 0.\n*END INSTANCE\n*NODE\n1, 9, 0, 0\n*NSET, NSET=RP\n1\n\
         *NSET, NSET=_set, INTERNAL, INSTANCE=P-2\nend\n*SURFACE, NAME=_tip, TYPE=NODE, INTERNAL\n_set,\n\
         *COUPLING, CONSTRAINT NAME=c, REF NODE=RP, SURFACE=_tip\n*KINEMATIC\n\
         *TIE, NAME=t\nP-1.tip, P-2.foot\n*END ASSEMBLY\n"
    );
    let file = parse_text("a.inp", &text).unwrap();
    let table = "name = \"c\"\ngroup = \"c-nodes\"\npoint = [9.0, 0.0, 0.0]\nkind = \"rigid\"";
    assert_entry(&file, "c", "coupling", table);
    assert!(places(&file, "c-nodes").iter().all(|place| place[0] == 7.0));
    assert_entry(&file, "t", "tie", "follower = \"P-1.tip\"\nleader = \"P-2.foot\"\npartial = true");
    assert!(!file.mesh.groups().names().contains(&"_tip"));
    // A card of the part acts in both of its instances.
    let part = text.replace("*END PART\n", "*RIGID BODY, REF NODE=21, NSET=end\n*END PART\n");
    let file = parse_text("a.inp", &part.replace("*COUPLING", "*COUPLINGX")).unwrap();
    let table = "name = \"rigid-end\"\ngroup = \"P-1.end\"\npoint = [3.0, 0.5, 0.5]\nkind = \"rigid\"";
    assert_entry(&file, "rigid-end", "coupling", table);
    let table = "name = \"rigid-end-2\"\ngroup = \"P-2.end\"\npoint = [8.0, 0.5, 0.5]\nkind = \"rigid\"";
    assert_entry(&file, "rigid-end-2", "coupling", table);
}

#[test]
fn ties_are_of_surfaces_or_of_nodes() {
    let file = bricks(
        "*TIE, NAME=t, POSITION TOLERANCE=0.1\ntip, foot\n*TIE, TYPE=NODE TO SURFACE\ntip, foot\n\
         *TIE, NAME=nodes\nend-nodes, foot\n*TIE, NAME=half\ntip\n*TIE, NAME=far, TIED NSET=end\ntip, foot\n\
         *TIE, NAME=turn, CYCLIC SYMMETRY\ntip, foot\n*TIE, NAME=none\ntip, no\n",
    );
    assert_entry(&file, "t", "tie", "follower = \"tip\"\nleader = \"foot\"\npartial = true");
    assert_entry(
        &file,
        "tie-1",
        "tie",
        "follower = \"tip\"\nleader = \"foot\"\npartial = true\nkind = \"nodes\"",
    );
    assert_entry(
        &file,
        "nodes",
        "tie",
        "follower = \"end-nodes\"\nleader = \"foot\"\npartial = true\nkind = \"nodes\"",
    );
    assert_eq!(file.entries.len(), 3);
    assert_note(&file, "*TIE: 3 ties act: t, tie-1, nodes (mesh.leave_out switches them off)");
    assert_note(
        &file,
        "*TIE: POSITION TOLERANCE is not read: `tolerance` is relative to the edges of the leader, here 0.05",
    );
    let left_out = |name: &str, reason: &str| {
        assert_note(
            &file,
            &format!("*TIE: 1 is left out, though it may change the motion: {name} ({reason})"),
        );
    };
    left_out("half", "it names one surface alone");
    left_out("far", "only some of its nodes are tied (TIED NSET)");
    left_out("turn", "a tie of another kind (symmetry or a fluid)");
    left_out("none", "a surface is not in the file");
}

#[test]
fn beams_pins_and_links_of_mpc() {
    let file = bricks("*MPC\nBEAM, end, 21\nLINK, 1, 7\nPLANE, 1, 2, 3, 4\nPIN, 1, 2\n");
    let table =
        "name = \"mpc-beam-1\"\ngroup = \"mpc-beam-1-nodes\"\npoint = [3.0, 0.5, 0.5]\nkind = \"rigid\"";
    assert_entry(&file, "mpc-beam-1", "coupling", table);
    let table = "name = \"link-1\"\n[distance]\nbetween = [\"node-1\", \"node-7\"]\n\
                 points = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]";
    assert_entry(&file, "link-1", "joint", table);
    assert_eq!((places(&file, "node-1"), places(&file, "node-7")), (vec![[0.0; 3]], vec![[1.0; 3]]));
    assert_note(&file, "*MPC BEAM: 1 rigid coupling acts: mpc-beam-1 (mesh.leave_out switches it off)");
    assert_note(
        &file,
        "*MPC PLANE: 1 is left out, though it may change the motion: line 32 (it is not PIN, TIE, LINK or BEAM)",
    );
    assert_note(
        &file,
        "*MPC PIN: 1 is left out, though it may change the motion: line 33 (its nodes do not lie at one place)",
    );
    // A single beam between nodes of cells is a rigid link.
    let file = bricks("*MPC\nBEAM, 1, 7\n");
    assert_note(
        &file,
        "*MPC BEAM: 1 rigid link in the place of a beam acts: link-1 (mesh.leave_out switches it off)",
    );
    // A beam to the reference node of a coupling joins its body.
    let file = bricks("*RIGID BODY, REF NODE=21, NSET=end\n*MPC\nBEAM, 22, 21\nBEAM, 1, 22\n");
    assert_eq!((file.entries.len(), places(&file, "rigid-end-nodes").len()), (1, 5));
    // Another brick at one place with the end of the second one.
    let brick = "*NODE\n101,2,0,0\n102,3,0,0\n103,3,1,0\n104,2,1,0\n105,2,0,1\n106,3,0,1\n107,3,1,1\n108,2,1,1\n\
                 *ELEMENT, TYPE=C3D8\n3,101,102,103,104,105,106,107,108\n";
    let file = bricks(&format!("{brick}*NSET, NSET=others\n101, 104, 105, 108\n*MPC\nTIE, end, others\n"));
    let table = "follower = \"mpc-1-nodes\"\nleader = \"mpc-1-leaders\"\nkind = \"nodes\"";
    assert_entry(&file, "mpc-1", "tie", table);
    assert_eq!(places(&file, "mpc-1-nodes").len(), 4);
    assert_note(&file, "*MPC TIE: 1 tie of nodes at one place acts: mpc-1 (mesh.leave_out switches it off)");
    let file = bricks(&format!("{brick}*RIGID BODY, REF NODE=22, NSET=end\n*MPC\nPIN, 9, 101\n"));
    let table =
        "name = \"mpc-1\"\n[spherical]\nbetween = [\"rigid-end\", \"node-101\"]\nat = [2.0, 0.0, 0.0]";
    assert_entry(&file, "mpc-1", "joint", table);
}

/// Equations for x, y and z.
fn equations(terms: &str) -> String {
    let n = terms.split(';').count();
    let of = |dof: u32| {
        let terms: Vec<String> = terms.split(';').map(|term| term.replace("dof", &dof.to_string())).collect();
        format!("*EQUATION\n{n}\n{}\n", terms.join(", "))
    };
    [1, 2, 3].map(of).concat()
}

#[test]
fn equations_of_a_weighted_mean_are_ties() {
    // A node of another brick in the middle of the edge from 9 to 10, a quarter of the way from 11.
    let brick = "*NODE\n101,2,0.25,0\n102,3,0,0\n103,3,1,0\n104,2,1,0\n105,2,0,1\n106,3,0,1\n107,3,1,1\n108,2,1,1\n\
                 *ELEMENT, TYPE=C3D8\n3,101,102,103,104,105,106,107,108\n";
    let good = equations("101, dof, 1.0; 9, dof, -0.75; 10, dof, -0.25")
        + &equations("104, dof, -2.0; 10, dof, 2.0");
    let file = bricks(&format!("{brick}{good}"));
    let table = "follower = \"equation-1-nodes\"\nleader = \"equation-1-leaders\"\nweights = [0.75, 0.25]";
    assert_entry(&file, "equation-1", "tie", table);
    assert_eq!(places(&file, "equation-1-nodes"), [[2.0, 0.25, 0.0]]);
    assert_eq!(places(&file, "equation-1-leaders"), [[2.0, 0.0, 0.0], [2.0, 1.0, 0.0]]);
    let table = "follower = \"equation-2-nodes\"\nleader = \"equation-2-leaders\"\nkind = \"nodes\"";
    assert_entry(&file, "equation-2", "tie", table);
    assert_note(&file, "*EQUATION: 1 tie by weights acts: equation-1 (mesh.leave_out switches it off)");
    assert!(!file.notes.iter().any(|note| note.contains("*EQUATION") && note.contains("left out")));
    let bad = equations("101, dof, 1.0; 9, dof, -0.5; 10, dof, -0.5")
        + "*EQUATION\n2\n12, 1, 1., 11, 1, -1.\n*EQUATION\n2\n12, 2, 1., end, 2, -1.\n*EQUATION\n3\n1, 1, 1.\n"
        + &equations("102, dof, 1.0; 9, dof, -0.5");
    let file = bricks(&format!("{brick}{bad}"));
    assert_eq!(file.entries, []);
    let notes = [
        "3 are left out, though they may change the motion: line 41, line 44, line 47 (its node does not lie at the \
         weighted mean of the others)",
        "1 is left out, though it may change the motion: line 50 (not of one node in x, y and z with the same weights)",
        "1 is left out, though it may change the motion: line 53 (a set of several nodes)",
        "1 is left out, though it may change the motion: line 56 (it has another number of terms than it says)",
        "3 are left out, though they may change the motion: line 59, line 62, line 65 (its weights do not sum to one)",
    ];
    notes.iter().for_each(|note| assert_note(&file, &format!("*EQUATION: {note}")));
}

#[test]
fn equations_may_stand_in_a_file_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let main = folder.path().join("main.inp");
    std::fs::write(&main, format!("{BRICKS}*EQUATION, INPUT=eq.txt\n*EQUATION, INPUT=none.txt\n")).unwrap();
    std::fs::write(folder.path().join("eq.txt"), "2\n12, 1, 1., 11, 1, -1.\n").unwrap();
    let file = emmy_io::mesh::read(&main).unwrap();
    let note = "*EQUATION: 1 is left out, though it may change the motion: eq.txt, line 1 (not of one node in x, y and z \
                with the same weights)";
    assert_note(&file, note);
    assert!(file.notes.iter().any(|note| note.contains("line 30: *EQUATION is left out: there is no file")));
    assert_eq!(file.files.len(), 2);
}

#[test]
fn a_group_of_a_reference_node_has_a_note_with_the_name_of_its_point() {
    let file =
        bricks("*NSET, NSET=RP\n21\n*COUPLING, CONSTRAINT NAME=c, REF NODE=RP, SURFACE=tip\n*KINEMATIC\n");
    assert_note(&file, "node group \"RP\" has no node of a cell: it is the point of c");
}

#[test]
fn a_name_of_a_group_is_not_taken_twice() {
    let file =
        bricks("*COUPLING, CONSTRAINT NAME=tip, REF NODE=21, SURFACE=tip\n*KINEMATIC\n*NSET, NSET=tip\n9\n");
    let table = "name = \"tip-2\"\ngroup = \"facets:tip\"\npoint = [3.0, 0.5, 0.5]\nkind = \"rigid\"";
    assert_entry(&file, "tip-2", "coupling", table);
}
