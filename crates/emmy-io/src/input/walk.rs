//! One walk checks a value, and everything in it, against its description. It stores every fault.

use emmy::internals::material::{Bounds, ELASTIC_CONSTANTS, IfAbsent};
use emmy::internals::number::short;

use super::description::{Kind, Rule, Section};
use super::fault::{Fault, Faults};
use super::finite::{HELP, LARGEST};
use super::suggest::{did_you_mean, listed, nearest};
use super::table::{Item, Table, spelled};
use super::tree::Value;
use super::{catalogue, joint, material, parameters, synonyms};

/// The table of an item, if everything in it is right.
pub(super) fn table<'a>(item: Item<'a>, faults: &mut Faults) -> Option<Table<'a>> {
    if is_right(item, faults) { item.table() } else { None }
}

/// The table of the whole input with its keys checked, but not the tables in it.
pub(super) fn root<'a>(item: Item<'a>, faults: &mut Faults) -> Option<Table<'a>> {
    match item.table() {
        Some(table) => {
            are_keys_right(&table, faults);
            Some(table)
        }
        None => {
            faults.push(mismatch(item));
            None
        }
    }
}

/// The tables of a section of the input: each whose keys and values are right.
pub(super) fn tables<'a>(section: Item<'a>, faults: &mut Faults) -> Vec<Table<'a>> {
    let mut items = match (section.kind, section.value()) {
        (Kind::Tables(..), Value::Array(_) | Value::Table(_)) => section.items(),
        _ => vec![section],
    };
    faults.keep(length(section, items.len()));
    keep_right(&mut items, faults);
    items.into_iter().filter_map(|item| item.table()).collect()
}

/// Checks a value and everything in it.
pub(super) fn is_right(item: Item<'_>, faults: &mut Faults) -> bool {
    if faults.are_many() {
        return false;
    }
    match (item.kind, item.value()) {
        (Kind::Table(_) | Kind::TimeFunction(_), Value::Table(_)) => item
            .table()
            .is_some_and(|table| are_keys_right(&table, faults) & are_values_right(&table, faults)),
        // Its fault is known: otherwise there would be a number.
        (kind, value) if parameters::is_computed(kind, value) => false,
        (Kind::TimeFunction(_), Value::TimeFunction(_)) | (Kind::Field(_), Value::Field(_)) => true,
        (Kind::Field(of), _) if !is_of_program(item) => is_right(Item { kind: of, ..item }, faults),
        (Kind::Either(_), _) => match item.of_one_kind() {
            Some(of_kind) => {
                let is_right = is_right(of_kind, faults);
                if !is_right {
                    faults.advise_last(single(item));
                }
                is_right
            }
            None => faults.keep(Err::<(), _>(mismatch(item))).is_some(),
        },
        (
            Kind::TimeFunction(_) | Kind::Tables(..) | Kind::List(..) | Kind::Exactly(..) | Kind::Words(..),
            Value::Array(_),
        )
        | (Kind::Groups | Kind::Tables(..), Value::Table(_))
            if !is_entry(item) =>
        {
            let mut items = item.items();
            let n = items.len();
            if faults.keep(length(item, n)).is_none() {
                return false;
            }
            keep_right(&mut items, faults);
            items.len() == n
                && (!matches!(item.kind, Kind::Words(..)) || faults.keep(are_different(&items)).is_some())
        }
        _ => faults.keep(value(item)).is_some(),
    }
}

/// Keeps the entries of a list that are right. The same mistake in all of them is one fault, except in tables.
fn keep_right(items: &mut Vec<Item<'_>>, faults: &mut Faults) {
    let mut own = Faults::default();
    let are_tables = items.iter().any(|item| item.table().is_some());
    items.retain(|item| is_right(*item, &mut own));
    // Beyond the limit entries are not looked at, and may be right.
    if items.is_empty() && !are_tables && !own.are_many() {
        own.join_alike();
    }
    faults.append(own);
}

fn are_values_right(table: &Table<'_>, faults: &mut Faults) -> bool {
    let wrong = table.items().filter(|item| {
        let is_wrong = !is_misnamed(table, item.key) && !is_right(*item, faults);
        // A misspelt optional key of a table in which other names are free.
        if is_wrong && table.section.key_of(item.key).is_none() {
            faults.advise_last(did_you_mean(item.key, table.section.names()));
        }
        is_wrong
    });
    wrong.count() == 0
}

