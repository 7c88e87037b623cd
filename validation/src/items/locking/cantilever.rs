//! Bending of a slender cantilever, compressible and nearly incompressible.

use emmy::body::PressureSpace::{Constant, Linear};
use emmy::body::{Body, Load, Region, Support};
use emmy::material::{NeoHookeIsochoric, Volumetric};
use emmy::mesh::CellKind::{Hex8, Hex20, Hex27, Pyramid5, Pyramid13, Tet4, Tet10, Wedge6, Wedge15};

use Verdict::{Locks, Right, Soft, Stiff};

use super::grid::Grid;
use super::{Element, displacement_of};
use crate::claim::Item;
use crate::items::Effort;
use crate::picture::Pictures;

const LENGTH: f64 = 10.0;

/// Verdict on a deflection over beam theory.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Verdict {
    /// Below 0.8.
    Locks,
    /// Below 0.98.
    Stiff,
    /// From 0.98 to 1.02.
    Right,
    /// Above 1.02.
    Soft,
}

impl Verdict {
    fn of(deflection: f64) -> Self {
        match deflection {
            x if x < 0.8 => Locks,
            x if x < 0.98 => Stiff,
            x if x <= 1.02 => Right,
            _ => Soft,
        }
    }
}

/// Elements with their verdicts.
const ELEMENTS: [(Element, [Verdict; 4]); 18] = [
    (Element::standard("hex8", Hex8), [Locks; 4]),
    (Element::projected("hex8, constant", Hex8, Constant), [Soft, Locks, Soft, Stiff]),
    (Element::modes("hex8, modes", Hex8), [Right, Locks, Stiff, Locks]),
    (Element::standard("hex20", Hex20), [Right, Stiff, Right, Locks]),
    (Element::projected("hex20, linear", Hex20, Linear), [Right, Stiff, Right, Stiff]),
    (Element::standard("hex27", Hex27), [Right; 4]),
    (Element::projected("hex27, linear", Hex27, Linear), [Right; 4]),
    (Element::standard("wedge6", Wedge6), [Locks; 4]),
    (Element::projected("wedge6, constant", Wedge6, Constant), [Locks; 4]),
    (Element::standard("wedge15", Wedge15), [Right, Locks, Stiff, Locks]),
    (Element::projected("wedge15, linear", Wedge15, Linear), [Right, Locks, Right, Locks]),
    (Element::standard("pyramid5", Pyramid5), [Locks; 4]),
    (Element::projected("pyramid5, constant", Pyramid5, Constant), [Locks; 4]),
    (Element::standard("pyramid13", Pyramid13), [Right, Locks, Stiff, Locks]),
    (Element::projected("pyramid13, linear", Pyramid13, Linear), [Right, Stiff, Right, Locks]),
    (Element::standard("tet4", Tet4), [Locks; 4]),
    (Element::standard("tet10", Tet10), [Right, Locks, Stiff, Locks]),
    (Element::projected("tet10, constant", Tet10, Constant), [Soft, Stiff, Soft, Stiff]),
];

/// The table's columns.
const CASES: [(f64, f64); 4] = [(0.3, 0.0), (0.3, 0.25), (0.4999, 0.0), (0.4999, 0.25)];

/// Deflection of the tip under a small transverse force, over Timoshenko's `F L^3 / (3 E I) + F L / (5/6 G A)`: ten
/// linear or five quadratic cells, their inner faces tilted by a part of a cell. The wall holds the axial displacement
/// alone, as beam theory does.
fn deflection(element: Element, poisson: f64, tilt: f64) -> Result<f64, String> {
    let text = |error: emmy::Error| error.to_string();
    let n = if element.kind == element.kind.linear() { 10 } else { 5 };
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
        "A bar of 10 x 1 x 1 of ten linear or five quadratic bricks, some divided into wedges, pyramids or tetrahedra, under a small transverse \
        force at its end: deflection over the beam theory of Timoshenko. Skewed: inner faces tilted by a quarter of a brick to either side. \
        An element locks below 0.8, is stiff below 0.98, right to 1.02, and soft above.",
    );
    let header = ["element", "nu = 0.3", "skewed", "nu = 0.4999", "skewed"].map(String::from).to_vec();
    let mut table = vec![header];
    for (element, verdicts) in ELEMENTS {
        let found = CASES.iter().map(|&(poisson, tilt)| deflection(element, poisson, tilt));
        let found = found.collect::<Result<Vec<f64>, String>>()?;
        let numbers = found.iter().map(|found| format!("{found:.3}")).collect::<Vec<_>>();
        item.claim(
            format!(
                "{}: {}",
                element.label,
                verdicts.map(|verdict| format!("{verdict:?}").to_lowercase()).join(", ")
            ),
            numbers.join(", "),
            found.iter().zip(verdicts).all(|(&found, verdict)| Verdict::of(found) == verdict),
        );
        table.push(std::iter::once(element.label.to_string()).chain(numbers).collect());
    }
    item.tables.push(table);
    item.commands.push("cargo run --release -p emmy-validation -- --only cantilever".into());
    Ok(item)
}
