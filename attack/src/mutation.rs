//! Damage to files.

use fastrand::Rng;

/// Numbers that a reader may mishandle.
const NUMBERS: [&str; 24] = [
    "0",
    "-0.0",
    "-1",
    "1",
    "1e308",
    "-1e308",
    "1e-308",
    "5e-324",
    "1e160",
    "nan",
    "inf",
    "-inf",
    "1e17",
    "1e999",
    "2147483648",
    "4294967296",
    "9223372036854775807",
    "18446744073709551616",
    "-9223372036854775809",
    "0.1",
    "1e-9",
    "3",
    "7",
    "99999999",
];

/// A damaged copy with one to four changes, mostly one.
pub fn damaged(bytes: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..[1, 1, 1, 2, 4][rng.usize(..5)] {
        damage(&mut bytes, rng);
    }
    bytes
}

fn damage(bytes: &mut Vec<u8>, rng: &mut Rng) {
    if bytes.is_empty() {
        bytes.push(rng.u8(..));
        return;
    }
    match rng.usize(..9) {
        0 => {
            let at = rng.usize(..bytes.len());
            bytes[at] ^= 1 << rng.u8(..8);
        }
        1 => {
            let at = rng.usize(..bytes.len());
            bytes[at] = rng.u8(..);
        }
        2 => bytes.truncate(rng.usize(..bytes.len())),
        3 => {
            let start = rng.usize(..bytes.len());
            let longest = 1 << rng.usize(..12);
            let length = rng.usize(..=(bytes.len() - start).min(longest));
            bytes.drain(start..start + length);
        }
        4 => insert_noise(bytes, rng),
        5 | 6 => lines(bytes, rng),
        _ => numbers(bytes, rng),
    }
}

fn insert_noise(bytes: &mut Vec<u8>, rng: &mut Rng) {
    let at = rng.usize(..=bytes.len());
    let noise: Vec<u8> = match rng.usize(..20) {
        // A line that is too long for a message.
        0 => vec![b"0 (,=x"[rng.usize(..6)]; 100_000],
        _ => (0..1 << rng.usize(..6)).map(|_| rng.u8(..)).collect(),
    };
    bytes.splice(at..at, noise);
}

/// Removes, duplicates or moves a line.
fn lines(bytes: &mut Vec<u8>, rng: &mut Rng) {
    let mut lines: Vec<Vec<u8>> = bytes.split_inclusive(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
    let at = rng.usize(..lines.len());
    match rng.usize(..3) {
        0 => drop(lines.remove(at)),
        1 => lines.insert(at, lines[at].clone()),
        _ => {
            let other = rng.usize(..lines.len());
            lines.swap(at, other);
        }
    }
    *bytes = lines.concat();
}

/// Replaces a number by an odd one, or by another number of the file.
fn numbers(bytes: &mut Vec<u8>, rng: &mut Rng) {
    let places = number_places(bytes);
    if places.is_empty() {
        return insert_noise(bytes, rng);
    }
    let place = places[rng.usize(..places.len())].clone();
    let new = match rng.bool() {
        true => NUMBERS[rng.usize(..NUMBERS.len())].as_bytes().to_vec(),
        false => bytes[places[rng.usize(..places.len())].clone()].to_vec(),
    };
    bytes.splice(place, new);
}

fn number_places(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let is_part = |byte: u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+' | b'e' | b'E');
    let (mut places, mut start) = (Vec::new(), None);
    for (at, &byte) in bytes.iter().chain([&b' ']).enumerate() {
        match (start, is_part(byte)) {
            (None, true) if byte.is_ascii_digit() || byte == b'-' => start = Some(at),
            (Some(from), false) => {
                places.push(from..at);
                start = None;
            }
            _ => {}
        }
    }
    places
}
