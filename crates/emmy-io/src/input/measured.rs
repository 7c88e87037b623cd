//! `history = { file = "pulse.csv", time = "t", value = "force" }`: a table from a CSV file.

use std::fs;
use std::path::Path;

use csv::{ByteRecord, Reader, ReaderBuilder};
use emmy::body::TimeFunction;
use emmy::internals::number::short;

use super::context::Context;
use super::description::{Described, Kind, NUMBER, POSITIVE, Section};
use super::fault::Fault;
use super::record;
use super::shape::neighbour;
use super::suggest::{did_you_mean, listed};
use super::table::{Item, Read, Table};
use crate::whole_file;

/// A history from a file.
pub(super) static MEASURED: Described = Described::new(|| {
    Section::new("a history from a file", "A table from two columns of a CSV file")
        .must(
            "file",
            Kind::Text,
            "",
            "The CSV file, its path relative to the input file; its first line names the columns",
        )
        .must("time", Kind::Text, "", "Name of the column of times, which must not decrease")
        .must("value", Kind::Text, "", "Name of the column of values")
        .may("factor", NUMBER, "", "Factor on the values")
        .absent("1")
        .may(
            "low_pass",
            POSITIVE,
            "1/time",
            "Frequency of a low-pass filter without phase, at which half of the amplitude is left",
        )
        .absent("no filter")
        .may(
            "correct_baseline",
            Kind::True,
            "",
            "Of an acceleration: adds the parabola over time that makes the mean square of the velocity least",
        )
        .absent("not corrected")
});

/// Velocity at the end of a record that is no drift, as a part of its largest.
const LASTING: f64 = 0.7;

/// Largest file in bytes: some 30 million rows.
const MAX_BYTES: u64 = 1 << 30;

/// Reads the table; its corrections add notes.
pub(super) fn read(table: &Table<'_>, context: Context<'_>) -> Result<TimeFunction, Fault> {
    let file: Item<'_> = table.must("file");
    let columns = [table.must("time"), table.must("value")];
    let path = context.directory.join(table.must::<&str>("file"));
    let bytes = bytes(&file, &path)?;
    let source = Source { path: &path, bytes: &bytes, table, columns };
    let mut entries = source.entries(table.may("factor").unwrap_or(1.0))?;
    let name = table.must::<&str>("file");
    if let Some(item) = table.item("low_pass") {
        let (before, frequency) = (entries.clone(), f64::read(item));
        record::low_pass(&mut entries, frequency).map_err(|(row, reason)| {
            item.fault(format!("{}: row {}: {reason}", path.display(), row + 1), "no filter")
        })?;
        let change = record::change(&before, &entries);
        context
            .note(format!("{name}: filtered at {}: {change}", context.units.number(frequency, "frequency")));
    }
    let failed = |error: emmy::Error| file.fault(error.to_string(), "from here");
    if let Some(item) = table.item("correct_baseline") {
        let before = entries.clone();
        record::correct_baseline(&mut entries)
            .map_err(|reason| item.fault(format!("{}: {reason}", path.display()), "too short"))?;
        let [v0, u0, largest] = record::drift(&before).map_err(failed)?;
        let [v1, u1, _] = record::drift(&entries).map_err(failed)?;
        let change = record::change(&before, &entries);
        let [velocities, displacements] =
            [([v0, v1], "length/time"), ([u0, u1], "length")].map(|(ends, dimension)| {
                let [before, after] = ends.map(|end| context.units.number(end, dimension));
                format!("{before} to {after}")
            });
        context.note(format!(
            "{name}: corrected baseline: {change}; at the end of the record, the velocity changes from {velocities}, the \
             displacement from {displacements}"
        ));
        if v0.abs() > LASTING * largest {
            context.note(format!(
                "{name}: without correction, the record ends near its largest velocity, as an impact or a fall does: then \
                 it should not be corrected"
            ));
        }
    }
    TimeFunction::measured(entries).map_err(failed)
}

fn bytes(item: &Item<'_>, path: &Path) -> Result<Vec<u8>, Fault> {
    let fault = |reason: String| item.fault(format!("{}: {reason}", path.display()), "from here");
    if fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() > MAX_BYTES) {
        return Err(fault("the file has more than 1 GB".into())
            .help("leave rows out: the table is linear between rows"));
    }
    let bytes = whole_file::read(path).map_err(|error| {
        let fault = item.fault(format!("cannot read {}: {error}", path.display()), "from here");
        match neighbour(path) {
            Some(name) => fault.help(format!("did you mean `{name}`?")),
            None => fault.help("a path is relative to the input file; `--set` can give another one: --set load.0.history.file=PATH"),
        }
    })?;
    match &bytes[..] {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => {
            Err(fault("the file is UTF-16 text".into()).help("save it as UTF-8"))
        }
        [b'P', b'K', 3, 4, ..] => {
            Err(fault("the file is a spreadsheet or an archive".into()).help("save the table as CSV"))
        }
        other if other.contains(&0) => {
            Err(fault("the file is not a text file".into()).help("save the table as CSV"))
        }
        _ => Ok(bytes),
    }
}

