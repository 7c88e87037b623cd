//! Rigid elements and equations of Nastran files, as tables of the input.

use std::collections::BTreeSet;

use crate::mesh_abaqus_bodies::all_notes;
use crate::meshes::parse_text;
use emmy_io::mesh::{DeckEntry, MeshFile};

/// Two cubes side by side, and a tetrahedron apart, whose node 31 lies where 7 does. Grid point n has index n - 1;
/// those of the tetrahedron, 31 to 34, have 12 to 15.
pub(crate) const BLOCK: &str = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\n\
    GRID,5,,0.,0.,1.\n\
    GRID,6,,1.,0.,1.\nGRID,7,,1.,1.,1.\nGRID,8,,0.,1.,1.\nGRID,9,,2.,0.,0.\nGRID,10,,2.,1.,0.\nGRID,11,,2.,0.,1.\n\
    GRID,12,,2.,1.,1.\nGRID,31,,1.,1.,1.\nGRID,32,,3.,1.,1.\nGRID,33,,1.,3.,1.\nGRID,34,,1.,1.,3.\n\
    CHEXA,1,1,1,2,3,4,5,6\n,7,8\nCHEXA,2,1,2,9,10,3,6,11\n,12,7\nCTETRA,3,2,31,32,33,34\n";

/// A note of the block: node 31.
const COINCIDENT: &str =
    "1 node lies where another one does, the first at [1, 1, 1]: cells on both sides are not joined there";

pub(crate) fn read(cards: &str) -> MeshFile {
    let file = parse_text("a.bdf", &format!("{BLOCK}{cards}ENDDATA\n"));
    file.unwrap_or_else(|error| panic!("{error}\n{cards}"))
}

pub(crate) fn entry<'a>(file: &'a MeshFile, name: &str) -> &'a DeckEntry {
    let names: Vec<&str> = file.entries.iter().map(|entry| entry.name.as_str()).collect();
    let own = file.entries.iter().find(|entry| entry.name == name);
    own.unwrap_or_else(|| panic!("{name}: {names:?}\n{:?}", file.notes))
}

/// Checks an entry: name, section, card and table.
#[track_caller]
pub(crate) fn assert_entry(file: &MeshFile, [name, section, card, table]: [&str; 4]) {
    let own = entry(file, name);
    let table: toml::Table = table.parse().unwrap();
    assert_eq!((own.section.as_str(), own.card().as_str(), &own.table), (section, card, &table));
}

/// Checks the grid points of a group by their indices.
#[track_caller]
pub(crate) fn assert_group(file: &MeshFile, name: &str, nodes: &[u32]) {
    assert_eq!(file.mesh.groups().nodes[name], nodes, "{name}");
}

/// The note on a distributing coupling whose point is off the plane of its nodes.
pub(crate) fn off_plane(name: &str, point: &str, distance: &str) -> String {
    format!(
        "{name} is left out: coupling \"{name}\": the nodes of \"{name}-nodes\" lie in a plane, and the point {point} is \
         {distance} off; put it there, or couple it rigidly"
    )
}

/// Checks all notes but those on the block itself, in any order.
#[track_caller]
pub(crate) fn assert_notes(file: &MeshFile, notes: &[&str]) {
    let own: BTreeSet<String> = all_notes(file).into_iter().filter(|note| note != COINCIDENT).collect();
    assert_eq!(own, notes.iter().map(|note| note.to_string()).collect());
}

