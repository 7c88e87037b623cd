//! Claims of the paper and their verdicts.

/// A statement that is checked by numbers.
#[derive(Debug, Clone)]
pub struct Claim {
    /// What is claimed, in one line.
    pub statement: String,
    /// What was measured.
    pub measured: String,
    /// Whether the measurement bears it out.
    pub holds: bool,
}

impl Claim {
    /// A claim with its measurement.
    pub fn new(statement: impl Into<String>, measured: impl Into<String>, holds: bool) -> Self {
        Claim { statement: statement.into(), measured: measured.into(), holds }
    }
}

/// One table or figure: its claims and its pictures.
#[derive(Debug, Clone)]
pub struct Item {
    /// Key word, also the stem of its files.
    pub name: &'static str,
    /// Heading.
    pub title: &'static str,
    /// What the paper shows there, and what was lost of it.
    pub note: &'static str,
    /// Claims.
    pub claims: Vec<Claim>,
    /// Pictures that were written, file names.
    pub pictures: Vec<String>,
    /// A table in the page: header and rows.
    pub table: Vec<Vec<String>>,
}

impl Item {
    /// An item without claims yet.
    pub fn new(name: &'static str, title: &'static str, note: &'static str) -> Self {
        Item { name, title, note, claims: Vec::new(), pictures: Vec::new(), table: Vec::new() }
    }
}
