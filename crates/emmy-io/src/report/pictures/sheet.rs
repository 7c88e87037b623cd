//! Everything around a body in a picture: titles, the bar of the colours with the extreme value, and the axes.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::camera::Window;
use super::colours::Scale;
use super::raster::SAMPLES;
use crate::chart::superscript;
use crate::picture::{self, Area, Drawn, INK, PIXELS, stroke, text, units, width, writing};
use crate::vector::Vector;
use emmy::internals::number::short;

// Sizes in points.
const WIDTH: f64 = 640.0;
const HEIGHTS: [f64; 2] = [380.0, 480.0];
const MARGIN: f64 = 12.0;
/// Lower end of the titles.
const HEAD: f64 = 54.0;
/// Width of the column with the bar.
const COLUMN: f64 = 122.0;
const BAR: f64 = 15.0;
/// Height below the bar, for the extreme value and the axes.
const FOOT: f64 = 156.0;
const TITLE: f64 = 14.0;
const TEXT: f64 = 11.5;

const GREY: RGBColor = RGBColor(0x66, 0x6c, 0x74);
/// Colours of the axes.
const AXES: [RGBColor; 3] =
    [RGBColor(0xc9, 0x3a, 0x2f), RGBColor(0x2a, 0x8a, 0x3e), RGBColor(0x1f, 0x5f, 0xbf)];

/// A picture without its body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sheet<'a> {
    /// Title of the run; may be empty.
    pub(super) title: &'a str,
    /// Quantity and time.
    pub(super) caption: &'a str,
    /// Height in points.
    pub(super) height: f64,
    /// Axes of the observer.
    pub(super) axes: [Vector; 3],
    /// The colours, if there are any.
    pub(super) key: Option<Key<'a>>,
}

/// The meaning of the colours.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Key<'a> {
    pub(super) scale: &'a Scale,
    /// Unit of the values; may be empty.
    pub(super) unit: &'a str,
    /// Name of the extreme value, and the value.
    pub(super) extreme: (&'a str, f64),
    /// Its place in samples, and whether the body hides it.
    pub(super) mark: ([f64; 2], bool),
}

/// Height in points of a picture of bodies with a ratio of height to width.
pub(super) fn height(ratio: f64) -> f64 {
    // A point alone has no ratio.
    let ratio = if ratio.is_nan() { 0.0 } else { ratio };
    let fitting = HEAD + MARGIN + ratio * (WIDTH - COLUMN - MARGIN);
    // An even number of points is a whole number of pixels.
    2.0 * (0.5 * fitting.clamp(HEIGHTS[0], HEIGHTS[1])).round()
}

/// Size in pixels of a picture of a height in points.
pub(super) fn size(height: f64) -> [usize; 2] {
    [WIDTH, height].map(|points| (points * f64::from(PIXELS)) as usize)
}

/// Where the body is in a picture of a height in points.
pub(super) fn window(height: f64) -> Window {
    let samples = |points: f64| points * f64::from(PIXELS) * SAMPLES as f64;
    let size = [WIDTH - COLUMN - 2.0 * MARGIN, height - HEAD - MARGIN];
    Window { start: [samples(MARGIN), samples(HEAD)], size: size.map(samples) }
}

/// A number with four digits.
pub(super) fn four_digits(value: f64) -> String {
    resolved(value, f64::INFINITY)
}

/// A number with as many digits as tell it from another one at a distance, at least four.
fn resolved(value: f64, distance: f64) -> String {
    let digits = (value.abs() / distance).log10().ceil().clamp(3.0, 15.0) as usize;
    format!("{value:.digits$e}").parse().map_or_else(|_| value.to_string(), |value: f64| short(value))
}