/// Whether a free name is meant to be a required key, which is missing.
fn is_misnamed(table: &Table<'_>, name: &str) -> bool {
    let section = table.section;
    let required = section.keys.iter().filter(|key| key.if_absent == IfAbsent::Required);
    let mut missing = required.map(|key| key.name).filter(|key| table.item(key).is_none());
    let meant = nearest(name, section.names()).filter(|_| section.key_of(name).is_none());
    meant.is_some_and(|meant| missing.any(|key| key == meant))
}

/// Checks a value without values in it.
fn value(item: Item<'_>) -> Result<(), Fault> {
    let key = item.key;
    match (item.kind, item.value()) {
        (Kind::Number(bounds), Value::Float(value)) => number(item, *bounds, *value),
        (Kind::Number(bounds), Value::Integer(value)) => number(item, *bounds, *value as f64),
        (Kind::Expression, Value::Float(value)) => number(item, Bounds::Any, *value),
        (Kind::Expression, Value::Integer(_)) | (Kind::True, Value::Boolean(true)) => Ok(()),
        (Kind::True, Value::Boolean(false)) => {
            Err(item.fault(format!("`{key}` is true or left out"), "without effect"))
        }
        (Kind::Whole(least, most), Value::Integer(value)) => whole(item, *least, *most, *value),
        (Kind::Whole(..), Value::Float(value)) => {
            Err(item.fault(format!("`{key}` must be a whole number, not {value:?}"), "not whole"))
        }
        (kind, Value::String(text)) => match kind {
            Kind::Text
            | Kind::Column(_)
            | Kind::Word(..)
            | Kind::Scheme(_)
            | Kind::TimeFunction(_)
            | Kind::Expression
                if text.trim().is_empty() =>
            {
                Err(item.fault(format!("`{key}` must not be empty"), "empty"))
            }
            _ if is_of_program(item) => {
                let message = format!("`{key}`: a file cannot hold the function that a program gave here");
                Err(item.fault(message, "here").help("a run with it continues only in that program"))
            }
            Kind::Text | Kind::Expression | Kind::TimeFunction(_) => Ok(()),
            Kind::Column(taken) => column(item, text, taken),
            Kind::Word(_, words, _) if words.contains(&text.as_str()) => Ok(()),
            Kind::Word(what, words, doubt) => Err(doubt(text).map_or_else(
                || {
                    let near = did_you_mean(text, words.iter().copied());
                    let message =
                        format!("`{text}` is not {what}; there is {}", listed(words.iter().copied()));
                    item.fault(message, near.unwrap_or_else(|| format!("not {what}")))
                },
                |(fault, label)| fault.label(item.place(), label),
            )),
            Kind::Scheme(doubt) => {
                doubt(text).map_or(Ok(()), |(fault, label)| Err(fault.label(item.place(), label)))
            }
            _ => Err(mismatch(item)),
        },
        _ => Err(mismatch(item)),
    }
}

/// Whether a text stands in a file for a function of a program.
fn is_of_program(item: Item<'_>) -> bool {
    matches!(item.kind, Kind::Field(_) | Kind::TimeFunction(_))
        && item.text().is_some_and(|text| text.starts_with("<function"))
}

fn number(item: Item<'_>, bounds: Bounds, value: f64) -> Result<(), Fault> {
    let key = item.key;
    if !value.is_finite() {
        return Err(item.fault(format!("`{key}` must be a finite number, not {value}"), "not finite"));
    }
    let (wanted, label) = match bounds {
        _ if bounds.contains(value) && value.abs() <= LARGEST => return Ok(()),
        _ if bounds.contains(value) => {
            let message = format!("`{key}` must not be beyond {}", short(LARGEST));
            return Err(item.fault(message, "too large").help(HELP));
        }
        Bounds::NotZero => return Err(item.fault(format!("`{key}` must not be 0"), "zero")),
        Bounds::Above(0.0) => ("positive".to_string(), "not positive"),
        Bounds::Above(least) => (format!("above {least}"), "out of range"),
        Bounds::AtLeast(least) => (format!("at least {least}"), "out of range"),
        Bounds::Between(low, high) if value == low || value == high => {
            (format!("{bounds}, both excluded"), "out of range")
        }
        _ => (bounds.to_string(), "out of range"),
    };
    Err(item.fault(format!("`{key}` must be {wanted}, not {}", spelled(value)), label))
}

