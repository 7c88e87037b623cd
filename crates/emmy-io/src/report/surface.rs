//! The visible surface of a mesh: facets of one solid cell only, plane cells, and links.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use emmy::mesh::CellKind;

/// Triangles, the lines of the mesh on them, and links; the visible nodes have numbers of their own.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Surface {
    /// Index in the mesh of each node.
    pub(super) nodes: Vec<u32>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) edges: Vec<[u32; 2]>,
    pub(super) links: Vec<[u32; 2]>,
    /// The regions, if there are several: the nodes of the first come first.
    pub(super) regions: Vec<RegionNodes>,
}

/// Nodes of a region; each region has nodes of its own where it meets others.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RegionNodes {
    /// Number of the region, negative for rigid bodies.
    pub(super) number: i32,
    /// Number of its nodes.
    pub(super) n: usize,
    /// Number of those where it meets no other region, which come first.
    pub(super) n_inside: usize,
}

impl Surface {
    /// The surface of some cells.
    pub(super) fn new(cells: &[(CellKind, Vec<u32>)]) -> Self {
        let mut surface = Surface::default();
        let mut edges = BTreeSet::new();
        let mut times = HashMap::new();
        solid_facets(cells).for_each(|(_, corners, _)| *times.entry(sorted(&corners)).or_insert(0u8) += 1);
        for (nodes, corners, n_corners) in solid_facets(cells) {
            if times[&sorted(&corners)] == 1 {
                surface.add(&nodes, n_corners, &mut edges);
            }
        }
        for (kind, nodes) in cells {
            match kind.dimension() {
                1 => surface.links.push([nodes[0], nodes[1]]),
                2 => surface.add(nodes, kind.n_corners(), &mut edges),
                _ => {}
            }
        }
        surface.edges = edges.into_iter().collect();
        surface.renumber();
        surface
    }

    /// The surfaces of all regions, if there are several; otherwise that of all cells. `regions`: of each cell.
    pub(super) fn of_regions(cells: Vec<(CellKind, Vec<u32>)>, regions: &[i32]) -> Self {
        let several: BTreeSet<i32> = regions.iter().copied().filter(|&region| region >= 0).collect();
        if several.len() < 2 || regions.len() != cells.len() {
            return Surface::new(&cells);
        }
        let mut cells_of = BTreeMap::<i32, Vec<_>>::new();
        for (cell, &region) in cells.into_iter().zip(regions) {
            cells_of.entry(region).or_default().push(cell);
        }
        let surfaces: Vec<(i32, Surface)> =
            cells_of.into_iter().map(|(number, cells)| (number, Surface::new(&cells))).collect();
        let mut times = HashMap::new();
        let nodes = surfaces.iter().flat_map(|(_, surface)| &surface.nodes);
        nodes.for_each(|&node| *times.entry(node).or_insert(0u32) += 1);
        let mut joined = Surface::default();
        for (number, surface) in surfaces {
            joined.append(number, surface, |node| times[&node] == 1);
        }
        joined
    }

    /// Adds the surface of a region. `is_inside`: whether no other region has a node of the mesh.
    fn append(&mut self, number: i32, region: Surface, is_inside: impl Fn(u32) -> bool) {
        let (n, before) = (region.nodes.len(), self.nodes.len() as u32);
        let (inside, border): (Vec<usize>, Vec<usize>) =
            (0..n).partition(|&node| is_inside(region.nodes[node]));
        self.regions.push(RegionNodes { number, n, n_inside: inside.len() });
        let mut new = vec![0; n];
        for (&node, number) in inside.iter().chain(&border).zip(before..) {
            new[node] = number;
            self.nodes.push(region.nodes[node]);
        }
        let new = |node: u32| new[node as usize];
        self.triangles.extend(region.triangles.into_iter().map(|triangle| triangle.map(new)));
        self.edges.extend(region.edges.into_iter().map(|edge| edge.map(new)));
        self.links.extend(region.links.into_iter().map(|link| link.map(new)));
    }

