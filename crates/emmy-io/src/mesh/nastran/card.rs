//! Cards of bulk data: fields of 8 or 16 columns, or between commas, on one or more lines.

use std::borrow::Cow;
use std::collections::HashMap;

use super::super::abaqus::At;

/// Columns of the name, of a field and of a large field.
const NARROW: usize = 8;
const WIDE: usize = 16;

/// Fields of a line besides its name and the mark of its continuation.
const N_NARROW: usize = 8;
const N_WIDE: usize = 4;

/// A card with the fields after its name.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Card<'a> {
    /// The name in upper case, without `*` (large cells of meshio keep it).
    pub(super) name: String,
    pub(super) fields: Vec<Cow<'a, str>>,
    /// The first line.
    pub(super) at: At,
}

impl Card<'_> {
    /// A field, counted from 0 after the name; empty beyond the last one.
    pub(super) fn field(&self, index: usize) -> &str {
        self.fields.get(index).map_or("", |field| field)
    }

    /// The fields from an index on.
    pub(super) fn from(&self, index: usize) -> Vec<&str> {
        self.fields.iter().skip(index).map(|field| &**field).collect()
    }
}

/// The bulk data section.
#[derive(Debug, Default)]
pub(super) struct Bulk<'a> {
    pub(super) cards: Vec<Card<'a>>,
    /// Continuations that belong to no card: their number, and the first one.
    pub(super) stray: Option<(usize, At)>,
    /// Lines whose mark of a continuation no other line has.
    pub(super) open: Option<(usize, At)>,
    /// `ENDDATA`.
    pub(super) end: Option<At>,
    /// Lines after the end.
    pub(super) rest: Option<(usize, At)>,
}

pub(super) fn count(counted: &mut Option<(usize, At)>, at: At) {
    counted.get_or_insert((0, at)).0 += 1;
}

/// Lines of a card, or of continuations whose card is elsewhere; those have no name.
#[derive(Debug)]
struct Piece<'a> {
    name: String,
    /// Fields of each line, and their number in a full one.
    lines: Vec<(usize, Vec<Cow<'a, str>>)>,
    at: At,
    /// Mark of the first line, if it is a continuation.
    own: String,
    /// Mark of the last line.
    next: Mark,
}

#[derive(Debug)]
struct Mark {
    key: String,
    at: At,
    /// Whether it begins with `+` or `*`; sequence numbers do not.
    is_sure: bool,
}

impl<'a> Piece<'a> {
    fn new(name: String, own: String, line: Line<'a>, at: At) -> Self {
        Piece { name, at, own, next: mark(&line.mark, at), lines: vec![(line.width, line.fields)] }
    }

    /// Whether the last line has its last field.
    fn is_full(&self) -> bool {
        let last = |(width, fields): &(usize, Vec<Cow<'a, str>>)| fields.get(width - 1).cloned();
        self.lines.last().and_then(last).is_some_and(|field| !field.is_empty())
    }

    fn line(&mut self, line: Line<'a>, at: At) {
        self.append(Piece::new(String::new(), String::new(), line, at));
    }

    fn append(&mut self, more: Piece<'a>) {
        self.lines.extend(more.lines);
        self.next = more.next;
    }
}

/// The cards from `BEGIN BULK`, if there is one, up to `ENDDATA`, with their continuations. These are the next lines,
/// if they have no mark or the mark of the line before; otherwise the lines with its mark, anywhere. A line with a mark
/// also continues a full line without a mark.
pub(super) fn bulk<'a>(lines: impl Iterator<Item = (&'a str, At)> + Clone) -> Bulk<'a> {
    let lines = lines.map(|(line, at)| (without_comment(line), at));
    let start = lines.clone().position(|(line, _)| is_begin(line)).map_or(0, |index| index + 1);
    let mut bulk = Bulk::default();
    let mut pieces: Vec<Piece<'a>> = Vec::new();
    for (text, at) in lines.skip(start).filter(|(line, _)| !line.trim().is_empty() && !is_begin(line)) {
        if bulk.end.is_some() {
            count(&mut bulk.rest, at);
            continue;
        }
        let line = match is_section(text) {
            true => {
                Line { head: Cow::Owned(words(text)), fields: Vec::new(), mark: "".into(), width: N_NARROW }
            }
            false => split(text),
        };
        if line.head.is_empty() || line.head.starts_with(['+', '*']) {
            let own = key(&line.head);
            match pieces.last_mut() {
                Some(last) if own.is_empty() || own == last.next.key => last.line(line, at),
                None if own.is_empty() => count(&mut bulk.stray, at),
                _ => pieces.push(Piece::new(String::new(), own, line, at)),
            }
            continue;
        }
        let name = line.head.to_ascii_uppercase();
        // meshio has another order of nodes in large fields: a kind of its own, which is not read.
        let name = match name.as_str() {
            "CHEXA_*" | "CPENTA_*" => name,
            _ => name.trim_end_matches('*').trim_end().to_string(),
        };
        match name.as_str() {
            "ENDDATA" => bulk.end = Some(at),
            _ => pieces.push(Piece::new(name, String::new(), line, at)),
        }
    }
    bulk.cards = joined(pieces, &mut bulk.stray, &mut bulk.open);
    bulk
}

