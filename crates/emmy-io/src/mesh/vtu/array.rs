//! Numbers of a `DataArray`: ASCII, base64 or raw, plain or compressed with zlib (VTK File Formats, "XML File
//! Formats").

use std::io::Read;

use base64::{Engine, engine::general_purpose::STANDARD};
use flate2::bufread::ZlibDecoder;

use super::Numbers;

/// Encoding of the binary arrays of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Encoding {
    pub(super) big_endian: bool,
    /// Bytes of a number in the header of an array, 4 or 8.
    pub(super) header: usize,
    pub(super) compressed: bool,
}

/// Result with a reason that continues a message.
type Outcome<T> = Result<T, String>;

/// Numbers written as text.
pub(super) fn from_text(numeric_type: &str, text: &str) -> Outcome<Numbers> {
    let words = text.split_ascii_whitespace();
    let wrong =
        |word: &str| format!("expected a number, found \"{}\"", word.chars().take(40).collect::<String>());
    if numeric_type.starts_with("Float") {
        let real = |word: &str| word.parse().map_err(|_| wrong(word));
        return Ok(Numbers::Real(words.map(real).collect::<Outcome<_>>()?));
    }
    let whole = |word: &str| word.parse().map_err(|_| wrong(word));
    Ok(Numbers::Whole(words.map(whole).collect::<Outcome<_>>()?))
}

/// Numbers of a type in their bytes.
pub(super) fn from_bytes(numeric_type: &str, encoding: Encoding, bytes: &[u8]) -> Outcome<Numbers> {
    macro_rules! numbers {
        ($variant:ident, $type:ty, $as:ty) => {{
            const SIZE: usize = size_of::<$type>();
            if !bytes.len().is_multiple_of(SIZE) {
                return Err(format!("{} bytes are no whole number of {numeric_type}", bytes.len()));
            }
            let number = |chunk: &[u8]| {
                let mut array = [0; SIZE];
                array.copy_from_slice(chunk);
                let from = if encoding.big_endian { <$type>::from_be_bytes } else { <$type>::from_le_bytes };
                from(array) as $as
            };
            Ok(Numbers::$variant(bytes.chunks_exact(SIZE).map(number).collect()))
        }};
    }
    match numeric_type {
        "Int8" => numbers!(Whole, i8, i64),
        "UInt8" => numbers!(Whole, u8, i64),
        "Int16" => numbers!(Whole, i16, i64),
        "UInt16" => numbers!(Whole, u16, i64),
        "Int32" => numbers!(Whole, i32, i64),
        "UInt32" => numbers!(Whole, u32, i64),
        "Int64" => numbers!(Whole, i64, i64),
        "UInt64" => numbers!(Whole, u64, i64),
        "Float32" => numbers!(Real, f32, f64),
        "Float64" => numbers!(Real, f64, f64),
        _ => Err(format!("numbers of type {numeric_type} are not read")),
    }
}

/// The first `n` bits, the highest of a byte first.
pub(super) fn from_bits(bytes: &[u8], n: usize) -> Outcome<Numbers> {
    if bytes.len() != n.div_ceil(8) {
        return Err(format!("{} bytes instead of the {} of {n} bits", bytes.len(), n.div_ceil(8)));
    }
    let bits = bytes.iter().flat_map(|byte| (0..8).rev().map(move |place| i64::from((byte >> place) & 1)));
    Ok(Numbers::Whole(bits.take(n).collect()))
}

/// Bytes of base64; a header and its data may have been encoded separately.
pub(super) fn from_base64(text: &[u8]) -> Outcome<Vec<u8>> {
    let text: Vec<u8> = text.iter().copied().filter(|byte| !byte.is_ascii_whitespace()).collect();
    let mut rest = &text[..];
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    while !rest.is_empty() {
        let padding = rest.iter().position(|&byte| byte == b'=').unwrap_or(rest.len());
        let end = ((padding / 4 + 1) * 4).min(rest.len());
        let decoded = STANDARD.decode_vec(&rest[..end], &mut bytes);
        decoded.map_err(|error| format!("text that is not base64: {error}"))?;
        rest = &rest[end..];
    }
    Ok(bytes)
}

/// Data of an array after its header: a length, or the sizes of compressed blocks. More bytes may follow. Compressed
/// data of more than `most` bytes are rejected before they are read: a small file can expand to very many.
pub(super) fn payload(encoding: Encoding, bytes: &[u8], most: usize) -> Outcome<Vec<u8>> {
    let mut rest = bytes;
    let n = header_number(encoding, &mut rest)?;
    if !encoding.compressed {
        return Ok(rest.get(..n).ok_or_else(|| cut_off(n, rest.len()))?.to_vec());
    }
    if n == 0 {
        return Ok(Vec::new());
    }
    let [size, last] = [header_number(encoding, &mut rest)?, header_number(encoding, &mut rest)?];
    if n > rest.len() {
        return Err(cut_off(n, rest.len()));
    }
    let wanted = (n - 1).saturating_mul(size).saturating_add(if last > 0 { last } else { size });
    if wanted > most {
        return Err(format!("{wanted} bytes are announced where {most} are needed"));
    }
    let sizes = (0..n).map(|_| header_number(encoding, &mut rest)).collect::<Outcome<Vec<usize>>>()?;
    let mut data = Vec::new();
    for (block, compressed) in sizes.into_iter().enumerate() {
        let (bytes, after) =
            rest.split_at_checked(compressed).ok_or_else(|| cut_off(compressed, rest.len()))?;
        let wanted = if block + 1 == n && last > 0 { last } else { size };
        inflate(bytes, wanted, &mut data)?;
        rest = after;
    }
    Ok(data)
}

