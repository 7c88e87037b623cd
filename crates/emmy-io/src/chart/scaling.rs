//! From values to places on an axis, and the ticks of it.

use super::Scale;

/// An axis with its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scaling {
    scale: Scale,
    /// Ends of the range: values, or their decadic logarithms.
    low: f64,
    high: f64,
    /// Whether all values are whole numbers: there are no ticks between them.
    is_whole: bool,
}

/// A tick; minor ones have no label.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    /// Place, 0 at the lower and 1 at the upper end of the axis.
    pub(super) at: f64,
    pub(super) label: Option<String>,
}

impl Scaling {
    /// The axis that holds all values, with some room around them. Values that cannot be drawn do not count.
    pub(super) fn over(scale: Scale, values: impl Iterator<Item = f64>, room: f64) -> Self {
        let drawn: Vec<f64> = values.filter_map(|value| coordinate(scale, value)).collect();
        let is_whole = scale == Scale::Linear && drawn.iter().all(|value| value.fract() == 0.0);
        let (low, high) =
            (drawn.iter()).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        // What does not change is shown as a level line, not as noise.
        let least = match scale {
            Scale::Linear if is_whole => 2.0,
            Scale::Linear => (0.01 * low.abs().max(high.abs())).max(1e-300),
            Scale::Log => 0.3,
        };
        let (middle, span) = (low + (high - low) / 2.0, (high - low).max(least));
        let half = (0.5 + room) * span;
        let (low, high) = match high - low < least || room > 0.0 {
            true => (middle - half, middle + half),
            false => (low, high),
        };
        Scaling { scale, low, high, is_whole }
    }

    /// Place of a value on the axis, 0 to 1 within the range; none if it cannot be drawn.
    pub(super) fn place(&self, value: f64) -> Option<f64> {
        coordinate(self.scale, value).map(|v| self.at(v))
    }

    fn at(&self, coordinate: f64) -> f64 {
        (coordinate - self.low) / (self.high - self.low)
    }

    /// Coordinate (the logarithm on a logarithmic axis) of a value.
    pub(super) fn coordinate(&self, value: f64) -> Option<f64> {
        coordinate(self.scale, value)
    }

    /// Coordinate of a place on the axis.
    pub(super) fn coordinate_at(&self, place: f64) -> f64 {
        self.low + place * (self.high - self.low)
    }

    /// Value of a coordinate.
    pub(super) fn value(&self, coordinate: f64) -> f64 {
        match self.scale {
            Scale::Linear => coordinate,
            Scale::Log => 10f64.powf(coordinate),
        }
    }

    /// Ticks, and the power of ten that their labels leave out.
    pub(super) fn ticks(&self) -> (Vec<Tick>, Option<i32>) {
        match self.scale {
            Scale::Linear => self.linear_ticks(),
            Scale::Log => (self.log_ticks(), None),
        }
    }

    fn linear_ticks(&self) -> (Vec<Tick>, Option<i32>) {
        let step = round_step((self.high - self.low) / 5.0).max(if self.is_whole { 1.0 } else { 0.0 });
        let (first, last) = ((self.low / step).ceil() as i64, (self.high / step).floor() as i64);
        let largest = self.low.abs().max(self.high.abs());
        let power = largest.log10().floor() as i32;
        let power = if (-3..5).contains(&power) { None } else { Some(power) };
        let unit = 10f64.powi(power.unwrap_or(0));
        let decimals = (-(step / unit).log10().floor()).clamp(0.0, 12.0) as usize;
        let label = |value: f64| format!("{:.decimals$}", value / unit + 0.0).replace('-', "−");
        let tick = |i: i64| {
            let value = i as f64 * step;
            Tick { at: self.at(value), label: Some(label(value)) }
        };
        ((first..=last).take(20).map(tick).collect(), power)
    }

    fn log_ticks(&self) -> Vec<Tick> {
        let decades = self.high - self.low;
        // Labels at every n-th decade, or within the decades if there are few.
        let every = (decades / 8.0).ceil().max(1.0) as i32;
        let within: &[i32] = match decades {
            d if d < 0.75 => &[1, 2, 3, 4, 5, 6, 8],
            d if d < 1.6 => &[1, 2, 5],
            _ => &[1],
        };
        let (first, last) = (self.low.floor() as i32, self.high.ceil() as i32);
        let mut ticks = Vec::new();
        for power in first..=last {
            for digit in 1..=9 {
                let at = self.at(f64::from(power) + f64::from(digit).log10());
                let is_labelled = within.contains(&digit) && power.rem_euclid(every) == 0;
                let is_drawn = digit == 1 || every == 1;
                if (-1e-9..=1.0 + 1e-9).contains(&at) && is_drawn {
                    ticks.push(Tick { at, label: is_labelled.then(|| log_label(digit, power)) });
                }
            }
        }
        ticks
    }
}

fn coordinate(scale: Scale, value: f64) -> Option<f64> {
    let coordinate = match scale {
        Scale::Linear => value,
        Scale::Log if value > 0.0 => value.log10(),
        Scale::Log => return None,
    };
    coordinate.is_finite().then_some(coordinate)
}

/// 1, 2 or 5 times a power of ten, not less than a length.
fn round_step(length: f64) -> f64 {
    let power = 10f64.powf(length.log10().floor());
    let part = length / power;
    let round = [1.0, 2.0, 5.0, 10.0].into_iter().find(|&r| part <= r * (1.0 + 1e-9)).unwrap_or(10.0);
    round * power
}

fn log_label(digit: i32, power: i32) -> String {
    match (digit, power) {
        (_, -2..=2) => {
            let value = f64::from(digit) * 10f64.powi(power);
            format!("{value:.*}", (-power).max(0) as usize)
        }
        (1, _) => format!("10{}", superscript(power)),
        _ => format!("{digit}×10{}", superscript(power)),
    }
}

/// A whole number in raised digits.
pub(super) fn superscript(number: i32) -> String {
    let raised = |c: char| match c.to_digit(10) {
        Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
        None => '⁻',
    };
    number.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, low: f64, high: f64) -> Vec<String> {
        let (ticks, _) = Scaling::over(scale, [low, high].into_iter(), 0.0).ticks();
        assert!(ticks.iter().all(|tick| (-1e-6..=1.0 + 1e-6).contains(&tick.at)));
        ticks.into_iter().filter_map(|tick| tick.label).collect()
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
    }

    #[test]
    fn nothing_to_show_still_has_an_axis() {
        for scale in [Scale::Linear, Scale::Log] {
            let scaling = Scaling::over(scale, [f64::NAN].into_iter(), 0.05);
            assert!(!scaling.ticks().0.is_empty());
        }
        let level = Scaling::over(Scale::Linear, [5500.0, 5500.0].into_iter(), 0.0);
        assert_eq!(level.place(5500.0), Some(0.5));
    }
}
