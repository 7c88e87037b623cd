//! Paints a surface: triangles in the colours of their values, the lines of the mesh on them, and links.

use std::collections::HashSet;

use super::camera::Camera;
use super::colours::{GREY, Scale};
use super::raster::{Canvas, Corner, SAMPLES};
use crate::report::surface::Surface;
use crate::vector::{Vector, cross, dot, minus, unit};

/// Direction to the light, beside the observer: right, up and to the observer (`assets/scripts/shaders.js`).
const LIGHT: Vector = [-0.35, 0.6, 0.8];

/// Cosine of the angle by which a surface bends at a sharp edge, as in the page.
const SHARP: f64 = 0.906;

/// Colour of lines.
const INK: [f64; 3] = [0x18 as f64, 0x1c as f64, 0x22 as f64];

/// Pixels between the lines of the mesh, below which they would cover the colours.
const MIN_SPACING: f64 = 12.0;

/// Half the width of a link in samples.
const LINK: f64 = 2.0 * SAMPLES as f64;
/// Radius of the disc at an end of a link.
const DISC: f64 = 4.5 * SAMPLES as f64;
/// Sides of the disc.
const SIDES: usize = 20;

/// A side of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// Inside of a facet.
    Inner,
    /// Between two facets.
    Line,
    /// Where the surface bends or ends.
    Sharp,
}

impl Side {
    /// Half of its width in samples, and its opacity.
    fn pen(self, has_lines: bool) -> Option<(f64, f64)> {
        let samples = SAMPLES as f64;
        match self {
            Side::Line if has_lines => Some((0.4 * samples, 0.45)),
            Side::Sharp => Some((0.7 * samples, 0.8)),
            _ => None,
        }
    }
}

/// A surface with its sides, which are those of the reference configuration.
#[derive(Debug)]
pub(super) struct Skin {
    surface: Surface,
    /// Of each triangle, the sides opposite to its corners.
    sides: Vec<[Side; 3]>,
}

/// A configuration of the surface as the observer sees it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen<'a> {
    pub(super) camera: &'a Camera,
    /// Of each node; triangles with one that is not finite are left out.
    pub(super) positions: &'a [Vector],
    /// Of each node, with their colours; `None`: grey.
    pub(super) values: Option<(&'a [f64], &'a Scale)>,
}

impl Skin {
    /// The skin of a surface. `points`: of its nodes.
    pub(super) fn new(surface: Surface, points: &[Vector]) -> Self {
        // Those of several regions are not in order.
        let lines: HashSet<[u32; 2]> = surface.edges.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
        let normal = |&[a, b, c]: &[u32; 3]| normal([a, b, c].map(|node| points[node as usize]));
        let normals: Vec<Vector> = surface.triangles.iter().map(normal).collect();
        let mut sides = vec![[Side::Inner; 3]; surface.triangles.len()];
        // The sides of all triangles, those between the same nodes next to each other.
        let mut all: Vec<([u32; 2], usize, usize)> = Vec::with_capacity(3 * sides.len());
        for (triangle, nodes) in surface.triangles.iter().enumerate() {
            for k in 0..3 {
                let [a, b] = [nodes[(k + 1) % 3], nodes[(k + 2) % 3]];
                let key = [a.min(b), a.max(b)];
                if lines.contains(&key) {
                    all.push((key, triangle, k));
                }
            }
        }
        all.sort_unstable();
        for same in all.chunk_by(|a, b| a.0 == b.0) {
            let is_smooth = |a: usize, b: usize| dot(normals[same[a].1], normals[same[b].1]).abs() >= SHARP;
            let side = if same.len() == 2 && is_smooth(0, 1) { Side::Line } else { Side::Sharp };
            same.iter().for_each(|&(_, triangle, k)| sides[triangle][k] = side);
        }
        Skin { surface, sides }
    }