#[test]
fn rbe2_is_a_rigid_coupling() {
    let file = read("GRID,50,,2.5,.5,.5\nRBE2,12,50,123456,12,9,THRU,11,2.5-6\nRBE2,13,1,123,4,5,8\n");
    let table = "name = 'rbe2_12'\nkind = 'rigid'\ngroup = 'rbe2_12-nodes'\npoint = [2.5, 0.5, 0.5]";
    assert_entry(&file, ["rbe2_12", "coupling", "RBE2 12", table]);
    let table = "name = 'rbe2_13'\nkind = 'rigid'\ngroup = 'rbe2_13-nodes'\npoint = [0.0, 0.0, 0.0]";
    assert_entry(&file, ["rbe2_13", "coupling", "RBE2 13", table]);
    assert_group(&file, "rbe2_12-nodes", &[8, 9, 10, 11]);
    assert_group(&file, "rbe2_13-nodes", &[0, 3, 4, 7]);
    assert_notes(
        &file,
        &["RBE2: 2 rigid couplings act: rbe2_12, rbe2_13 (mesh.leave_out switches them off)"],
    );
    // The reference point is no node of a cell, and no node that is left out; a further one is.
    let file = read("GRID,50,,2.5,.5,.5\nGRID,51\nRBE2,12,50,123456,12,9,10\n");
    assert_eq!((file.mesh.n_nodes(), file.entries.len()), (16, 1));
    assert_notes(
        &file,
        &[
            "RBE2: 1 rigid coupling acts: rbe2_12 (mesh.leave_out switches it off)",
            "1 node belongs to no cell and is left out",
        ],
    );
    // Constraints of its point are words of the input, too.
    let file = read("GRID,50,,2.5,.5,.5\nRBE2,12,50,123456,12,9,10\nSPC1,5,123,50,1\n");
    let note = "constraints of points without cells fix nothing without a `support` with their names: rbe2_12 (spc_5)";
    assert!(file.notes.contains(&note.to_string()), "{:?}", file.notes);
    // Large fields, and a name that the file has already.
    let wide =
        format!("{:<8}{:<16}{:<16}{:<16}{:<16}*\n{:<8}{:<16}{:<16}\n", "RBE2*", 12, 1, 123, 4, "*", 5, 8);
    let file = read(&format!("$ Femap Property 1 : rbe2_12\n{wide}"));
    assert_group(&file, "rbe2_12-2-nodes", &[0, 3, 4, 7]);
    assert_eq!(entry(&file, "rbe2_12-2").table["group"].as_str(), Some("rbe2_12-2-nodes"));
}

#[test]
fn rbe2_with_common_grid_points_are_one_body() {
    let cards = "GRID,50,,2.5,.5,.5\nGRID,51,,-.5,.5,.5\nRBE2,12,50,123456,9,10,11\nRBE2,14,51,123456,1,4,5\n\
        RBE2,13,50,123456,12,51\n";
    let file = read(cards);
    assert_eq!(file.entries.len(), 1);
    let table = "name = 'rbe2_12'\nkind = 'rigid'\ngroup = 'rbe2_12-nodes'\npoint = [2.5, 0.5, 0.5]";
    assert_entry(&file, ["rbe2_12", "coupling", "RBE2 12, 14, 13", table]);
    assert_group(&file, "rbe2_12-nodes", &[0, 3, 4, 8, 9, 10, 11]);
    assert_notes(
        &file,
        &[
            "RBE2: 1 rigid coupling acts: rbe2_12 (mesh.leave_out switches it off)",
            "rbe2_12 is one rigid body of RBE2 12, 14, 13: they share grid points",
        ],
    );
    // Only the translations of 51 follow: the second body turns about it.
    let file = read(&cards.replace("RBE2,13,50,123456,12,51", "RBE2,13,50,123,12,51"));
    let joint =
        "name = 'rbe2_13-joint'\nspherical = { between = ['rbe2_12', 'rbe2_14'], at = [-0.5, 0.5, 0.5] }";
    assert_entry(&file, ["rbe2_13-joint", "joint", "RBE2 13", joint]);
    assert_group(&file, "rbe2_12-nodes", &[8, 9, 10, 11]);
    assert_group(&file, "rbe2_14-nodes", &[0, 3, 4]);
}

