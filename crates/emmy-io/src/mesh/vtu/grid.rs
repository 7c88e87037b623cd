//! An unstructured grid as VTK has it: the common form of its files and of grids in memory.

use std::collections::HashMap;

use super::super::account::{Entries, Treatment, treatment};
use crate::message::counted;

/// Numbers of an array; whole numbers are exact.
#[derive(Debug, Clone, PartialEq)]
pub enum Numbers {
    /// Whole numbers.
    Whole(Vec<i64>),
    /// Real numbers; NaN stands for no value.
    Real(Vec<f64>),
}

impl Numbers {
    pub(super) fn into_reals(self) -> Vec<f64> {
        match self {
            Numbers::Whole(numbers) => numbers.into_iter().map(|number| number as f64).collect(),
            Numbers::Real(numbers) => numbers,
        }
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Numbers::Whole(numbers) => numbers.len(),
            Numbers::Real(numbers) => numbers.len(),
        }
    }

    /// Whole numbers, `None` where there is no value; `None` if there are other numbers, or no value at all.
    pub(super) fn labels(&self) -> Option<Vec<Option<i64>>> {
        /// Reals beyond it are not exact.
        const LARGEST: f64 = 9_007_199_254_740_992.0;
        let labels: Vec<Option<i64>> = match self {
            Numbers::Whole(numbers) => return Some(numbers.iter().copied().map(Some).collect()),
            Numbers::Real(numbers) => {
                let is_label = |x: &f64| x.is_nan() || (x.fract() == 0.0 && x.abs() <= LARGEST);
                if !numbers.iter().all(is_label) {
                    return None;
                }
                numbers.iter().map(|x| (!x.is_nan()).then_some(*x as i64)).collect()
            }
        };
        labels.iter().any(Option::is_some).then_some(labels)
    }

    /// Appends other numbers; the result has reals if either of them has.
    fn joined(self, other: Numbers) -> Numbers {
        match (self, other) {
            (Numbers::Whole(mut own), Numbers::Whole(other)) => {
                own.extend(other);
                Numbers::Whole(own)
            }
            (own, other) => {
                let mut own = own.into_reals();
                own.extend(other.into_reals());
                Numbers::Real(own)
            }
        }
    }
}

/// An array with a value for each cell or each point of a [`Grid`].
#[derive(Debug, Clone, PartialEq)]
pub struct GridArray {
    /// Its name.
    pub name: String,
    /// One number for each; `None`: several numbers each, or text.
    pub numbers: Option<Numbers>,
}

/// An unstructured grid of VTK.
///
/// ```
/// use emmy_io::mesh::{Grid, GridArray, Numbers, from_grid};
/// let grid = Grid {
///     points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
///     types: vec![10], // tetrahedron
///     ends: vec![4],
///     connectivity: vec![0, 1, 2, 3],
///     cell_arrays: vec![GridArray { name: "material".into(), numbers: Some(Numbers::Real(vec![2.0])) }],
///     point_arrays: Vec::new(),
/// };
/// let file = from_grid("the grid".as_ref(), grid, &[])?;
/// assert_eq!(file.mesh.groups().cells("material=2")?, [0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Grid {
    /// Points.
    pub points: Vec<[f64; 3]>,
    /// Types of the cells (`vtkCellType.h`).
    pub types: Vec<i64>,
    /// End of the points of each cell in `connectivity`.
    pub ends: Vec<i64>,
    /// Points of all cells.
    pub connectivity: Vec<i64>,
    /// Arrays on the cells.
    pub cell_arrays: Vec<GridArray>,
    /// Arrays on the points.
    pub point_arrays: Vec<GridArray>,
}

