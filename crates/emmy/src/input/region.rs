//! Regions of a body.

use super::viscosity::Viscosity;
use crate::element::{CellKind, Formulation, PressureSpace};
use crate::input::RegionMaterial;
use crate::material::{Link, Material};

/// Part of the body with one material and density.
#[derive(Debug)]
pub struct Region {
    /// Cell group; `None`: every cell.
    pub group: Option<String>,
    /// Reference density \[mass/length^3\].
    pub density: f64,
    /// Thickness of its plane cells \[length\]; 1 unless it is set.
    pub thickness: f64,
    /// Viscosity; none unless it is set. Links have [`Viscosity::time`] only.
    pub viscosity: Viscosity,
    /// How its cells represent their strain.
    pub formulation: Formulation,
    pub(crate) material: RegionMaterial,
}

impl Region {
    /// The region of all cells, of a material with a reference density \[mass/length^3\].
    pub fn new(material: impl Material, density: f64) -> Self {
        Region::of(RegionMaterial::Solid(material.compiled()), density)
    }

    /// The region of all cells, with links. Bars need the density; springs and attractions have no mass.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let mesh = Mesh::from_cells(CellKind::Line2, &[[0.0; 3], [3.0, 4.0, 0.0]], &[[0, 1]])?;
    /// let bar = Region::links(Link::bar(1000.0, 0.1)?, 2.0);
    /// assert!((Body::builder(mesh).region(bar).build()?.regions()[0].mass - 1.0).abs() < 1e-15);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn links(link: Link, density: f64) -> Self {
        Region::of(RegionMaterial::Link(link), density)
    }

    fn of(material: RegionMaterial, density: f64) -> Self {
        Region {
            group: None,
            density,
            thickness: 1.0,
            viscosity: Viscosity::default(),
            formulation: Formulation::Standard,
            material,
        }
    }

    /// The same region on the cells of a group.
    pub fn on(self, group: impl Into<String>) -> Self {
        Region { group: Some(group.into()), ..self }
    }

    /// The link of a region of links.
    pub fn link(&self) -> Option<Link> {
        match self.material {
            RegionMaterial::Solid(_) => None,
            RegionMaterial::Link(link) => Some(link),
        }
    }

    /// Young's modulus at small strain \[force/length^2\]; `None` for springs and attractions. For a material with
    /// directions it is that of the mean elasticity over all directions.
    ///
    /// ```math
    /// E = 9 K mu / (3 K + mu),      K = D_iijj / 9,      mu = (D_ijij - D_iijj / 3) / 10
    /// ```
    ///
    /// Source: Voigt (1889), Ann. Phys. 274.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let steel = Region::new(NeoHooke::from_engineering(2.1e5, 0.3)?, 7.85e-9);
    /// assert!((steel.youngs_modulus().unwrap() - 2.1e5).abs() < 1e-9);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    #[allow(non_snake_case)]
    pub fn youngs_modulus(&self) -> Option<f64> {
        if let Some(link) = self.link() {
            return link.youngs_modulus();
        }
        let [K, mu] = self.moduli()?;
        Some(9.0 * K * mu / (3.0 * K + mu))
    }

    /// Bulk and shear modulus at small strain \[force/length^2\], as in [`Region::youngs_modulus`]; `None` for links.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHookeIsochoric::new(0.3, 150.0, Volumetric::default())?, 1e-9);
    /// let [bulk, shear] = rubber.moduli().unwrap();
    /// assert!((bulk - 150.0).abs() < 1e-12 && (shear - 0.3).abs() < 1e-15 * bulk);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    #[allow(non_snake_case)]
    pub fn moduli(&self) -> Option<[f64; 2]> {
        let RegionMaterial::Solid(material) = &self.material else { return None };
        let mut D = [[0.0; 6]; 6];
        material.response::<f64>().stress_and_elasticity(&[0.0; 6], &mut [0.0; 6], &mut D);
        let iijj: f64 = D[..3].iter().flat_map(|row| &row[..3]).sum();
        let ijij = (0..6).map(|a| D[a][a] * if a < 3 { 1.0 } else { 2.0 }).sum::<f64>();
        Some([iijj / 9.0, (ijij - iijj / 3.0) / 10.0])
    }

    /// Stored energy at a Green-Lagrange strain `[11, 22, 33, 12, 23, 13]` \[energy/length^3\]; `None` for links.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
    /// let [stretched, mut stress] = [[1.5, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0; 6]];
    /// let ln_2 = std::f64::consts::LN_2;
    /// let energy = rubber.strain_energy(&stretched, &mut stress).unwrap();
    /// assert!((energy - (750.0 + 500.0 * ln_2 * ln_2 - 500.0 * ln_2)).abs() < 1e-10);
    /// assert!((stress[1] - 1000.0 * ln_2).abs() < 1e-10); // lambda ln J across
    /// # Ok::<(), emmy::Error>(())
    /// ```
    ///
    /// `stress` becomes the second Piola-Kirchhoff stress there.
    pub fn strain_energy(&self, strain: &[f64; 6], stress: &mut [f64; 6]) -> Option<f64> {
        let RegionMaterial::Solid(material) = &self.material else { return None };
        let response = material.response::<f64>();
        response.stress(strain, stress);
        Some(response.strain_energy(strain))
    }

    /// The functions of the pressure in its cells of a kind with a formulation; `None` for a formulation without them.
    ///
    /// # Errors
    /// The reason why the kind or the material does not have the formulation, with the remedy.
    ///
    /// ```
    /// use emmy::body::{Formulation, PressureSpace};
    /// use emmy::mesh::CellKind;
    /// use emmy::prelude::*;
    /// let steel = Region::new(NeoHooke::from_engineering(2.1e5, 0.3)?, 7.85e-9);
    /// let space = steel.pressure_space(Formulation::ProjectedVolume(None), CellKind::Hex8);
    /// assert_eq!(space, Ok(Some(PressureSpace::Constant)));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn pressure_space(
        &self,
        formulation: Formulation,
        kind: CellKind,
    ) -> Result<Option<PressureSpace>, String> {
        let split = self.material.split(formulation, kind)?;
        Ok(split.map(|(space, ..)| space))
    }

    /// The same region with another thickness of its plane cells.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let plate = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0).with_thickness(0.1);
    /// let body = Body::builder(mesh::rectangle([3.0, 4.0], [3, 4])?).region(plate).build()?;
    /// assert!((body.regions()[0].mass - 2.4).abs() < 1e-14);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn with_thickness(self, thickness: f64) -> Self {
        Region { thickness, ..self }
    }

    /// The same region with a viscosity.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let viscosity = Viscosity { time: 1e-3, ..Viscosity::default() };
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0).with_viscosity(viscosity);
    /// assert!(Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?.is_viscous());
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn with_viscosity(self, viscosity: Viscosity) -> Self {
        Region { viscosity, ..self }
    }

    /// The same region with another formulation of its cells.
    ///
    /// ```
    /// use emmy::body::Formulation;
    /// use emmy::prelude::*;
    /// let silicone = NeoHookeIsochoric::new(0.3e6, 1.5e9, Volumetric::default())?;
    /// let mount = Region::new(silicone, 1100.0).with_formulation(Formulation::ProjectedVolume(None));
    /// let body = Body::builder(mesh::block([0.02; 3], [4; 3])?).region(mount).build()?;
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn with_formulation(self, formulation: Formulation) -> Self {
        Region { formulation, ..self }
    }
}
