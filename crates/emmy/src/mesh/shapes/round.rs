//! Shapes of hex8 cells with round surfaces, whose nodes lie on the surface.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_4, TAU};

use super::{CORNERS, check_count, positive};
use crate::error::{Error, Result};
use crate::mesh::{CellKind, Facet, Mesh, MeshBuilder};

/// Fewest cells around a ring: the chords of two would meet in one plane.
pub const FEWEST_AROUND: usize = 3;

/// Ring about the z axis with the base at z = 0, of hex8 cells; groups `body`, `inner`, `outer`, `z-min`, `z-max`.
///
/// `radii`: inner and outer radius, `height` \[length\]; `cells`: number of cells along the radius, around the axis and
/// along it. The nodes of both surfaces lie at the radii and the facets between them are plane. With `n` cells around,
/// the volume is therefore that of the ring times `sin(2 pi / n) / (2 pi / n)`.
///
/// # Errors
/// [`Error::NotPositive`], [`Error::InnerRadius`], [`Error::CellsAround`] below 3, [`Error::TooManyCells`].
///
/// ```
/// let mesh = emmy::mesh::ring([1.0, 2.0], 0.5, [1, 6, 1])?;
/// let area = 0.5 * 6.0 * (2.0_f64.powi(2) - 1.0) * (3.0_f64.sqrt() / 2.0);
/// assert!((emmy::mesh::quality(&mesh).volume - 0.5 * area).abs() < 1e-14);
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn ring(radii: [f64; 2], height: f64, cells: [usize; 3]) -> Result<Mesh> {
    let [inner, outer] = radii;
    positive("inner radius of the ring", inner)?;
    positive("outer radius of the ring", outer)?;
    positive("height of the ring", height)?;
    cells.into_iter().try_for_each(|n| positive("number of ring cells", n as f64))?;
    let [n_radial, n_around, n_along] = cells;
    if inner >= outer {
        return Err(Error::InnerRadius { inner, outer });
    }
    if n_around < FEWEST_AROUND {
        return Err(Error::CellsAround { count: n_around, least: FEWEST_AROUND });
    }
    check_count(cells.map(|n| n as f64).iter().product())?;
    let mut blocks = Blocks::new(move |(_, [i, j, k]): Key| {
        // The last radius is exact.
        let part = i as f64 / n_radial as f64;
        let radius = inner * (1.0 - part) + outer * part;
        let (sine, cosine) = (TAU * j as f64 / n_around as f64).sin_cos();
        [radius * cosine, radius * sine, height * k as f64 / n_along as f64]
    });
    let faces = [(0, "inner"), (1, "outer"), (4, "z-min"), (5, "z-max")];
    blocks.fill(cells, |[i, j, k]| (0, [i, j % n_around, k].map(|at| at as i32)), &faces)?;
    blocks.build()
}

/// Cylinder about the z axis with the base at z = 0, of hex8 cells; groups `body`, `side`, `z-min`, `z-max`.
///
/// `radius`, `height` \[length\]; `cells`: number of cells from the axis to the side, and along the axis. A square core
/// with rounded sides has half of the cells along the radius, rounded up; with `c` of them, `n = 8 c` cells lie around
/// the axis. The nodes of the side lie at the radius and its facets are plane, so the volume is that of the cylinder
/// times `sin(2 pi / n) / (2 pi / n)`.
///
/// # Errors
/// [`Error::NotPositive`], [`Error::TooManyCells`].
///
/// ```
/// let mesh = emmy::mesh::cylinder(1.0, 3.0, [2, 1])?;
/// assert_eq!((mesh.n_cells(), mesh.groups().facets("side")?.len()), (12, 8));
/// assert!((emmy::mesh::quality(&mesh).volume - 3.0 * 8.0_f64.sqrt()).abs() < 1e-14);
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn cylinder(radius: f64, height: f64, cells: [usize; 2]) -> Result<Mesh> {
    positive("radius of the cylinder", radius)?;
    positive("height of the cylinder", height)?;
    cells.into_iter().try_for_each(|n| positive("number of cylinder cells", n as f64))?;
    check_count(cylinder_count(cells))?;
    let [core, layers] = core_and_layers(cells[0]);
    let n_along = cells[1];
    let mut blocks = Blocks::new(move |(layer, [i, j, k]): Key| {
        let [x, y, _] = round_point([core, layers], layer, [i, j, 0]);
        [radius * x, radius * y, height * f64::from(k) / n_along as f64]
    });
    let half = core as i32;
    let core = Core { least: [-half, -half, 0], n_cells: [2 * core, 2 * core, n_along], n_round: 2 };
    blocks.fill_round(&core, layers, "side")?;
    blocks.build()
}

