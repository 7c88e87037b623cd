//! The command line of Emmy.
fn main() {}