    /// Adds a facet, subdivided at the nodes on its edges. `nodes`: corners, then midside nodes, then the central one.
    fn add(&mut self, nodes: &[u32], n_corners: usize, edges: &mut BTreeSet<[u32; 2]>) {
        let n = n_corners;
        let (corners, middles) = nodes.split_at(n);
        let mut edge = |a: u32, b: u32| edges.insert([a.min(b), a.max(b)]);
        if middles.is_empty() {
            self.triangles.extend((1..n - 1).map(|i| [corners[0], corners[i], corners[i + 1]]));
            (0..n).for_each(|i| _ = edge(corners[i], corners[(i + 1) % n]));
            return;
        }
        for i in 0..n {
            edge(corners[i], middles[i]);
            edge(middles[i], corners[(i + 1) % n]);
            let before = middles[(i + n - 1) % n];
            match middles.get(n) {
                Some(&centre) => {
                    self.triangles.push([corners[i], middles[i], centre]);
                    self.triangles.push([corners[i], centre, before]);
                }
                None => self.triangles.push([corners[i], middles[i], before]),
            }
        }
        if middles.len() == n {
            self.triangles.extend((1..n - 1).map(|i| [middles[0], middles[i], middles[i + 1]]));
        }
    }

    fn renumber(&mut self) {
        let used: BTreeSet<u32> =
            self.triangles.iter().flatten().chain(self.links.iter().flatten()).copied().collect();
        self.nodes = used.into_iter().collect();
        let number: HashMap<u32, u32> =
            self.nodes.iter().enumerate().map(|(new, &old)| (old, new as u32)).collect();
        let lists = self.triangles.iter_mut().flatten();
        lists
            .chain(self.edges.iter_mut().flatten())
            .chain(self.links.iter_mut().flatten())
            .for_each(|node| *node = number[node]);
    }
}

/// Facets of the solid cells: their nodes, four corners (the fourth of a triangle is no node, so that two cells agree
/// on the same facet whichever corner is last), and the number of corners.
fn solid_facets(cells: &[(CellKind, Vec<u32>)]) -> impl Iterator<Item = (Vec<u32>, [u32; 4], usize)> + '_ {
    let solids = cells.iter().filter(|(kind, _)| kind.dimension() == 3);
    solids.flat_map(|(kind, nodes)| {
        kind.facets().iter().map(|facet| {
            let nodes: Vec<u32> = facet.nodes.iter().map(|&local| nodes[local]).collect();
            let n = facet.kind.n_corners();
            let corners = [0, 1, 2, 3].map(|i| if i < n { nodes[i] } else { u32::MAX });
            (nodes, corners, n)
        })
    })
}

fn sorted(corners: &[u32; 4]) -> [u32; 4] {
    let mut corners = *corners;
    corners.sort_unstable();
    corners
}

#[cfg(test)]
mod tests {
    use emmy::internals::element::element;
    use emmy::mesh::{block, l_block};

    use super::*;

