//! `--json`: one object for each step on standard output, with the columns of the history as names.

use std::time::Instant;

use emmy::motion::{Observer, View};
use emmy_io::history::{HistoryColumns, Number};
use emmy_io::input::Problem;
use serde_json::{Map, Value};

use crate::host::Host;
use crate::print;

/// Prints every step, if switched on.
#[derive(Debug)]
pub(super) struct JsonLines<'h> {
    host: &'h dyn Host,
    on: bool,
    columns: HistoryColumns,
    names: Vec<String>,
    started: Instant,
}

impl<'h> JsonLines<'h> {
    /// The observer; the clock starts here.
    pub(super) fn new(host: &'h dyn Host, on: bool, problem: &Problem) -> Self {
        let columns = HistoryColumns::of(problem);
        JsonLines { host, on, names: columns.names(), columns, started: Instant::now() }
    }
}

impl Observer for JsonLines<'_> {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        if !self.on {
            return Ok(());
        }
        let row = self.columns.row(view, self.started.elapsed().as_secs_f64());
        let value = |number: &Number| match *number {
            Number::Whole(value) => Value::from(value),
            Number::Real(value) => Value::from(value),
            Number::Limit(limit) => Value::from(limit.name()),
            Number::Missing => Value::Null,
        };
        let numbers = row.numbers.iter().map(value);
        let object: Map<String, Value> = self.names.iter().cloned().zip(numbers).collect();
        print::result(self.host, &format!("{}\n", Value::Object(object)))
            .map_err(|failure| failure.message().into())
    }
}
