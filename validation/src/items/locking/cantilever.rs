//! Bending of a slender cantilever, compressible and nearly incompressible.

use emmy::body::PressureSpace::{Constant, Linear};
use emmy::body::{Body, Load, Region, Support};
use emmy::material::{NeoHookeIsochoric, Volumetric};
use emmy::mesh::CellKind::{Hex8, Hex20, Hex27};

use super::grid::Grid;
use super::{Element, displacement_of};
use crate::claim::Item;
use crate::items::Effort;
use crate::picture::Pictures;

const LENGTH: f64 = 10.0;

/// Elements, with bounds for their deflections over beam theory: nu = 0.3 and 0.4999, regular and skewed cells.
const ELEMENTS: [(Element, [(f64, f64); 4]); 6] = [
    (Element::standard("hex8", Hex8), [LOCKS, LOCKS, LOCKS, LOCKS]),
    (Element::projected("hex8, constant", Hex8, Constant), [SOFT, LOCKS, SOFT, (0.8, 0.9)]),
    (Element::standard("hex20", Hex20), [BENDS, (0.85, 0.95), BENDS, LOCKS]),
    (Element::projected("hex20, linear", Hex20, Linear), [BENDS, (0.9, 1.01), BENDS, (0.9, 1.01)]),
    (Element::standard("hex27", Hex27), [BENDS; 4]),
    (Element::projected("hex27, linear", Hex27, Linear), [BENDS; 4]),
];
const LOCKS: (f64, f64) = (0.0, 0.8);
const SOFT: (f64, f64) = (1.15, 1.5);
const BENDS: (f64, f64) = (0.98, 1.01);
/// The table's columns.
const CASES: [(f64, f64); 4] = [(0.3, 0.0), (0.3, 0.25), (0.4999, 0.0), (0.4999, 0.25)];

/// Deflection of the tip under a small transverse force, over Timoshenko's `F L^3 / (3 E I) + F L / (5/6 G A)`:
/// ten linear or five quadratic cells, their inner faces tilted by a part of a cell. The wall holds the axial displacement
/// alone, as beam theory does.
fn deflection(element: Element, poisson: f64, tilt: f64) -> Result<f64, String> {
    let text = |error: emmy::Error| error.to_string();
    let n = if element.kind == Hex8 { 10 } else { 5 };
    let map = |[x, y, z]: [f64; 3]| [(x + tilt * tilted(x, n) * (2.0 * y - 1.0)) * LENGTH / n as f64, y, z];
    let mesh = Grid { kind: element.kind, n: [n, 1, 1], map: &map }
        .mesh(&[("wall", &|x| x[0] < 1e-9), ("end", &|x| x[0] > LENGTH - 1e-9)])?;
    let at = |point: [f64; 3]| [mesh.nearest_node(point) as u32];
    let (foot, side) = (at([0.0; 3]), at([0.0, 0.0, 1.0]));
    let mesh = mesh.with_node_group("foot", foot).and_then(|mesh| mesh.with_node_group("side", side));
    let mesh = mesh.map_err(text)?;
    let mu = 0.5 / (1.0 + poisson);
    let bulk_modulus = 1.0 / (3.0 * (1.0 - 2.0 * poisson));
    let rubber = NeoHookeIsochoric::new(mu, bulk_modulus, Volumetric::SimoTaylor).map_err(text)?;
    let force = 1e-8;
    let body = Body::builder(mesh)
        .region(Region::new(rubber, 1.0).with_formulation(element.formulation))
        .support(Support::of_components("wall", [true, false, false]))
        .support(Support::fixed("foot"))
        .support(Support::of_components("side", [false, true, false]))
        .load(Load::force("end", [0.0, force, 0.0]))
        .build()
        .map_err(text)?;
    let tip = displacement_of(&body, 1, [LENGTH, 0.0, 0.0])?[1];
    Ok(tip / (force * (LENGTH.powi(3) / (3.0 / 12.0) + LENGTH / (5.0 / 6.0 * mu))))
}

/// 1 and -1 at inner faces in turn, 0 at the ends, linear between.
fn tilted(x: f64, n: usize) -> f64 {
    let at = |i: f64| if i < 0.5 || i > n as f64 - 0.5 { 0.0 } else { 1.0 - 2.0 * (i % 2.0) };
    let part = x - x.floor();
    (1.0 - part) * at(x.floor()) + part * at(x.floor() + 1.0)
}

/// The cantilever with each element.
pub(in crate::items) fn item(_: Effort, _: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "cantilever",
        "Elements that do not lock: a cantilever",
        "A bar of 10 x 1 x 1 of ten linear or five quadratic cells under a small transverse force at its end: deflection over the beam theory of \
        Timoshenko. Skewed: inner faces tilted by a quarter of a cell to either side. Both a too small (locking) and a too large number \
        (constant pressure in bending) disqualify an element for slender parts.",
    );
    let header = ["element", "nu = 0.3", "skewed", "nu = 0.4999", "skewed"].map(String::from).to_vec();
    let mut table = vec![header];
    for (element, bounds) in ELEMENTS {
        let found = CASES.iter().map(|&(poisson, tilt)| deflection(element, poisson, tilt));
        let found = found.collect::<Result<Vec<f64>, String>>()?;
        let holds = found.iter().zip(bounds).all(|(found, (low, high))| (low..high).contains(found));
        let words = found.iter().map(|found| format!("{found:.3}")).collect::<Vec<_>>();
        item.claim(statement(element, bounds), words.join(", "), holds);
        table.push(std::iter::once(element.label.to_string()).chain(words).collect());
    }
    item.tables.push(table);
    item.commands.push("cargo run --release -p emmy-validation -- --only cantilever".into());
    Ok(item)
}

fn statement(element: Element, bounds: [(f64, f64); 4]) -> String {
    let bounds = bounds
        .map(|(low, high)| if low == 0.0 { format!("below {high}") } else { format!("{low} to {high}") });
    format!("{}: deflection over beam theory {}", element.label, bounds.join(", "))
}
