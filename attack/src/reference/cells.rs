//! Shape functions and quadrature of cells and facets, written down one by one.

use super::dual::Dual;
use super::numbers::gauss;

/// A kind of cell or facet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Two nodes.
    Line2,
    /// Two nodes and their middle.
    Line3,
    /// Triangle of three nodes.
    Tri3,
    /// Triangle with nodes at its edges.
    Tri6,
    /// Bilinear quadrilateral.
    Quad4,
    /// Quadrilateral with nodes at its edges.
    Quad8,
    /// Tetrahedron of four nodes.
    Tet4,
    /// Tetrahedron with nodes at its edges.
    Tet10,
    /// Wedge of six nodes.
    Wedge6,
    /// Trilinear hexahedron.
    Hex8,
    /// Hexahedron with nodes at its edges.
    Hex20,
    /// Biquadratic quadrilateral.
    Quad9,
    /// Wedge with nodes at its edges.
    Wedge15,
    /// Triquadratic hexahedron.
    Hex27,
}

/// Points with weights.
pub type Rule = Vec<([f64; 3], f64)>;

const CUBE: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

impl Kind {
    /// Number of its corners.
    pub fn corners(self) -> usize {
        match self {
            Kind::Line2 | Kind::Line3 => 2,
            Kind::Tri3 | Kind::Tri6 => 3,
            Kind::Quad4 | Kind::Quad8 | Kind::Quad9 | Kind::Tet4 | Kind::Tet10 => 4,
            Kind::Wedge6 | Kind::Wedge15 => 6,
            Kind::Hex8 | Kind::Hex20 | Kind::Hex27 => 8,
        }
    }

