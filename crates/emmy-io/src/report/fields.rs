//! The quantities that give colours to a surface.

/// A nodal quantity for colouring.
#[derive(Debug)]
pub(super) struct ColourField {
    pub(super) name: &'static str,
    pub(super) label: &'static str,
    /// Array in the frames, and its number of components.
    pub(super) array: (&'static str, usize),
    /// Value at a node from its components.
    pub(super) value: fn(&[f64]) -> f64,
    /// The value that a picture of a run shows.
    pub(super) extreme: Extreme,
}

impl ColourField {
    /// Whether zero has the middle colour.
    pub(super) fn is_signed(&self) -> bool {
        self.extreme == Extreme::Absolute
    }
}

/// The value of a quantity that is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Extreme {
    Largest,
    Smallest,
    /// The largest without its sign.
    Absolute,
}

impl Extreme {
    /// Name in a picture.
    pub(super) fn name(self) -> &'static str {
        match self {
            Extreme::Largest => "largest value",
            Extreme::Smallest => "smallest value",
            Extreme::Absolute => "largest |value|",
        }
    }

    /// Number that is largest for the value that is looked for.
    pub(super) fn weight(self, value: f64) -> f64 {
        match self {
            Extreme::Largest => value,
            Extreme::Smallest => -value,
            Extreme::Absolute => value.abs(),
        }
    }
}

/// The displacement, which all frames of a page have.
pub(super) static MOTION: ColourField = ColourField {
    name: "displacement",
    label: "displacement |u|",
    array: ("displacement", 3),
    value: norm,
    extreme: Extreme::Largest,
};

/// Quantities for colouring besides the displacement.
pub(super) static FIELDS: [ColourField; 8] = [
    ColourField {
        name: "von_mises_stress",
        label: "von Mises stress",
        array: ("von_mises_stress", 1),
        value: |numbers| numbers[0],
        extreme: Extreme::Largest,
    },
    ColourField {
        name: "strain_energy_density",
        label: "strain energy density",
        array: ("strain_energy_density", 1),
        value: |numbers| numbers[0],
        extreme: Extreme::Largest,
    },
    ColourField {
        name: "speed",
        label: "speed |v|",
        array: ("velocity", 3),
        value: norm,
        extreme: Extreme::Largest,
    },
    ColourField {
        name: "mean_stress",
        label: "mean stress tr \u{3c3} / 3",
        array: ("cauchy_stress", 6),
        value: |numbers| (numbers[0] + numbers[1] + numbers[2]) / 3.0,
        extreme: Extreme::Absolute,
    },
    ColourField {
        name: "largest_stretch",
        label: "largest principal stretch",
        array: ("principal_stretches", 3),
        value: |numbers| numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        extreme: Extreme::Largest,
    },
    ColourField {
        name: "largest_stretch",
        label: "largest principal stretch",
        array: ("largest_stretch", 1),
        value: |numbers| numbers[0],
        extreme: Extreme::Largest,
    },
    ColourField {
        name: "smallest_stretch",
        label: "smallest principal stretch",
        array: ("principal_stretches", 3),
        value: |numbers| numbers.iter().copied().fold(f64::INFINITY, f64::min),
        extreme: Extreme::Smallest,
    },
    ColourField {
        name: "contact_pressure",
        label: "contact pressure",
        array: ("contact_pressure", 1),
        value: |numbers| numbers[0],
        extreme: Extreme::Largest,
    },
];

fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|v| v * v).sum::<f64>().sqrt()
}
