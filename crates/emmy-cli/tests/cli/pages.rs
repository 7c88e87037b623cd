//! The pages as a hosting site shows them: plain Markdown, in which every link leads somewhere.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use regex_lite::Regex;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// A page as it stands.
struct Page {
    text: String,
}

impl Page {
    fn read(path: &Path) -> Self {
        Page { text: fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())) }
    }

    /// Lines outside of listings.
    fn prose(&self) -> impl Iterator<Item = &str> {
        let mut is_listing = false;
        self.text.lines().filter(move |line| {
            let is_fence = line.trim_start().starts_with("```");
            is_listing ^= is_fence;
            !is_listing && !is_fence
        })
    }

    /// Addresses of links and pictures, without those of other sites.
    fn links(&self) -> Vec<String> {
        let code = Regex::new(r"`[^`]*`").unwrap();
        let link = Regex::new(r#"(?:\]\(|(?:href|src)=")([^)"\s]+)"#).unwrap();
        let prose = self.prose().collect::<Vec<_>>().join("\n");
        let prose = code.replace_all(&prose, "");
        let links = link.captures_iter(&prose).map(|found| found[1].to_string());
        links.filter(|link| !link.contains("://") && !link.starts_with("mailto:")).collect()
    }

    /// Anchors of the headings.
    fn anchors(&self) -> Vec<String> {
        let mut seen = BTreeMap::<String, usize>::new();
        let headings = self.prose().filter_map(|line| {
            let heading = line.trim_start_matches('#').strip_prefix(' ')?;
            line.starts_with('#').then(|| anchor(heading))
        });
        let mut number = |anchor: String| {
            let before = seen.entry(anchor.clone()).or_default();
            *before += 1;
            if *before == 1 { anchor } else { format!("{anchor}-{}", *before - 1) }
        };
        headings.map(&mut number).collect()
    }
}

/// The anchor of a heading: its letters and digits in lower case, with hyphens for blanks.
fn anchor(heading: &str) -> String {
    let link = Regex::new(r"\[([^\]]*)\]\([^)]*\)").unwrap();
    let text = link.replace_all(heading.trim(), "$1").to_lowercase();
    let kept = text.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// The pages that links of README.md reach.
fn reached() -> BTreeMap<PathBuf, Page> {
    let mut pages = BTreeMap::new();
    let mut next = vec![root().join("README.md")];
    while let Some(path) = next.pop() {
        if pages.contains_key(&path) {
            continue;
        }
        let page = Page::read(&path);
        let files = page.links().into_iter().filter_map(|link| target(&path, &link).canonicalize().ok());
        next.extend(files.filter(|file| file.extension().is_some_and(|extension| extension == "md")));
        pages.insert(path, page);
    }
    pages
}

/// The file of a link of a page.
fn target(page: &Path, link: &str) -> PathBuf {
    match link.split('#').next().unwrap() {
        "" => page.to_path_buf(),
        file => page.parent().unwrap().join(file),
    }
}

#[test]
fn every_link_and_anchor_leads_somewhere() {
    let mut dead = Vec::new();
    let pages = reached();
    for (path, page) in &pages {
        for link in page.links() {
            let file = target(path, &link).canonicalize();
            let is_alive = match (&file, link.split_once('#')) {
                (Err(_), _) => false,
                (Ok(_), None) => true,
                (Ok(file), Some((_, anchor))) => {
                    pages.get(file).is_some_and(|page| page.anchors().iter().any(|own| own == anchor))
                }
            };
            if !is_alive {
                dead.push(format!("{}: {link}", path.strip_prefix(root()).unwrap().display()));
            }
        }
    }
    assert!(dead.is_empty(), "{}", dead.join("\n"));
}

#[test]
fn the_book_is_reached_and_needs_no_preprocessor() {
    let pages = reached();
    let book = root().join("book/src");
    for (path, page) in &pages {
        assert!(!page.text.contains("{{#"), "{}", path.display());
        // mdBook copies no other files.
        let outside =
            |link: &String| !target(path, link).canonicalize().is_ok_and(|file| file.starts_with(&book));
        let outside: Vec<String> = page.links().into_iter().filter(outside).collect();
        assert!(!path.starts_with(&book) || outside.is_empty(), "{}: {outside:?}", path.display());
    }
    for folder in ["", "design", "paper"] {
        for name in super::names(&book.join(folder)).iter().filter(|name| name.ends_with(".md")) {
            let page = book.join(folder).join(name);
            assert!(pages.contains_key(&page), "no link of README.md leads to {}", page.display());
        }
    }
}

#[test]
fn links_and_anchors_are_those_of_a_hosting_site() {
    let page = Page {
        text: "# One [Two](a.md)\n```sh\n# no [b](b.md)\n```\n## `[[load]] history`: C, and D\n\
               `[c](c.md)` [d\ne](d.md#f) ![g](g.svg) [h](https://h.org)\n# One Two\n"
            .to_string(),
    };
    assert_eq!(page.links(), ["a.md", "d.md#f", "g.svg"]);
    assert_eq!(page.anchors(), ["one-two", "load-history-c-and-d", "one-two-1"]);
}

/// Largest width of a line of text; listings, tables, pictures and addresses may be wider.
const WIDTH: usize = 120;

/// Files that a program writes, or that others wrote.
const NOT_OURS: [&str; 5] = ["target", "vendor", "environments", "results.md", "THIRD_PARTY_NOTICES.md"];

/// Files with an extension in a folder and below.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let ours = super::names(folder).into_iter().filter(|name| !name.starts_with('.'));
    let paths = ours.filter(|name| !NOT_OURS.contains(&name.as_str())).map(|name| folder.join(name));
    let wanted = |path: &PathBuf| path.extension().is_some_and(|own| own == extension);
    paths
        .flat_map(|path| if path.is_dir() { files(&path, extension) } else { vec![path] })
        .filter(wanted)
        .collect()
}

