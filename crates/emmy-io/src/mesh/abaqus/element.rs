//! Elements of Abaqus: solid and plane strain. Their node order is the order of VTK (Abaqus Elements Guide,
//! "Three-dimensional solid elements", "Two-dimensional solid elements").

use std::sync::LazyLock;

use emmy::internals::element::CellShape;
use emmy::mesh::CellKind;

/// Supported types, by kind of cell; the plainest first.
const TYPES: [(CellKind, &[&str]); 13] = [
    (CellKind::Hex8, &["C3D8", "C3D8R", "C3D8I", "C3D8S", "C3D8H", "C3D8RH", "C3D8IH", "C3D8HS"]),
    (CellKind::Hex20, &["C3D20", "C3D20R", "C3D20H", "C3D20RH"]),
    (CellKind::Tet4, &["C3D4", "C3D4H"]),
    (CellKind::Tet10, &["C3D10", "C3D10M", "C3D10H", "C3D10MH", "C3D10I", "C3D10HS", "C3D10T"]),
    (CellKind::Wedge6, &["C3D6", "C3D6R", "C3D6H"]),
    (CellKind::Wedge15, &["C3D15", "C3D15H"]),
    (CellKind::Pyramid5, &["C3D5", "C3D5H"]),
    // Gmsh writes it.
    (CellKind::Pyramid13, &["C3D13"]),
    (CellKind::Tri3, &["CPE3", "CPE3H"]),
    (CellKind::Tri6, &["CPE6", "CPE6H", "CPE6M", "CPE6MH"]),
    (CellKind::Quad4, &["CPE4", "CPE4R", "CPE4H", "CPE4RH", "CPE4I", "CPE4IH"]),
    (CellKind::Quad8, &["CPE8", "CPE8R", "CPE8H", "CPE8RH"]),
    (CellKind::Line2, &["T3D2", "T3D2H", "T2D2", "T2D2H", "CONN3D2", "CONN2D2", "SPRINGA"]),
];

/// The supported types for messages: the plainest of each kind.
pub(super) fn supported() -> &'static str {
    static TEXT: LazyLock<String> = LazyLock::new(|| {
        let plainest = |dimension: usize| {
            let types = TYPES.iter().filter(move |(kind, _)| kind.dimension() == dimension);
            types.map(|(_, types)| types[0]).collect::<Vec<_>>().join(", ")
        };
        let links = types(CellKind::Line2).join(", ");
        format!(
            "{} or their variants (R, H, I, ...), or in a plane of {}, or links of {links}",
            plainest(3),
            plainest(2)
        )
    });
    &TEXT
}

/// Element types of a kind of cell.
pub(super) fn types(kind: CellKind) -> &'static [&'static str] {
    TYPES.iter().find(|(own, _)| *own == kind).map_or(&[], |(_, types)| types)
}

/// Kind of cell of an element type, given in upper case.
pub(super) fn kind(element_type: &str) -> Option<CellKind> {
    TYPES.iter().find(|(_, types)| types.contains(&element_type)).map(|(kind, _)| *kind)
}

/// The role of an element type in a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Cells.
    Cell(CellKind),
    /// Faces or edges of cells, with their number of nodes.
    Lower(CellKind, usize),
    /// They are left out, with their number of nodes if all variants have it.
    LeftOut(Option<usize>),
}

/// Role of a type of elements, given in upper case; `None`: a solid or unknown type that is not read. Lines of two
/// nodes may be links or edges.
pub(super) fn role(element_type: &str) -> Option<Role> {
    let lower = match element_type {
        "T3D3" | "T3D3H" | "T2D3" | "T2D3H" => Some((CellKind::Line2, 3)),
        _ => face_kind(element_type).map(|kind| (kind, kind.n_nodes())),
    };
    let cell = || kind(element_type).map(Role::Cell);
    let lower = || lower.map(|(kind, n_nodes)| Role::Lower(kind, n_nodes));
    cell().or_else(lower).or_else(|| left_out(element_type).map(Role::LeftOut))
}