    /// The surface.
    pub(super) fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Paints a configuration.
    pub(super) fn paint(&self, canvas: &mut Canvas, seen: Seen<'_>) {
        let corner = |(node, &position): (usize, &Vector)| {
            let (at, nearness) = seen.camera.project(position);
            Corner { at, nearness, value: seen.values.map_or(0.0, |(values, _)| values[node]) }
        };
        let corners: Vec<Corner> = seen.positions.iter().enumerate().map(corner).collect();
        let has_lines = self.spacing(&corners) >= MIN_SPACING * SAMPLES as f64;
        let colour = |value: f64| seen.values.map_or(GREY, |(_, scale)| scale.colour(value));
        for (nodes, sides) in self.surface.triangles.iter().zip(&self.sides) {
            let nodes = nodes.map(|node| node as usize);
            let light = light(nodes.map(|node| seen.camera.towards(seen.positions[node])));
            let pens = sides.map(|side| side.pen(has_lines));
            canvas.fill(nodes.map(|node| corners[node]), |value, distances| {
                let ink = |k: usize| {
                    pens[k]
                        .map_or(0.0, |(half, opacity)| opacity * (half + 0.5 - distances[k]).clamp(0.0, 1.0))
                };
                let ink = (0..3).map(ink).fold(0.0, f64::max);
                let base = colour(value);
                [0, 1, 2].map(|i| (ink * INK[i] + (1.0 - ink) * light * f64::from(base[i])).min(255.0) as u8)
            });
        }
        let ends: HashSet<u32> = self.surface.links.iter().flatten().copied().collect();
        for &[a, b] in &self.surface.links {
            ribbon(canvas, corners[a as usize], corners[b as usize], colour);
        }
        ends.into_iter().for_each(|node| disc(canvas, corners[node as usize], colour));
    }

    /// Mean length of the lines of the mesh in samples.
    fn spacing(&self, corners: &[Corner]) -> f64 {
        let length = |&[a, b]: &[u32; 2]| {
            let [a, b] = [a, b].map(|node| corners[node as usize].at);
            (b[0] - a[0]).hypot(b[1] - a[1])
        };
        let lengths = self.surface.edges.iter().map(length).filter(|length| length.is_finite());
        let (n, sum) = lengths.fold((0, 0.0), |(n, sum), length| (n + 1, sum + length));
        sum / f64::from(n.max(1))
    }
}

/// Unit normal of a triangle; zero without one.
fn normal([a, b, c]: [Vector; 3]) -> Vector {
    unit(cross(minus(b, a), minus(c, a))).unwrap_or_default()
}

/// Light on a triangle, from its corners by the vectors to the observer.
fn light(towards: [Vector; 3]) -> f64 {
    let normal = normal(towards.map(|from| from.map(|x| -x)));
    let normal = if dot(normal, towards[0]) < 0.0 { normal.map(|x| -x) } else { normal };
    let to_light = unit(LIGHT).unwrap_or_default();
    0.74 + 0.2 * dot(normal, to_light).max(0.0) + 0.08 * normal[2].max(0.0)
}

/// A line of a width on the canvas.
fn ribbon(canvas: &mut Canvas, a: Corner, b: Corner, colour: impl Fn(f64) -> [u8; 3]) {
    let along = [b.at[0] - a.at[0], b.at[1] - a.at[1]];
    let length = along[0].hypot(along[1]);
    let moved = |from: Corner, side: f64| {
        let across = [-along[1], along[0]].map(|x| side * LINK * x / length);
        Corner { at: [from.at[0] + across[0], from.at[1] + across[1]], ..from }
    };
    let [first, second, third, fourth] = [moved(a, 1.0), moved(a, -1.0), moved(b, 1.0), moved(b, -1.0)];
    for corners in [[first, second, third], [third, second, fourth]] {
        canvas.fill(corners, |value, _| colour(value));
    }
}

