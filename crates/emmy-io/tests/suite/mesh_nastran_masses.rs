//! Masses, springs and dampers of Nastran files, as tables of the input.

use crate::mesh_abaqus_bodies::assert_note;
use crate::mesh_nastran_beside::{BLOCK, assert_entry, assert_group, assert_notes, entry, off_plane, read};
use crate::meshes::parse_text;
use emmy_io::mesh::{MeshOptions, parse_with};

#[test]
fn masses_act_at_what_they_stand_on() {
    let coupling = "GRID,50,,2.5,.5,.5\nRBE2,12,50,123456,9,10,11\n";
    let file = read(&format!(
        "{coupling}CONM2,1,50,,3.\n,1.,,2.,,.1,2.5\nCONM2,2,50,,4.,1.\nCONM2,3,50,-1,5.,0.,0.,1.\n,1.,,1.,,,1.\n\
         CONM2,4,9,,6.\n"
    ));
    // Products of inertia have the other sign in the tensor.
    let table =
        "group = 'rbe2_12'\nmass = 3.0\ninertia = [[1.0, 0.0, 0.0], [0.0, 2.0, -0.1], [0.0, -0.1, 2.5]]";
    assert_entry(&file, ["conm2_1", "mass", "CONM2 1", table]);
    assert_entry(
        &file,
        ["conm2_2", "rigid", "CONM2 2", "name = 'conm2_2'\nmass = 4.0\ncentre = [3.5, 0.5, 0.5]"],
    );
    let joint =
        "name = 'conm2_2-joint'\nspherical = { between = ['conm2_2', 'rbe2_12'], at = [3.5, 0.5, 0.5] }";
    assert_entry(&file, ["conm2_2-joint", "joint", "CONM2 2", joint]);
    let table = "name = 'conm2_3'\nmass = 5.0\ncentre = [0.0, 0.0, 1.0]\n\
        inertia = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]";
    assert_entry(&file, ["conm2_3", "rigid", "CONM2 3", table]);
    let joint = "name = 'conm2_3-joint'\nfixed = { between = ['conm2_3', 'rbe2_12'], at = [0.0, 0.0, 1.0] }";
    assert_entry(&file, ["conm2_3-joint", "joint", "CONM2 3", joint]);
    assert_entry(&file, ["conm2_4", "mass", "CONM2 4", "group = 'conm2_4-node'\nmass = 6.0"]);
    assert_notes(
        &file,
        &[
            "CONM2: 2 joints hold masses beside their rigid couplings: conm2_2-joint, conm2_3-joint \
                (mesh.leave_out switches them off)",
            "CONM2: 4 masses act: conm2_1, conm2_2, conm2_3, conm2_4 (mesh.leave_out switches them off)",
            "RBE2: 1 rigid coupling acts: rbe2_12 (mesh.leave_out switches it off)",
        ],
    );
    // A point of RBE3, a node and a grid point alone; the axes of system 5 are y, -x, z.
    let system = "CORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n";
    let file = read(&format!(
        "{system}GRID,50,,2.5,.5,.5\nGRID,51,,9.,9.,9.\nRBE3,7,,50,123,1.,123,12,9,10\nCONM2,1,50,,3.,.5\n\
         ,1.,,1.,,,1.\nCONM2,2,9,,4.,.5\nCONM2,3,51,5,5.,1.,2.,3.\n,1.,,1.5,,,2.\nCONM2,4,51,,0.\n,1.\n\
         CONM2,5,51,,0.\nCONM2,6,77,,1.\nCONM2,7,1,,1.\n,9.,,1.,,,1.\n"
    ));
    assert_entry(&file, ["conm2_1", "mass", "CONM2 1", "group = 'rbe3_7'\nmass = 3.0"]);
    assert_entry(&file, ["conm2_2", "mass", "CONM2 2", "group = 'conm2_2-node'\nmass = 4.0"]);
    let table = "name = 'conm2_3'\nmass = 5.0\ncentre = [7.0, 10.0, 12.0]\n\
        inertia = [[1.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]]";
    assert_entry(&file, ["conm2_3", "rigid", "CONM2 3", table]);
    assert_notes(
        &file,
        &[
            "CONM2: 1 is left out (4): an inertia needs a mass above 0",
            "CONM2: 1 is left out (5): its mass is not above 0",
            "CONM2: 3 masses act: conm2_2, conm2_3, conm2_7 (mesh.leave_out switches them off)",
            &off_plane("rbe3_7", "[2.5, 0.5, 0.5]", "0.5"),
            "conm2_1 is left out with rbe3_7",
            "a.bdf, line 35: CONM2: 1 is left out (6): there is no grid point 77",
            "joined to nothing, as masses at grid points without cells: conm2_3",
            "the inertia of CONM2: 1 is left out (1): the point of a distributing coupling has none",
            "the inertia of CONM2: 1 is left out (7): no body has it",
            "the offset of CONM2: 1 is left out (1): the point of a distributing coupling has none",
            "the offset of CONM2: 1 is left out (2): a node of a cell has none",
        ],
    );
}

