//! Motions that Emmy and other programs compute alike: one description of each for all of them.

use std::fmt;
use std::path::Path;

use emmy::mesh::CellKind;

use crate::job::{Case, Job};
use crate::mesh_file::block_file;
use crate::peers;
use crate::scratch::Scratch;

/// The body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Shape {
    /// The L-shaped block in free flight, in cells of a kind, r of them (or r^3 times six tetrahedra) to a unit length.
    Block(CellKind, u32),
    /// A bracket of tet10, clamped at its foot, with a pulse on its tip.
    Bracket,
}

/// A motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Work {
    /// The body.
    pub shape: Shape,
    /// Whether waves cross many cells in a step; the moduli of soft bodies are smaller by [`STIFF`].
    pub stiff: bool,
    /// Key word of the material.
    pub material: &'static str,
    /// Number of steps.
    pub steps: u32,
}

/// Name of CalculiX among the solvers of DOLFINx.
pub(crate) const CALCULIX: &str = "calculix";
/// Key words of the materials that the script for DOLFINx has too; CalculiX has the second one.
pub(crate) const MATERIALS: [&str; 2] = ["neo-hooke", "saint-venant-kirchhoff"];

/// Moduli of a stiff body over those of a soft one.
const STIFF: f64 = 1e4;
/// Young's modulus \[MPa\] and Poisson's ratio of steel.
const STEEL: (f64, f64) = (2.1e5, 0.3);
/// Largest force on the tip of a soft and of a stiff bracket \[N\].
const FORCES: [f64; 2] = [100.0, 2000.0];
/// History of that force; `peers/dolfinx_block.py` has the same.
const PULSE: &str = "[[0.0, 0.0], [5e-4, 1.0], [1e-3, 0.0]]";
/// Tolerance of Newton's iteration in DOLFINx: the round-off of a stiff body is above 1e-10.
const TOLERANCE: &str = "1e-9";
/// Finest stiff blocks for the factorisations of MUMPS, for BoomerAMG and for CalculiX.
const LARGEST_CHOLESKY: u32 = 6;
const LARGEST_HYPRE: u32 = 4;
const LARGEST_CALCULIX: u32 = 4;

impl Work {
    /// The spinning block of neo-Hooke material in hex8 cells.
    pub(crate) fn hex8(r: u32, stiff: bool, steps: u32) -> Self {
        Work { shape: Shape::Block(CellKind::Hex8, r), stiff, material: MATERIALS[0], steps }
    }

    /// The steel bracket of St. Venant-Kirchhoff material.
    pub(crate) fn steel_bracket(steps: u32) -> Self {
        Work { shape: Shape::Bracket, stiff: true, material: MATERIALS[1], steps }
    }

    /// First Lame parameter and shear modulus.
    fn moduli(&self) -> [f64; 2] {
        let (youngs, poissons) = STEEL;
        let shear = youngs / (2.0 * (1.0 + poissons));
        let of_stiff = match self.shape {
            Shape::Block(..) => [1e7, 5e6],
            Shape::Bracket => [2.0 * shear * poissons / (1.0 - 2.0 * poissons), shear],
        };
        if self.stiff { of_stiff } else { of_stiff.map(|modulus| modulus / STIFF) }
    }

    fn step_size(&self) -> f64 {
        if self.shape == Shape::Bracket { 5e-5 } else { 0.02 }
    }

    fn force(&self) -> f64 {
        FORCES[usize::from(self.stiff)]
    }

    /// The case of Emmy, by the mid-point rule unless the scheme is changed.
    ///
    /// # Errors
    /// The message of the system if the mesh cannot be written.
    pub(crate) fn case(&self, scratch: &Scratch) -> Result<Case, String> {
        let case = match self.shape {
            Shape::Block(CellKind::Hex8, r) => Case::spinning_block(r),
            Shape::Block(kind, r) => Case::spinning_block_of(&block_file(scratch, kind, r)?),
            Shape::Bracket => Case::bracket()
                .with("load.force", format!("[0.0, 0.0, {:?}]", -self.force()))
                .with("load.history", PULSE),
        };
        let [lambda, mu] = self.moduli();
        let material = format!("{{ {} = {{ lambda = {lambda:?}, mu = {mu:?} }} }}", self.material);
        let case = case.with("region.material", material).scheme("FE(1)", 1);
        Ok(case.steps(self.steps, self.step_size()))
    }

    /// The case of Emmy with the equations of CalculiX.
    ///
    /// # Errors
    /// As [`Work::case`].
    pub(crate) fn like_calculix(&self, scratch: &Scratch) -> Result<Case, String> {
        let work = Work { material: MATERIALS[1], ..*self };
        Ok(work.case(scratch)?.scheme("Newmark(0.25,0.5)", 1))
    }

