//! The same equilibrium by another code: felupe 11.3 on the same mesh (`tests/felupe/block.py`).

use emmy::body::{Body, Load, Region, Support};
use emmy::material::NeoHooke;
use emmy::mesh::block;

use super::{displacement, equilibrium};

#[test]
fn a_block_under_dead_traction_and_follower_pressure() {
    let body = Body::builder(block([4.0, 1.0, 1.0], [8, 2, 2]).unwrap())
        .region(Region::new(NeoHooke::new(60.0, 30.0).unwrap(), 1.0))
        .support(Support::fixed("x-min"))
        .load(Load::traction("x-max", [0.5, 0.3, 0.8]))
        .load(Load::pressure("z-max", 0.4))
        .build()
        .unwrap();
    let state = equilibrium(&body, 5);
    let corners = [
        ([4.0, 0.0, 0.0], [0.156823506039, 0.626976887421, 0.376489677623]),
        ([4.0, 1.0, 0.0], [-0.051339230745, 0.599277254637, 0.366909837765]),
        ([4.0, 0.0, 1.0], [-0.032747354255, 0.591514674637, 0.351290384179]),
        ([4.0, 1.0, 1.0], [-0.242839288582, 0.570598308467, 0.343418207671]),
    ];
    for (corner, expected) in corners {
        let found = displacement(&body, &state, corner);
        let error = (0..3).map(|d| (found[d] - expected[d]).abs()).fold(0.0, f64::max);
        assert!(error < 1e-9, "{corner:?}: {found:?}, {error:e}");
    }
    let energy = body.strain_energy(&state.displacement);
    assert!((energy - 0.137513611979).abs() < 1e-9, "{energy}");
}
