//! `RBE2`, `RBAR` and `RROD`.

use super::super::card::real;
use super::Work;
use super::body::Link;
use super::fields::{Outcome, Reason, Stored, components, grid_points};
use super::grids::Grids;
use super::pair::Pair;

impl Work<'_> {
    /// Rigid bodies of rigid elements that share grid points, and pairs of grid points.
    pub(super) fn rigid(&mut self) {
        let mut links = Vec::new();
        for card in self.cards.iter().filter(|card| card.name == "RBE2") {
            match link(card, &self.grids) {
                // Two grid points: their distance is all that solid cells see.
                Ok(link) if link.members.len() == 1 => self.pairs.push(link.into_pair()),
                Ok(link) => links.push(link),
                Err(reason) => {
                    let hub = card.number(1).ok().filter(|&hub| self.grids.is_unused(hub));
                    self.lost.extend(hub);
                    self.register.leave_out(card, reason);
                }
            }
        }
        for card in self.cards {
            let pair = match card.name {
                "RBAR" => Pair::of_bar(card, &self.grids),
                "RROD" => Pair::of_rod(card, &self.grids),
                _ => continue,
            };
            match pair {
                Ok(pair) => self.pairs.push(pair),
                Err(reason) => self.register.leave_out(card, reason),
            }
        }
        self.join_links(links);
    }
}

/// The grid points of `RBE2`.
fn link(card: &Stored, grids: &Grids<'_>) -> Outcome<Link> {
    let label = card.number(0)?.to_string();
    let hub = card.number(1)?;
    grids.known(hub)?;
    let follows = components(card.field(2))?;
    if !follows.has_translations() || follows.has_some_rotation() != follows.has_rotations() {
        return Err(Reason::new("its components CM are not 123 or 123456"));
    }
    let fields: Vec<&str> = card.fields.iter().skip(3).map(String::as_str).collect();
    let (mut members, others) = grid_points(&fields, grids)?;
    // ALPHA and TREF.
    if let Some(word) = others.into_iter().find(|word| real(word).is_none()) {
        return Err(Reason::fault(format!("\"{}\" is not a grid point", super::super::shown(word))));
    }
    members.retain(|&member| member != hub);
    if members.is_empty() {
        return Err(Reason::fault("it has no dependent grid point"));
    }
    let turns = follows.has_rotations();
    let name = format!("rbe2_{label}");
    Ok(Link { card: card.name, label, name, at: card.at, hub, members, turns })
}
