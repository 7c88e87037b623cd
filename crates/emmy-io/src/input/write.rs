//! The tree as TOML text: the resolved input.

use std::fmt::Write;

use super::tree::{Entry, Node, Value};

/// Text of a tree. Numbers have as many digits as needed to read back the same value.
pub(super) fn toml(root: &Node) -> String {
    let mut text = String::new();
    let Value::Table(entries) = &root.value else { return text };
    for Entry { key, node, .. } in entries.iter().filter(|entry| !is_section(&entry.node)) {
        line(&mut text, key, node);
    }
    for Entry { key, node, .. } in entries {
        match &node.value {
            Value::Table(entries) => section(&mut text, &format!("[{}]", name(key)), entries),
            Value::Array(items) if is_section(node) => {
                for Node { value, .. } in items {
                    let Value::Table(entries) = value else { continue };
                    section(&mut text, &format!("[[{}]]", name(key)), entries);
                }
            }
            _ => {}
        }
    }
    text
}

/// Headers of the sections that describe a body.
const OF_BODY: [&str; 10] = [
    "[mesh]",
    "[[region]]",
    "[[mass]]",
    "[[support]]",
    "[[tie]]",
    "[[contact]]",
    "[[rigid]]",
    "[[coupling]]",
    "[[joint]]",
    "[[load]]",
];

/// The sections of a resolved input that describe the body, without those of its motion. A comment explains the names
/// of functions, which no file can hold.
///
/// ```
/// let resolved = "[mesh]\nfile = \"a.msh\"\n\n[[load]]\nhistory = \"<function hat>\"\n\n[time]\nscheme = \"DGM\"\n";
/// let body = emmy_io::input::body_sections(resolved);
/// assert!(body.starts_with("# ") && body.ends_with("[[load]]\nhistory = \"<function hat>\"\n"));
/// ```
pub fn body_sections(resolved: &str) -> String {
    let mut sections: Vec<String> = Vec::new();
    for part in resolved.split("\n\n") {
        match sections.last_mut() {
            // Inside a text of several lines.
            Some(last) if !part.starts_with('[') => *last += &format!("\n\n{part}"),
            _ => sections.push(part.to_string()),
        }
    }
    sections.retain(|section| OF_BODY.iter().any(|header| section.starts_with(header)));
    let text = format!("{}\n", sections.join("\n\n").trim_end());
    if text.contains("\"<function ") {
        return format!(
            "# `<function NAME>` stands for a function of a program, which no file can hold.\n\n{text}"
        );
    }
    text
}

/// Tables and lists of tables get a header of their own.
fn is_section(node: &Node) -> bool {
    let table = |node: &Node| matches!(node.value, Value::Table(_));
    table(node) || matches!(&node.value, Value::Array(items) if !items.is_empty() && items.iter().all(table))
}

fn section(text: &mut String, header: &str, entries: &[Entry]) {
    if !text.is_empty() {
        text.push('\n');
    }
    let _ = writeln!(text, "{header}");
    for Entry { key, node, .. } in entries {
        line(text, key, node);
    }
}

fn line(text: &mut String, key: &str, node: &Node) {
    let _ = writeln!(text, "{} = {}", name(key), inline(&node.value));
}

fn inline(value: &Value) -> String {
    match value {
        Value::String(text) => string(text),
        Value::Integer(value) => value.to_string(),
        Value::Float(value) => format!("{value:?}").to_lowercase(),
        Value::Boolean(value) => value.to_string(),
        Value::Datetime(value) => value.clone(),
        // `complete::spell` replaces these where a file must hold them.
        Value::Mesh(_) | Value::TimeFunction(_) | Value::Field(_) => string(&format!("<{}>", value.kind())),
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(|item| inline(&item.value)).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Table(entries) if entries.is_empty() => "{}".to_string(),
        Value::Table(entries) => {
            let entry = |entry: &Entry| format!("{} = {}", name(&entry.key), inline(&entry.node.value));
            format!("{{ {} }}", entries.iter().map(entry).collect::<Vec<_>>().join(", "))
        }
    }
}

fn string(text: &str) -> String {
    toml::Value::String(text.to_string()).to_string()
}

/// A key, quoted if TOML requires it.
fn name(key: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !key.is_empty() && key.chars().all(bare) { key.to_string() } else { string(key) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::tree::parse;

    #[test]
    fn written_inputs_read_back() {
        let text = "title = \"a \\\"b\\\" \\\\ c\"\n\n[mesh]\nbox = { size = [2, 8.5, 1e-300], cells = [1, 1, 1] }\n\n\
                    [[load]]\ngroup = \"x-min\"\n\n[[load]]\n\"odd key\" = [{ a = 0.1 }, 1e300]\n";
        let once = toml(&parse("test", text).unwrap());
        assert_eq!(toml(&parse("again", &once).unwrap()), once);
        assert!(once.contains("size = [2, 8.5, 1e-300]") && once.contains("[{ a = 0.1 }, 1e300]"), "{once}");
    }
}
