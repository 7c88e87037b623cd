//! Compiles the calls of MPI, which have no stable names in C libraries: `MPI_DOUBLE` may be a macro or an object.

#[cfg(not(feature = "mpi"))]
fn main() {}

#[cfg(feature = "mpi")]
fn main() {
    println!("cargo::rerun-if-changed=src/shim.c");
    // Open MPI and MPICH name their packages differently.
    let found =
        ["ompi-c", "mpich", "mpi-c"].into_iter().find_map(|name| pkg_config::probe_library(name).ok());
    let Some(mpi) = found else {
        println!(
            "cargo::error=no MPI found by pkg-config (ompi-c, mpich or mpi-c); on Debian: apt-get install libopenmpi-dev \
             openmpi-bin pkg-config"
        );
        return;
    };
    cc::Build::new().file("src/shim.c").includes(&mpi.include_paths).warnings(true).compile("emmy_mpi_shim");
    if std::env::var_os("CARGO_FEATURE_PETSC").is_none() {
        return;
    }
    println!("cargo::rerun-if-changed=src/petsc.c");
    let Ok(petsc) = pkg_config::Config::new().atleast_version("3.17").probe("PETSc") else {
        println!(
            "cargo::error=no PETSc 3.17 or later found by pkg-config (PETSc); on Debian: apt-get install \
             libpetsc-real-dev"
        );
        return;
    };
    let mut build = cc::Build::new();
    build.file("src/petsc.c").includes(&petsc.include_paths).includes(&mpi.include_paths);
    build.warnings(true).compile("emmy_mpi_petsc");
}
