//! Conditions on every reference element, checked for each in one line.

use super::*;
use crate::tensor::cross;
use proptest::prelude::*;

/// Kronecker delta at the nodes, partition of unity, completeness, gradients, and the measure of the domain.
fn conforms<const D: usize>(
    element: &dyn ReferenceElement<D>,
    domain: Domain,
    degree: i32,
    points: &[[f64; D]],
) {
    is_nodal(element);
    for &xi in points {
        reproduces_polynomials(element, degree, xi);
        gradient_is_the_derivative(element, domain, xi);
    }
    integrates_products(element, domain);
}

/// Reference domain of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Domain {
    Cube,
    Simplex,
    Wedge,
    Pyramid,
}

impl Domain {
    fn of(kind: CellKind) -> Self {
        match kind.info().shape {
            CellShape::Tetrahedron | CellShape::Triangle => Domain::Simplex,
            CellShape::Wedge => Domain::Wedge,
            CellShape::Pyramid => Domain::Pyramid,
            CellShape::Hexahedron | CellShape::Quadrilateral | CellShape::Line => Domain::Cube,
        }
    }

    /// Factor that turns the shape functions into polynomials, a function of the last coordinate.
    fn denominator<const D: usize>(self, xi: [f64; D]) -> f64 {
        if self == Domain::Pyramid { 1.0 - xi[D - 1] } else { 1.0 }
    }

    fn denominator_slope<const D: usize>(self, i: usize) -> f64 {
        if self == Domain::Pyramid && i == D - 1 { -1.0 } else { 0.0 }
    }

    /// Image of a point of the unit cube, and the determinant of the map there.
    fn image<const D: usize>(self, u: [f64; D]) -> ([f64; D], f64) {
        let line = |u: f64| 2.0 * u - 1.0;
        // x_i = u_i (1 - u_{i+1}) (1 - u_{i+2}) ... in n dimensions
        let shrink = |i: usize, n: usize| u[i + 1..n].iter().map(|v| 1.0 - v).product::<f64>();
        match self {
            Domain::Cube => (u.map(line), 2f64.powi(D as i32)),
            Domain::Simplex => {
                (std::array::from_fn(|i| u[i] * shrink(i, D)), (0..D).map(|i| shrink(i, D)).product())
            }
            Domain::Wedge => {
                let x = |i: usize| if i == D - 1 { line(u[i]) } else { u[i] * shrink(i, D - 1) };
                (std::array::from_fn(x), 2.0 * (0..D - 1).map(|i| shrink(i, D - 1)).product::<f64>())
            }
            Domain::Pyramid => {
                let w = 1.0 - u[D - 1];
                let x = |i: usize| if i == D - 1 { u[i] } else { w * line(u[i]) };
                (std::array::from_fn(x), (2.0 * w).powi(D as i32 - 1))
            }
        }
    }
}

fn shape_at<const D: usize>(element: &dyn ReferenceElement<D>, xi: [f64; D]) -> Vec<f64> {
    let mut N = vec![f64::NAN; element.nodes().len()];
    element.shape(xi, &mut N);
    N
}

fn gradient_at<const D: usize>(element: &dyn ReferenceElement<D>, xi: [f64; D]) -> Vec<[f64; D]> {
    let mut dN = vec![[f64::NAN; D]; element.nodes().len()];
    element.gradient(xi, &mut dN);
    dN
}

fn is_nodal<const D: usize>(element: &dyn ReferenceElement<D>) {
    for (B, &xi) in element.nodes().iter().enumerate() {
        for (A, N) in shape_at(element, xi).into_iter().enumerate() {
            assert_eq!(N, f64::from(u8::from(A == B)), "N_{A} at node {B}");
        }
    }
}

/// Exponents of all monomials of a total degree; the first is 1, the partition of unity.
fn monomials<const D: usize>(degree: i32) -> impl Iterator<Item = [i32; D]> {
    let n = degree + 1;
    (0..n.pow(D as u32))
        .map(move |index| std::array::from_fn(|i| index / n.pow(i as u32) % n))
        .filter(move |exponent: &[i32; D]| exponent.iter().sum::<i32>() <= degree)
}

