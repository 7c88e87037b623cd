//! Entries of decks besides their meshes.

/// A rigid element, coupling, tie, mass, spring or joint of a mesh file, as a table of the input.
///
/// It acts as if it stood in the input, which can refer to its name or leave it out (`mesh.leave_out`).
///
/// ```
/// let deck = b"*Node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*Element, type=C3D4, elset=body\n1, 1,2,3,4\n";
/// assert_eq!(emmy_io::mesh::parse("tet.inp".as_ref(), deck)?.entries, []);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DeckEntry {
    /// Its name, of letters, digits, `_` and `-`; no other entry of the file has it.
    pub name: String,
    /// Section of the input: `rigid`, `coupling`, `tie`, `mass`, `support` or `joint`.
    pub section: &'static str,
    /// Its table there, in the lengths of the file.
    pub table: toml::Table,
    /// Its card or keyword, with the number if it has one, such as `RBE2 12`.
    pub card: String,
}