/// A file with the names of its two columns.
struct Source<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    table: &'a Table<'a>,
    /// Items with the names of the columns of times and values.
    columns: [Item<'a>; 2],
}

impl Source<'_> {
    /// Times and values, these times a factor.
    fn entries(&self, factor: f64) -> Result<Vec<(f64, f64)>, Fault> {
        let mut reader = reader(self.bytes);
        let mut row = ByteRecord::new();
        let header = reader.byte_headers().cloned().map_err(|error| self.fault(&row, &error.to_string()))?;
        let columns = [self.column(&header, &self.columns[0])?, self.column(&header, &self.columns[1])?];
        let mut entries: Vec<(f64, f64)> = Vec::with_capacity(self.bytes.len() / 16);
        while reader.read_byte_record(&mut row).map_err(|error| self.fault(&row, &error.to_string()))? {
            let [time, value] = self.numbers(&header, &row, columns)?;
            if let Some(&(before, _)) = entries.last().filter(|(before, _)| time < *before) {
                let [time, before] = [time, before].map(short);
                let reason = format!("the time {time} lies before {before}, the time of the row above");
                return Err(self.fault_of(0, &row, &reason).help("sort the rows by time"));
            }
            entries.push((time, self.finite(1, &row, factor * value)?));
        }
        match entries.len() {
            count @ (0 | 1) => {
                let reason = format!("a table needs two rows below the names of its columns, not {count}");
                Err(self.fault(&ByteRecord::new(), &reason))
            }
            _ => Ok(entries),
        }
    }

    /// Index of a column by its name.
    fn column(&self, header: &ByteRecord, item: &Item<'_>) -> Result<usize, Fault> {
        let wanted = item.text().unwrap_or_default().trim();
        let names: Vec<_> = header.iter().map(String::from_utf8_lossy).collect();
        let mut found = (0..names.len()).filter(|&i| names[i] == wanted);
        let path = self.path.display();
        match (found.next(), found.next()) {
            (Some(column), None) => Ok(column),
            (Some(_), Some(_)) => {
                Err(item.fault(format!("{path}: two columns are named `{wanted}`"), "not unique"))
            }
            (None, _) => {
                let all = || names.iter().map(AsRef::as_ref);
                let label = did_you_mean(wanted, all()).unwrap_or_else(|| "not a column".to_string());
                let message = format!("{path}: there is no column `{wanted}`; there is {}", listed(all()));
                let is_unnamed = all().all(|name: &str| name.parse::<f64>().is_ok());
                let fault = item.fault(message, label);
                Err(if is_unnamed { fault.help("the first line must name the columns") } else { fault })
            }
        }
    }

    /// The numbers of a row in two columns.
    fn numbers(&self, header: &ByteRecord, row: &ByteRecord, columns: [usize; 2]) -> Result<[f64; 2], Fault> {
        if row.iter().skip(header.len()).any(|field| !field.is_empty()) {
            let reason = format!("{} columns, but {} names of columns", row.len(), header.len());
            let help = "a comma separates columns: write numbers with a decimal point";
            return Err(self.fault(row, &reason).help(help));
        }
        let mut numbers = [0.0; 2];
        for (which, column) in columns.into_iter().enumerate() {
            let field = row.get(column).unwrap_or_default();
            let number = str::from_utf8(field).ok().and_then(|text| text.parse().ok());
            let number = number.ok_or_else(|| self.not_a_number(which, row, field))?;
            numbers[which] = self.finite(which, row, number)?;
        }
        Ok(numbers)
    }

    fn finite(&self, which: usize, row: &ByteRecord, number: f64) -> Result<f64, Fault> {
        match number.is_finite() {
            true => Ok(number),
            false => Err(self.fault_of(which, row, &format!("{number} is not a finite number"))),
        }
    }

    fn not_a_number(&self, which: usize, row: &ByteRecord, field: &[u8]) -> Fault {
        let text = String::from_utf8_lossy(field);
        if text.is_empty() {
            return self.fault_of(which, row, "there is no number");
        }
        let fault = self.fault_of(which, row, &format!("`{text}` is not a number"));
        match text.replacen(',', ".", 1).parse::<f64>() {
            Ok(_) => fault.help("a decimal comma: write numbers with a decimal point"),
            Err(_) => {
                fault.help("rows below the first line hold numbers; a line that begins with `#` is a comment")
            }
        }
    }

    /// A fault in a row.
    fn fault(&self, row: &ByteRecord, reason: &str) -> Fault {
        let message = format!("{}:{}: {reason}", self.path.display(), self.line(row));
        Fault::at(self.table.place, message, "from here")
    }

    /// A fault in a row and the column of times (0) or values (1).
    fn fault_of(&self, which: usize, row: &ByteRecord, reason: &str) -> Fault {
        let item = &self.columns[which];
        let name = item.text().unwrap_or_default().trim();
        let message = format!("{}:{}: column `{name}`: {reason}", self.path.display(), self.line(row));
        item.fault(message, "from here")
    }

    /// Number of the line of a row. The reader counts empty lines and comments before it to the row.
    fn line(&self, row: &ByteRecord) -> usize {
        let start = row.position().map_or(0, |position| position.byte() as usize).min(self.bytes.len());
        let (before, rest) = self.bytes.split_at(start);
        let is_left_out = |line: &&[u8]| is_empty_or_comment(line);
        let left_out = rest.split(|&byte| byte == b'\n').take_while(is_left_out).count();
        1 + before.iter().filter(|&&byte| byte == b'\n').count() + left_out
    }
}

