//! Chunks of a field: how a frame is divided, and how a chunk is compressed.

use crate::vtk::array::compressed;

/// Size of a chunk, about \[bytes\].
const SIZE: usize = 1 << 20;

/// Bytes of a number.
const WIDTH: usize = size_of::<f64>();

/// How the rows of a frame are divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Chunks {
    /// Rows of a chunk.
    pub(super) rows: usize,
    /// Chunks of a frame.
    pub(super) count: usize,
    /// Numbers of a row.
    pub(super) components: usize,
}

impl Chunks {
    /// Chunks of nearly one size, as few rows being added as can be.
    pub(super) fn new(n_rows: usize, components: usize) -> Self {
        let wanted = (n_rows * components * WIDTH).div_ceil(SIZE).max(1);
        let rows = n_rows.div_ceil(wanted).max(1);
        Chunks { rows, count: n_rows.div_ceil(rows).max(1), components }
    }

    /// Rows from one frame to the next.
    pub(super) fn stride(&self) -> usize {
        self.rows * self.count
    }

    /// A chunk of a frame as it stands in the file: filled up, its bytes shuffled, compressed.
    pub(super) fn stored(&self, numbers: &[f64], chunk: usize) -> Vec<u8> {
        let n = self.rows * self.components;
        let start = (chunk * n).min(numbers.len());
        let own = &numbers[start..((chunk + 1) * n).min(numbers.len())];
        compressed(&shuffled(own, n))
    }
}

/// First bytes of all numbers, then the second ones, and so on (HDF5's shuffle filter); `n`: with so many zeros in the end.
fn shuffled(numbers: &[f64], n: usize) -> Vec<u8> {
    let mut bytes = vec![0; n * WIDTH];
    for (i, number) in numbers.iter().enumerate() {
        for (place, byte) in number.to_le_bytes().into_iter().enumerate() {
            bytes[place * n + i] = byte;
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_take_whole_chunks_with_few_rows_to_spare() {
        for n_rows in [1, 7, 43_691, 105_000, 1_000_003] {
            for components in [1, 3, 6] {
                let chunks = Chunks::new(n_rows, components);
                assert!(chunks.stride() >= n_rows && chunks.stride() < n_rows + chunks.count);
                assert!(chunks.rows * components * 8 <= SIZE, "{n_rows} {chunks:?}");
            }
        }
    }

    #[test]
    fn bytes_are_sorted_by_their_place() {
        let bytes = shuffled(&[f64::from_le_bytes([1, 2, 3, 4, 5, 6, 7, 8])], 2);
        assert_eq!(bytes, [1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0, 7, 0, 8, 0]);
    }
}