fn reproduces_polynomials<const D: usize>(element: &dyn ReferenceElement<D>, degree: i32, xi: [f64; D]) {
    let N = shape_at(element, xi);
    for exponent in monomials::<D>(degree) {
        let monomial = |x: [f64; D]| (0..D).map(|i| x[i].powi(exponent[i])).product::<f64>();
        let interpolated: f64 = N.iter().zip(element.nodes()).map(|(N, &node)| N * monomial(node)).sum();
        assert!((interpolated - monomial(xi)).abs() < 1e-13, "{exponent:?} at {xi:?}");
    }
}

/// Where N is rational, it is `d N` that is differentiated, d being the denominator: `(d N)' = d N' + d' N`.
fn gradient_is_the_derivative<const D: usize>(
    element: &dyn ReferenceElement<D>,
    domain: Domain,
    xi: [f64; D],
) {
    let N = shape_at(element, xi);
    let dN = gradient_at(element, xi);
    for i in 0..D {
        let shifted = |h: f64| {
            let x = std::array::from_fn(|j| if i == j { xi[j] + h } else { xi[j] });
            shape_at(element, x).into_iter().map(|N| N * domain.denominator(x)).collect::<Vec<_>>()
        };
        // Four-point difference: exact for functions whose degree in one coordinate is at most four.
        let [m2, m1, p1, p2] = [-0.5, -0.25, 0.25, 0.5].map(shifted);
        for A in 0..dN.len() {
            let difference = (m2[A] - 8.0 * m1[A] + 8.0 * p1[A] - p2[A]) / 3.0;
            let slope = domain.denominator(xi) * dN[A][i] + domain.denominator_slope::<D>(i) * N[A];
            assert!((difference - slope).abs() < 1e-13, "dN_{A}/dx_{i} at {xi:?}");
        }
    }
}

/// The mass rule agrees with a rule of high degree on every product of shape functions.
fn integrates_products<const D: usize>(element: &dyn ReferenceElement<D>, domain: Domain) {
    let n = element.nodes().len();
    let rule = element.mass_quadrature();
    let fine = fine_rule(domain);
    let integral = |rule: &Quadrature<D>, A: usize, B: usize| -> f64 {
        rule.iter().map(|(&xi, w)| w * shape_at(element, xi)[A] * shape_at(element, xi)[B]).sum()
    };
    for A in 0..n {
        for B in 0..=A {
            let error = integral(&rule, A, B) - integral(&fine, A, B);
            assert!(error.abs() < 1e-14, "N_{A} N_{B}: {error:e}");
        }
    }
    let measure: f64 = element.quadrature().weights.iter().sum();
    assert!((measure - fine.weights.iter().sum::<f64>()).abs() < 1e-14);
}

/// Gauss rule of high degree on the unit cube, mapped to a domain.
fn fine_rule<const D: usize>(domain: Domain) -> Quadrature<D> {
    let n = 5usize;
    let line = crate::quadrature::gauss(5);
    let mut rule = Quadrature { points: Vec::new(), weights: Vec::new() };
    for index in 0..n.pow(D as u32) {
        let digits: [usize; D] = std::array::from_fn(|i| index / n.pow(i as u32) % n);
        let (point, det) = domain.image(digits.map(|d| line.points[d][0]));
        rule.points.push(point);
        rule.weights.push(det * digits.map(|d| line.weights[d]).iter().product::<f64>());
    }
    rule
}

/// The rule of the internal force agrees with a rule of high degree on the stiffness of an undistorted cell.
fn integrates_stiffness<const D: usize>(element: &dyn ReferenceElement<D>, domain: Domain) {
    let rule = element.quadrature();
    let fine = fine_rule(domain);
    let stiffness = |rule: &Quadrature<D>| {
        let mut sums = vec![0.0; (D * element.nodes().len()).pow(2)];
        for (&xi, w) in rule.iter() {
            let dN: Vec<f64> = gradient_at(element, xi).into_iter().flatten().collect();
            let products = dN.iter().flat_map(|a| dN.iter().map(move |b| a * b));
            sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += w * product);
        }
        sums
    };
    for (a, b) in stiffness(&rule).into_iter().zip(stiffness(&fine)) {
        assert!((a - b).abs() < 1e-13, "{a} is not {b}");
    }
}

