//! Cards that repeat the card above with increments.

use std::borrow::Cow;

use super::card::{Card, real};

/// Largest number of copies of a file; a line could request very many.
pub(super) const MAX_COPIES: usize = 1_000_000;

/// Number of further copies that a card `=n` or `=(n)` requests, with the increments of the last repetition.
pub(super) fn copies(card: &Card<'_>) -> Option<usize> {
    let count = card.name.strip_prefix('=')?;
    inner(count).parse().ok()
}

/// Whether a card repeats the fields of one above: its name is `=`, or it has the name of that card, and `=`, `==` or
/// `*n` among its fields.
pub(super) fn repeats(card: &Card<'_>, above: Option<&Card<'_>>) -> bool {
    let has_sign = || card.fields.iter().any(|field| field.starts_with(['=', '*']));
    card.name.starts_with('=') || above.is_some_and(|above| above.name == card.name) && has_sign()
}

/// A card like the one above, except for its own fields: `=` the same field, `==` all further ones, `*n` and `*(n)` the
/// field plus n. `Err`: the field that cannot be incremented.
pub(super) fn repeated<'a>(above: &Card<'a>, card: &Card<'a>) -> Result<Card<'a>, String> {
    let mut fields = Vec::with_capacity(above.fields.len());
    for (index, field) in card.fields.iter().enumerate() {
        let old = || above.fields.get(index).cloned().unwrap_or_default();
        match (&**field, field.strip_prefix('*')) {
            ("==", _) => {
                fields.extend(above.fields.iter().skip(index).cloned());
                break;
            }
            ("=", _) => fields.push(old()),
            (_, Some(step)) => {
                let sum = incremented(&old(), inner(step));
                fields.push(Cow::Owned(sum.ok_or_else(|| format!("{} by {field}", old()))?));
            }
            _ => fields.push(field.clone()),
        }
    }
    Ok(Card { name: above.name.clone(), fields, at: card.at })
}

/// A number without its brackets.
fn inner(text: &str) -> &str {
    text.trim().trim_start_matches('(').trim_end_matches(')').trim()
}

/// The sum of two whole or real numbers; an empty field is zero.
fn incremented(field: &str, step: &str) -> Option<String> {
    let whole = |text: &str| if text.is_empty() { Some(0) } else { text.parse::<i64>().ok() };
    match (whole(field), whole(step)) {
        (Some(field), Some(step)) => Some(field.checked_add(step)?.to_string()),
        _ => Some(format!("{:?}", real(field)? + real(step)?)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn card<'a>(name: &str, fields: &[&'a str]) -> Card<'a> {
        let at = super::super::At { file: 0, line: 1 };
        Card { name: name.into(), fields: fields.iter().map(|field| Cow::Borrowed(*field)).collect(), at }
    }

    #[test]
    fn fields_are_kept_or_incremented() {
        let above = card("GRID", &["101", "17", "1.0", "10.5", "", "17", "3456"]);
        let next = repeated(&above, &card("=", &["*1", "=", "*(0.25)", "=="])).unwrap();
        assert_eq!(next, card("GRID", &["102", "17", "1.25", "10.5", "", "17", "3456"]));
        let down = repeated(&next, &card("=", &["*-2", "", "*(-1)", "7.", "*1.5-1"])).unwrap();
        assert_eq!(down, card("GRID", &["100", "", "0.25", "7.", "0.15"]));
        let error = repeated(&card("GRID", &["x"]), &card("=", &["*1"])).unwrap_err();
        assert_eq!(error, "x by *1");
    }

    #[test]
    fn counts_stand_in_the_first_field() {
        let counts = ["=3", "=(3)", "= 3", "=", "==", "GRID"].map(|name| copies(&card(name, &[])));
        assert_eq!(counts, [Some(3), Some(3), Some(3), None, None, None]);
        let grid = card("GRID", &["1"]);
        assert!(repeats(&card("=", &[]), None) && repeats(&card("GRID", &["*1"]), Some(&grid)));
        assert!(!repeats(&card("GRID", &["*1"]), None) && !repeats(&card("GRID", &["2"]), Some(&grid)));
    }
}
