//! Gradients by parameters.

use emmy::adjoint::Parameter;
use emmy::body::Body;
use emmy::time::Scheme;

use super::problems::*;
use crate::shared::schemes::{DGM, assumed_strain, fe};

/// Relative difference between a derivative by a parameter and differences of whole motions.
fn parameter_error(body: impl Fn(f64) -> Result<Body>, value: f64, (scheme, degree): (Scheme, usize)) -> f64 {
    let own = body(value).unwrap();
    let (start, plan) = (disturbed(&own, 0.05, 0.5), equal(0.9, 0.15 * degree as f64));
    let goal = scattered_goal(&own);
    let parameter = Parameter::linear(value, value, &body).unwrap();
    let gradient = trajectory(&own, scheme, degree, &start, &plan).gradient(&goal, &[parameter]).unwrap();
    let slope = slope(2e-4 * value, |d| {
        let varied = body(value + d).unwrap();
        // The same velocity, with the momentum of the varied mass.
        let start = disturbed(&varied, 0.05, 0.5);
        goal.value(&end(&varied, scheme, degree, &start, &plan))
    });
    (gradient.parameters[0] - slope).abs() / slope.abs()
}

#[test]
fn gradients_by_parameters_are_differences_of_motions() {
    for k in 1..=3 {
        for scheme in [fe(k), assumed_strain(k + 1), DGM] {
            for rubber in [true, false] {
                let errors = [
                    parameter_error(|lambda| held_block([lambda, 15.0], 1.0, 2.0, rubber), 30.0, (scheme, k)),
                    parameter_error(|mu| held_block([30.0, mu], 1.0, 2.0, rubber), 15.0, (scheme, k)),
                    parameter_error(
                        |density| held_block([30.0, 15.0], density, 2.0, rubber),
                        1.0,
                        (scheme, k),
                    ),
                    parameter_error(
                        |traction| held_block([30.0, 15.0], 1.0, traction, rubber),
                        2.0,
                        (scheme, k),
                    ),
                ];
                println!("{scheme}, k = {k}, rubber {rubber}: {errors:?}");
                assert!(
                    errors.iter().all(|error| *error < 5e-9),
                    "{scheme}, k = {k}, rubber {rubber}: {errors:?}"
                );
            }
            let error = parameter_error(springs, 20.0, (scheme, k));
            assert!(error < 5e-9, "{scheme}, k = {k}, springs: {error:e}");
        }
    }
}

/// The energy is not linear in Poisson's ratio: its derivative follows from the chain rule over the Lame parameters.
#[test]
fn smooth_parameters_have_the_derivative_of_the_chain_rule() {
    let (youngs, nu) = (40.0, 0.3);
    let lame =
        |youngs: f64, nu: f64| [youngs * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), youngs / (2.0 * (1.0 + nu))];
    let [lambda, mu] = lame(youngs, nu);
    let body = held_block([lambda, mu], 1.0, 2.0, true).unwrap();
    let (start, goal) = (disturbed(&body, 0.05, 0.5), scattered_goal(&body));
    let parameters = [
        Parameter::linear(lambda, lambda, |lambda| held_block([lambda, mu], 1.0, 2.0, true)),
        Parameter::linear(mu, mu, |mu| held_block([lambda, mu], 1.0, 2.0, true)),
        Parameter::smooth(nu, nu, |nu| held_block(lame(youngs, nu), 1.0, 2.0, true)),
        Parameter::smooth(mu, mu, |mu| held_block([lambda, mu], 1.0, 2.0, true)),
    ];
    let parameters = parameters.map(Result::unwrap);
    let gradient = trajectory(&body, DGM, 2, &start, &equal(0.9, 0.15)).gradient(&goal, &parameters).unwrap();
    let [by_lambda, by_mu, by_nu, by_mu_again] = gradient.parameters[..] else { panic!() };
    let dlambda = youngs * (1.0 + 2.0 * nu * nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)).powi(2);
    let chain = by_lambda * dlambda - by_mu * youngs / (2.0 * (1.0 + nu).powi(2));
    println!("{by_nu} {chain}, {:e}, {:e}", by_nu / chain - 1.0, by_mu_again / by_mu - 1.0);
    assert!((by_nu / chain - 1.0).abs() < 1e-10 && (by_mu_again / by_mu - 1.0).abs() < 1e-10);
}
