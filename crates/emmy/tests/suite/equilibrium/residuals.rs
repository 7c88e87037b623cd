//! The residual of an equilibrium, its increments and its reactions, for materials, cells and loads.

use emmy::body::{
    Body, Field, GroundSpring, Load, LoadKind, PointTerms, Region, Rotation, Support, TimeFunction,
};
use emmy::equilibrium::{Equilibrium, unbalanced_force};
use emmy::material::{Gent, Hencky, NeoHooke, Ogden, SaintVenantKirchhoff, Yeoh};
use emmy::mesh::CellKind;
use emmy::motion::{NewtonSettings, Observer, ObserverResult, Record, View};

use super::{equilibrium, mapped};
use crate::shared::faces::with_faces;

const KINDS: [CellKind; 7] = [
    CellKind::Tet4,
    CellKind::Hex8,
    CellKind::Tet10,
    CellKind::Hex20,
    CellKind::Hex27,
    CellKind::Wedge6,
    CellKind::Quad8,
];

/// A block of 3 x 1 x 1 with a face that is turned and pushed, pressure on another, gravity and a field.
fn body(kind: CellKind, region: Region) -> Body {
    use crate::shared::patch::Patch;
    let mesh = if kind.dimension() == 2 {
        let mesh = mapped(kind, [3, 1, 1], &[&|[s, t, _]| [3.0 * s, t, 0.0]]);
        with_faces(mesh, &[("low", &|X| X[0] == 0.0), ("high", &|X| X[0] == 3.0), ("top", &|X| X[1] == 1.0)])
    } else {
        let patch = Patch { bricks: 2, curved: false, distortion: 0.3 }.mesh(kind);
        let mut builder = emmy::mesh::MeshBuilder::new();
        patch.points().iter().for_each(|&X| {
            builder.point(X);
        });
        patch.cells().for_each(|cell| {
            builder.cell(cell.kind, cell.nodes).unwrap();
        });
        let [low, high] = [0, 1].map(|end| {
            let x = patch.points().iter().map(|X| X[0]);
            if end == 0 { x.fold(f64::INFINITY, f64::min) } else { x.fold(f64::NEG_INFINITY, f64::max) }
        });
        let top = patch.points().iter().map(|X| X[1]).fold(f64::NEG_INFINITY, f64::max);
        with_faces(
            builder,
            &[("low", &|X| X[0] == low), ("high", &|X| X[0] == high), ("top", &|X| X[1] == top)],
        )
    };
    let size = mesh.extent()[0];
    let table = |value: f64| TimeFunction::new(vec![(-1.0, 0.0), (0.0, value), (9.0, value)]).unwrap();
    let crank = Support {
        group: "high".into(),
        displacement: [Some(table(0.05 * size)), None, None],
        rotation: Some(Rotation { axis: [0.0, 0.0, 1.0], about: [size, 0.0, 0.0], angle: table(0.1) }),
        ..Default::default()
    };
    let field = Field::new(|X, t| [0.3 * X[1], 0.2 + t, 0.0]);
    Body::builder(mesh)
        .region(region)
        .support(Support::fixed("low"))
        .support(crank)
        .load(Load::pressure("top", 0.4))
        .load(Load::acceleration([0.0, -0.5, 0.0]))
        .load(Load::new(LoadKind::BodyForceField { group: None, field }))
        .point_terms(PointTerms {
            springs: vec![GroundSpring { group: "top".into(), stiffness: 0.2 }],
            ..Default::default()
        })
        .build()
        .unwrap()
}

/// Whatever the material and the cells, the forces balance to round-off of the forces in the cells.
#[test]
fn residuals_are_at_round_off() {
    let regions = || {
        [
            Region::new(SaintVenantKirchhoff::new(12.0, 8.0).unwrap(), 1.0),
            Region::new(NeoHooke::new(12.0, 8.0).unwrap(), 1.0),
            Region::new(Hencky::new(12.0, 8.0).unwrap(), 1.0),
        ]
    };
    for kind in KINDS {
        for region in regions() {
            let body = body(kind, region);
            let state = equilibrium(&body, 3);
            let force = unbalanced_force(&body, &state.displacement, 0.0).unwrap();
            let size = force.iter().fold(0.0, |size: f64, f| size.max(f.abs()));
            let free = force.iter().zip(body.fixed()).filter(|(_, fixed)| !**fixed);
            let residual = free.fold(0.0, |residual: f64, (f, _)| residual.max(f.abs()));
            assert!(residual < 3e-14 * size, "{kind}: {residual:e} of {size:e}");
        }
    }
}

