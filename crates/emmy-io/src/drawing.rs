//! Deformed configurations of a mesh, as SVG and PNG.
//!
//! The faces of the boundary are painted from far to near, shaded by a light beside the observer; faces that point away
//! from the observer are left out. Quadratic cells are drawn by their corners.

use std::io;
use std::path::Path;

use emmy::mesh::Mesh;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use crate::chart::Figure;
use crate::picture::{self, Area, Drawn, INK, stroke, text, units, writing};
use crate::vector::{cross, dot};

// Sizes in points.
const WIDTH: f64 = 960.0;
/// Largest height of a row of configurations.
const MAX_HEIGHT: f64 = 480.0;
const LABEL: f64 = 11.5;
/// Height of a row of labels.
const ROW: f64 = 26.0;
/// Colours of the first and the last configuration.
const COLOURS: [[f64; 3]; 2] = [[90.0, 190.0, 240.0], [225.0, 145.0, 115.0]];
/// Direction to the light: right, up and to the observer.
const LIGHT: [f64; 3] = [0.25, 0.6, 0.75];

/// Positions of all nodes of a mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Configuration {
    /// Label below.
    pub label: String,
    /// Positions, `[n_nodes][3]` \[length\]. A face with a node whose position is missing or not finite is left out.
    pub positions: Vec<[f64; 3]>,
}

/// Arrangement of the configurations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrangement {
    /// Each in a frame of its own, with this number of frames in a row.
    Beside(usize),
    /// All in one frame, to show the path.
    Path,
}

/// Position of the observer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewpoint {
    /// Direction from the body to the observer.
    pub from: [f64; 3],
    /// A direction that is up in the picture; it differs from the direction to the observer.
    pub up: [f64; 3],
}

impl Default for Viewpoint {
    /// From a corner above; the second axis is up.
    fn default() -> Self {
        Viewpoint { from: [0.52, 0.38, 0.76], up: [0.0, 1.0, 0.0] }
    }
}

impl Viewpoint {
    /// Unit vectors to the right, up and to the observer.
    pub(crate) fn axes(&self) -> [[f64; 3]; 3] {
        let depth = unit(self.from);
        let right = unit(cross(self.up, depth));
        [right, cross(depth, right), depth]
    }
}

/// Configurations of a mesh, drawn to the same scale.
///
/// ```
/// use emmy::mesh::block;
/// use emmy_io::chart::Figure;
/// use emmy_io::drawing::{Arrangement, Configuration, Drawing, Viewpoint};
/// let mesh = block([1.0; 3], [1; 3])?;
/// let configuration = |t: f64| Configuration {
///     label: format!("t = {t}"),
///     positions: mesh.points().iter().map(|[x, y, z]| [x + t, y + 0.5 * x * t, *z]).collect(),
/// };
/// let drawing = Drawing {
///     mesh: &mesh,
///     configurations: vec![configuration(0.0), configuration(1.0)],
///     arrangement: Arrangement::Beside(2),
///     view: Viewpoint::default(),
///     below: Figure::default(),
/// };
/// assert_eq!(drawing.svg().matches("<polygon").count(), 2 * 3); // three faces of a cube are seen
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Its configurations.
    pub configurations: Vec<Configuration>,
    /// Their arrangement.
    pub arrangement: Arrangement,
    /// Position of the observer.
    pub view: Viewpoint,
    /// Charts below; may be empty.
    pub below: Figure,
}

impl Drawing<'_> {
    /// The drawing as SVG.
    pub fn svg(&self) -> String {
        let scene = Scene::new(self);
        let below = self.below.sheet(WIDTH);
        let height = if self.below.charts.is_empty() { 0.0 } else { below.size().1 };
        picture::svg((WIDTH, scene.height() + height), |area| {
            let (above, rest) = area.split_vertically(units(scene.height()));
            scene.draw(&above)?;
            if height > 0.0 { below.draw(&rest) } else { Ok(()) }
        })
    }

    /// Writes `STEM.svg` and `STEM.png`.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write(&self, stem: &Path) -> io::Result<()> {
        picture::write(&self.svg(), stem)
    }
}

/// The mesh seen by the observer; coordinates are right, up and to the observer.
struct Scene<'a> {
    drawing: &'a Drawing<'a>,
    seen: Vec<Vec<[f64; 3]>>,
    /// Lower and upper ends of the frame of each configuration, to the right and up.
    frames: Vec<[[f64; 2]; 2]>,
    /// Points of the picture per unit of length.
    scale: f64,
    columns: usize,
}

