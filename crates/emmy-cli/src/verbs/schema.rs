//! `emmy schema`: the input as a JSON schema, for editors.

use crate::failure::Failure;
use crate::print;

/// Prints the schema.
pub(super) fn run() -> Result<(), Failure> {
    print::result(&format!("{:#}\n", emmy_io::input::schema()))
}