/// Records of every increment.
struct Rows(Vec<Record>);

impl Observer for Rows {
    fn observe(&mut self, view: View<'_>) -> ObserverResult {
        self.0.push(view.record.clone());
        Ok(())
    }
}

/// Energies of the increments: loads that grow with the fraction s do the work `integral F . u' ds` along the path,
/// which the strain energy stores (Simpson's rule over the increments of a dead load).
#[test]
fn increments_store_the_work_of_the_loads() {
    struct Path(Vec<[f64; 2]>, Vec<f64>);
    impl Observer for Path {
        fn observe(&mut self, view: View<'_>) -> ObserverResult {
            let force: f64 = self.1.iter().zip(&view.state.displacement).map(|(f, u)| f * u).sum();
            self.0.push([force, view.record.strain_energy]);
            Ok(())
        }
    }
    let mesh = emmy::mesh::block([3.0, 1.0, 1.0], [3, 1, 1]).unwrap();
    let body = Body::builder(mesh)
        .region(Region::new(NeoHooke::new(12.0, 8.0).unwrap(), 1.0))
        .support(Support::fixed("x-min"))
        .load(Load::traction("x-max", [1.0, 0.2, -0.3]))
        .build()
        .unwrap();
    let mut full = vec![0.0; body.n_dofs()];
    body.loads_at(0.0, &mut full).unwrap();
    let (mut path, mut rows) = (Path(Vec::new(), full), Rows(Vec::new()));
    let start = Equilibrium::new(&body, 0.0, 80).unwrap();
    start.start(NewtonSettings::default(), &[], &mut [&mut path, &mut rows]).unwrap();
    // W = F . u at the end less the integral of F . u over the fraction.
    let n = path.0.len() - 1;
    let weight = |i: usize| {
        if i == 0 || i == n {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        }
    };
    let integral: f64 = path.0.iter().enumerate().map(|(i, [work, _])| weight(i) * work).sum::<f64>() / 240.0;
    let [work, stored] = path.0[n];
    assert!((work - integral - stored).abs() < 2e-8 * stored, "{} {stored}", work - integral);
    assert_eq!((n, rows.0[0].time, rows.0[n].time), (80, 0.0, 1.0));
    for row in &rows.0 {
        assert!(row.kinetic_energy == 0.0 && row.energy_residual.abs() < 1e-15, "{row:?}");
        assert!(row.linear_momentum_residual < 1e-12 && row.angular_momentum_residual < 1e-12, "{row:?}");
    }
}

/// A load with a rare material each: the path is found, and the reactions carry the load.
#[test]
fn reactions_carry_the_loads() {
    let bulk = emmy::material::Volumetric::default();
    let regions = [
        Region::new(Gent::new(5.0, 30.0, 40.0, bulk).unwrap(), 2.0),
        Region::new(Yeoh::new([5.0, 0.1, 0.01], 20.0, bulk).unwrap(), 2.0),
        Region::new(Ogden::new(&[(5.0, 2.0)], 20.0, bulk).unwrap(), 2.0),
    ];
    for region in regions {
        let mesh = emmy::mesh::block([2.0, 1.0, 1.0], [2, 1, 1]).unwrap();
        let body = Body::builder(mesh)
            .region(region)
            .support(Support::fixed("x-min"))
            .load(Load::acceleration([0.0, 0.0, -0.1]))
            .build()
            .unwrap();
        let state = equilibrium(&body, 2);
        let force = unbalanced_force(&body, &state.displacement, 0.0).unwrap();
        let sum = |d: usize| force.iter().skip(d).step_by(3).sum::<f64>();
        // m g = 2 x 2 x 0.1; its moment about y, from the displaced centre of mass, is carried as well.
        assert!((sum(2) - 0.4).abs() < 1e-13 && sum(0).abs() < 1e-13 && sum(1).abs() < 1e-13);
        let mut weight = vec![0.0; body.n_dofs()];
        body.loads_at(0.0, &mut weight).unwrap();
        let [carried, loaded] = [&force, &weight].map(|force| body.moment(&state.displacement, force));
        (0..3).for_each(|d| assert!((carried[d] + loaded[d]).abs() < 1e-13, "{carried:?} {loaded:?}"));
    }
}
