//! `emmy-attack [ATTACK..] [--minutes N | --quick | --trials N] [--seed S]`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant, SystemTime};

use clap::Parser;

/// Attacks the built binary from outside; exit code 1 if a fault is found.
#[derive(Debug, Parser)]
struct Arguments {
    /// Attacks to run [default: all]
    attacks: Vec<String>,
    /// Minutes for all attacks together
    #[arg(long, default_value_t = 5.0, value_name = "N")]
    minutes: f64,
    /// A minute for all attacks together, as in CI
    #[arg(long, conflicts_with = "minutes")]
    quick: bool,
    /// Number of trials of each attack, instead of a time
    #[arg(long, value_name = "N")]
    trials: Option<usize>,
    /// Seed of the first trial of each attack; later trials have the following seeds [default: from the clock]
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// The binary [default: `emmy` beside this program]
    #[arg(long, value_name = "FILE")]
    emmy: Option<PathBuf>,
}

#[cfg(unix)]
fn main() -> ExitCode {
    use emmy_attack::attack::{Budget, Campaign};
    use emmy_attack::{attacks, emmy::Emmy, table};

    let arguments = Arguments::parse();
    let beside = || std::env::current_exe().unwrap_or_default().with_file_name("emmy");
    let path = arguments.emmy.clone().unwrap_or_else(beside);
    let Ok(path) = path.canonicalize() else {
        eprintln!("{} is not there; `cargo build -p emmy-cli` makes it", path.display());
        return ExitCode::from(2);
    };
    if let Some(name) = arguments.attacks.iter().find(|name| attacks::of(name).is_none()) {
        let names = attacks::ALL.map(|attack| attack.name).join(", ");
        eprintln!("there is no attack `{name}`; there are {names}");
        return ExitCode::from(2);
    }
    let clock = || SystemTime::UNIX_EPOCH.elapsed().map_or(1, |since| since.as_secs());
    let seed = arguments.seed.unwrap_or_else(clock);
    let time = Duration::from_secs_f64(if arguments.quick { 60.0 } else { 60.0 * arguments.minutes });
    let budget = match arguments.trials {
        Some(trials) => Budget::Trials(trials),
        None => Budget::Time(time),
    };
    eprintln!("{}, seed {seed}", path.display());
    let start = Instant::now();
    let campaign = Campaign { emmy: Emmy::new(path), seed, budget };
    let reports = campaign.run(&arguments.attacks);
    print!("{}", table::of(&reports));
    println!("{:.0} s, seed {seed}", start.elapsed().as_secs_f64());
    if reports.iter().all(|report| report.findings.is_empty()) {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

#[cfg(not(unix))]
fn main() -> ExitCode {
    let _ = Arguments::parse();
    eprintln!("the attack needs signals and limits of Unix");
    ExitCode::from(2)
}