impl<'a> Scene<'a> {
    fn new(drawing: &'a Drawing<'a>) -> Self {
        let axes = drawing.view.axes();
        let seen =
            |positions: &Vec<[f64; 3]>| positions.iter().map(|&q| axes.map(|axis| dot(axis, q))).collect();
        let seen: Vec<Vec<[f64; 3]>> = drawing.configurations.iter().map(|c| seen(&c.positions)).collect();
        let (frames, columns) = match drawing.arrangement {
            Arrangement::Beside(columns) => (seen.iter().map(|s| frame(s.iter())).collect(), columns.max(1)),
            Arrangement::Path => (vec![frame(seen.iter().flatten()); seen.len()], 1),
        };
        let largest =
            |i: usize| frames.iter().map(|[low, high]: &[[f64; 2]; 2]| high[i] - low[i]).fold(0.0, f64::max);
        // With a margin between neighbours.
        let scale = (0.92 * WIDTH / columns as f64 / largest(0)).min(MAX_HEIGHT / largest(1));
        Scene { drawing, seen, frames, scale: if scale.is_finite() { scale } else { 1.0 }, columns }
    }

    /// Height of a row in points, with the labels.
    fn row(&self) -> f64 {
        let heights = self.frames.iter().map(|[low, high]| self.scale * (high[1] - low[1]));
        heights.fold(0.0, f64::max) + 2.0 * ROW
    }

    fn height(&self) -> f64 {
        match self.drawing.arrangement {
            Arrangement::Beside(_) => self.row() * self.seen.len().div_ceil(self.columns) as f64,
            Arrangement::Path => self.row(),
        }
    }

    fn draw(&self, area: &Area<'_>) -> Drawn {
        let boundary = self.drawing.mesh.boundary();
        let all = 0..self.seen.len();
        let mut faces: Vec<Face> =
            all.clone().flat_map(|i| boundary.iter().filter_map(move |nodes| self.face(i, nodes))).collect();
        faces.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        faces.iter().try_for_each(|face| face.draw(area))?;
        all.into_iter().try_for_each(|i| self.draw_label(area, i))
    }

    /// A point of a configuration on the canvas.
    fn place(&self, configuration: usize, [x, y]: [f64; 2]) -> (i32, i32) {
        let [low, high] = self.frames[configuration];
        let (row, column) = match self.drawing.arrangement {
            Arrangement::Beside(_) => (configuration / self.columns, configuration % self.columns),
            Arrangement::Path => (0, 0),
        };
        let left = WIDTH / self.columns as f64 * (column as f64 + 0.5);
        let top = self.row() * (row as f64 + 0.5) - 0.5 * ROW;
        let from_middle = |i: usize, at: f64| self.scale * (at - 0.5 * (low[i] + high[i]));
        (units(left + from_middle(0, x)), units(top - from_middle(1, y)))
    }

    /// A face of a configuration, if it is visible.
    fn face(&self, configuration: usize, nodes: &[u32]) -> Option<Face> {
        let seen = &self.seen[configuration];
        let corners: Vec<[f64; 3]> =
            nodes.iter().filter_map(|&node| seen.get(node as usize)).copied().collect();
        if corners.len() < nodes.len() || corners.iter().flatten().any(|x| !x.is_finite()) {
            return None;
        }
        let n = corners.len();
        let edge = |a: usize, b: usize| [0, 1, 2].map(|i| corners[b][i] - corners[a][i]);
        let normal = unit(cross(edge(0, 2), edge(1, n - 1)));
        let place = |&[x, y, _]: &[f64; 3]| self.place(configuration, [x, y]);
        (normal[2] > 0.0).then(|| Face {
            depth: corners.iter().map(|corner| corner[2]).sum::<f64>() / n as f64,
            corners: corners.iter().map(place).collect(),
            fill: self.fill(configuration, normal),
        })
    }

    /// The colour of a face of a configuration, from the angle of the light.
    fn fill(&self, configuration: usize, normal: [f64; 3]) -> RGBColor {
        let along = configuration as f64 / (self.seen.len().max(2) - 1) as f64;
        let light = (0.35 + 0.65 * dot(normal, LIGHT).max(0.0)).min(1.0);
        let [red, green, blue] =
            [0, 1, 2].map(|i| (light * (COLOURS[0][i] + along * (COLOURS[1][i] - COLOURS[0][i]))) as u8);
        RGBColor(red, green, blue)
    }

