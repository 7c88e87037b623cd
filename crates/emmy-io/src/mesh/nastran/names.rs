//! Names of properties in comments of preprocessors.

use std::collections::HashMap;

/// Names by the numbers of properties:
///
/// | program | comment |
/// |---|---|
/// | ANSA | `$ANSA_NAME_COMMENT;1;PSOLID;steel;` |
/// | HyperMesh | `$HMNAME PROP  1"steel" 4` |
/// | Femap | `$ Femap Property 1 : steel` |
pub(super) fn properties(text: &str) -> HashMap<u64, String> {
    text.lines().filter_map(|line| name(line.strip_prefix('$')?)).collect()
}

fn name(comment: &str) -> Option<(u64, String)> {
    let (number, name) = match comment.trim() {
        ansa if ansa.starts_with("ANSA_NAME_COMMENT;") => {
            let fields: Vec<&str> = ansa.split(';').collect();
            fields.get(2).filter(|card| card.starts_with('P'))?;
            (fields[1], *fields.get(3)?)
        }
        other => match (other.strip_prefix("HMNAME PROP"), other.strip_prefix("Femap Property")) {
            (Some(hypermesh), _) => (hypermesh.split('"').next()?, hypermesh.split('"').nth(1)?),
            (None, femap) => femap?.split_once(':')?,
        },
    };
    let name = crate::message::name(name.trim());
    (!name.is_empty()).then_some((number.trim().parse().ok()?, name.into_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_three_programs_are_read() {
        let text = "$ANSA_NAME_COMMENT;1;PSOLID;steel;\n$ANSA_NAME_COMMENT;7;MAT1;iron;\n$HMNAME PROP                   2\"soft rubber\" 4\n\
                    $HMNAME COMP 3\"part\"\n$ Femap Property 4 : Glass\r\n$ Femap Property 5 :\n$ plain\n";
        let expected =
            [(1, "steel"), (2, "soft rubber"), (4, "Glass")].map(|(n, name)| (n, name.to_string()));
        assert_eq!(properties(text), expected.into());
    }
}
