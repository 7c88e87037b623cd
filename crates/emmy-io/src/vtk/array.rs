//! Data arrays of VTK's XML files: little-endian, compressed with zlib in blocks, as base64.

use std::io::Write;

use base64::{Engine, engine::general_purpose::STANDARD};
use flate2::{Compression, write::ZlibEncoder};
use rayon::prelude::*;

/// A type of the numbers in arrays.
pub(super) trait Numeric: Copy {
    /// Name of the type in VTK.
    const NAME: &'static str;
    /// Appends the number, least significant byte first.
    fn push(self, bytes: &mut Vec<u8>);
}

macro_rules! numeric {
    ($($type:ty, $name:literal;)*) => {
        $(impl Numeric for $type {
            const NAME: &'static str = $name;
            fn push(self, bytes: &mut Vec<u8>) {
                bytes.extend_from_slice(&self.to_le_bytes());
            }
        })*
    };
}
numeric! { f64, "Float64"; f32, "Float32"; i64, "Int64"; i32, "Int32"; u8, "UInt8"; }

/// Size of a compressed block \[bytes\].
const BLOCK: usize = 1 << 20;

/// A `DataArray` element; `components`: numbers per tuple.
pub(super) fn data_array<T: Numeric>(
    name: &str,
    components: usize,
    numbers: impl Iterator<Item = T>,
) -> String {
    element::<T>(name, components, "", numbers)
}

/// A `DataArray` element with named components; a scalar has one empty name.
pub(super) fn named_components<T: Numeric>(
    name: &str,
    components: &[&str],
    numbers: impl Iterator<Item = T>,
) -> String {
    let named = components.iter().enumerate().filter(|(_, component)| !component.is_empty());
    let names: String = named.map(|(i, component)| format!(" ComponentName{i}=\"{component}\"")).collect();
    element::<T>(name, components.len(), &names, numbers)
}

fn element<T: Numeric>(
    name: &str,
    components: usize,
    attributes: &str,
    numbers: impl Iterator<Item = T>,
) -> String {
    let mut bytes = Vec::with_capacity(size_of::<T>() * numbers.size_hint().0);
    numbers.for_each(|number| number.push(&mut bytes));
    format!(
        "<DataArray type=\"{}\" Name=\"{name}\" NumberOfComponents=\"{components}\"{attributes} format=\"binary\">{}</DataArray>\n",
        T::NAME,
        encoded(&bytes)
    )
}

/// Header (number of blocks, size of a block, size of the last one if smaller, compressed sizes) and blocks.
fn encoded(bytes: &[u8]) -> String {
    let blocks: Vec<Vec<u8>> = bytes.par_chunks(BLOCK).map(compressed).collect();
    let mut header = Vec::new();
    for number in [blocks.len(), BLOCK, bytes.len() % BLOCK].into_iter().chain(blocks.iter().map(Vec::len)) {
        header.extend_from_slice(&(number as u64).to_le_bytes());
    }
    STANDARD.encode(header) + &STANDARD.encode(blocks.concat())
}

/// Level of the compression, 1 to 9. Level 4 takes twice the time and saves 5 %.
pub(super) const LEVEL: u32 = 1;

/// A block compressed by zlib.
pub(super) fn compressed(block: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(LEVEL));
    // Writing to memory cannot fail.
    let _ = encoder.write_all(block);
    encoder.finish().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    #[test]
    fn arrays_decode_to_their_values() {
        for n in [0, 1, 1000, BLOCK / 8, BLOCK / 8 + 1, BLOCK / 4] {
            let numbers: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
            let text = data_array("x", 1, numbers.iter().copied());
            let text = &text[text.find('>').unwrap() + 1..text.rfind('<').unwrap()];
            let n_blocks = u64::from_le_bytes(STANDARD.decode(&text[..12]).unwrap()[..8].try_into().unwrap());
            let header = (24 + 8 * n_blocks as usize).div_ceil(3) * 4;
            let mut rest = STANDARD.decode(&text[header..]).unwrap();
            let mut bytes = Vec::new();
            while !rest.is_empty() {
                let mut decoder = flate2::bufread::ZlibDecoder::new(&rest[..]);
                decoder.read_to_end(&mut bytes).unwrap();
                let used = decoder.total_in() as usize;
                rest.drain(..used);
            }
            let decoded: Vec<f64> =
                bytes.chunks(8).map(|chunk| f64::from_le_bytes(chunk.try_into().unwrap())).collect();
            assert_eq!(decoded, numbers);
            assert_eq!(n_blocks as usize, (8 * n).div_ceil(BLOCK));
        }
    }
}
