//! The first line of a history. Names of groups may have commas and quotes, which CSV puts between quotes.

/// The line of some names.
pub(crate) fn line(names: &[String]) -> String {
    let cell = |name: &String| match name.contains([',', '"']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.clone(),
    };
    names.iter().map(cell).collect::<Vec<_>>().join(",")
}

/// The names in a line.
pub(crate) fn names(line: &str) -> Vec<String> {
    let mut names = vec![String::new()];
    let mut is_quoted = false;
    let mut characters = line.chars().peekable();
    while let Some(character) = characters.next() {
        let name = names.last_mut();
        match character {
            '"' if is_quoted && characters.peek() == Some(&'"') => {
                characters.next();
                name.into_iter().for_each(|name| name.push('"'));
            }
            '"' if is_quoted || name.as_ref().is_some_and(|name| name.is_empty()) => is_quoted = !is_quoted,
            ',' if !is_quoted => names.push(String::new()),
            character => name.into_iter().for_each(|name| name.push(character)),
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_commas_and_quotes_are_read_back() {
        let own = ["step", "left, upper_force_x", "the \"foot\"_force_x", "z-min_force_z", "5\" pipe", ""];
        let own: Vec<String> = own.map(str::to_string).to_vec();
        let text = line(&own);
        let start = r#"step,"left, upper_force_x","the ""foot""_force_x",z-min_force_z,"5"" pipe","#;
        assert_eq!(text, start);
        assert_eq!(names(&text), own);
    }
}
