//! Values as bytes: fields with names in MessagePack, followed by a checksum.

use std::io;

use serde::Serialize;

/// Appends a value, and the CRC-32 of all bytes from `start` on, the lowest byte first.
///
/// # Errors
/// None in practice: lists, numbers and text can always be encoded.
pub(crate) fn append(bytes: &mut Vec<u8>, start: usize, value: &impl Serialize) -> io::Result<()> {
    rmp_serde::encode::write_named(bytes, value).map_err(io::Error::other)?;
    let sum = crc32fast::hash(&bytes[start..]);
    bytes.extend(sum.to_le_bytes());
    Ok(())
}

/// The bytes before the checksum, if it is correct.
pub(crate) fn verified(bytes: &[u8]) -> Option<&[u8]> {
    let (content, sum) = bytes.split_last_chunk::<4>()?;
    (crc32fast::hash(content) == u32::from_le_bytes(*sum)).then_some(content)
}
