//! Finished runs of a small body; attacks damage copies of them.

use crate::emmy::Emmy;
use crate::place::Place;

/// The input, with thirty steps.
pub const INPUT: &str = r#"mesh.box = { size = [1, 2, 1], cells = [1, 2, 1] }
[[region]]
density = 2.0
material.neo-hooke = { lambda = 1000.0, mu = 500.0 }
[[load]]
group = "y-max"
pressure = 30.0
history = [[0.0, 0.0], [0.2, 1.0]]
[initial]
angular_velocity = [0.3, 0.5, 1.0]
[time]
scheme = "DGM"
steps = [{ until = 0.6, size = 0.02 }]
[output]
directory = "run"
every = 5
checkpoint_every = 7
probes = [{ name = "tip", point = [0, 2, 0] }]
"#;

/// Directories `vtu/run` and `vtkhdf/run` of finished runs, each with its input beside it.
#[derive(Debug)]
pub struct Base {
    /// The directory of both.
    pub place: Place,
}

/// Formats of the frames.
pub const FORMATS: [&str; 2] = ["vtu", "vtkhdf"];

impl Base {
    /// Makes the runs.
    ///
    /// # Panics
    /// If a run fails.
    pub fn new(emmy: &Emmy) -> Self {
        let place = Place::new();
        for format in FORMATS {
            place.write(format!("{format}/box.toml"), INPUT);
            let set = format!("output.format={format}");
            let outcome = emmy.call(place.path(format), ["run", "box.toml", "--quiet", "--set", &set]).run();
            assert_eq!(outcome.code, Some(0), "{outcome:?}");
        }
        Base { place }
    }
}