#[test]
fn rbe2_that_cannot_act_are_named() {
    let cards = "GRID,50,,2.5,.5,.5\nGRID,51\nGRID,52,,4.\nRBE2,12,50,12,9,10,11\nRBE2,13,50,12346,9,10,11\n\
        RBE2,14,51,123456,50,52\n\
        RBE2,15,50,123456,9,77\nRBE2,16,50,123456,9,x\nRBE2,17,50,123456\n\
        RBE2,x\nRBE2,18,1,123456,2,9\nRBE1,19,50,123456\n";
    let file = read(cards);
    assert_eq!(file.entries, []);
    assert_notes(
        &file,
        &[
            "RBE2: 1 is left out (14): no grid point of it belongs to a cell or has a mass",
            "RBE2: 1 is left out (18): its nodes lie on a line, about which nothing holds it",
            "RBE2: 2 are left out (12, 13): its components CM are not 123 or 123456",
            "a.bdf, line 28: RBE2: 1 is left out (15): there is no grid point 77",
            "a.bdf, line 29: RBE2: 1 is left out (16): \"x\" is not a grid point",
            "a.bdf, line 30: RBE2: 1 is left out (17): it has no dependent grid point",
            "a.bdf, line 31: RBE2: 1 is left out (line 31): \"x\" is not a whole number",
            "left out, though it may change the motion: 1 RBE1",
            "3 nodes belong to no cell and are left out",
        ],
    );
}

#[test]
fn rigid_bars_are_distances_or_part_of_a_body() {
    let file = read("RBAR,20,9,32,123456\nRBAR,21,10,33,,123456,123\nRROD,22,11,34,,1\nRBAR,23,12,34,123\n");
    let table = "name = 'rbar_20'\n\
        distance = { between = ['rbar_20-end-1', 'rbar_20-end-2'], points = [[2.0, 0.0, 0.0], [3.0, 1.0, 1.0]] }";
    assert_entry(&file, ["rbar_20", "joint", "RBAR 20", table]);
    assert_group(&file, "rbar_20-end-1", &[8]);
    assert_group(&file, "rbar_20-end-2", &[13]);
    // The independent one comes first.
    assert_group(&file, "rbar_21-end-1", &[14]);
    assert_eq!(entry(&file, "rrod_22").card(), "RROD 22");
    assert_notes(
        &file,
        &[
            "RBAR: 1 is left out (23): neither CNA nor CNB alone is 123456",
            "RBAR: 2 rigid links act: rbar_20, rbar_21 (mesh.leave_out switches them off)",
            "RROD: 1 rigid link acts: rrod_22 (mesh.leave_out switches it off)",
            "rigid links keep a distance and carry no moments: rbar_20, rbar_21, rrod_22",
        ],
    );
    // At one place: a tie; RBE2 with one dependent grid point is a bar.
    let file = read("RBAR,20,7,31,123456\nRBE2,21,1,123456,32\nRROD,22,31,7,1\n");
    let table = "follower = 'rbar_20-node'\nleader = 'rbar_20-leaders'\nkind = 'nodes'\nweights = [1.0]";
    assert_entry(&file, ["rbar_20", "tie", "RBAR 20", table]);
    assert_group(&file, "rbar_20-node", &[12]);
    assert_group(&file, "rbar_20-leaders", &[6]);
    assert_eq!(entry(&file, "rbe2_21").section, "joint");
    assert!(
        file.notes.contains(&"RROD: 1 is left out (22): its two grid points lie at one place".to_string())
    );
    // At the point of a coupling, at a member of it, and from one to another.
    let coupling = "GRID,50,,2.5,.5,.5\nRBE2,12,50,123456,9,10,11\n";
    let file = read(&format!("{coupling}RBAR,20,50,32,123456\nRBAR,21,33,9,123456\nRBAR,22,9,10,123456\n"));
    assert_group(&file, "rbe2_12-nodes", &[8, 9, 10, 13, 14]);
    assert_entry(
        &file,
        [
            "rbe2_12",
            "coupling",
            "RBE2 12, RBAR 20, RBAR 21",
            "name = 'rbe2_12'\nkind = 'rigid'\ngroup = 'rbe2_12-nodes'\npoint = [2.5, 0.5, 0.5]",
        ],
    );
    assert!(file.notes.contains(&"within one rigid coupling, and without effect: RBAR 22".to_string()));
    // A rod from a coupling, and a star of bars.
    let file = read(&format!("{coupling}RROD,20,50,32,1\n"));
    let table = "name = 'rrod_20'\n\
        distance = { between = ['rbe2_12', 'rrod_20-end-2'], points = [[2.5, 0.5, 0.5], [3.0, 1.0, 1.0]] }";
    assert_entry(&file, ["rrod_20", "joint", "RROD 20", table]);
    let file = read("GRID,50,,2.5,.5,.5\nRBAR,1,50,9,123456\nRBAR,2,50,10,123456\nRBAR,3,50,11,123456\n");
    assert_group(&file, "rbar_1-nodes", &[8, 9, 10]);
    // A grid point without cells at a node: its mass is that of the node.
    let file = read("GRID,50,,2.,1.,1.\nRBAR,1,12,50,123456\nCONM2,2,50,,3.\n");
    assert_group(&file, "conm2_2-node", &[11]);
    assert!(
        file.notes
            .contains(&"grid points without cells move with the node at their place: RBAR 1".to_string())
    );
    // Beside it: a point mass on a link.
    let file = read("GRID,50,,2.,1.,3.\nRBAR,1,12,50,123456\nCONM2,2,50,,3.\n");
    assert_entry(
        &file,
        ["conm2_2", "rigid", "CONM2 2", "name = 'conm2_2'\nmass = 3.0\ncentre = [2.0, 1.0, 3.0]"],
    );
    let table = "name = 'rbar_1'\n\
        distance = { between = ['rbar_1-end-1', 'conm2_2'], points = [[2.0, 1.0, 1.0], [2.0, 1.0, 3.0]] }";
    assert_entry(&file, ["rbar_1", "joint", "RBAR 1", table]);
}

