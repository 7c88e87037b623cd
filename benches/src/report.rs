//! Output: Markdown tables, and goals with their verdicts.

use std::fmt::Write;

/// The result of an item.
#[derive(Debug, Clone)]
pub(crate) struct Report {
    /// Heading.
    pub title: &'static str,
    /// Description of the measurements.
    pub note: String,
    /// Tables.
    pub tables: Vec<Table>,
    /// Goals.
    pub goals: Vec<Goal>,
}

impl Report {
    /// A report without tables yet.
    pub(crate) fn new(title: &'static str, note: impl Into<String>) -> Self {
        Report { title, note: note.into(), tables: Vec::new(), goals: Vec::new() }
    }

    /// The report as Markdown; goals are judged or only named.
    pub(crate) fn markdown(&self, judge: bool) -> String {
        let mut text = format!("## {}\n\n{}\n", self.title, self.note);
        self.tables.iter().for_each(|table| text += &format!("\n{}", table.markdown()));
        if !self.goals.is_empty() {
            text.push('\n');
        }
        self.goals.iter().for_each(|goal| text += &goal.line(judge));
        text
    }
}

/// A table with a heading; all columns but the first few hold numbers.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    texts: usize,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table; the first columns, `texts` of them, are aligned to the left.
    pub(crate) fn new(texts: usize, heading: &[&str]) -> Self {
        Table { texts, rows: vec![heading.iter().map(|word| word.to_string()).collect()] }
    }

    /// An empty table with a given heading.
    pub(crate) fn with_heading(texts: usize, heading: Vec<String>) -> Self {
        Table { texts, rows: vec![heading] }
    }

    /// Adds a row.
    pub(crate) fn push(&mut self, row: Vec<String>) {
        self.rows.push(row);
    }

    /// The table, aligned.
    fn markdown(&self) -> String {
        let columns = 0..self.rows[0].len();
        let width =
            |column: usize| self.rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0).max(3);
        let widths: Vec<usize> = columns.map(width).collect();
        let mut text = String::new();
        for (index, row) in self.rows.iter().enumerate() {
            self.line(&mut text, row, &widths);
            if index == 0 {
                self.rule(&mut text, &widths);
            }
        }
        text
    }

    // Writing to a string cannot fail.
    fn line(&self, text: &mut String, row: &[String], widths: &[usize]) {
        for (column, (cell, width)) in row.iter().zip(widths).enumerate() {
            let _ = match column < self.texts {
                true => write!(text, "| {cell:<width$} "),
                false => write!(text, "| {cell:>width$} "),
            };
        }
        text.push_str("|\n");
    }

    fn rule(&self, text: &mut String, widths: &[usize]) {
        for (column, width) in widths.iter().enumerate() {
            let dashes = "-".repeat(width + 1);
            let _ = match column < self.texts {
                true => write!(text, "|{dashes}-"),
                false => write!(text, "|{dashes}:"),
            };
        }
        text.push_str("|\n");
    }
}

/// A limit for a measured number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Limit {
    /// The number must be at least this.
    AtLeast(f64),
    /// The number must be at most this.
    AtMost(f64),
}

/// A goal with its measurement.
#[derive(Debug, Clone)]
pub(crate) struct Goal {
    statement: String,
    limit: Limit,
    measured: f64,
    is_time: bool,
}

impl Goal {
    /// A goal about time or memory: judged only by a full run.
    pub(crate) fn new(statement: impl Into<String>, limit: Limit, measured: f64) -> Self {
        Goal { statement: statement.into(), limit, measured, is_time: true }
    }

    /// A goal that must hold on every machine.
    pub(crate) fn always(statement: impl Into<String>, limit: Limit, measured: f64) -> Self {
        Goal { is_time: false, ..Goal::new(statement, limit, measured) }
    }

    /// Whether the measured number is within the limit.
    pub(crate) fn holds(&self) -> bool {
        match self.limit {
            Limit::AtLeast(limit) => self.measured >= limit,
            Limit::AtMost(limit) => self.measured <= limit,
        }
    }

    fn line(&self, judge: bool) -> String {
        let word = match (judge || !self.is_time, self.holds()) {
            (false, _) => "not judged",
            (true, true) => "holds",
            (true, false) => "does not hold",
        };
        let limit = match self.limit {
            Limit::AtLeast(limit) => format!("at least {limit}"),
            Limit::AtMost(limit) => format!("at most {limit}"),
        };
        format!("- **{word}**: {}, {limit} (measured {})\n", self.statement, number(self.measured))
    }
}

/// A number with three significant digits, or with all digits before the point.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let decimals = 2 - value.abs().log10().floor() as i32;
    if decimals > 6 {
        return format!("{value:.2e}");
    }
    grouped(&format!("{value:.*}", decimals.max(0) as usize))
}

/// A number that may be missing.
pub(crate) fn number_or_dash(value: Option<f64>) -> String {
    value.map_or("-".into(), number)
}

/// A whole number with commas.
pub(crate) fn count(value: usize) -> String {
    grouped(&value.to_string())
}

/// Digits with a comma before every third one of the whole part.
fn grouped(digits: &str) -> String {
    let (sign, digits) = digits.split_at(usize::from(digits.starts_with('-')));
    let whole = digits.find('.').unwrap_or(digits.len());
    let mut text = sign.to_string();
    for (index, digit) in digits.char_indices() {
        if 0 < index && index < whole && (whole - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let expected = [(0.00345678, "0.00346"), (2.0, "2.00"), (85_557.4, "85,557"), (1.2e-9, "1.20e-9")];
        for (value, text) in expected {
            assert_eq!(number(value), text);
        }
        assert_eq!((count(1_505_427), count(117)), ("1,505,427".into(), "117".into()));
        assert_eq!((number(-123_456.0), number(-1.5)), ("-123,456".into(), "-1.50".into()));
    }

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new(1, &["name", "x"]);
        table.push(vec!["a".into(), "1.5".into()]);
        assert_eq!(table.markdown(), "| name |   x |\n|------|----:|\n| a    | 1.5 |\n");
    }

    #[test]
    fn goals_are_judged_by_their_limit() {
        let goal = Goal::new("a ratio", Limit::AtMost(1.15), 1.2);
        assert!(!goal.holds() && goal.line(true).starts_with("- **does not hold**"));
        assert!(goal.line(false).starts_with("- **not judged**"));
        assert!(Goal::new("a ratio", Limit::AtLeast(5.0), 5.1).line(true).starts_with("- **holds**"));
        assert!(!Goal::new("no number", Limit::AtMost(1.0), f64::NAN).holds());
    }
}
