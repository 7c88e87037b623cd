//! Cook's membrane of nearly incompressible rubber in plane strain.

use emmy::body::PressureSpace::{Constant, Linear};
use emmy::body::{Body, Load, Region, Support};
use emmy::material::{NeoHookeIsochoric, Volumetric};
use emmy::mesh::CellKind::{Quad4, Quad8, Quad9, Tri6};

use super::grid::Grid;
use super::{Element, displacement_of};
use crate::claim::Item;
use crate::items::Effort;
use crate::picture::{Pictures, Series};

/// Element choices with the results of an independent implementation on 4 x 4, 8 x 8 and 16 x 16 squares.
const ELEMENTS: [(Element, [f64; 3]); 8] = [
    (Element::standard("quad4", Quad4), [2.163, 2.219, 2.381]),
    (Element::projected("quad4, constant", Quad4, Constant), [6.020, 6.619, 6.814]),
    (Element::modes("quad4, modes", Quad4), [6.303, 6.672, 6.820]),
    (Element::projected("quad8, linear", Quad8, Linear), [6.618, 6.812, 6.880]),
    (Element::standard("quad9", Quad9), [5.917, 6.519, 6.758]),
    (Element::projected("quad9, linear", Quad9, Linear), [6.873, 6.903, 6.920]),
    (Element::standard("tri6", Tri6), [5.823, 6.467, 6.743]),
    (Element::projected("tri6, constant", Tri6, Constant), [7.032, 6.986, 6.958]),
];
const COMPARED: [usize; 3] = [4, 8, 16];

/// The deflection to which all choices converge.
const LIMIT: f64 = 6.93;

/// F-bar quadrilaterals of the benchmark "Cook's membrane, large deformation" of OpenGeoSys: squares along an edge,
/// deflection.
const F_BAR: [(usize, f64); 5] = [(4, 6.141), (10, 6.746), (15, 6.824), (20, 6.859), (30, 6.891)];

/// Vertical displacement of the corner (48, 60) under a vertical force of 100 on the free end.
fn deflection(element: Element, n: usize) -> Result<f64, String> {
    let text = |error: emmy::Error| error.to_string();
    let map = |x: [f64; 3]| {
        let [s, t] = [x[0] / n as f64, x[1] / n as f64];
        [48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s), 0.0]
    };
    let mesh = Grid { kind: element.kind, n: [n, n, 1], map: &map }
        .mesh(&[("wall", &|x| x[0] < 1e-9), ("end", &|x| x[0] > 48.0 - 1e-9)])?;
    let rubber = NeoHookeIsochoric::new(80.1938, 400942.0, Volumetric::Quadratic).map_err(text)?;
    let body = Body::builder(mesh)
        .region(Region::new(rubber, 1.0).with_formulation(element.formulation))
        .support(Support::fixed("wall"))
        .load(Load::force("end", [0.0, 100.0, 0.0]))
        .build()
        .map_err(text)?;
    Ok(displacement_of(&body, 5, [48.0, 60.0, 0.0])?[1])
}

/// The membrane with each element, and its chart.
pub(in crate::items) fn item(effort: Effort, pictures: &Pictures) -> Result<Item, String> {
    let mut item = Item::new(
        "cook",
        "Elements that do not lock: Cook's membrane",
        "A tapered panel of rubber in plane strain (corners (0, 0), (48, 44), (48, 60), (0, 44); isochoric neo-Hooke, mu = 80.1938, \
        K = 400942, K/2 (J - 1)^2), fixed at the left, with a vertical force of 100 on the right: vertical displacement of the upper \
        right corner. R. D. Cook, J. Struct. Div. ASCE 100 (1974) 1851; E. A. de Souza Neto et al., Int. J. Solids Struct. 33 (1996) \
        3277; T. Elguedj et al., Comput. Methods Appl. Mech. Engrg. 197 (2008) 2732.",
    );
    let sizes: &[usize] = if effort.quick { &[2, 4, 8, 16] } else { &[2, 4, 8, 16, 32] };
    let mut curves = Vec::new();
    for (element, expected) in ELEMENTS {
        let deflections = sizes.iter().map(|&n| Ok((n, deflection(element, n)?)));
        let deflections = deflections.collect::<Result<Vec<(usize, f64)>, String>>()?;
        compare(&mut item, element, &deflections, expected);
        curves.push((element, deflections));
    }
    f_bar(&mut item)?;
    show(&mut item, pictures, sizes, &curves)?;
    item.commands.push("cargo run --release -p emmy-validation -- --only cook".into());
    Ok(item)
}

