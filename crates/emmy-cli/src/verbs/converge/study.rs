//! The study from the command line. Every fault names its flag.

use emmy::time::Scheme;
use emmy_io::convergence::Study;
use emmy_io::input::Problem;

use super::Arguments;
use crate::failure::Failure;
use crate::print::number;

/// Largest memory of the samples of the reference \[bytes\].
const MAX_MEMORY: f64 = 1.6e10;

/// The study, checked.
pub(super) fn read(arguments: &Arguments, problem: &Problem) -> Result<Study, Failure> {
    if problem.is_static() {
        let message = "the input is a static analysis: it has no steps in time to study".to_string();
        return Err(Failure::Usage { message, help: Some("give it `[time]`".to_string()) });
    }
    let (from, to) = span(arguments, problem)?;
    let window = window(arguments.window.as_deref(), from, to)?;
    let length = window.1 - window.0;
    let smallest = sizes(&arguments.sizes, length)?;
    let reference_scheme = reference_scheme(arguments.reference_scheme.as_deref(), problem)?;
    let reference_scheme =
        with_degree(reference_scheme, arguments.reference_degree, problem.scheme.degree())?;
    let reference_size = match arguments.reference {
        None => 0.1 * smallest,
        // A reference of a higher degree or another scheme may have larger steps.
        Some(size) if reference_scheme != problem.scheme => at_most(size, length, "the window")?,
        Some(size) => below(size, smallest)?,
    };
    let of_joints = problem.joints.iter().filter_map(|joint| joint.until);
    let releases = problem.supports.iter().filter_map(|support| support.until).chain(of_joints).collect();
    let study = Study {
        scheme: problem.scheme,
        from,
        window,
        sizes: arguments.sizes.clone(),
        reference_scheme,
        reference_size,
        releases,
        units: problem.units,
    };
    affordable(&study, problem.body.n_dofs())?;
    Ok(study)
}

fn fault(flag: &str, what: impl std::fmt::Display, help: &str) -> Failure {
    let help = (!help.is_empty()).then(|| help.to_string());
    Failure::Usage { message: format!("{flag}: {what}"), help }
}

/// Start and end of the runs.
fn span(arguments: &Arguments, problem: &Problem) -> Result<(f64, f64), Failure> {
    let start = problem.plan.start();
    let end = problem.plan.end();
    let plan = format!("the plan goes from t = {} to t = {}", number(start), number(end));
    let from = arguments.from.unwrap_or(start);
    if !(start..end).contains(&from) {
        return Err(fault(&format!("--from {from}"), plan, "it must be a time of the plan before its end"));
    }
    let to = arguments.to.unwrap_or(end);
    if !(to > from && to <= end) {
        let help = format!("it must be after t = {} and not after the end of the plan", number(from));
        return Err(fault(&format!("--to {to}"), plan, &help));
    }
    Ok((from, to))
}

fn window(asked: Option<&[f64]>, from: f64, to: f64) -> Result<(f64, f64), Failure> {
    let flag = |times: &[f64]| {
        let times: Vec<String> = times.iter().map(f64::to_string).collect();
        format!("--window {}", times.join(","))
    };
    match asked {
        None => Ok((from, to)),
        Some(&[start, end]) if from <= start && start < end && end <= to => Ok((start, end)),
        Some(times @ [_, _]) => {
            let runs = format!("the runs go from t = {} to t = {}", number(from), number(to));
            Err(fault(&flag(times), runs, "it must be two of their times, the earlier one first"))
        }
        Some(times) => {
            let what = format!("there must be two times, not {}", times.len());
            Err(fault(&flag(times), what, "such as --window 1,2"))
        }
    }
}

/// The smallest of the sizes, all checked.
fn sizes(sizes: &[f64], length: f64) -> Result<f64, Failure> {
    for (i, &size) in sizes.iter().enumerate() {
        let flag = format!("--sizes: {size}");
        if !(size > 0.0 && size.is_finite()) {
            return Err(fault(
                &flag,
                "a step size must be positive and finite",
                "such as --sizes 0.04,0.02,0.01",
            ));
        }
        if sizes[..i].contains(&size) {
            return Err(fault(&flag, "the size is given twice", ""));
        }
        if size > length {
            let what = format!("the size is larger than the window, which is {} long", number(length));
            return Err(fault(&flag, what, "leave it out, or widen --window"));
        }
    }
    Ok(sizes.iter().copied().fold(f64::INFINITY, f64::min))
}

fn reference_scheme(asked: Option<&str>, problem: &Problem) -> Result<Scheme, Failure> {
    let Some(text) = asked else { return Ok(problem.scheme) };
    Scheme::from_name(text)
        .map_err(|error| fault("--reference-scheme", error, "such as --reference-scheme DGM"))
}

/// The scheme of the reference with the requested degree, or the degree of the input.
fn with_degree(scheme: Scheme, asked: Option<usize>, own: usize) -> Result<Scheme, Failure> {
    let degree = asked.unwrap_or(own);
    let flag = format!("--reference-degree {degree}");
    if degree < own {
        let what = format!("it is less than the degree {own} of the input");
        return Err(fault(&flag, what, "a reference must be more accurate than the members"));
    }
    scheme.with_degree(degree).map_err(|error| {
        fault(&flag, error, "choose a scheme that allows it, or leave it out and give a smaller --reference")
    })
}

fn at_most(size: f64, length: f64, of_what: &str) -> Result<f64, Failure> {
    if size > 0.0 && size <= length {
        return Ok(size);
    }
    let what = format!("it must be positive and not larger than {of_what} ({})", number(length));
    Err(fault(&format!("--reference {size}"), what, ""))
}

fn below(size: f64, smallest: f64) -> Result<f64, Failure> {
    if size > 0.0 && size < smallest {
        return Ok(size);
    }
    let what = format!("it must be positive and smaller than the smallest of --sizes ({})", number(smallest));
    let help = "or give the reference a higher degree with --reference-degree";
    Err(fault(&format!("--reference {size}"), what, help))
}

/// Rejects sizes so small that the samples would not fit; they are probably typing errors.
fn affordable(study: &Study, n_dofs: usize) -> Result<(), Failure> {
    let mut n_times = 0.0;
    let all = study.sizes.iter().map(|&size| ("--sizes", size));
    for (flag, size) in all.chain([("--reference", study.reference_size)]) {
        let plan = study.plan(size).map_err(|error| fault(&format!("{flag}: {size}"), error, ""))?;
        if flag == "--sizes" {
            n_times += plan.n_steps() as f64;
        }
    }
    let memory = 8.0 * n_times * n_dofs as f64;
    if memory > MAX_MEMORY {
        let what =
            format!("the reference would be kept at {n_times} times, which takes {:.0} GB", 1e-9 * memory);
        return Err(fault("--sizes", what, "use larger sizes or a shorter --window"));
    }
    Ok(())
}
