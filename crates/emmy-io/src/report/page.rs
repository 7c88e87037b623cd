//! Fills the template of the page.

use serde_json::{Value, json};

use super::run::RunData;
use crate::differences::Differences;

/// The template, with placeholders such as `{{title}}`.
const TEMPLATE: &str = include_str!("assets/report.html");

/// Placeholders that are the same in every page.
const PARTS: [(&str, &str); 6] = [
    ("vendor/uplot/LICENSE", include_str!("assets/vendor/uplot/LICENSE")),
    ("vendor/ogl/LICENSE", include_str!("assets/vendor/ogl/LICENSE")),
    ("vendor/uplot/uPlot.min.css", include_str!("assets/vendor/uplot/uPlot.min.css")),
    ("vendor/uplot/uPlot.iife.min.js", include_str!("assets/vendor/uplot/uPlot.iife.min.js")),
    ("vendor/ogl/ogl.iife.min.js", include_str!("assets/vendor/ogl/ogl.iife.min.js")),
    ("report.css", include_str!("assets/report.css")),
];

/// The scripts of the page; each uses only earlier ones.
const SCRIPTS: [&str; 18] = [
    include_str!("assets/scripts/format.js"),
    include_str!("assets/scripts/data.js"),
    include_str!("assets/scripts/colours.js"),
    include_str!("assets/scripts/clock.js"),
    include_str!("assets/scripts/verdict.js"),
    include_str!("assets/scripts/chart.js"),
    include_str!("assets/scripts/quantities.js"),
    include_str!("assets/scripts/charts.js"),
    include_str!("assets/scripts/newton.js"),
    include_str!("assets/scripts/frames.js"),
    include_str!("assets/scripts/orbit.js"),
    include_str!("assets/scripts/shaders.js"),
    include_str!("assets/scripts/scene.js"),
    include_str!("assets/scripts/scale.js"),
    include_str!("assets/scripts/film.js"),
    include_str!("assets/scripts/viewer.js"),
    include_str!("assets/scripts/transport.js"),
    include_str!("assets/scripts/details.js"),
];

/// The script of natural modes, in their pages only.
const MODES: &str = include_str!("assets/scripts/modes.js");

/// The script of charts over the frequency, in their pages only.
const CURVES: &str = include_str!("assets/scripts/curves.js");

/// The last script, which puts the page together.
const MAIN: &str = include_str!("assets/scripts/main.js");

/// The page of some runs, with their differences.
pub(super) fn page(runs: &[RunData], differences: Option<&Differences>) -> String {
    let names: Vec<&str> = runs.iter().map(|run| run.name.as_str()).collect();
    let manifest = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "runs": runs.iter().map(|run| &run.manifest).collect::<Vec<_>>(),
        "differences": differences,
    });
    let arrays = |(index, run): (usize, &RunData)| {
        format!("<script type=\"text/plain\" id=\"run-{index}\">{}</script>\n", run.arrays)
    };
    let has = |key: &str| runs.iter().any(|run| run.manifest.get(key).is_some());
    // Charts are not drawn beside modes, nor bodies beside charts over the frequency.
    let (own, left_out) = match () {
        () if has("modes") => (MODES, "vendor/uplot/uPlot.iife.min.js"),
        () if has("curves") => (CURVES, "vendor/ogl/ogl.iife.min.js"),
        () => ("", ""),
    };
    filled(TEMPLATE, |place| match place {
        "title" => escaped(&names.join(", ")),
        "manifest" => inside_script(&manifest),
        "data" => runs.iter().enumerate().map(arrays).collect(),
        "scripts" => format!("{}\n{own}\n{MAIN}", SCRIPTS.join("\n")),
        place if place == left_out => String::new(),
        place => {
            PARTS.iter().find(|(name, _)| *name == place).map_or(String::new(), |(_, text)| text.to_string())
        }
    })
}

/// Replaces the placeholders of a template; placeholders in the replacements are kept.
fn filled(template: &str, text: impl Fn(&str) -> String) -> String {
    let mut pieces = template.split("{{");
    let mut filled = pieces.next().unwrap_or_default().to_string();
    for piece in pieces {
        let (place, rest) = piece.split_once("}}").unwrap_or((piece, ""));
        filled += &text(place);
        filled += rest;
    }
    filled
}

/// Text for an HTML document.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// JSON that cannot close its script element.
fn inside_script(value: &Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(name: &str, input: &str) -> RunData {
        RunData {
            name: name.into(),
            manifest: json!({ "name": name, "input": input }),
            arrays: "abc=".into(),
        }
    }

    #[test]
    fn every_place_of_the_template_is_filled() {
        let page = page(&[run("a", ""), run("b", "")], None);
        assert!(!page.contains("{{title}}") && page.contains("<title>a, b</title>"));
        assert!(page.contains("id=\"run-1\">abc=</script>"));
        let mut places = TEMPLATE.split("{{").skip(1).filter_map(|piece| Some(piece.split_once("}}")?.0));
        let own = ["title", "manifest", "data", "scripts"];
        assert!(places.all(|place| own.contains(&place) || PARTS.iter().any(|(name, _)| *name == place)));
    }

    /// The MIT licence requires its notice in every copy of the libraries, which a page contains.
    #[test]
    fn every_library_in_the_page_has_its_licence_there() {
        let page = page(&[run("a", "")], None);
        let comment = page.split_once("<!--").and_then(|(_, rest)| rest.split_once("-->")).unwrap().0;
        let libraries = PARTS.iter().filter_map(|(name, _)| name.strip_prefix("vendor/")?.split('/').next());
        for library in libraries {
            let file = format!("vendor/{library}/LICENSE");
            let (_, licence) =
                PARTS.iter().find(|(name, _)| *name == file).expect("a licence of each library");
            assert!(licence.len() > 1000 && comment.contains(licence), "{library}");
        }
        assert!(comment.contains("Copyright (c) 2022 Leon Sorokin"));
    }

    #[test]
    fn names_and_inputs_cannot_end_the_page() {
        let page = page(&[run("<b>", "title = \"</script><script>alert(1)\"")], None);
        assert!(
            page.contains("<title>&lt;b&gt;</title>")
                && !page.contains("alert(1)\"</")
                && !page.contains("</script><script>alert")
        );
    }

    #[test]
    fn nothing_is_loaded_from_elsewhere() {
        let own = SCRIPTS
            .iter()
            .chain([&TEMPLATE, &MODES, &MAIN])
            .copied()
            .chain(PARTS.iter().map(|(_, text)| *text));
        for text in own {
            assert!(!text.contains("</script><") && !text.contains("@import") && !text.contains("fetch("));
            // Names of XML vocabularies and of a licence are not loaded.
            let rest = text.replace("http://www.w3.org/2000/svg", "").replace("<https://unlicense.org>", "");
            let addresses = rest
                .match_indices("http")
                .filter(|(at, _)| rest[*at..].starts_with("http://") || rest[*at..].starts_with("https://"));
            let addresses: Vec<&str> =
                addresses.map(|(at, _)| &rest[at..(at + 60).min(rest.len())]).collect();
            assert!(
                addresses.iter().all(|address| address.starts_with("https://github.com/leeoniya")),
                "{addresses:?}"
            );
        }
    }
}
