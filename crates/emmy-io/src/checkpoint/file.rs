//! The form of the file: a header, texts and lists of numbers with names, a checksum over all before it.
//!
//! | part | form |
//! |---|---|
//! | header | `emmy checkpoint 2` and a line feed |
//! | texts | their number, then name and text of each, with their lengths before them |
//! | lists | their number, then name, number of entries and entries of each |
//! | checksum | CRC-32 of everything before it |
//!
//! Lengths and counts are 64-bit whole numbers, entries 64-bit floating-point numbers, all with the lowest byte first.

const HEADER: &[u8] = b"emmy checkpoint 2\n";

/// Texts and lists of numbers with names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Parts {
    pub texts: Vec<(String, String)>,
    pub lists: Vec<(String, Vec<f64>)>,
}

impl Parts {
    /// A text by its name.
    pub fn text(&self, name: &str) -> Result<&str, String> {
        let found = self.texts.iter().find(|(own, _)| own == name);
        found.map(|(_, text)| text.as_str()).ok_or_else(|| format!("has no `{name}`"))
    }

    /// A list by its name.
    pub fn list(&self, name: &str) -> Result<&[f64], String> {
        let found = self.lists.iter().find(|(own, _)| own == name);
        found.map(|(_, list)| &list[..]).ok_or_else(|| format!("has no `{name}`"))
    }

    /// A list of a given length.
    pub fn array<const N: usize>(&self, name: &str) -> Result<[f64; N], String> {
        let list = self.list(name)?;
        list.try_into().map_err(|_| format!("has {} numbers in `{name}`, not {N}", list.len()))
    }

    /// The bytes of the file.
    pub fn bytes(&self) -> Vec<u8> {
        let numbers: usize = self.lists.iter().map(|(_, list)| list.len()).sum();
        let mut bytes = Vec::with_capacity(8 * numbers + 65_536);
        bytes.extend(HEADER);
        put_count(&mut bytes, self.texts.len());
        for text in self.texts.iter().flat_map(|(name, text)| [name, text]) {
            put_text(&mut bytes, text);
        }
        put_count(&mut bytes, self.lists.len());
        for (name, list) in &self.lists {
            put_text(&mut bytes, name);
            put_count(&mut bytes, list.len());
            list.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
        }
        let sum = crc32fast::hash(&bytes);
        bytes.extend(sum.to_le_bytes());
        bytes
    }

    /// Reads the bytes of a file. Nothing is allocated for what is not there.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        if !bytes.starts_with(HEADER) {
            let is_other = bytes.starts_with(&HEADER[..16]);
            return Err(if is_other {
                "is of another version of Emmy, which this one cannot resume"
            } else {
                "is no checkpoint"
            }
            .into());
        }
        let (content, sum) = bytes.split_last_chunk::<4>().ok_or(DAMAGED)?;
        if crc32fast::hash(content) != u32::from_le_bytes(*sum) {
            return Err(DAMAGED.into());
        }
        let mut rest = content.get(HEADER.len()..).ok_or(DAMAGED)?;
        let mut parts = Parts::default();
        for _ in 0..take_count(&mut rest)? {
            parts.texts.push((take_text(&mut rest)?, take_text(&mut rest)?));
        }
        for _ in 0..take_count(&mut rest)? {
            let name = take_text(&mut rest)?;
            let length = take_count(&mut rest)?.checked_mul(8).ok_or(DAMAGED)?;
            let numbers = take(&mut rest, length)?.as_chunks::<8>().0;
            parts.lists.push((name, numbers.iter().map(|number| f64::from_le_bytes(*number)).collect()));
        }
        if rest.is_empty() { Ok(parts) } else { Err(DAMAGED.into()) }
    }
}

const DAMAGED: &str = "is damaged";

fn put_count(bytes: &mut Vec<u8>, count: usize) {
    bytes.extend((count as u64).to_le_bytes());
}

fn put_text(bytes: &mut Vec<u8>, text: &str) {
    put_count(bytes, text.len());
    bytes.extend(text.as_bytes());
}

fn take<'a>(rest: &mut &'a [u8], length: usize) -> Result<&'a [u8], String> {
    let (taken, left) = rest.split_at_checked(length).ok_or(DAMAGED)?;
    *rest = left;
    Ok(taken)
}

fn take_count(rest: &mut &[u8]) -> Result<usize, String> {
    let (count, left) = rest.split_first_chunk::<8>().ok_or(DAMAGED)?;
    *rest = left;
    usize::try_from(u64::from_le_bytes(*count)).map_err(|_| DAMAGED.to_string())
}

fn take_text(rest: &mut &[u8]) -> Result<String, String> {
    let length = take_count(rest)?;
    String::from_utf8(take(rest, length)?.to_vec()).map_err(|_| DAMAGED.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts() -> Parts {
        Parts {
            texts: vec![("input".into(), "title = \"ä\"\n".into()), ("empty".into(), String::new())],
            lists: vec![("state".into(), vec![1.0, -0.0, 1e-300, f64::INFINITY]), ("none".into(), vec![])],
        }
    }

    #[test]
    fn what_is_written_reads_back() {
        let read = Parts::read(&parts().bytes()).unwrap();
        assert_eq!(read, parts());
        assert!(read.list("state").unwrap()[1].is_sign_negative());
        assert!(
            read.text("input").is_ok() && read.text("output").is_err() && read.array::<3>("state").is_err()
        );
    }

    #[test]
    fn every_damage_is_seen() {
        let whole = parts().bytes();
        for length in 0..whole.len() {
            assert!(Parts::read(&whole[..length]).is_err());
            let mut flipped = whole.clone();
            flipped[length] ^= 4;
            assert!(Parts::read(&flipped).is_err());
        }
    }

    #[test]
    fn counts_beyond_the_file_are_refused_before_anything_is_allocated() {
        let whole = parts().bytes();
        for at in HEADER.len()..whole.len() - 12 {
            let mut odd = whole[..whole.len() - 4].to_vec();
            odd[at..at + 8].copy_from_slice(&(u64::MAX / 8).to_le_bytes());
            let sum = crc32fast::hash(&odd);
            odd.extend(sum.to_le_bytes());
            // A whole checksum does not make a whole file; only inside the numbers themselves may anything stand.
            if let Ok(read) = Parts::read(&odd) {
                assert_eq!(read.lists.len(), 2, "{at}");
            }
        }
        let older = [b"emmy checkpoint 1\n", &whole[HEADER.len()..]].concat();
        assert_eq!(
            Parts::read(&older),
            Err("is of another version of Emmy, which this one cannot resume".into())
        );
        assert_eq!(Parts::read(b"hello"), Err("is no checkpoint".into()));
    }
}