    /// Side by side, labels are in a row; along a path, each is below its configuration.
    fn draw_label(&self, area: &Area<'_>, configuration: usize) -> Drawn {
        let [low, high] = frame(self.seen[configuration].iter());
        let middle = self.place(configuration, [0.5 * (low[0] + high[0]), low[1]]);
        let (x, y) = match self.drawing.arrangement {
            Arrangement::Beside(_) => {
                (middle.0, units(self.row() * ((configuration / self.columns) as f64 + 1.0) - 0.6 * ROW))
            }
            Arrangement::Path => (middle.0, middle.1 + units(0.5 * ROW)),
        };
        text(area, &self.drawing.configurations[configuration].label, &writing(LABEL), HPos::Center, (x, y))
    }
}

/// A face on the canvas.
struct Face {
    depth: f64,
    corners: Vec<(i32, i32)>,
    fill: RGBColor,
}

impl Face {
    fn draw(&self, area: &Area<'_>) -> Drawn {
        area.draw(&Polygon::new(self.corners.clone(), self.fill))?;
        let outline: Vec<(i32, i32)> = self.corners.iter().chain(self.corners.first()).copied().collect();
        area.draw(&PathElement::new(outline, stroke(INK, 0.4)))
    }
}

/// Lower and upper ends of the visible nodes, to the right and up.
fn frame<'a>(seen: impl Iterator<Item = &'a [f64; 3]>) -> [[f64; 2]; 2] {
    let none = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    let [low, high] = seen
        .filter(|q| q.iter().all(|x| x.is_finite()))
        .fold(none, |[low, high], q| [[0, 1].map(|i| q[i].min(low[i])), [0, 1].map(|i| q[i].max(high[i]))]);
    if low[0] <= high[0] { [low, high] } else { [[0.0; 2]; 2] }
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let norm = dot(a, a).sqrt();
    a.map(|a| a / norm)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unit cubes seen along the third axis, slightly rotated, the second one in front of the first.
    fn cubes(mesh: &Mesh, arrangement: Arrangement) -> Drawing<'_> {
        let at = |z: f64| mesh.points().iter().map(|p| [p[0], p[1], p[2] + z]).collect();
        let cube = |(label, z): (&str, f64)| Configuration { label: label.into(), positions: at(z) };
        Drawing {
            mesh,
            configurations: [("far", 0.0), ("near", 3.0)].map(cube).to_vec(),
            arrangement,
            view: Viewpoint { from: [0.1, 0.2, 1.0], up: [0.0, 1.0, 0.0] },
            below: Figure::default(),
        }
    }

    #[test]
    fn near_faces_are_painted_last() {
        let mesh = emmy::mesh::block([1.0; 3], [1; 3]).unwrap();
        let mut drawing = cubes(&mesh, Arrangement::Path);
        // The first configuration is blue, the last one red.
        let is_red = |svg: &str| {
            let polygon = svg.lines().rfind(|line| line.starts_with("<polygon")).unwrap();
            let (_, fill) = polygon.split_once("fill=\"#").unwrap();
            fill[0..2] > fill[4..6]
        };
        assert_eq!(drawing.svg().matches("<polygon").count(), 6);
        assert!(is_red(&drawing.svg()));
        drawing.configurations.reverse();
        assert!(!is_red(&drawing.svg()));
    }

    #[test]
    fn side_by_side_each_stands_in_its_own_place() {
        let mesh = emmy::mesh::block([1.0; 3], [1; 3]).unwrap();
        let drawing = cubes(&mesh, Arrangement::Beside(2));
        let scene = Scene::new(&drawing);
        let boundary = mesh.boundary();
        for i in 0..2 {
            let faces = boundary.iter().filter_map(|nodes| scene.face(i, nodes));
            let corners: Vec<(i32, i32)> = faces.flat_map(|face| face.corners).collect();
            let half = units(WIDTH) / 2;
            assert!(
                corners.iter().all(|&(x, y)| x / half == i as i32 && (0..units(scene.height())).contains(&y))
            );
        }
    }

    #[test]
    fn a_node_without_a_position_takes_its_faces_away() {
        let mesh = emmy::mesh::block([1.0; 3], [1; 3]).unwrap();
        let mut drawing = cubes(&mesh, Arrangement::Beside(1));
        drawing.configurations[0].positions[0][1] = f64::NAN;
        drawing.configurations[1].positions.clear();
        let svg = drawing.svg();
        assert!(svg.matches("<polygon").count() <= 3 && !svg.contains("NaN") && svg.contains("near"));
    }
}
