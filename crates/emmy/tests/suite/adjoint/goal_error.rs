//! The estimated error of a goal against the true one.

use emmy::adjoint::Goal;
use emmy::motion::{Adaptivity, StepPlan};

use super::problems::*;
use crate::shared::schemes::{DGM, fe};

/// The estimate has the sign and, if the steps resolve the motion, the size of the error of a probe.
#[test]
fn the_error_of_a_goal_is_estimated_with_its_sign() {
    let network = springs(20.0).unwrap();
    let stretched = disturbed(&network, 0.1, 1.0);
    // The book's table: two components with equal steps, two with adaptive ones, of degrees 1, 2, 3.
    let of_orbit = [[1.00, 1.01, 1.00, 1.00], [0.87, 0.88, 1.00, 1.05], [1.33, 1.30, 1.11, 1.06]];
    let of_springs = [[1.02, 1.19, 1.00, 0.99], [0.99, 0.98, 0.99, 0.97], [0.94, 0.93, 1.00, 0.98]];
    let of_block = [[0.95, 0.92, 0.94, 0.91], [1.00, 0.96, 0.98, 0.93], [0.99, 0.98, 0.97, 0.91]];
    let problems = [
        ("orbit", orbit(0.5), 2.0, 0.02, 1e-5, of_orbit),
        ("springs", (network, stretched), 2.0, 0.02, 1e-5, of_springs),
        ("soft block", soft_block(), 1.0, 0.01, 1e-5, of_block),
    ];
    for (name, (body, start), until, size, tolerance, quoted) in &problems {
        let exact = end(body, fe(5), 5, start, &equal(*until, 0.5 * size));
        for degree in [1, 2, 3] {
            let adaptive = StepPlan::adaptive(0.0, *until, Adaptivity::new(*tolerance)).unwrap();
            let mut quoted = quoted[degree - 1].into_iter();
            for plan in [equal(*until, size * [1.0, 3.0, 5.0][degree - 1]), adaptive] {
                let trajectory = trajectory(body, DGM, degree, start, &plan);
                let own = end(body, DGM, degree, start, &plan);
                for direction in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
                    let goal = Goal::displacement_at(body, 1, direction);
                    let (error, estimate) =
                        (goal.value(&own) - goal.value(&exact), trajectory.goal_error(&goal).unwrap());
                    let (ratio, n) = (estimate.total() / error, trajectory.n_steps());
                    println!("{name}, k = {degree}, {n} steps, error {error:.2e}: {ratio:.4}");
                    let quoted = quoted.next().unwrap();
                    assert!(
                        (ratio - quoted).abs() < 0.02,
                        "{name}, k = {degree}, {n} steps: {ratio} is not the book's {quoted}"
                    );
                    assert!(estimate.size() >= estimate.total().abs() && estimate.steps.len() == n);
                }
            }
        }
    }
}
