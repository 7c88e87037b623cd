//! Elements of Nastran. Corners have the order of VTK; the midside nodes of hexahedra and wedges do not.

use emmy::mesh::CellKind;

/// A kind of cell, and the place in the card of each node in VTK order.
pub(super) type Row = (CellKind, &'static [usize]);

const IN_ORDER: [usize; 13] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];

/// Nastran numbers the midside nodes of the bottom, the vertical edges, the top; VTK those of the bottom, the top, the
/// vertical edges.
const HEX20: [usize; 20] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15];
const WEDGE15: [usize; 15] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11];

/// Gmsh does not write the order of Nastran here, but its own: the edges in the order of their nodes.
const PYRAMID13_OF_GMSH: [usize; 13] = [0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12];

const fn first(count: usize) -> &'static [usize] {
    IN_ORDER.split_at(count).0
}

const TETRAHEDRA: &[Row] = &[(CellKind::Tet4, first(4)), (CellKind::Tet10, first(10))];
const HEXAHEDRA: &[Row] = &[(CellKind::Hex8, first(8)), (CellKind::Hex20, &HEX20)];
const WEDGES: &[Row] = &[(CellKind::Wedge6, first(6)), (CellKind::Wedge15, &WEDGE15)];
const PYRAMIDS: &[Row] = &[(CellKind::Pyramid5, first(5)), (CellKind::Pyramid13, first(13))];
const PYRAMIDS_OF_GMSH: &[Row] = &[(CellKind::Pyramid5, first(5)), (CellKind::Pyramid13, &PYRAMID13_OF_GMSH)];
const TRIANGLE: Row = (CellKind::Tri3, first(3));
const QUADRILATERAL: Row = (CellKind::Quad4, first(4));
const LINES: &[Row] = &[(CellKind::Line2, first(2))];

/// Kinds of cells by the names of their cards, from few nodes to many. meshio writes `CTETRA_` for cells with midside
/// nodes. Shells and membranes are faces of solid cells, or cells in a plane.
const CARDS: [(&str, &[Row]); 29] = [
    ("CTETRA", TETRAHEDRA),
    ("CHEXA", HEXAHEDRA),
    ("CPENTA", WEDGES),
    ("CPYRAM", PYRAMIDS),
    ("CPYRA", PYRAMIDS),
    ("CTETRA_", TETRAHEDRA),
    ("CHEXA_", HEXAHEDRA),
    ("CPENTA_", WEDGES),
    ("CPYRA_", PYRAMIDS),
    ("CTRIA3", &[TRIANGLE]),
    ("CTRIAR", &[TRIANGLE]),
    ("CPLSTN3", &[TRIANGLE]),
    ("CTRIA6", &[TRIANGLE, (CellKind::Tri6, first(6))]),
    ("CPLSTN6", &[TRIANGLE, (CellKind::Tri6, first(6))]),
    ("CQUAD4", &[QUADRILATERAL]),
    ("CQUADR", &[QUADRILATERAL]),
    ("CPLSTN4", &[QUADRILATERAL]),
    ("CQUAD8", &[QUADRILATERAL, (CellKind::Quad8, first(8))]),
    // Gmsh and meshio write it; Nastran has no such card.
    ("CQUAD9", &[QUADRILATERAL, (CellKind::Quad8, first(8)), (CellKind::Quad9, first(9))]),
    ("CPLSTN8", &[QUADRILATERAL, (CellKind::Quad8, first(8))]),
    ("CBAR", LINES),
    ("CBEAM", LINES),
    ("CBEND", LINES),
    ("CROD", LINES),
    ("CTUBE", LINES),
    ("CBUSH", LINES),
    ("CBUSH1D", LINES),
    ("CVISC", LINES),
    ("CGAP", LINES),
];

/// The name and the kinds of cells of a card, in a file of Gmsh or of another program.
pub(super) fn rows(name: &str, is_of_gmsh: bool) -> Option<(&'static str, &'static [Row])> {
    let pyramids = ("CPYRAM", PYRAMIDS_OF_GMSH);
    let own = (is_of_gmsh && name == pyramids.0).then_some(pyramids);
    own.or_else(|| CARDS.iter().find(|(known, _)| *known == name).copied())
}

