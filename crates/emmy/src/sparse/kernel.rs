//! Products of 3 x 3 blocks with vectors, for each instruction set.

use half::bf16;
use pulp::Arch;
#[cfg(target_arch = "x86_64")]
use pulp::x86::V3;

use super::real::Real;

#[cfg(target_arch = "x86_64")]
mod x86;

/// A vector of a solver: three components per row, each with C columns, and a zero that fills a register. One column is
/// a real vector; two columns are the real and imaginary parts of a complex one. `[row][4][C]`.
pub(super) type Row<T, const C: usize> = [[T; C]; 4];

/// Entries loaded by a product from the first entry of a block on: a register of the widest instruction set.
pub(super) const LOADED: usize = 16;

/// Storage format of the numbers of a matrix.
pub(crate) trait Entry: Copy + Default + Send + Sync + 'static {
    /// Number type in which products are computed.
    type Number: Real;
    /// The nearest entry.
    fn of(value: f64) -> Self;
    /// Its value.
    fn number(self) -> Self::Number;
    /// Uses the kernel of the best instruction set of the machine.
    fn dispatch<const C: usize, W: Work<Self, C>>(work: W) -> W::Output;
    /// Uses the kernel of an instruction set that is not the best one of the machine.
    #[cfg(test)]
    fn narrower<const C: usize, W: Work<Self, C>>(_: W) -> Option<W::Output> {
        None
    }
}

/// Double precision, for solutions that are not corrected.
impl Entry for f64 {
    type Number = f64;
    #[inline(always)]
    fn of(value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn number(self) -> f64 {
        self
    }
    fn dispatch<const C: usize, W: Work<f64, C>>(work: W) -> W::Output {
        in_double_precision(work)
    }
}

/// Single precision for entries, double precision for vectors. Up to Courant numbers of 1e4, single-precision entries
/// add no iterations; single-precision vectors would.
impl Entry for f32 {
    type Number = f64;
    #[inline(always)]
    fn of(value: f64) -> f32 {
        value as f32
    }
    #[inline(always)]
    fn number(self) -> f64 {
        f64::from(self)
    }
    fn dispatch<const C: usize, W: Work<f32, C>>(work: W) -> W::Output {
        in_double_precision(work)
    }
}

/// Uses the kernel of the machine for products in double precision.
#[cfg(target_arch = "x86_64")]
fn in_double_precision<const C: usize, E: x86::Widened, W: Work<E, C>>(work: W) -> W::Output {
    match Arch::new() {
        Arch::V4(simd) => simd.vectorize(x86::With::<C, E, V3, W>::new(*simd, work)),
        Arch::V3(simd) => simd.vectorize(x86::With::<C, E, V3, W>::new(simd, work)),
        _ => work.run(Portable),
    }
}

/// Uses the kernel of the machine for products in double precision.
#[cfg(not(target_arch = "x86_64"))]
fn in_double_precision<const C: usize, E: Entry, W: Work<E, C>>(work: W) -> W::Output {
    work.run(Portable)
}

/// The upper half of a number of single precision: an iterative solver is limited by memory, and its result is
/// corrected.
impl Entry for bf16 {
    type Number = f32;
    #[inline(always)]
    fn of(value: f64) -> bf16 {
        // To the nearest, ties to even, as `bf16::from_f32`, but without a branch for what is not a number.
        let bits = (value as f32).to_bits();
        bf16::from_bits((bits.wrapping_add(0x7fff + (bits >> 16 & 1)) >> 16) as u16)
    }
    #[inline(always)]
    fn number(self) -> f32 {
        f32::from_bits(u32::from(self.to_bits()) << 16)
    }
    fn dispatch<const C: usize, W: Work<bf16, C>>(work: W) -> W::Output {
        match Arch::new() {
            #[cfg(target_arch = "x86_64")]
            Arch::V4(simd) => simd.vectorize(x86::With::<C, bf16, _, _>::new(simd, work)),
            #[cfg(target_arch = "x86_64")]
            Arch::V3(simd) => simd.vectorize(x86::With::<C, bf16, _, _>::new(simd, work)),
            _ => work.run(Portable),
        }
    }
    #[cfg(all(test, target_arch = "x86_64"))]
    fn narrower<const C: usize, W: Work<bf16, C>>(work: W) -> Option<W::Output> {
        V3::try_new().map(|simd| simd.vectorize(x86::With::<C, bf16, _, _>::new(simd, work)))
    }
}

/// Work with a kernel. Everything called by `run` must be inlined into it; otherwise it is compiled for the oldest
/// machine.
pub(crate) trait Work<E: Entry, const C: usize> {
    /// Result.
    type Output;
    /// Does the work.
    fn run<K: Kernel<E, C>>(self, kernel: K) -> Self::Output;
}

/// Sums of products of blocks with rows of a vector, in registers.
pub(crate) trait Kernel<E: Entry, const C: usize>: Copy {
    /// A sum.
    type Sum: Copy;
    /// Zero.
    fn zero(self) -> Self::Sum;
    /// `sum + A x`; A: the first nine entries, by columns.
    fn add_product(self, sum: Self::Sum, A: &[E; LOADED], x: &Row<E::Number, C>) -> Self::Sum;
    /// The sum of two sums.
    fn total(self, sums: [Self::Sum; 2]) -> Row<E::Number, C>;
}

/// The kernel for any machine: four numbers at a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Portable;

impl<E: Entry, const C: usize> Kernel<E, C> for Portable {
    type Sum = [<E::Number as Real>::Four; C];

    #[inline(always)]
    fn zero(self) -> Self::Sum {
        [E::Number::four([E::Number::default(); 4]); C]
    }

    #[inline(always)]
    fn add_product(self, mut sum: Self::Sum, A: &[E; LOADED], x: &Row<E::Number, C>) -> Self::Sum {
        let column = |b: usize| {
            E::Number::four([
                A[3 * b].number(),
                A[3 * b + 1].number(),
                A[3 * b + 2].number(),
                A[3 * b + 3].number(),
            ])
        };
        let A = [column(0), column(1), column(2)];
        for c in 0..C {
            let by = |b: usize| E::Number::four([x[b][c]; 4]);
            sum[c] += A[0] * by(0) + A[1] * by(1) + A[2] * by(2);
        }
        sum
    }

    #[inline(always)]
    fn total(self, sums: [Self::Sum; 2]) -> Row<E::Number, C> {
        let mut row = [[E::Number::default(); C]; 4];
        for c in 0..C {
            let sum = E::Number::array(sums[0][c] + sums[1][c]);
            (0..3).for_each(|a| row[a][c] = sum[a]);
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_of_numbers_are_the_nearest_ones() {
        let mut bits = 0x1234_5678u32;
        let ties = (0..64).map(|i| 0x3f80_8000 + (i << 16));
        let random = (0..100_000).map(|_| {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            bits
        });
        for number in ties.chain(random).map(f32::from_bits).filter(|number| !number.is_nan()) {
            assert_eq!(<bf16 as Entry>::of(f64::from(number)), bf16::from_f32(number), "{number:e}");
        }
        assert!(<bf16 as Entry>::of(f64::NAN).is_nan() && <bf16 as Entry>::of(-f64::NAN).is_nan());
        assert_eq!(<bf16 as Entry>::of(f64::INFINITY), bf16::INFINITY);
    }
}
