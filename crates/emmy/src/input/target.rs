//! Loads, supports and joints that functions of time drive, in messages.

use std::fmt;

use super::time_function::NotFinite;
use crate::error::Error;

/// The load, the support or the joint that a function of time drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SignalTarget {
    /// A load, by its number.
    Load(usize),
    /// A driven support, by its number among all supports.
    Support(usize),
    /// A joint with a given motion or a motor, by its number.
    Joint(usize),
}

impl fmt::Display for SignalTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SignalTarget::Load(number) => write!(f, "load {number}"),
            SignalTarget::Support(number) => write!(f, "moving support {number}"),
            SignalTarget::Joint(number) => write!(f, "joint {number}"),
        }
    }
}

/// Largest length of a text in a message.
const LONGEST: usize = 60;

impl SignalTarget {
    /// The load, support or joint with the text of its function, which may be empty.
    pub(crate) fn with_text(self, text: &str) -> String {
        if text.is_empty() {
            return self.to_string();
        }
        let shown: String = text.chars().take(LONGEST).collect();
        let dots = if shown.len() < text.len() { "..." } else { "" };
        format!("{self} (\"{shown}{dots}\")")
    }

    /// The error of a function that is not a finite number.
    pub(crate) fn not_finite(self, text: &str, NotFinite { time, value }: NotFinite) -> Error {
        Error::NotFiniteAt { what: self.with_text(text), time, value }
    }
}
