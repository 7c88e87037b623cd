//! Coordinates and ticks of an axis.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;

use super::Scale;

/// An axis with its range in coordinates, which are values in units of a power of ten, or their decimal logarithms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ruler {
    scale: Scale,
    /// The power of ten that is left out of the labels.
    pub(super) power: i32,
    pub(super) low: f64,
    pub(super) high: f64,
    /// Whether all values are whole numbers; there are no ticks between them then.
    is_whole: bool,
}

impl Ruler {
    /// The axis for some values, with a margin that is a part of their range. Values that cannot be drawn are ignored.
    pub(super) fn over(scale: Scale, values: impl Iterator<Item = f64>, room: f64) -> Self {
        let bare = Ruler { scale, power: 0, low: 0.0, high: 1.0, is_whole: false };
        let drawn: Vec<f64> = values.filter_map(|value| bare.coordinate(value)).collect();
        let Some(low) = drawn.iter().copied().reduce(f64::min) else { return bare };
        let high = drawn.iter().copied().fold(low, f64::max);
        let is_whole = scale == Scale::Linear && drawn.iter().all(|value| value.fract() == 0.0);
        // A constant is drawn as a level line, without its rounding noise.
        let least = match scale {
            Scale::Linear if is_whole => 2.0,
            Scale::Linear => (0.01 * low.abs().max(high.abs())).max(1e-300),
            Scale::Log => 0.3,
        };
        let middle = 0.5 * low + 0.5 * high;
        let span = (high - low).max(least);
        let half = if high - low < least { (0.5 + room.max(0.06)) * span } else { (0.5 + room) * span };
        bare.with_range(middle - half, middle + half, is_whole)
    }

    /// The axis in units with short labels.
    fn with_range(self, low: f64, high: f64, is_whole: bool) -> Self {
        let power = low.abs().max(high.abs()).log10().floor() as i32;
        let power = if self.scale == Scale::Log || (-3..5).contains(&power) { 0 } else { power };
        let unit = 10f64.powi(power);
        Ruler { power, low: low / unit, high: high / unit, is_whole: is_whole && power == 0, ..self }
    }

    /// Coordinate of a value; `None` if it cannot be drawn.
    pub(super) fn coordinate(&self, value: f64) -> Option<f64> {
        let coordinate = match self.scale {
            Scale::Linear => value / 10f64.powi(self.power),
            Scale::Log if value > 0.0 => value.log10(),
            Scale::Log => return None,
        };
        // Differences of these coordinates are finite.
        (coordinate.abs() <= 1e300).then_some(coordinate)
    }

    /// Value of a coordinate.
    pub(super) fn value(&self, coordinate: f64) -> f64 {
        match self.scale {
            Scale::Linear => coordinate * 10f64.powi(self.power),
            Scale::Log => 10f64.powf(coordinate),
        }
    }

    fn linear_ticks(&self) -> Vec<f64> {
        let ticks = RangedCoordf64::from(self.low..self.high).key_points(6);
        // The ticks of plotters have the rounding errors of a sum.
        let round = 1e-6 * 10f64.powf((self.high - self.low).log10().floor());
        let ticks = ticks.into_iter().map(|tick| (tick / round).round() * round);
        ticks.filter(|tick| !self.is_whole || (tick - tick.round()).abs() < round).collect()
    }

