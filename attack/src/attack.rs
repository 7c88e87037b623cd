//! What an attack is, and a campaign of several.

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
    /// Its name on the command line.
    pub name: &'static str,
    /// What is tried, in a few words.
    pub what: &'static str,
    /// Its part of the time, relative to those of the others.
    pub share: f64,
    /// What its trials are.
    pub cases: Cases,
    /// One trial; an error is a fault of the program under attack.
    pub trial: fn(&mut Trial<'_>) -> Result<(), String>,
}

/// What the trials of an attack are.
#[derive(Debug, Clone, Copy)]
pub enum Cases {
    /// Drawn from the seed, until the time is up.
    Random,
    /// A list of known length, once each, in an order drawn from the seed.
    Listed(fn(&Emmy) -> usize),
}

/// One trial: a directory of its own and a random generator.
#[derive(Debug)]
pub struct Trial<'a> {
    /// The binary.
    pub emmy: &'a Emmy,
    /// Directory of the trial.
    pub place: Place,
    /// Random numbers of the trial.
    pub rng: Rng,
    /// Seed of a random trial, number of a listed case.
    pub number: u64,
}

/// How long an attack goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Budget {
    /// For a time, shared by all attacks.
    Time(Duration),
    /// For a number of trials each.
    Trials(usize),
}

/// A fault that was found.
#[derive(Debug)]
pub struct Finding {
    /// Seed or number of the trial.
    pub number: u64,
    /// What is wrong.
    pub fault: String,
    /// Where the files of the trial are kept.
    pub kept: PathBuf,
}

/// What came of an attack.
#[derive(Debug)]
pub struct Report {
    /// The attack.
    pub attack: Attack,
    /// Number of trials done, and of all where they are listed.
    pub trials: (usize, Option<usize>),
    /// What was found.
    pub findings: Vec<Finding>,
}

/// Attacks with a binary, a seed and a budget.
#[derive(Debug)]
pub struct Campaign {
    /// The binary.
    pub emmy: Emmy,
    /// Seed of the first trial of each attack.
    pub seed: u64,
    /// How long.
    pub budget: Budget,
}

impl Campaign {
    /// Runs the attacks of some names; all of them if there is none.
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

    /// Numbers of the listed cases in the order in which they are tried. With a number of trials they begin at the seed, so that a case
    /// can be repeated.
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