    fn area(points: &[[f64; 3]], surface: &Surface) -> f64 {
        let at = |node: u32| points[surface.nodes[node as usize] as usize];
        let side = |a: [f64; 3], b: [f64; 3]| [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let triangle = |&[a, b, c]: &[u32; 3]| {
            let (u, v) = (side(at(a), at(b)), side(at(a), at(c)));
            let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            0.5 * n.iter().map(|n| n * n).sum::<f64>().sqrt()
        };
        surface.triangles.iter().map(triangle).sum()
    }

    fn cell(kind: CellKind) -> (Vec<[f64; 3]>, Surface) {
        let nodes = element(kind).nodes().to_vec();
        let surface = Surface::new(&[(kind, (0..nodes.len() as u32).collect())]);
        (nodes, surface)
    }

    #[test]
    fn the_block_shows_its_sides_and_nothing_inside() {
        let mesh = l_block(1.0).unwrap();
        let cells: Vec<_> = mesh.cells().map(|cell| (cell.kind, cell.nodes.to_vec())).collect();
        let surface = Surface::new(&cells);
        // Two L of 39 squares, and the rim of 32 x 3 between them.
        assert_eq!((surface.triangles.len(), area(mesh.points(), &surface).round()), (2 * 174, 174.0));
        // A closed surface of squares has twice as many edges as facets.
        assert_eq!(surface.edges.len(), 2 * 174);
        assert!(surface.nodes.len() == 174 + 2 && surface.links.is_empty());
    }

    #[test]
    fn quadratic_facets_are_divided_at_their_nodes_and_covered_once() {
        let (root3, root2) = (3f64.sqrt(), 2f64.sqrt());
        let tetrahedron = 1.5 + 0.5 * root3;
        for (kind, n_triangles, expected) in [
            (CellKind::Hex20, 6 * 6, 24.0),
            (CellKind::Hex27, 6 * 8, 24.0),
            (CellKind::Tet10, 4 * 4, tetrahedron),
            (CellKind::Wedge15, 2 * 4 + 3 * 6, 1.0 + 2.0 * (2.0 + root2)),
            (CellKind::Pyramid13, 6 + 4 * 4, 4.0 * (1.0 + root2)),
            (CellKind::Quad8, 6, 4.0),
            (CellKind::Quad9, 8, 4.0),
            (CellKind::Tri6, 4, 0.5),
        ] {
            let (points, surface) = cell(kind);
            assert_eq!(surface.triangles.len(), n_triangles, "{kind}");
            assert!(
                (area(&points, &surface) - expected).abs() < 1e-12,
                "{kind}: {}",
                area(&points, &surface)
            );
        }
    }

    /// The cells list the nodes of their facets in different orders.
    #[test]
    fn a_triangle_between_two_cells_is_inside() {
        for second in [[1, 2, 3, 4], [1, 3, 2, 4], [3, 2, 1, 4], [4, 1, 2, 3], [2, 4, 3, 1]] {
            let surface =
                Surface::new(&[(CellKind::Tet4, vec![0, 1, 2, 3]), (CellKind::Tet4, second.to_vec())]);
            assert_eq!((surface.triangles.len(), surface.edges.len()), (6, 9), "{second:?}");
        }
    }

    #[test]
    fn regions_have_their_own_closed_surfaces() {
        let mesh = block([2.0, 1.0, 1.0], [2, 1, 1]).unwrap();
        let cells: Vec<_> = mesh.cells().map(|cell| (cell.kind, cell.nodes.to_vec())).collect();
        assert_eq!(Surface::of_regions(cells.clone(), &[3, 3]), Surface::new(&cells));
        let centre = (CellKind::Line2, vec![0; 2]);
        let all = [cells, vec![centre]].concat();
        let surface = Surface::of_regions(all, &[1, 0, -1]);
        let region = |number: i32, n: usize, n_inside: usize| RegionNodes { number, n, n_inside };
        // Four nodes are of both cubes; the centre is a corner of one.
        assert_eq!(surface.regions, [region(-1, 1, 0), region(0, 8, 4), region(1, 8, 3)]);
        assert_eq!((surface.nodes.len(), surface.links.as_slice()), (17, &[[0, 0]][..]));
        assert_eq!((surface.triangles.len(), area(mesh.points(), &surface)), (24, 12.0));
        assert!(surface.triangles[..12].iter().flatten().all(|node| (1..9).contains(node)));
        let is_in_the_middle = |&node: &u32| mesh.points()[node as usize][0] == 1.0;
        assert!(surface.nodes[5..9].iter().all(is_in_the_middle));
        assert!(!surface.nodes[1..5].iter().any(is_in_the_middle));
    }

    #[test]
    fn links_are_lines() {
        let surface = Surface::new(&[(CellKind::Line2, vec![4, 2]), (CellKind::Line2, vec![2, 9])]);
        assert_eq!((surface.nodes, surface.links), (vec![2, 4, 9], vec![[1, 0], [0, 2]]));
    }
}
