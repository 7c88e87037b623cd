//! Faults of the input: reason, place, and something to try.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use miette::NamedSource;

use crate::message::shown;

/// A place in a source: in the input file, in a flag of the command line, or in a tree that a program has built.
#[derive(Debug, Clone)]
pub struct Place {
    source: Arc<NamedSource<String>>,
    span: Range<usize>,
    /// Whether the name of the source is the path of a value in a tree, which has no text.
    is_path: bool,
}

impl Place {
    /// The start of a new source.
    pub(super) fn start_of(name: &str, text: &str) -> Self {
        let source = Arc::new(NamedSource::new(name, text.to_string()));
        Place { source, span: 0..0, is_path: false }
    }

    /// A value in a tree, such as `load[1].group`.
    pub(super) fn of_path(path: &str) -> Self {
        Place { is_path: true, ..Place::start_of(path, "") }
    }

    /// The path, of a value in a tree.
    pub fn path(&self) -> Option<&str> {
        self.is_path.then(|| self.source_name())
    }

    /// Another place of the same source.
    pub(super) fn at(&self, span: Range<usize>) -> Self {
        let end = span.end.min(self.text().len());
        Place { span: span.start.min(end)..end, ..self.clone() }
    }

    /// A part of a quoted text at this place, by the bytes of the text; the whole place if the quotes contain anything
    /// else, such as escapes.
    pub(super) fn inside(&self, text: &str, part: Range<usize>) -> Self {
        let written = self.text().get(self.span.clone()).unwrap_or("");
        match written.find(text) {
            Some(offset) if offset <= 3 && written.len() <= text.len() + 6 => {
                let start = self.span.start + offset;
                self.at(start + part.start..start + part.end)
            }
            _ => self.clone(),
        }
    }

    /// Bytes of the source.
    pub(crate) fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Text of the source.
    pub(crate) fn text(&self) -> &str {
        self.source.inner()
    }

    /// Name of the source: the path of the file, or the flag.
    pub fn source_name(&self) -> &str {
        self.source.name()
    }

    /// Line of the place, from 1.
    pub fn line(&self) -> usize {
        self.before().iter().filter(|&&byte| byte == b'\n').count() + 1
    }

    /// Column of the place in characters, from 1.
    pub fn column(&self) -> usize {
        let before = self.before();
        let line = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
        String::from_utf8_lossy(&before[line..]).chars().count() + 1
    }

    fn before(&self) -> &[u8] {
        &self.text().as_bytes()[..self.span.start]
    }

    fn is_whole_source(&self) -> bool {
        !self.is_path && self.span.is_empty() && self.span.start == 0
    }

    /// Identifies a place: its copies have the same number.
    pub(super) fn id(&self) -> (*const NamedSource<String>, usize) {
        (Arc::as_ptr(&self.source), self.span.start)
    }

    /// Whether both can be marked in one excerpt.
    fn same_source(&self, other: &Place) -> bool {
        self.is_path && other.is_path || Arc::ptr_eq(&self.source, &other.source)
    }
}

/// One fault of the input.
#[derive(Debug, Clone)]
pub struct Fault {
    message: String,
    labels: Vec<(Place, String)>,
    help: Option<String>,
    missing_group: Option<MissingGroup>,
}

/// A group that the mesh does not have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingGroup {
    /// Its name.
    pub name: String,
    /// Group names that would be valid here.
    pub available: Vec<String>,
}

