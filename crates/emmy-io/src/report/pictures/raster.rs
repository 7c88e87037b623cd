//! A canvas for triangles with a depth buffer. Each pixel is the mean of several samples.

/// Samples of a pixel in a row and in a column.
pub(super) const SAMPLES: usize = 2;

const WHITE: [u8; 3] = [255; 3];

/// A corner of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Corner {
    /// Place in samples, to the right and down.
    pub(super) at: [f64; 2],
    /// Reciprocal of the distance from the observer, which is linear on the canvas.
    pub(super) nearness: f64,
    /// The number that is interpolated.
    pub(super) value: f64,
}

/// Samples with the colours of the triangles in front; the ground is white.
#[derive(Debug)]
pub(super) struct Canvas {
    /// Width and height in samples.
    size: [usize; 2],
    nearness: Vec<f32>,
    colours: Vec<[u8; 3]>,
}

impl Canvas {
    /// An empty canvas of a size in pixels.
    pub(super) fn new(size: [usize; 2]) -> Self {
        let size = size.map(|n| n * SAMPLES);
        let n = size[0] * size[1];
        Canvas { size, nearness: vec![0.0; n], colours: vec![WHITE; n] }
    }

    /// Paints a triangle where nothing is nearer. The colour of a sample follows from its value, and from its distances
    /// to the sides opposite to the three corners in samples.
    pub(super) fn fill(&mut self, corners: [Corner; 3], colour: impl Fn(f64, [f64; 3]) -> [u8; 3]) {
        let [a, b, c] = corners.map(|corner| corner.at);
        let area = doubled_area(a, b, c);
        let lengths = [[b, c], [c, a], [a, b]].map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1]));
        let is_finite = corners.iter().all(|corner| corner.nearness.is_finite() && corner.nearness > 0.0);
        if !(area.abs() > 0.0 && area.is_finite() && is_finite) {
            return;
        }
        let [columns, rows] = [0, 1].map(|i| {
            let [low, high] =
                [f64::min, f64::max].map(|end| [b, c].iter().fold(a[i], |most, corner| end(most, corner[i])));
            // Converted to whole numbers, what lies outside is cut off. Samples lie in the middle of their squares.
            let first = (low - 0.5).ceil().max(0.0) as usize;
            first..((high + 0.5).floor().max(0.0) as usize).min(self.size[i])
        });
        for y in rows {
            for x in columns.clone() {
                let at = [x as f64 + 0.5, y as f64 + 0.5];
                let shares = [[b, c], [c, a], [a, b]].map(|[a, b]| doubled_area(a, b, at) / area);
                if shares.iter().any(|&share| share < 0.0) {
                    continue;
                }
                let mean = |of: &dyn Fn(&Corner) -> f64| -> f64 {
                    corners.iter().zip(shares).map(|(corner, share)| share * of(corner)).sum()
                };
                let nearness = mean(&|corner| corner.nearness);
                let sample = y * self.size[0] + x;
                if nearness as f32 <= self.nearness[sample] {
                    continue;
                }
                let value = mean(&|corner| corner.nearness * corner.value) / nearness;
                let distances = [0, 1, 2].map(|k| shares[k] * area.abs() / lengths[k]);
                self.nearness[sample] = nearness as f32;
                self.colours[sample] = colour(value, distances);
            }
        }
    }

    /// Whether something in the middle of a place and its neighbours is clearly nearer than a point there.
    pub(super) fn hides(&self, at: [f64; 2], nearness: f64) -> bool {
        let around = |i: usize| [-2.0, 0.0, 2.0].map(move |offset| (at[i] + offset).floor());
        let is_inside = |at: f64, i: usize| at >= 0.0 && at < self.size[i] as f64;
        let samples = around(1)
            .into_iter()
            .flat_map(|y| around(0).map(|x| [x, y]))
            .filter(|[x, y]| is_inside(*x, 0) && is_inside(*y, 1));
        let mut samples = samples.map(|[x, y]| self.nearness[y as usize * self.size[0] + x as usize]);
        // A point of the surface has the surface beside it at its own distance, or further away.
        samples.all(|sample| f64::from(sample) > nearness * 1.005)
    }

    /// Pixels from left to right and from top to bottom: red, green, blue and 255.
    pub(super) fn pixels(&self) -> Vec<u8> {
        let [width, height] = self.size.map(|n| n / SAMPLES);
        let mut pixels = Vec::with_capacity(4 * width * height);
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let samples = (0..SAMPLES).flat_map(|row| {
                let first = (y * SAMPLES + row) * self.size[0] + x * SAMPLES;
                &self.colours[first..first + SAMPLES]
            });
            let sum = samples.fold([0; 3], |sum, colour| [0, 1, 2].map(|i| sum[i] + u32::from(colour[i])));
            let n = (SAMPLES * SAMPLES) as u32;
            pixels.extend(sum.map(|sum| ((sum + n / 2) / n) as u8));
            pixels.push(255);
        }
        pixels
    }
}