#[test]
fn rbe3_is_a_distributing_coupling() {
    let file = read(
        "GRID,50,,2.5,.5,.5\nGRID,51,,-1.,.5,.5\nRBE3,7,,50,123,1.,123,12,9\n,11,10\n\
         RBE3,8,,51,123456,2.,123,8,1,.5\n,123456,4,5,2.,123,8,ALPHA\n,6.5-6\n",
    );
    let table = "name = 'rbe3_7'\nkind = 'distributing'\ngroup = 'rbe3_7-nodes'\npoint = [2.5, 0.5, 0.5]";
    assert_entry(&file, ["rbe3_7", "coupling", "RBE3 7", table]);
    assert_group(&file, "rbe3_7-nodes", &[8, 9, 10, 11]);
    // In the order of the nodes; 8 twice.
    let table = "name = 'rbe3_8'\nkind = 'distributing'\ngroup = 'rbe3_8-nodes'\npoint = [-1.0, 0.5, 0.5]\n\
        weights = [2.0, 0.5, 0.5, 4.0]";
    assert_entry(&file, ["rbe3_8", "coupling", "RBE3 8", table]);
    assert_group(&file, "rbe3_8-nodes", &[0, 3, 4, 7]);
    assert_notes(
        &file,
        &[&off_plane("rbe3_7", "[2.5, 0.5, 0.5]", "0.5"), &off_plane("rbe3_8", "[-1, 0.5, 0.5]", "1")],
    );
    // In the plane they act.
    let file = read("GRID,50,,2.,.5,.5\nRBE3,7,,50,123,1.,123,12,9\n,11,10\n");
    assert_notes(&file, &["RBE3: 1 distributing coupling acts: rbe3_7 (mesh.leave_out switches it off)"]);
    // A node of a cell is tied: 12 is the mirror image of 9 at the middle of 10 and 11.
    let file = read("RBE3,7,,12,123,1.,123,9,10,11\n");
    let table = "follower = 'rbe3_7-node'\nleader = 'rbe3_7-leaders'\nkind = 'nodes'";
    let own = entry(&file, "rbe3_7");
    let weights: Vec<f64> =
        own.table["weights"].as_array().unwrap().iter().map(|weight| weight.as_float().unwrap()).collect();
    assert!(
        weights.iter().zip([-1.0, 1.0, 1.0]).all(|(own, exact)| (own - exact).abs() < 1e-14),
        "{weights:?}"
    );
    let mut rest = own.table.clone();
    rest.remove("weights");
    assert_eq!((own.section.as_str(), rest), ("tie", table.parse().unwrap()));
    let file = read(
        "GRID,50,,2.5,.5,.5\nRBE3,1,,50,123,1.,123,9,10,50\nRBE3,2,,50,12,1.,123,9,10,11\n\
            RBE3,3,,50,123,1.,12,9,10,11\n\
         RBE3,4,,50,123,1.,123,9\n,UM,9,1\nRBE3,5,,1,123,1.,123,9,10,11\nRBE3,6,,50,123,1.\n\
             RBE3,7,,50,123,0.,123,9\n\
         RBE3,8,,99,123,1.,123,9\n",
    );
    assert_eq!(file.entries, []);
    assert_notes(
        &file,
        &[
            "RBE3: 1 is left out (1): an independent grid point belongs to no cell",
            "RBE3: 1 is left out (2): not all of 1, 2 and 3 are in REFC",
            "RBE3: 1 is left out (3): not all of 1, 2 and 3 are in its components Ci",
            "RBE3: 1 is left out (4): it chooses its dependent components (UM)",
            "RBE3: 1 is left out (5): its point is a node, and lies off the plane or line of the others",
            "RBE3: 1 is left out (7): a weight is not above 0",
            "a.bdf, line 29: RBE3: 1 is left out (6): its weights and grid points are not complete",
            "a.bdf, line 31: RBE3: 1 is left out (8): there is no grid point 99",
            "1 node belongs to no cell and is left out",
        ],
    );
}