impl Fault {
    /// A fault without a place.
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Fault { message: message.into(), labels: Vec::new(), help: None, missing_group: None }
    }

    /// The same fault, caused by a missing group.
    pub(super) fn of_group(self, name: &str, available: &[&str]) -> Self {
        let available = available.iter().map(|name| name.to_string()).collect();
        Fault { missing_group: Some(MissingGroup { name: name.to_string(), available }), ..self }
    }

    /// The group that is missing, if that is the fault.
    pub fn missing_group(&self) -> Option<&MissingGroup> {
        self.missing_group.as_ref()
    }

    /// A fault at a place.
    pub(super) fn at(place: &Place, message: impl Into<String>, label: impl Into<String>) -> Self {
        Fault::new(message).label(place, label)
    }

    /// The same fault with another label; a place that is the whole source becomes part of the message.
    pub(super) fn label(mut self, place: &Place, label: impl Into<String>) -> Self {
        if place.is_whole_source() {
            self.message = format!("{}: {}", place.source_name(), self.message);
        } else if self.labels.first().is_none_or(|(first, _)| first.same_source(place)) {
            self.labels.push((place.clone(), label.into()));
        }
        self
    }

    /// The same fault with advice.
    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// The same fault with words before its message.
    pub(crate) fn before(mut self, words: &str) -> Self {
        self.message.insert_str(0, words);
        self
    }

    /// Reason.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Place, if there is exactly one.
    pub fn place(&self) -> Option<&Place> {
        self.labels.first().map(|(place, _)| place)
    }

    /// The places with their labels.
    pub(super) fn labels(&self) -> &[(Place, String)] {
        &self.labels
    }

    /// Advice.
    pub fn advice(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// The word that was probably meant, if the words at the place say so.
    pub fn suggestion(&self) -> Option<&str> {
        let mut words = self.labels.iter().map(|(_, words)| words.as_str());
        words.find(|words| words.starts_with("did you mean"))
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Fault {}

/// All faults of an input, in the order of the file.
#[derive(Debug, Clone)]
pub struct InputError {
    faults: Vec<Fault>,
}

impl InputError {
    /// Success without faults.
    pub(crate) fn unless_empty(faults: Vec<Fault>) -> Result<(), Self> {
        if faults.is_empty() { Ok(()) } else { Err(InputError { faults }) }
    }

    /// The same faults; the last has the notes on the mesh, which may explain them.
    pub(super) fn with_notes(mut self, notes: &[String]) -> Self {
        if let Some(last) = self.faults.last_mut().filter(|_| !notes.is_empty()) {
            let notes = format!("notes on the mesh: {}", notes.join("; "));
            last.help = Some(last.help.take().map_or(notes.clone(), |help| format!("{help}; {notes}")));
        }
        self
    }

    /// The faults; at least one.
    pub fn faults(&self) -> &[Fault] {
        &self.faults
    }
}

impl From<Fault> for InputError {
    fn from(fault: Fault) -> Self {
        InputError { faults: vec![fault] }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, fault) in self.faults.iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            if let Some(path) = fault.place().and_then(Place::path) {
                write!(f, "{}: ", shown(path))?;
            } else if let Some(place) = fault.place() {
                write!(f, "{}:{}:{}: ", shown(place.source_name()), place.line(), place.column())?;
            }
            f.write_str(&shown(fault.message()))?;
        }
        Ok(())
    }
}

impl std::error::Error for InputError {}

/// Limit on the number of faults: nobody reads more, and the search for similar words takes time.
const MANY: usize = 100;

/// Faults collected so that one reading shows all of them.
#[derive(Debug, Default)]
pub(super) struct Faults {
    faults: Vec<Fault>,
}

impl Faults {
    /// The value, or `None` after storing the fault.
    pub(super) fn keep<T>(&mut self, result: Result<T, Fault>) -> Option<T> {
        result.map_err(|fault| self.faults.push(fault)).ok()
    }

    pub(super) fn push(&mut self, fault: Fault) {
        self.faults.push(fault);
    }

    /// Adds other faults, up to the limit.
    pub(super) fn append(&mut self, other: Faults) {
        self.faults.extend(other.faults.into_iter().take(MANY.saturating_sub(self.faults.len())));
    }

    /// Leaves only the first fault if all say the same.
    pub(super) fn join_alike(&mut self) {
        if self.faults.windows(2).all(|pair| pair[0].message == pair[1].message) {
            self.faults.truncate(1);
        }
    }

    /// Adds advice to the last fault.
    pub(super) fn advise_last(&mut self, advice: Option<String>) {
        if let (Some(last), Some(advice)) = (self.faults.last_mut(), advice) {
            last.help = Some(advice);
        }
    }

    /// Number of faults.
    pub(super) fn len(&self) -> usize {
        self.faults.len()
    }

    /// Whether the limit on the number of faults is reached.
    pub(super) fn are_many(&self) -> bool {
        self.faults.len() >= MANY
    }

    /// Fails if there was any fault.
    pub(super) fn finish(&mut self) -> Result<(), InputError> {
        if self.faults.is_empty() { Ok(()) } else { Err(self.error()) }
    }

    /// The faults in the order of the file.
    pub(super) fn error(&mut self) -> InputError {
        let mut faults = std::mem::take(&mut self.faults);
        let of_text = |fault: &Fault| fault.place().filter(|place| !place.is_path).cloned();
        faults.sort_by_cached_key(|fault| {
            of_text(fault).map(|place| (place.source_name().to_string(), place.span.start))
        });
        InputError { faults }
    }
}
