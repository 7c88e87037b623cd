//! Attacks, and campaigns of several attacks.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use fastrand::Rng;

use crate::attacks;
use crate::emmy::Emmy;
use crate::place::Place;

/// An attack: trials of one kind.
#[derive(Debug, Clone, Copy)]
pub struct Attack {
    /// Name on the command line.
    pub name: &'static str,
    /// Short description.
    pub what: &'static str,
    /// Share of the time, relative to the other attacks.
    pub share: f64,
    /// The trials.
    pub cases: Cases,
    /// One trial; an error is a fault of the program under attack.
    pub trial: fn(&mut Trial<'_>) -> Result<(), String>,
}

/// The trials of an attack.
#[derive(Debug, Clone, Copy)]
pub enum Cases {
    /// Random, from the seed, until the time is up.
    Random,
    /// A list of known length, each item once, in a random order.
    Listed(fn(&Emmy) -> usize),
}

/// One trial, with its directory and random generator.
#[derive(Debug)]
pub struct Trial<'a> {
    /// The binary.
    pub emmy: &'a Emmy,
    /// Directory of the trial.
    pub place: Place,
    /// Random numbers of the trial.
    pub rng: Rng,
    /// Seed of a random trial, or number of a listed case.
    pub number: u64,
}

/// Duration of a campaign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Budget {
    /// A time, shared by all attacks.
    Time(Duration),
    /// A number of trials of each attack.
    Trials(usize),
}

/// A fault.
#[derive(Debug)]
pub struct Finding {
    /// Seed or number of the trial.
    pub number: u64,
    /// Description.
    pub fault: String,
    /// Directory with the files of the trial.
    pub kept: PathBuf,
}

/// The result of an attack.
#[derive(Debug)]
pub struct Report {
    /// The attack.
    pub attack: Attack,
    /// Number of trials done, and of all listed cases.
    pub trials: (usize, Option<usize>),
    /// The faults.
    pub findings: Vec<Finding>,
}

/// Attacks with a binary, a seed and a budget.
#[derive(Debug)]
pub struct Campaign {
    /// The binary.
    pub emmy: Emmy,
    /// Seed of the first trial of each attack.
    pub seed: u64,
    /// Duration.
    pub budget: Budget,
}

impl Campaign {
    /// Runs the named attacks, or all without names.
    pub fn run(&self, names: &[String]) -> Vec<Report> {
        let is_chosen = |attack: &&Attack| names.is_empty() || names.iter().any(|name| name == attack.name);
        let chosen: Vec<Attack> = attacks::ALL.iter().filter(is_chosen).copied().collect();
        let all: f64 = chosen.iter().map(|attack| attack.share).sum();
        chosen.iter().map(|attack| self.attack(attack, attack.share / all)).collect()
    }

    fn attack(&self, attack: &Attack, share: f64) -> Report {
        let numbers = self.numbers(attack);
        let (start, mut done, mut findings) = (Instant::now(), 0, Vec::new());
        let total = numbers.as_ref().map(Vec::len);
        while total.is_none_or(|total| done < total) && self.has_budget(share, start, done) {
            let number = match &numbers {
                Some(numbers) => numbers[done],
                None => self.seed.wrapping_add(done as u64),
            };
            findings.extend(self.trial(attack, number));
            done += 1;
        }
        Report { attack: *attack, trials: (done, total), findings }
    }

    /// Numbers of the listed cases in the order of their trials. With a given number of trials they begin at the seed,
    /// so that a case can be repeated.
    fn numbers(&self, attack: &Attack) -> Option<Vec<u64>> {
        let Cases::Listed(count) = attack.cases else { return None };
        let count = count(&self.emmy) as u64;
        let mut numbers: Vec<u64> = (0..count).collect();
        match self.budget {
            Budget::Trials(_) => numbers.rotate_left((self.seed % count.max(1)) as usize),
            Budget::Time(_) => Rng::with_seed(self.seed).shuffle(&mut numbers),
        }
        Some(numbers)
    }

    fn has_budget(&self, share: f64, start: Instant, done: usize) -> bool {
        match self.budget {
            Budget::Time(time) => start.elapsed() < time.mul_f64(share),
            Budget::Trials(trials) => done < trials,
        }
    }

    fn trial(&self, attack: &Attack, number: u64) -> Option<Finding> {
        let rng = Rng::with_seed(number);
        let mut trial = Trial { emmy: &self.emmy, place: Place::new(), rng, number };
        // The library may panic in the trial itself.
        let outcome = catch_unwind(AssertUnwindSafe(|| (attack.trial)(&mut trial)));
        let fault = outcome.unwrap_or_else(|_| Err("panic in the trial: see above".into())).err()?;
        let kept = trial.place.keep();
        eprintln!("{} {number}: {fault}\n  kept in {}", attack.name, kept.display());
        Some(Finding { number, fault, kept })
    }
}
