//! Materials behind tables of functions, so that the averaging rules and the assembly are compiled once for all of
//! them.

use std::any::{Any, type_name};
use std::fmt;
use std::sync::Arc;

use pulp::{Arch, Simd, WithSimd};

use super::{Material, VolumeLaw};
use crate::tensor::{Batch, Elasticity, Lane, Sym, inlined};

/// A material at the points of one lane type: the functions of [`Material`] that the averaging rules call.
///
/// Every material implements it for every lane type. Results are written where the caller wants them, because a call
/// through a table cannot return registers.
pub trait Response<L: Lane>: Send + Sync {
    /// [`Material::IS_LINK`]: the energy belongs to a link.
    fn is_link(&self) -> bool;
    /// Stored energy, [`Material::strain_energy`].
    fn strain_energy(&self, strain: &Sym<L>) -> L;
    /// Stress, [`Material::stress`].
    fn stress(&self, strain: &Sym<L>, stress: &mut Sym<L>);
    /// Change of the energy, [`Material::energy_change`].
    fn energy_change(&self, strain: &Sym<L>, change: &Sym<L>) -> Option<L>;
    /// Quadrature of the stress along a path, [`Material::stress_along`].
    fn stress_along(&self, strain: &Sym<L>, change: &Sym<L>, points: &[[f64; 2]], stress: &mut Sym<L>);
    /// Stress and elasticity, [`Material::stress_and_elasticity`].
    fn stress_and_elasticity(&self, strain: &Sym<L>, stress: &mut Sym<L>, elasticity: &mut Elasticity<L>);
}

impl<M: Material, L: Lane> Response<L> for M {
    fn is_link(&self) -> bool {
        M::IS_LINK
    }

    fn strain_energy(&self, strain: &Sym<L>) -> L {
        strain[0].vectorize(inlined!(|| Material::strain_energy(self, strain)))
    }

    fn stress(&self, strain: &Sym<L>, stress: &mut Sym<L>) {
        strain[0].vectorize(inlined!(|| *stress = Material::stress(self, strain)));
    }

    fn energy_change(&self, strain: &Sym<L>, change: &Sym<L>) -> Option<L> {
        strain[0].vectorize(inlined!(|| Material::energy_change(self, strain, change)))
    }

    fn stress_along(&self, strain: &Sym<L>, change: &Sym<L>, points: &[[f64; 2]], stress: &mut Sym<L>) {
        strain[0].vectorize(inlined!(|| *stress = Material::stress_along(self, strain, change, points)));
    }

    fn stress_and_elasticity(&self, strain: &Sym<L>, stress: &mut Sym<L>, elasticity: &mut Elasticity<L>) {
        let compute = inlined!(|| (*stress, *elasticity) = Material::stress_and_elasticity(self, strain));
        strain[0].vectorize(compute);
    }
}

/// A material with the tables of its functions for single points and for the registers of this machine.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::material::CompiledMaterial;
/// let rubber = NeoHooke::new(1000.0, 500.0)?.compiled();
/// let stretched = [1.5, 0.0, 0.0, 0.0, 0.0, 0.0];
/// assert!(rubber.response::<f64>().strain_energy(&stretched) > 0.0);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Clone)]
pub struct CompiledMaterial {
    name: &'static str,
    points: Arc<dyn Response<f64>>,
    /// `Arc<dyn Response<Batch<S>>>` of the instruction set S of this machine.
    registers: Arc<dyn Any + Send + Sync>,
    split: Arc<dyn Fn(f64) -> Option<(CompiledMaterial, VolumeLaw)> + Send + Sync>,
}

impl CompiledMaterial {
    /// The tables of a material; its functions are compiled with the crate that calls this.
    pub fn new(material: &impl Material) -> Self {
        let whole = material.clone();
        let split = move |share| whole.split(share).map(|(points, law)| (points.compiled(), law));
        CompiledMaterial {
            name: type_name_of(material),
            points: Arc::new(material.clone()),
            registers: Arch::new().dispatch(RegisterTable(material.clone())),
            split: Arc::new(split),
        }
    }

    /// [`Material::split`].
    pub fn split(&self, share: f64) -> Option<(CompiledMaterial, VolumeLaw)> {
        (self.split)(share)
    }

    /// The functions for a lane type.
    ///
    /// # Panics
    /// For lanes other than `f64` and the registers of this machine.
    pub fn response<L: Lane>(&self) -> &dyn Response<L> {
        let points: &dyn Any = &self.points;
        let table = points.downcast_ref().or_else(|| self.registers.downcast_ref());
        let table: &Arc<dyn Response<L>> = table.expect("the instruction set of a machine does not change");
        &**table
    }
}

impl fmt::Debug for CompiledMaterial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

fn type_name_of<M>(_: &M) -> &'static str {
    type_name::<M>()
}

/// Makes the table of a material for the registers of an instruction set.
struct RegisterTable<M>(M);

impl<M: Material> WithSimd for RegisterTable<M> {
    type Output = Arc<dyn Any + Send + Sync>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let table: Arc<dyn Response<Batch<S>>> = Arc::new(self.0);
        Arc::new(table)
    }
}

/// Compiles the tables of a material with this crate: for use in its `impl Material`.
macro_rules! compiled_with_this_crate {
    () => {
        fn compiled(&self) -> crate::material::CompiledMaterial {
            crate::material::CompiledMaterial::new(self)
        }
    };
}
pub(super) use compiled_with_this_crate;
