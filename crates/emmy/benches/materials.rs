//! Assembly of hex8 cells under the mid-point rule on one core, material by material: cells per second (divan's
//! "items").
//!
//! ```sh
//! cargo bench -p emmy --bench materials
//! ```

use divan::{Bencher, counter::ItemsCount};
use emmy::body::{Body, Region};
use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{StepDamping, StepInput};
use emmy::internals::quadrature::gauss;
use emmy::material::{Hencky, NeoHooke, Ogden, SaintVenantKirchhoff, Volumetric};

fn main() {
    divan::main();
}

const MATERIALS: [&str; 4] = ["neo-hooke", "saint-venant-kirchhoff", "hencky", "ogden"];

fn region(material: &str) -> Region {
    match material {
        "saint-venant-kirchhoff" => Region::new(SaintVenantKirchhoff::new(1000.0, 500.0).unwrap(), 1.0),
        "hencky" => Region::new(Hencky::new(1000.0, 500.0).unwrap(), 1.0),
        "ogden" => {
            let terms = [(400.0, 1.3), (-50.0, -2.0)];
            Region::new(Ogden::new(&terms, 1000.0, Volumetric::Logarithmic).unwrap(), 1.0)
        }
        _ => Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0),
    }
}

fn measure(bencher: Bencher<'_, '_>, material: &str, request: Request) {
    let mesh = emmy::mesh::block([1.0; 3], [16; 3]).unwrap();
    // One thread has one part.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let wave = |factor: f64| -> Vec<f64> {
        let dofs = mesh.points().iter().flatten().enumerate();
        dofs.map(|(dof, x)| factor * (2.0 * x + dof as f64 % 3.0).sin()).collect()
    };
    let (displacement, rates, rule) = (wave(0.05), wave(0.01), Rule::standard(1, &gauss(1)));
    let body = pool.install(|| Body::builder(mesh).region(region(material)).build().unwrap());
    let mut assembly = body.assembly(&rule);
    let step = StepInput {
        rule: &rule,
        tangent_factor: 1e-4,
        displacement: &displacement,
        rates: &rates,
        coordinates: &[],
        damping: StepDamping::default(),
        local: None,
    };
    let counted = bencher.counter(ItemsCount::new(body.mesh().n_cells()));
    counted.bench_local(|| body.assemble(&step, request, &[2.0], &mut assembly).unwrap());
}

#[divan::bench(args = MATERIALS)]
fn residual(bencher: Bencher<'_, '_>, material: &str) {
    measure(bencher, material, Request::Stress);
}

#[divan::bench(args = MATERIALS)]
fn residual_and_tangent(bencher: Bencher<'_, '_>, material: &str) {
    measure(bencher, material, Request::Tangent);
}
