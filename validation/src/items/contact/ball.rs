//! A quarter of a ball whose cells are finer towards the point of contact.

use emmy::body::{Contact, Obstacle};
use emmy::internals::contact::Layer;
use emmy::internals::element::{facet_element, facet_tangents};
use emmy::mesh::{self, FacetKind, Mesh, MeshBuilder};
use emmy::prelude::{NeoHooke, Region, Support};

/// The quarter x > 0, y > 0 of a ball about the origin; groups `x`, `y` (nodes of its planes of symmetry), `surface`.
///
/// A conformal map of the ball onto itself makes lengths at (0, 0, -radius) smaller by `finer`, and those opposite
/// larger.
///
/// # Errors
/// The message of a mesh that cannot be made.
pub(super) fn quarter(radius: f64, cells: usize, finer: f64) -> Result<Mesh, String> {
    let text = |error: emmy::Error| error.to_string();
    let ball = mesh::ball(1.0, cells).map_err(text)?;
    let shift = (finer - 1.0) / (finer + 1.0);
    let mut builder = MeshBuilder::new();
    let mut node_of = vec![u32::MAX; ball.n_nodes()];
    let mut cell_of = vec![u32::MAX; ball.n_cells()];
    for (index, cell) in ball.cells().enumerate() {
        let sum = |d: usize| cell.nodes.iter().map(|&node| ball.points()[node as usize][d]).sum::<f64>();
        if sum(0) < 0.0 || sum(1) < 0.0 {
            continue;
        }
        let mut node = |&own: &u32| {
            if node_of[own as usize] == u32::MAX {
                let place = mapped(ball.points()[own as usize], shift).map(|x| radius * x);
                node_of[own as usize] = builder.point(place);
            }
            node_of[own as usize]
        };
        let nodes: Vec<u32> = cell.nodes.iter().map(&mut node).collect();
        cell_of[index] = builder.cell(cell.kind, &nodes).map_err(text)?;
    }
    let facets = ball.groups().facets("surface").map_err(text)?;
    let own = facets.iter().filter(|facet| cell_of[facet.cell as usize] != u32::MAX);
    builder.facet_group(
        "surface",
        own.map(|facet| mesh::Facet { cell: cell_of[facet.cell as usize], ..*facet }),
    );
    let quarter = builder.build().map_err(text)?;
    let on = |d: usize| {
        let nodes = (0..quarter.n_nodes() as u32)
            .filter(|&node| quarter.points()[node as usize][d].abs() < 1e-9 * radius);
        nodes.collect::<Vec<u32>>()
    };
    let (x, y) = (on(0), on(1));
    quarter.with_node_group("x", x).and_then(|mesh| mesh.with_node_group("y", y)).map_err(text)
}

/// The translation of hyperbolic space that takes the origin to (0, 0, -shift).
fn mapped(x: [f64; 3], shift: f64) -> [f64; 3] {
    let square: f64 = x.iter().map(|x| x * x).sum();
    let along = 1.0 - 2.0 * shift * x[2];
    let below = along + shift * shift * square;
    let own = |d: usize| (1.0 - shift * shift) * x[d] - if d == 2 { (along + square) * shift } else { 0.0 };
    [0, 1, 2].map(|d| own(d) / below)
}

/// Rubber of a Young's modulus and Poisson's ratio.
///
/// # Errors
/// The message of an invalid material.
pub(super) fn rubber(young: f64, poisson: f64, density: f64) -> Result<Region, String> {
    let mu = young / (2.0 * (1.0 + poisson));
    let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    Ok(Region::new(NeoHooke::new(lambda, mu).map_err(|error| error.to_string())?, density))
}

/// Supports of the planes of symmetry.
pub(super) fn symmetry() -> [Support; 2] {
    [Support::of_components("x", [true, false, false]), Support::of_components("y", [false, true, false])]
}

/// The contact of the surface with a plane below.
pub(super) fn on_plane(height: f64, layer: Layer) -> Contact {
    let plane = Obstacle::Plane { point: [0.0, 0.0, height], normal: [0.0, 0.0, 1.0] };
    let contact = Contact::with_obstacle("surface", plane);
    contact.with_stiffness(layer.modulus).with_distance(layer.thickness).with_law(layer.law)
}

/// Radius a of the contact and largest pressure p0, by the moments of a pressure `p0 sqrt(1 - r^2/a^2)`: those of p r^2
/// and p^2 are 2/5 a^2 and 3/4 p0 of the force. p is the mean over a facet.
///
/// # Errors
/// The message of a mesh without a surface.
pub(super) fn pressure(
    mesh: &Mesh,
    displacement: &[f64],
    height: f64,
    layer: Layer,
) -> Result<[f64; 2], String> {
    let quad = facet_element(FacetKind::Quad4);
    let facets = mesh.groups().facets("surface").map_err(|error| error.to_string())?;
    let (mut force, mut second, mut squared) = (0.0, 0.0, 0.0);
    for facet in facets {
        let nodes: Vec<usize> = mesh.facet_nodes(*facet).map(|node| node as usize).collect();
        let places: Vec<[f64; 3]> = nodes.iter().map(|&node| mesh.points()[node]).collect();
        let now = |node: usize, d: usize| mesh.points()[node][d] + displacement[3 * node + d];
        let rule = quad.quadrature();
        let (mut size, mut load) = (0.0, 0.0);
        for (xi, weight) in rule.points.iter().zip(rule.weights.iter()) {
            let (mut shape, mut slopes) = ([0.0; 4], [[0.0; 2]; 4]);
            quad.shape(*xi, &mut shape);
            quad.gradient(*xi, &mut slopes);
            let at =
                [0, 1, 2].map(|d| nodes.iter().zip(shape).map(|(&node, n)| n * now(node, d)).sum::<f64>());
            let [s, t] = facet_tangents(FacetKind::Quad4, &places, &slopes);
            let normal = [s[1] * t[2] - s[2] * t[1], s[2] * t[0] - s[0] * t[2], s[0] * t[1] - s[1] * t[0]];
            let area = weight * crate::measure::norm(normal);
            let gap = at[2] - height;
            let pressure =
                -layer.slope((gap / layer.thickness).powi(2)) * 2.0 * gap / layer.thickness.powi(2);
            (size, load) = (size + area, load + area * pressure);
            second += area * pressure * (at[0] * at[0] + at[1] * at[1]);
        }
        (force, squared) = (force + load, squared + load * load / size);
    }
    Ok([(2.5 * second / force).sqrt(), 4.0 / 3.0 * squared / force])
}