fn whole(item: Item<'_>, least: usize, most: Option<usize>, value: i64) -> Result<(), Fault> {
    let number = usize::try_from(value).ok().filter(|number| *number >= least);
    let (bound, label) = match (number, most) {
        (None, _) => (format!("at least {least}"), "too small"),
        (Some(number), Some(most)) if number > most => (format!("at most {most}"), "too large"),
        _ => return Ok(()),
    };
    Err(item.fault(format!("`{}` must be {bound}, not {value}", item.key), label))
}

fn column(item: Item<'_>, name: &str, taken: &[&str]) -> Result<(), Fault> {
    if !name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-') {
        let message =
            format!("`{name}` is used as a column name: it may contain only letters, digits, `_` and `-`");
        return Err(item.fault(message, "not a name"));
    }
    match taken.contains(&name) {
        true => Err(item.fault(format!("there is a column `{name}_x` already"), "taken")),
        false => Ok(()),
    }
}

/// Checks the number of entries of a list.
fn length(item: Item<'_>, n: usize) -> Result<(), Fault> {
    let key = item.key;
    match item.kind {
        Kind::List(least, _) | Kind::Words(least, _) | Kind::Tables(least, _) if n < *least && n == 0 => {
            Err(item.fault(format!("`{key}` is empty"), "needs an entry"))
        }
        Kind::Exactly(length, of) if n != *length => {
            Err(item
                .fault(format!("`{key}` must have {length} {}, not {n}", plural(of)), format!("{n} here")))
        }
        _ => Ok(()),
    }
}

fn are_different(words: &[Item<'_>]) -> Result<(), Fault> {
    let is_again = |i: &usize| words[..*i].iter().any(|other| other.text() == words[*i].text());
    match (0..words.len()).find(is_again).map(|i| words[i]) {
        Some(word) => {
            Err(word.fault(format!("`{}` is listed twice", word.text().unwrap_or_default()), "again"))
        }
        None => Ok(()),
    }
}

/// The fault of a value of another kind, with advice.
fn mismatch(item: Item<'_>) -> Fault {
    let found = match item.value() {
        Value::Array(_) if is_entry(item) => "a single entry",
        value => value.kind(),
    };
    let message = format!("`{}` must be {}, not {found}", item.key, wanted(item.kind));
    let fault = item.fault(message, format!("this is {found}"));
    match (item.kind, item.text().map(str::trim)) {
        (Kind::Number(_) | Kind::Whole(..), Some(text)) if text.parse::<f64>().is_ok() => {
            fault.help("numbers stand without quotes")
        }
        (Kind::Number(_) | Kind::Whole(..), Some(text)) if text.contains('*') => {
            fault.help(format!("an expression begins with `=`: {} = \"= {text}\"", item.key))
        }
        (Kind::Number(_) | Kind::Whole(..), Some(text))
            if text.starts_with(|c: char| c.is_ascii_digit() || ".+-".contains(c)) =>
        {
            fault.help(
                "give the number alone: units are any consistent set, such as m, kg, s, and are not written",
            )
        }
        _ if is_entry(item) => fault.help("put square brackets around it"),
        (Kind::Word(..), None) if item.key == "gravity" => {
            fault.help("the vector of any acceleration is an `acceleration`")
        }
        (Kind::TimeFunction(_), _) => match item.value() {
            Value::Float(number) => fault.help(of_number(item.key, *number)),
            Value::Integer(number) => fault.help(of_number(item.key, *number as f64)),
            _ => fault,
        },
        _ => fault,
    }
}

/// How a number is written as a function of time.
fn of_number(key: &str, number: f64) -> String {
    match key {
        "angle" | "slide" => {
            format!("a given motion begins with zero, such as {key} = \"{number:?}*t\" at a constant rate")
        }
        "x" | "y" | "z" => format!(
            "a constant is an expression, too: {key} = \"{number:?}\"; at a constant rate, {key} = \"{number:?}*t\""
        ),
        _ => format!("a constant is an expression, too: {key} = \"{number:?}\""),
    }
}

/// How a single name is written where one alone or a list of several may stand.
fn single(item: Item<'_>) -> Option<String> {
    match (item.kind, item.value()) {
        (Kind::Either(kinds), Value::Array(nodes)) if matches!(kinds[0], Kind::Text) && nodes.len() == 1 => {
            let name = Item { node: &nodes[0], ..item }.text()?;
            Some(format!("one name stands without brackets, as with an `obstacle`: {} = {name:?}", item.key))
        }
        _ => None,
    }
}

/// Whether a value is a single entry where a list must be. A table counts even if it has faults.
fn is_entry(item: Item<'_>) -> bool {
    let entry = Item { kind: item.kind.inner(), ..item };
    match item.kind {
        Kind::List(..) | Kind::Words(..) | Kind::TimeFunction(_) => {
            entry.table().is_some() || is_right(entry, &mut Faults::default())
        }
        _ => false,
    }
}

/// A value of a kind, in words.
fn wanted(kind: &Kind) -> String {
    match kind {
        Kind::Text | Kind::Column(_) | Kind::Scheme(_) => "a string".to_string(),
        Kind::Number(_) => "a number".to_string(),
        Kind::Expression => "a number or an expression".to_string(),
        Kind::Whole(..) => "a whole number".to_string(),
        Kind::Word(_, words, _) => format!("one of {}", listed(words.iter().copied())),
        Kind::True => "true".to_string(),
        Kind::List(_, of) => match &**of {
            Kind::Exactly(length, of) => format!("a list of lists of {length} {}", plural(of)),
            _ => "a list".to_string(),
        },
        Kind::Words(_, of) => match &**of {
            Kind::Word(_, words, _) => format!("a list of words, such as {:?}", &words[..1]),
            _ => "a list".to_string(),
        },
        Kind::Exactly(length, of) => format!("a list of {length} {}", plural(of)),
        Kind::Groups => "a table".to_string(),
        Kind::TimeFunction(_) => {
            "a list of [time, value], a table { file, time, value } or an expression such as \"sin(2*pi*t)\""
                .to_string()
        }
        Kind::Field(of) => wanted(of),
        Kind::Either(kinds) => kinds.each_ref().map(wanted).join(", or "),
        Kind::Table(section) => format!("a table with the keys {}", listed(section.names())),
        Kind::Tables(..) => "a table or a list of tables".to_string(),
    }
}

fn plural(of: &Kind) -> &'static str {
    match of {
        Kind::Expression => "numbers or expressions",
        Kind::Whole(..) => "whole numbers",
        Kind::Text => "names",
        Kind::Exactly(..) => "rows",
        _ => "numbers",
    }
}

