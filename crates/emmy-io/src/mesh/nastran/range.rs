//! Lists of grid points: `1, 5, THRU, 12, EXCEPT, 7, 20`.

/// Numbers from the first to the last one, without some others.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Range {
    pub(super) first: u64,
    pub(super) last: u64,
    /// First and last number of each range that is taken out.
    except: Vec<[u64; 2]>,
}

impl Range {
    pub(super) fn contains(&self, number: u64) -> bool {
        let is_in = |[first, last]: &[u64; 2]| (*first..=*last).contains(&number);
        is_in(&[self.first, self.last]) && !self.except.iter().any(is_in)
    }
}

/// The ranges of a list, and the fields that are not part of any. The numbers after `EXCEPT` are taken out up to the
/// first one beyond the range.
pub(super) fn ranges<'a>(fields: &[&'a str]) -> (Vec<Range>, Vec<&'a str>) {
    let is = |field: Option<&&str>, word: &str| field.is_some_and(|field| field.eq_ignore_ascii_case(word));
    let fields: Vec<&str> = fields.iter().copied().filter(|field| !field.is_empty()).collect();
    let (mut ranges, mut others) = (Vec::<Range>::new(), Vec::new());
    let mut is_except = false;
    let mut rest = &fields[..];
    while let [field, more @ ..] = rest {
        rest = more;
        let Ok(first) = field.parse::<u64>() else {
            is_except =
                is(Some(field), "EXCEPT") && ranges.last().is_some_and(|range| range.last > range.first);
            others.extend((!is_except).then_some(*field));
            continue;
        };
        let thru =
            if is(more.first(), "THRU") { more.get(1).and_then(|last| last.parse().ok()) } else { None };
        if thru.is_some() {
            rest = &more[2..];
        }
        let last = thru.unwrap_or(first);
        match ranges.last_mut() {
            Some(range) if is_except && (range.first..=range.last).contains(&first) => {
                range.except.push([first, last]);
            }
            _ => {
                is_except = false;
                ranges.push(Range { first, last, except: Vec::new() });
            }
        }
    }
    (ranges, others)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_taken_out_of_the_range_before() {
        let list = |text: &str| {
            let fields: Vec<&str> = text.split(',').collect();
            let (ranges, others) = ranges(&fields);
            let numbers = (0..30).filter(|&number| ranges.iter().any(|range| range.contains(number)));
            (numbers.collect::<Vec<u64>>(), others.join(","))
        };
        let without = |others: &str, numbers: &[u64]| (numbers.to_vec(), others.to_string());
        assert_eq!(list("1,5,thru,8,except,7"), without("", &[1, 5, 6, 8]));
        assert_eq!(list("1,THRU,6,,EXCEPT,2,THRU,4,9,5"), without("", &[1, 5, 6, 9]));
        assert_eq!(list("7,FOO,8"), without("FOO", &[7, 8]));
        assert_eq!(list("7,THRU"), without("THRU", &[7]));
        assert_eq!(list("7,THRU,x,9"), without("THRU,x", &[7, 9]));
        assert_eq!(list("7,EXCEPT,8"), without("EXCEPT", &[7, 8]));
        assert_eq!(list("9,THRU,7"), without("", &[]));
    }
}
