//! Any bytes as a mesh file of VTU: a mesh or an error, never a panic.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let options = emmy_io::mesh::MeshOptions { links: vec!["links".to_string()], plane_shells: true };
    match emmy_io::mesh::parse_with("fuzz.vtu".as_ref(), bytes, &options) {
        Ok(file) => assert!(file.mesh.n_cells() > 0),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