/// Checks the keys of a table: all known, the required ones there, and their rule.
fn are_keys_right(table: &Table<'_>, faults: &mut Faults) -> bool {
    let (section, before) = (table.section, faults.len());
    let name = section.title();
    // Known keys that unknown ones are meant to be: these are not missing.
    let (mut meant, mut are_known) = (Vec::new(), true);
    for (key, place) in table.keys().filter(|(key, _)| section.key_of(key).is_none()) {
        if faults.are_many() {
            return false;
        }
        let (own, mut label) = meaning(section, key);
        meant.extend(own);
        let mut advice = None;
        if own.is_none()
            && let Some((other, help)) = joint::of_another_kind(section, key)
        {
            (label, advice) = (Some(other), Some(help));
        }
        if section.others.is_none() || is_misnamed(table, key) {
            are_known = false;
            let keys = format!("keys of {name}: {}", listed(section.names()));
            let help = advice.map_or_else(|| keys.clone(), |advice| format!("{advice}; {keys}"));
            let label = label.unwrap_or_else(|| "not a key".to_string());
            faults.push(Fault::at(place, format!("unknown key `{key}` in {name}"), label).help(help));
        }
    }
    let is_there = |key: &str| table.item(key).is_some() || meant.contains(&key);
    let missing =
        |key: &str| Fault::at(table.place, format!("`{key}` is missing in {name}"), format!("needs `{key}`"));
    let required = section.keys.iter().filter(|key| key.if_absent == IfAbsent::Required);
    required.filter(|key| !is_there(key.name)).for_each(|key| faults.push(missing(key.name)));
    let none = |how: &str, keys: Vec<&str>| {
        Fault::at(
            table.place,
            format!("{name} needs {how} one of {}", listed(keys)),
            "none of these is given",
        )
    };
    match &section.rule {
        Rule::ExactlyOne(sets) => match &sets.iter().filter(|keys| is_there(keys[0])).collect::<Vec<_>>()[..]
        {
            // An unknown key may be one of the choice.
            [] if !are_known => {}
            [] => faults.push(none("exactly", section.choice())),
            [keys] => keys.iter().filter(|key| !is_there(key)).for_each(|key| faults.push(missing(key))),
            several => {
                let fault = Fault::new(format!("{name} takes exactly one of {}", listed(section.choice())));
                let given = several.iter().filter_map(|keys| table.item(keys[0]));
                let labels = ["this one"].into_iter().chain(std::iter::repeat("and this one"));
                faults.push(
                    given.zip(labels).fold(fault, |fault, (item, label)| fault.label(item.key_place, label)),
                );
            }
        },
        Rule::AtLeastOne(keys) if are_known && !keys.iter().any(|key| is_there(key)) => {
            faults.push(none("at least", section.choice()));
        }
        Rule::TwoElasticConstants if are_known => {
            faults.keep(two_constants(table));
        }
        Rule::Input(keys) => {
            // A body has cells with materials, or rigid bodies, or both.
            let [mesh, region, rigid] = ["mesh", "region", "rigid"].map(is_there);
            let bodies = table.item("rigid").map(|item| item.items()).unwrap_or_default();
            let has_group = bodies.iter().filter_map(Item::table).any(|own| own.item("group").is_some());
            let is_needed = !rigid || mesh || region || has_group;
            let absent = [("mesh", mesh), ("region", region)].into_iter().filter(|(_, there)| !there);
            absent.filter(|_| is_needed).for_each(|(key, _)| faults.push(missing(key)));
            if are_known && !keys.iter().any(|key| is_there(key)) {
                faults.push(none("at least", section.choice()));
            }
        }
        // A misspelt material may have no mass.
        Rule::Region
            if !is_there("density") && table.item("material").map_or(are_known, material::has_mass) =>
        {
            faults.push(missing("density"));
        }
        Rule::Free | Rule::AtLeastOne(_) | Rule::TwoElasticConstants | Rule::Region => {}
    }
    faults.len() == before
}

