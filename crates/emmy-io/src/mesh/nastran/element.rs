//! Elements of Nastran. Corners have the order of VTK; the midside nodes of hexahedra and wedges do not.

use emmy::mesh::CellKind;

/// A kind of cell, and the place in the card of each node in VTK order.
pub(super) type Row = (CellKind, &'static [usize]);

const IN_ORDER: [usize; 13] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];

/// Nastran numbers the midside nodes of the bottom, the vertical edges, the top; VTK those of the bottom, the top, the
/// vertical edges.
const HEX20: [usize; 20] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15];
const WEDGE15: [usize; 15] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11];

const fn first(count: usize) -> &'static [usize] {
    IN_ORDER.split_at(count).0
}

const TETRAHEDRA: &[Row] = &[(CellKind::Tet4, first(4)), (CellKind::Tet10, first(10))];
const HEXAHEDRA: &[Row] = &[(CellKind::Hex8, first(8)), (CellKind::Hex20, &HEX20)];
const WEDGES: &[Row] = &[(CellKind::Wedge6, first(6)), (CellKind::Wedge15, &WEDGE15)];
const PYRAMIDS: &[Row] = &[(CellKind::Pyramid5, first(5)), (CellKind::Pyramid13, first(13))];

/// Kinds of cells by the names of their cards. Shells and membranes are faces of solid cells, or cells in a plane.
const CARDS: [(&str, &[Row]); 17] = [
    ("CTETRA", TETRAHEDRA),
    ("CHEXA", HEXAHEDRA),
    ("CPENTA", WEDGES),
    ("CPYRAM", PYRAMIDS),
    ("CPYRA", PYRAMIDS),
    ("CTRIA3", &[(CellKind::Tri3, first(3))]),
    ("CTRIAR", &[(CellKind::Tri3, first(3))]),
    ("CPLSTN3", &[(CellKind::Tri3, first(3))]),
    ("CTRIA6", &[(CellKind::Tri6, first(6))]),
    ("CPLSTN6", &[(CellKind::Tri6, first(6))]),
    ("CQUAD4", &[(CellKind::Quad4, first(4))]),
    ("CQUADR", &[(CellKind::Quad4, first(4))]),
    ("CPLSTN4", &[(CellKind::Quad4, first(4))]),
    ("CQUAD8", &[(CellKind::Quad8, first(8))]),
    ("CPLSTN8", &[(CellKind::Quad8, first(8))]),
    ("CBAR", &[(CellKind::Line2, first(2))]),
    ("CROD", &[(CellKind::Line2, first(2))]),
];

/// Kinds of cells of a card.
pub(super) fn rows(name: &str) -> Option<&'static [Row]> {
    CARDS.iter().find(|(known, _)| *known == name).map(|(_, rows)| *rows)
}

/// The row of a card with these fields for nodes. Fields after the nodes of a surface or line are its thickness and the
/// like.
pub(super) fn row(rows: &'static [Row], fields: &[&str]) -> Option<Row> {
    let is_whole = |(kind, _): &&Row| {
        let is_solid = kind.dimension() == 3;
        let fits = if is_solid { fields.len() == kind.n_nodes() } else { fields.len() >= kind.n_nodes() };
        fits && fields[..kind.n_nodes()].iter().all(|field| !matches!(*field, "" | "0"))
    };
    rows.iter().find(is_whole).copied()
}

/// Whether a card without a kind of cell is an element that carries load or mass: `CONM2`, `RBE2`, ...
pub(super) fn is_omitted(name: &str) -> bool {
    let is_element = name.starts_with('C') && !name.starts_with("CORD");
    is_element || ["RBE", "RBAR", "RROD", "RTRPLT", "RSPLINE"].iter().any(|rigid| name.starts_with(rigid))
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
            }
        }
    }
}
