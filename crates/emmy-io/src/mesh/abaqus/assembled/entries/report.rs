//! Notes on the cards that act and on those that are left out.

use crate::message::counted;

/// Names in a note at most.
const MAX_NAMES: usize = 10;

/// The fates of the cards, in the order of the file.
#[derive(Debug, Default)]
pub(super) struct Report {
    acting: Vec<Acting>,
    left_out: Vec<LeftOut>,
    remarks: Vec<Remark>,
}

#[derive(Debug)]
struct Acting {
    card: String,
    /// Words for one and for several: `rigid coupling acts`.
    words: [&'static str; 2],
    names: Vec<String>,
}

#[derive(Debug)]
struct LeftOut {
    card: String,
    reason: String,
    which: Vec<String>,
}

/// A remark on some cards.
#[derive(Debug)]
struct Remark {
    card: String,
    text: String,
    which: Vec<String>,
}

impl Report {
    /// Records an entry that acts.
    pub(super) fn act(&mut self, card: &str, words: [&'static str; 2], name: &str) {
        let known = self.acting.iter_mut().find(|acting| acting.card == card && acting.words == words);
        match known {
            Some(acting) => acting.names.push(name.to_string()),
            None => self.acting.push(Acting { card: card.to_string(), words, names: vec![name.to_string()] }),
        }
    }

    /// Records a card, or an element, that is left out, with the reason in a clause.
    pub(super) fn leave_out(&mut self, card: &str, reason: &str, which: String) {
        let known = self.left_out.iter_mut().find(|own| own.card == card && own.reason == reason);
        match known {
            Some(own) => own.which.push(which),
            None => {
                self.left_out.push(LeftOut {
                    card: card.to_string(),
                    reason: reason.to_string(),
                    which: vec![which],
                });
            }
        }
    }

    /// Records a remark on a card, or on all of its kind.
    pub(super) fn remark(&mut self, card: &str, which: Option<&str>, text: &str) {
        let which = which.map(str::to_string);
        match self.remarks.iter_mut().find(|own| own.card == card && own.text == text) {
            Some(own) => own.which.extend(which),
            None => {
                let which = which.into_iter().collect();
                self.remarks.push(Remark { card: card.to_string(), text: text.to_string(), which });
            }
        }
    }

    /// A sentence for each kind of what acts, each reason, and each remark.
    pub(super) fn notes(self) -> Vec<String> {
        let acting = self.acting.iter().map(|Acting { card, words: [one, many], names }| {
            let them = if names.len() == 1 { "it" } else { "them" };
            let count = counted(names.len(), one, many);
            format!("{card}: {count}: {} (mesh.leave_out switches {them} off)", listed(names))
        });
        let left_out = self.left_out.iter().map(|LeftOut { card, reason, which }| {
            let [are, they] = if which.len() == 1 { ["is", "it"] } else { ["are", "they"] };
            let count = which.len();
            let which = listed(which);
            format!("{card}: {count} {are} left out, though {they} may change the motion: {which} ({reason})")
        });
        let remarks = self.remarks.iter().map(|Remark { card, text, which }| match which.is_empty() {
            true => format!("{card}: {text}"),
            false => format!("{card} {}: {text}", listed(which)),
        });
        acting.chain(left_out).chain(remarks).collect()
    }
}

/// The first of some names.
pub(super) fn listed(names: &[String]) -> String {
    let first = names.iter().take(MAX_NAMES).map(String::as_str).collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MAX_NAMES) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}