/// Cards with the continuations that stand elsewhere.
fn joined<'a>(
    pieces: Vec<Piece<'a>>,
    stray: &mut Option<(usize, At)>,
    open: &mut Option<(usize, At)>,
) -> Vec<Card<'a>> {
    let mut loose = HashMap::<String, Piece<'a>>::new();
    let mut cards: Vec<Piece<'a>> = Vec::new();
    // Continuations after a full line without a mark, which belong to it unless another card has their mark.
    let mut nearest = Vec::new();
    let mut is_after_unmarked = false;
    for piece in pieces {
        let is_unmarked = piece.next.key.is_empty() && piece.is_full();
        if !piece.name.is_empty() {
            cards.push(piece);
        } else if loose.contains_key(&piece.own) {
            count(stray, piece.at);
        } else {
            if is_after_unmarked {
                nearest.push((cards.len() - 1, piece.own.clone()));
            }
            loose.insert(piece.own.clone(), piece);
        }
        is_after_unmarked = is_unmarked && !cards.is_empty();
    }
    for card in &mut cards {
        // The continuation of a line is never without a mark here.
        while let Some(more) = loose.remove(&card.next.key) {
            card.append(more);
        }
    }
    for (card, own) in nearest {
        if let Some(more) = loose.remove(&own) {
            cards[card].append(more);
        }
    }
    let mut rest: Vec<At> = loose.into_values().map(|piece| piece.at).collect();
    rest.sort_unstable_by_key(|at| (at.file, at.line));
    rest.into_iter().for_each(|at| count(stray, at));
    for card in &cards {
        if card.next.is_sure {
            count(open, card.next.at);
        }
    }
    cards.into_iter().map(card).collect()
}

fn card(piece: Piece<'_>) -> Card<'_> {
    let Piece { name, lines, at, .. } = piece;
    let (mut fields, mut full) = (Vec::new(), 0_usize);
    for (width, line) in lines {
        // A line with a continuation counts as full.
        full = fields.len().max(full).next_multiple_of(width);
        fields.resize(full, Cow::Borrowed(""));
        fields.extend(line);
        full += width;
    }
    let length = fields.iter().rposition(|field| !field.is_empty()).map_or(0, |last| last + 1);
    fields.truncate(length);
    Card { name, fields, at }
}

fn without_comment(line: &str) -> &str {
    line.split('$').next().unwrap_or_default().trim_end()
}

fn is_begin(line: &str) -> bool {
    let mut words = line.split_whitespace();
    let mut is_next = |wanted: &str| words.next().is_some_and(|word| word.eq_ignore_ascii_case(wanted));
    is_next("BEGIN") && is_next("BULK") && words.next().is_none()
}

/// Whether another section begins, such as `BEGIN SUPER=2`; its name is longer than that of a card.
fn is_section(line: &str) -> bool {
    line.split_whitespace().next().is_some_and(|word| word.eq_ignore_ascii_case("BEGIN"))
}

fn words(line: &str) -> String {
    line.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A mark without its first `+` or `*`.
fn key(mark: &str) -> String {
    mark.trim_start_matches(['+', '*']).trim().to_ascii_uppercase()
}

/// A line of a card.
#[derive(Debug)]
struct Line<'a> {
    /// The name, or the mark of a continuation.
    head: Cow<'a, str>,
    fields: Vec<Cow<'a, str>>,
    /// Mark of its continuation.
    mark: Cow<'a, str>,
    /// Fields of a full line.
    width: usize,
}

fn mark(written: &str, at: At) -> Mark {
    let key = key(written);
    let is_sure = !key.is_empty() && written.starts_with(['+', '*']);
    Mark { key, at, is_sure }
}

fn split(line: &str) -> Line<'_> {
    if line.contains(',') {
        return free(line);
    }
    let line = match line.contains('\t') {
        true => Cow::Owned(expanded(line)),
        false => Cow::Borrowed(line),
    };
    let head = columns(&line, 0, NARROW);
    let is_wide = head.contains('*') && !head.starts_with('=');
    let (count, size) = if is_wide { (N_WIDE, WIDE) } else { (N_NARROW, NARROW) };
    let fields = (0..count).map(|index| columns(&line, NARROW + index * size, size)).collect();
    Line { fields, mark: columns(&line, NARROW + count * size, NARROW), head, width: count }
}

