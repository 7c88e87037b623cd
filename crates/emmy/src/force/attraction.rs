//! Attraction to points of space.

use std::sync::Arc;

use super::interface::{Force, Side};
use super::solid::SolidForce;
use super::source::{ForceSource, Site};
use crate::error::{Error, Result};
use crate::input::GroundAttraction;
use crate::material::Link;
use crate::space::CellTable;

/// Links from the masses to a fixed point.
///
/// Source of the potential: Newton's law of gravitation.
impl ForceSource for GroundAttraction {
    fn force(&self, _: usize, site: &Site<'_>) -> Result<Arc<dyn Force>> {
        let mesh = site.mesh;
        let mut nodes = match &self.group {
            Some(group) => mesh.volume_nodes(group)?,
            None => (0..mesh.n_nodes() as u32).collect(),
        };
        nodes.retain(|&node| (node as usize) < site.n_own);
        let (mut gradients, mut energies) = (Vec::new(), Vec::new());
        for &node in &nodes {
            let X = mesh.points()[node as usize];
            let c = self.centre;
            let r = [0, 1, 2].map(|i| X[i] - c[i]);
            let square: f64 = r.iter().map(|x| x * x).sum();
            if square == 0.0 || !square.is_finite() {
                return Err(Error::NotPositive {
                    what: "distance of a mass from the centre of attraction".into(),
                    value: square,
                });
            }
            // The gradient of the shape function of the moving end, along the first coordinate: t/L.
            gradients.push([r.map(|x| x / square), [0.0; 3], [0.0; 3]]);
            // A node without mass has no attraction: a strength of zero is invalid.
            let strength = self.strength * site.masses[node as usize];
            energies.push(
                Link::attraction(if strength == 0.0 { f64::MIN_POSITIVE } else { strength })?
                    .with_length(square.sqrt()),
            );
        }
        let table = CellTable {
            cells: vec![0; nodes.len()],
            n_nodes: 1,
            n_modes: 0,
            mode_gradients: Vec::new(),
            reference_gradients: vec![[1.0, 0.0, 0.0]],
            inverse_jacobians: gradients,
            weights: vec![1.0; nodes.len()],
            nodes,
        };
        let mut links = SolidForce::links(energies, table)?.on(Side::Outside);
        links.attach(site.pattern, site.parts);
        Ok(Arc::new(links))
    }
}
