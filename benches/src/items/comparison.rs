//! Comparison of Emmy with other programs, measured in the same session or recorded.

use std::path::PathBuf;

use super::Settings;
use crate::job::Job;
use crate::machine::times_faster;
use crate::peers::{Interpreters, Peer, Recorded};
use crate::report::{Goal, Limit, Report, Table, number, number_or_dash};
use crate::session::{Runs, step_seconds};

/// Meshes (r) with a goal for the fastest of the others.
const FASTER_AT: [u32; 2] = [4, 6];

/// r of the mesh for the recorded memory and rate of assembly.
const RECORDED_AT: u32 = 4;

/// The other programs, and the interpreters of those that run.
#[derive(Debug)]
pub(super) struct Peers {
    recorded: Recorded,
    pythons: Vec<Option<PathBuf>>,
}

impl Peers {
    /// The programs; those that are installed, if they should run.
    ///
    /// # Errors
    /// A message if the recorded figures cannot be read.
    pub(super) fn find(settings: &Settings) -> Result<Self, String> {
        let recorded = Recorded::read()?;
        let python =
            |peer: &Peer| settings.peers.as_ref().and_then(|pythons: &Interpreters| pythons.of(&peer.name));
        let pythons = recorded.peers.iter().map(python).collect();
        Ok(Peers { recorded, pythons })
    }

    /// One job for each program that runs and each of its meshes (r), in this order.
    pub(super) fn jobs(&self, sizes: &[u32]) -> Vec<Job> {
        let job =
            |(peer, r): (usize, u32)| Some(self.recorded.peers[peer].job(self.pythons[peer].as_ref()?, r));
        self.places(sizes).into_iter().filter_map(job).collect()
    }

    /// Programs and r of the jobs.
    fn places(&self, sizes: &[u32]) -> Vec<(usize, u32)> {
        let peers =
            self.recorded.peers.iter().enumerate().filter(|(index, _)| self.pythons[*index].is_some());
        let of_peer = |(index, peer): (usize, &Peer)| {
            let sizes = sizes.iter().filter(|&&r| r <= peer.largest_r);
            sizes.map(|&r| (index, r)).collect::<Vec<_>>()
        };
        peers.flat_map(of_peer).collect()
    }
}

/// The comparison; `emmy` has the runs by size, `of_peers` the runs of [`Peers::jobs`].
pub(super) fn report(sizes: &[u32], emmy: &[Runs], peers: &Peers, of_peers: &[Runs]) -> Report {
    let places = peers.places(sizes);
    let measured = |peer: usize, r: u32| -> Option<&Runs> {
        places.iter().position(|&place| place == (peer, r)).map(|index| &of_peers[index])
    };
    let comparison = Comparison { sizes, emmy, peers, measured: &measured };
    let mut report = Report::new("Beside other programs", comparison.note());
    report.tables = vec![comparison.seconds(), comparison.ratios()];
    report.goals = comparison.goals();
    report
}

struct Comparison<'a> {
    sizes: &'a [u32],
    emmy: &'a [Runs],
    peers: &'a Peers,
    measured: &'a dyn Fn(usize, u32) -> Option<&'a Runs>,
}

