//! Any bytes as a mesh file of Nastran: a mesh or an error, never a panic.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let links = ["links".to_string()];
    match emmy_io::mesh::parse_with_links("fuzz.bdf".as_ref(), bytes, &links) {
        Ok(file) => assert!(file.mesh.n_cells() > 0),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