fn is_empty_or_comment(line: &[u8]) -> bool {
    line.trim_ascii().is_empty() || line.starts_with(b"#")
}

/// Reader of a text whose first line decides on the separator: semicolon, tab or comma.
fn reader(bytes: &[u8]) -> Reader<&[u8]> {
    let mut lines = bytes.split(|&byte| byte == b'\n');
    let head = lines.find(|line| !is_empty_or_comment(line)).unwrap_or_default();
    let separator = [b';', b'\t'].into_iter().find(|&byte| is_outside_quotes(head, byte)).unwrap_or(b',');
    ReaderBuilder::new()
        .delimiter(separator)
        .comment(Some(b'#'))
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(bytes)
}

fn is_outside_quotes(line: &[u8], wanted: u8) -> bool {
    let mut is_quoted = false;
    line.iter().any(|&byte| {
        is_quoted ^= byte == b'"';
        byte == wanted && !is_quoted
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::history::tests::read_in;

    fn read(text: &[u8]) -> Result<Vec<(f64, f64)>, String> {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.csv"), text).unwrap();
        let history = "{ file = \"a.csv\", time = \"t\", value = \"F [N]\", factor = 2 }";
        read_in(folder.path(), history).map(|table| table.entries().to_vec())
    }

    #[test]
    fn every_common_dialect_is_read() {
        let rows = [(0.0, 2.0), (0.5, -4e-3), (0.5, 6.0)];
        for text in [
            "t,F [N]\n0,1\n0.5,-2e-3\n.5,+3.0\n",
            "\u{feff}t,F [N]\r\n0,1\r\n0.5,-2e-3\r\n.5,3",
            "# from the lab\n\n\"F [N]\" ; note; t\n1;a;0\n-2E-3;;5e-1\n# second pulse\n3;;0.5\n",
            " t \tF [N]\t\n0\t1\t\n0.5\t-0.002\t\n0.5\t 3 \t\n",
            "\"t\",\"F [N]\",\"a;b\"\n0,1,x\n\n0.5,-2e-3\n0.5,3,\"y\n\"\n",
        ] {
            assert_eq!(read(text.as_bytes()).unwrap(), rows, "{text:?}");
        }
    }

    #[test]
    fn faults_name_line_and_column() {
        let cases: [(&[u8], &str); 13] = [
            (b"t,F [N]\n0,1\n\n# more\n1,x\n", "a.csv:5: column `F [N]`: `x` is not a number"),
            (b"t,F [N]\n0,1\n1,nan\n", "a.csv:3: column `F [N]`: NaN is not a finite number"),
            (b"t,F [N]\n0,1\n1,1e308\n", "a.csv:3: column `F [N]`: inf is not a finite number"),
            (b"t,F [N]\n0,1\n1\n", "a.csv:3: column `F [N]`: there is no number"),
            (b"t,F [N]\n0.3,1\n0.2,2\n", "a.csv:3: column `t`: the time 0.2 lies before 0.3"),
            (b"t,F [N]\n0.3,1\n", "a.csv:1: a table needs two rows below the names of its columns, not 1"),
            (b"t;F [N]\n0;1\n1;0,5\n", "a.csv:3: column `F [N]`: `0,5` is not a number"),
            (b"t,F [N]\n0,0,0,5\n", "a.csv:2: 4 columns, but 2 names of columns"),
            (b"t,F [N],t\n0,1,2\n", "a.csv: two columns are named `t`"),
            (b"0,1\n1,2\n", "a.csv: there is no column `t`; there is `0`, `1`"),
            (b"", "a.csv: there is no column `t`; there is none"),
            (b"\xff\xfet\0", "a.csv: the file is UTF-16 text"),
            (b"PK\x03\x04...", "a.csv: the file is a spreadsheet"),
        ];
        for (text, message) in cases {
            let error = read(text).unwrap_err();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn files_that_are_too_large_are_not_read() {
        let folder = tempfile::tempdir().unwrap();
        fs::File::create(folder.path().join("a.csv")).unwrap().set_len(MAX_BYTES + 1).unwrap();
        let error = read_in(folder.path(), "{ file = \"a.csv\", time = \"t\", value = \"F\" }").unwrap_err();
        assert!(error.contains("more than 1 GB"), "{error}");
    }
}
