//! The tests of readers and writers from outside, in one binary, because linking the library takes longer than most of
//! them.

mod body_force;
mod checkpoints;
mod flights;
mod frames;
mod fuzz_corpus;
mod group_names;
mod input_robustness;
mod input_round_trip;
mod inputs_in_memory;
mod mesh_abaqus;
mod mesh_abaqus_account;
mod mesh_damage;
mod mesh_errors;
mod mesh_gmsh;
mod mesh_grids;
mod mesh_limits;
mod mesh_links;
mod mesh_mirrored;
mod mesh_nastran;
mod mesh_plane;
mod mesh_round_trip;
mod mesh_vtk_arrays;
mod mesh_vtu;
mod meshes;
mod report_vendor;