/// Largest size of a number in bytes, by its type; `None` for a type without numbers.
pub(super) fn size(numeric_type: &str) -> Option<usize> {
    match numeric_type {
        "Bit" | "Int8" | "UInt8" => Some(1),
        "Int16" | "UInt16" => Some(2),
        "Int32" | "UInt32" | "Float32" => Some(4),
        "Int64" | "UInt64" | "Float64" => Some(8),
        _ => None,
    }
}

/// Adds a block of a known size. It grows as it is read, so that a wrong size costs nothing.
fn inflate(bytes: &[u8], wanted: usize, data: &mut Vec<u8>) -> Outcome<()> {
    let before = data.len();
    let read = ZlibDecoder::new(bytes).take(wanted as u64).read_to_end(data);
    read.map_err(|error| format!("compressed data that cannot be read: {error}"))?;
    match data.len() - before == wanted {
        true => Ok(()),
        false => Err(cut_off(wanted, data.len() - before)),
    }
}

fn header_number(encoding: Encoding, rest: &mut &[u8]) -> Outcome<usize> {
    let (bytes, after) =
        rest.split_at_checked(encoding.header).ok_or_else(|| cut_off(encoding.header, rest.len()))?;
    *rest = after;
    let digit = |number: u64, byte: &u8| (number << 8) | u64::from(*byte);
    let number = match encoding.big_endian {
        true => bytes.iter().fold(0, digit),
        false => bytes.iter().rev().fold(0, digit),
    };
    usize::try_from(number).map_err(|_| cut_off(usize::MAX, rest.len()))
}

fn cut_off(wanted: usize, found: usize) -> String {
    format!("{wanted} bytes are announced where there are {found}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Encoding = Encoding { big_endian: false, header: 4, compressed: false };

    #[test]
    fn header_and_data_may_be_encoded_together_or_one_by_one() {
        let header = 8u32.to_le_bytes();
        let data = 0.5f64.to_le_bytes();
        let together = STANDARD.encode([&header[..], &data[..]].concat());
        let apart = STANDARD.encode(header) + "\n  " + &STANDARD.encode(data);
        assert_ne!(together, apart);
        for text in [together, apart] {
            let bytes = payload(PLAIN, &from_base64(text.as_bytes()).unwrap(), 8).unwrap();
            assert_eq!(from_bytes("Float64", PLAIN, &bytes), Ok(Numbers::Real(vec![0.5])));
        }
    }

    #[test]
    fn padding_in_the_wrong_place_is_told() {
        for text in ["=", "====", "A===", "AAA=BB"] {
            assert!(from_base64(text.as_bytes()).is_err(), "{text}");
        }
    }

    #[test]
    fn the_largest_byte_may_come_first() {
        let encoding = Encoding { big_endian: true, ..PLAIN };
        let bytes = [0, 0, 0, 4, 0xff, 0xff, 1, 2];
        let data = payload(encoding, &bytes, 4).unwrap();
        assert_eq!(from_bytes("Int16", encoding, &data), Ok(Numbers::Whole(vec![-1, 258])));
    }

    #[test]
    fn bits_begin_with_the_highest_of_a_byte() {
        assert_eq!(from_bits(&[0xa0, 0x40], 10), Ok(Numbers::Whole(vec![1, 0, 1, 0, 0, 0, 0, 0, 0, 1])));
        assert_eq!(from_bits(&[0xa0], 10).unwrap_err(), "1 bytes instead of the 2 of 10 bits");
    }

    #[test]
    fn sizes_that_lie_are_told() {
        assert!(payload(PLAIN, &[9, 0, 0, 0, 1], 9).unwrap_err().contains("9 bytes are announced"));
        let compressed = Encoding { compressed: true, header: 8, ..PLAIN };
        assert!(payload(compressed, &[0xff; 48], 9).unwrap_err().contains("are announced"));
    }

    #[test]
    fn a_small_file_cannot_ask_for_all_the_memory() {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        std::io::copy(&mut std::io::repeat(0).take(1 << 24), &mut encoder).unwrap();
        let data = encoder.finish().unwrap();
        let header = [1, 1 << 24, 0, data.len() as u32].map(u32::to_le_bytes).concat();
        let bytes = [header, data].concat();
        assert!(bytes.len() < 20_000);
        let compressed = Encoding { compressed: true, ..PLAIN };
        assert_eq!(payload(compressed, &bytes, 1 << 24).unwrap().len(), 1 << 24);
        let rejected = payload(compressed, &bytes, 24).unwrap_err();
        assert_eq!(rejected, "16777216 bytes are announced where 24 are needed");
    }
}
