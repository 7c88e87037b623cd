//! Terms of the cells, made when the first forces are wanted: what only reads a body needs no geometry of points.

use super::elimination;
use super::system::Body;
use crate::force::term::{Terms, time_of, traces};
use crate::force::{Term, cells};

impl Terms {
    fn new(body: &Body) -> Self {
        let counts = |cell: u32| body.subdomain.as_ref().is_none_or(|part| part.counts()[cell as usize]);
        let of_cells = |chosen: &dyn Fn(u32) -> bool| {
            let terms = cells::terms(&body.mesh, &body.made_of, &body.region_of_cell, &body.internal, chosen);
            // The builder has checked all else.
            terms.unwrap_or_else(|error| panic!("{error}"))
        };
        let mut all = of_cells(&counts);
        let n_counted = all.len();
        if body.subdomain.is_some() {
            all.extend(of_cells(&|cell| !counts(cell)));
        }
        all.iter_mut().for_each(|term| term.attach(&body.pattern, &body.parts));
        elimination::number(&mut all, &body.parts);
        Terms { all, n_counted }
    }
}

impl Body {
    /// Terms of the cells, made on first use; those of cells that count on another rank are last.
    pub(super) fn terms(&self) -> &[Box<dyn Term>] {
        &self.terms.get_or_init(|| Terms::new(self)).all
    }

    /// Terms of the cells that count here.
    pub(super) fn counted_terms(&self) -> impl Iterator<Item = &Box<dyn Term>> {
        let terms = self.terms.get_or_init(|| Terms::new(self));
        terms.all[..terms.n_counted].iter()
    }

    /// Mean viscosity of the cells over their mean stiffness at rest \[time\].
    pub(super) fn own_viscous_time(&self) -> f64 {
        if self.is_viscous() { time_of(traces(self.counted_terms())) } else { 0.0 }
    }
}