#[test]
fn masses_without_cells_that_move_as_one_are_one_body() {
    // Two masses of a rod, 2 apart: m d^2 / 4 each about the middle.
    let file = read(
        "GRID,50,,4.,,5.\nGRID,51,,6.,,5.\nGRID,52,,5.,9.,5.\nRBE2,3,52,123456,50,51\nCONM2,1,50,,3.\nCONM2,2,51,,3.\n",
    );
    let table = "name = 'rbe2_3'\nmass = 6.0\ncentre = [5.0, 0.0, 5.0]\n\
        inertia = [[0.0, 0.0, 0.0], [0.0, 6.0, 0.0], [0.0, 0.0, 6.0]]";
    assert_entry(&file, ["rbe2_3", "rigid", "RBE2 3", table]);
    assert!(
        file.notes.contains(&"rbe2_3 has the masses of CONM2 1, CONM2 2".to_string()),
        "{:?}",
        file.notes
    );
    let file = read(
        "GRID,50,,4.\nCONM2,1,50,,3.\nCONM2,2,50,,4.\nCMASS2,5,1.,50,1\nCMASS2,6,1.,50,2\nCMASS2,7,1.,50,3\n",
    );
    assert_eq!(file.entries.len(), 1);
    assert_entry(
        &file,
        [
            "conm2_1",
            "rigid",
            "CONM2 1, 2, CMASS2 5, 6, 7",
            "name = 'conm2_1'\nmass = 8.0\ncentre = [4.0, 0.0, 0.0]",
        ],
    );
    // Masses that are alike, by a property, and others.
    let file = read(
        "PMASS,1,9.,2,2.5\nCMASS1,5,2,1,1\nCMASS1,6,2,1,2\nCMASS1,7,2,,,1,3\nCMASS2,8,1.,2,1\n\
            CMASS2,9,1.,2,1,3,1\nCMASS1,10,7,2,1\n",
    );
    assert_entry(&file, ["cmass1_5", "mass", "CMASS1 5, 6, 7", "group = 'cmass1_5-node'\nmass = 2.5"]);
    assert_group(&file, "pid_2-ends", &[0]);
}

#[test]
fn springs_act_to_the_ground_and_along_lines() {
    let ground = "CELAS2,1,5.,9,1\nCELAS2,2,5.,9,2\nCELAS2,3,2.,,,9,3\nCELAS2,4,3.,9,3\n";
    let file = read(ground);
    assert_entry(
        &file,
        ["celas2_1", "support", "CELAS2 1, 2, 3, 4", "group = 'celas2_1-node'\nspring = 5.0"],
    );
    assert_group(&file, "celas2_1-node", &[8]);
    assert_notes(&file, &["CELAS2: 1 spring to the ground acts: celas2_1 (mesh.leave_out switches it off)"]);
    // At points of couplings.
    let couplings = "GRID,9001,,2.5,.5,.5\nGRID,9002,,-1.,.5,.5\nRBE2,12,9001,123456,10,11,12\n\
        RBE3,7,,9002,123,1.,123,1,4,5\n";
    let own = |grid: &str| ground.replace(",9,", &format!(",{grid},"));
    for (grid, group) in [("9001", "rbe2_12"), ("9002", "rbe3_7")] {
        let file = read(&format!("{couplings}{}", own(grid)));
        assert_eq!(entry(&file, "celas2_1").table["group"].as_str(), Some(group));
    }
    // Along x, from 1 to 9, with a damper; from the point of a coupling along x to a grid point with a mass.
    let file = read(&format!(
        "{couplings}GRID,9003,,7.5,.5,.5\nPELAS,5,100.,,,6,200.\nPDAMP,5,1.,6,2.5\nCELAS1,1,6,1,1,9,1\n\
            CDAMP1,2,6,9,1,1,1\n\
         CONM2,3,9003,,1.\nCELAS1,4,5,9001,1,9003,1\nCDAMP2,6,.5,2,2,3,2\n"
    ));
    let table = "name = 'celas1_1'\n\
        line = { between = ['celas1_1-end-1', 'celas1_1-end-2'], points = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]] }\n\
                 spring = { stiffness = 200.0 }\ndamping = 2.5";
    assert_entry(&file, ["celas1_1", "joint", "CELAS1 1, CDAMP1 2", table]);
    let table = "name = 'celas1_4'\n\
        line = { between = ['rbe2_12', 'conm2_3'], points = [[2.5, 0.5, 0.5], [7.5, 0.5, 0.5]] }\n\
        spring = { stiffness = 100.0 }";
    assert_entry(&file, ["celas1_4", "joint", "CELAS1 4", table]);
    let table = "name = 'cdamp2_6'\n\
        line = { between = ['cdamp2_6-end-1', 'cdamp2_6-end-2'], points = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]] }\n\
        damping = 0.5";
    assert_entry(&file, ["cdamp2_6", "joint", "CDAMP2 6", table]);
    // The ends with a property remain a group.
    assert_group(&file, "pid_6", &[0, 8]);
    // A radial spring: the component 1 of both grid points is along the line from the axis.
    let block = BLOCK
        .replace("GRID,3,,1.,1.,0.", "GRID,3,,1.,1.,0.,5")
        .replace("GRID,1,,0.,0.,0.", "GRID,1,,0.,0.,0.,6");
    let systems = "CORD2C,5,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,6,,0.,0.,0.,0.,0.,1.\n,1.,1.,0.\n";
    let text = format!("{block}{systems}CELAS2,1,5.,1,1,3,1\nENDDATA\n");
    assert_eq!(parse_text("a.bdf", &text).unwrap().entries.len(), 1);
}

