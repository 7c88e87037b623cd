//! Names of contacts, by which their forces count as reactions beside those of supports; checks of their surfaces; and
//! the node of each obstacle that moves.

use std::collections::{HashMap, HashSet};

use super::BodyBuilder;
use crate::error::Result;
use crate::input::{Contact, GroundSpring, Opponent, Support};
use crate::mesh::{Facet, Mesh};

/// Checks that no name of a contact is that of a supported group or of another contact.
pub(super) fn check_names(
    contacts: &[Contact],
    supports: &[Support],
    springs: &[GroundSpring],
) -> Result<()> {
    let supported = supports.iter().map(|own| &own.group).chain(springs.iter().map(|own| &own.group));
    let supported: HashSet<&String> = supported.collect();
    let mut known: HashMap<String, usize> = HashMap::new();
    for (number, contact) in contacts.iter().enumerate() {
        let name = contact.name(number);
        let reason = if supported.contains(&name) {
            format!(
                "\"{name}\" is also a supported group, and its forces need a name of their own: give the contact \
                 another `name`"
            )
        } else if let Some(first) = known.insert(name.clone(), number) {
            format!(
                "contacts {} and {} both have this name, and the forces of each need their own: give one of them \
                 another `name`",
                first + 1,
                number + 1
            )
        } else {
            continue;
        };
        return Err(contact.error(number, ("name", reason)));
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
            return Err(contact.error(number, ("surfaces", reason)));
        }
        known.push((number, sides));
    }
    Ok(())
}

/// Checks that something of both sides of each contact can move.
pub(super) fn check_motion(mesh: &Mesh, contacts: &[Contact], supports: &[Support]) -> Result<()> {
    if contacts.is_empty() {
        return Ok(());
    }
    let mut given = vec![[false; 3]; mesh.n_nodes()];
    for support in supports.iter().filter(|support| support.until.is_none()) {
        let fixed = support.fixed_components(mesh)?;
        for node in mesh.group_nodes(&support.group)? {
            let own = &mut given[node as usize];
            (0..3).for_each(|d| own[d] |= fixed[d] || support.drives(d));
        }
    }
    if !given.contains(&[true; 3]) {
        return Ok(());
    }
    let can_move = |group: Option<&str>| -> Result<bool> {
        let facets = mesh.surface_facets(group)?;
        let mut nodes = facets.iter().flat_map(|facet| mesh.facet_nodes(*facet));
        Ok(facets.is_empty() || nodes.any(|node| given[node as usize] != [true; 3]))
    };
    for (number, contact) in contacts.iter().enumerate() {
        let own = contact.surface.as_deref();
        let surfaces = match (&contact.opponent, own) {
            (Opponent::Surface(other), Some(own)) if !(can_move(Some(own))? || can_move(Some(other))?) => {
                format!("\"{own}\" and \"{other}\"")
            }
            (Opponent::Obstacle(_) | Opponent::Bodies, _) if !can_move(own)? => match own {
                Some(own) => format!("\"{own}\""),
                None => "the boundary".to_string(),
            },
            _ => continue,
        };
        let reason = format!("nothing of {surfaces} can move: supports give the motion of all nodes");
        return Err(contact.error(number, ("surfaces", reason)));
    }
    Ok(())
}

impl BodyBuilder {
    /// Adds a node for each obstacle that moves, and a support that moves it. Returns whether there are some.
    pub(super) fn obstacles(&mut self) -> Result<bool> {
        let BodyBuilder { mesh, contacts, supports, .. } = self;
        let moving = contacts.iter().enumerate().filter(|(_, contact)| contact.moves());
        let n_nodes = mesh.n_nodes();
        for (number, contact) in moving {
            let fail = |fault| contact.error(number, fault);
            let Opponent::Obstacle(obstacle) = &contact.opponent else {
                let reason = "a motion is one of an obstacle; supports move surfaces".to_string();
                return Err(fail(("move", reason)));
            };
            let group = contact.group_of_obstacle(number);
            mesh.add_nodes(&group, std::iter::once(obstacle.surface().map_err(fail)?.origin()))?;
            let fix = contact.motion.each_ref().map(Option::is_none);
            let displacement = contact.motion.clone();
            supports.push(Support { group, fix, displacement, ..Support::default() });
        }
        Ok(mesh.n_nodes() > n_nodes)
    }
}

/// Names of the groups of springs and of the contacts, each with its place among the forces: these come first.
pub(super) fn groups_of_forces(springs: &[GroundSpring], contacts: &[Contact]) -> Vec<(String, usize)> {
    let groups = springs.iter().map(|spring| spring.group.clone());
    let names = contacts.iter().enumerate().map(|(number, contact)| contact.name(number));
    groups.chain(names).zip(0..).collect()
}