/// Lines of text in a page, without those that a test writes.
fn text_of_page(page: &Page) -> impl Iterator<Item = &str> {
    let mut is_written = false;
    page.prose().filter(move |line| {
        is_written |= line.starts_with("<!-- part:") || line.starts_with("<!-- table:");
        is_written &= !line.starts_with("<!-- end of");
        !is_written && !line.starts_with("    ")
    })
}

/// Comments of a file without their listings and formulas.
fn text_of_comments(text: &str) -> impl Iterator<Item = &str> {
    let mut is_listed = false;
    text.lines().map(str::trim_end).filter(move |line| {
        let line = line.trim_start();
        let is_fence = line.trim_start_matches(['/', '!', ' ']).starts_with("```");
        is_listed = line.starts_with("//") && (is_listed != is_fence);
        line.starts_with("//") && !is_listed && !is_fence
    })
}

fn is_wide(line: &str) -> bool {
    let mark = ["///", "//!", "//"].into_iter().find_map(|mark| line.trim_start().strip_prefix(mark));
    let text = mark.unwrap_or(line).trim_start();
    let may_be_wide = text.starts_with('|') || text.starts_with("![") || !text.contains(' ');
    line.chars().count() > WIDTH && !may_be_wide
}

/// Whether a comment begins with the word "What": the style wants a noun.
fn begins_with_what(line: &str) -> bool {
    line.trim_start().starts_with("//")
        && line.trim_start().trim_start_matches(['/', '!', ' ']).starts_with("What ")
}

#[test]
fn lines_of_text_keep_to_the_style() {
    let mut faults = Vec::new();
    let mut look = |path: &Path, lines: &mut dyn Iterator<Item = &str>| {
        let own = lines.filter(|line| is_wide(line) || begins_with_what(line));
        faults.extend(own.map(|line| format!("{}: {line}", path.strip_prefix(root()).unwrap().display())));
    };
    for folder in ["crates", "python", "examples", "validation", "benches", "attack", "fuzz", "book/src"] {
        for path in files(&root().join(folder), "md") {
            look(&path, &mut text_of_page(&Page::read(&path)));
        }
        for path in files(&root().join(folder), "rs") {
            let text = fs::read_to_string(&path).unwrap();
            look(&path, &mut text_of_comments(&text));
        }
    }
    for name in ["ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md", "README.md"] {
        let path = root().join(name);
        look(&path, &mut text_of_page(&Page::read(&path)));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Paths in pages about the code; those without a crate are in `crates/emmy/src`, and a module needs no ending.
#[test]
fn files_of_the_code_have_the_names_in_the_pages() {
    let path = Regex::new(r"`([a-z_]+(?:/[a-z_0-9.-]+)+/?)`").unwrap();
    let folders =
        ["", "crates", "crates/emmy/src", "crates/emmy", "crates/emmy-cli"].map(|folder| root().join(folder));
    // Programs write these.
    let made = ["book/html", "fuzz/artifacts"];
    let is_there = |name: &str| {
        let mut places = folders.iter().map(|folder| folder.join(name));
        made.contains(&name) || places.any(|place| place.exists() || place.with_extension("rs").exists())
    };
    let design = files(&root().join("book/src/design"), "md");
    let pages = ["ARCHITECTURE.md", "CONTRIBUTING.md"].map(|name| root().join(name));
    let mut wrong = Vec::new();
    for page in pages.into_iter().chain(design) {
        let text = Page::read(&page).text;
        let names = path.captures_iter(&text).map(|found| found[1].to_string());
        let absent = names.filter(|name| !is_there(name));
        wrong.extend(absent.map(|name| format!("{}: {name}", page.display())));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
