//! Lines of an input file.

/// A keyword line: `*Elset, elset=_Surf-1_S2, internal, instance=Part-1-1`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Keyword {
    /// Upper case, without spaces: `ENDPART`.
    pub(super) name: String,
    /// As users write it, in upper case: `*END PART`.
    pub(super) title: String,
    parameters: Vec<(String, String)>,
}

impl Keyword {
    /// The keyword in a line that begins with a star.
    pub(super) fn parse(line: &str) -> Self {
        let mut fields = fields(line.trim_start_matches('*')).into_iter();
        let words = fields.next().unwrap_or_default().to_ascii_uppercase();
        let title = format!("*{}", words.split_whitespace().collect::<Vec<_>>().join(" "));
        let parameter = |field: String| match field.split_once('=') {
            Some((key, value)) => (squeezed(key), value.trim().to_string()),
            None => (squeezed(&field), String::new()),
        };
        Keyword { name: squeezed(&words), title, parameters: fields.map(parameter).collect() }
    }

    /// Whether a parameter is given, with or without a value.
    pub(super) fn has(&self, key: &str) -> bool {
        self.parameters.iter().any(|(name, _)| name == key)
    }

    /// Value of a parameter.
    pub(super) fn value(&self, key: &str) -> Option<&str> {
        let found = self.parameters.iter().find(|(name, value)| name == key && !value.is_empty());
        found.map(|(_, value)| value.as_str())
    }
}

fn squeezed(text: &str) -> String {
    text.split_whitespace().collect::<String>().to_ascii_uppercase()
}

/// Fields between commas, trimmed and without quotes; commas in quotes do not count, nor does one at the end.
pub(super) fn fields(line: &str) -> Vec<String> {
    let mut quoted = false;
    let separator = |c: char| {
        quoted ^= c == '"';
        c == ',' && !quoted
    };
    let mut fields: Vec<String> =
        line.split(separator).map(|field| field.replace('"', "").trim().into()).collect();
    if fields.last().is_some_and(String::is_empty) {
        fields.pop();
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keywords_know_no_case_and_names_in_quotes_keep_theirs() {
        let keyword = Keyword::parse("* End  part , Name = \"Arm, Left\" , INTERNAL, elset=A b");
        assert_eq!(keyword.name, "ENDPART");
        assert_eq!(keyword.title, "*END PART");
        assert_eq!(keyword.value("NAME"), Some("Arm, Left"));
        assert_eq!(keyword.value("ELSET"), Some("A b"));
        assert!(keyword.has("INTERNAL") && keyword.value("INTERNAL").is_none());
    }

    #[test]
    fn a_comma_at_the_end_is_no_field() {
        assert_eq!(fields("1, ,2,"), ["1", "", "2"]);
        assert_eq!(fields(""), Vec::<String>::new());
    }
}
