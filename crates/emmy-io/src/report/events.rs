//! Reads `events.csv`, with the columns `step,time,event,message`.

use std::io::Read;
use std::path::Path;

use serde_json::{Value, json};

use crate::whole_file;

/// Largest number of events of a page.
const MAX_EVENTS: usize = 1000;

/// Bytes of the file that are read.
const MAX_BYTES: u64 = 1_000_000;

/// The first events of a file, and an estimate of the number of others.
pub(super) fn read(path: &Path) -> (Vec<Value>, usize) {
    let mut bytes = Vec::new();
    let whole = whole_file::open(path).and_then(|file| {
        let length = file.metadata()?.len();
        file.take(MAX_BYTES).read_to_end(&mut bytes)?;
        Ok(length)
    });
    let mut events = events(&String::from_utf8_lossy(&bytes));
    let per_byte = events.len() as f64 / bytes.len().max(1) as f64;
    let all = (per_byte * whole.unwrap_or_default() as f64).round() as usize;
    events.truncate(MAX_EVENTS);
    let more = all.saturating_sub(events.len());
    (events, more)
}

/// Events in the text of the file; damaged and incomplete rows are left out.
fn events(text: &str) -> Vec<Value> {
    let mut records = records(text).into_iter();
    let head = records.next().unwrap_or_default();
    let column = |name: &str| head.iter().position(|column| column == name);
    let [Some(step), Some(time), Some(event)] = ["step", "time", "event"].map(column) else {
        return Vec::new();
    };
    let message = column("message");
    let row = |cells: Vec<String>| {
        let number: usize = cells.get(step)?.parse().ok()?;
        let time: f64 = cells.get(time)?.parse().ok()?;
        let message = message.and_then(|at| cells.get(at).cloned()).unwrap_or_default();
        Some(json!({ "step": number, "time": time, "event": cells.get(event)?, "message": message }))
    };
    records.filter_map(row).collect()
}

/// Records of comma-separated values; cells with commas, quotation marks or line ends are in quotation marks.
fn records(text: &str) -> Vec<Vec<String>> {
    let mut records = Vec::new();
    let mut record = Vec::new();
    let mut cell = String::new();
    let mut is_quoted = false;
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if is_quoted && letters.peek() == Some(&'"') => cell.extend(letters.next()),
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => record.push(std::mem::take(&mut cell)),
            '\r' if !is_quoted => {}
            '\n' if !is_quoted => {
                record.push(std::mem::take(&mut cell));
                records.push(std::mem::take(&mut record));
            }
            letter => cell.push(letter),
        }
    }
    records
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_may_hold_commas_and_quotation_marks() {
        let text = "step,time,event,message\n3,0.5,cut,\"step cut, \"\"no\"\" convergence\"\n4,1,release,plain\nx,1,a,b\n5,0.";
        assert_eq!(
            events(text),
            [
                json!({ "step": 3, "time": 0.5, "event": "cut", "message": "step cut, \"no\" convergence" }),
                json!({ "step": 4, "time": 1.0, "event": "release", "message": "plain" }),
            ]
        );
        assert!(events("").is_empty() && events("a,b\n1,2\n").is_empty());
    }
}
