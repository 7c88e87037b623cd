//! `emmy schema`: the input as a JSON schema, for editors.

use crate::failure::Failure;
use crate::host::Host;
use crate::print;

/// Prints the schema.
pub(super) fn run(host: &dyn Host) -> Result<(), Failure> {
    print::result(host, &format!("{:#}\n", emmy_io::input::schema()))
}
