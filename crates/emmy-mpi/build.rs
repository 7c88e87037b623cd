//! Compiles the calls of MPI, which have no stable names in C libraries: `MPI_DOUBLE` may be a macro or an object.

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
}
