//! Chunks of a field: division of a frame, and compression.

use crate::vtk::Precision;
use crate::vtk::array::compressed;

/// Approximate size of a chunk \[bytes\].
const SIZE: usize = 1 << 20;

/// Division of the rows of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Chunks {
    /// Rows of a chunk.
    pub(super) rows: usize,
    /// Chunks of a frame.
    pub(super) count: usize,
    /// Numbers of a row.
    pub(super) components: usize,
    precision: Precision,
}

impl Chunks {
    /// Chunks of nearly equal size, with few rows of padding.
    pub(super) fn new(n_rows: usize, components: usize, precision: Precision) -> Self {
        let wanted = (n_rows * components * precision.width()).div_ceil(SIZE).max(1);
        let rows = n_rows.div_ceil(wanted).max(1);
        Chunks { rows, count: n_rows.div_ceil(rows).max(1), components, precision }
    }

    /// Rows of a frame with its padding.
    pub(super) fn stride(&self) -> usize {
        self.rows * self.count
    }

    /// A chunk of a frame as stored: padded, shuffled, compressed.
    pub(super) fn stored(&self, numbers: &[f64], chunk: usize) -> Vec<u8> {
        let n = self.rows * self.components;
        let start = (chunk * n).min(numbers.len());
        let own = &numbers[start..((chunk + 1) * n).min(numbers.len())];
        compressed(&match self.precision {
            Precision::Double => shuffled(own.iter().map(|number| number.to_le_bytes()), n),
            Precision::Single => shuffled(own.iter().map(|&number| (number as f32).to_le_bytes()), n),
        })
    }
}

/// First bytes of all numbers, then the second ones, and so on (the shuffle filter of HDF5), padded with zeros to `n`
/// numbers.
fn shuffled<const W: usize>(numbers: impl Iterator<Item = [u8; W]>, n: usize) -> Vec<u8> {
    let mut bytes = vec![0; n * W];
    for (i, number) in numbers.enumerate() {
        for (plane, byte) in number.into_iter().enumerate() {
            bytes[plane * n + i] = byte;
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_take_whole_chunks_with_little_padding() {
        for n_rows in [1, 7, 43_691, 105_000, 1_000_003] {
            for (components, precision) in
                [(1, Precision::Double), (3, Precision::Single), (6, Precision::Double)]
            {
                let chunks = Chunks::new(n_rows, components, precision);
                assert!(chunks.stride() >= n_rows && chunks.stride() < n_rows + chunks.count);
                assert!(chunks.rows * components * precision.width() <= SIZE, "{n_rows} {chunks:?}");
            }
        }
    }

    #[test]
    fn bytes_are_sorted_by_their_place() {
        let bytes = shuffled([[1, 2, 3, 4], [5, 6, 7, 8]].into_iter(), 3);
        assert_eq!(bytes, [1, 5, 0, 2, 6, 0, 3, 7, 0, 4, 8, 0]);
    }
}
