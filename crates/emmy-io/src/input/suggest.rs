//! The nearest word to an unknown one.

/// Smallest length of a word that may be the beginning of another.
const SHORTEST_BEGINNING: usize = 3;

/// Largest number of words in a message.
const MAX_WORDS: usize = 60;

/// The nearest of the known words, if one is similar enough; else the first that begins with the word.
pub(crate) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let plain = plain(word);
    let distance = |known: &&str| strsim::damerau_levenshtein(&plain, &self::plain(known));
    let length = plain.chars().count();
    // A single letter is similar to any other.
    let allowed = (length / 3).max(1).min(length.saturating_sub(1));
    let known: Vec<&str> = known.into_iter().collect();
    // Of equally near words one with all letters: `tim` and `tiem` are `time` rather than `tie`.
    let lacks_letters = |word: &&str| !has_letters(&self::plain(word), &plain);
    let near = known.iter().map(|word| (distance(word), lacks_letters(word), *word));
    let near = near.filter(|(distance, ..)| *distance <= allowed).min();
    let begins = |word: &&&str| length >= SHORTEST_BEGINNING && self::plain(word).starts_with(&plain);
    near.map(|(.., word)| word).or_else(|| known.iter().find(begins).copied())
}

/// Whether a word has all letters of another one.
fn has_letters(word: &str, other: &str) -> bool {
    let count = |text: &str, letter: char| text.chars().filter(|own| *own == letter).count();
    other.chars().all(|letter| count(word, letter) >= count(other, letter))
}

/// "did you mean ...?", or nothing.
pub(crate) fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest(word, known).map(|word| format!("did you mean `{word}`?"))
}

/// Words in one line, each in back-quotes; only the first of very many.
pub(super) fn listed<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let mut words = words.into_iter();
    let first: Vec<String> = words.by_ref().take(MAX_WORDS).map(|word| format!("`{word}`")).collect();
    match (first.is_empty(), words.count()) {
        (true, _) => "none".to_string(),
        (false, 0) => first.join(", "),
        (false, more) => format!("{} and {more} more", first.join(", ")),
    }
}

/// Case, hyphens and underscores make no difference.
fn plain(word: &str) -> String {
    word.to_lowercase().replace(['_', ' '], "-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_words_are_found_and_far_ones_left_alone() {
        assert_eq!(nearest("densty", ["group", "density"]), Some("density"));
        assert_eq!(nearest("Neo_Hooke", ["saint-venant-kirchhoff", "neo-hooke"]), Some("neo-hooke"));
        assert_eq!(nearest("banana", ["group", "density"]), None);
        assert_eq!(nearest("w", ["x", "y", "z"]), None);
        assert_eq!(nearest("X", ["x", "y", "z"]), Some("x"));
        assert_eq!(nearest("mv", ["lambda", "mu"]), Some("mu"));
    }

    #[test]
    fn the_beginning_of_a_word_is_near() {
        assert_eq!(nearest("youngs", ["lambda", "mu", "youngs_modulus"]), Some("youngs_modulus"));
        assert_eq!(nearest("Poissons", ["youngs_modulus", "poissons_ratio"]), Some("poissons_ratio"));
        assert_eq!(nearest("po", ["youngs_modulus", "poissons_ratio"]), None);
        assert_eq!(nearest("density", ["densities", "density_of_cells"]), Some("density_of_cells"));
    }

    #[test]
    fn of_equally_near_words_the_likelier_is_meant() {
        for word in ["tim", "tiem", "tme"] {
            assert_eq!(nearest(word, ["tie", "time"]), Some("time"), "{word}");
        }
        assert_eq!(nearest("ties", ["tie", "time"]), Some("tie"));
        assert_eq!(nearest("sine", ["sinh", "sin"]), Some("sin"));
    }

    #[test]
    fn lists_have_an_end() {
        let names: Vec<String> = (0..1000).map(|i| format!("g{i}")).collect();
        let list = listed(names.iter().map(String::as_str));
        assert!(list.ends_with("`g59` and 940 more"), "{list}");
        assert_eq!(listed(["a", "b"]), "`a`, `b`");
        assert_eq!(listed([]), "none");
    }
}
