//! Every item: the table and the figures of the paper, and additional ones.

mod classic;
mod contact;
mod degrees;
mod free_flight;
mod harmonic_response;
mod inner_points;
mod large_strain;
mod locking;
mod mechanisms;
mod n_body;
mod quasi_rigid;
mod study;
mod table_3;

use crate::case::Case;
use crate::claim::Item;
use crate::measure::{energy_drift, momentum_drift};
use crate::picture::{Pictures, Series};
use study::Reference;

/// Extent of the computation: `quick` for continuous integration, the full set as in the paper.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    /// Coarser references, fewer points, no claims about time.
    pub quick: bool,
    /// Interpreter that can import EXUDYN, for a comparison.
    pub exudyn: Option<&'static std::path::Path>,
    /// The program ccx of CalculiX, for a comparison.
    pub ccx: Option<&'static std::path::Path>,
    /// Python with MuJoCo, for a comparison.
    pub mujoco: Option<&'static std::path::Path>,
}

impl Effort {
    /// Step sizes of Figs. 5 and 13.
    fn sizes(self) -> &'static [f64] {
        if self.quick { &[0.04, 0.02, 0.01] } else { &[0.04, 0.02, 0.01, 0.005, 0.0025] }
    }

    /// The paper's reference has steps of 1e-4; a time element of degree 3 with larger ones reaches the same error
    /// sooner.
    fn reference(self) -> Reference {
        if self.quick { Reference("DGM", 3, 0.005) } else { Reference("DGM", 1, 1e-4) }
    }
}

/// One item of the page.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
    /// Key word.
    pub name: &'static str,
    /// Computes the item and writes its pictures.
    pub reproduce: fn(Effort, &Pictures) -> Result<Item, String>,
    /// Whether times are measured; then nothing else may run at the same time.
    pub timed: bool,
    /// Whether it takes so long that it runs only if it is named.
    pub long: bool,
}

const fn entry(name: &'static str, reproduce: fn(Effort, &Pictures) -> Result<Item, String>) -> Entry {
    Entry { name, reproduce, timed: false, long: false }
}

const fn timed(name: &'static str, reproduce: fn(Effort, &Pictures) -> Result<Item, String>) -> Entry {
    Entry { name, reproduce, timed: true, long: false }
}

/// All items, in the order of the page.
pub(crate) const ALL: [Entry; 29] = [
    entry("table-3", table_3::table_3),
    entry("figure-3", large_strain::figure_3),
    entry("figure-4", quasi_rigid::figure_4),
    entry("figure-5", quasi_rigid::figure_5),
    entry("figure-6", quasi_rigid::figure_6),
    entry("figure-7", quasi_rigid::figure_7),
    entry("figure-8", quasi_rigid::figure_8),
    entry("figure-10", large_strain::figure_10),
    entry("figure-11", large_strain::figure_11),
    entry("figure-12", large_strain::figure_12),
    entry("figure-13", large_strain::figure_13),
    entry("classic-large-strain", classic::large_strain),
    entry("classic-quasi-rigid", classic::quasi_rigid),
    timed("classic-cost", classic::cost),
    timed("degrees-smooth", degrees::smooth),
    timed("degrees-block", degrees::block),
    timed("inner-points", inner_points::inner_points),
    entry("two-body", n_body::two_body),
    entry("spring-network", n_body::spring_network),
    entry("free-flight", free_flight::free_flight),
    entry("inf-sup", locking::inf_sup),
    entry("cook", locking::cook),
    entry("cantilever", locking::cantilever),
    entry("silicone", locking::silicone),
    entry("harmonic-response", harmonic_response::harmonic_response),
    timed("mechanisms", mechanisms::mechanisms),
    Entry { long: true, ..timed("mechanisms-long", mechanisms::long) },
    entry("contact", contact::contact),
    Entry { long: true, ..entry("contact-long", contact::long) },
];

/// Below this relative drift a quantity counts as conserved, above [`LOST`] as not; nothing may lie between.
const CONSERVED: f64 = 1e-9;
const LOST: f64 = 1e-5;

/// Lost data of the paper's test problem, and their replacement.
pub(crate) const COMPLETED: &str = "The paper's text does not give the mesh, the magnitudes of the load or its peak. Geometry and load vector \
    are those of the group's later public examples of the same block; the peak of 1 at t = 0.5 is chosen because it reproduces what the \
    paper reports of Figs. 7 and 12.";

/// The claim that a case with a scheme keeps energy and angular momentum after the load, with its picture.
fn conserved(item: &mut Item, pictures: &Pictures, name: &str, case: &Case) -> Result<(), String> {
    let run = case.run()?;
    let (energy, momentum) = (energy_drift(run.after(1.0)), momentum_drift(run.after(1.0)));
    item.claim(
        format!("{name} conserves energy and angular momentum at any step size"),
        format!("drift of H {energy:.1e}, of L {momentum:.1e}"),
        run.failure.is_none() && energy < CONSERVED && momentum < CONSERVED,
    );
    let mut series = vec![Series::line("H", run.history(0.0, |r| r.total_energy))];
    for (i, label) in ["L_1", "L_2", "L_3"].into_iter().enumerate() {
        series.push(Series::line(label, run.history(0.0, move |r| r.angular_momentum[i])));
    }
    let stem = format!("{}-{}", item.name, name.to_lowercase().replace(['(', ')'], ""));
    let title = format!("{name}: energy and angular momentum");
    item.pictures.push(pictures.linear(&stem, &title, ["t", "H, L"], series)?);
    item.commands.push(case.command());
    Ok(())
}