/// The treatment of arrays. Any other array of up to 64 whole numbers gives groups; the rest is named in a note.
pub(crate) const TABLE: &[Entries] = &[
    Entries { treatment: Treatment::Read, what: "groups", names: &["GROUP:*", "FACETS:*"] },
    Entries { treatment: Treatment::Read, what: "tags, any number of them; 0: none", names: TAGS },
    Entries {
        treatment: Treatment::Read,
        what: "ghost, hidden and refined cells, which are left out",
        names: &[GHOST_TYPE, GHOST_LEVEL],
    },
    Entries {
        treatment: Treatment::NoEffect,
        what: "numbers of cells and points",
        names: &[
            "GLOBALCELLIDS",
            "GLOBALELEMENTID",
            "GLOBALNODEID",
            "GLOBALNODEIDS",
            "GLOBALPOINTIDS",
            "PEDIGREECELLIDS",
            "PEDIGREEELEMENTID",
            "PEDIGREENODEID",
        ],
    },
    Entries {
        treatment: Treatment::NoEffect,
        what: "data of pictures, and of VTK and meshio itself",
        names: &[
            "GMSH:DIM_TAGS",
            "NORMALS",
            "TCOORDS",
            "TEXTURE COORDINATES",
            "TEXTURECOORDINATES",
            "HIGHERORDERDEGREES",
            "VTK*",
        ],
    },
];

/// Arrays whose values are tags on cells of every dimension, or on nodes: of Gmsh, Salome and Medit by meshio.
const TAGS: &[&str] = &["GMSH:PHYSICAL", "CELL_TAGS", "POINT_TAGS", "MEDIT:REF"];

const GHOST_TYPE: &str = "VTKGHOSTTYPE";
/// Name before VTK 6.3.
const GHOST_LEVEL: &str = "VTKGHOSTLEVELS";

/// Whether an array has tags.
pub(super) fn has_tags(name: &str) -> bool {
    TAGS.contains(&&*name.to_uppercase())
}

/// Whether an array has no effect.
pub(super) fn has_no_effect(name: &str) -> bool {
    treatment(TABLE, &name.to_uppercase()) == Some(Treatment::NoEffect)
        || emmy::body::FieldName::ALL.iter().any(|field| field.name() == name)
}

/// Arrays with the numbers of points in the whole grid.
const NODES: [&str; 3] = ["GlobalNodeIds", "GlobalPointIds", crate::vtk::NODE];

/// Whether the numbers of an array are needed.
pub(super) fn is_needed(name: &str) -> bool {
    !has_no_effect(name)
        || NODES.contains(&name)
        || [GHOST_TYPE, GHOST_LEVEL].contains(&&*name.to_uppercase())
}

impl Grid {
    /// Whether each cell is a ghost of another piece, hidden or replaced by finer ones.
    pub(super) fn ghosts(&self) -> Vec<bool> {
        /// Bits of `vtkDataSetAttributes`: duplicate, refined and hidden cell.
        const BITS: i64 = 1 | 8 | 32;
        let mut ghosts = vec![false; self.types.len()];
        for array in &self.cell_arrays {
            let is_ghost: fn(i64) -> bool = match &*array.name.to_uppercase() {
                GHOST_TYPE => |value| value & BITS != 0,
                GHOST_LEVEL => |value| value > 0,
                _ => continue,
            };
            let labels = array.numbers.as_ref().and_then(Numbers::labels).unwrap_or_default();
            for (ghost, label) in ghosts.iter_mut().zip(labels) {
                *ghost |= label.is_some_and(is_ghost);
            }
        }
        ghosts
    }
}

