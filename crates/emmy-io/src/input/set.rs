//! `--set KEY=VALUE`: values of the command line that replace values of the file.

use std::ops::Range;

use super::equilibrium;
use super::fault::{Fault, InputError, Place};
use super::suggest::listed;
use super::table::spelled;
use super::tree::{self, Entry, Node, Value};

/// Applies one `KEY=VALUE`. The key is dotted; numbers in it count the items of a list from 0 (optional for the only
/// table of a list). The value is TOML, or else a string; a value that begins like a list, a table or a quoted text
/// must be TOML. `KEY=` removes the key.
pub(super) fn apply(tree: &mut Node, flag: &str) -> Result<(), InputError> {
    let start = Place::start_of("--set", flag);
    let key = key(&start, flag)?;
    let path = path(&start, key)?;
    if flag[key.len() + 1..].trim().is_empty() {
        return Ok(take_out(tree, "the input", &path)?);
    }
    let value = value(&start, flag, key, path.len())?;
    Ok(assign(tree, "the input", &path, value)?)
}

/// Applies `--dt H` and `--degree K`, short forms of values in `[time]`.
pub(super) fn apply_to_time(
    tree: &mut Node,
    step_size: Option<f64>,
    degree: Option<usize>,
) -> Result<(), Fault> {
    if let Some(degree) = degree {
        let node = of_flag("--degree", &degree.to_string(), Value::Integer(degree as i64));
        time(tree, "--degree")?.put("degree", node);
    }
    if let Some(size) = step_size {
        apply_step_size(time(tree, "--dt")?, &of_flag("--dt", &spelled(size), Value::Float(size)))?;
    }
    Ok(())
}

fn time<'a>(tree: &'a mut Node, flag: &str) -> Result<&'a mut Node, Fault> {
    tree.get_mut("time").ok_or_else(|| equilibrium::no_time(flag))
}

/// The value of a flag.
fn of_flag(name: &str, text: &str, value: Value) -> Node {
    let flag = format!("{name} {text}");
    Node { value, place: Place::start_of(name, &flag).at(name.len() + 1..flag.len()) }
}

/// Sets the size of the only phase of `[time]`.
fn apply_step_size(time: &mut Node, size: &Node) -> Result<(), Fault> {
    if time.get_mut("adaptive").is_some() {
        let message = "--dt: the sizes of adaptive steps are chosen by their errors";
        let help =
            "set the error, --set time.adaptive.tolerance=E, or the bound, --set time.adaptive.max_size=H";
        return Err(Fault::at(&size.place, message, "this size").help(help));
    }
    // Something else than a list has its fault when the input is read.
    let Some(Value::Array(phases)) = time.get_mut("steps").map(|steps| &mut steps.value) else {
        return Ok(());
    };
    if phases.len() > 1 {
        let message = format!("--dt: `steps` has {} phases, each with its size", phases.len());
        let help =
            format!("set each by its number: --set time.steps.0.size=H to time.steps.{}", phases.len() - 1);
        return Err(Fault::at(&size.place, message, "of which phase?").help(help));
    }
    phases.iter_mut().for_each(|phase| phase.put("size", size.clone()));
    Ok(())
}

/// A flag `KEY=A,B,C` of a sweep as one `KEY=VALUE` for each value. A comma inside brackets or quotes belongs to a
/// value.
///
/// # Errors
/// A key that is not dotted, and an empty value among others.
pub(crate) fn alternatives(flag: &str) -> Result<Vec<String>, InputError> {
    let start = Place::start_of("--set", flag);
    let key = key(&start, flag)?;
    path(&start, key)?;
    let offset = key.len() + 1;
    let values = split(&flag[offset..]);
    let is_empty = |value: &&Range<usize>| flag[offset..][(*value).clone()].trim().is_empty();
    if let Some(empty) = values.iter().find(is_empty).filter(|_| values.len() > 1) {
        let comma = offset + empty.start.saturating_sub(1)..offset + empty.end + 1;
        let fault = Fault::at(&start.at(comma), format!("--set {flag}: a value is empty"), "no value here");
        return Err(fault.help("values stand between commas: --set region.density=1,2,3").into());
    }
    Ok(values.into_iter().map(|value| format!("{key}={}", flag[offset..][value].trim())).collect())
}

