//! A model of many processes from numbers of this machine: where the time of a step goes, and what breaks first.
//!
//!     RAYON_NUM_THREADS=1 cargo run --release --example scaling_model [CELLS]
//!
//! Neighbours, guests and cells computed twice come from real partitions of the L-shaped block with CELLS (16) cells a unit
//! length into 8 to 4,096 parts; sums and exchanges of a step from a motion whose calls are counted; time and memory of a
//! degree of freedom from a motion of one process. The network is assumed: see `LATENCY` and `BANDWIDTH`. Nothing here is a
//! measurement of more than one machine.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use emmy::mesh::{self, Share, owners};
use emmy::motion::Solver;
use emmy::prelude::*;
use emmy::team::{Parcel, Team, Threads};

/// Assumed: seconds a message, bytes a second of a rank.
const LATENCY: f64 = 2e-6;
const BANDWIDTH: f64 = 1e9;

/// Ranks of a partition that are looked at.
const SAMPLES: usize = 12;

/// Steps of the motions.
const STEPS: usize = 10;

/// A team that counts its calls.
#[derive(Debug)]
struct Counting {
    team: Arc<dyn Team>,
    sums: AtomicUsize,
    exchanges: AtomicUsize,
}

impl Team for Counting {
    fn size(&self) -> usize {
        self.team.size()
    }

    fn rank(&self) -> usize {
        self.team.rank()
    }

    fn sum(&self, name: &'static str, values: &mut [f64]) {
        self.sums.fetch_add(1, Ordering::Relaxed);
        self.team.sum(name, values);
    }

    fn largest(&self, name: &'static str, values: &mut [f64]) {
        self.sums.fetch_add(1, Ordering::Relaxed);
        self.team.largest(name, values);
    }

    fn exchange(&self, name: &'static str, parcels: &mut [Parcel]) {
        self.exchanges.fetch_add(1, Ordering::Relaxed);
        self.team.exchange(name, parcels);
    }
}

/// Steps of the spinning block with cells of a size; seconds a step, and linear iterations of all steps.
fn spin(body: &Body, cell_size: f64) -> emmy::Result<(f64, usize)> {
    let spin = InitialVelocity {
        angular_velocity: [0.3, 0.5, 0.8],
        gradient: [[0.2, 0.0, 0.0], [0.0, -0.1, 0.0], [0.0, 0.0, 0.02]],
        ..Default::default()
    };
    let settings = NewtonSettings { solver: Solver::Iterative, ..Default::default() };
    let state = State::initial(body, 0.0, &[spin])?;
    let mut motion = Motion::starting(body, TimeElement::discrete_gradient(1)?, settings, state)?;
    // The same Courant number for every mesh.
    let size = 0.08 * cell_size;
    motion.step(size)?;
    let start = Instant::now();
    for _ in 0..STEPS {
        motion.step(size)?;
    }
    Ok((start.elapsed().as_secs_f64() / STEPS as f64, motion.statistics().linear_iterations))
}

fn rubber() -> emmy::Result<Region> {
    Ok(Region::new(NeoHooke::new(1000.0, 500.0)?, 0.5))
}

/// Calls of a step: sums and largest values, exchanges.
fn calls() -> emmy::Result<[f64; 2]> {
    let mesh = mesh::l_block(0.5)?;
    let owners = owners(&mesh, 2)?;
    let counted = Threads::run(2, |team| {
        let counting = Arc::new(Counting { team, sums: AtomicUsize::new(0), exchanges: AtomicUsize::new(0) });
        let share = Share::new(&mesh, &owners, counting.rank());
        let body = Body::shared(share, counting.clone()).region(rubber()?).build()?;
        let before = [&counting.sums, &counting.exchanges].map(|calls| calls.load(Ordering::Relaxed));
        spin(&body, 0.5)?;
        let after = [&counting.sums, &counting.exchanges].map(|calls| calls.load(Ordering::Relaxed));
        Ok([0, 1].map(|i| (after[i] - before[i]) as f64 / (STEPS + 1) as f64))
    });
    let mut ranks = counted.map_err(|error| emmy::Error::Linear { reason: error.to_string() })?;
    ranks.swap_remove(0)
}

/// Largest resident memory of this process so far, in bytes (Linux).
fn peak_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kilobytes| 1024.0 * kilobytes)
}

/// What the ranks of a partition have, as means over the ranks that were looked at; the largest number of neighbours.
struct Partition {
    own: f64,
    guests: f64,
    extra_cells: f64,
    neighbours: usize,
}

