//! Advice on text that is not TOML, for common mistakes.

/// Advice, from the message of the parser, the line of the fault and the beginning of the text.
pub(super) fn advice(message: &str, text: &str, at: usize) -> Option<&'static str> {
    of_a_message(message).or_else(|| of_a_text(text, at))
}

fn of_a_message(message: &str) -> Option<&'static str> {
    match message {
        "duplicate key" => Some(
            "it is given already: remove one of the two; several regions, loads and so on are written [[region]], [[load]]",
        ),
        _ if message.starts_with("missing comma between array elements") => {
            Some("or the `]` of the list is missing before this")
        }
        _ => None,
    }
}

fn of_a_text(text: &str, at: usize) -> Option<&'static str> {
    let text_before = text.get(..at)?;
    let start = text_before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = text.get(start..)?.lines().next().unwrap_or_default().trim();
    of_another_format(text.trim_start()).or_else(|| match line.split_once('=') {
        Some((key, value)) => of_a_value(key, value.trim()),
        None if line.contains(':') => {
            Some("a value is given as `key = value`, a section begins with [section]")
        }
        None => None,
    })
}

fn of_another_format(text: &str) -> Option<&'static str> {
    match text.chars().next()? {
        '$' | '*' | '<' => Some(
            "this looks like a mesh; the input is a TOML file of its own, which names it: [mesh] file = \"...\"",
        ),
        '{' => Some("this looks like JSON; the input is TOML: `emmy new l-block` writes an example"),
        _ => None,
    }
}

fn of_a_value(key: &str, value: &str) -> Option<&'static str> {
    let Some(first) = value.chars().next() else { return Some("a value is missing behind the `=`") };
    let digits = value.trim_start_matches(['+', '-']);
    let after_digits = digits.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.' || c == '_');
    let is_number = digits.starts_with(|c: char| c.is_ascii_digit());
    match after_digits.trim_start().chars().next() {
        _ if format!("{key}{value}").contains(['“', '”', '„', '‘', '’', '«', '»']) => {
            Some("write straight quotes, \"...\" or '...'")
        }
        _ if first == '"' && value.contains('\\') => Some(
            "in \"...\" a backslash begins an escape: write paths with /, or in single quotes: 'C:\\part.msh'",
        ),
        _ if first == '(' => Some("a list is written in square brackets: [1.0, 2.0, 3.0]"),
        _ if first.is_alphabetic() => Some("a text is written in quotes, such as scheme = \"DGM\""),
        _ if digits.starts_with('.') || is_number && value.ends_with('.') => {
            Some("a number has digits on both sides of its point: 0.5, 2.0")
        }
        Some(',') if is_number => Some("a number has a point, not a comma: 2.5"),
        Some('*' | '/' | '^' | '+' | '-') if is_number => {
            Some("write the number out, such as 0.5 or 2e3; only histories are expressions, in quotes")
        }
        Some(c) if is_number && (c.is_alphabetic() || c == '%' || c == '[') => {
            Some("give the number alone: units are any consistent set, such as m, kg, s, and are not written")
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slip_is_recognised() {
        for (line, part) in [
            ("density = 2,5", "not a comma"),
            ("density = 7850 kg/m3", "units"),
            ("density = 7850kg", "units"),
            ("density = 1/2", "write the number out"),
            ("density = 2*10^3", "write the number out"),
            ("density = .5", "both sides"),
            ("density = 5.", "both sides"),
            ("scheme = DGM", "in quotes"),
            ("kind = “auto”", "straight quotes"),
            ("file = \"C:\\meshes\"", "backslash"),
            ("traction = (0, 0, 1)", "square brackets"),
            ("degree: 1", "`key = value`"),
        ] {
            let text = format!("# first\n{line}\nnext = 1\n");
            let found = of_a_text(&text, 10).unwrap_or_default();
            assert!(found.contains(part), "{line}: {found}");
        }
        assert_eq!(of_a_text("a = 1\nb = [1, 2\n", 8), None);
        assert!(of_a_text("*Node\n1, 0\n", 0).unwrap().contains("looks like a mesh"));
    }
}
