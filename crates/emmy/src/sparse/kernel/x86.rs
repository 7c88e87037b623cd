//! The kernels of x86-64 with AVX-512 and with AVX2.

use std::arch::x86_64::{__m128i, __m256, __m256d, __m256i, __m512};
use std::marker::PhantomData;

use half::bf16;
use pulp::NullaryFnOnce;
use pulp::bytemuck::cast;
use pulp::x86::{V3, V4};

use super::{Entry, Kernel, LOADED, Row, Work};

/// Work with the kernel of an instruction set, for entries of type E and vectors of C columns.
pub(super) struct With<const C: usize, E, S, W> {
    simd: S,
    work: W,
    entry: PhantomData<E>,
}

impl<const C: usize, E, S, W> With<C, E, S, W> {
    pub(super) fn new(simd: S, work: W) -> Self {
        With { simd, work, entry: PhantomData }
    }
}

impl<const C: usize, E: Entry, S: Kernel<E, C>, W: Work<E, C>> NullaryFnOnce for With<C, E, S, W> {
    type Output = W::Output;
    #[inline(always)]
    fn call(self) -> W::Output {
        self.work.run(self.simd)
    }
}

/// A register holds the whole block: the nine products of a block with a vector are one multiplication.
impl<const C: usize> Kernel<bf16, C> for V4 {
    type Sum = [__m512; C];

    #[inline(always)]
    fn zero(self) -> [__m512; C] {
        [self.avx512f._mm512_setzero_ps(); C]
    }

    #[inline(always)]
    fn add_product(self, mut sum: [__m512; C], A: &[bf16; LOADED], x: &Row<f32, C>) -> [__m512; C] {
        let simd = self.avx512f;
        let upper = simd._mm512_slli_epi32::<16>(simd._mm512_cvtepu16_epi32(cast::<_, __m256i>(*A)));
        let A = simd._mm512_castsi512_ps(upper);
        let x = if C == 1 {
            simd._mm512_castps128_ps512(cast(first::<4, _>(x.as_flattened())))
        } else {
            simd._mm512_castps256_ps512(cast(first::<8, _>(x.as_flattened())))
        };
        for c in 0..C {
            let spread = simd._mm512_permutexvar_ps(cast(columns::<16>(C, c)), x);
            sum[c] = simd._mm512_fmadd_ps(A, spread, sum[c]);
        }
        sum
    }