impl Sheet<'_> {
    /// The sheet as SVG without ground.
    pub(super) fn svg(&self) -> String {
        picture::overlay((WIDTH, self.height), |area| self.draw(area))
    }

    fn draw(&self, area: &Area<'_>) -> Drawn {
        let at = |x: f64, y: f64| (units(x), units(y));
        let caption = if self.title.is_empty() { 0.5 * HEAD } else { 0.68 * HEAD };
        let small = writing(TEXT).color(&GREY);
        text(area, &cut(self.title, &small), &small, HPos::Left, at(MARGIN, 0.3 * HEAD))?;
        text(area, &cut(self.caption, &writing(TITLE)), &writing(TITLE), HPos::Left, at(MARGIN, caption))?;
        self.draw_axes(area)?;
        self.key.as_ref().map_or(Ok(()), |key| key.draw(area, self.height))
    }

    /// The axes in the lower right corner, the nearest last.
    fn draw_axes(&self, area: &Area<'_>) -> Drawn {
        const LENGTH: f64 = 26.0;
        let [right, up, towards] = self.axes;
        let middle = [WIDTH - 0.5 * COLUMN, self.height - MARGIN - 1.5 * LENGTH];
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| towards[a].total_cmp(&towards[b]));
        for axis in order {
            let at =
                |length: f64| (units(middle[0] + length * right[axis]), units(middle[1] - length * up[axis]));
            area.draw(&PathElement::new(vec![at(0.0), at(LENGTH)], stroke(AXES[axis], 1.8)))?;
            // The name of an axis that points at the observer would cover the others.
            if right[axis].hypot(up[axis]) > 0.2 {
                let style = writing(TEXT).color(&AXES[axis]);
                text(area, ["x", "y", "z"][axis], &style, HPos::Center, at(1.38 * LENGTH))?;
            }
        }
        Ok(())
    }
}

impl Key<'_> {
    fn draw(&self, area: &Area<'_>, height: f64) -> Drawn {
        let left = WIDTH - COLUMN + 8.0;
        let [top, bottom] = [HEAD + 26.0, height - FOOT];
        let (power, step) = divisions(self.scale.low, self.scale.high);
        let unit = if power == 0 {
            self.unit.to_string()
        } else {
            format!("×10{} {}", superscript(power), self.unit)
        };
        text(area, unit.trim_end(), &writing(TEXT), HPos::Left, (units(left), units(HEAD + 8.0)))?;
        let at = |part: f64| units(bottom + part * (top - bottom));
        for i in 0..256 {
            let [low, high] = [i, i + 1].map(|i| f64::from(i) / 256.0);
            let middle = self.scale.low + (low + 0.5 / 256.0) * (self.scale.high - self.scale.low);
            let [red, green, blue] = self.scale.colour(middle);
            // Neighbours overlap, so that no ground is seen between them.
            let corners = [(units(left), at(high)), (units(left + BAR), at((low - 0.004).max(0.0)))];
            area.draw(&Rectangle::new(corners, RGBColor(red, green, blue).filled()))?;
        }
        area.draw(&Rectangle::new([(units(left), at(1.0)), (units(left + BAR), at(0.0))], stroke(INK, 0.6)))?;
        for tick in ticks(self.scale.low, self.scale.high, step) {
            let y = at(self.scale.part(tick));
            let line = [left + BAR, left + BAR + 4.0].map(|x| (units(x), y));
            area.draw(&PathElement::new(line, stroke(INK, 0.6)))?;
            let scale = 10f64.powi(power);
            let number = resolved(tick / scale, step / scale).replace('-', "\u{2212}");
            text(area, &number, &writing(TEXT), HPos::Left, (units(left + BAR + 7.0), y))?;
        }
        self.draw_extreme(area, step, [left, bottom + 24.0])
    }

    /// The extreme value below the bar, and its mark on the body.
    fn draw_extreme(&self, area: &Area<'_>, step: f64, [left, top]: [f64; 2]) -> Drawn {
        let (name, value) = self.extreme;
        let (place, is_hidden) = self.mark;
        let points = place.map(|samples| samples / (f64::from(PIXELS) * SAMPLES as f64));
        let colour = if is_hidden { GREY } else { INK };
        for [x, y] in [points, [left + 5.0, top]] {
            if x.is_finite() && y.is_finite() {
                area.draw(&Circle::new((units(x), units(y)), units(4.6), stroke(WHITE, 3.6)))?;
                area.draw(&Circle::new((units(x), units(y)), units(4.6), stroke(colour, 1.5)))?;
            }
        }
        let value = format!("{} {}", resolved(value, 0.05 * step).replace('-', "\u{2212}"), self.unit);
        let rows = [name, value.trim_end(), if is_hidden { "out of sight" } else { "" }];
        for (i, row) in rows.into_iter().enumerate() {
            let at = (units(left + 14.0), units(top + 15.0 * i as f64));
            let style = if i == 2 { writing(TEXT).color(&GREY) } else { writing(TEXT) };
            text(area, row, &style, HPos::Left, at)?;
        }
        Ok(())
    }
}