/// A line with fields between commas.
fn free(line: &str) -> Line<'_> {
    let mut fields = line.split(',').map(|field| Cow::Borrowed(field.trim()));
    let head = fields.next().unwrap_or_default();
    let width = if head.contains('*') && !head.starts_with('=') { N_WIDE } else { N_NARROW };
    let mut fields: Vec<Cow<'_, str>> = fields.collect();
    // The last field of a full line marks its continuation; a number there belongs to a longer line.
    let has_mark = fields.len() == width + 1
        && fields
            .last()
            .is_some_and(|field| real(field).is_none() || field.starts_with('+') || field.is_empty());
    let mark = if has_mark { fields.pop().unwrap_or_default() } else { Cow::Borrowed("") };
    Line { head, fields, mark, width }
}

/// A line with its tabs replaced by spaces, up to the next multiple of eight columns.
fn expanded(line: &str) -> String {
    let mut text = String::with_capacity(2 * line.len());
    for c in line.chars() {
        match c {
            '\t' => text.extend(std::iter::repeat_n(' ', NARROW - text.len() % NARROW)),
            c => text.push(c),
        }
    }
    text
}

/// Columns of a line without spaces around them. Cards have ASCII characters; a longer one spoils only its own field.
fn columns<'a>(line: &Cow<'a, str>, from: usize, count: usize) -> Cow<'a, str> {
    fn part(line: &str, from: usize, count: usize) -> &str {
        line.get(from..(from + count).min(line.len())).unwrap_or_default().trim()
    }
    match line {
        Cow::Borrowed(line) => Cow::Borrowed(part(line, from, count)),
        Cow::Owned(line) => Cow::Owned(part(line, from, count).to_string()),
    }
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

    /// Names, fields and lines of the cards in a text.
    fn cards(text: &str) -> Vec<(String, Vec<String>, u32)> {
        let cards = bulk_of(text).cards.into_iter();
        cards
            .map(|card| {
                (card.name.clone(), card.from(0).iter().map(|f| f.to_string()).collect(), card.at.line)
            })
            .collect()
    }

    fn bulk_of(text: &str) -> Bulk<'_> {
        bulk(
            text.lines()
                .zip(1..)
                .map(|(line, number)| (line, At { file: 0, line: number }))
                .collect::<Vec<_>>()
                .into_iter(),
        )
    }

    fn of(name: &str, fields: &[&str], line: u32) -> (String, Vec<String>, u32) {
        (name.to_string(), fields.iter().map(|field| field.to_string()).collect(), line)
    }

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
        let tabs = "GRID\t12\t\t1.5\t2.-3\n";
        for text in [short, long, free, free_wide, tabs] {
            assert_eq!(cards(text), [of("GRID", &["12", "", "1.5", "2.-3"], 1)], "{text}");
        }
        let full = "GRID\t1\t\t0.0000001.0000002.000000\n";
        assert_eq!(cards(full), [of("GRID", &["1", "", "0.000000", "1.000000", "2.000000"], 1)]);
    }

    #[test]
    fn continued_lines_are_joined() {
        let nodes: Vec<String> = (1..=10).map(|node| node.to_string()).collect();
        let head = "$ a comment, with a comma\nSOL 101\nCEND\nBEGIN BULK\n";
        let fields = [&["5", "3"], &nodes.iter().map(String::as_str).collect::<Vec<_>>()[..]].concat();
        for card in [
            "CTETRA  5       3       1       2       3       4       5       6       +E5\n+E5     7       8       9       10\nENDDATA\nGRID",
            "CTETRA  5       3       1       2       3       4       5       6\n        7       8       9       10      $ end",
            "CTETRA,5,3,1,2,3,4,5,6,+\n+,7,8,9,10",
            "CTETRA,5,3,1,2,3,4,5,6\n,7,8,9,10",
            "CTETRA* 5               3               1               2               *\n*       3               4               5               6\n        7       8       9       10",
            "CTETRA* 5               3               1               2               *\n*       3               4               5               6               *B\n*B      7               8               9               10",
            "CTETRA,5,3,1,2,3,4,5,6,7,8,9,10",
            "CTETRA,5,3,1,2,3,4,5,6,E5\n+E5,7,8,9,10",
            "CTETRA,5,3,1,2,3,4,5,6\n+E5,7,8,9,10",
        ] {
            assert_eq!(cards(&format!("{head}{card}\n")), [of("CTETRA", &fields, 5)], "{card}");
        }
        // Continuations before and after other cards, in another form, and with continuations of their own.
        let apart = "*E5,7,8\nCTETRA,5,3,1,2,3,4,5,6,+E5\nGRID,7\n";
        assert_eq!(cards(apart), [of("CTETRA", &fields[..10], 2), of("GRID", &["7"], 3)]);
        let far = format!("{:<8}{:<8}{:<8}{:<8}{:<40}+b", "+a", 3, 4, 5, 6);
        let chain = format!("CTETRA,5,3,1,2,,,,,+A\nGRID,7\n+B,7,8,9,10\n{far}\n");
        let blank = [""; 4];
        let joined =
            [&["5", "3", "1", "2"], &blank[..], &["3", "4", "5", "6"], &blank, &["7", "8", "9", "10"]];
        assert_eq!(cards(&chain), [of("CTETRA", &joined.concat(), 1), of("GRID", &["7"], 2)]);
        // A narrow line after the second half of a wide one, both elsewhere.
        let (first, second) = (format!("{:<72}*A", "CTETRA* 5               3"), format!("{:<72}+B", "*A"));
        let mixed = format!("{first}\nGRID,7\n{second}\n+B,9\n");
        let joined = [&["5", "3"], &[""; 6][..], &["9"]].concat();
        assert_eq!(cards(&mixed), [of("CTETRA", &joined, 1), of("GRID", &["7"], 2)]);
    }

    #[test]
    fn lines_that_belong_to_nothing_are_counted() {
        let text = "+,9\nGRID,1,,,,,,,,+A\nGRID,2,,,,,,,,7\n+X,1\nGRID,3\n+C,5\n+X,2\nENDDATA\nGRID,4\n$ end\n\nGRID,5\n";
        let bulk = bulk_of(text);
        let at = |line: u32| At { file: 0, line };
        // `+X` and `+C` follow lines without a mark, but these are not full.
        assert_eq!(bulk.cards.len(), 3);
        assert_eq!(bulk.cards[2].from(0), ["3"]);
        assert_eq!((bulk.stray, bulk.open), (Some((4, at(1))), Some((1, at(2)))));
        assert_eq!((bulk.end, bulk.rest), (Some(at(8)), Some((2, at(9)))));
        let whole = bulk_of("GRID,1\n");
        assert_eq!((whole.stray, whole.open, whole.end, whole.rest), (None, None, None, None));
    }

    #[test]
    fn odd_lines_do_no_harm() {
        let odd = "\u{e4}\u{f6}\u{fc}\u{e4}";
        assert_eq!(cards("+       1\n\u{e4}\u{f6}\u{fc}\u{e4}\u{f6}\n,\n"), [of(odd, &["\u{f6}"], 2)]);
        // A boundary of columns inside a character.
        assert_eq!(cards("a\u{e4}\u{f6}\u{fc}\u{e4}\u{f6}\n"), []);
    }
}
