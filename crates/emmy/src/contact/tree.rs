//! A tree of bounding boxes.

/// A box in space: its lowest and its highest corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lowest coordinates \[length\].
    pub low: [f64; 3],
    /// Highest coordinates \[length\].
    pub high: [f64; 3],
}

impl Bounds {
    /// The box of nothing.
    pub const NONE: Bounds = Bounds { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    /// The box of one point.
    pub fn of(point: [f64; 3]) -> Bounds {
        Bounds { low: point, high: point }
    }

    /// The box of both.
    pub fn with(self, other: Bounds) -> Bounds {
        let low = [0, 1, 2].map(|d| self.low[d].min(other.low[d]));
        Bounds { low, high: [0, 1, 2].map(|d| self.high[d].max(other.high[d])) }
    }

    /// The box of all points at most a length away along each axis.
    pub fn inflated(self, length: f64) -> Bounds {
        Bounds { low: self.low.map(|x| x - length), high: self.high.map(|x| x + length) }
    }

    /// The box of all points of this one times a factor.
    pub fn scaled(self, factor: f64) -> Bounds {
        let [low, high] = [self.low, self.high].map(|corner| corner.map(|x| factor * x));
        if factor < 0.0 { Bounds { low: high, high: low } } else { Bounds { low, high } }
    }

    /// The box of all sums of a point in this one and a point in another.
    pub fn sum(self, other: Bounds) -> Bounds {
        let low = [0, 1, 2].map(|d| self.low[d] + other.low[d]);
        Bounds { low, high: [0, 1, 2].map(|d| self.high[d] + other.high[d]) }
    }

    /// Whether both have a common point. A coordinate that is no number counts as common.
    pub fn meets(&self, other: &Bounds) -> bool {
        (0..3).all(|d| !(self.low[d] > other.high[d] || other.low[d] > self.high[d]))
    }

    /// Whether it contains a box.
    pub fn contains(&self, other: &Bounds) -> bool {
        (0..3).all(|d| self.low[d] <= other.low[d] && other.high[d] <= self.high[d])
    }

    /// Length of its longest side.
    pub fn extent(&self) -> f64 {
        (0..3).map(|d| self.high[d] - self.low[d]).fold(0.0, f64::max)
    }

    fn half_area(&self) -> f64 {
        let [a, b, c] = [0, 1, 2].map(|d| (self.high[d] - self.low[d]).max(0.0));
        a * b + b * c + c * a
    }
}

/// Some numbered boxes in a binary tree, to find those that meet another box in a time that grows with their logarithm.
///
/// The tree splits at the median along the longest side. [`BoxTree::fit`] gives the boxes other sizes and places at the
/// cost of one pass, and rebuilds the tree where its boxes overlap too much.
///
/// ```
/// use emmy::internals::contact::{Bounds, BoxTree};
/// let boxes: Vec<Bounds> = (0..100).map(|i| Bounds::of([i as f64, 0.0, 0.0])).collect();
/// let mut tree = BoxTree::default();
/// tree.fit(&boxes, 0..100);
/// let mut found = Vec::new();
/// tree.for_each_meeting(&boxes, &Bounds::of([30.0, 0.0, 0.0]).inflated(1.5), &mut |number| found.push(number));
/// found.sort();
/// assert_eq!(found, [29, 30, 31]);
/// ```
#[derive(Debug, Clone, Default)]
pub struct BoxTree {
    /// Boxes of the nodes: root at 1, children of i at 2 i and 2 i + 1.
    nodes: Vec<Bounds>,
    /// Numbers in the order of the leaves.
    order: Vec<u32>,
    /// Number of leaves, a power of two.
    n_leaves: usize,
    /// Sum of the areas of all boxes of nodes when the tree was built.
    built_area: f64,
}

/// Most things in a leaf.
const IN_LEAF: usize = 4;

/// The tree is rebuilt where the sum of the areas of its boxes has grown by this factor.
const SPOILT: f64 = 2.0;

impl BoxTree {
    /// Sets the boxes; `members`: the numbers of those in the tree, the same in each call.
    pub fn fit(&mut self, boxes: &[Bounds], members: impl ExactSizeIterator<Item = u32>) {
        let is_new = self.nodes.is_empty() || self.order.len() != members.len();
        if is_new || self.refit(boxes) > SPOILT * self.built_area {
            self.build(boxes, members);
        }
    }