fn partition(mesh: &Mesh, size: usize) -> emmy::Result<Partition> {
    let owners = owners(mesh, size)?;
    let ranks: Vec<usize> = (0..size).step_by(size.div_ceil(SAMPLES)).collect();
    let shares = ranks.iter().map(|&rank| Share::new(mesh, &owners, rank));
    let (mut own, mut guests, mut cells, mut counted, mut neighbours) = (0, 0, 0, 0, 0);
    for share in shares {
        own += share.n_own();
        guests += share.mesh().n_nodes() - share.n_own();
        cells += share.mesh().n_cells();
        counted += share.n_counted_cells();
        neighbours = neighbours.max(share.neighbours().count());
    }
    let mean = |sum: usize| sum as f64 / ranks.len() as f64;
    Ok(Partition {
        own: mean(own),
        guests: mean(guests),
        extra_cells: cells as f64 / counted as f64 - 1.0,
        neighbours,
    })
}

fn main() -> emmy::Result<()> {
    let cells: f64 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(16.0);
    let before = peak_memory();
    let body = Body::builder(mesh::l_block(0.25)?).region(rubber()?).build()?;
    let (seconds, iterations) = spin(&body, 0.25)?;
    let n = body.n_dofs() as f64;
    let (per_dof, memory) = (seconds / n, (peak_memory() - before) / n);
    let [sums, exchanges] = calls()?;
    println!("One process, {n} degrees of freedom, DGM of degree 1, Courant number 5:");
    println!("{:.2} us a degree of freedom and step, {memory:.0} bytes a degree of freedom,", 1e6 * per_dof);
    println!("{:.1} linear iterations a step.", iterations as f64 / (STEPS + 1) as f64);
    println!("Two ranks: {sums:.0} sums and {exchanges:.0} exchanges a step.\n");

    let mesh = mesh::l_block(1.0 / cells)?;
    println!(
        "| parts of {} nodes | own nodes | guests | guests/own^(2/3) | cells more | most neighbours |",
        mesh.n_nodes()
    );
    println!("|---|---|---|---|---|---|");
    let mut surface: f64 = 0.0;
    let mut most_neighbours = 0;
    for size in [8, 64, 512, 4096] {
        let Partition { own, guests, extra_cells, neighbours } = partition(&mesh, size)?;
        let factor = guests / own.powf(2.0 / 3.0);
        println!(
            "| {size} | {own:.0} | {guests:.0} | {factor:.2} | {:.0} % | {neighbours} |",
            100.0 * extra_cells
        );
        // Small parts have more guests for their surface than large ones.
        surface = if surface == 0.0 { factor } else { surface.max(factor) };
        most_neighbours = most_neighbours.max(neighbours);
    }

    println!("\n| 10,000 ranks, degrees of freedom a rank | 100,000 | 10,000 |");
    println!("|---|---|---|");
    let ranks: f64 = 1e4;
    let columns = [1e5, 1e4].map(|dofs: f64| {
        let guests = surface * (dofs / 3.0).powf(2.0 / 3.0);
        let compute = per_dof * dofs;
        // Half of a step is assembly, which computes cells at the border twice: about half a layer of cells.
        let twice = 0.5 * compute * 0.5 * guests / (dofs / 3.0);
        let exchange = exchanges * (most_neighbours as f64 * LATENCY + 24.0 * guests / BANDWIDTH);
        let sum = sums * (ranks.log2().ceil() * LATENCY + 8.0 * ranks / BANDWIDTH);
        let tree = sums * 2.0 * ranks.log2().ceil() * LATENCY;
        [compute, twice, exchange, sum, tree, compute / (compute + twice + exchange + tree), memory * dofs]
    });
    let row = |name: &str, index: usize, factor: f64, unit: &str| {
        println!(
            "| {name} | {:.3}{unit} | {:.3}{unit} |",
            factor * columns[0][index],
            factor * columns[1][index]
        );
    };
    row("computing", 0, 1.0, " s");
    row("cells computed twice", 1, 1.0, " s");
    row("exchanges", 2, 1.0, " s");
    row("sums, gathered in one level as now", 3, 1.0, " s");
    row("sums in two levels", 4, 1.0, " s");
    row("efficiency with sums in two levels", 5, 1.0, "");
    row("memory of a rank", 6, 1e-9, " GB");

    // The whole mesh: coordinates, connectivity of hexahedra, groups, owners, numbers.
    let nodes = 1e9 / 3.0;
    println!("\nWhat breaks first, for 1e9 degrees of freedom:");
    println!(
        "1. The whole mesh on every rank before its share is taken: {:.0} GB.",
        nodes * (24.0 + 36.0 + 8.0) * 1e-9
    );
    println!(
        "2. Sums gathered in one level: {:.0} kB a sum and rank, {sums:.0} of them a step.",
        8.0 * ranks / 1024.0
    );
    println!(
        "3. METIS with 32-bit indices: {:.0} million nodes of hexahedra.",
        f64::from(i32::MAX) / 26.0 * 1e-6
    );
    Ok(())
}