/// Beginnings of the names of elements that are not solid, with their number of nodes; 0: it is the last number of the
/// name.
const LEFT_OUT: [(usize, &[&str]); 4] = [
    (1, &["MASS", "ROTARYI", "HEATCAP", "SPRING1", "DASHPOT1", "DCOUP", "PC3D", "PD3D"]),
    (
        2,
        &[
            "SPRING2", "DASHPOT2", "DASHPOTA", "GAPUNI", "GAPCYL", "GAPSPHER", "DGAP", "JOINT", "CONN",
            "B21", "B23", "B31", "B33", "PIPE21", "PIPE31", "ELBOW31", "FRAME", "RB2D2", "RB3D2", "R2D2",
            "RAX2", "FLINK", "ITS", "ITT", "DRAG", "SAX1", "MAX1", "MGAX1", "SFMAX1", "SFMGAX1", "DSAX1",
            "DC1D2", "T3D2", "T2D2",
        ],
    ),
    (
        3,
        &[
            "B22", "B32", "PIPE22", "PIPE32", "ELBOW32", "SAX2", "MAX2", "MGAX2", "SFMAX2", "SFMGAX2",
            "DSAX2", "DC1D3",
        ],
    ),
    (0, &["R3D", "COH", "CIN", "AC", "ASI", "GK", "F2D", "F3D", "FAX", "DS", "MCL", "SFMCL"]),
];

/// Number of nodes, if known, of a type for which Emmy has no cells: masses, springs, beams, rigid, infinite, cohesive,
/// acoustic or user elements.
fn left_out(element_type: &str) -> Option<Option<usize>> {
    let is_own = |names: &[&str]| names.iter().any(|name| element_type.starts_with(name));
    if let Some((n_nodes, _)) = LEFT_OUT.iter().find(|(_, names)| is_own(names)) {
        return Some(if *n_nodes == 0 { last_number(element_type) } else { Some(*n_nodes) });
    }
    // User elements U1, substructures Z1, network elements of CalculiX, line springs, soil.
    let numbered = element_type.strip_prefix(['U', 'Z']);
    let is_numbered = numbered.is_some_and(|rest| {
        rest.starts_with(|c: char| c.is_ascii_digit()) || ["S3", "S4"].iter().any(|own| rest.starts_with(own))
    });
    let is_other =
        element_type == "D" || ["LS3S", "LS6", "PSI", "IS"].iter().any(|own| element_type.starts_with(own));
    (is_numbered || is_other).then_some(None)
}

/// The last number of a name: 8 of `AC3D8R`.
fn last_number(name: &str) -> Option<usize> {
    name.split(|c: char| !c.is_ascii_digit()).rfind(|digits| !digits.is_empty())?.parse().ok()
}

/// Kind of face for a type of membranes, shells or plane stress elements, in upper case: meshers write these beside the
/// solid cells for their sets.
fn face_kind(element_type: &str) -> Option<CellKind> {
    let shape = ["CPS", "M3D", "STRI", "SFM3D", "S"]
        .into_iter()
        .find_map(|prefix| element_type.strip_prefix(prefix))?;
    // The number of nodes is followed by letters, and a 5 if nodes have five degrees of freedom: S4R5.
    let digits: String = shape.chars().take_while(char::is_ascii_digit).collect();
    match digits.as_str() {
        "3" => Some(CellKind::Tri3),
        "4" => Some(CellKind::Quad4),
        "6" | "65" => Some(CellKind::Tri6),
        "8" => Some(CellKind::Quad8),
        "9" => Some(CellKind::Quad9),
        _ => None,
    }
}

/// Remark on a type that is integrated differently from Abaqus.
pub(super) fn note(element_type: &str, kind: CellKind) -> Option<String> {
    if kind == CellKind::Line2 {
        return (!element_type.starts_with('T')).then(|| format!("{element_type} is read as {kind}"));
    }
    let suffix = element_type
        .trim_start_matches("C3D")
        .trim_start_matches("CPE")
        .trim_start_matches(|c: char| c.is_ascii_digit());
    let how = match suffix {
        "" => return None,
        "R" => format!("{kind} and integrated fully"),
        "RH" => format!("{kind} without its pressure and integrated fully"),
        "H" => format!("{kind} without its pressure"),
        _ if suffix.contains('H') => format!("plain {kind} without its pressure"),
        _ => format!("plain {kind}"),
    };
    let advice = match kind.info() {
        info if suffix.contains('I') && info.n_modes > 0 => {
            "; its modes are those of formulation = \"incompatible-modes\""
        }
        info if suffix.contains('H') && !info.pressures.is_empty() => {
            "; formulation = \"projected-volume\" has one"
        }
        _ => "",
    };
    Some(format!("{element_type} is read as {how}{advice}"))
}

/// Number of the face in [`CellKind::facets`] of a face of Abaqus, `S1` being 1.
pub(super) fn local_facet(kind: CellKind, face: u8) -> Option<u8> {
    let faces: &[&[usize]] = match kind.info().shape {
        CellShape::Hexahedron => &HEX_FACES,
        CellShape::Tetrahedron => &TET_FACES,
        CellShape::Wedge => &WEDGE_FACES,
        CellShape::Pyramid => &PYRAMID_FACES,
        CellShape::Triangle => &TRI_EDGES,
        CellShape::Quadrilateral => &QUAD_EDGES,
        CellShape::Line => &[],
    };
    let corners = faces.get(usize::from(face).checked_sub(1)?)?;
    let same = |nodes: &[usize]| corners.iter().all(|corner| nodes.contains(corner));
    kind.facets().iter().position(|facet| same(facet.nodes)).map(|local| local as u8)
}