/// Three equations with the same weights.
fn equations(set: u32, terms: &[(u32, f64)]) -> String {
    let equation = |component: u32| {
        let fields = |line: &[(u32, f64)]| {
            line.iter().map(|(grid, factor)| format!(",{grid},{component},{factor:?}")).collect::<String>()
        };
        let lines: Vec<String> = terms.chunks(2).map(fields).collect();
        format!("MPC,{set}{}\n", lines.join("\n,"))
    };
    [1, 2, 3].map(equation).concat()
}

#[test]
fn three_equations_of_a_grid_point_are_a_tie() {
    // 12 = 10 + 11 - 9, with a common factor, from the second line on in the third and fourth places.
    let cards = equations(4, &[(12, 2.0), (9, 2.0), (10, -2.0), (11, -2.0)]);
    let file = read(&cards);
    let table =
        "follower = 'mpc_4_12-node'\nleader = 'mpc_4_12-leaders'\nkind = 'nodes'\nweights = [-1.0, 1.0, 1.0]";
    assert_entry(&file, ["mpc_4_12", "tie", "MPC 4 of grid point 12", table]);
    assert_group(&file, "mpc_4_12-leaders", &[8, 9, 10]);
    assert_notes(
        &file,
        &[
            "MPC: 1 tie acts: mpc_4_12 (mesh.leave_out switches it off)",
            "MPC: no case control chooses a set: set 4 acts",
        ],
    );
    let file = read(&equations(4, &[(31, 1.0), (7, -1.0)]));
    let table = "follower = 'mpc_4_31-node'\nleader = 'mpc_4_31-leaders'\nkind = 'nodes'\nweights = [1.0]";
    assert_entry(&file, ["mpc_4_31", "tie", "MPC 4 of grid point 31", table]);
    // A grid point without cells at the mean.
    let free = format!("GRID,50,,2.,.25,.5\n{}", equations(1, &[(50, 4.0), (9, -3.0), (12, -1.0)]));
    let file = read(&free.replace(".25,.5", ".25,.25"));
    let table = "name = 'mpc_1_50'\nkind = 'distributing'\ngroup = 'mpc_1_50-nodes'\npoint = [2.0, 0.25, 0.25]\n\
        weights = [0.75, 0.25]";
    assert_entry(&file, ["mpc_1_50", "coupling", "MPC 1 of grid point 50", table]);
    assert_eq!(read(&free).entries, []);
}