/// Joins the pieces of a grid: points of two pieces are one if they have one number in the whole grid or, without such
/// numbers, one position. Returns a note, too.
pub(super) fn joined(mut pieces: Vec<Grid>) -> (Grid, Option<String>) {
    if pieces.len() < 2 {
        return (pieces.pop().unwrap_or_default(), None);
    }
    let n_pieces = pieces.len();
    let keys = numbers_in_the_whole(&pieces).unwrap_or_else(|| pieces.iter().map(positions).collect());
    let mut all = Grid::default();
    let mut points: HashMap<[u64; 3], i64> = HashMap::new();
    let mut n_joined = 0;
    for (mut piece, keys) in pieces.into_iter().zip(keys) {
        let known: Vec<Option<i64>> = keys.iter().map(|key| points.get(key).copied()).collect();
        let is_new: Vec<bool> = known.iter().map(Option::is_none).collect();
        n_joined += known.iter().flatten().count();
        let mut index = Vec::with_capacity(known.len());
        let n_before = all.points.len();
        for (i, known) in known.into_iter().enumerate() {
            index.push(known.unwrap_or_else(|| {
                all.points.push(piece.points[i]);
                (all.points.len() - 1) as i64
            }));
            points.entry(keys[i]).or_insert(index[i]);
        }
        let begin = all.connectivity.len() as i64;
        // A node that is not there stays so.
        let node = |&node: &i64| usize::try_from(node).ok().and_then(|node| index.get(node)).copied();
        all.connectivity.extend(piece.connectivity.iter().map(|id| node(id).unwrap_or(i64::MAX)));
        all.ends.extend(piece.ends.iter().map(|end| begin.saturating_add(*end)));
        append(&mut all.cell_arrays, piece.cell_arrays, all.types.len(), piece.types.len());
        all.types.append(&mut piece.types);
        for array in &mut piece.point_arrays {
            array.numbers = array.numbers.take().map(|numbers| numbers.only(&is_new));
        }
        append(&mut all.point_arrays, piece.point_arrays, n_before, all.points.len() - n_before);
    }
    let nodes = counted(n_joined, "repeated node is", "repeated nodes are");
    (all, Some(format!("{n_pieces} pieces of the grid are joined; {nodes} left out")))
}

impl Numbers {
    fn only(self, chosen: &[bool]) -> Numbers {
        fn of<T>(numbers: Vec<T>, chosen: &[bool]) -> Vec<T> {
            numbers.into_iter().zip(chosen).filter_map(|(number, chosen)| chosen.then_some(number)).collect()
        }
        match self {
            Numbers::Whole(numbers) => Numbers::Whole(of(numbers, chosen)),
            Numbers::Real(numbers) => Numbers::Real(of(numbers, chosen)),
        }
    }
}

/// Appends arrays for `n` more cells or points after the first `before`; what one piece lacks has no value there.
fn append(arrays: &mut Vec<GridArray>, piece: Vec<GridArray>, before: usize, n: usize) {
    let nothing = |n: usize| Numbers::Real(vec![f64::NAN; n]);
    for own in piece {
        if let Some(array) = arrays.iter_mut().find(|array| array.name == own.name) {
            let pair = array.numbers.take().zip(own.numbers);
            array.numbers = pair.map(|(first, second)| first.joined(second));
        } else {
            let numbers = own.numbers.map(|own| if before == 0 { own } else { nothing(before).joined(own) });
            arrays.push(GridArray { name: own.name, numbers });
        }
    }
    for array in arrays {
        array.numbers = array.numbers.take().map(|numbers| {
            let missing = (before + n).saturating_sub(numbers.len());
            if missing == 0 { numbers } else { numbers.joined(nothing(missing)) }
        });
    }
}

/// Keys of points at one position.
fn positions(piece: &Grid) -> Vec<[u64; 3]> {
    // Adding 0 makes -0 to 0.
    piece.points.iter().map(|point| point.map(|x| (x + 0.0).to_bits())).collect()
}

/// Keys of points by their numbers in the whole grid, if every piece has them and points of one number have one
/// position.
fn numbers_in_the_whole(pieces: &[Grid]) -> Option<Vec<Vec<[u64; 3]>>> {
    let of = |name: &str| -> Option<Vec<Vec<[u64; 3]>>> {
        let mut place_of: HashMap<i64, [u64; 3]> = HashMap::new();
        let mut keys = Vec::with_capacity(pieces.len());
        for piece in pieces {
            let array = piece.point_arrays.iter().find(|array| array.name == name)?;
            let Some(Numbers::Whole(numbers)) = &array.numbers else { return None };
            for (&number, place) in numbers.iter().zip(positions(piece)) {
                if *place_of.entry(number).or_insert(place) != place {
                    return None;
                }
            }
            keys.push(numbers.iter().map(|&number| [number as u64, 0, 0]).collect());
        }
        Some(keys)
    };
    NODES.iter().find_map(|name| of(name))
}
