//! Damaged files never make a reader panic.

use crate::meshes::{bytes, path};
use emmy_io::mesh::parse;
use proptest::prelude::*;

const FILES: [&str; 20] = [
    "hex8-22-ascii.msh",
    "hex8-22-binary.msh",
    "hex20-41-ascii.msh",
    "hex20-41-binary.msh",
    "partitioned-41.msh",
    "partitioned-41-binary.msh",
    "tet4-22-binary.msh",
    "flat.inp",
    "assembly.inp",
    "quadratic.inp",
    "wedge15-41-binary.msh",
    "mixed-22-ascii.msh",
    "wedges.inp",
    "vtk-ascii.vtu",
    "vtk-inline-zlib.vtu",
    "vtk-raw-plain.vtu",
    "vtk-raw-zlib.vtu",
    "vtk-base64-zlib.vtu",
    "legacy-42-ascii.vtk",
    "legacy-51-binary.vtk",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn cut_off(file in 0..FILES.len(), length in any::<prop::sample::Index>()) {
        let bytes = bytes(FILES[file]);
        let _ = parse(&path(FILES[file]), &bytes[..length.index(bytes.len())]);
    }

    #[test]
    fn flipped(
        file in 0..FILES.len(),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let mut bytes = bytes(FILES[file]);
        for (at, byte) in flips {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        let _ = parse(&path(FILES[file]), &bytes);
    }

    /// Changed digits in text change counts, numbers and types.
    #[test]
    fn other_digits(
        file in 0..FILES.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), b'0'..=b'9'), 1..8),
    ) {
        let mut bytes = bytes(FILES[file]);
        let digits: Vec<usize> = (0..bytes.len()).filter(|&at| bytes[at].is_ascii_digit()).collect();
        for (at, digit) in changes {
            bytes[digits[at.index(digits.len())]] = digit;
        }
        let _ = parse(&path(FILES[file]), &bytes);
    }
}