/// Faces of a cell: tangents make an outward normal, and the facet element is the cell's restricted to the face.
fn facets_conform(kind: CellKind) {
    let cell = element(kind);
    let corners = &cell.nodes()[..kind.n_corners()];
    let centre = [0, 1, 2].map(|i| corners.iter().map(|x| x[i]).sum::<f64>() / corners.len() as f64);
    for facet in kind.facets() {
        let face = facet_element(facet.kind);
        assert_eq!(face.nodes().len(), facet.kind.n_nodes());
        let positions: Vec<[f64; 3]> = facet.nodes.iter().map(|&local| cell.nodes()[local]).collect();
        let on_cell = |s: [f64; 2]| combination(&shape_at(face, s), &positions);
        for (&s, _) in face.quadrature().iter() {
            assert!(flux(&gradient_at(face, s), &positions, on_cell(s), centre) > 0.1, "{kind} {facet:?}");
            is_the_restriction(cell, facet.nodes, &shape_at(face, s), on_cell(s));
        }
        for (&s, &position) in face.nodes().iter().zip(&positions) {
            assert_eq!(on_cell(s), position);
            is_the_restriction(cell, facet.nodes, &shape_at(face, s), position);
        }
    }
}

fn combination(N: &[f64], positions: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|i| N.iter().zip(positions).map(|(N, x)| N * x[i]).sum())
}

/// Cross product of the tangents in the direction away from the centre.
fn flux(dN: &[[f64; 2]], positions: &[[f64; 3]], x: [f64; 3], centre: [f64; 3]) -> f64 {
    let tangent = |d: usize| combination(&dN.iter().map(|dN| dN[d]).collect::<Vec<_>>(), positions);
    let (s, t) = (tangent(0), tangent(1));
    let normal = cross(s, t);
    (0..3).map(|i| normal[i] * (x[i] - centre[i])).sum()
}

/// On a face the cell's functions are the facet's for its nodes and zero for all others.
fn is_the_restriction(cell: &dyn ReferenceElement<3>, nodes: &[usize], N_facet: &[f64], xi: [f64; 3]) {
    for (A, N) in shape_at(cell, xi).into_iter().enumerate() {
        let expected = nodes.iter().position(|&node| node == A).map_or(0.0, |a| N_facet[a]);
        assert!((N - expected).abs() < 1e-15, "N_{A} on the face {nodes:?}");
    }
}

fn cell_conforms(kind: CellKind, degree: i32, points: &[[f64; 3]]) {
    assert_eq!(element(kind).nodes().len(), kind.n_nodes());
    conforms(element(kind), Domain::of(kind), degree, points);
    integrates_stiffness(element(kind), Domain::of(kind));
    facets_conform(kind);
}

fn points<const D: usize>() -> impl Strategy<Value = Vec<[f64; D]>> {
    prop::collection::vec(prop::array::uniform::<_, D>(-1.0..1.0f64), 8)
}

/// A plane cell without its third coordinate.
struct Flat(CellKind);

impl ReferenceElement<2> for Flat {
    fn nodes(&self) -> &'static [[f64; 2]] {
        element(self.0).nodes().iter().map(|&[x, y, _]| [x, y]).collect::<Vec<_>>().leak()
    }
    fn shape(&self, [x, y]: [f64; 2], N: &mut [f64]) {
        // Nothing depends on the third coordinate.
        element(self.0).shape([x, y, 7.0], N);
    }
    fn gradient(&self, [x, y]: [f64; 2], dN: &mut [[f64; 2]]) {
        let mut all = vec![[f64::NAN; 3]; dN.len()];
        element(self.0).gradient([x, y, 7.0], &mut all);
        assert!(all.iter().all(|dN| dN[2] == 0.0));
        dN.iter_mut().zip(all).for_each(|(dN, [x, y, _])| *dN = [x, y]);
    }
    fn quadrature(&self) -> Quadrature<2> {
        flat(element(self.0).quadrature())
    }
    fn mass_quadrature(&self) -> Quadrature<2> {
        flat(element(self.0).mass_quadrature())
    }
}

fn flat(rule: Quadrature<3>) -> Quadrature<2> {
    Quadrature { points: rule.points.iter().map(|&[x, y, _]| [x, y]).collect(), weights: rule.weights }
}

