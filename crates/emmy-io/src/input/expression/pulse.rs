//! Pulses: functions of the time with kinks at given times.

use std::f64::consts::PI;

/// Names of the pulses, with their arguments.
pub(super) const PULSES: [(&str, &[&str]); 4] = [
    ("half_sine", &["t, t1, t2"]),
    ("ramp", &["t, t1, t2"]),
    ("step", &["t, t1", "t, t1, t2"]),
    ("window", &["t, t1, t2", "t, t1, t2, rise"]),
];

/// A pulse, with the times of its kinks.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::input) struct Pulse {
    shape: Shape,
    kinks: Vec<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    /// 1 from the first time on.
    Jump,
    /// A smooth rise from 0 to 1 between two times.
    Rise,
    /// A linear rise.
    Ramp,
    /// 1 between two times.
    Window,
    /// The same with a smooth rise and fall between the four times.
    SmoothWindow,
    /// Half a wave between two times.
    HalfSine,
}

/// `s^3 (10 - 15 s + 6 s^2)` of the part s of a span, whose first two derivatives vanish at both ends.
fn rise(time: f64, from: f64, to: f64) -> [f64; 3] {
    let length = to - from;
    let s = ((time - from) / length).clamp(0.0, 1.0);
    [
        s * s * s * (10.0 + s * (6.0 * s - 15.0)),
        30.0 * (s * (1.0 - s)).powi(2) / length,
        60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (length * length),
    ]
}

impl Pulse {
    /// A pulse by its name and the numbers after the time.
    ///
    /// # Errors
    /// The number that is wrong, if it is one, and the reason.
    pub(super) fn new(name: &str, numbers: &[f64]) -> Result<Self, (Option<usize>, String)> {
        let shape = match (name, numbers.len()) {
            ("step", 1) => Shape::Jump,
            ("step", 2) => Shape::Rise,
            ("ramp", 2) => Shape::Ramp,
            ("window", 2) => Shape::Window,
            ("window", 3) => Shape::SmoothWindow,
            ("half_sine", 2) => Shape::HalfSine,
            _ => {
                let forms = PULSES.iter().find(|(own, _)| *own == name).map_or(&[][..], |(_, forms)| forms);
                let forms = forms.iter().map(|form| format!("{name}({form})")).collect::<Vec<String>>();
                return Err((None, format!("`{name}` is {}", forms.join(" or "))));
            }
        };
        if let [t1, t2, ..] = numbers[..]
            && t2 <= t1
        {
            return Err((Some(1), format!("the end of `{name}` must come after its start")));
        }
        let kinks = match numbers[..] {
            [t1, t2, rise] if !(rise > 0.0 && 2.0 * rise <= t2 - t1) => {
                let reason = format!("rise and fall of `{name}` must be positive and fit between its times");
                return Err((Some(2), reason));
            }
            [t1, t2, rise] => vec![t1, t1 + rise, t2 - rise, t2],
            _ => numbers.to_vec(),
        };
        Ok(Pulse { shape, kinks })
    }

    /// Times of its kinks.
    pub(super) fn kinks(&self) -> &[f64] {
        &self.kinks
    }

    /// Value, rate and second derivative at a time; at a kink, those after it.
    pub(super) fn at(&self, time: f64) -> [f64; 3] {
        const ZERO: [f64; 3] = [0.0; 3];
        const ONE: [f64; 3] = [1.0, 0.0, 0.0];
        let [start, .., end] = self.kinks[..] else { return if time < self.kinks[0] { ZERO } else { ONE } };
        let length = end - start;
        match self.shape {
            _ if time < start => ZERO,
            Shape::Jump => ONE,
            Shape::Rise => rise(time, start, end),
            Shape::Ramp if time >= end => ONE,
            Shape::Ramp => [(time - start) / length, length.recip(), 0.0],
            Shape::Window | Shape::SmoothWindow | Shape::HalfSine if time >= end => ZERO,
            Shape::Window => ONE,
            Shape::SmoothWindow => {
                let (up, down) = (rise(time, start, self.kinks[1]), rise(time, self.kinks[2], end));
                [0, 1, 2].map(|i| up[i] - down[i])
            }
            Shape::HalfSine => {
                let (sin, cos) = (PI * (time - start) / length).sin_cos();
                [sin, cos * PI / length, -sin * (PI / length).powi(2)]
            }
        }
    }
}
