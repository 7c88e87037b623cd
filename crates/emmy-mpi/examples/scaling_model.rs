//! A model of many processes from numbers of this machine: where the time of a step goes, and what breaks first.
//!
//!     RAYON_NUM_THREADS=1 cargo run --release -p emmy-mpi --example scaling_model [CELLS]
//!
//! Neighbours, guests and cells computed twice come from real partitions of the L-shaped block with CELLS (16) cells a
//! unit length into 8 to 4,096 parts; sums and exchanges of a step from a motion whose calls are counted; time and
//! memory of a degree of freedom from a motion of one process; memory of the first rank, which divides the mesh, from
//! this process. The network is assumed: see `LATENCY` and `BANDWIDTH`. Nothing here is a measurement of more than one
//! machine.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use emmy::mesh::{self, Share, Shares, owners};
use emmy::motion::Solver;
use emmy::prelude::*;
use emmy::team::{GROUP, Parcel, Team, Threads};

/// Assumed: seconds a message, bytes a second of a rank.
const LATENCY: f64 = 2e-6;
const BANDWIDTH: f64 = 1e9;

/// Assumed: bytes of memory of a machine.
const MACHINE: f64 = 256e9;

/// Bytes of a number of the sums.
const NUMBER: f64 = 8.0;

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

/// Resident memory of this process in bytes (Linux): the largest since [`reset_peak`], or the present one.
fn memory(name: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(name));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kilobytes| 1024.0 * kilobytes)
}

/// Forgets the largest memory so far; returns the present one.
fn reset_peak() -> f64 {
    _ = std::fs::write("/proc/self/clear_refs", "5");
    memory("VmRSS:")
}

/// The sizes of the ranks in a partition: means over the ranks that were looked at, the largest number of neighbours.
struct Partition {
    own: f64,
    guests: f64,
    extra_cells: f64,
    neighbours: usize,
}

fn partition(mesh: &Mesh, size: usize) -> emmy::Result<Partition> {
    let owners = owners(mesh, size)?;
    let shares = Shares::new(mesh, &owners);
    let ranks: Vec<usize> = (0..size).step_by(size.div_ceil(SAMPLES)).collect();
    let (mut own, mut guests, mut cells, mut counted, mut neighbours) = (0, 0, 0, 0, 0);
    for share in ranks.iter().map(|&rank| shares.share(rank)) {
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

/// Seconds of a sum of one number: within groups of ranks, among their first ranks, and back to the groups.
fn sum_in_groups(ranks: f64) -> f64 {
    let group = ranks.min(GROUP as f64);
    let groups = (ranks / group).ceil();
    let gather = |size: f64| size.log2().ceil() * LATENCY + NUMBER * size / BANDWIDTH;
    gather(group) + gather(groups) + group.log2().ceil() * LATENCY
}

fn main() -> emmy::Result<()> {
    let cells: f64 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(16.0);
    let before = reset_peak();
    let body = Body::builder(mesh::l_block(0.25)?).region(rubber()?).build()?;
    let (seconds, iterations) = spin(&body, 0.25)?;
    let n = body.n_dofs() as f64;
    let (per_dof, memory_of_dof) = (seconds / n, (memory("VmHWM:") - before) / n);
    drop(body);
    let [sums, exchanges] = calls()?;
    println!("One process, {n} degrees of freedom, DGM of degree 1, Courant number 5:");
    println!(
        "{:.2} us a degree of freedom and step, {memory_of_dof:.0} bytes a degree of freedom,",
        1e6 * per_dof
    );
    println!("{:.1} linear iterations a step.", iterations as f64 / (STEPS + 1) as f64);
    println!("Two ranks: {sums:.0} sums and {exchanges:.0} exchanges a step.\n");

    let before = reset_peak();
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
    let memory_of_node = (memory("VmHWM:") - before) / mesh.n_nodes() as f64;
    println!("The mesh and its division take {memory_of_node:.0} bytes a node on the first rank.");

    println!("\n| 10,000 ranks, degrees of freedom a rank | 100,000 | 10,000 |");
    println!("|---|---|---|");
    let ranks: f64 = 1e4;
    let columns = [1e5, 1e4].map(|dofs: f64| {
        let guests = surface * (dofs / 3.0).powf(2.0 / 3.0);
        let compute = per_dof * dofs;
        // Half of a step is assembly, which computes cells at the border twice: about half a layer of cells.
        let twice = 0.5 * compute * 0.5 * guests / (dofs / 3.0);
        let exchange = exchanges * (most_neighbours as f64 * LATENCY + 3.0 * NUMBER * guests / BANDWIDTH);
        let sum = sums * sum_in_groups(ranks);
        [compute, twice, exchange, sum, compute / (compute + twice + exchange + sum), memory_of_dof * dofs]
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
    row("sums, in groups of ranks", 3, 1.0, " s");
    row("efficiency", 4, 1.0, "");
    row("memory of a rank", 5, 1e-9, " GB");

    let mut limits = [
        ("METIS counts the couplings of nodes, 26 each, in 32 bits", 3.0 * f64::from(i32::MAX) / 26.0),
        ("the first rank divides the mesh in 256 GB", 3.0 * MACHINE / memory_of_node),
        ("PETSc of Debian numbers rows in 32 bits", f64::from(i32::MAX)),
        ("nodes of the mesh are numbered in 32 bits", 3.0 * f64::from(u32::MAX)),
    ];
    limits.sort_by(|(_, dofs), (_, others)| dofs.total_cmp(others));
    println!("\n| what ends first | millions of degrees of freedom |");
    println!("|---|---|");
    limits.iter().for_each(|(what, dofs)| println!("| {what} | {:.0} |", 1e-6 * dofs));
    Ok(())
}
