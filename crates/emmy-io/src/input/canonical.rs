//! Words and keys that an input may write in several ways, in the one spelling of the descriptions. Names of groups,
//! probes and files are left as they are.

use super::description::{Kind, Rule, Section, for_each_value};
use super::synonyms;
use super::tree::{Entry, Node, Value};

/// Writes the words of a value of this kind, and the keys that choose models, shapes and the like, as the descriptions
/// have them: upper and lower case make no difference there. Short names of keys become the long ones.
pub(super) fn spell(node: &mut Node, kind: &'static Kind) {
    for_each_value(node, kind, &mut |node, kind| match (kind, &mut node.value) {
        (Kind::Word(_, words, _), Value::String(text)) => {
            if let Some(word) = words.iter().find(|word| word.eq_ignore_ascii_case(text)) {
                *text = word.to_string();
            }
        }
        (_, Value::Table(entries)) => {
            kind.section().into_iter().for_each(|section| spell_keys(entries, section))
        }
        _ => {}
    });
}

fn spell_keys(entries: &mut [Entry], section: &Section) {
    let choice = match section.rule {
        Rule::ExactlyOne(_) => section.choice(),
        // Upper and lower case tell other keys apart: `K` is a bulk modulus, `k` a stiffness.
        _ => Vec::new(),
    };
    for key in section.names() {
        if entries.iter().any(|entry| entry.key == key) {
            continue;
        }
        let is_meant = |own: &str| {
            synonyms::accepted(key).any(|word| word == own)
                || choice.contains(&key) && own.eq_ignore_ascii_case(key)
        };
        let meant = entries.iter_mut().find(|entry| is_meant(&entry.key));
        meant.into_iter().for_each(|entry| entry.key = key.to_string());
    }
}
