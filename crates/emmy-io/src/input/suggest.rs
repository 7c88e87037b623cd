//! The nearest word to one that is not known.

/// The nearest of the known words, if one is near enough to be meant.
pub(super) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let plain = plain(word);
    let distance = |known: &&str| strsim::damerau_levenshtein(&plain, &self::plain(known));
    let length = plain.chars().count();
    // One letter is as near to every other one.
    let allowed = (length / 3).max(1).min(length.saturating_sub(1));
    known
        .into_iter()
        .map(|word| (distance(&word), word))
        .filter(|(d, _)| *d <= allowed)
        .min()
        .map(|(_, word)| word)
}

/// "did you mean ...?", or nothing.
pub(super) fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest(word, known).map(|word| format!("did you mean `{word}`?"))
}

/// Words in one line, each in back-quotes.
pub(super) fn listed<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let words: Vec<String> = words.into_iter().map(|word| format!("`{word}`")).collect();
    if words.is_empty() { "none".to_string() } else { words.join(", ") }
}

/// Case, hyphens and underscores make no difference to what is meant.
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
}
