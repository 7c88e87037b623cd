//! The estimated error of a goal against the true one.

use emmy::adjoint::Goal;
use emmy::motion::{Adaptivity, StepPlan};
use emmy::time::Scheme;

use super::problems::*;

/// The estimate has the sign and, where the steps resolve the motion, the size of the error of a probe.
#[test]
fn the_error_of_a_goal_is_estimated_with_its_sign() {
    let network = springs(20.0).unwrap();
    let stretched = disturbed(&network, 0.1, 1.0);
    let problems = [
        ("orbit", orbit(0.5), 2.0, 0.02, 1e-5),
        ("springs", (network, stretched), 2.0, 0.02, 1e-5),
        ("soft block", soft_block(), 1.0, 0.01, 1e-5),
    ];
    for (name, (body, start), until, size, tolerance) in &problems {
        let exact = end(body, Scheme::Standard(5), 5, start, &equal(*until, 0.5 * size));
        for degree in [1, 2, 3] {
            let adaptive = StepPlan::adaptive(0.0, *until, Adaptivity::new(*tolerance)).unwrap();
            for plan in [equal(*until, size * [1.0, 3.0, 5.0][degree - 1]), adaptive] {
                let trajectory = trajectory(body, DGM, degree, start, &plan);
                let own = end(body, DGM, degree, start, &plan);
                for direction in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
                    let goal = Goal::displacement_at(body, 1, direction);
                    let (error, estimate) =
                        (goal.value(&own) - goal.value(&exact), trajectory.goal_error(&goal).unwrap());
                    let (ratio, n) = (estimate.total() / error, trajectory.n_steps());
                    println!("{name}, k = {degree}, {n} steps, error {error:.2e}: {ratio:.4}");
                    assert!((0.5..2.0).contains(&ratio), "{name}, k = {degree}, {n} steps: {ratio}");
                    assert!(estimate.size() >= estimate.total().abs() && estimate.steps.len() == n);
                }
            }
        }
    }
}
