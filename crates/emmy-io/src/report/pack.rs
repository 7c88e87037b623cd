//! Typed arrays of a page, split into planes of bytes, compressed by zlib, as base64.

use std::io::Write;

use base64::{Engine, engine::general_purpose::STANDARD};
use flate2::{Compression, write::ZlibEncoder};
use serde_json::{Value, json};

/// A type of the numbers in arrays.
pub(super) trait Item: Copy {
    /// Name of the type.
    const NAME: &'static str;
    /// Bytes of a number.
    const WIDTH: usize;
    /// A byte of the number; 0 is the least significant.
    fn byte(self, plane: usize) -> u8;
}

macro_rules! items {
    ($($type:ty, $name:literal;)*) => {
        $(impl Item for $type {
            const NAME: &'static str = $name;
            const WIDTH: usize = size_of::<$type>();
            fn byte(self, plane: usize) -> u8 {
                self.to_le_bytes()[plane]
            }
        })*
    };
}
items! { f64, "f64"; f32, "f32"; u32, "u32"; u16, "u16"; u8, "u8"; }

/// Arrays with names. All first bytes of an array come first, then all second ones, and so on: exponents and high bytes
/// are similar, and compress well.
#[derive(Debug, Default)]
pub(super) struct Pack {
    bytes: Vec<u8>,
    places: Vec<Value>,
}

impl Pack {
    /// Adds an array.
    pub(super) fn push<T: Item>(&mut self, name: &str, items: &[T]) {
        let place =
            json!({ "name": name, "type": T::NAME, "length": items.len(), "offset": self.bytes.len() });
        self.places.push(place);
        for plane in 0..T::WIDTH {
            self.bytes.extend(items.iter().map(|item| item.byte(plane)));
        }
    }

    /// Manifest of the arrays, and all bytes as text.
    pub(super) fn finish(self) -> (Vec<Value>, String) {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(6));
        // Writing to memory cannot fail.
        let _ = encoder.write_all(&self.bytes);
        (self.places, STANDARD.encode(encoder.finish().unwrap_or_default()))
    }
}

/// Numbers as integers from 0 (the smallest) to 65535 or 255 (the largest), each stored as the difference from the
/// previous one, since neighbours are similar. Numbers that are not finite become the smallest. Returns the bounds.
pub(super) fn quantised<T: Item>(
    values: impl Iterator<Item = f64> + Clone,
    whole: impl Fn(u32) -> T,
    quantised: &mut Vec<T>,
) -> [f64; 2] {
    let finite = values.clone().filter(|value| value.is_finite());
    let bounds = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
    let [low, high] = if bounds[0] <= bounds[1] { bounds } else { [0.0; 2] };
    let steps = 2f64.powi(8 * T::WIDTH as i32) - 1.0;
    let unit = if high > low { steps / (high - low) } else { 0.0 };
    let mut before = 0u32;
    quantised.extend(values.map(|value| {
        let number = if value.is_finite() { ((value - low) * unit).round() as u32 } else { 0 };
        let difference = number.wrapping_sub(before);
        before = number;
        whole(difference)
    }));
    [low, high]
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    fn unpacked(text: &str) -> Vec<u8> {
        let bytes = STANDARD.decode(text).unwrap();
        let mut unpacked = Vec::new();
        flate2::read::ZlibDecoder::new(&bytes[..]).read_to_end(&mut unpacked).unwrap();
        unpacked
    }

    #[test]
    fn arrays_stand_plane_by_plane() {
        let mut pack = Pack::default();
        pack.push("a", &[1u8, 2]);
        pack.push("b", &[0x0102u16, 0x0304]);
        pack.push("c", &[1.5f64]);
        let (places, text) = pack.finish();
        let bytes = unpacked(&text);
        assert_eq!(bytes[..6], [1, 2, 0x02, 0x04, 0x01, 0x03]);
        assert_eq!(bytes[6..], 1.5f64.to_le_bytes());
        assert_eq!(places[2], json!({ "name": "c", "type": "f64", "length": 1, "offset": 6 }));
    }

    #[test]
    fn quantised_numbers_are_within_half_a_part() {
        let values: Vec<f64> = (0..1000).map(|i| 3.0 + (0.1 * f64::from(i)).sin()).collect();
        let mut differences = Vec::new();
        let [low, high] = quantised(values.iter().copied(), |x| x as u16, &mut differences);
        let mut number = 0u16;
        for (value, difference) in values.iter().zip(&differences) {
            number = number.wrapping_add(*difference);
            let back = low + (high - low) / 65535.0 * f64::from(number);
            assert!((back - value).abs() <= 0.5000001 * (high - low) / 65535.0);
        }
        assert_eq!(quantised([f64::NAN, f64::NAN].into_iter(), |x| x as u8, &mut Vec::new()), [0.0; 2]);
        assert_eq!(quantised([2.0, 2.0].into_iter(), |x| x as u8, &mut Vec::new()), [2.0; 2]);
    }
}
