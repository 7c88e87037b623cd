//! Several meshes as parts of one.

use emmy::mesh::{MeshBuilder, Placement};

use super::{MeshFile, NOT_JOINED, note_on_coincident_nodes};

impl MeshFile {
    /// The mesh at another place, with the points, directions and inertias of its entries.
    ///
    /// # Errors
    /// As [`emmy::mesh::Mesh::placed`].
    pub fn placed(self, placement: &Placement) -> emmy::Result<Self> {
        if *placement == Placement::default() {
            return Ok(self);
        }
        let entries = self.entries.into_iter().map(|own| own.placed(placement)).collect();
        Ok(MeshFile { mesh: self.mesh.placed(placement)?, entries, ..self })
    }
}

/// One mesh of several, each a part with a name, as [`MeshBuilder::part`]. Notes and entries have the name of the part
/// before them, and groups in entries their new names. Nodes at one position are noted for the whole mesh.
///
/// ```
/// use emmy_io::mesh::{MeshFile, joined};
/// let part = || emmy::mesh::block([1.0; 3], [1; 3]).map(|mesh| MeshFile {
///     mesh,
///     notes: vec!["a note".into()],
///     entries: Vec::new(),
///     files: Vec::new(),
/// });
/// let file = joined(vec![("left".into(), part()?), ("right".into(), part()?)])?;
/// assert_eq!(file.mesh.groups().facets("right-x-max")?.len(), 1);
/// assert_eq!(file.notes[1], "right: a note");
/// assert!(file.notes[2].starts_with("8 nodes lie where another one does"));
/// # Ok::<(), emmy::Error>(())
/// ```
///
/// # Errors
/// As [`MeshBuilder::part`] and [`MeshBuilder::build`].
pub fn joined(parts: Vec<(String, MeshFile)>) -> emmy::Result<MeshFile> {
    let mut builder = MeshBuilder::new();
    let (mut notes, mut entries, mut files) = (Vec::new(), Vec::new(), Vec::new());
    for (name, part) in parts {
        builder.part(&name, &part.mesh)?;
        let own = part.notes.iter().filter(|note| !note.ends_with(NOT_JOINED));
        notes.extend(own.map(|note| format!("{name}: {note}")));
        entries.extend(part.entries.into_iter().map(|own| own.in_part(&name, &part.mesh)));
        files.extend(part.files);
    }
    let mesh = builder.build()?;
    notes.extend(note_on_coincident_nodes(&mesh, |_| false));
    Ok(MeshFile { mesh, notes, entries, files })
}
