//! Fields of the cards that are kept, and reasons why one is left out.

use std::borrow::Cow;

use super::super::super::abaqus::At;
use super::super::card::real;
use super::super::range;
use super::super::shown;
use super::grids::Grids;

/// A card with the fields after its name.
#[derive(Debug)]
pub(super) struct Stored {
    pub(super) name: &'static str,
    pub(super) fields: Vec<String>,
    pub(super) at: At,
}

/// Why a card is left out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reason {
    pub(super) text: Cow<'static, str>,
    /// Whether the card is not as it must be: its place is of use.
    pub(super) is_fault: bool,
}

impl Reason {
    pub(super) fn new(text: impl Into<Cow<'static, str>>) -> Self {
        Reason { text: text.into(), is_fault: false }
    }

    pub(super) fn fault(text: impl Into<Cow<'static, str>>) -> Self {
        Reason { text: text.into(), is_fault: true }
    }
}

pub(super) type Outcome<T> = Result<T, Reason>;

impl Stored {
    /// A field, counted from 0 after the name; empty beyond the last one.
    pub(super) fn field(&self, index: usize) -> &str {
        self.fields.get(index).map_or("", String::as_str)
    }

    pub(super) fn number(&self, index: usize) -> Outcome<u64> {
        number(self.field(index))
    }

    /// A real number; zero for a blank field.
    pub(super) fn real(&self, index: usize) -> Outcome<f64> {
        let field = self.field(index);
        let value = real(field).filter(|value| value.is_finite());
        value.ok_or_else(|| Reason::fault(format!("\"{}\" is not a number", shown(field))))
    }

    /// Its number, as a property or an element; the line of a card without one.
    pub(super) fn label(&self) -> String {
        match self.number(0) {
            Ok(number) => number.to_string(),
            Err(_) => format!("line {}", self.at.line),
        }
    }

    /// Components such as `123`, in ascending order.
    pub(super) fn components(&self, index: usize) -> Outcome<Components> {
        components(self.field(index))
    }

    /// Whether it acts itself; properties and lists of sets do not.
    pub(super) fn is_element(&self) -> bool {
        !matches!(self.name, "PMASS" | "PELAS" | "PDAMP" | "PBUSH" | "MPCADD")
    }
}

pub(super) fn number(field: &str) -> Outcome<u64> {
    field.parse().map_err(|_| Reason::fault(format!("\"{}\" is not a whole number", shown(field))))
}

/// Components of a motion: three translations, three rotations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Components([bool; 6]);

impl Components {
    pub(super) fn has_translations(self) -> bool {
        self.0[..3] == [true; 3]
    }

    pub(super) fn has_rotations(self) -> bool {
        self.0[3..] == [true; 3]
    }

    pub(super) fn has_some_rotation(self) -> bool {
        self.0[3..].contains(&true)
    }
}

pub(super) fn components(field: &str) -> Outcome<Components> {
    let mut all = [false; 6];
    for c in field.bytes() {
        match c {
            b'1'..=b'6' => all[usize::from(c - b'1')] = true,
            b'0' | b' ' => {}
            _ => return Err(Reason::fault(format!("\"{}\" are not components 1 to 6", shown(field)))),
        }
    }
    Ok(Components(all))
}

/// The known grid points of a list with ranges, each once, in the order of the file. A number beside the ranges must be
/// known; words and numbers with a point are others.
pub(super) fn grid_points<'a>(fields: &[&'a str], grids: &Grids<'_>) -> Outcome<(Vec<u64>, Vec<&'a str>)> {
    let (ranges, others) = range::ranges(fields);
    let mut all = Vec::new();
    for range in ranges {
        if range.first == range.last {
            grids.known(range.first)?;
            all.push(range.first);
        } else {
            all.extend(grids.within(&range));
        }
    }
    all.sort_unstable_by_key(|&grid| grids.index(grid));
    all.dedup();
    Ok((all, others))
}