    #[inline(always)]
    fn total(self, sums: [[__m512; C]; 2]) -> Row<f32, C> {
        // The columns of a block are three numbers apart.
        const SECOND: [i32; 16] = [3, 4, 5, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        const THIRD: [i32; 16] = [6, 7, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        let simd = self.avx512f;
        let mut row = [[0.0; C]; 4];
        for c in 0..C {
            let sum = simd._mm512_add_ps(sums[0][c], sums[1][c]);
            let second = simd._mm512_maskz_permutexvar_ps(0b111, cast(SECOND), sum);
            let third = simd._mm512_maskz_permutexvar_ps(0b111, cast(THIRD), sum);
            let first = simd._mm512_maskz_mov_ps(0b111, sum);
            let total = simd._mm512_add_ps(simd._mm512_add_ps(first, second), third);
            let total: [f32; 4] = cast(simd._mm512_castps512_ps128(total));
            (0..4).for_each(|a| row[a][c] = total[a]);
        }
        row
    }
}

/// A register holds all of the block but its last number.
impl<const C: usize> Kernel<bf16, C> for V3 {
    type Sum = [(__m256, f32); C];

    #[inline(always)]
    fn zero(self) -> [(__m256, f32); C] {
        [(self.avx._mm256_setzero_ps(), 0.0); C]
    }

    #[inline(always)]
    fn add_product(
        self,
        mut sum: [(__m256, f32); C],
        A: &[bf16; LOADED],
        x: &Row<f32, C>,
    ) -> [(__m256, f32); C] {
        let bits: __m128i = cast(first::<8, _>(A));
        let upper = self.avx2._mm256_slli_epi32::<16>(self.avx2._mm256_cvtepu16_epi32(bits));
        let eight = self.avx._mm256_castsi256_ps(upper);
        let last = f32::from_bits(u32::from(A[8].to_bits()) << 16);
        let vector = if C == 1 {
            self.avx._mm256_castps128_ps256(cast(first::<4, _>(x.as_flattened())))
        } else {
            cast(first::<8, _>(x.as_flattened()))
        };
        for c in 0..C {
            let spread = self.avx2._mm256_permutevar8x32_ps(vector, cast(columns::<8>(C, c)));
            sum[c] = (self.fma._mm256_fmadd_ps(eight, spread, sum[c].0), last.mul_add(x[2][c], sum[c].1));
        }
        sum
    }

    #[inline(always)]
    fn total(self, sums: [[(__m256, f32); C]; 2]) -> Row<f32, C> {
        let mut row = [[0.0; C]; 4];
        for c in 0..C {
            let sum: [f32; 8] = cast(self.avx._mm256_add_ps(sums[0][c].0, sums[1][c].0));
            row[0][c] = sum[0] + sum[3] + sum[6];
            row[1][c] = sum[1] + sum[4] + sum[7];
            row[2][c] = sum[2] + sum[5] + sums[0][c].1 + sums[1][c].1;
        }
        row
    }
}

/// Entries whose products are computed in double precision, four at a time.
pub(super) trait Widened: Entry<Number = f64> {
    /// Four entries.
    fn four(simd: V3, a: Self, b: Self, c: Self, d: Self) -> __m256d;
}

impl Widened for f64 {
    #[inline(always)]
    fn four(simd: V3, a: f64, b: f64, c: f64, d: f64) -> __m256d {
        simd.avx._mm256_setr_pd(a, b, c, d)
    }
}

impl Widened for f32 {
    #[inline(always)]
    fn four(simd: V3, a: f32, b: f32, c: f32, d: f32) -> __m256d {
        simd.avx._mm256_cvtps_pd(simd.sse._mm_setr_ps(a, b, c, d))
    }
}

/// A register holds a column of the block.
impl<const C: usize, E: Widened> Kernel<E, C> for V3 {
    type Sum = [__m256d; C];

    #[inline(always)]
    fn zero(self) -> [__m256d; C] {
        [self.avx._mm256_setzero_pd(); C]
    }

    #[inline(always)]
    fn add_product(self, mut sum: [__m256d; C], A: &[E; LOADED], x: &Row<f64, C>) -> [__m256d; C] {
        let column = [
            E::four(self, A[0], A[1], A[2], A[3]),
            E::four(self, A[3], A[4], A[5], A[6]),
            E::four(self, A[6], A[7], A[8], A[9]),
        ];
        for c in 0..C {
            sum[c] = self.fma._mm256_fmadd_pd(column[0], self.avx._mm256_set1_pd(x[0][c]), sum[c]);
            sum[c] = self.fma._mm256_fmadd_pd(column[1], self.avx._mm256_set1_pd(x[1][c]), sum[c]);
            sum[c] = self.fma._mm256_fmadd_pd(column[2], self.avx._mm256_set1_pd(x[2][c]), sum[c]);
        }
        sum
    }

    #[inline(always)]
    fn total(self, sums: [[__m256d; C]; 2]) -> Row<f64, C> {
        let mut row = [[0.0; C]; 4];
        for c in 0..C {
            let sum: [f64; 4] = cast(self.avx._mm256_add_pd(sums[0][c], sums[1][c]));
            for a in 0..3 {
                row[a][c] = sum[a];
            }
        }
        row
    }
}

/// Index of the vector component for each entry of a block, in a row of `n_columns` columns.
#[inline(always)]
const fn columns<const N: usize>(n_columns: usize, column: usize) -> [i32; N] {
    let mut at = [0; N];
    let mut entry = 0;
    while entry < N {
        // Entries after the block are multiplied with the zero after the vector.
        let component = if entry < 9 { entry / 3 } else { 3 };
        at[entry] = (component * n_columns + column) as i32;
        entry += 1;
    }
    at
}

/// The first N of a slice.
#[inline(always)]
fn first<const N: usize, T: Copy + Default>(slice: &[T]) -> [T; N] {
    let mut array = [T::default(); N];
    array.copy_from_slice(&slice[..N]);
    array
}
