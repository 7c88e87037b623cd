//! Claims and their verdicts.

/// A statement that is checked by numbers.
#[derive(Debug, Clone)]
pub(crate) struct Claim {
    /// The claim, in one line.
    pub statement: String,
    /// The measurement.
    pub measured: String,
    /// Whether the measurement supports the claim.
    pub holds: bool,
}

/// One table or figure: its claims, tables and pictures.
#[derive(Debug, Clone)]
pub(crate) struct Item {
    /// Key word, also the stem of its files.
    pub name: &'static str,
    /// Heading.
    pub title: &'static str,
    /// Description of the item, with background.
    pub note: &'static str,
    /// Claims.
    pub claims: Vec<Claim>,
    /// Pictures that were written, file names.
    pub pictures: Vec<String>,
    /// Tables in the page, each a header and rows.
    pub tables: Vec<Vec<Vec<String>>>,
    /// Commands that repeat the runs.
    pub commands: Vec<String>,
}

impl Item {
    /// An item without claims yet.
    pub(crate) fn new(name: &'static str, title: &'static str, note: &'static str) -> Self {
        let (claims, pictures, tables, commands) = Default::default();
        Item { name, title, note, claims, pictures, tables, commands }
    }

    /// Adds a claim with its measurement.
    pub(crate) fn claim(&mut self, statement: impl Into<String>, measured: impl Into<String>, holds: bool) {
        self.claims.push(Claim { statement: statement.into(), measured: measured.into(), holds });
    }
}