/// Checks that exactly two elastic constants are given.
fn two_constants(table: &Table<'_>) -> Result<(), Fault> {
    let given: Vec<Item<'_>> = material::given_constants(table).collect();
    if given.len() == 2 {
        return Ok(());
    }
    let names: Vec<String> = ELASTIC_CONSTANTS.iter().map(|own| format!("`{}`", own.name)).collect();
    let pairs = |(i, name): (usize, &String)| match &names[i + 1..] {
        [] => None,
        [others @ .., last] if !others.is_empty() => {
            Some(format!("{name} with {} or {last}", others.join(", ")))
        }
        [last, ..] => Some(format!("{name} with {last}")),
    };
    let pairs: Vec<String> = names.iter().enumerate().filter_map(pairs).collect();
    let title = table.section.title();
    let message = format!("{title} needs exactly two elastic constants, not {}", given.len());
    let fault = match &given[..] {
        [] => Fault::at(table.place, message, "none of them here"),
        given => given.iter().fold(Fault::new(message), |fault, own| fault.label(own.key_place, "given")),
    };
    Err(fault.help(format!("the pairs: {}", pairs.join("; "))))
}

/// The keys of a table that its unknown words are meant to be.
pub(super) fn meant<'a>(table: &Table<'a>) -> impl Iterator<Item = &'static str> + use<'a> {
    let section = table.section;
    let unknown = table.keys().filter(|(key, _)| section.key_of(key).is_none());
    unknown.filter_map(|(key, _)| meaning(section, key).0)
}

/// The key of a table meant by an unknown word; advice: this key, or the table to which the word belongs.
fn meaning(section: &Section, word: &str) -> (Option<&'static str>, Option<String>) {
    if let Some(key) = word.split_once('.').and_then(|(first, _)| section.key_of(first)) {
        return (Some(key.name), Some(format!("without the quotes: {word}")));
    }
    let mut synonyms = synonyms::of(word);
    let first = synonyms.clone().next();
    let here = synonyms.find(|key| section.key_of(key).is_some());
    match here.or_else(|| nearest(word, section.names())) {
        Some(key) => (section.key_of(key).map(|key| key.name), Some(format!("did you mean `{key}`?"))),
        None if catalogue::is_planned(section, word) => (None, Some("not there yet".to_string())),
        None => {
            let elsewhere = |word| catalogue::elsewhere(section, word);
            (None, elsewhere(word).or_else(|| first.and_then(elsewhere)))
        }
    }
}