    /// First digits of labelled values; with few decades, there are labels inside them.
    fn digits(&self) -> &'static [i32] {
        match self.high - self.low {
            decades if decades < 0.75 => &[1, 2, 3, 4, 5, 6, 8],
            decades if decades < 1.6 => &[1, 2, 5],
            _ => &[1],
        }
    }

    /// Number of decades from label to label.
    fn every(&self) -> i32 {
        ((self.high - self.low) / 8.0).ceil().max(1.0) as i32
    }

    fn log_ticks(&self, digits: &[i32]) -> Vec<f64> {
        let powers =
            (self.low.floor() as i32..=self.high.ceil() as i32).filter(|p| p.rem_euclid(self.every()) == 0);
        let ticks =
            powers.flat_map(|power| digits.iter().map(move |&d| f64::from(power) + f64::from(d).log10()));
        ticks.filter(|tick| (self.low - 1e-9..=self.high + 1e-9).contains(tick)).collect()
    }

    fn between(&self) -> Vec<f64> {
        if self.every() > 1 { Vec::new() } else { self.log_ticks(&[2, 3, 4, 5, 6, 7, 8, 9]) }
    }

    /// Number of digits that the ticks need.
    fn decimals(&self) -> usize {
        let ticks = self.linear_ticks();
        let is_shown =
            |n: &i32| ticks.iter().all(|tick| ((tick * 10f64.powi(*n)).fract().abs() - 0.5).abs() > 0.499);
        (0..6).find(is_shown).unwrap_or(6) as usize
    }
}

/// The axis for plotters.
impl Ranged for Ruler {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, coordinate: &f64, limit: (i32, i32)) -> i32 {
        RangedCoordf64::from(self.range()).map(coordinate, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        match (self.scale, hint.weight().allow_light_points()) {
            (Scale::Linear, _) => self.linear_ticks(),
            (Scale::Log, true) => self.between(),
            (Scale::Log, false) => self.log_ticks(self.digits()),
        }
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Ruler {
    fn format(coordinate: &f64) -> String {
        coordinate.to_string()
    }

    fn format_ext(&self, coordinate: &f64) -> String {
        match self.scale {
            Scale::Linear => format!("{:.*}", self.decimals(), coordinate + 0.0).replace('-', "−"),
            Scale::Log => log_label(*coordinate),
        }
    }
}

fn log_label(coordinate: f64) -> String {
    let power = (coordinate + 1e-9).floor() as i32;
    let digit = 10f64.powf(coordinate - f64::from(power)).round();
    match power {
        -2..=2 => format!("{:.*}", (-power).max(0) as usize, digit * 10f64.powi(power)),
        _ if digit == 1.0 => format!("10{}", superscript(power)),
        _ => format!("{digit}×10{}", superscript(power)),
    }
}

/// A whole number in superscript digits.
pub(crate) fn superscript(number: i32) -> String {
    let raised = |c: char| match c.to_digit(10) {
        Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
        None => '⁻',
    };
    number.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use plotters::coord::ranged1d::BoldPoints;

    use super::*;

    fn labels(scale: Scale, low: f64, high: f64) -> Vec<String> {
        let ruler = Ruler::over(scale, [low, high].into_iter(), 0.0);
        ruler.key_points(BoldPoints(9)).iter().map(|tick| ruler.format_ext(tick)).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels(Scale::Linear, 0.0, 4.0), ["0", "1", "2", "3", "4"]);
        assert_eq!(labels(Scale::Linear, 3.0, 5.0), ["3", "4", "5"]);
        assert_eq!(labels(Scale::Linear, -0.25, 0.25), ["−0.2", "−0.1", "0.0", "0.1", "0.2"]);
        assert_eq!(labels(Scale::Linear, 0.0, 5e6), ["0", "1", "2", "3", "4", "5"]);
        assert_eq!(labels(Scale::Log, 1e-6, 1e-3), ["10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³"]);
        assert_eq!(labels(Scale::Log, 0.01, 0.1), ["0.01", "0.02", "0.05", "0.1"]);
        assert_eq!(labels(Scale::Log, 1e-16, 1.0).len(), 9);
        assert_eq!(labels(Scale::Log, 1e-20, 1e-17).len(), 4);
    }

    #[test]
    fn nothing_to_show_still_has_an_axis() {
        assert!(labels(Scale::Linear, f64::NAN, f64::NAN).len() > 1);
        assert!(!labels(Scale::Log, f64::NAN, -1.0).is_empty());
        let level = Ruler::over(Scale::Linear, [5500.0, 5500.0].into_iter(), 0.0);
        assert_eq!(level.coordinate(5500.0), Some(0.5 * (level.low + level.high)));
    }
}