    /// Corners with a node in their middle, in the order of Gmsh.
    pub fn middles(self) -> &'static [&'static [usize]] {
        static HEX27: [&[usize]; 19] = [
            &[0, 1],
            &[0, 3],
            &[0, 4],
            &[1, 2],
            &[1, 5],
            &[2, 3],
            &[2, 6],
            &[3, 7],
            &[4, 5],
            &[4, 7],
            &[5, 6],
            &[6, 7],
            &[0, 3, 2, 1],
            &[0, 1, 5, 4],
            &[0, 4, 7, 3],
            &[1, 2, 6, 5],
            &[2, 3, 7, 6],
            &[4, 5, 6, 7],
            &[0, 1, 2, 3, 4, 5, 6, 7],
        ];
        match self {
            Kind::Line3 => &[&[0, 1]],
            Kind::Tri6 => &[&[0, 1], &[1, 2], &[2, 0]],
            Kind::Quad8 => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
            Kind::Quad9 => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0], &[0, 1, 2, 3]],
            Kind::Tet10 => &[&[0, 1], &[1, 2], &[2, 0], &[3, 0], &[3, 2], &[3, 1]],
            Kind::Wedge15 => {
                &[&[0, 1], &[0, 2], &[0, 3], &[1, 2], &[1, 4], &[2, 5], &[3, 4], &[3, 5], &[4, 5]]
            }
            Kind::Hex20 => HEX27.split_at(12).0,
            Kind::Hex27 => &HEX27,
            _ => &[],
        }
    }

    /// Its facets by corners.
    pub fn facets(self) -> &'static [&'static [usize]] {
        match self {
            Kind::Tri3 | Kind::Tri6 => &[&[0, 1], &[1, 2], &[2, 0]],
            Kind::Quad4 | Kind::Quad8 | Kind::Quad9 => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
            Kind::Tet4 | Kind::Tet10 => &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]],
            Kind::Wedge6 | Kind::Wedge15 => {
                &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]]
            }
            Kind::Hex8 | Kind::Hex20 | Kind::Hex27 => {
                &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
            }
            Kind::Line2 | Kind::Line3 => &[],
        }
    }

    /// The kind of a facet with some corners.
    pub fn facet(self, corners: usize) -> Kind {
        let is_quadratic = !self.middles().is_empty();
        match (corners, is_quadratic) {
            (4, true) if self == Kind::Hex27 => Kind::Quad9,
            (2, false) => Kind::Line2,
            (2, true) => Kind::Line3,
            (3, false) => Kind::Tri3,
            (3, true) => Kind::Tri6,
            (_, false) => Kind::Quad4,
            (_, true) => Kind::Quad8,
        }
    }

    /// Number of the element type in Gmsh's files.
    pub fn gmsh(self) -> usize {
        match self {
            Kind::Line2 => 1,
            Kind::Tri3 => 2,
            Kind::Quad4 => 3,
            Kind::Tet4 => 4,
            Kind::Hex8 => 5,
            Kind::Wedge6 => 6,
            Kind::Line3 => 8,
            Kind::Tri6 => 9,
            Kind::Tet10 => 11,
            Kind::Quad8 => 16,
            Kind::Hex20 => 17,
            Kind::Quad9 => 10,
            Kind::Wedge15 => 18,
            Kind::Hex27 => 12,
        }
    }

    /// Dimension of its reference cell.
    pub fn dimension(self) -> usize {
        match self {
            Kind::Line2 | Kind::Line3 => 1,
            Kind::Tri3 | Kind::Tri6 | Kind::Quad4 | Kind::Quad8 | Kind::Quad9 => 2,
            _ => 3,
        }
    }

    /// Shape functions as duals by the reference coordinates.
    pub fn shapes(self, at: [f64; 3]) -> Vec<Dual> {
        let xi: [Dual; 3] = std::array::from_fn(|d| Dual::variable(at[d], d));
        let one = Dual::constant(1.0);
        let between = |xi: Dual, end: f64| (xi * end + 1.0) * 0.5;
        match self {
            Kind::Line2 => vec![between(xi[0], -1.0), between(xi[0], 1.0)],
            Kind::Line3 => {
                let x = xi[0];
                vec![x * (x - 1.0) * 0.5, x * (x + 1.0) * 0.5, one - x * x]
            }
            Kind::Tri3 | Kind::Tet4 | Kind::Tri6 | Kind::Tet10 => {
                let n = self.dimension();
                let rest = xi[..n].iter().fold(one, |sum, &x| sum - x);
                let linear: Vec<Dual> = [rest].into_iter().chain(xi[..n].iter().copied()).collect();
                if self.middles().is_empty() {
                    return linear;
                }
                let corners = linear.iter().map(|&l| l * (l * 2.0 - 1.0));
                corners
                    .chain(self.middles().iter().map(|ends| linear[ends[0]] * linear[ends[1]] * 4.0))
                    .collect()
            }
            Kind::Wedge6 => {
                let linear = [one - xi[0] - xi[1], xi[0], xi[1]];
                let ends = [between(xi[2], -1.0), between(xi[2], 1.0)];
                ends.iter().flat_map(|&end| linear.map(|l| l * end)).collect()
            }
            Kind::Quad4 => (0..4).map(|c| between(xi[0], CUBE[c][0]) * between(xi[1], CUBE[c][1])).collect(),
            Kind::Hex8 => {
                let corner =
                    |c: &[f64; 3]| between(xi[0], c[0]) * between(xi[1], c[1]) * between(xi[2], c[2]);
                CUBE.iter().map(corner).collect()
            }
            Kind::Quad8 | Kind::Hex20 => {
                let n = self.dimension();
                let product = |c: &[f64; 3]| (0..n).fold(one, |p, d| p * between(xi[d], c[d]));
                let sum = |c: &[f64; 3]| (0..n).fold(Dual::constant(1.0 - n as f64), |s, d| s + xi[d] * c[d]);
                let corners = CUBE[..self.corners()].iter().map(|c| product(c) * sum(c));
                let edge = |ends: &&[usize]| {
                    let [a, b] = [ends[0], ends[1]];
                    (0..n).fold(one, |p, d| match CUBE[a][d] == CUBE[b][d] {
                        true => p * between(xi[d], CUBE[a][d]),
                        false => p * (one - xi[d] * xi[d]),
                    })
                };
                corners.chain(self.middles().iter().map(edge)).collect()
            }
            Kind::Quad9 | Kind::Hex27 => {
                let n = self.dimension();
                // -1, 0 or 1 along each axis.
                let place = |corners: &[usize], d: usize| {
                    corners.iter().map(|&c| CUBE[c][d]).sum::<f64>() / corners.len() as f64
                };
                let along = |x: Dual, node: f64| match node == 0.0 {
                    true => one - x * x,
                    false => x * (x + node) * 0.5,
                };
                let shape = |corners: &[usize]| (0..n).fold(one, |p, d| p * along(xi[d], place(corners, d)));
                let corners = (0..self.corners()).map(|corner| shape(&[corner]));
                corners.chain(self.middles().iter().map(|corners| shape(corners))).collect()
            }
            Kind::Wedge15 => {
                let linear = [one - xi[0] - xi[1], xi[0], xi[1]];
                let ends = [between(xi[2], -1.0), between(xi[2], 1.0)];
                let bubble = one - xi[2] * xi[2];
                let corner = |c: usize| {
                    let (l, end) = (linear[c % 3], ends[c / 3]);
                    l * (l * 2.0 - 1.0) * end - l * bubble * 0.5
                };
                let middle = |pair: &&[usize]| {
                    let [a, b] = [pair[0], pair[1]];
                    match a % 3 == b % 3 {
                        true => linear[a % 3] * bubble,
                        false => linear[a % 3] * linear[b % 3] * ends[a / 3] * 4.0,
                    }
                };
                (0..6).map(corner).chain(self.middles().iter().map(middle)).collect()
            }
        }
    }

    /// Middle of the reference cell.
    pub fn middle(self) -> [f64; 3] {
        match self {
            Kind::Tri3 | Kind::Tri6 => [1.0 / 3.0, 1.0 / 3.0, 0.0],
            Kind::Tet4 | Kind::Tet10 => [0.25; 3],
            Kind::Wedge6 | Kind::Wedge15 => [1.0 / 3.0, 1.0 / 3.0, 0.0],
            _ => [0.0; 3],
        }
    }

    /// Rule of the strain energy, with the number of points of the table in `book/src/input.md`.
    pub fn strain_rule(self) -> Rule {
        let third = 1.0 / 3.0;
        let triangle = [[1.0 / 6.0, 1.0 / 6.0], [2.0 * third, 1.0 / 6.0], [1.0 / 6.0, 2.0 * third]];
        match self {
            Kind::Tri3 => vec![([third, third, 0.0], 0.5)],
            Kind::Tri6 => triangle.iter().map(|&[x, y]| ([x, y, 0.0], 1.0 / 6.0)).collect(),
            Kind::Tet4 => vec![([0.25; 3], 1.0 / 6.0)],
            Kind::Tet10 => {
                let a = (5.0 - 5f64.sqrt()) / 20.0;
                let b = 1.0 - 3.0 * a;
                [[a, a, a], [b, a, a], [a, b, a], [a, a, b]].map(|point| (point, 1.0 / 24.0)).to_vec()
            }
            Kind::Wedge6 => {
                let ends = gauss(2);
                let layer = |&(z, w): &(f64, f64)| triangle.map(|[x, y]| ([x, y, 2.0 * z - 1.0], w / 3.0));
                ends.iter().flat_map(layer).collect()
            }
            Kind::Wedge15 => {
                let triangle = Kind::Tri6.facet_rule();
                let layer = |&(z, w): &(f64, f64)| {
                    triangle
                        .iter()
                        .map(move |([x, y, _], v)| ([*x, *y, 2.0 * z - 1.0], 2.0 * w * v))
                        .collect::<Rule>()
                };
                gauss(3).iter().flat_map(layer).collect()
            }
            _ => self.product_rule(if self.middles().is_empty() { 2 } else { 3 }),
        }
    }

    /// Rule of the mass, with the number of points of `book/src/input.md`.
    pub fn mass_rule(self) -> Rule {
        match self {
            Kind::Tri3 => Kind::Tri6.strain_rule(),
            Kind::Tet4 => Kind::Tet10.strain_rule(),
            Kind::Tri6 => self.facet_rule(),
            Kind::Tet10 => {
                // Walkington (2000): 14 points of degree 5.
                let mut rule = Rule::new();
                for (a, w) in [
                    (0.310_885_919_263_300_6, 0.112_687_925_718_015_85),
                    (0.092_735_250_310_891_23, 0.073_493_043_116_361_95),
                ] {
                    let b = 1.0 - 3.0 * a;
                    rule.extend([[a, a, a], [b, a, a], [a, b, a], [a, a, b]].map(|point| (point, w / 6.0)));
                }
                let (a, w) = (0.045_503_704_125_649_65, 0.042_546_020_777_081_466);
                let b = 0.5 - a;
                let edges = [[a, a, b], [a, b, a], [b, a, a], [a, b, b], [b, a, b], [b, b, a]];
                rule.extend(edges.map(|point| (point, w / 6.0)));
                rule
            }
            _ => self.strain_rule(),
        }
    }

    /// Rule of a facet.
    pub fn facet_rule(self) -> Rule {
        match self {
            Kind::Tri3 => Kind::Tri6.strain_rule(),
            Kind::Tri6 => {
                // Six points of degree 4, in closed form.
                let mut rule = Rule::new();
                for sign in [1.0, -1.0] {
                    let root = 10f64.sqrt();
                    let a = (8.0 - root + sign * (38.0 - 44.0 * 0.4f64.sqrt()).sqrt()) / 18.0;
                    let w = (620.0 + sign * (213_125.0 - 53_320.0 * root).sqrt()) / 3720.0;
                    let b = 1.0 - 2.0 * a;
                    rule.extend([[a, a, 0.0], [b, a, 0.0], [a, b, 0.0]].map(|point| (point, 0.5 * w)));
                }
                rule
            }
            _ => self.strain_rule(),
        }
    }

    /// Gauss' rule along each axis.
    fn product_rule(self, n: usize) -> Rule {
        let mut rule = vec![([0.0; 3], 1.0)];
        for d in 0..self.dimension() {
            let extend = |(point, weight): &([f64; 3], f64)| {
                let (point, weight) = (*point, *weight);
                gauss(n).into_iter().map(move |(x, w)| {
                    let mut point = point;
                    point[d] = 2.0 * x - 1.0;
                    (point, 2.0 * w * weight)
                })
            };
            rule = rule.iter().flat_map(extend).collect();
        }
        rule
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `a! b! c! d! / (a + b + c + d + n)!` is the integral of barycentric powers over the simplex of dimension n.
    #[test]
    fn rules_of_simplices_are_exact() {
        let factorial = |n: usize| (1..=n).map(|i| i as f64).product::<f64>();
        for (kind, degree) in [(Kind::Tri3, 2), (Kind::Tri6, 4), (Kind::Tet4, 2), (Kind::Tet10, 5)] {
            let n = kind.dimension();
            for a in 0..=degree {
                for b in 0..=degree - a {
                    for c in 0..=if n == 3 { degree - a - b } else { 0 } {
                        let powers = [a, b, c].map(|power| power as i32);
                        let term = |(x, w): &([f64; 3], f64)| {
                            w * (0..3).map(|d| x[d].powi(powers[d])).product::<f64>()
                        };
                        let sum: f64 = kind.mass_rule().iter().map(term).sum();
                        let exact = factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + n);
                        assert!((sum - exact).abs() < 1e-15, "{kind:?} {powers:?}: {sum} {exact}");
                    }
                }
            }
        }
    }

    #[test]
    fn shape_functions_are_one_at_their_nodes_and_add_up_to_one() {
        let linear = [Kind::Wedge6, Kind::Hex8];
        let quadratic =
            [Kind::Tri6, Kind::Quad8, Kind::Quad9, Kind::Tet10, Kind::Wedge15, Kind::Hex20, Kind::Hex27];
        for kind in linear.into_iter().chain(quadratic) {
            for (at, _) in kind.strain_rule() {
                let shapes = kind.shapes(at);
                let sum = shapes.iter().skip(1).fold(shapes[0], |sum, &shape| sum + shape);
                assert!(
                    (sum.value - 1.0).abs() < 1e-14 && sum.by.iter().all(|d| d.abs() < 1e-14),
                    "{kind:?}"
                );
            }
        }
    }
}