/// The conditions on a plane cell in its two coordinates; its edges have the cell on their left.
fn plane_cell_conforms(kind: CellKind, degree: i32, points: &[[f64; 2]]) {
    assert_eq!(element(kind).nodes().len(), kind.n_nodes());
    conforms(&Flat(kind), Domain::of(kind), degree, points);
    integrates_stiffness(&Flat(kind), Domain::of(kind));
    let cell = element(kind);
    let corners = &element(kind).nodes()[..kind.n_corners()];
    let centre = [0, 1, 2].map(|i| corners.iter().map(|x| x[i]).sum::<f64>() / corners.len() as f64);
    for facet in kind.facets() {
        let edge = facet_element(facet.kind);
        assert_eq!(edge.nodes().len(), facet.kind.n_nodes());
        let positions: Vec<[f64; 3]> = facet.nodes.iter().map(|&local| cell.nodes()[local]).collect();
        for (&s, _) in edge.quadrature().iter() {
            let [a, b] = facet_tangents(facet.kind, &positions, &gradient_at(edge, s));
            let normal = cross(a, b);
            let x = combination(&shape_at(edge, s), &positions);
            assert!((0..3).map(|i| normal[i] * (x[i] - centre[i])).sum::<f64>() > 0.1, "{kind} {facet:?}");
            is_the_restriction(cell, facet.nodes, &shape_at(edge, s), x);
        }
    }
}

/// Rounding grows with the coordinates u and v of the ray, so there are no points beside the pyramid as with the
/// others.
fn inside_the_pyramid() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let inside = |points: Vec<[f64; 3]>| {
        points.into_iter().map(|x| Domain::Pyramid.image(x.map(|x| 0.5 * x + 0.5)).0).collect()
    };
    points().prop_map(inside)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn hex8(points in points()) { cell_conforms(CellKind::Hex8, 1, &points) }
    #[test]
    fn hex20(points in points()) { cell_conforms(CellKind::Hex20, 2, &points) }
    #[test]
    fn hex27(points in points()) { cell_conforms(CellKind::Hex27, 2, &points) }
    #[test]
    fn tet4(points in points()) { cell_conforms(CellKind::Tet4, 1, &points) }
    #[test]
    fn tet10(points in points()) { cell_conforms(CellKind::Tet10, 2, &points) }
    #[test]
    fn wedge6(points in points()) { cell_conforms(CellKind::Wedge6, 1, &points) }
    #[test]
    fn wedge15(points in points()) { cell_conforms(CellKind::Wedge15, 2, &points) }
    #[test]
    fn pyramid5(points in inside_the_pyramid()) { cell_conforms(CellKind::Pyramid5, 1, &points) }
    #[test]
    fn pyramid13(points in inside_the_pyramid()) { cell_conforms(CellKind::Pyramid13, 2, &points) }
    #[test]
    fn line2(points in points()) { conforms(&Line2, Domain::Cube, 1, &points) }
    #[test]
    fn line3(points in points()) { conforms(&Line3, Domain::Cube, 2, &points) }
    #[test]
    fn plane_tri3(points in points()) { plane_cell_conforms(CellKind::Tri3, 1, &points) }
    #[test]
    fn plane_tri6(points in points()) { plane_cell_conforms(CellKind::Tri6, 2, &points) }
    #[test]
    fn plane_quad4(points in points()) { plane_cell_conforms(CellKind::Quad4, 1, &points) }
    #[test]
    fn plane_quad8(points in points()) { plane_cell_conforms(CellKind::Quad8, 2, &points) }
    #[test]
    fn plane_quad9(points in points()) { plane_cell_conforms(CellKind::Quad9, 2, &points) }
    #[test]
    fn tri3(points in points()) { conforms(facet_element(FacetKind::Tri3), Domain::Simplex, 1, &points) }
    #[test]
    fn tri6(points in points()) { conforms(facet_element(FacetKind::Tri6), Domain::Simplex, 2, &points) }
    #[test]
    fn quad4(points in points()) { conforms(facet_element(FacetKind::Quad4), Domain::Cube, 1, &points) }
    #[test]
    fn quad8(points in points()) { conforms(facet_element(FacetKind::Quad8), Domain::Cube, 2, &points) }
    #[test]
    fn quad9(points in points()) { conforms(facet_element(FacetKind::Quad9), Domain::Cube, 2, &points) }
}