/// Number of cells of a [`cylinder`].
pub fn cylinder_count([n_radial, n_along]: [usize; 2]) -> f64 {
    let [core, layers] = core_and_layers(n_radial).map(|n| n as f64);
    (4.0 * core * core + 8.0 * core * layers) * n_along as f64
}

/// Ball about the origin, of hex8 cells; groups `body`, `surface`.
///
/// `radius` \[length\]; `cells`: number of cells from the centre to the surface. Half of them, rounded up, lie in a
/// cube with rounded sides, the others in layers around it. The nodes of the surface lie at the radius; the volume is
/// smaller than that of the ball by a part of the order `1 / cells^2`.
///
/// # Errors
/// [`Error::NotPositive`], [`Error::TooManyCells`].
///
/// ```
/// let mesh = emmy::mesh::ball(0.5, 4)?;
/// assert_eq!((mesh.n_cells(), mesh.groups().facets("surface")?.len()), (4 * 4 * 4 + 6 * 4 * 4 * 2, 6 * 4 * 4));
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn ball(radius: f64, cells: usize) -> Result<Mesh> {
    positive("radius of the ball", radius)?;
    positive("number of ball cells", cells as f64)?;
    check_count(ball_count(cells))?;
    let [core, layers] = core_and_layers(cells);
    let mut blocks =
        Blocks::new(move |(layer, at): Key| round_point([core, layers], layer, at).map(|x| radius * x));
    let core = Core { least: [-(core as i32); 3], n_cells: [2 * core; 3], n_round: 3 };
    blocks.fill_round(&core, layers, "surface")?;
    blocks.build()
}

/// Number of cells of a [`ball`].
pub fn ball_count(cells: usize) -> f64 {
    let [core, layers] = core_and_layers(cells).map(|n| n as f64);
    8.0 * core.powi(3) + 24.0 * core * core * layers
}

/// Numbers of cells from the middle to the surface: in the core, and in layers around it.
fn core_and_layers(n_radial: usize) -> [usize; 2] {
    let core = n_radial.div_ceil(2);
    [core, n_radial - core]
}

/// Position of a node in the circle or ball of radius 1. `at` counts from the middle of the core, up to the number of
/// its cells; a node of a layer has that of the node of the core below it.
///
/// Sides of the core are the mean of a square (a cube) and a circle (a sphere): their corners then have angles of 119
/// degrees, near the best for three cells that meet. Nodes of the surface lie at equal angles.
fn round_point([core, layers]: [usize; 2], layer: usize, at: [i32; 3]) -> [f64; 3] {
    // Without layers the core is the whole body.
    let [size, roundness] = if layers == 0 { [1.0, 1.0] } else { [0.5, 0.5] };
    let p = at.map(|i| f64::from(i) / core as f64);
    let shell = p.into_iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    if shell == 0.0 {
        return p;
    }
    let scale = size * (1.0 - roundness * shell + roundness * shell * shell / length(p));
    let below = p.map(|x| scale * x);
    let direction = p.map(|x| if x.abs() == 1.0 { x } else { (FRAC_PI_4 * x).tan() });
    let above = direction.map(|x| x / length(direction));
    let part = layer as f64 / layers.max(1) as f64;
    [0, 1, 2].map(|i| (1.0 - part) * below[i] + part * above[i])
}

