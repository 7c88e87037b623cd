//! Text of messages: control characters are escaped, and long text is shortened.

use std::borrow::Cow;
use std::fmt::Write;

/// Longest word of a message in characters; paths are words.
const MAX_WORD: usize = 400;

/// Longest message in characters.
const MAX_TEXT: usize = 4000;

/// A message for a terminal. Control characters other than line feeds and tabs are escaped. A word of more than 400
/// characters and text of more than 4000 keep only their beginning and end.
///
/// ```
/// use emmy_io::message::shown;
/// assert_eq!(shown("group \u{1b}[2J"), "group \\u{1b}[2J");
/// assert!(shown(&"x".repeat(100_000)).chars().count() <= 400);
/// ```
pub fn shown(text: &str) -> Cow<'_, str> {
    let is_short =
        text.len() <= MAX_TEXT && text.split(char::is_whitespace).all(|word| word.len() <= MAX_WORD);
    if is_short && !text.contains(is_escaped) {
        return Cow::Borrowed(text);
    }
    let escaped = escaped(text);
    let words: String =
        escaped.split_inclusive(char::is_whitespace).map(|word| cut(word, MAX_WORD)).collect();
    Cow::Owned(cut(&words, MAX_TEXT).into_owned())
}

/// Text with control characters, other than line feeds and tabs, escaped as `\u{1b}`.
pub fn escaped(text: &str) -> Cow<'_, str> {
    if !text.contains(is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    text.chars().for_each(|c| push_escaped(&mut shown, c));
    Cow::Owned(shown)
}

/// Adds a character to a text, escaped if it is a control character.
pub(crate) fn push_escaped(text: &mut String, c: char) {
    match is_escaped(c) {
        true => _ = write!(text, "\\u{{{:x}}}", c as u32),
        false => text.push(c),
    }
}

fn is_escaped(c: char) -> bool {
    c.is_control() && c != '\n' && c != '\t'
}

/// An error with its causes, each in a line.
pub fn with_causes(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(cause) => format!("{error}\ncause: {}", with_causes(cause)),
        None => error.to_string(),
    }
}

/// A name for XML 1.0, with `_` in place of characters that XML cannot hold: control characters other than tabs and
/// line ends, U+FFFE and U+FFFF (XML 1.0, production 2, `Char`).
pub(crate) fn name(text: &str) -> Cow<'_, str> {
    let is_forbidden = |c: char| matches!(c, '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}');
    match text.contains(is_forbidden) {
        true => Cow::Owned(text.replace(is_forbidden, "_")),
        false => Cow::Borrowed(text),
    }
}

/// A note on a name that [`name`] has changed.
pub(crate) fn note_on_name(text: &str) -> Option<String> {
    match name(text) {
        Cow::Borrowed(_) => None,
        Cow::Owned(read) => {
            Some(format!("the name \"{}\" has control characters: it is read as \"{read}\"", shown(text)))
        }
    }
}

/// The beginning and the end of a text that is too long: a half and a third of the allowed characters.
fn cut(text: &str, longest: usize) -> Cow<'_, str> {
    let n_chars = text.chars().count();
    if n_chars <= longest {
        return Cow::Borrowed(text);
    }
    let beginning: String = text.chars().take(longest / 2).collect();
    let end: String = text.chars().skip(n_chars - longest / 3).collect();
    Cow::Owned(format!("{beginning}…{end}"))
}

/// `1 node`, `2 nodes`.
///
/// ```
/// use emmy_io::message::counted;
/// assert_eq!([1, 2].map(|n| counted(n, "body", "bodies")), ["1 body", "2 bodies"]);
/// ```
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped() {
        assert_eq!(shown("a\u{1b}[2J\u{7}\u{9b}b\r\n\tc"), "a\\u{1b}[2J\\u{7}\\u{9b}b\\u{d}\n\tc");
        assert!(matches!(shown("plain — ∑\n"), Cow::Borrowed(_)));
    }

    #[test]
    fn long_words_are_cut_and_long_texts_of_short_words_are_not() {
        let text = format!("unknown key `{}` here", "k".repeat(100_000));
        let cut = shown(&text);
        assert!(cut.len() < 450 && cut.starts_with("unknown key `kkk") && cut.ends_with("k` here"), "{cut}");
        let words = "word ".repeat(700);
        assert_eq!(shown(&words), words);
        assert!(shown(&"word ".repeat(100_000)).chars().count() <= 4000);
    }

    #[test]
    fn names_hold_any_character_of_xml() {
        assert_eq!(name("a\u{1b}b\u{ffff}"), "a_b_");
        assert_eq!(name("Körper\t1\r\n"), "Körper\t1\r\n");
        assert_eq!(note_on_name("body"), None);
        let note = note_on_name("a\u{1b}b").unwrap();
        assert_eq!(note, "the name \"a\\u{1b}b\" has control characters: it is read as \"a_b\"");
    }
}