    /// Solvers of DOLFINx, among which its best one is, and CalculiX. BoomerAMG takes more than twice the time of GAMG,
    /// so it runs on smaller meshes only. CalculiX integrates the mass of tet10 with four points, which changes the
    /// energies of short waves, but not those of the stiff bracket; on the stiff block of hex20 its iteration diverges
    /// in the twelfth step.
    pub(crate) fn solvers(&self) -> Vec<&'static str> {
        let Work { shape: Shape::Block(CellKind::Hex8, r), stiff: true, .. } = *self else {
            let mut solvers =
                if self.stiff { vec!["gamg", "cholesky"] } else { vec!["jacobi", "icc", "cholesky"] };
            let is_alike = match self.shape {
                Shape::Block(CellKind::Tet10, _) => false,
                Shape::Block(CellKind::Hex20, _) => !self.stiff,
                Shape::Block(..) => true,
                Shape::Bracket => self.stiff,
            };
            solvers.extend((is_alike && self.material == MATERIALS[1]).then_some(CALCULIX));
            return solvers;
        };
        let largest = [
            ("gamg", u32::MAX),
            ("hypre", LARGEST_HYPRE),
            ("cholesky", LARGEST_CHOLESKY),
            (CALCULIX, LARGEST_CALCULIX),
        ];
        largest.into_iter().filter(|(_, largest)| r <= *largest).map(|(solver, _)| solver).collect()
    }

    /// The job of a solver of DOLFINx, or of CalculiX by its faster solver.
    pub(crate) fn job(&self, python: &Path, solver: &str) -> Job {
        let (r, kind) = match self.shape {
            Shape::Block(kind, r) => (r, kind),
            Shape::Bracket => (1, CellKind::Tet10),
        };
        let is_calculix = solver == CALCULIX;
        let of_calculix = if self.stiff { "spooles" } else { "scaling" };
        let mut words = vec![r.to_string(), if is_calculix { of_calculix } else { solver }.to_string()];
        let mut flag = |name: &str, values: &[String]| {
            words.push(format!("--{name}"));
            words.extend_from_slice(values);
        };
        flag("cells", &[kind.to_string()]);
        flag("moduli", &self.moduli().map(|modulus| format!("{modulus:?}")));
        flag("step-size", &[format!("{:?}", self.step_size())]);
        flag("steps", &[self.steps.to_string()]);
        if !is_calculix {
            flag("material", &[self.material.to_string()]);
            flag("tolerance", &[TOLERANCE.to_string()]);
            flag("guess", &[self.guess(solver).to_string()]);
        }
        if self.shape == Shape::Bracket {
            let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/meshes/steel-bracket.msh");
            flag("mesh", &[mesh.display().to_string()]);
            flag("density", &["7.85e-9".to_string()]);
            flag("force", &[format!("{:?}", self.force())]);
        }
        Job::script(python, &peers::script(if is_calculix { CALCULIX } else { "dolfinx" }), words, None)
    }

    /// First guess of DOLFINx for the middle of a step: the motion straight on for half a step saves an iteration; but
    /// it stretches what spins, and then the matrices of a stiff block are indefinite, which multigrid does not bear.
    fn guess(&self, solver: &str) -> f64 {
        let stretched = self.stiff && self.shape != Shape::Bracket;
        if stretched && solver != "cholesky" { 0.0 } else { 0.5 }
    }
}

impl fmt::Display for Work {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.shape {
            Shape::Block(kind, r) => write!(f, "{kind} r = {r}")?,
            Shape::Bracket => write!(f, "bracket")?,
        }
        write!(f, ", {}, {}", if self.stiff { "stiff" } else { "soft" }, self.material)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_programs_compute_the_same_motion() {
        let scratch = Scratch::new("work").unwrap();
        for (work, moduli) in [
            (Work::hex8(2, false, 3), ["1000.0", "500.0"]),
            (Work::hex8(2, true, 3), ["10000000.0", "5000000.0"]),
            (Work::steel_bracket(3), ["121153.84615384614", "80769.23076923077"]),
        ] {
            let case = Job::case(&work.case(&scratch).unwrap()).unwrap().to_string();
            let script = work.job(Path::new("python3"), "cholesky").to_string();
            assert!(case.contains(&format!("lambda = {}, mu = {}", moduli[0], moduli[1])), "{case}");
            assert!(script.contains(&format!("--moduli {} {}", moduli[0], moduli[1])), "{script}");
            assert!(case.contains(&format!("size = {:?}", work.step_size())), "{case}");
            assert!(script.contains(&format!("--step-size {:?} --steps 3", work.step_size())), "{script}");
        }
    }

    #[test]
    fn the_pulse_is_that_of_the_script() {
        let text = std::fs::read_to_string(peers::script("dolfinx")).unwrap();
        assert!(text.contains("PULSE = [0.0, 5e-4, 1e-3], [0.0, 1.0, 0.0]"));
        assert_eq!(PULSE, "[[0.0, 0.0], [5e-4, 1.0], [1e-3, 0.0]]");
    }
}
