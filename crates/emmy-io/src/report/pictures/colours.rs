//! The colour maps of the page (`assets/scripts/colours.js`).

/// Colours of a map at equal distances.
type Stops = [u32; 17];

/// Viridis (Smith and van der Walt 2015, CC0).
const VIRIDIS: Stops = [
    0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26828e, 0x21918c, 0x1fa088,
    0x28ae80, 0x3fbc73, 0x5ec962, 0x84d44b, 0xaddc30, 0xd8e219, 0xfde725,
];

/// The diverging map of Moreland (2009), for signed fields.
const DIVERGING: Stops = [
    0x3b4cc0, 0x4e68d8, 0x6282ea, 0x779af7, 0x8db0fe, 0xa3c2fe, 0xb9d0f9, 0xccd9ed, 0xdddcdc, 0xecd3c5,
    0xf5c4ac, 0xf7b093, 0xf4987a, 0xeb7d62, 0xdd5f4b, 0xca3b37, 0xb40426,
];

/// Colour of a value that is not a number, and of bodies without values.
pub(super) const GREY: [u8; 3] = [0xc4, 0xc8, 0xcc];

/// A map with the range of values that its colours span.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scale {
    pub(super) low: f64,
    pub(super) high: f64,
    colours: Vec<[u8; 3]>,
}

impl Scale {
    /// The scale of some values: from the least to the largest, or for signed ones around zero.
    pub(super) fn of(values: &[f64], is_signed: bool) -> Self {
        let finite = values.iter().copied().filter(|value| value.is_finite());
        let (low, high) = finite
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        let most = low.abs().max(high.abs());
        // As that of the page, it is never empty.
        let (low, high) = match is_signed {
            _ if low > high => (0.0, 1.0),
            true if most > 0.0 => (-most, most),
            _ if high > low => (low, high),
            _ => (low, low + if low == 0.0 { 1.0 } else { low.abs() }),
        };
        Scale { low, high, colours: colours(if is_signed { DIVERGING } else { VIRIDIS }) }
    }

    /// Place of a value between the ends, 0 and 1.
    pub(super) fn part(&self, value: f64) -> f64 {
        // Halves, because the difference of two finite numbers may be infinite.
        (0.5 * value - 0.5 * self.low) / (0.5 * self.high - 0.5 * self.low)
    }

    /// Colour of a value.
    pub(super) fn colour(&self, value: f64) -> [u8; 3] {
        match self.part(value) {
            part if part.is_nan() => GREY,
            part => self.colours[(part.clamp(0.0, 1.0) * 255.0).round() as usize],
        }
    }
}

/// 256 colours of a map.
fn colours(stops: Stops) -> Vec<[u8; 3]> {
    let channel = |stop: usize, shift: u32| f64::from(stops[stop] >> shift & 0xff);
    let colour = |i: u32| {
        let at = f64::from(i) / 255.0 * (stops.len() - 1) as f64;
        let low = (at as usize).min(stops.len() - 2);
        [16, 8, 0].map(|shift| {
            let from = channel(low, shift);
            (from + (at - low as f64) * (channel(low + 1, shift) - from)).round() as u8
        })
    };
    (0..256).map(colour).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_maps_are_those_of_the_page() {
        let script = include_str!("../assets/scripts/colours.js");
        for (name, stops) in [("viridis", VIRIDIS), ("diverging", DIVERGING)] {
            let (_, rest) = script.split_once(&format!("{name}: \"")).unwrap();
            let expected: Vec<u32> = rest
                .split('"')
                .next()
                .unwrap()
                .split(' ')
                .map(|hex| u32::from_str_radix(hex, 16).unwrap())
                .collect();
            assert_eq!(stops[..], expected, "{name}");
        }
    }

    #[test]
    fn colours_span_the_values_and_are_mixed_between_the_stops() {
        let scale = Scale::of(&[2.0, 4.0, f64::NAN, 3.0], false);
        assert_eq!((scale.low, scale.high), (2.0, 4.0));
        assert_eq!([2.0, 4.0].map(|value| scale.colour(value)), [[0x44, 0x01, 0x54], [0xfd, 0xe7, 0x25]]);
        // 128/255 of 16 intervals is 0.0314 of one beyond the ninth stop, 21918c; the tenth is 1fa088.
        assert_eq!(scale.colour(3.0), [0x21, 0x91, 0x8c]);
        assert_eq!((scale.colour(-1.0), scale.colour(f64::NAN)), (scale.colour(2.0), GREY));
        let signed = Scale::of(&[-1.0, 5.0], true);
        // Zero is number 128 of 0 to 255 as well: dddcdc and 0.0314 of the way to ecd3c5.
        assert_eq!((signed.low, signed.high, signed.colour(0.0)), (-5.0, 5.0, [221, 220, 219]));
    }

    #[test]
    fn no_scale_is_empty() {
        let ends = |values: &[f64], is_signed| {
            let scale = Scale::of(values, is_signed);
            (scale.low, scale.high)
        };
        assert_eq!(
            [ends(&[3.0], false), ends(&[0.0; 2], true), ends(&[], true)],
            [(3.0, 6.0), (0.0, 1.0), (0.0, 1.0)]
        );
        assert_eq!(Scale::of(&[-f64::MAX, f64::MAX], false).part(0.0), 0.5);
    }
}
