//! Limits of the machine: operations and bytes a second.

use std::hint::black_box;
use std::time::Instant;

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Chains of fused multiplications and additions, enough of them to hide their latency; returns their operations.
struct Chains;

const CHAINS: usize = 12;
const LENGTH: usize = 1_000_000;

impl WithSimd for Chains {
    type Output = f64;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (factor, addend) = (simd.splat_f64s(black_box(0.999)), simd.splat_f64s(black_box(1e-3)));
        let mut sums = [addend; CHAINS];
        for _ in 0..LENGTH {
            for sum in &mut sums {
                *sum = simd.mul_add_e_f64s(*sum, factor, addend);
            }
        }
        black_box(sums.map(|sum| simd.reduce_sum_f64s(sum)));
        (2 * CHAINS * LENGTH * S::F64_LANES) as f64
    }
}

/// Floating-point operations a second of one core, the fastest of some attempts.
pub(crate) fn operations_per_second() -> f64 {
    let rate = |_| {
        let started = Instant::now();
        Arch::new().dispatch(Chains) / started.elapsed().as_secs_f64()
    };
    (0..10).map(rate).fold(0.0, f64::max)
}

/// Numbers of each vector of a triad: more than the caches hold.
const TRIAD: usize = 1 << 23;

/// Bytes a second of `z = x + a y` on some threads, the fastest of some attempts.
///
/// # Errors
/// The message of the system if it starts no threads.
pub(crate) fn triad(threads: usize) -> Result<f64, String> {
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| error.to_string())?;
    let (x, y, mut z) = (vec![1.0; TRIAD], vec![2.0; TRIAD], vec![0.0; TRIAD]);
    let factor = black_box(3.0);
    let mut rate = || {
        let started = Instant::now();
        pool.install(|| {
            let parts = z.par_chunks_mut(TRIAD / threads).zip(x.par_chunks(TRIAD / threads));
            parts.zip(y.par_chunks(TRIAD / threads)).for_each(|((z, x), y)| {
                z.iter_mut().zip(x).zip(y).for_each(|((z, x), y)| *z = x + factor * y);
            });
        });
        black_box(&z);
        (24 * TRIAD) as f64 / started.elapsed().as_secs_f64()
    };
    Ok((0..10).map(|_| rate()).fold(0.0, f64::max))
}
