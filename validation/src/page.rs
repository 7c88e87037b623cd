//! The page: every item with its claims, verdicts, tables and pictures, as Markdown and as HTML.

use std::fmt::Write;
use std::path::Path;

use pulldown_cmark::{Options, Parser, html};

use crate::claim::{Claim, Item};
use crate::items::COMPLETED;

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}\
    table{border-collapse:collapse;margin:.5rem 0}td,th{border:1px solid #bbb;padding:.2rem .6rem;text-align:left}\
    img{max-width:100%}code{font-size:.85em}";

/// Contents of the page.
pub(crate) struct Page<'a> {
    /// The items.
    pub items: &'a [Item],
    /// Whether it is the quick set.
    pub quick: bool,
    /// Duration of the computation in seconds.
    pub seconds: f64,
}

impl Page<'_> {
    /// Writes `results.md` and `index.html` into a folder.
    ///
    /// # Errors
    /// Errors of the system.
    pub(crate) fn write(&self, folder: &Path) -> std::io::Result<()> {
        let text = self.markdown();
        std::fs::write(folder.join("results.md"), &text)?;
        let mut body = String::new();
        html::push_html(&mut body, Parser::new_ext(&text, Options::ENABLE_TABLES));
        let head = format!(
            "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>The paper, reproduced</title><style>{STYLE}</style>"
        );
        std::fs::write(folder.join("index.html"), format!("{head}{body}</html>\n"))
    }

    fn markdown(&self) -> String {
        let set = if self.quick { "Quick set" } else { "Full set" };
        let claims = || self.items.iter().flat_map(|item| &item.claims);
        let held = claims().filter(|claim| claim.holds).count();
        let mut page = format!(
            "# The paper, reproduced\n\nP. Betsch, P. Steinmann, *Conservation properties of a time FE method, Part II* (2001), Section 5. \
             {COMPLETED}\n\n{set}: {held} of {} claims hold. Computed in {:.0} s on {}, by Emmy {}.\n",
            claims().count(),
            self.seconds,
            machine(),
            env!("CARGO_PKG_VERSION")
        );
        self.items.iter().for_each(|item| section(&mut page, item));
        page
    }
}

/// The processor, as far as the system reports it, and the number of threads.
fn machine() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let name = name.map_or(std::env::consts::ARCH, |(_, name)| name);
    format!("{name}, {} threads", rayon::current_num_threads())
}

fn section(page: &mut String, item: &Item) {
    // Writing to a string cannot fail.
    let _ = write!(page, "\n## {}\n\n{}\n", escaped(item.title), escaped(item.note));
    part(page, item.name, "claims", item.claims.iter().map(claim).collect());
    part(page, item.name, "tables", item.tables.iter().map(|rows| table(rows)).collect());
    let picture = |name: &String| format!("\n![{}]({name})\n", escaped(item.title));
    item.pictures.iter().for_each(|name| page.push_str(&picture(name)));
    if !item.commands.is_empty() {
        let _ = write!(page, "\n```sh\n{}\n```\n", item.commands.join("\n"));
    }
}

/// A part of a section between the marks by which pages of the book copy it (`tests/book.rs`).
fn part(page: &mut String, item: &str, part: &str, text: String) {
    if !text.is_empty() {
        let name = format!("{item}-{part}");
        let _ = write!(page, "\n<!-- part: {name} -->\n\n{}\n\n<!-- end of part -->\n", text.trim_end());
    }
}

fn claim(claim: &Claim) -> String {
    let word = if claim.holds { "holds" } else { "FAILS" };
    format!("- **{word}**: {} ({})\n", escaped(&claim.statement), escaped(&claim.measured))
}

fn table(rows: &[Vec<String>]) -> String {
    let mut text = String::new();
    for (i, cells) in rows.iter().enumerate() {
        let cells: Vec<String> = cells.iter().map(|cell| escaped(cell)).collect();
        let _ = writeln!(text, "| {} |", cells.join(" | "));
        if i == 0 {
            let _ = writeln!(text, "|{}", "---|".repeat(cells.len()));
        }
    }
    text + "\n"
}

/// A text with the characters of Markdown escaped.
fn escaped(text: &str) -> String {
    let own = ['\\', '|', '*', '_', '<', '>', '`', '['];
    text.chars().flat_map(|c| own.contains(&c).then_some('\\').into_iter().chain([c])).collect()
}
