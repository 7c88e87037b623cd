//! Bodies of many regions: regions per second (divan's "items"), the same for few and many if the cost is linear.
//!
//! ```sh
//! cargo bench -p emmy --bench regions
//! ```

use divan::{Bencher, counter::ItemsCount};
use emmy::body::{Body, Region};
use emmy::material::Link;
use emmy::mesh::{CellKind, Mesh, MeshBuilder};

fn main() {
    divan::main();
}

/// Links in a row, each a group of its own.
fn chain(n_links: u32) -> Mesh {
    let mut builder = MeshBuilder::new();
    for i in 0..=n_links {
        builder.point([i.into(), 0.0, 0.0]);
    }
    for i in 0..n_links {
        let cell = builder.cell(CellKind::Line2, &[i, i + 1]).unwrap();
        builder.cell_group(&i.to_string(), [cell]);
    }
    builder.build().unwrap()
}

fn region(i: u32) -> Region {
    Region::links(Link::bar(1.0, 1.0).unwrap(), 1.0).on(i.to_string())
}

#[divan::bench(args = [1_000, 16_000])]
fn body(bencher: Bencher<'_, '_>, n_regions: u32) {
    let mesh = chain(n_regions);
    bencher
        .counter(ItemsCount::new(n_regions))
        .with_inputs(|| (mesh.clone(), (0..n_regions).map(region).collect::<Vec<_>>()))
        .bench_values(|(mesh, regions)| Body::builder(mesh).regions(regions).build().unwrap());
}