    fn build(&mut self, boxes: &[Bounds], members: impl Iterator<Item = u32>) {
        self.order.clear();
        self.order.extend(members);
        self.n_leaves = self.order.len().div_ceil(IN_LEAF).max(1).next_power_of_two();
        self.nodes.clear();
        self.nodes.resize(2 * self.n_leaves, Bounds::NONE);
        let mut order = std::mem::take(&mut self.order);
        let levels = self.n_leaves.ilog2();
        split(&mut order, boxes, levels);
        self.order = order;
        self.built_area = self.refit(boxes);
    }

    /// Sets all boxes from below; returns the sum of their areas.
    fn refit(&mut self, boxes: &[Bounds]) -> f64 {
        for leaf in 0..self.n_leaves {
            let members = self.members(leaf);
            self.nodes[self.n_leaves + leaf] = (self.order[members].iter())
                .fold(Bounds::NONE, |sum, number| sum.with(boxes[*number as usize]));
        }
        for node in (1..self.n_leaves).rev() {
            self.nodes[node] = self.nodes[2 * node].with(self.nodes[2 * node + 1]);
        }
        self.nodes[1..].iter().map(Bounds::half_area).sum()
    }

    /// Places of the members of a leaf in the order.
    fn members(&self, leaf: usize) -> std::ops::Range<usize> {
        let n = self.order.len();
        leaf * n / self.n_leaves..(leaf + 1) * n / self.n_leaves
    }

    /// The box of everything.
    pub fn bounds(&self) -> Bounds {
        self.nodes.get(1).copied().unwrap_or(Bounds::NONE)
    }

    /// Calls a function with the numbers of all boxes, as they were set last, that meet a box.
    pub fn for_each_meeting(&self, boxes: &[Bounds], query: &Bounds, visit: &mut dyn FnMut(u32)) {
        if !self.order.is_empty() {
            self.descend(1, (boxes, query), visit);
        }
    }

    fn descend(&self, node: usize, (boxes, query): (&[Bounds], &Bounds), visit: &mut dyn FnMut(u32)) {
        if !self.nodes[node].meets(query) {
            return;
        }
        match node.checked_sub(self.n_leaves) {
            Some(leaf) => {
                let members = self.order[self.members(leaf)].iter();
                members
                    .filter(|number| boxes[**number as usize].meets(query))
                    .for_each(|number| visit(*number));
            }
            None => {
                self.descend(2 * node, (boxes, query), visit);
                self.descend(2 * node + 1, (boxes, query), visit);
            }
        }
    }
}

/// Orders numbers so that each half of them, down to the leaves, is on one side along the longest extent of the
/// centres.
fn split(order: &mut [u32], boxes: &[Bounds], levels: u32) {
    if levels == 0 || order.len() < 2 {
        return;
    }
    let centre = |number: u32| {
        let own = &boxes[number as usize];
        [0, 1, 2].map(|d| own.low[d] + own.high[d])
    };
    let all = order.iter().fold(Bounds::NONE, |sum, number| sum.with(Bounds::of(centre(*number))));
    let longest = (0..3).max_by(|&a, &b| (all.high[a] - all.low[a]).total_cmp(&(all.high[b] - all.low[b])));
    let axis = longest.unwrap_or(0);
    let middle = order.len() / 2;
    order
        .select_nth_unstable_by(middle, |&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b)));
    let (left, right) = order.split_at_mut(middle);
    split(left, boxes, levels - 1);
    split(right, boxes, levels - 1);
}

#[cfg(test)]
mod tests {
    use super::super::tests::Random;
    use super::*;

    /// Boxes at random places.
    fn boxes(random: &mut Random, n: usize) -> Vec<Bounds> {
        let mut corner = || [random.number(), random.number(), random.number()];
        (0..n).map(|_| Bounds::of(corner()).inflated(0.05)).collect()
    }

    #[test]
    fn all_boxes_that_meet_a_box_are_found() {
        let mut random = Random(3);
        let mut tree = BoxTree::default();
        for n in [0, 1, 2, 5, 17, 300, 300, 300, 64] {
            let all = boxes(&mut random, n);
            tree.fit(&all, 0..n as u32);
            for _ in 0..20 {
                let query = Bounds::of([random.number(), random.number(), random.number()]).inflated(0.1);
                let mut found = Vec::new();
                tree.for_each_meeting(&all, &query, &mut |number| found.push(number));
                found.sort_unstable();
                let expected: Vec<u32> = (0..n as u32).filter(|i| all[*i as usize].meets(&query)).collect();
                assert_eq!(found, expected);
            }
        }
    }

    #[test]
    fn numbers_that_are_none_meet_everything() {
        let nowhere = Bounds { low: [f64::NAN; 3], high: [f64::NAN; 3] };
        assert!(nowhere.meets(&Bounds::of([1.0; 3])) && !Bounds::NONE.meets(&Bounds::of([1.0; 3])));
    }
}
