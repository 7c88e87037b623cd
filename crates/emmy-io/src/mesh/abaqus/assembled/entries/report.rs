//! Notes on the cards that are left out, and remarks.

use super::super::super::super::entry::first_names;

/// The fates of the cards, in the order of the file.
#[derive(Debug, Default)]
pub(super) struct Report {
    left_out: Vec<LeftOut>,
    remarks: Vec<Remark>,
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

    /// A sentence for each reason and each remark.
    pub(super) fn notes(self) -> Vec<String> {
        let left_out = self.left_out.iter().map(|LeftOut { card, reason, which }| {
            let [are, they] = if which.len() == 1 { ["is", "it"] } else { ["are", "they"] };
            let count = which.len();
            let which = first_names(which);
            format!("{card}: {count} {are} left out, though {they} may change the motion: {which} ({reason})")
        });
        let remarks = self.remarks.iter().map(|Remark { card, text, which }| match which.is_empty() {
            true => format!("{card}: {text}"),
            false => format!("{card} {}: {text}", first_names(which)),
        });
        left_out.chain(remarks).collect()
    }
}
