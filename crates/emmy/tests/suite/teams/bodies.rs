//! Bodies of cells against locking, and equilibria, on a team.

use emmy::body::Formulation;

use super::*;

/// Bricks along x in the cell groups `left` and `right`, with the node groups `clamp` and `tip`.
fn bricks() -> Mesh {
    let block = mesh::block([2.0, 1.0, 1.0], [4, 2, 2]).unwrap();
    let mut builder = MeshBuilder::new();
    block.points().iter().for_each(|&point| _ = builder.point(point));
    let x = |node: u32| block.points()[node as usize][0];
    for cell in block.cells() {
        let is_left = cell.nodes.iter().all(|&node| x(node) <= 1.0);
        let index = builder.cell(cell.kind, cell.nodes).unwrap();
        builder.cell_group(if is_left { "left" } else { "right" }, [index]);
    }
    let at = |place: f64| (0..block.n_nodes() as u32).filter(move |&node| x(node) == place);
    builder.node_group("clamp", at(0.0));
    builder.node_group("tip", at(2.0));
    builder.build().unwrap()
}

/// A beam that is clamped at one end and pushed at the other.
fn pushed(parts: fn(BodyBuilder) -> BodyBuilder, scheme: Scheme) -> Case {
    Case {
        mesh: bricks(),
        parts,
        start: InitialVelocity::default(),
        scheme,
        exact_tangent: false,
        plan: plan(0.08, 0.02),
    }
}

fn push(builder: BodyBuilder) -> BodyBuilder {
    let force = Load::nodal_force("tip", [0.5, 1.0, 2.0]).over([(0.0, 1.0), (0.06, 0.0)]).unwrap();
    builder.support(Support::fixed("clamp")).load(force)
}

/// Incompatible modes in one half of a beam.
fn incompatible(builder: BodyBuilder) -> BodyBuilder {
    let heavy = Region::new(SaintVenantKirchhoff::new(900.0, 700.0).unwrap(), 2.0).on("right");
    let modes = rubber().on("left").with_formulation(Formulation::IncompatibleModes);
    push(builder).region(modes).region(heavy)
}

#[test]
fn incompatible_modes_are_those_of_the_whole_body() {
    for degree in 1..=2 {
        pushed(incompatible, at(DGM, degree)).assert_equal(2..=4, 1e-12);
    }
    Case { exact_tangent: true, ..pushed(incompatible, at(assumed_strain(5), 2)) }.assert_equal([3], 1e-12);
}

/// Projected volumes in one half of a beam, where K/mu = 17.
fn projected(builder: BodyBuilder) -> BodyBuilder {
    let viscosity = Viscosity { time: 0.01, shear: 1.0, bulk: 1.0 };
    let firm = Region::new(NeoHooke::new(8000.0, 500.0).unwrap(), 0.5).on("left");
    let firm = firm.with_formulation(Formulation::ProjectedVolume(None)).with_viscosity(viscosity);
    push(builder).region(firm).region(rubber().on("right")).drag(0.2)
}

#[test]
fn projected_volumes_are_those_of_the_whole_body() {
    for scheme in [fe(1), at(DGM, 1), at(DGM, 2)] {
        pushed(projected, scheme).assert_equal(2..=4, 1e-12);
    }
    Case { exact_tangent: true, ..pushed(projected, at(assumed_strain(5), 2)) }.assert_equal([3], 1e-12);
}