/// A disc on the canvas, in front of the links that end there, with a dark rim.
fn disc(canvas: &mut Canvas, middle: Corner, colour: impl Fn(f64) -> [u8; 3]) {
    let middle = Corner { nearness: 1.0005 * middle.nearness, ..middle };
    let rim = |i: usize| {
        let angle = i as f64 * std::f64::consts::TAU / SIDES as f64;
        let at = [middle.at[0] + DISC * angle.cos(), middle.at[1] + DISC * angle.sin()];
        Corner { at, ..middle }
    };
    for i in 0..SIDES {
        canvas.fill([middle, rim(i), rim(i + 1)], |value, [to_rim, ..]| {
            colour(value).map(|channel| if to_rim < 1.2 { channel / 3 } else { channel })
        });
    }
}

#[cfg(test)]
mod tests {
    use emmy::mesh::block;

    use super::super::camera::{Window, viewpoint};
    use super::*;

    #[test]
    fn lines_of_the_mesh_are_told_from_sharp_edges_and_diagonals() {
        let mesh = block([2.0, 1.0, 1.0], [2, 1, 1]).unwrap();
        let cells: Vec<_> = mesh.cells().map(|cell| (cell.kind, cell.nodes.to_vec())).collect();
        let skin = Skin::new(Surface::new(&cells), mesh.points());
        let count = |side| skin.sides.iter().flatten().filter(|&&own| own == side).count();
        // Ten squares with a diagonal each; four lines between the cubes. Every side belongs to two triangles.
        assert_eq!([Side::Inner, Side::Line, Side::Sharp].map(count), [20, 8, 32]);
    }

    /// A square from the front, from 0 at the left to 1 at the right.
    #[test]
    fn colours_are_interpolated_and_lines_are_dark() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let surface = Surface {
            nodes: vec![0, 1, 2, 3],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            edges: vec![[0, 1], [1, 2], [2, 3], [0, 3]],
            ..Surface::default()
        };
        let window = Window { start: [0.0; 2], size: [2.0 * 101.0; 2] };
        let camera = Camera::fitted(&viewpoint(&points, true), &points, window);
        let values = [0.0, 1.0, 1.0, 0.0];
        let scale = Scale::of(&values, false);
        let mut canvas = Canvas::new([101, 101]);
        let seen = Seen { camera: &camera, positions: &points, values: Some((&values, &scale)) };
        Skin::new(surface, &points).paint(&mut canvas, seen);
        let pixels = canvas.pixels();
        let pixel = |x: usize, y: usize| -> [u8; 3] { pixels[4 * (101 * y + x)..][..3].try_into().unwrap() };
        let light = light([[0.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.0, -1.0, 1.0]]);
        for (x, value) in [(20, 20.5 / 101.0), (50, 0.5), (80, 80.5 / 101.0)] {
            let expected = scale.colour(value).map(|channel| light * f64::from(channel));
            let shown = pixel(x, 30);
            // A sample lies a quarter of a pixel beside the middle.
            assert!(
                (0..3).all(|i| (f64::from(shown[i]) - expected[i]).abs() < 2.5),
                "{shown:?} {expected:?}"
            );
        }
        let sum = |pixel: [u8; 3]| pixel.iter().map(|&channel| u32::from(channel)).sum::<u32>();
        // Half of the samples at the border have lines of opacity 0.8, the others of 0.32.
        assert!(10 * sum(pixel(80, 0)) < 6 * sum(pixel(80, 30)));
        // The diagonal is no line of the mesh.
        assert_eq!(pixel(50, 50), pixel(50, 30));
    }

    #[test]
    fn links_and_their_ends_have_a_width() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0]];
        let surface = Surface { nodes: vec![0, 1], links: vec![[0, 1]], ..Surface::default() };
        let window = Window { start: [40.0, 40.0], size: [200.0, 100.0] };
        let camera = Camera::fitted(&viewpoint(&points, false), &points, window);
        let mut canvas = Canvas::new([140, 90]);
        Skin::new(surface, &points)
            .paint(&mut canvas, Seen { camera: &camera, positions: &points, values: None });
        let pixels = canvas.pixels();
        let painted = |x: usize| (0..90).filter(|y| pixels[4 * (140 * y + x)..][..3] != [255; 3]).count();
        // The disc begins and ends in the middle of a pixel.
        assert_eq!([painted(10), painted(70), painted(20)], [0, 4, 10]);
    }
}
