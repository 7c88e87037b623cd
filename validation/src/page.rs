//! The index page: every item with its claims, verdicts and pictures.

use std::fmt::Write;

use crate::claim::Item;
use crate::items::COMPLETED;

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}\
    table{border-collapse:collapse;margin:.5rem 0}td,th{border:1px solid #bbb;padding:.2rem .6rem;text-align:left}\
    img{max-width:100%}.yes{color:#00664a;font-weight:bold}.no{color:#b3261e;font-weight:bold}";

/// The page as HTML.
pub fn html(items: &[Item], effort: &str) -> String {
    let mut page = format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>The paper, reproduced</title><style>{STYLE}</style>\
         <h1>The paper, reproduced</h1><p>P. Betsch, P. Steinmann, <em>Conservation properties of a time FE method, Part II</em> \
         (2001), Section 5. {COMPLETED}</p><p>{effort}</p>"
    );
    items.iter().for_each(|item| section(&mut page, item));
    page + "</html>\n"
}

fn section(page: &mut String, item: &Item) {
    // Writing to a string cannot fail.
    let _ = write!(page, "<h2>{}</h2><p>{}</p><ul>", escaped(item.title), escaped(item.note));
    for claim in &item.claims {
        let (class, word) = if claim.holds { ("yes", "holds") } else { ("no", "FAILS") };
        let (statement, measured) = (escaped(&claim.statement), escaped(&claim.measured));
        let _ = write!(page, "<li><span class=\"{class}\">{word}</span>: {statement} ({measured})</li>");
    }
    page.push_str("</ul>");
    if !item.table.is_empty() {
        page.push_str("<table>");
        for (row, cells) in item.table.iter().enumerate() {
            let tag = if row == 0 { "th" } else { "td" };
            let cells: String =
                cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect();
            let _ = write!(page, "<tr>{cells}</tr>");
        }
        page.push_str("</table>");
    }
    for picture in &item.pictures {
        let _ = write!(page, "<p><img src=\"{picture}\" alt=\"{}\"></p>", escaped(item.title));
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