/// The numbers of the other implementation have three decimals.
fn compare(item: &mut Item, element: Element, deflections: &[(usize, f64)], expected: [f64; 3]) {
    let at = |n: usize| deflections.iter().find(|point| point.0 == n).map_or(f64::NAN, |point| point.1);
    let errors = COMPARED.map(at).into_iter().zip(expected).map(|(found, expected)| (found - expected).abs());
    let largest = errors.fold(0.0, f64::max);
    item.claim(
        format!("{}: the deflections of an independent implementation", element.label),
        format!("{} on {:?} squares; largest difference {largest:.1e}", words(&COMPARED.map(at)), COMPARED),
        largest < 6e-4,
    );
    let (name, missing) = (element.label, 1.0 - at(16) / LIMIT);
    let is_free = element.formulation != emmy::body::Formulation::Standard;
    let measured = format!("{:+.1} % on 16 x 16", -100.0 * missing);
    match (is_free, element.kind) {
        (true, _) => {
            item.claim(format!("{name} is within 2 % of the limit {LIMIT}"), measured, missing.abs() < 0.02)
        }
        (false, Quad4) => item.claim(format!("{name} locks"), measured, missing > 0.5),
        (false, _) => item.claim(format!("{name} locks mildly"), measured, missing > 0.02),
    }
}

fn words(values: &[f64]) -> String {
    values.iter().map(|value| format!("{value:.3}")).collect::<Vec<_>>().join(", ")
}

/// F-bar has another volume in each cell, the one in its middle.
fn f_bar(item: &mut Item) -> Result<(), String> {
    let mut largest = 0f64;
    for (n, expected) in F_BAR {
        largest = largest.max((deflection(ELEMENTS[1].0, n)? / expected - 1.0).abs());
    }
    item.claim(
        "quad4 with a constant pressure agrees with the F-bar quadrilaterals of OpenGeoSys within 2 %",
        format!("largest difference {:.1} %", 100.0 * largest),
        largest < 0.02,
    );
    Ok(())
}

fn show(
    item: &mut Item,
    pictures: &Pictures,
    sizes: &[usize],
    curves: &[(Element, Vec<(usize, f64)>)],
) -> Result<(), String> {
    let point = |&(n, value): &(usize, f64)| (n as f64, value);
    let series = curves
        .iter()
        .map(|(element, points)| Series::marked(element.label, points.iter().map(point).collect()));
    let others = Series::marked("F-bar (OpenGeoSys)", F_BAR.iter().map(point).collect());
    item.pictures.push(pictures.linear(
        "cook",
        "Cook's membrane of nearly incompressible rubber",
        ["squares along an edge", "vertical displacement of the corner"],
        series.chain([others]).collect(),
    )?);
    let header = std::iter::once("squares".to_string());
    let header = header.chain(curves.iter().map(|(element, _)| element.label.to_string())).collect();
    let row = |(index, n): (usize, &usize)| {
        let values = curves.iter().map(|(_, points)| format!("{:.3}", points[index].1));
        std::iter::once(format!("{n} x {n}")).chain(values).collect()
    };
    item.tables.push(std::iter::once(header).chain(sizes.iter().enumerate().map(row)).collect());
    Ok(())
}
