//! Working memory of an assembly.

use std::any::Any;

use pulp::{Arch, Simd, WithSimd};

use super::projected::{VolumeMemory, VolumeRegisters};
use crate::average::Average;
use crate::force::pressures::PressureResults;
use crate::tensor::{Batch, LANES, Mat3, Packed, Register};

/// Working memory of an assembly, one for each part.
#[derive(Debug)]
pub struct Scratch {
    batch: BatchMemory,
    /// [`PointMemory`] of single cells, and of the registers that the machine has.
    points: [Box<dyn Any + Send + Sync>; 2],
    /// Results of the cells with pressures, of each term.
    pub pressures: Vec<PressureResults>,
}

/// Fields and results of a batch.
#[derive(Debug)]
pub(crate) struct BatchMemory {
    /// Nodal displacement and rates, or their combination at the only point of a rule, `[1 + k][n_nodes][3]`.
    pub(crate) nodal: Vec<[Packed; 3]>,
    /// Weighted stresses in reference coordinates, `w P J^-T`, `[k][point][3][3]`.
    pub(super) stress: Vec<[[Packed; 3]; 3]>,
    /// Gradients of the shape functions at a point, `[n_nodes][3]`.
    pub(super) gradients: Vec<[Packed; 3]>,
    /// Stage forces, `[k][n_nodes][3]`.
    pub force: Vec<[Packed; 3]>,
    /// Stage derivatives, `[k k][A][B][3 i + k]`; B >= A only where they are symmetric.
    pub stiffness: Vec<[Packed; 9]>,
    /// Smallest determinant that the rule met.
    pub min_det: Packed,
    /// Pressures of projected volumes.
    pub volume: VolumeMemory,
}

/// Working memory at a quadrature point.
#[derive(Debug)]
pub(crate) struct PointMemory<R> {
    pub(super) average: Average<R>,
    /// Displacement gradient at the start of the step, then the rates of the deformation gradient, `[1 + k]`.
    pub(super) gradients: Vec<Mat3<R>>,
    /// Made for the first cells with a projected volume.
    pub(super) volume: Option<VolumeRegisters<R>>,
}

/// Makes the memory of a degree for the registers of an instruction set.
struct NewPointMemory(usize);

impl WithSimd for NewPointMemory {
    type Output = Box<dyn Any + Send + Sync>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let degree = self.0;
        let zero = Batch::new(simd, 0.0);
        let gradients = vec![[[zero; 3]; 3]; 1 + degree];
        Box::new(PointMemory { average: Average::new(degree, zero), gradients, volume: None })
    }
}

impl Scratch {
    /// Memory for time elements of a degree and cells with up to so many nodes and quadrature points.
    pub(crate) fn new(degree: usize, n_nodes: usize, n_points: usize, n_pressure_terms: usize) -> Self {
        let zero = Packed([0.0; LANES]);
        let batch = BatchMemory {
            nodal: vec![[zero; 3]; (degree + 1) * n_nodes],
            stress: vec![[[zero; 3]; 3]; degree * n_points],
            gradients: vec![[zero; 3]; n_nodes],
            force: vec![[zero; 3]; degree * n_nodes],
            stiffness: vec![[zero; 9]; degree * degree * n_nodes * n_nodes],
            min_det: zero,
            volume: VolumeMemory::default(),
        };
        let points = [Arch::Scalar, Arch::new()].map(|arch| arch.dispatch(NewPointMemory(degree)));
        Scratch { batch, points, pressures: vec![PressureResults::default(); n_pressure_terms] }
    }

    /// The memory for the registers of a lane type.
    ///
    /// # Panics
    /// For registers that the machine does not have.
    #[inline(always)]
    pub(crate) fn of<R: Register>(
        &mut self,
    ) -> (&mut BatchMemory, &mut PointMemory<R>, &mut [PressureResults]) {
        let points = self.points.iter_mut().find_map(|points| points.downcast_mut());
        let points = points.expect("the instruction set of a machine does not change");
        (&mut self.batch, points, &mut self.pressures)
    }
}
