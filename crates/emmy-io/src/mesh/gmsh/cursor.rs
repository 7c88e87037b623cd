//! Reading position in an MSH file, ASCII or binary.

use std::path::Path;
use std::str::FromStr;

use super::super::{MeshError, Place, Position, Result};

/// Encoding of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Reading position. Sections, counts and names are the same in both encodings, so one parser serves both.
pub(super) struct Cursor<'a> {
    file: &'a Path,
    bytes: &'a [u8],
    offset: usize,
    pub(super) encoding: Encoding,
}

const DAMAGED: &str = "the file is damaged or cut off, write it again";

impl<'a> Cursor<'a> {
    pub(super) fn new(file: &'a Path, bytes: &'a [u8]) -> Self {
        Cursor { file, bytes, offset: 0, encoding: Encoding::Ascii }
    }

    pub(super) fn file(&self) -> &'a Path {
        self.file
    }

    /// Offset of the next token (ASCII) or byte (binary).
    pub(super) fn offset(&mut self) -> usize {
        if self.encoding == Encoding::Ascii {
            self.skip_whitespace();
        }
        self.offset
    }

    /// The place of an offset, for messages.
    pub(super) fn place(&self, offset: usize) -> Place {
        let line = || 1 + self.bytes[..offset].iter().filter(|&&byte| byte == b'\n').count();
        let position = match self.encoding {
            Encoding::Ascii => Position::Line(line()),
            _ => Position::Byte(offset),
        };
        Place { file: self.file.to_path_buf(), position }
    }

    pub(super) fn malformed(&self, offset: usize, problem: String) -> MeshError {
        MeshError::Malformed { place: self.place(offset), problem, advice: DAMAGED }
    }

    /// Name of the next section, without the dollar; text between sections is skipped.
    pub(super) fn section(&mut self) -> Result<Option<&'a str>> {
        loop {
            self.skip_whitespace();
            let offset = self.offset;
            if offset == self.bytes.len() {
                return Ok(None);
            }
            if let Some(name) = self.line()?.strip_prefix('$') {
                return match name.to_ascii_lowercase().starts_with("end") {
                    true => Err(self.malformed(offset, format!("${name} without its beginning"))),
                    false => Ok(Some(name)),
                };
            }
        }
    }

    /// Whether one of some texts comes later.
    pub(super) fn has_ahead(&self, texts: [&str; 2]) -> bool {
        let rest = &self.bytes[self.offset..];
        texts.iter().any(|text| rest.windows(text.len()).any(|window| window == text.as_bytes()))
    }

    /// Goes back to an offset.
    pub(super) fn back_to(&mut self, offset: usize) {
        self.offset = offset;
    }

    /// Reads `$EndName`, in MSH 1 `$ENDNAME`.
    pub(super) fn end(&mut self, name: &str) -> Result<()> {
        self.skip_whitespace();
        let offset = self.offset;
        let found = self.bytes[offset..].split(u8::is_ascii_whitespace).next().unwrap_or_default();
        if found.eq_ignore_ascii_case(format!("$End{name}").as_bytes()) {
            self.offset += found.len();
            return Ok(());
        }
        Err(self.malformed(offset, format!("expected $End{name}, found {}", shown(found))))
    }

    /// Skips the rest of a section.
    pub(super) fn skip_section(&mut self, name: &str) -> Result<()> {
        let end = format!("$End{name}");
        let rest = &self.bytes[self.offset..];
        match rest.windows(end.len()).position(|window| window == end.as_bytes()) {
            Some(length) => self.offset += length,
            None => return Err(self.malformed(self.offset, format!("section ${name} has no {end}"))),
        }
        Ok(())
    }

    /// The rest of the line, trimmed; sections and names are text in binary files too.
    pub(super) fn line(&mut self) -> Result<&'a str> {
        let start = self.offset;
        let rest = &self.bytes[start..];
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.offset = (start + length + 1).min(self.bytes.len());
        let text = std::str::from_utf8(&rest[..length]);
        let text = text.map_err(|_| self.malformed(start, "text that is not UTF-8".to_string()))?;
        Ok(text.trim())
    }

    /// A count on its own line as text, in binary files too (MSH 2.2).
    pub(super) fn count_line(&mut self, what: &'static str, min_bytes: usize) -> Result<u64> {
        self.skip_whitespace();
        let start = self.offset;
        let text = self.line()?;
        let count = text.parse();
        let count = count.map_err(|_| self.unexpected(start, "a count", text.as_bytes()))?;
        self.checked_count(start, what, count, min_bytes)
    }

    /// A count of items with a least number of bytes each.
    pub(super) fn count(&mut self, what: &'static str, min_bytes: usize) -> Result<u64> {
        let start = self.offset();
        let count = self.size()?;
        self.checked_count(start, what, count, min_bytes)
    }

    /// Wrong counts must not make the reader allocate or loop beyond the size of the file.
    pub(super) fn checked_count(
        &self,
        start: usize,
        what: &'static str,
        count: u64,
        min_bytes: usize,
    ) -> Result<u64> {
        let room = ((self.bytes.len() - self.offset) / min_bytes.max(1)) as u64 + 1;
        if count <= room {
            return Ok(count);
        }
        Err(MeshError::Count { place: self.place(start), what, count, room })
    }

    /// An `int` of the format.
    pub(super) fn int(&mut self) -> Result<i64> {
        match self.encoding {
            Encoding::Ascii => self.parsed("an integer"),
            Encoding::LittleEndian => Ok(i32::from_le_bytes(self.array()?).into()),
            Encoding::BigEndian => Ok(i32::from_be_bytes(self.array()?).into()),
        }
    }

    /// An `int` that must not be negative.
    pub(super) fn whole(&mut self) -> Result<u64> {
        let start = self.offset();
        let int = self.int()?;
        u64::try_from(int)
            .map_err(|_| self.malformed(start, format!("expected a number from 0 on, found {int}")))
    }

    /// A `size_t` of the format.
    pub(super) fn size(&mut self) -> Result<u64> {
        match self.encoding {
            Encoding::Ascii => self.parsed("a whole number"),
            Encoding::LittleEndian => Ok(u64::from_le_bytes(self.array()?)),
            Encoding::BigEndian => Ok(u64::from_be_bytes(self.array()?)),
        }
    }

    /// A `double` of the format.
    pub(super) fn real(&mut self) -> Result<f64> {
        match self.encoding {
            Encoding::Ascii => self.parsed("a number"),
            Encoding::LittleEndian => Ok(f64::from_le_bytes(self.array()?)),
            Encoding::BigEndian => Ok(f64::from_be_bytes(self.array()?)),
        }
    }

    /// Skips a number of `double`s.
    pub(super) fn skip_reals(&mut self, count: u64) -> Result<()> {
        (0..count).try_for_each(|_| self.real().map(drop))
    }

    /// Skips a counted list of `int`s.
    pub(super) fn skip_ints(&mut self) -> Result<()> {
        let count = self.count("tags", 2)?;
        (0..count).try_for_each(|_| self.int().map(drop))
    }

    pub(super) fn point(&mut self) -> Result<[f64; 3]> {
        Ok([self.real()?, self.real()?, self.real()?])
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let Some(&array) = self.bytes[self.offset..].first_chunk() else {
            return Err(
                self.malformed(self.offset, format!("the file ends where {N} more bytes are expected"))
            );
        };
        self.offset += N;
        Ok(array)
    }

    fn parsed<T: FromStr>(&mut self, what: &str) -> Result<T> {
        self.skip_whitespace();
        let rest = &self.bytes[self.offset..];
        let token = rest.split(u8::is_ascii_whitespace).next().unwrap_or_default();
        let value = std::str::from_utf8(token).ok().and_then(|token| token.parse().ok());
        let value = value.ok_or_else(|| self.unexpected(self.offset, what, token))?;
        self.offset += token.len();
        Ok(value)
    }

    fn unexpected(&self, offset: usize, wanted: &str, found: &[u8]) -> MeshError {
        self.malformed(offset, format!("expected {wanted}, found {}", shown(found)))
    }

    fn skip_whitespace(&mut self) {
        let rest = &self.bytes[self.offset..];
        self.offset += rest.len() - rest.trim_ascii_start().len();
    }
}

/// The text found, short enough for a message.
fn shown(found: &[u8]) -> String {
    match found {
        [] => "the end of the file".to_string(),
        _ => format!("\"{}\"", String::from_utf8_lossy(&found[..found.len().min(40)]).escape_debug()),
    }
}