/// Puts faults of flags first, in the order of the flags. A fault of a value with commas gets the advice to use a
/// sweep.
pub(super) fn of_one_run(error: InputError, flags: &[String]) -> InputError {
    let has_many = |place: &Place| {
        let text = place.text();
        flags.iter().any(|flag| flag == text) && alternatives(text).is_ok_and(|all| all.len() > 1)
    };
    let advised = |fault: &Fault| match fault.place().is_some_and(has_many) {
        true => fault
            .clone()
            .help("a run has one value: `emmy sweep` runs each value between commas; a list is [1, 2, 3]"),
        false => fault.clone(),
    };
    let mut faults: Vec<Fault> = error.faults().iter().map(advised).collect();
    let flag =
        |fault: &Fault| flags.iter().position(|flag| fault.place().is_some_and(|place| place.text() == flag));
    faults.sort_by_cached_key(|fault| flag(fault).unwrap_or(flags.len()));
    InputError::unless_empty(faults).err().unwrap_or(error)
}

/// Parts of a text between commas, except those inside brackets and quotes.
fn split(text: &str) -> Vec<Range<usize>> {
    let mut parts = Vec::new();
    let mut start = 0;
    let mut depth = 0_usize;
    let mut quote = None;
    let mut is_escaped = false;
    for (at, c) in text.char_indices() {
        // The apostrophe of a word is no quote.
        let is_begin = || depth > 0 || text[start..at].trim_start().chars().all(|before| before == c);
        match (quote, c) {
            (Some(open), _) if c == open && !is_escaped => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') if is_begin() => quote = Some(c),
            (None, '[' | '{' | '(') => depth += 1,
            (None, ']' | '}' | ')') => depth = depth.saturating_sub(1),
            (None, ',') if depth == 0 => {
                parts.push(start..at);
                start = at + 1;
            }
            _ => {}
        }
        is_escaped = c == '\\' && quote == Some('"') && !is_escaped;
    }
    parts.push(start..text.len());
    parts
}

/// The text before the `=`.
fn key<'a>(start: &Place, flag: &'a str) -> Result<&'a str, Fault> {
    flag.split_once('=').map(|(key, _)| key).ok_or_else(|| {
        let fault = Fault::at(&start.at(0..flag.len()), format!("--set {flag}: there is no `=`"), "no `=`");
        fault.help("write --set KEY=VALUE, such as --set time.scheme=DGM")
    })
}

/// Parts of a dotted key with their places.
fn path(start: &Place, key: &str) -> Result<Vec<(String, Place)>, Fault> {
    let whole = start.at(0..key.len().max(1));
    let bad = || Fault::at(&whole, format!("--set: `{key}` is not a dotted key"), "such as load.0.traction");
    let mut node = tree::parse("--set", &format!("{key}=0")).map_err(|_| bad())?;
    let mut path = Vec::new();
    while let Value::Table(mut entries) = node.value {
        let (Some(entry), true) = (entries.pop(), entries.is_empty()) else { return Err(bad()) };
        path.push((entry.key, start.at(entry.place.span())));
        node = entry.node;
    }
    Ok(path)
}

/// The value, read as TOML or taken as a string.
fn value(start: &Place, flag: &str, key: &str, depth: usize) -> Result<Node, InputError> {
    let text = flag[key.len() + 1..].trim();
    let place = start.at(key.len() + 1..flag.len());
    let as_string = || Node { value: Value::String(text.to_string()), place: place.clone() };
    let is_toml = text.starts_with(['[', '{', '"', '\'']);
    let mut node = match tree::parse("--set", flag) {
        Ok(node) => node,
        Err(error) if is_toml => return Err(as_flag(error, flag)),
        Err(_) => return Ok(as_string()),
    };
    for _ in 0..depth {
        match node.value {
            Value::Table(mut entries) if entries.len() == 1 => node = entries.remove(0).node,
            _ if is_toml => {
                let second = Fault::at(&place, "there is more than one value", "more than one value");
                return Err(as_flag(second.into(), flag));
            }
            _ => return Ok(as_string()),
        }
    }
    Ok(node)
}

/// The error of a value, in terms of the flag.
fn as_flag(error: InputError, flag: &str) -> InputError {
    let Some(fault) = error.faults().first() else { return error };
    let help = "lists, tables and quoted texts are TOML; put the whole flag in quotes of the shell: --set 'KEY=[1, 2, 3]'";
    fault.clone().before(&format!("--set {flag}: ")).help(help).into()
}

/// Sets the value at the end of the path from a node of the given name.
fn assign(node: &mut Node, parent: &str, path: &[(String, Place)], value: Node) -> Result<(), Fault> {
    let [(name, place), rest @ ..] = path else {
        *node = value;
        return Ok(());
    };
    match &mut node.value {
        Value::Array(items) if is_only_table(items, name) => assign(&mut items[0], parent, path, value),
        Value::Table(entries) => {
            not_a_list(entries, parent, name, place)?;
            assign(key_of(entries, name, place), name, rest, value)
        }
        Value::Array(items) => assign(item_of(items, parent, path)?, name, rest, value),
        other => {
            let message = format!("--set: `{parent}` is {}, in which there is nothing to set", other.kind());
            Err(Fault::at(place, message, "leads into a single value"))
        }
    }
}

