//! Names of contacts, by which their forces count as reactions beside those of supports.

use std::collections::HashSet;

use crate::error::{Error, Result};
use crate::input::{Contact, GroundSpring, Opponent, Support};
use crate::mesh::{Facet, Mesh};

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

/// Checks that no pair of facets is in contact twice, which would double its layer.
pub(super) fn check_overlaps(mesh: &Mesh, contacts: &[Contact]) -> Result<()> {
    let is_between_bodies = |contact: &&Contact| !matches!(contact.opponent, Opponent::Obstacle(_));
    if contacts.iter().filter(is_between_bodies).count() < 2 {
        return Ok(());
    }
    let mut known: Vec<(usize, [HashSet<Facet>; 2])> = Vec::new();
    for (number, contact) in contacts.iter().enumerate() {
        let facets = |group: Option<&str>| -> Result<HashSet<Facet>> {
            Ok(mesh.surface_facets(group)?.into_iter().collect())
        };
        let own = facets(contact.surface.as_deref())?;
        let sides = match &contact.opponent {
            Opponent::Obstacle(_) => continue,
            Opponent::Surface(other) => [own, facets(Some(other))?],
            Opponent::Bodies => [own.clone(), own],
        };
        let overlap = |[a, b]: [&HashSet<Facet>; 2]| !a.is_disjoint(b);
        let is_double = |(_, known): &&(usize, [HashSet<Facet>; 2])| {
            overlap([&sides[0], &known[0]]) && overlap([&sides[1], &known[1]])
                || overlap([&sides[0], &known[1]]) && overlap([&sides[1], &known[0]])
        };
        if let Some((other, _)) = known.iter().find(is_double) {
            let other = contacts[*other].name(*other);
            let reason =
                format!("facets of its surfaces are in contact by \"{other}\", too: leave one of both");
            return Err(Error::Contact { contact: contact.name(number), reason });
        }
        known.push((number, sides));
    }
    Ok(())
}

/// Names of the groups of springs and of the contacts, each with its place among the forces: these come first.
pub(super) fn groups_of_forces(springs: &[GroundSpring], contacts: &[Contact]) -> Vec<(String, usize)> {
    let groups = springs.iter().map(|spring| spring.group.clone());
    let names = contacts.iter().enumerate().map(|(number, contact)| contact.name(number));
    groups.chain(names).zip(0..).collect()
}