fn length(x: [f64; 3]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// A node, the same in all blocks: its layer, and its place along three directions.
type Key = (usize, [i32; 3]);

/// The block in the middle of a round body.
struct Core {
    /// Its first node.
    least: [i32; 3],
    n_cells: [usize; 3],
    /// Number of directions with layers on both sides; the ends of the others are `z-min` and `z-max`.
    n_round: usize,
}

/// Blocks of hex8 cells that share the nodes between them; nodes are numbered as they are first met.
struct Blocks<P> {
    builder: MeshBuilder,
    node_at: HashMap<Key, u32>,
    position: P,
    n_cells: u32,
}

impl<P: Fn(Key) -> [f64; 3]> Blocks<P> {
    fn new(position: P) -> Self {
        Blocks { builder: MeshBuilder::new(), node_at: HashMap::new(), position, n_cells: 0 }
    }

    fn node(&mut self, key: Key) -> u32 {
        *self.node_at.entry(key).or_insert_with(|| self.builder.point((self.position)(key)))
    }

    /// Adds a block; each of `faces`, numbered as those of a cell, goes into a group.
    fn fill(
        &mut self,
        n_cells: [usize; 3],
        key: impl Fn([usize; 3]) -> Key,
        faces: &[(usize, &str)],
    ) -> Result<()> {
        for i in 0..n_cells[0] {
            for j in 0..n_cells[1] {
                for k in 0..n_cells[2] {
                    let at = [i, j, k];
                    let nodes = CORNERS.map(|c| self.node(key([0, 1, 2].map(|axis| at[axis] + c[axis]))));
                    let cell = self.builder.cell(CellKind::Hex8, &nodes)?;
                    self.n_cells += 1;
                    for &(local, group) in faces {
                        let end = if local % 2 == 0 { 0 } else { n_cells[local / 2] - 1 };
                        if at[local / 2] == end {
                            self.builder.facet_group(group, [Facet { cell, local: local as u8 }]);
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Adds a core and the layers around it, whose outermost facets are the group `side`.
    fn fill_round(&mut self, core: &Core, layers: usize, side: &str) -> Result<()> {
        let &Core { least, n_cells, n_round } = core;
        let is_end = |axis: usize| axis >= n_round;
        let group = |local: usize| match (is_end(local / 2), local % 2) {
            (false, _) => side,
            (true, 0) => "z-min",
            (true, _) => "z-max",
        };
        let own: Vec<(usize, &str)> = (0..6).map(|local| (local, group(local))).collect();
        let own: Vec<(usize, &str)> =
            own.into_iter().filter(|(local, _)| layers == 0 || is_end(local / 2)).collect();
        let moved = |from: [i32; 3], by: [usize; 3]| [0, 1, 2].map(|axis| from[axis] + by[axis] as i32);
        self.fill(n_cells, |at| (0, moved(least, at)), &own)?;
        for axis in 0..n_round {
            for is_last in [false, true] {
                // Outwards first: these three directions are right-handed.
                let [mut b, mut c] = [(axis + 1) % 3, (axis + 2) % 3];
                if !is_last {
                    (b, c) = (c, b);
                }
                let of_block = [axis, b, c];
                let mut faces = vec![(1, side)];
                let ends = (2..6).filter(|local| is_end(of_block[local / 2]));
                faces.extend(ends.map(|local| (local, group(2 * of_block[local / 2] + local % 2))));
                let key = |[layer, i, j]: [usize; 3]| {
                    let mut by = [0; 3];
                    by[axis] = if is_last { n_cells[axis] } else { 0 };
                    [by[b], by[c]] = [i, j];
                    (layer, moved(least, by))
                };
                self.fill([layers, n_cells[b], n_cells[c]], key, &faces)?;
            }
        }
        Ok(())
    }

    fn build(mut self) -> Result<Mesh> {
        self.builder.cell_group("body", 0..self.n_cells);
        self.builder.build()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::mesh::quality;

    /// Area of a group of plane or warped facets of four corners: half the cross products of the diagonals, summed.
    fn area(mesh: &Mesh, group: &str) -> f64 {
        let facet = |&facet: &Facet| {
            let x: Vec<[f64; 3]> = mesh.facet_nodes(facet).map(|node| mesh.points()[node as usize]).collect();
            let between = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| b[i] - a[i]);
            length(crate::tensor::cross(between(x[0], x[2]), between(x[1], x[3]))) / 2.0
        };
        mesh.groups().facets(group).unwrap().iter().map(facet).sum()
    }

    fn radii(mesh: &Mesh, group: &str, radial: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
        let nodes = mesh.group_nodes(group).unwrap().into_iter();
        nodes.map(|node| length(radial(mesh.points()[node as usize]))).collect()
    }

    fn from_axis([x, y, _]: [f64; 3]) -> [f64; 3] {
        [x, y, 0.0]
    }

    /// Area of a regular polygon over that of its circle.
    fn polygon(n: usize) -> f64 {
        (TAU / n as f64).sin() / (TAU / n as f64)
    }

    #[test]
    fn rings_and_cylinders_have_the_volume_and_areas_of_their_polygons() {
        for n in [3, 4, 7, 40] {
            let mesh = ring([0.5, 2.0], 3.0, [3, n, 2]).unwrap();
            let of_circles = PI * (4.0 - 0.25);
            assert!((quality(&mesh).volume / (3.0 * of_circles * polygon(n)) - 1.0).abs() < 1e-13, "{n}");
            for end in ["z-min", "z-max"] {
                assert!((area(&mesh, end) / (of_circles * polygon(n)) - 1.0).abs() < 1e-13, "{n} {end}");
            }
            for (side, radius) in [("inner", 0.5), ("outer", 2.0)] {
                let perimeter = 2.0 * n as f64 * radius * (PI / n as f64).sin();
                assert!((area(&mesh, side) / (3.0 * perimeter) - 1.0).abs() < 1e-13, "{n} {side}");
                assert!(radii(&mesh, side, from_axis).iter().all(|own| (own - radius).abs() < 1e-15));
            }
            assert_eq!(mesh.n_nodes(), 4 * n * 3, "the ring is closed");
            assert_eq!(mesh.boundary().len(), 2 * (n * 3) + 2 * (n * 2));
        }
        for cells in 1..9_usize {
            let n = 8 * cells.div_ceil(2);
            let mesh = cylinder(2.0, 3.0, [cells, 2]).unwrap();
            assert_eq!(mesh.n_cells() as f64, cylinder_count([cells, 2]));
            assert!((quality(&mesh).volume / (12.0 * PI * polygon(n)) - 1.0).abs() < 1e-13, "{cells}");
            for end in ["z-min", "z-max"] {
                assert!((area(&mesh, end) / (4.0 * PI * polygon(n)) - 1.0).abs() < 1e-13, "{cells} {end}");
            }
            let perimeter = 4.0 * n as f64 * (PI / n as f64).sin();
            assert!((area(&mesh, "side") / (3.0 * perimeter) - 1.0).abs() < 1e-13, "{cells}");
            assert!(radii(&mesh, "side", from_axis).iter().all(|own| (own - 2.0).abs() < 1e-15));
            assert_eq!(mesh.boundary().len(), 2 * mesh.n_cells() / 2 + 2 * n);
        }
    }

    #[test]
    fn volume_and_surface_of_a_ball_converge_with_the_second_order() {
        let errors = [4, 8, 16].map(|cells| {
            let mesh = ball(2.0, cells).unwrap();
            assert_eq!(mesh.n_cells() as f64, ball_count(cells));
            assert!(radii(&mesh, "surface", |x| x).iter().all(|own| (own - 2.0).abs() < 1e-15));
            assert_eq!(mesh.boundary().len(), 6 * cells * cells);
            let volume = quality(&mesh).volume / (4.0 / 3.0 * PI * 8.0);
            [1.0 - volume, 1.0 - area(&mesh, "surface") / (16.0 * PI)]
        });
        // The numbers of `book/src/input.md`.
        assert!((errors[0][0] - 0.065).abs() < 5e-4 && (polygon(26) - 0.990).abs() < 5e-4);
        for i in [0, 1] {
            assert!(errors[2][i] > 0.0 && errors[0][i] < 0.1, "{errors:?}");
            for pair in errors.windows(2) {
                let order = (pair[0][i] / pair[1][i]).log2();
                assert!((order - 2.0).abs() < 0.05, "{order} {errors:?}");
            }
        }
    }

    /// Corners of the core have angles of some 120 degrees however fine the mesh is: no cell becomes flat. Coarsest are
    /// the quarters of a circle, whose corners of 135 degrees have the sine 0.71, and the eighths of a ball.
    #[test]
    fn cells_of_round_bodies_are_well_shaped() {
        for cells in [1, 2, 3, 4, 5, 8, 15, 16] {
            for (name, mesh, least) in [
                ("ball", ball(1.0, cells).unwrap(), 0.66),
                ("cylinder", cylinder(1.0, 1.0, [cells, 1]).unwrap(), 0.7),
            ] {
                let quality = quality(&mesh);
                assert!(quality.inverted.is_empty());
                let worst = quality.scaled_jacobian.value;
                assert!(worst > least, "{name} {cells}: {worst}");
            }
        }
        assert_eq!(ring([1.0, 1.5], 1.0, [1, 3, 1]).map(|mesh| quality(&mesh).inverted), Ok(vec![]));
    }

    #[test]
    fn numbers_that_make_no_shape_are_rejected() {
        let message = |mesh: Result<Mesh>| mesh.unwrap_err().to_string();
        assert!(ring([1.0, 1.0], 1.0, [1, 3, 1]) == Err(Error::InnerRadius { inner: 1.0, outer: 1.0 }));
        assert_eq!(
            message(ring([2.0, 1.0], 1.0, [1, 3, 1])),
            "the inner radius 2 must be smaller than the outer radius 1"
        );
        assert_eq!(
            message(ring([1.0, 2.0], 1.0, [1, 2, 1])),
            "a ring needs at least 3 cells around its axis, not 2"
        );
        for radii in [[0.0, 1.0], [-1.0, 1.0], [1.0, f64::INFINITY], [f64::NAN, 1.0]] {
            assert!(message(ring(radii, 1.0, [1, 3, 1])).contains("must be positive and finite"));
        }
        assert!(ring([1.0, 2.0], 0.0, [1, 3, 1]).is_err() && ring([1.0, 2.0], 1.0, [0, 3, 1]).is_err());
        assert!(cylinder(0.0, 1.0, [1, 1]).is_err() && cylinder(1.0, -1.0, [1, 1]).is_err());
        assert!(cylinder(1.0, 1.0, [0, 1]).is_err() && cylinder(1.0, 1.0, [1, 0]).is_err());
        assert!(ball(-1.0, 1).is_err() && ball(1.0, 0).is_err());
        for mesh in [
            ring([1.0, 2.0], 1.0, [usize::MAX; 3]),
            cylinder(1.0, 1.0, [usize::MAX; 2]),
            ball(1.0, usize::MAX),
            ball(1.0, 1000),
        ] {
            assert!(matches!(mesh, Err(Error::TooManyCells { .. })));
        }
    }
}
