//! Lines of a bulk data file and its includes.

use std::path::{Path, PathBuf};

use super::super::abaqus::At;
use super::super::includes::{Includes, included};
use super::super::{MeshError, Place, Result, without_mark};

/// Largest number of lines of a path between quotes.
const MAX_LINES_OF_A_PATH: usize = 20;

/// A file and its includes; `INCLUDE` stands in any section, also between a card and its continuation.
#[derive(Debug, Default)]
pub(super) struct Sources {
    pub(super) files: Vec<PathBuf>,
    texts: Vec<String>,
    lines: Vec<Span>,
    includes: Includes,
}

/// A line, as bytes of the text of its file.
#[derive(Debug)]
struct Span {
    at: At,
    start: usize,
    end: usize,
}

impl Sources {
    pub(super) fn read(file: &Path, bytes: &[u8]) -> Result<Self> {
        let mut sources = Sources::default();
        // The first file is never included yet.
        _ = sources.includes.open(file);
        sources.file(file, bytes)?;
        Ok(sources)
    }

    /// All lines in the order in which they are read, those of an include in its place.
    pub(super) fn lines(&self) -> impl Iterator<Item = (&str, At)> + Clone {
        self.lines.iter().map(|span| (&self.texts[span.at.file as usize][span.start..span.end], span.at))
    }

    pub(super) fn texts(&self) -> impl Iterator<Item = &str> {
        self.texts.iter().map(String::as_str)
    }

    fn file(&mut self, path: &Path, bytes: &[u8]) -> Result<()> {
        let file = self.files.len() as u32;
        self.files.push(path.to_path_buf());
        self.texts.push(String::new());
        let text = String::from_utf8_lossy(without_mark(bytes)).into_owned();
        let mut start = 0;
        let mut lines = text.split_inclusive('\n').zip(1..);
        while let Some((line, number)) = lines.next() {
            let at = At { file, line: number };
            let end = start + line.trim_end_matches(['\n', '\r']).len();
            let Some(mut path) = after_include(line).map(|rest| rest.trim().to_string()) else {
                self.lines.push(Span { at, start, end });
                start += line.len();
                continue;
            };
            start += line.len();
            for _ in 0..MAX_LINES_OF_A_PATH {
                if is_whole(&path) {
                    break;
                }
                let Some((line, _)) = lines.next() else { break };
                start += line.len();
                path += line.trim();
            }
            self.include(at, &path)?;
        }
        self.texts[file as usize] = text;
        Ok(())
    }

    fn include(&mut self, at: At, written: &str) -> Result<()> {
        let quote = written.chars().next().filter(|c| is_quote(*c));
        let name = match quote {
            Some(quote) => written[1..].split_once(quote).map(|(name, _)| name),
            None => written.split('$').next(),
        };
        let name = name.map(str::trim).filter(|name| !name.is_empty()).ok_or_else(|| {
            self.malformed(at, "INCLUDE without a path, or without its second quote".into(), "INCLUDE 'FILE'")
        })?;
        let path = included(&self.files, at.file, name);
        let opened = self.includes.open(&path);
        opened.map_err(|(problem, advice)| self.malformed(at, problem, advice))?;
        let bytes = crate::whole_file::read(&path).map_err(|reason| {
            let problem = format!("the file {} cannot be read: {reason}", path.display());
            self.malformed(at, problem, "paths of INCLUDE are relative to the file that includes")
        })?;
        self.file(&path, &bytes)?;
        self.includes.close();
        Ok(())
    }

    fn malformed(&self, at: At, problem: String, advice: &'static str) -> MeshError {
        let place = Place::line(&self.files[at.file as usize], at.line as usize);
        MeshError::Malformed { place, problem, advice }
    }
}

const fn is_quote(c: char) -> bool {
    matches!(c, '\'' | '"')
}

/// The rest of a line `INCLUDE ...`.
fn after_include(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let (word, rest) = (line.get(..7)?, line.get(7..)?);
    let is_end = rest.chars().next().is_none_or(|c| c.is_whitespace() || is_quote(c));
    (word.eq_ignore_ascii_case("INCLUDE") && is_end).then_some(rest)
}

/// Whether a path is complete: it is not empty, and its quotes are closed.
fn is_whole(path: &str) -> bool {
    match path.chars().next() {
        None => false,
        Some(quote) if is_quote(quote) => path[1..].contains(quote),
        Some(_) => true,
    }
}
