//! Groups of facets by the places of their nodes.

use emmy::mesh::{Facet, Mesh, MeshBuilder};

/// A group of facets by the places of their nodes.
pub(crate) type Face<'a> = (&'a str, &'a dyn Fn([f64; 3]) -> bool);

/// The mesh with groups of the facets whose nodes all lie on a face.
pub(crate) fn with_faces(mut builder: MeshBuilder, faces: &[Face<'_>]) -> Mesh {
    let mesh = builder.clone().build().unwrap();
    for (name, is_on) in faces {
        let locals = |cell: u32| 0..mesh.cell(cell as usize).kind.facets().len() as u8;
        let facets = (0..mesh.n_cells() as u32)
            .flat_map(|cell| locals(cell).map(move |local| Facet { cell, local }))
            .filter(|&facet| mesh.facet_nodes(facet).all(|node| is_on(mesh.points()[node as usize])));
        builder.facet_group(name, facets.collect::<Vec<_>>());
    }
    builder.build().unwrap()
}
