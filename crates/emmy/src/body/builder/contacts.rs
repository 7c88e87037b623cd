//! Names of contacts, by which their forces count as reactions beside those of supports.

use std::collections::HashSet;

use crate::error::{Error, Result};
use crate::input::{Contact, GroundSpring, Support};

/// Checks that no name of a contact is that of a supported group or of another contact.
pub(super) fn check_names(
    contacts: &[Contact],
    supports: &[Support],
    springs: &[GroundSpring],
) -> Result<()> {
    let supported = supports.iter().map(|own| &own.group).chain(springs.iter().map(|own| &own.group));
    let mut taken: HashSet<String> = supported.cloned().collect();
    for (number, contact) in contacts.iter().enumerate() {
        let name = contact.name(number);
        if !taken.insert(name.clone()) {
            let reason = "its forces need a name that no supported group and no other contact has".into();
            return Err(Error::Contact { contact: name, reason });
        }
    }
    Ok(())
}

/// Names of the groups of springs and of the contacts, each with its place among the forces: these come first.
pub(super) fn groups_of_forces(springs: &[GroundSpring], contacts: &[Contact]) -> Vec<(String, usize)> {
    let groups = springs.iter().map(|spring| spring.group.clone());
    let names = contacts.iter().enumerate().map(|(number, contact)| contact.name(number));
    groups.chain(names).zip(0..).collect()
}