/// Twice the area of a triangle, with a sign.
fn doubled_area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: [u8; 3] = [255, 0, 0];
    const BLUE: [u8; 3] = [0, 0, 255];

    fn corner(x: f64, y: f64, distance: f64, value: f64) -> Corner {
        Corner { at: [x, y], nearness: 1.0 / distance, value }
    }

    fn pixel(canvas: &Canvas, x: usize, y: usize) -> [u8; 3] {
        let at = 4 * (y * canvas.size[0] / SAMPLES + x);
        canvas.pixels()[at..at + 3].try_into().unwrap()
    }

    /// A right triangle with legs of 8 pixels, with a corner of the canvas as its right angle.
    #[test]
    fn a_triangle_covers_the_pixels_inside_and_parts_of_those_at_its_border() {
        for turned in [false, true] {
            let mut canvas = Canvas::new([10, 10]);
            let [a, b, c] = [[0.0, 0.0], [16.0, 0.0], [0.0, 16.0]].map(|[x, y]| corner(x, y, 1.0, 0.0));
            canvas.fill(if turned { [a, c, b] } else { [a, b, c] }, |_, _| RED);
            let pixels = canvas.pixels();
            let all = (0..10).flat_map(|y| (0..10).map(move |x| (x, y)));
            for (x, y) in all {
                // The hypotenuse divides the pixels with x + y = 7; its own samples belong to the triangle.
                let expected = match x + y {
                    ..7 => RED,
                    7 => [255, 64, 64],
                    _ => WHITE,
                };
                assert_eq!(pixels[4 * (10 * y + x)..][..3], expected, "{x} {y}");
            }
        }
    }

    #[test]
    fn the_nearer_triangle_is_seen_whichever_comes_first() {
        let triangle =
            |distance: f64| [[0.0, 0.0], [16.0, 0.0], [0.0, 16.0]].map(|[x, y]| corner(x, y, distance, 0.0));
        for order in [[(1.0, RED), (2.0, BLUE)], [(2.0, BLUE), (1.0, RED)]] {
            let mut canvas = Canvas::new([8, 8]);
            order.iter().for_each(|&(distance, colour)| canvas.fill(triangle(distance), |_, _| colour));
            assert_eq!(pixel(&canvas, 2, 2), RED);
        }
        // Two triangles that pass through each other change places where they meet, at x = 8.
        let mut canvas = Canvas::new([8, 8]);
        let [a, b] = [0.0, 32.0].map(|y| [corner(0.0, y - 8.0, 1.0, 0.0), corner(16.0, y - 8.0, 2.0, 0.0)]);
        canvas.fill([a[0], a[1], b[0]], |_, _| RED);
        canvas.fill(
            triangle(4.0 / 3.0).map(|corner| Corner { at: corner.at.map(|x| 2.0 * x), ..corner }),
            |_, _| BLUE,
        );
        assert_eq!([pixel(&canvas, 1, 1), pixel(&canvas, 6, 1)], [RED, BLUE]);
    }

    #[test]
    fn values_and_distances_in_the_middle_are_those_of_the_place() {
        let mut canvas = Canvas::new([9, 9]);
        // The middle (5.5, 5.5) of a sample is the mean of the corners, and 4 from two of the sides.
        let corners =
            [corner(1.5, 1.5, 1.0, 0.0), corner(13.5, 1.5, 1.0, 60.0), corner(1.5, 13.5, 1.0, 30.0)];
        canvas.fill(corners, |value, [_, left, top]| {
            [value.round() as u8, (10.0 * left).round() as u8, (10.0 * top).round() as u8]
        });
        assert_eq!(canvas.colours[5 * 18 + 5], [30, 40, 40]);
        // In perspective, the point half-way on the canvas is nearer than that half-way in space: of the distances 1
        // and 3 the harmonic mean is 1.5, a quarter of the way.
        let corners =
            [corner(0.5, 0.0, 1.0, 0.0), corner(0.5, 18.0, 1.0, 0.0), corner(16.5, 9.0, 3.0, 200.0)];
        let mut canvas = Canvas::new([9, 9]);
        canvas.fill(corners, |value, _| [value.round() as u8; 3]);
        assert_eq!(canvas.colours[8 * 18 + 8], [50; 3]);
    }

    #[test]
    fn what_lies_behind_is_hidden_and_what_lies_on_the_surface_is_not() {
        let mut canvas = Canvas::new([8, 8]);
        canvas.fill([[0.0, 0.0], [64.0, 0.0], [0.0, 64.0]].map(|[x, y]| corner(x, y, 2.0, 0.0)), |_, _| RED);
        assert!(canvas.hides([8.0, 8.0], 1.0 / 3.0));
        assert!(!canvas.hides([8.0, 8.0], 1.0 / 2.0) && !canvas.hides([8.0, 8.0], 1.0));
    }

    #[test]
    fn triangles_that_cannot_be_drawn_are_left_out() {
        let mut canvas = Canvas::new([4, 4]);
        for bad in [f64::NAN, f64::INFINITY, -1e300, 1e300] {
            canvas.fill(
                [corner(bad, 0.0, 1.0, 0.0), corner(bad, 4.0, 1.0, 0.0), corner(bad, 2.0, 1.0, 0.0)],
                |_, _| RED,
            );
            canvas.fill(
                [corner(0.0, 0.0, bad, 0.0), corner(4.0, 0.0, 1.0, 0.0), corner(0.0, 4.0, 0.0, 0.0)],
                |_, _| RED,
            );
        }
        assert!(canvas.colours.iter().all(|&colour| colour == WHITE));
    }
}
