//! Cards of bulk data: fields of 8 or 16 columns, or between commas, on one or more lines.

/// Columns of the name, of a field and of a large field.
const NARROW: usize = 8;
const WIDE: usize = 16;

/// Fields of a line besides its name and the mark of its continuation.
const N_NARROW: usize = 8;
const N_WIDE: usize = 4;

/// A card with the fields after its name.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Card<'a> {
    /// The name in upper case, without `*`.
    pub(super) name: String,
    pub(super) fields: Vec<&'a str>,
    /// Number of the first line.
    pub(super) line: u32,
}

impl<'a> Card<'a> {
    /// A field, counted from 0 after the name; one that is not there is empty.
    pub(super) fn field(&self, index: usize) -> &'a str {
        self.fields.get(index).copied().unwrap_or_default()
    }
}

/// The cards of a text, from `BEGIN BULK`, if it is there, up to `ENDDATA`.
pub(super) fn cards(text: &str) -> Vec<Card<'_>> {
    let lines = || text.lines().zip(1..).map(|(line, number)| (without_comment(line), number));
    let start = lines().find(|(line, _)| is_begin(line)).map_or(0, |(_, number)| number);
    let mut cards: Vec<Card<'_>> = Vec::new();
    for (line, number) in lines().skip(start as usize).filter(|(line, _)| !line.is_empty()) {
        let (head, fields, width) = split(line);
        if head.is_empty() || head.starts_with(['+', '*']) {
            // A continuation without a card belongs to nothing.
            let Some(card) = cards.last_mut() else { continue };
            card.fields.resize(card.fields.len().next_multiple_of(width), "");
            card.fields.extend(fields);
            continue;
        }
        let name = head.trim_end_matches('*').trim_end().to_ascii_uppercase();
        if name == "ENDDATA" {
            break;
        }
        cards.push(Card { name, fields, line: number });
    }
    for card in &mut cards {
        let length = card.fields.iter().rposition(|field| !field.is_empty()).map_or(0, |last| last + 1);
        card.fields.truncate(length);
    }
    cards
}

fn without_comment(line: &str) -> &str {
    line.split('$').next().unwrap_or_default().trim_end()
}

fn is_begin(line: &str) -> bool {
    let mut words = line.split_whitespace();
    let is_word =
        |word: Option<&str>, wanted: &str| word.is_some_and(|word| word.eq_ignore_ascii_case(wanted));
    is_word(words.next(), "BEGIN") && is_word(words.next(), "BULK")
}

/// Name, fields and number of fields of a full line.
fn split(line: &str) -> (&str, Vec<&str>, usize) {
    if line.contains([',', '\t']) {
        let mut fields = line.split([',', '\t']).map(str::trim);
        let head = fields.next().unwrap_or_default();
        let width = if head.contains('*') { N_WIDE } else { N_NARROW };
        let mut fields: Vec<&str> = fields.collect();
        // The last field of a full line marks its continuation.
        if fields.len() == width + 1 {
            fields.pop();
        }
        return (head, fields, width);
    }
    let head = columns(line, 0, NARROW);
    let (count, size) = if head.contains('*') { (N_WIDE, WIDE) } else { (N_NARROW, NARROW) };
    let field = |index: usize| columns(line, NARROW + index * size, size);
    (head, (0..count).map(field).collect(), count)
}

/// Columns of a line without spaces around them. Cards have ASCII characters; a longer one spoils only its own field.
fn columns(line: &str, from: usize, count: usize) -> &str {
    let end = (from + count).min(line.len());
    line.get(from..end).unwrap_or_default().trim()
}

/// A real number; the exponent may lack its letter, as in `1.5-3`, and an empty field is zero.
pub(super) fn real(field: &str) -> Option<f64> {
    if field.is_empty() {
        return Some(0.0);
    }
    let is_exponent = |(index, c): &(usize, char)| {
        matches!(c, '+' | '-')
            && field.as_bytes()[..*index].last().is_some_and(|c| c.is_ascii_digit() || *c == b'.')
    };
    match field.char_indices().find(is_exponent) {
        Some((index, _)) => format!("{}e{}", &field[..index], &field[index..]).parse().ok(),
        None => field.replace(['d', 'D'], "e").parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_may_lack_the_letter_of_the_exponent() {
        for (field, value) in [
            ("1.5-3", 1.5e-3),
            ("1.+2", 100.0),
            ("-7.0+1", -70.0),
            ("7.0E+1", 70.0),
            ("-.7D-2", -7e-3),
            ("+2", 2.0),
            ("", 0.0),
        ] {
            assert_eq!(real(field), Some(value), "{field}");
        }
        assert!(["1.5-", "a", "1 2", "-", "1.-2-3"].iter().all(|field| real(field).is_none()));
    }

    #[test]
    fn every_form_of_a_card_has_the_same_fields() {
        let short = "GRID    12              1.5     2.-3            \n";
        let long = "GRID*   12                              1.5             2.-3            *A\n*A                      \n";
        let free = "grid,12,,1.5,2.-3\n";
        let free_wide = "GRID*,12,,1.5,2.-3,*1\n*1,\n";
        for text in [short, long, free, free_wide] {
            let card = Card { name: "GRID".into(), fields: vec!["12", "", "1.5", "2.-3"], line: 1 };
            assert_eq!(cards(text), [card], "{text}");
        }
    }

    #[test]
    fn continued_lines_are_joined() {
        let nodes: Vec<String> = (1..=10).map(|node| node.to_string()).collect();
        let head = "$ a comment, with a comma\nSOL 101\nCEND\nBEGIN BULK\n";
        for card in [
            "CTETRA  5       3       1       2       3       4       5       6       +E5\n+E5     7       8       9       10\nENDDATA\nGRID",
            "CTETRA  5       3       1       2       3       4       5       6\n        7       8       9       10      $ end",
            "CTETRA,5,3,1,2,3,4,5,6,+\n+,7,8,9,10",
            "CTETRA,5,3,1,2,3,4,5,6\n,7,8,9,10",
            "CTETRA* 5               3               1               2               *\n*       3               4               5               6\n        7       8       9       10",
            "CTETRA,5,3,1,2,3,4,5,6,7,8,9,10",
        ] {
            let text = format!("{head}{card}\n");
            let cards = cards(&text);
            assert_eq!((cards.len(), cards[0].line, cards[0].name.as_str()), (1, 5, "CTETRA"), "{card}");
            assert_eq!(
                cards[0].fields,
                [&["5", "3"], &nodes.iter().map(String::as_str).collect::<Vec<_>>()[..]].concat()
            );
        }
    }

    #[test]
    fn odd_lines_do_no_harm() {
        let card = Card { name: "\u{e4}\u{f6}\u{fc}\u{e4}".into(), fields: vec!["\u{f6}"], line: 2 };
        assert_eq!(cards("+       1\n\u{e4}\u{f6}\u{fc}\u{e4}\u{f6}\n,\n"), [card]);
        // A boundary of columns inside a character.
        assert_eq!(cards("a\u{e4}\u{f6}\u{fc}\u{e4}\u{f6}\n"), []);
    }
}
