//! Cells and materials of the regions.

use std::fmt::Write;

use fastrand::Rng;

use super::{chosen, number};
use crate::features::Choice;
use crate::reference::body::{Formulation, Material};
use crate::reference::cells::Kind;
use crate::reference::energies::Energy;

pub(super) fn cells(name: &str, needs_two: bool) -> (Kind, usize) {
    match name {
        "hex8" => (Kind::Hex8, 2),
        "hex20" => (Kind::Hex20, 1 + usize::from(needs_two)),
        "tet4" => (Kind::Tet4, 1),
        "tet10" => (Kind::Tet10, 1),
        "wedge6" => (Kind::Wedge6, 1),
        "quad4" => (Kind::Quad4, 2),
        "quad8" => (Kind::Quad8, 2),
        "hex27" => (Kind::Hex27, 1 + usize::from(needs_two)),
        "wedge15" => (Kind::Wedge15, 1),
        "quad9" => (Kind::Quad9, 2),
        "tri3" => (Kind::Tri3, 2),
        _ => (Kind::Tri6, 1),
    }
}

pub(super) fn materials(choice: &Choice, kind: Kind, rng: &mut Rng) -> [Material; 2] {
    let mu = number(rng, 45.0, 60.0);
    let lambda = number(rng, 60.0, 90.0);
    let neo_hooke = Energy::NeoHooke { lambda, mu };
    let saint_venant = Energy::SaintVenantKirchhoff { lambda, mu };
    let energy = match chosen(choice, "material") {
        "saint-venant-kirchhoff" => saint_venant.clone(),
        "mooney-rivlin" => Energy::MooneyRivlin { c10: 0.35 * mu, c01: 0.15 * mu, bulk: lambda },
        "formula" => Energy::Formula { c: 0.5 * mu, b: 1.5, bulk: lambda },
        "fibres" => {
            let fibre = if kind.dimension() == 2 { [1.0, 2.0, 0.0] } else { [1.0, 2.0, 0.5] };
            Energy::Fibres { mu, k1: 30.0, k2: 1.5, kappa: 0.1, fibre, bulk: lambda }
        }
        _ => neo_hooke,
    };
    let viscosity = match chosen(choice, "damping") {
        "viscous-time" => [0.004, 0.0, 0.0],
        "viscous-shear" => [0.0, 0.3, 0.2],
        _ => [0.0; 3],
    };
    let takes_linear = matches!(kind, Kind::Quad8 | Kind::Quad9 | Kind::Wedge15 | Kind::Hex20 | Kind::Hex27);
    let formulation = match chosen(choice, "formulation") {
        "projected-volume" if takes_linear => Formulation::Linear,
        "projected-volume" => Formulation::Constant,
        "incompatible-modes" => Formulation::Modes,
        _ => Formulation::Standard,
    };
    let first = Material { energy, density: number(rng, 1.0, 1.5), viscosity, formulation };
    let second = match chosen(choice, "material") {
        "two" => Material { energy: saint_venant, density: 0.8 * first.density, ..first.clone() },
        _ => first.clone(),
    };
    [first, second]
}

pub(super) fn regions(
    choice: &Choice,
    materials: &[Material; 2],
    has_second: bool,
    thickness: f64,
) -> String {
    let is_two = chosen(choice, "material") == "two" && has_second;
    let mut text = String::new();
    for (material, group) in materials.iter().zip(["one", "two"]).take(1 + usize::from(is_two)) {
        let _ = writeln!(text, "[[region]]");
        if is_two {
            let _ = writeln!(text, "group = \"{group}\"");
        }
        let _ = writeln!(text, "density = {:?}\nmaterial.{}", material.density, material.energy.text());
        if thickness != 1.0 {
            let _ = writeln!(text, "thickness = {thickness:?}");
        }
        match material.viscosity {
            [0.0, 0.0, 0.0] => {}
            [time, 0.0, 0.0] => text += &format!("viscosity = {{ time = {time:?} }}\n"),
            [_, shear, bulk] => text += &format!("viscosity = {{ shear = {shear:?}, bulk = {bulk:?} }}\n"),
        }
        let _ = writeln!(text, "formulation = \"{}\"\n", chosen(choice, "formulation"));
    }
    text
}
