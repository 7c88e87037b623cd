//! Coarsening of a surface: the nodes in each box of a grid become one of them (vertex clustering, Rossignac and Borrel
//! 1993).

use std::collections::{BTreeSet, HashMap};

use super::surface::{RegionNodes, Surface};

/// The surface with at most `limit` of its nodes: of the nodes of a region in a box, the one nearest to their mean
/// stays. `points`: of the mesh.
pub(super) fn coarsened(surface: Surface, points: &[[f64; 3]], limit: usize) -> Surface {
    if surface.nodes.len() <= limit {
        return surface;
    }
    let at = |node: usize| points[surface.nodes[node] as usize];
    let n = surface.nodes.len();
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for node in 0..n {
        for i in 0..3 {
            (low[i], high[i]) = (low[i].min(at(node)[i]), high[i].max(at(node)[i]));
        }
    }
    let longest = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
    let ends = ends(&surface.regions);
    let boxes = |divisions: usize| -> HashMap<(usize, [u32; 3]), Vec<u32>> {
        let mut boxes: HashMap<_, Vec<u32>> = HashMap::new();
        for node in 0..n {
            let place = [0, 1, 2].map(|i| ((at(node)[i] - low[i]) / longest * divisions as f64) as u32);
            let region = ends.partition_point(|&[_, end]| end <= node);
            boxes.entry((region, place)).or_default().push(node as u32);
        }
        boxes
    };
    // The largest number of divisions that leaves few enough boxes.
    let mut few = 1;
    let mut many = 2 * n;
    while many - few > 1 {
        let middle = few + (many - few) / 2;
        if boxes(middle).len() <= limit { few = middle } else { many = middle }
    }
    let mut representative = vec![0; n];
    for members in boxes(few).values() {
        let mean =
            [0, 1, 2].map(|i| members.iter().map(|&m| at(m as usize)[i]).sum::<f64>() / members.len() as f64);
        let distance = |m: u32| (0..3).map(|i| (at(m as usize)[i] - mean[i]).powi(2)).sum::<f64>();
        let nearest =
            members.iter().copied().min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
        members.iter().for_each(|&member| representative[member as usize] = nearest);
    }
    replaced(&surface, &representative)
}

/// Ends of the inner nodes and of all nodes of each region.
fn ends(regions: &[RegionNodes]) -> Vec<[usize; 2]> {
    let of_region = |start: &mut usize, own: &RegionNodes| {
        let inside = *start + own.n_inside;
        *start += own.n;
        Some([inside, *start])
    };
    regions.iter().scan(0, of_region).collect()
}

/// The surface with nodes replaced by others; collapsed triangles and lines are left out.
fn replaced(surface: &Surface, representative: &[u32]) -> Surface {
    let new = |node: u32| representative[node as usize];
    let mut seen = BTreeSet::new();
    let mut triangles = Vec::new();
    let mut edges = BTreeSet::new();
    for triangle in surface.triangles.iter().map(|triangle| triangle.map(new)) {
        let [a, b, c] = triangle;
        let mut key = triangle;
        key.sort_unstable();
        if a != b && b != c && c != a && seen.insert(key) {
            triangles.push(triangle);
            edges.extend([[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]));
        }
    }
    let links: BTreeSet<[u32; 2]> =
        surface.links.iter().map(|link| link.map(new)).filter(|[a, b]| a != b).collect();
    let used: BTreeSet<u32> = triangles.iter().flatten().chain(links.iter().flatten()).copied().collect();
    let number: HashMap<u32, u32> = used.iter().enumerate().map(|(new, &old)| (old, new as u32)).collect();
    let mut start = 0;
    let of_region = |(own, ends): (&RegionNodes, [usize; 2])| {
        let [inside, end] = ends.map(|end| used.range(..end as u32).count());
        let before = std::mem::replace(&mut start, end);
        RegionNodes { number: own.number, n: end - before, n_inside: inside - before }
    };
    Surface {
        regions: surface.regions.iter().zip(ends(&surface.regions)).map(of_region).collect(),
        nodes: used.iter().map(|&node| surface.nodes[node as usize]).collect(),
        triangles: triangles.into_iter().map(|triangle| triangle.map(|node| number[&node])).collect(),
        edges: edges.into_iter().map(|edge| edge.map(|node| number[&node])).collect(),
        links: links.into_iter().map(|link| link.map(|node| number[&node])).collect(),
    }
}

#[cfg(test)]
mod tests {
    use emmy::mesh::block;

    use super::*;

    #[test]
    fn a_coarser_block_is_closed_and_as_large() {
        let mesh = block([2.0, 1.0, 1.0], [32, 16, 16]).unwrap();
        let cells: Vec<_> = mesh.cells().map(|cell| (cell.kind, cell.nodes.to_vec())).collect();
        let fine = Surface::new(&cells);
        let coarse = coarsened(fine.clone(), mesh.points(), 500);
        assert!(coarse.nodes.len() <= 500 && coarse.nodes.len() > 200, "{}", coarse.nodes.len());
        assert!(coarse.nodes.iter().all(|node| fine.nodes.contains(node)));
        // Every edge of a closed surface belongs to two triangles.
        assert_eq!(2 * coarse.edges.len(), 3 * coarse.triangles.len());
        assert_eq!(coarsened(fine.clone(), mesh.points(), 10_000), fine);
    }

    #[test]
    fn regions_are_coarsened_by_themselves() {
        let mesh = block([2.0, 1.0, 1.0], [32, 16, 16]).unwrap();
        let cells: Vec<_> = mesh.cells().map(|cell| (cell.kind, cell.nodes.to_vec())).collect();
        let of_cell = |(_, nodes): &(_, Vec<u32>)| {
            let middle = nodes.iter().map(|&node| mesh.points()[node as usize][0]).sum::<f64>() / 8.0;
            i32::from(middle > 1.0)
        };
        let regions: Vec<i32> = cells.iter().map(of_cell).collect();
        let coarse = coarsened(Surface::of_regions(cells, &regions), mesh.points(), 500);
        let [a, b] = &coarse.regions[..] else { panic!("two regions") };
        assert!(a.n + b.n == coarse.nodes.len() && (200..=500).contains(&coarse.nodes.len()));
        let x = |node: usize| mesh.points()[coarse.nodes[node] as usize][0];
        assert!((0..a.n_inside).all(|node| x(node) < 1.0) && (a.n_inside..a.n).all(|node| x(node) == 1.0));
        assert!((a.n..a.n + b.n_inside).all(|node| x(node) > 1.0));
        let is_first = |triangle: &[u32; 3]| triangle.map(|node| (node as usize) < a.n);
        assert!(coarse.triangles.iter().map(is_first).all(|own| own == [true; 3] || own == [false; 3]));
        // Both are closed.
        assert_eq!(2 * coarse.edges.len(), 3 * coarse.triangles.len());
    }
}
