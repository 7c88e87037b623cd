//! A tuning fork of bricks, held at its stem.

use emmy::body::{Body, InitialVelocity, Region, Support};
use emmy::material::NeoHooke;
use emmy::mesh::{CellKind, Mesh, MeshBuilder};
use emmy::motion::{Motion, State};
use emmy::time::Scheme;

/// Cells along x and y of stem, bridge and tines: each half as wide as it is long, all of thickness 1.
const PARTS: [[[usize; 2]; 2]; 4] =
    [[[2, 4], [0, 2]], [[0, 6], [2, 3]], [[0, 2], [3, 13]], [[4, 6], [3, 13]]];

/// Number of cells along x and y, and start of the tines \[length\].
const GRID: [usize; 2] = [6, 13];
const TINES: f64 = 3.0;

/// The fork: two tines of 1 x 10 x 1 on a bridge and a stem, of a period near 1.
pub(super) fn body() -> emmy::Result<Body> {
    // Young's modulus 4e5, Poisson's ratio 0.3.
    let metal = Region::new(NeoHooke::new(230_769.230_769, 153_846.153_846)?, 1.0);
    let held = Support { group: "stem".into(), fix: [true; 3], ..Support::default() };
    Body::builder(mesh()?).region(metal).support(held).build()
}

/// The fork while its tines vibrate against each other in the lowest modes: struck, and then computed through the first
/// periods by Bathe's method, which damps the modes that its steps do not resolve.
pub(super) fn start(body: &Body) -> emmy::Result<State> {
    let swing = |group: &str, rate: f64| InitialVelocity {
        group: Some(group.into()),
        velocity: [-rate * TINES, 0.0, 0.0],
        gradient: [[0.0, rate, 0.0], [0.0; 3], [0.0; 3]],
        ..InitialVelocity::default()
    };
    let struck = State::initial(body, 0.0, &[swing("left", -0.3), swing("right", 0.3)])?;
    let mut motion = Motion::new(body, Scheme::Bathe)?.from(struck)?;
    for _ in 0..200 {
        motion.step(0.05)?;
    }
    Ok(State { time: 0.0, step: 0, ..motion.state().clone() })
}

fn mesh() -> emmy::Result<Mesh> {
    let mut builder = MeshBuilder::new();
    let mut nodes = vec![None; (GRID[0] + 1) * (GRID[1] + 1) * 2];
    let mut groups: [Vec<u32>; 3] = Default::default();
    for (part, [[x0, x1], [y0, y1]]) in PARTS.into_iter().enumerate() {
        for (x, y) in (x0..x1).flat_map(|x| (y0..y1).map(move |y| (x, y))) {
            let corner = |&[dx, dy, z]: &[usize; 3]| {
                let at = ((x + dx) * (GRID[1] + 1) + y + dy) * 2 + z;
                *nodes[at]
                    .get_or_insert_with(|| builder.point([0.5 * (x + dx) as f64, (y + dy) as f64, z as f64]))
            };
            let corners: Vec<u32> = CORNERS.iter().map(corner).collect();
            match (part, y) {
                (0, 0) => groups[0].extend([0, 1, 4, 5].map(|i| corners[i])),
                (2, _) => groups[1].extend(&corners),
                (3, _) => groups[2].extend(&corners),
                _ => {}
            }
            builder.cell(CellKind::Hex8, &corners)?;
        }
    }
    for (name, nodes) in ["stem", "left", "right"].into_iter().zip(groups) {
        builder.node_group(name, nodes);
    }
    builder.build()
}

/// Corners of a brick.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