/// Whether a field names no node.
pub(super) fn is_blank(field: &str) -> bool {
    matches!(field, "" | "0")
}

/// The row of a card with these fields for nodes: the first one that has all of them; without any midside node, the
/// linear one. Fields after the nodes of a surface or line are its thickness and the like. `Err`: the number of its
/// nodes.
pub(super) fn row(rows: &'static [Row], fields: &[&str]) -> Result<Row, usize> {
    let (linear, _) = rows[0];
    let (most, _) = rows[rows.len() - 1];
    let is_there = |index: usize| fields.get(index).is_some_and(|field| !is_blank(field));
    let n_fields = if linear.dimension() == 3 { fields.len() } else { most.n_nodes() };
    let has_corners = (0..linear.n_nodes()).all(is_there);
    let has_all = |(kind, _): &&Row| !(kind.n_nodes()..most.n_nodes()).any(is_there);
    match rows.iter().find(has_all) {
        Some(row) if has_corners && n_fields <= most.n_nodes() => Ok(*row),
        _ => Err((0..n_fields).filter(|&index| is_there(index)).count()),
    }
}

/// Midside nodes of a kind of cell with the corners at the ends of their edges, as local numbers in VTK order.
pub(super) fn midsides(kind: CellKind) -> Vec<(usize, [usize; 2])> {
    let mut all: Vec<(usize, [usize; 2])> = Vec::new();
    for facet in kind.facets() {
        let n = facet.kind.n_corners();
        for (i, &local) in facet.nodes.iter().enumerate().skip(n).take(n) {
            let corners = [facet.nodes[i - n], facet.nodes[(i - n + 1) % n]];
            if !all.iter().any(|(known, _)| *known == local) {
                all.push((local, corners));
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_is_a_permutation() {
        for (card, rows) in CARDS {
            for (kind, order) in rows {
                let mut sorted = order.to_vec();
                sorted.sort_unstable();
                assert_eq!(sorted, (0..kind.n_nodes()).collect::<Vec<_>>(), "{card}");
                let n_centres = usize::from(*kind == CellKind::Quad9);
                assert_eq!(midsides(*kind).len(), kind.n_nodes() - kind.n_corners() - n_centres, "{card}");
            }
        }
    }

    #[test]
    fn fields_decide_on_the_kind() {
        let [_, tets] = ["CBAR", "CTETRA"].map(|name| rows(name, false).unwrap().1);
        let kind = |fields: &[&str]| row(tets, fields).map(|(kind, _)| kind);
        assert_eq!(kind(&["1", "2", "3", "4"]), Ok(CellKind::Tet4));
        assert_eq!(kind(&["1", "2", "3", "4", "", "0"]), Ok(CellKind::Tet4));
        assert_eq!(kind(&["1", "2", "3", "4", "", "6"]), Ok(CellKind::Tet10));
        assert_eq!(kind(&["1", "", "3", "4", "5"]), Err(4));
        assert_eq!(kind(&["1"; 11]), Err(11));
        let quads = rows("CQUAD8", false).unwrap().1;
        let fields = ["1", "2", "3", "4", "5", "", "7", "8", "", "", "", "", "90."];
        assert_eq!(row(quads, &fields).map(|(kind, _)| kind), Ok(CellKind::Quad8));
        let nines = rows("CQUAD9", false).unwrap().1;
        assert_eq!(row(nines, &["1"; 9]).map(|(kind, _)| kind), Ok(CellKind::Quad9));
        assert_eq!(row(nines, &fields).map(|(kind, _)| kind), Ok(CellKind::Quad8));
        assert_eq!(row(nines, &fields[..4]).map(|(kind, _)| kind), Ok(CellKind::Quad4));
        assert_eq!(row(quads, &["1", "2", "", "4", "5", "", "7", "8", "90."]), Err(6));
    }
}
