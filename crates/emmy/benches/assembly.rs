//! Assembly on one core: cells per second (divan's "items"), residual alone and with its tangent.
//!
//! ```sh
//! cargo bench -p emmy --bench assembly               # all
//! cargo bench -p emmy --bench assembly hex8          # names with hex8
//! ```
//!
//! Share of the peak. Floating-point operations of a hex8 cell of neo-Hooke material under FE(1), counted by the
//! formulas (a fused multiplication and addition is two, a division, root or comparison is one), at each of 8 points:
//!
//! ```text
//! residual                                               tangent, beside the residual
//!   sum u (x) dN/dxi       8 nodes x 9 x 2       144       elasticity D   21 x 7           150
//!   times dxi/dX           9 x 5                  45       D B(F)         6 x 9 x 5        270
//!   det F                                         20       F (D B)        45 x 5           225
//!   E                      6 x 8                  48       geometric part                   18
//!   S: C^-1, ln J, sums                          150       share of the point               81
//!   P = F S                9 x 6                  54       dN/dX          8 x 3 x 6        144
//!   w P J^-T               9 x 6                  54       grad N_A . dP/dF   8 x 27 x 5  1080
//!   force                  8 nodes x 9 x 2       144       times grad N_B    36 x 27 x 2  1944
//!   sum                                          659       sum                            3912
//! ```
//!
//! So 5300 for a residual and 36600 for both. `emmy-bench assembly` measures the peak and the share of it.

use divan::{Bencher, black_box, counter::ItemsCount};
use emmy::body::{Body, Region};
use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{StepDamping, StepInput};
use emmy::internals::quadrature::gauss;
use emmy::material::NeoHooke;
use emmy::mesh::CellKind;

#[path = "../tests/suite/shared/cells.rs"]
mod cells;
#[path = "../tests/suite/shared/patch.rs"]
mod patch;

fn main() {
    divan::main();
}

/// A body in a step.
struct Step {
    body: Body,
    displacement: Vec<f64>,
    rates: Vec<f64>,
}

const KINDS: [&str; 5] = ["hex8", "hex20", "hex27", "tet4", "tet10"];
const RULES: [&str; 4] = ["FE(1)", "AS(1)", "AS(5)", "DGM"];

/// Kind of cell and number of bricks along an edge: more than the caches hold.
fn division(kind: &str) -> (CellKind, usize) {
    match kind {
        "hex20" => (CellKind::Hex20, 12),
        "hex27" => (CellKind::Hex27, 10),
        "tet4" => (CellKind::Tet4, 16),
        "tet10" => (CellKind::Tet10, 10),
        _ => (CellKind::Hex8, 24),
    }
}

fn rule(name: &str) -> Rule {
    match name {
        "AS(1)" => Rule::assumed_strain(1, 1),
        "AS(5)" => Rule::assumed_strain(1, 5),
        "DGM" => Rule::discrete_gradient(1),
        _ => Rule::standard(1, &gauss(1)),
    }
}

impl Step {
    fn new(kind: &str, region: Region) -> Step {
        let (kind, bricks) = division(kind);
        let mesh = patch::Patch { bricks, curved: true, distortion: 1.0 }.mesh(kind);
        // One thread has one part.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let wave = |factor: f64| -> Vec<f64> {
            let dofs = mesh.points().iter().flatten().enumerate();
            dofs.map(|(dof, x)| factor * (2.0 * x + dof as f64 % 3.0).sin()).collect()
        };
        let (displacement, rates) = (wave(0.05), wave(0.01));
        let body = pool.install(|| Body::builder(mesh).region(region).build().unwrap());
        Step { body, displacement, rates }
    }

    fn measure(&self, bencher: Bencher<'_, '_>, rule: &Rule, request: Request) {
        let mut assembly = self.body.assembly(rule);
        let Step { body, displacement, rates } = self;
        let step = StepInput {
            rule,
            tangent_factor: 1e-4,
            displacement,
            rates,
            coordinates: &[],
            damping: StepDamping::default(),
            local: None,
        };
        let counted = bencher.counter(ItemsCount::new(body.mesh().n_cells()));
        counted.bench_local(|| body.assemble(&step, request, &[2.0], &mut assembly).unwrap());
    }
}

fn neo_hooke() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0)
}

/// Every kind with every rule.
fn cases() -> impl Iterator<Item = String> {
    KINDS.into_iter().flat_map(|kind| RULES.map(|rule| format!("{kind} {rule}")))
}

fn measure(bencher: Bencher<'_, '_>, case: &str, request: Request) {
    let (kind, name) = case.split_once(' ').unwrap();
    Step::new(kind, neo_hooke()).measure(bencher, &rule(name), request);
}

#[divan::bench(args = cases())]
fn residual(bencher: Bencher<'_, '_>, case: &str) {
    measure(bencher, case, Request::Stress);
}

#[divan::bench(args = cases())]
fn residual_and_tangent(bencher: Bencher<'_, '_>, case: &str) {
    measure(bencher, case, Request::Tangent);
}

#[divan::bench(args = KINDS)]
fn strain_energy(bencher: Bencher<'_, '_>, kind: &str) {
    let Step { body, displacement, .. } = Step::new(kind, neo_hooke());
    let counted = bencher.counter(ItemsCount::new(body.mesh().n_cells()));
    counted.bench_local(|| body.strain_energy(black_box(&displacement)));
}
