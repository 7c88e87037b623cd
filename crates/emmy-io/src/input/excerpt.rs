//! The display of a fault: its lines, cut to the neighbourhood of the marks.

use std::fmt;
use std::ops::Range;

use miette::{
    Diagnostic, LabeledSpan, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents,
};

use super::fault::{Fault, Place};
use crate::message::{push_escaped, shown};

/// Longest line that is shown whole, in bytes.
const MAX_LINE: usize = 200;

/// Bytes shown before and after the ends of a mark in a longer line.
const AROUND: usize = 50;

/// Most lines of one mark; only the first line of a longer mark is marked.
const MAX_LINES: usize = 10;

/// Lines shown before and after those with marks.
const CONTEXT: usize = 1;

/// A fault with the part of its source that is shown; control characters are escaped everywhere.
#[derive(Debug)]
pub struct Excerpt {
    message: String,
    help: Option<String>,
    /// Name of the source.
    name: String,
    /// Lines of the source: those near the marks, cut, and empty lines instead of the others, so that line numbers stay
    /// the same.
    text: String,
    labels: Vec<LabeledSpan>,
    /// Where marks begin in the text, and their columns in the source.
    columns: Vec<(usize, usize)>,
}

impl Fault {
    /// The fault with the relevant lines, ready to be shown.
    pub fn excerpt(&self) -> Excerpt {
        Excerpt::new(self)
    }
}

impl Excerpt {
    /// The excerpt that shows a fault.
    fn new(fault: &Fault) -> Self {
        if let Some(path) = fault.place().and_then(Place::path) {
            return Excerpt {
                message: shown(&format!("{path}: {}", fault.message())).into_owned(),
                help: fault.suggestion().or(fault.advice()).map(|help| shown(help).into_owned()),
                name: String::new(),
                text: String::new(),
                labels: Vec::new(),
                columns: Vec::new(),
            };
        }
        let marks: Vec<Range<usize>> = fault.labels().iter().map(|(place, _)| first_lines(place)).collect();
        let source = fault.place().map_or("", Place::text);
        let (text, moved) = cut(source, &marks);
        let label = |((_, label), span): (&(Place, String), &Range<usize>)| {
            LabeledSpan::new_with_span(Some(shown(label).into_owned()), (span.start, span.len()))
        };
        let before = |mark: &Range<usize>| &source.as_bytes()[..mark.start];
        let column =
            |mark: &Range<usize>| before(mark).rsplit(|&byte| byte == b'\n').next().map_or(0, <[u8]>::len);
        Excerpt {
            message: shown(fault.message()).into_owned(),
            help: fault.advice().map(|help| shown(help).into_owned()),
            name: shown(fault.place().map_or("", Place::source_name)).into_owned(),
            labels: fault.labels().iter().zip(&moved).map(label).collect(),
            columns: moved.iter().zip(&marks).map(|(moved, mark)| (moved.start, column(mark))).collect(),
            text,
        }
    }
}

/// The span of a place; only its first line if it has many.
fn first_lines(place: &Place) -> Range<usize> {
    let Range { start, end } = place.span();
    let marked = place.text().get(start..end).unwrap_or_default();
    match marked.match_indices('\n').nth(MAX_LINES) {
        Some(_) => start..start + marked.find('\n').unwrap_or(marked.len()),
        None => start..end,
    }
}

/// The text with cut lines, and where its marks are then.
fn cut(source: &str, marks: &[Range<usize>]) -> (String, Vec<Range<usize>>) {
    let mut text = String::new();
    let mut moved = vec![[usize::MAX; 2]; marks.len()];
    let line_of = |at: usize| source.as_bytes()[..at].iter().filter(|&&byte| byte == b'\n').count();
    let lines_of: Vec<[usize; 2]> = marks.iter().map(|mark| [mark.start, mark.end].map(line_of)).collect();
    let mut begin = 0;
    for (number, line) in source.split_inclusive('\n').enumerate() {
        let content = line.strip_suffix('\n').unwrap_or(line);
        if lines_of
            .iter()
            .any(|[first, last]| (*first..=last + CONTEXT).contains(&number) || number + CONTEXT == *first)
        {
            push_line(&mut text, content, begin, marks, &mut moved);
        }
        if line.ends_with('\n') {
            text.push('\n');
        }
        begin += line.len();
    }
    // A mark at the very end of the source is placed behind its last line.
    let moved = moved.into_iter().map(|[start, end]| {
        let start = start.min(text.len());
        start..end.clamp(start, text.len())
    });
    let moved = moved.collect();
    (text, moved)
}

/// Adds a line of the source that begins at an offset, and returns the new positions of the ends of marks in it.
fn push_line(text: &mut String, line: &str, begin: usize, marks: &[Range<usize>], moved: &mut [[usize; 2]]) {
    // The end of a line is a valid place in it.
    let within = |at: usize| (begin..=begin + line.len()).contains(&at);
    let ends: Vec<usize> = marks
        .iter()
        .flat_map(|mark| [mark.start, mark.end])
        .filter(|&at| within(at))
        .map(|at| at - begin)
        .collect();
    let near = |at: usize| ends.iter().any(|&end| at < end + AROUND && end < at + AROUND);
    let is_kept = |at: usize| line.len() <= MAX_LINE || near(at) || ends.is_empty() && at < MAX_LINE;
    let mut note = |at: usize, to: usize| {
        for (mark, moved) in marks.iter().zip(moved.iter_mut()) {
            for (end, moved) in [mark.start, mark.end].into_iter().zip(moved) {
                if end == at && *moved == usize::MAX {
                    *moved = to;
                }
            }
        }
    };
    let mut is_gap = false;
    for (at, c) in line.char_indices() {
        let kept = is_kept(at);
        if kept {
            note(begin + at, text.len());
            // A carriage return at the end belongs to the line feed.
            if c != '\r' || at + 1 < line.len() {
                push_escaped(text, c);
            }
        } else if !is_gap {
            text.push('…');
        }
        is_gap = !kept;
    }
    note(begin + line.len(), text.len());
}

impl fmt::Display for Excerpt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Excerpt {}

impl Diagnostic for Excerpt {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        (!self.labels.is_empty()).then_some(self as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        (!self.labels.is_empty())
            .then(|| Box::new(self.labels.iter().cloned()) as Box<dyn Iterator<Item = LabeledSpan>>)
    }
}

/// Columns refer to the source.
impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let contents = self.text.as_str().read_span(span, before, after)?;
        let mark = self.columns.iter().find(|(start, _)| before == 0 && *start == span.offset());
        let column = mark.map_or(contents.column(), |(_, column)| *column);
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            contents.data(),
            *contents.span(),
            contents.line(),
            column,
            contents.line_count(),
        )))
    }
}