/// The beginning of a text that has room in a picture.
fn cut(whole: &str, style: &TextStyle<'_>) -> String {
    // XML has no control characters.
    let whole: String = whole.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let has_room = |text: &str| width(text, style) <= units(WIDTH - 2.0 * MARGIN);
    if has_room(&whole) {
        return whole;
    }
    let ends = whole.char_indices().map(|(end, _)| format!("{}…", &whole[..end]));
    ends.take_while(|text| has_room(text)).last().unwrap_or_default()
}

/// Power of ten left out of the labels of a range, and distance of its ticks: 1, 2 or 5 times a power of ten.
fn divisions(low: f64, high: f64) -> (i32, f64) {
    let magnitude = |x: f64| 10f64.powi(x.log10().floor() as i32);
    let wanted = (high - low) / 6.0;
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|n| n * magnitude(wanted))
        .into_iter()
        .find(|&step| step >= wanted * (1.0 - 1e-9));
    let power = low.abs().max(high.abs()).log10().floor() as i32;
    (if (-3..5).contains(&power) { 0 } else { power }, step.unwrap_or(f64::NAN))
}

/// Multiples of a step in a range.
fn ticks(low: f64, high: f64, step: f64) -> Vec<f64> {
    let [first, last] = [(low / step - 1e-9).ceil(), (high / step + 1e-9).floor()];
    let is_resolved = last - first < 20.0 && first.abs().max(last.abs()) < 1e9;
    if !is_resolved {
        return vec![low, high];
    }
    (0..=(last - first) as usize).map(|i| (first + i as f64) * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_large_numbers_leave_a_power_out() {
        let labels = |low: f64, high: f64| {
            let (power, step) = divisions(low, high);
            let scale = 10f64.powi(power);
            let labels = ticks(low, high, step).into_iter().map(|tick| resolved(tick / scale, step / scale));
            (power, labels.collect::<Vec<_>>().join(" "))
        };
        assert_eq!(labels(0.0, 1.0), (0, "0 0.2 0.4 0.6 0.8 1".into()));
        assert_eq!(labels(-7.3, 7.3), (0, "-5 0 5".into()));
        assert_eq!(labels(1.2e6, 4.9e6), (6, "2 3 4".into()));
        assert_eq!(labels(0.98, 1.021), (0, "0.98 0.99 1 1.01 1.02".into()));
        assert_eq!(labels(-3e-5, 0.0), (-5, "-3 -2.5 -2 -1.5 -1 -0.5 0".into()));
        assert_eq!(labels(1.0, 1.00035).1, "1 1.0001 1.0002 1.0003");
        assert_eq!(labels(1.0, 1.0 + 1e-14).1, "1 1");
    }

    #[test]
    fn titles_are_cut_where_the_picture_ends() {
        assert_eq!(cut("a \u{1} b", &writing(TITLE)), "a   b");
        let long = cut(&"word ".repeat(100), &writing(TITLE));
        assert!(long.ends_with('…') && (50..110).contains(&long.chars().count()), "{long}");
    }

    #[test]
    fn flat_bodies_have_lower_pictures() {
        assert_eq!([0.1, 0.7, 5.0, f64::INFINITY, f64::NAN].map(height).map(size)[0], [1600, 950]);
        assert_eq!([0.9, 5.0, f64::INFINITY].map(height), [480.0; 3]);
        assert!((380.0..480.0).contains(&height(0.75)) && height(f64::NAN).is_finite());
    }
}
