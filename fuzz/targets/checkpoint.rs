//! Any bytes as a checkpoint: a resumed motion or an error, never a panic. The target sets valid checksums, which no
//! fuzzer would find; another test checks wrong ones.

#![no_main]

use std::sync::LazyLock;

use emmy::body::{Body, Region};
use emmy::material::NeoHooke;
use emmy::mesh;
use emmy::motion::{Motion, NewtonSettings};
use emmy::time::{NewmarkFamily, Scheme, TimeElement};
use emmy_io::checkpoint;
use libfuzzer_sys::fuzz_target;

/// The body of `corpus/checkpoint`: one cell.
static BODY: LazyLock<Body> = LazyLock::new(|| {
    let cell = mesh::block([1.0; 3], [1; 3]).expect("a cell");
    let rubber = NeoHooke::new(1000.0, 500.0).expect("a material");
    Body::builder(cell).region(Region::new(rubber, 2.0)).build().expect("a body")
});

fuzz_target!(|bytes: &[u8]| {
    let Ok(checkpoint) = checkpoint::parse(&checkpoint::sealed(bytes.to_vec())) else { return };
    let settings = NewtonSettings::default();
    let newmark = NewmarkFamily::Newmark { beta: 0.25, gamma: 0.5 };
    for scheme in [Scheme::from(TimeElement::SIMO_TARNOW), newmark.into()] {
        if let Ok(mut motion) = Motion::resumed(&BODY, scheme, settings, checkpoint.snapshot.clone()) {
            let _ = motion.step(0.01);
        }
    }
});