#[test]
fn springs_that_cannot_act_are_named() {
    let file = read(
        "GRID,50,,8.\nCELAS2,1,5.,9,1\nCELAS2,2,5.,9,2\nCELAS2,3,5.,1,2,9,2\nCELAS2,4,5.,7,1,31,1\n\
            CELAS2,5,5.,9,4\nCELAS2,6,5.,77,0\n\
         CELAS2,7,5.,77,1\nCELAS2,8,0.,9,1\nCELAS1,9,3,9,1\nCDAMP2,10,5.,9,1\nCELAS2,11,5.,50,1\n\
             CELAS2,12,5.,50,2\nCELAS2,13,5.,50,3\nCELAS2,14,5.\n\
         CELAS2,15,5.,1,1,50,1\nCMASS2,16,5.,1,1,9,1\nCELAS2,17,-x,1,1,9,1\nCELAS2,18,5.,1,1,9,1,.02\n",
    );
    assert_eq!(file.entries.len(), 1);
    let expected = [
        "CDAMP2: 1 is left out (10): no damper acts between a grid point and the ground",
        "CELAS1: 1 is left out (9): its property has no PELAS",
        "CELAS2: 3 are left out (11, 12, 13): its grid point has no cell, and is not the point of a coupling or mass",
        "CELAS2: 1 is left out (15): a grid point of it has no cell, no rigid element that acts, and no mass",
        "CELAS2: 1 is left out (3): its component is not along the line between its grid points",
        "CELAS2: 1 is left out (4): its two grid points lie at one place",
        "CELAS2: 1 is left out (5): it is at a rotation",
        "CELAS2: 1 is left out (6): it is at a scalar point",
        "CELAS2: 1 is left out (8): its stiffness is not above 0",
        "CELAS2: 1 spring along a line acts: celas2_18 (mesh.leave_out switches it off)",
        "CELAS2: 2 are left out (1, 2): those of its grid point are not alike in 1, 2 and 3",
        "CMASS2: 1 is left out (16): it is between two grid points",
        "a.bdf, line 29: CELAS2: 1 is left out (7): there is no grid point 77",
        "a.bdf, line 36: CELAS2: 1 is left out (14): it has no grid point",
        "a.bdf, line 39: CELAS2: 1 is left out (17): \"-x\" is not a number",
        "the structural damping GE of springs is left out: CELAS2 18",
        "node group \"pid_3\" has no node of a cell",
    ];
    for note in &expected[..16] {
        assert_note(&file, note);
    }
}