const HEX_FACES: [&[usize]; 6] =
    [&[0, 1, 2, 3], &[4, 7, 6, 5], &[0, 4, 5, 1], &[1, 5, 6, 2], &[2, 6, 7, 3], &[3, 7, 4, 0]];
const TET_FACES: [&[usize]; 4] = [&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]];
const WEDGE_FACES: [&[usize]; 5] = [&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]];
const PYRAMID_FACES: [&[usize]; 5] = [&[0, 1, 2, 3], &[0, 4, 1], &[1, 4, 2], &[2, 4, 3], &[3, 4, 0]];
const TRI_EDGES: [&[usize]; 3] = [&[0, 1], &[1, 2], &[2, 0]];
const QUAD_EDGES: [&[usize]; 4] = [&[0, 1], &[1, 2], &[2, 3], &[3, 0]];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_face_has_its_own_place_in_the_cell() {
        for kind in CellKind::ALL {
            let n_faces = kind.facets().len() as u8;
            let mut locals: Vec<u8> = (1..=n_faces).map(|face| local_facet(kind, face).unwrap()).collect();
            locals.sort();
            assert_eq!(locals, (0..n_faces).collect::<Vec<_>>());
            assert_eq!(local_facet(kind, 0), None);
            assert_eq!(local_facet(kind, n_faces + 1), None);
        }
    }

    #[test]
    fn membranes_and_shells_may_be_faces() {
        let kinds = [
            ("CPS3", CellKind::Tri3),
            ("CPS4R", CellKind::Quad4),
            ("CPS6", CellKind::Tri6),
            ("CPS8R", CellKind::Quad8),
            ("M3D3", CellKind::Tri3),
            ("M3D8", CellKind::Quad8),
            ("S3", CellKind::Tri3),
            ("S4R5", CellKind::Quad4),
            ("S6", CellKind::Tri6),
            ("S8R", CellKind::Quad8),
            ("STRI65", CellKind::Tri6),
        ];
        for (element_type, kind) in kinds {
            assert_eq!(face_kind(element_type), Some(kind), "{element_type}");
        }
        for element_type in ["C3D8", "SPRINGA", "SC8R", "CPE4", "S", "T3D2"] {
            assert_eq!(face_kind(element_type), None, "{element_type}");
        }
    }

    #[test]
    fn elements_that_are_not_solid_are_left_out_and_unknown_solids_are_not() {
        let counts = [
            ("MASS", Some(1)),
            ("SPRING1", Some(1)),
            ("SPRING2", Some(2)),
            ("DASHPOTA", Some(2)),
            ("GAPUNI", Some(2)),
            ("DCOUP3D", Some(1)),
            ("B31", Some(2)),
            ("B32R", Some(3)),
            ("PIPE31H", Some(2)),
            ("R3D4", Some(4)),
            ("COH3D8", Some(8)),
            ("CIN3D12R", Some(12)),
            ("CINPE4", Some(4)),
            ("AC3D20", Some(20)),
            ("U12", None),
            ("US3", None),
            ("D", None),
        ];
        for (element_type, n_nodes) in counts {
            assert_eq!(role(element_type), Some(Role::LeftOut(n_nodes)), "{element_type}");
        }
        for element_type in
            ["C3D27", "C3D8P", "CAX4", "CGAX4", "CPEG4", "SC8R", "CCL12", "EC3D8R", "DC3D8", "C3D", "FOO"]
        {
            assert_eq!(role(element_type), None, "{element_type}");
        }
        assert_eq!(role("SPRINGA"), Some(Role::Cell(CellKind::Line2)));
        assert_eq!(role("T3D3"), Some(Role::Lower(CellKind::Line2, 3)));
        assert_eq!(role("S4R"), Some(Role::Lower(CellKind::Quad4, 4)));
    }

    #[test]
    fn types_that_are_changed_are_told() {
        assert_eq!(note("C3D8", CellKind::Hex8), None);
        assert_eq!(note("C3D20R", CellKind::Hex20).unwrap(), "C3D20R is read as hex20 and integrated fully");
        assert_eq!(note("CPE8R", CellKind::Quad8).unwrap(), "CPE8R is read as quad8 and integrated fully");
        assert_eq!(note("C3D10M", CellKind::Tet10).unwrap(), "C3D10M is read as plain tet10");
    }
}