/// Removes the key at the end of the path from a node of the given name.
fn take_out(node: &mut Node, parent: &str, path: &[(String, Place)]) -> Result<(), Fault> {
    let [(name, place), rest @ ..] = path else { return Ok(()) };
    match &mut node.value {
        Value::Array(items) if is_only_table(items, name) => take_out(&mut items[0], parent, path),
        Value::Array(items) if !rest.is_empty() => take_out(item_of(items, parent, path)?, name, rest),
        Value::Table(entries) => {
            let at = entries.iter().position(|entry| entry.key == *name);
            let at = at.ok_or_else(|| nothing_there(parent, name, place))?;
            if rest.is_empty() {
                entries.remove(at);
                return Ok(());
            }
            take_out(&mut entries[at].node, name, rest)
        }
        _ => Err(nothing_there(parent, name, place)),
    }
}

fn nothing_there(parent: &str, name: &str, place: &Place) -> Fault {
    let message = format!("--set: nothing after the `=` takes a key out, and `{parent}` has no key `{name}`");
    Fault::at(place, message, "not there").help(format!("an empty text is --set '{name}=\"\"'"))
}

/// Whether a list has exactly one table, to which a key without a number belongs.
fn is_only_table(items: &[Node], name: &str) -> bool {
    name.parse::<usize>().is_err() && matches!(items, [Node { value: Value::Table(_), .. }])
}

/// Tables in which a key may be a number.
const OF_ANY_KEYS: [&str; 2] = ["groups", "link_groups"];

/// Rejects an item number if there is one table and no list.
fn not_a_list(entries: &[Entry], parent: &str, name: &str, place: &Place) -> Result<(), Fault> {
    let is_number = name.parse::<usize>().is_ok() && !entries.iter().any(|entry| entry.key == name);
    if !is_number || entries.is_empty() || OF_ANY_KEYS.contains(&parent) {
        return Ok(());
    }
    let message = format!("--set: `{parent}` is one table here, not a list of them");
    Err(Fault::at(place, message, "leave this number out"))
}

fn key_of<'a>(entries: &'a mut Vec<Entry>, name: &str, place: &Place) -> &'a mut Node {
    let at = entries.iter().position(|entry| entry.key == name).unwrap_or_else(|| {
        let node = Node { value: Value::Table(Vec::new()), place: place.clone() };
        entries.push(Entry { key: name.to_string(), place: place.clone(), node });
        entries.len() - 1
    });
    &mut entries[at].node
}