#[test]
fn bushings_act_alike_or_along_their_line() {
    let properties =
        "PBUSH,4,K,7.,7.,7.,1.,1.,1.\nPBUSH,5,K,8.,,,,,\n,,B,.5\nPBUSH,6,K,1.,2.\nPBUSH,7,K,RIGID\n";
    let cards = "CBUSH,101,4,9,,,,,0\nCBUSH,102,5,10,34\nCBUSH,103,6,11,34\nCBUSH,104,7,11,34\nCBUSH,105,8,11\n\
        CBUSH,106,4,9,34\nCBUSH,107,8,11,34\n";
    let file = read(&format!("{properties}{cards}"));
    assert_entry(&file, ["cbush_101", "support", "CBUSH 101", "group = 'cbush_101-node'\nspring = 7.0"]);
    let table = "name = 'cbush_102'\n\
        line = { between = ['cbush_102-end-1', 'cbush_102-end-2'], points = [[2.0, 1.0, 0.0], [1.0, 1.0, 3.0]] }\n\
                 spring = { stiffness = 8.0 }\ndamping = 0.5";
    assert_entry(&file, ["cbush_102", "joint", "CBUSH 102", table]);
    assert_notes(
        &file,
        &[
            "1 line element is read as the nodes at the ends, not as bars",
            "CBUSH: 1 is left out (104): its property has a stiffness RIGID",
            "CBUSH: 1 is left out (105): its property has no PBUSH",
            "CBUSH: 1 spring along a line acts: cbush_102 (mesh.leave_out switches it off)",
            "CBUSH: 1 spring to the ground acts: cbush_101 (mesh.leave_out switches it off)",
            "CBUSH: 2 are left out (103, 106): it has stiffness or damping beside that along its line (K1, B1)",
        ],
    );
    // A link is no spring.
    let links = MeshOptions { links: vec!["pid_5".to_string()], ..MeshOptions::default() };
    let text = format!("{BLOCK}PBUSH,5,K,8.\nCBUSH,102,5,10,34\nENDDATA\n");
    assert_eq!(parse_with("a.bdf".as_ref(), text.as_bytes(), &links).unwrap().entries, []);
}

#[test]
fn a_body_in_plane_strain_and_a_file_without_cells_have_none() {
    let sheet = "GRID,1\nGRID,2,,1.\nGRID,3,,1.,1.\nGRID,4,,,1.\nCPLSTN4,1,1,1,2,3,4\n";
    let file = parse_text("a.bdf", &format!("{sheet}RBE2,7,1,123,2,3\nCONM2,8,1,,1.\nENDDATA\n")).unwrap();
    assert_eq!(file.entries, []);
    let notes = [
        "CONM2: 1 is left out (8): the body is in plane strain",
        "RBE2: 1 is left out (7): the body is in plane strain",
    ];
    assert_eq!(file.notes, notes);
    let error = parse_text("a.bdf", "GRID,1\nGRID,2\nRBE2,7,1,123,2\nCONM2,8,1,,1.\nENDDATA\n").unwrap_err();
    assert!(error.to_string().contains("only 1 CONM2, 1 RBE2"), "{error}");
}

#[test]
fn an_input_has_them_but_for_those_it_leaves_out() {
    let folder = std::env::temp_dir().join(format!("emmy-nastran-beside-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let cards = "GRID,50,,7.\nCONM2,1,50,,3.\nCONM2,2,9,,4.\nCELAS2,3,5.,9,1,50,1\nCELAS2,4,5.,1,1\n\
        CELAS2,5,5.,1,2\nCELAS2,6,5.,1,3\n";
    std::fs::write(folder.join("a.bdf"), format!("{BLOCK}{cards}ENDDATA\n")).unwrap();
    let read = |mesh: &str| {
        let rest = "[[region]]\ndensity = 1.0\nmaterial.neo-hooke = { youngs_modulus = 1000.0, poissons_ratio = 0.3 }\n\
                    [time]\nscheme = \"DGM\"\nsteps = [{ until = 1.0, size = 0.1 }]\n";
        std::fs::write(folder.join("input.toml"), format!("[mesh]\nfile = \"a.bdf\"\n{mesh}\n{rest}"))
            .unwrap();
        let problem = emmy_io::input::read(&folder.join("input.toml"), &emmy_io::input::Overrides::default());
        problem.map_err(|error| error.to_string())
    };
    let resolved = read("scale = 10.0").unwrap().resolved;
    for text in ["conm2_2-node", "celas2_3", "celas2_4-node", "70.0"] {
        assert!(resolved.contains(text), "{text}\n{resolved}");
    }
    let resolved = read("leave_out = [\"conm2_1\", \"celas2_3\"]").unwrap().resolved;
    assert!(!resolved.contains("stiffness = 5") && resolved.contains("celas2_4-node"), "{resolved}");
    assert!(read("leave_out = [\"conm2_9\"]").unwrap_err().contains("nothing that is named `conm2_9`"));
    std::fs::remove_dir_all(&folder).unwrap();
}
