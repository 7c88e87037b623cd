//! A user's material: its complete definition, and a block of it that rotates and stretches in space.
//!
//!     cargo run --release -p emmy --example own_material

#![allow(non_snake_case)] // the letters of the formulas

use emmy::body::{Body, InitialVelocity, Region};
use emmy::material::{Elasticity, Lane, Material, Sym, double_dot, sym_scaled};
use emmy::motion::{Motion, Record, State};
use emmy::time::TimeElement;

/// A foam that stiffens with its strain: W = mu (E : E + stiffening (E : E)^2).
#[derive(Clone, Debug)]
struct Foam {
    mu: f64,
    stiffening: f64,
}

impl Material for Foam {
    #[inline(always)]
    fn strain_energy<L: Lane>(&self, E: &Sym<L>) -> L {
        let square = double_dot(E, E);
        (square + square * square * self.stiffening) * self.mu
    }

    #[inline(always)]
    fn stress<L: Lane>(&self, E: &Sym<L>) -> Sym<L> {
        let slope = E[0].splat(1.0) + double_dot(E, E) * (2.0 * self.stiffening);
        sym_scaled(slope * (2.0 * self.mu), E)
    }

    #[inline(always)]
    fn stress_and_elasticity<L: Lane>(&self, E: &Sym<L>) -> (Sym<L>, Elasticity<L>) {
        let zero = E[0].splat(0.0);
        let slope = E[0].splat(1.0) + double_dot(E, E) * (2.0 * self.stiffening);
        let mut D = [[zero; 6]; 6];
        for a in 0..6 {
            for b in 0..6 {
                D[a][b] = E[a] * E[b] * (8.0 * self.mu * self.stiffening);
            }
            D[a][a] += slope * (self.mu * if a < 3 { 2.0 } else { 1.0 }); // shear strains count twice
        }
        (self.stress(E), D)
    }
}

fn fly() -> emmy::Result<Vec<Record>> {
    let mesh = emmy::mesh::block([1.0, 3.0, 1.0], [2, 6, 2])?;
    let foam = Foam { mu: 200.0, stiffening: 5.0 };
    let body = Body::builder(mesh).region(Region::new(foam, 1.0)).build()?;
    let spin = InitialVelocity { angular_velocity: [8.0, 1.0, 3.0], ..Default::default() };
    let state = State::initial(&body, 0.0, &[spin])?;
    let mut motion = Motion::new(&body, TimeElement::discrete_gradient(2)?)?.from(state)?;
    (0..50).map(|_| motion.step(0.02).cloned()).collect()
}

fn main() -> emmy::Result<()> {
    for record in fly()? {
        println!("t = {:.2}  T = {:.3}  V = {:.3}", record.time, record.kinetic_energy, record.strain_energy);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn energy_is_kept_to_round_off() {
        let records = super::fly().unwrap();
        // A block of 1 x 3 x 1 about the origin: T = 1/2 w . I w, I = [(1 + 9)/3, (1 + 1)/3, (1 + 9)/3] m less
        // products.
        let (m, w) = (3.0, [8.0, 1.0, 3.0]);
        let squares = 10.0 * (w[0] * w[0] + w[2] * w[2]) / 3.0 + 2.0 * w[1] * w[1] / 3.0;
        let products = 0.75 * w[0] * w[1] + 0.25 * w[0] * w[2] + 0.75 * w[1] * w[2];
        let energy = m * (squares / 2.0 - products);
        assert!(
            records.iter().all(|r| (r.total_energy - energy).abs() < 1e-11 * energy),
            "{energy} {records:?}"
        );
        assert!(records.iter().any(|r| r.strain_energy > 0.05 * energy));
    }
}
