//! Small distorted blocks of every kind of cell, and their files.

use std::collections::BTreeMap;
use std::fmt::Write;

use fastrand::Rng;

use super::cells::Kind;

/// A cell or a facet.
#[derive(Debug, Clone)]
pub struct Item {
    /// Its kind.
    pub kind: Kind,
    /// Its nodes.
    pub nodes: Vec<usize>,
}

/// A block on y = 0, its upper side at `HEIGHT`.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Reference positions.
    pub points: Vec<[f64; 3]>,
    /// Cells.
    pub cells: Vec<Item>,
    /// Whether a cell is in the group `two` instead of `one`.
    pub is_second: Vec<bool>,
    /// Facets at the bottom, with outer normals.
    pub bottom: Vec<Item>,
    /// Facets at the top, with outer normals.
    pub top: Vec<Item>,
    /// Thickness of a plane block, else 1.
    pub thickness: f64,
}

/// Height of the block.
pub const HEIGHT: f64 = 0.8;

impl Mesh {
    /// A block of some cells along x; the second half of them is the group `two`.
    pub fn block(kind: Kind, n: usize, rng: &mut Rng) -> Self {
        let depth = if kind.dimension() == 3 { 1 } else { 0 };
        let node = |i: usize, j: usize, k: usize| i + (n + 1) * (j + 2 * k);
        let mut points = Vec::new();
        for k in 0..=depth {
            for j in 0..2 {
                for i in 0..=n {
                    let mut place = [0.9 * i as f64, HEIGHT * j as f64, 0.7 * k as f64];
                    (0..=2 * depth).step_by(2).for_each(|d| place[d] += 0.15 * (rng.f64() - 0.5));
                    points.push(place);
                }
            }
        }
        let mut corners = Vec::new();
        for i in 0..n {
            let low = [node(i, 0, 0), node(i + 1, 0, 0), node(i + 1, 1, 0), node(i, 1, 0)];
            let base = match depth {
                1 => low.into_iter().chain(low.map(|at| at + 2 * (n + 1))).collect::<Vec<_>>(),
                _ => low.to_vec(),
            };
            let parts: &[&[usize]] = match kind {
                Kind::Tri3 | Kind::Tri6 => &[&[0, 1, 2], &[0, 2, 3]],
                Kind::Tet4 | Kind::Tet10 => &[
                    &[0, 1, 2, 6],
                    &[0, 2, 3, 6],
                    &[0, 3, 7, 6],
                    &[0, 7, 4, 6],
                    &[0, 4, 5, 6],
                    &[0, 5, 1, 6],
                ],
                Kind::Wedge6 | Kind::Wedge15 => &[&[0, 1, 2, 4, 5, 6], &[0, 2, 3, 4, 6, 7]],
                Kind::Quad4 | Kind::Quad8 | Kind::Quad9 => &[&[0, 1, 2, 3]],
                _ => &[&[0, 1, 2, 3, 4, 5, 6, 7]],
            };
            corners.extend(parts.iter().map(|part| part.iter().map(|&at| base[at]).collect::<Vec<_>>()));
        }
        let mut middles = BTreeMap::new();
        let mut cells = Vec::new();
        for own in &corners {
            let nodes = with_middles(kind, own, &mut points, &mut middles, rng);
            cells.push(Item { kind, nodes });
        }
        let count = cells.len();
        let is_second = (0..count).map(|cell| count > 1 && 2 * cell >= count).collect();
        let thickness = if depth == 0 { 0.7 } else { 1.0 };
        let mut mesh = Mesh { points, cells, is_second, bottom: Vec::new(), top: Vec::new(), thickness };
        mesh.bottom = mesh.facets_at(0.0, &mut middles, rng);
        mesh.top = mesh.facets_at(HEIGHT, &mut middles, rng);
        mesh
    }

