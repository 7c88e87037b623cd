//! Formats of other programs, and their converters.

use std::path::Path;

use super::MeshError;

/// Steps that turn a format into a supported mesh.
#[derive(Debug, Clone, Copy)]
enum Way {
    /// A mesh for meshio.
    Meshio,
    /// A mesh that Gmsh keeps with the names of its groups; meshio keeps their numbers alone.
    Save,
    /// A mesh or a geometry for Gmsh; the volume is meshed if necessary.
    Gmsh,
    /// A surface, from which Gmsh creates a volume.
    Surface,
    /// A script of Gmsh.
    Script,
    /// A result, whose input has the mesh.
    Bulk,
}

/// Known formats by their extensions.
const FORMATS: [(&str, &str, Way); 20] = [
    ("cgns", "a mesh of CGNS", Way::Gmsh),
    ("ply", "a surface of triangles (PLY)", Way::Surface),
    ("off", "a surface (OFF)", Way::Surface),
    ("op2", "a binary result of Nastran", Way::Bulk),
    ("xdmf", "a mesh of XDMF", Way::Meshio),
    ("xmf", "a mesh of XDMF", Way::Meshio),
    ("exo", "a mesh of Exodus", Way::Meshio),
    ("e", "a mesh of Exodus", Way::Meshio),
    ("mesh", "a mesh of Medit", Way::Meshio),
    ("su2", "a mesh of SU2", Way::Meshio),
    ("med", "a mesh of Salome", Way::Save),
    ("unv", "a mesh of I-deas", Way::Gmsh),
    ("step", "a geometry, no mesh,", Way::Gmsh),
    ("stp", "a geometry, no mesh,", Way::Gmsh),
    ("iges", "a geometry, no mesh,", Way::Gmsh),
    ("igs", "a geometry, no mesh,", Way::Gmsh),
    ("brep", "a geometry, no mesh,", Way::Gmsh),
    ("stl", "a surface of triangles (STL)", Way::Surface),
    ("obj", "a surface (OBJ)", Way::Surface),
    ("geo", "a script of Gmsh", Way::Script),
];

/// The error for a file with the extension of a known but unsupported format.
pub(super) fn format(file: &Path) -> Option<MeshError> {
    let extension = file.extension()?.to_str()?.to_ascii_lowercase();
    let (_, format, way) = FORMATS.into_iter().find(|(known, ..)| *known == extension)?;
    let from = file.display();
    let to = file.with_extension("msh");
    let to = to.display();
    let command = match way {
        Way::Meshio => format!(
            "convert it with meshio: `meshio convert {from} {}`",
            file.with_extension("vtu").display()
        ),
        Way::Save => format!("convert it with Gmsh: `gmsh {from} -save -format msh41 -o {to}`"),
        Way::Gmsh => format!("convert it with Gmsh: `gmsh -3 {from} -format msh41 -o {to}`"),
        Way::Surface => {
            "make a volume of it in Gmsh (`Merge`, `Surface Loop`, `Volume`) and mesh that".to_string()
        }
        Way::Bulk => "take the bulk data file (.bdf) that it was computed from".to_string(),
        Way::Script => format!("mesh it with Gmsh: `gmsh -3 {from} -format msh41 -o {to}`"),
    };
    Some(MeshError::OtherFormat { file: file.to_path_buf(), format, command })
}