#[test]
fn equations_in_local_directions_are_those_of_the_motion() {
    // The displacements of 31 are along the axes of a system turned by 90 degrees about z: 1 is y, 2 is -x.
    let system = "CORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n";
    let block = BLOCK.replace("GRID,31,,1.,1.,1.", "GRID,31,,1.,1.,1.,5");
    let turned = "MPC,1,31,1,1.,7,2,-1.\nMPC,1,31,2,-1.,7,1,-1.\nMPC,1,31,3,1.,7,3,-1.\n";
    let parsed = |cards: &str| parse_text("a.bdf", &format!("{block}{system}{cards}ENDDATA\n")).unwrap();
    let file = parsed(turned);
    assert_eq!(entry(&file, "mpc_1_31").section, "tie");
    let file = parsed(&equations(1, &[(31, 1.0), (7, -1.0)]));
    assert_eq!(file.entries, []);
    let note = "MPC: 3 are left out (grid point 31): their weights are not alike in all directions";
    assert!(file.notes.contains(&note.to_string()), "{:?}", file.notes);
    // A cylindrical system of two grid points at one place has the same directions there.
    let block = block.replace("GRID,7,,1.,1.,1.", "GRID,7,,1.,1.,1.,5").replace("CORD2R", "CORD2C");
    let text = format!("{block}{system}{}ENDDATA\n", equations(1, &[(31, 1.0), (7, -1.0)]))
        .replace("CORD2R", "CORD2C");
    assert_eq!(entry(&parse_text("a.bdf", &text).unwrap(), "mpc_1_31").section, "tie");
}

#[test]
fn equations_that_cannot_act_are_named() {
    let cards = [
        "MPC,1,9,1,1.,10,1,-1.\n".to_string(),
        equations(2, &[(31, 1.0), (7, -0.5)]),
        equations(3, &[(12, 1.0), (9, -1.0)]),
        "MPC,4,12,4,1.,9,4,-1.\nMPC,4,31,1,1.,7,1,-1.\n,,7,5,.1\nMPC,5,77,,1.,9,1,-1.\nMPC,6,1,1\n"
            .to_string(),
    ];
    let file = read(&cards.concat());
    assert_eq!(file.entries, []);
    assert_notes(
        &file,
        &[
            "MPC: 1 is left out (grid point 12): they are of rotations",
            "MPC: 1 is left out (grid point 31): they have rotations",
            "MPC: 1 is left out (grid point 77): they are of scalar points",
            "MPC: 1 is left out (grid point 9): they are not one for each of the components 1, 2 and 3",
            "MPC: 3 are left out (grid point 12): the grid point does not lie at the weighted mean of the others",
            "MPC: 3 are left out (grid point 31): the sum of their weights is not 1",
            "MPC: no case control chooses a set: sets 1, 2, 3, 4, 5 act",
            "a.bdf, line 33: MPC: 1 is left out (line 33): its first factor is 0",
        ],
    );
}

#[test]
fn the_case_control_chooses_equations() {
    let sets = [4, 6]
        .map(|set| equations(set, &[(if set == 4 { 12 } else { 2 }, 1.0), (9, 1.0), (10, -1.0), (11, -1.0)]));
    let sets = format!("{}{}MPCADD,9,4,5\n", sets[0], sets[1].replace("9,", "3,").replace("10,", "1,"));
    let names = |control: &str| {
        let text = format!("SOL 101\nCEND\n{control}\nBEGIN BULK\n{BLOCK}{sets}ENDDATA\n");
        let file = parse_text("a.bdf", &text).unwrap();
        let names: Vec<String> = file.entries.iter().map(|entry| entry.name.clone()).collect();
        (names.join(" "), file.notes)
    };
    for control in ["MPC = 4", " mpc=9 $ both", "SUBCASE 1\n  MPC  =  4"] {
        let (own, notes) = names(control);
        assert_eq!(own, "mpc_4_12", "{control}");
        let chosen = if control.contains('9') { 9 } else { 4 };
        let note = format!("MPC: 3 equations are left out, for the case control chooses {chosen} and not 6");
        assert!(notes.contains(&note), "{notes:?}");
    }
    assert_eq!(names("MPCFORCES(PLOT) = ALL").0, "mpc_4_12");
}