    fn facets_at(&mut self, y: f64, middles: &mut BTreeMap<Vec<usize>, usize>, rng: &mut Rng) -> Vec<Item> {
        let mut facets = Vec::new();
        for cell in self.cells.clone() {
            for local in cell.kind.facets() {
                let own: Vec<usize> = local.iter().map(|&at| cell.nodes[at]).collect();
                if own.iter().all(|&node| self.points[node][1] == y) {
                    let kind = cell.kind.facet(own.len());
                    let nodes = with_middles(kind, &own, &mut self.points, middles, rng);
                    facets.push(Item { kind, nodes });
                }
            }
        }
        facets
    }

    /// Whether the block is plane.
    pub fn is_plane(&self) -> bool {
        self.cells[0].kind.dimension() == 2
    }

    /// Nodes of some facets or cells, each once.
    pub fn nodes_of<'a>(items: impl IntoIterator<Item = &'a Item>) -> Vec<usize> {
        let mut nodes: Vec<usize> = items.into_iter().flat_map(|item| item.nodes.iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// The mesh as a file of Gmsh, version 2.2.
    pub fn text(&self) -> String {
        let dimension = self.cells[0].kind.dimension();
        let mut names = vec![(1, "one"), (2, "two"), (3, "bottom"), (4, "top"), (5, "feet")];
        names.retain(|(number, _)| *number != 2 || self.is_second.contains(&true));
        let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n", names.len());
        for (number, name) in names {
            let own = if number == 5 { 0 } else { dimension - (number - 1) / 2 };
            let _ = writeln!(text, "{own} {number} \"{name}\"");
        }
        let _ = writeln!(text, "$EndPhysicalNames\n$Nodes\n{}", self.points.len());
        for (number, [x, y, z]) in self.points.iter().enumerate() {
            let _ = writeln!(text, "{} {x:?} {y:?} {z:?}", number + 1);
        }
        let cells =
            self.cells.iter().zip(&self.is_second).map(|(cell, &second)| (cell, 1 + usize::from(second)));
        let facets =
            self.bottom.iter().map(|facet| (facet, 3)).chain(self.top.iter().map(|facet| (facet, 4)));
        let items: Vec<_> = cells.chain(facets).collect();
        let feet = Mesh::nodes_of(&self.bottom);
        let _ = writeln!(text, "$EndNodes\n$Elements\n{}", items.len() + feet.len());
        for (number, (item, group)) in items.iter().enumerate() {
            let nodes: Vec<String> = item.nodes.iter().map(|node| (node + 1).to_string()).collect();
            let _ =
                writeln!(text, "{} {} 2 {group} {group} {}", number + 1, item.kind.gmsh(), nodes.join(" "));
        }
        for (number, node) in feet.iter().enumerate() {
            let _ = writeln!(text, "{} 15 2 5 5 {}", items.len() + number + 1, node + 1);
        }
        text + "$EndElements\n"
    }
}

/// Corners and the nodes between them, which are made where they are missing, a little beside the middle.
fn with_middles(
    kind: Kind,
    corners: &[usize],
    points: &mut Vec<[f64; 3]>,
    middles: &mut BTreeMap<Vec<usize>, usize>,
    rng: &mut Rng,
) -> Vec<usize> {
    let mut nodes = corners.to_vec();
    for corners_of in kind.middles() {
        let mut around: Vec<usize> = corners_of.iter().map(|&corner| corners[corner]).collect();
        around.sort_unstable();
        if let Some(&node) = middles.get(&around) {
            nodes.push(node);
            continue;
        }
        let is_plane = points.iter().all(|point| point[2] == 0.0);
        let mean = |d: usize| around.iter().map(|&node| points[node][d]).sum::<f64>() / around.len() as f64;
        let is_at = |y: f64| around.iter().all(|&node| points[node][1] == y);
        let mut aside = [0, 1, 2].map(|_| 0.06 * (rng.f64() - 0.5));
        aside[2] *= f64::from(!is_plane);
        let mut place: [f64; 3] = std::array::from_fn(|d| mean(d) + aside[d]);
        for y in [0.0, HEIGHT] {
            if is_at(y) {
                place[1] = y;
            }
        }
        points.push(place);
        nodes.push(points.len() - 1);
        middles.insert(around, points.len() - 1);
    }
    nodes
}
