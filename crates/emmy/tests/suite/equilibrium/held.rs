//! Rigid motions that nothing holds, and mechanisms.

use emmy::Error;
use emmy::body::{Body, GroundAttraction, GroundSpring, Load, PointMass, PointTerms, Region, Support};
use emmy::equilibrium::Equilibrium;
use emmy::material::{Link, NeoHooke};
use emmy::mesh::{CellKind, Mesh, MeshBuilder, block, rectangle};
use emmy::motion::{MarchError, NewtonSettings};

fn rubber() -> Region {
    Region::new(NeoHooke::new(10.0, 5.0).unwrap(), 1.0)
}

/// The free motions of a block of 2 x 4 x 6 under supports and springs.
fn free(supports: &[Support], nodal: PointTerms) -> String {
    let mesh = block([2.0, 4.0, 6.0], [1, 2, 3]).unwrap();
    let corner = mesh.nearest_node([0.0; 3]) as u32;
    let mesh = mesh.with_node_group("corner", [corner]).unwrap();
    let body = Body::builder(mesh).region(rubber()).supports(supports).point_terms(nodal).build().unwrap();
    match Equilibrium::new(&body, 0.0, 1).unwrap().check() {
        Ok(()) => String::new(),
        Err(Error::NotHeld { motions, .. }) => motions,
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn free_rigid_motions_are_named() {
    let none = PointTerms::default;
    let fix = |group: &str, fix| Support::of_components(group, fix);
    let x_y_z = "rotation about x, rotation about y, rotation about z, \
                 translation along x, translation along y and translation along z";
    assert_eq!(free(&[], none()), x_y_z);
    assert_eq!(free(&[Support::fixed("x-min")], none()), "");
    assert_eq!(
        free(&[Support::symmetry("x-min")], none()),
        "rotation about x, translation along y and translation along z"
    );
    // Two planes of symmetry leave the line in which they meet.
    assert_eq!(
        free(&[Support::symmetry("x-min"), Support::symmetry("y-min")], none()),
        "translation along z"
    );
    assert_eq!(
        free(&[Support::fixed("corner")], none()),
        "rotation about x through [1, 0, 0], rotation about y through [0, 2, 0] and rotation about z through [0, 0, 3]"
    );
    // A hinge along y at x = z = 0: the axis passes the centre at y = 2.
    let hinge = [Support::fixed("corner"), fix("x-min", [true, false, false])];
    assert_eq!(free(&hinge, none()), "rotation about x through [1, 0, 0]");
}

#[test]
fn springs_hold_and_attractions_hold_against_translation() {
    let springs = |group: &str| PointTerms {
        springs: vec![GroundSpring { group: group.into(), stiffness: 0.3 }],
        ..Default::default()
    };
    assert_eq!(free(&[], springs("x-min")), "");
    assert!(free(&[], springs("corner")).starts_with("rotation about x through [1, 0, 0]"));
    // All masses are drawn to a point below: nothing resists a rotation about it.
    let centre = [1.0, 2.0, -50.0];
    let drawn = GroundAttraction { group: None, centre, strength: 7.0 };
    let attractions = PointTerms { attractions: vec![drawn], ..Default::default() };
    assert_eq!(
        free(&[], attractions),
        "rotation about x through [1, 2, -50], rotation about y through [1, 2, -50] and rotation about z"
    );
}

#[test]
fn parts_are_held_one_by_one_and_planes_stay_in_their_plane() {
    let mut builder = MeshBuilder::new();
    for x in [0.0, 5.0] {
        let corner = |at: u32| {
            let [a, b, c] = [at & 1, at >> 1 & 1, at >> 2].map(f64::from);
            [x + a, b, c]
        };
        let order = [0, 1, 3, 2, 4, 5, 7, 6];
        let nodes = order.map(|at| builder.point(corner(at)));
        builder.cell(CellKind::Hex8, &nodes).unwrap();
        if x == 0.0 {
            builder.node_group("first", nodes);
        }
    }
    let two = Body::builder(builder.build().unwrap()).region(rubber()).support(Support::fixed("first"));
    let error = Equilibrium::new(&two.build().unwrap(), 0.0, 1).unwrap().check().unwrap_err();
    assert!(
        error.to_string().starts_with("nothing holds the part of the body with cell 1 against"),
        "{error}"
    );

    let plane = Body::builder(rectangle([2.0, 1.0], [2, 1]).unwrap()).region(rubber()).build().unwrap();
    let error = Equilibrium::new(&plane, 0.0, 1).unwrap().check().unwrap_err();
    let Error::NotHeld { motions, .. } = error else { panic!("{error}") };
    assert_eq!(motions, "rotation about z, translation along x and translation along y");
}

/// A chain of two links between walls carries no force across it before it sags.
#[test]
fn mechanisms_are_named_with_their_place() {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let mesh = Mesh::from_cells(CellKind::Line2, &points, &[[0, 1], [1, 2]]).unwrap();
    let mesh = mesh.with_node_group("walls", [0, 2]).unwrap().with_node_group("middle", [1]).unwrap();
    let masses = vec![PointMass { group: "middle".into(), mass: 1.0 }];
    let chain = |supports: &[Support]| {
        Body::builder(mesh.clone())
            .region(Region::links(Link::spring(100.0, None).unwrap(), 0.0))
            .point_terms(PointTerms { masses: masses.clone(), ..Default::default() })
            .supports(supports)
            .load(Load::acceleration([0.0, 0.0, -9.81]))
            .build()
            .unwrap()
    };
    let body = chain(&[Support::fixed("walls")]);
    let start = Equilibrium::new(&body, 0.0, 4).unwrap();
    match start.start(NewtonSettings::default(), &[], &mut []).unwrap_err() {
        MarchError::Step(Error::NoEquilibrium { fraction, cause, .. }) => {
            let Error::Singular { node, .. } = *cause else { panic!("{cause}") };
            assert_eq!((fraction, node), (0.0, 1));
        }
        other => panic!("{other}"),
    }
    // A part on a line need not be held against rotation about it.
    let held = chain(&[Support::fixed("walls"), Support::fixed("middle")]);
    Equilibrium::new(&held, 0.0, 1).unwrap().check().unwrap();
}
