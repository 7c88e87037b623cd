//! The L-shaped block of Betsch and Steinmann (2001) in free flight, on all processes of `mpirun`.
//!
//!     mpirun -n 2 target/release/examples/l_block [CELL_SIZE]
//!
//! One row a step: the energy, and the residuals of the balances.

use emmy::mesh::{self, Share, owners};
use emmy::prelude::*;

fn main() -> emmy::Result<()> {
    let cell_size = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(0.5);
    emmy_mpi::run(|team| {
        let mesh = mesh::l_block(cell_size)?;
        let share = Share::new(&mesh, &owners(&mesh, team.size())?, team.rank());
        let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 0.5);
        let body = Body::shared(share, team.clone()).region(rubber).build()?;
        let spin = InitialVelocity { angular_velocity: [0.3, 0.5, 0.8], ..Default::default() };
        let state = State::initial(&body, 0.0, &[spin])?;
        let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?.from(state)?;
        if team.rank() == 0 {
            println!("{} nodes on {} ranks", mesh.n_nodes(), team.size());
            println!("time, energy, residual of the energy, residual of the angular momentum");
        }
        for _ in 0..10 {
            let record = motion.step(0.02)?;
            if team.rank() == 0 {
                let Record { time, total_energy, energy_residual, angular_momentum_residual, .. } = record;
                println!(
                    "{time:.2}, {total_energy:.12e}, {energy_residual:.1e}, {angular_momentum_residual:.1e}"
                );
            }
        }
        Ok(())
    })
}