fn item_of<'a>(items: &'a mut [Node], parent: &str, path: &[(String, Place)]) -> Result<&'a mut Node, Fault> {
    let n = items.len();
    let (name, place) = &path[0];
    if name.parse::<usize>().is_err() {
        let keys: Vec<&str> = path.iter().map(|(key, _)| key.as_str()).collect();
        let message = format!("--set: `{parent}` is a list; say which item of it, counted from 0");
        return Err(Fault::at(place, message, format!("such as `{parent}.0.{}`", keys.join("."))));
    }
    let index = name.parse::<usize>().ok().filter(|&index| index < n);
    let numbers: Vec<String> = (0..n.min(8)).map(|i| i.to_string()).collect();
    let missing = || {
        let message =
            format!("--set: `{name}` is not the number of an item; the list has {n}, counted from 0");
        Fault::at(place, message, format!("one of {}", listed(numbers.iter().map(String::as_str))))
    };
    Ok(&mut items[index.ok_or_else(missing)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(text: &str, flag: &str) -> Result<String, InputError> {
        let mut tree = tree::parse("test", text)?;
        apply(&mut tree, flag)?;
        Ok(super::super::write::toml(&tree))
    }

    #[test]
    fn values_are_toml_or_else_strings() {
        assert_eq!(set("", "time.scheme=DGM").unwrap(), "[time]\nscheme = \"DGM\"\n");
        assert_eq!(set("", "time.scheme=\"AS(5)\"").unwrap(), "[time]\nscheme = \"AS(5)\"\n");
        assert_eq!(set("", "time.degree = 2").unwrap(), "[time]\ndegree = 2\n");
        assert_eq!(set("a = 1\n", "a={ b = [1, 2.0] }").unwrap(), "[a]\nb = [1, 2.0]\n");
        assert_eq!(set("", "a=x=y").unwrap(), "a = \"x=y\"\n");
    }

    #[test]
    fn values_of_a_sweep_are_between_commas_outside_of_brackets_and_quotes() {
        let values = |flag: &str| -> Vec<String> {
            let flags = alternatives(flag).unwrap();
            flags.iter().map(|flag| flag.strip_prefix("a=").unwrap().to_string()).collect()
        };
        assert_eq!(values("a=1, 2 ,3"), ["1", "2", "3"]);
        assert_eq!(values("a=[1,2,3],[4,[5,6]]"), ["[1,2,3]", "[4,[5,6]]"]);
        assert_eq!(values("a={x=1,y=2},3"), ["{x=1,y=2}", "3"]);
        assert_eq!(values("a=AS(2),Newmark(0.25,0.5)"), ["AS(2)", "Newmark(0.25,0.5)"]);
        assert_eq!(values(r#"a="x,\"y,","z",'u,v'"#), [r#""x,\"y,""#, r#""z""#, "'u,v'"]);
        assert_eq!(values(r#"a="""x,y""",["p,q]",2]"#), [r#""""x,y""""#, r#"["p,q]",2]"#]);
        assert_eq!(values("a=it's,that"), ["it's", "that"]);
        assert_eq!(values("a="), [""]);
        // An open bracket is a mistake of the value, which its reader reports.
        assert_eq!(values("a=[1,2"), ["[1,2"]);
        for (flag, part) in [
            ("a", "there is no `=`"),
            ("=1,2", "not a dotted key"),
            ("a=1,,2", "1:4: --set a=1,,2: a value is empty"),
            ("a=1,2,", "1:6: --set a=1,2,: a value is empty"),
        ] {
            let error = alternatives(flag).unwrap_err().to_string();
            assert!(error.contains(part), "{flag}: {error}");
        }
    }

    #[test]
    fn nothing_takes_a_key_out() {
        let text = "[time]\nscheme = \"DGM\"\nsteps = [1, 2]\n";
        assert_eq!(set(text, "time.steps=").unwrap(), "[time]\nscheme = \"DGM\"\n");
        assert_eq!(set(text, "time.steps = ").unwrap(), "[time]\nscheme = \"DGM\"\n");
        assert_eq!(set("load = [{ a = 1, b = 2 }]\n", "load.0.a=").unwrap(), "[[load]]\nb = 2\n");
        assert_eq!(set(text, "time.scheme=\"\"").unwrap(), "[time]\nscheme = \"\"\nsteps = [1, 2]\n");
    }

    #[test]
    fn values_that_begin_like_toml_must_be_toml() {
        for flag in ["title=\"a\" # c\nx=1", "a=[1]\nb=2", "a={ b = 1 }\nc=2", "a='x'\n[b]"] {
            let error = set("", flag).unwrap_err().to_string();
            assert!(error.contains("more than one value"), "{flag:?}: {error}");
        }
        assert_eq!(set("", "title=\"a\" # c").unwrap(), "title = \"a\"\n");
    }

    #[test]
    fn an_only_table_of_a_list_needs_no_number() {
        let text = "[[support]]\ngroup = \"y-min\"\nfix = [\"x\"]\n";
        let changed = text.replace("y-min", "y-max");
        assert_eq!(set(text, "support.group=y-max").unwrap(), changed);
        assert_eq!(set(text, "support.0.group=y-max").unwrap(), changed);
        assert_eq!(set(text, "support.fix=").unwrap(), "[[support]]\ngroup = \"y-min\"\n");
        let error = set(&text.repeat(2), "support.group=y-max").unwrap_err().to_string();
        assert!(error.contains("`support` is a list; say which item"), "{error}");
    }

    #[test]
    fn items_of_lists_are_counted_from_zero() {
        let text = "[[load]]\ntraction = [1, 2, 3]\n";
        assert_eq!(set(text, "load.0.traction.1=7").unwrap(), "[[load]]\ntraction = [1, 7, 3]\n");
        for (flag, part) in [
            ("load.1.traction=[0,0,0]", "the list has 1"),
            ("load.0.traction.x=1", "`traction` is a list; say which item"),
            ("load.0.0.traction=[0,0,0]", "`0` is one table here"),
            ("load.0.traction.0.x=1", "`0` is a whole number, in which there is nothing to set"),
            ("load.0.traction=[1, 2", "not valid TOML"),
            ("title=\"draft", "not valid TOML"),
            ("load", "there is no `=`"),
            ("=1", "not a dotted key"),
            ("a=", "has no key `a`"),
            ("load.0.history=", "has no key `history`"),
            ("load.0=", "has no key `0`"),
            ("load.0.traction.1=", "has no key `1`"),
        ] {
            let error = set(text, flag).unwrap_err().to_string();
            assert!(error.contains(part), "{flag}: {error}");
        }
    }
}