impl Comparison<'_> {
    fn note(&self) -> String {
        let text = "CPU seconds a step, one thread; cells a second in the assembly of residual and tangent, and memory, at \
            the finest mesh up to r = 4. Then the other programs' time over Emmy's.";
        let recorded = format!("recorded, not measured now, on {}", self.peers.recorded.machine);
        if self.peers.pythons.iter().all(Option::is_none) {
            return format!("{text} The other programs' figures were {recorded}.");
        }
        format!(
            "{text} All runs took turns in this session, except figures with an asterisk, which were {recorded}."
        )
    }

    fn seconds(&self) -> Table {
        let mut table = Table::with_heading(1, self.heading(&["assembled cells/s", "peak MB"]));
        table.push(self.emmy_row());
        (0..self.peers.recorded.peers.len()).for_each(|peer| table.push(self.peer_row(peer)));
        table
    }

    fn emmy_row(&self) -> Vec<String> {
        let at = &self.emmy[self.finest()];
        let seconds = self.emmy.iter().map(|runs| number(runs.median(step_seconds)));
        let mut row: Vec<String> = std::iter::once("Emmy".to_string()).chain(seconds).collect();
        row.push(number_or_dash(at.median_of_some(|o| o.assembled_cells_per_second)));
        row.push(number_or_dash(at.median_of_some(|o| o.peak_megabytes)));
        row
    }

    fn peer_row(&self, index: usize) -> Vec<String> {
        let (peer, r) = (&self.peers.recorded.peers[index], self.sizes[self.finest()]);
        let seconds = self.sizes.iter().map(|&r| self.cell(index, r, self.peer_seconds(index, r)));
        let mut row: Vec<String> = std::iter::once(peer.label.clone()).chain(seconds).collect();
        let [rate, peak] = match (self.measured)(index, r) {
            Some(runs) => [
                runs.median_of_some(|o| o.assembled_cells_per_second),
                runs.median_of_some(|o| o.peak_megabytes),
            ],
            None if r == RECORDED_AT => [peer.assembled_cells_per_second, peer.peak_megabytes],
            None => [None, None],
        };
        row.extend([rate, peak].map(|value| self.cell(index, r, value)));
        row
    }

    /// Index of the finest mesh up to the mesh of the recorded memory.
    fn finest(&self) -> usize {
        self.sizes.iter().rposition(|&r| r <= RECORDED_AT).unwrap_or(0)
    }

    fn ratios(&self) -> Table {
        let mut table = Table::with_heading(1, self.heading(&[]));
        for (index, peer) in self.peers.recorded.peers.iter().enumerate() {
            let ratios = (0..self.sizes.len()).map(|i| self.cell(index, self.sizes[i], self.ratio(index, i)));
            table.push(std::iter::once(peer.label.clone()).chain(ratios).collect());
        }
        table
    }

    fn heading(&self, more: &[&str]) -> Vec<String> {
        let sizes = self.sizes.iter().map(|r| format!("r = {r}"));
        let first = std::iter::once("program, solver".to_string());
        first.chain(sizes).chain(more.iter().map(|word| word.to_string())).collect()
    }

    /// A number, with an asterisk if it is recorded among measured ones.
    fn cell(&self, peer: usize, r: u32, value: Option<f64>) -> String {
        let some_run = self.peers.pythons.iter().any(Option::is_some);
        let mark = if some_run && value.is_some() && (self.measured)(peer, r).is_none() { "*" } else { "" };
        number_or_dash(value) + mark
    }

    fn peer_seconds(&self, peer: usize, r: u32) -> Option<f64> {
        let recorded = self.peers.recorded.peers[peer].recorded_seconds(r);
        (self.measured)(peer, r).map(|runs| runs.median(step_seconds)).or(recorded)
    }

    /// Time of a program relative to Emmy's at a size.
    fn ratio(&self, peer: usize, size: usize) -> Option<f64> {
        let (r, emmy) = (self.sizes[size], &self.emmy[size]);
        match (self.measured)(peer, r) {
            Some(runs) => Some(runs.ratio(emmy, step_seconds)),
            None => Some(self.peer_seconds(peer, r)? / emmy.median(step_seconds)),
        }
    }

    fn goals(&self) -> Vec<Goal> {
        (0..self.sizes.len())
            .flat_map(|size| self.fastest(size).into_iter().chain(self.named(size)))
            .collect()
    }

    /// The goal against the fastest of the others.
    fn fastest(&self, size: usize) -> Option<Goal> {
        let r = self.sizes[size];
        FASTER_AT.contains(&r).then_some(())?;
        let ratios = (0..self.peers.recorded.peers.len()).filter_map(|peer| self.ratio(peer, size));
        let statement = format!("the fastest of the others over Emmy at r = {r}");
        Some(Goal::new(statement, Limit::AtLeast(times_faster()), ratios.reduce(f64::min)?))
    }

    /// The goals against single programs.
    fn named(&self, size: usize) -> impl Iterator<Item = Goal> {
        let r = self.sizes[size];
        self.peers.recorded.peers.iter().enumerate().filter_map(move |(index, peer)| {
            let (times, ratio) = (peer.times_faster.get(&r.to_string())?, self.ratio(index, size)?);
            let statement = format!("{} over Emmy at r = {r}", peer.label);
            Some(Goal::new(statement, Limit::AtLeast(*times), ratio))
        })
    }
}
