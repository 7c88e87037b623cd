//! `material.MODEL = { ... }`: one small function a model.

use emmy::body::Region;
use emmy::material::{
    ArrudaBoyce, CiarletGeymonat, EngineeringConstants, Gent, Hencky, HolzapfelGasserOgden, Link,
    MooneyRivlin, NeoHooke, Ogden, Orthotropic, SaintVenantKirchhoff, Volumetric, Yeoh,
};

use super::derived;
use super::fault::Fault;
use super::keys::{self, Keys};
use super::table::{Item, Table};

/// Reads the one model of a material and makes the region of it.
pub(super) fn region(item: Item<'_>, group: Option<String>, density: f64) -> Result<Region, Fault> {
    let materials = item.table(keys::MATERIAL)?;
    let item = materials.exactly_one("one model", keys::MATERIAL.keys)?;
    Ok(match item.key() {
        "saint-venant-kirchhoff" => {
            let new = [SaintVenantKirchhoff::new, SaintVenantKirchhoff::from_engineering];
            Region::new(group, density, from_a_pair(item, new)?)
        }
        "neo-hooke" => {
            Region::new(group, density, from_a_pair(item, [NeoHooke::new, NeoHooke::from_engineering])?)
        }
        "ciarlet-geymonat" => {
            let new = [CiarletGeymonat::new, CiarletGeymonat::from_engineering];
            Region::new(group, density, from_a_pair(item, new)?)
        }
        "hencky" => Region::new(group, density, from_a_pair(item, [Hencky::new, Hencky::from_engineering])?),
        "mooney-rivlin" => Region::new(group, density, mooney_rivlin(item)?),
        "yeoh" => Region::new(group, density, yeoh(item)?),
        "gent" => Region::new(group, density, gent(item)?),
        "arruda-boyce" => Region::new(group, density, arruda_boyce(item)?),
        "ogden" => Region::new(group, density, ogden(item)?),
        "orthotropic" => Region::new(group, density, orthotropic(item)?),
        "bar" => Region::links(group, density, bar(item)?),
        "spring" => Region::links(group, density, spring(item)?),
        "attraction" => Region::links(group, density, attraction(item)?),
        _ => Region::new(group, density, holzapfel_gasser_ogden(item)?),
    })
}

/// Values of parameters that are left out.
pub(super) const DEFAULTS: &str = "
mooney-rivlin = { volumetric = 'simo-taylor' }
yeoh = { volumetric = 'simo-taylor' }
gent = { volumetric = 'simo-taylor' }
arruda-boyce = { volumetric = 'simo-taylor' }
ogden = { volumetric = 'simo-taylor' }
orthotropic = { axis_1 = [1, 0, 0], axis_2 = [0, 1, 0] }
holzapfel-gasser-ogden = { kappa = 0.0, volumetric = 'simo-taylor' }
";

/// The parameters of a model.
struct Parameters<'a> {
    item: Item<'a>,
    table: Table<'a>,
}

impl<'a> Parameters<'a> {
    fn read(item: Item<'a>, keys: Keys) -> Result<Self, Fault> {
        Ok(Parameters { item, table: item.table(keys)? })
    }

    fn number(&self, key: &str) -> Result<f64, Fault> {
        let item = self.table.require(key)?;
        derived::within(&item, item.number()?)
    }

    fn numbers<const N: usize>(&self, keys: [&str; N]) -> Result<[f64; N], Fault> {
        let mut values = [0.0; N];
        for (value, key) in values.iter_mut().zip(keys) {
            *value = self.number(key)?;
        }
        Ok(values)
    }

    /// A list with at least one entry.
    fn list(&self, key: &str) -> Result<Vec<Item<'a>>, Fault> {
        let item = self.table.require(key)?;
        match item.list()? {
            items if items.is_empty() => Err(item.fault(format!("`{key}` is empty"), "empty")),
            items => Ok(items),
        }
    }

    fn direction(&self, key: &str) -> Result<[f64; 3], Fault> {
        self.table.require(key)?.numbers()
    }

    /// Bulk modulus and law of volume.
    fn volume(&self) -> Result<(f64, Volumetric), Fault> {
        let bulk_modulus = self.number("bulk_modulus")?;
        let item = self.table.require("volumetric")?;
        let word = item.word("a law of volume", &Volumetric::ALL.map(Volumetric::name))?;
        Ok((bulk_modulus, word.parse().map_err(|message: String| item.fault(message, "not known"))?))
    }

    /// The model, or a fault at the parameter that is out of range.
    fn checked<M>(&self, model: emmy::Result<M>) -> Result<M, Fault> {
        model.map_err(|error| {
            let guilty = match &error {
                emmy::Error::MaterialParameter { parameter, .. } => self.table.get(parameter),
                _ => None,
            };
            guilty.unwrap_or(self.item).fault(error.to_string(), "out of range")
        })
    }
}

type FromTwo<M> = fn(f64, f64) -> emmy::Result<M>;

const PAIRS: [[&str; 2]; 2] = [["lambda", "mu"], ["youngs_modulus", "poissons_ratio"]];

/// A model from one of the two pairs of parameters.
fn from_a_pair<M>(item: Item<'_>, new: [FromTwo<M>; 2]) -> Result<M, Fault> {
    let parameters = Parameters::read(item, keys::PARAMETERS)?;
    let given = |pair: [&str; 2]| pair.map(|key| parameters.table.get(key).is_some());
    let pair = match PAIRS.map(given) {
        [[true, true], [false, false]] => 0,
        [[false, false], [true, true]] => 1,
        _ => {
            let message = format!("`{}` needs exactly one pair of parameters: ", item.key());
            let pairs = "either `lambda` and `mu`, or `youngs_modulus` and `poissons_ratio`";
            return Err(item.fault(message + pairs, "not one pair"));
        }
    };
    let [a, b] = parameters.numbers(PAIRS[pair])?;
    if pair == 1 {
        derived::check_lame(&item, a, b)?;
    }
    parameters.checked(new[pair](a, b))
}

fn mooney_rivlin(item: Item<'_>) -> Result<MooneyRivlin, Fault> {
    let parameters = Parameters::read(item, keys::MOONEY_RIVLIN)?;
    let ([c10, c01], (bulk_modulus, law)) = (parameters.numbers(["c10", "c01"])?, parameters.volume()?);
    parameters.checked(MooneyRivlin::new(c10, c01, bulk_modulus, law))
}

fn yeoh(item: Item<'_>) -> Result<Yeoh, Fault> {
    let parameters = Parameters::read(item, keys::YEOH)?;
    let (moduli, (bulk_modulus, law)) = (parameters.numbers(["c10", "c20", "c30"])?, parameters.volume()?);
    parameters.checked(Yeoh::new(moduli, bulk_modulus, law))
}

fn gent(item: Item<'_>) -> Result<Gent, Fault> {
    let parameters = Parameters::read(item, keys::GENT)?;
    let ([mu, jm], (bulk_modulus, law)) = (parameters.numbers(["mu", "jm"])?, parameters.volume()?);
    parameters.checked(Gent::new(mu, jm, bulk_modulus, law))
}

fn arruda_boyce(item: Item<'_>) -> Result<ArrudaBoyce, Fault> {
    let parameters = Parameters::read(item, keys::ARRUDA_BOYCE)?;
    let ([mu, lambda_m], (bulk_modulus, law)) =
        (parameters.numbers(["mu", "lambda_m"])?, parameters.volume()?);
    parameters.checked(ArrudaBoyce::new(mu, lambda_m, bulk_modulus, law))
}

fn ogden(item: Item<'_>) -> Result<Ogden, Fault> {
    let parameters = Parameters::read(item, keys::OGDEN)?;
    let (mu, alpha) = (parameters.list("mu")?, parameters.list("alpha")?);
    if mu.len() != alpha.len() {
        let message =
            format!("`mu` has {} entries and `alpha` {}; a term has one of each", mu.len(), alpha.len());
        return Err(parameters.table.require("alpha")?.fault(message, "not as many as `mu`"));
    }
    let term = |(mu, alpha): (&Item<'_>, &Item<'_>)| Ok((mu.number()?, alpha.number()?));
    let terms = mu.iter().zip(&alpha).map(term).collect::<Result<Vec<_>, Fault>>()?;
    let (bulk_modulus, law) = parameters.volume()?;
    parameters.checked(Ogden::new(&terms, bulk_modulus, law))
}

fn orthotropic(item: Item<'_>) -> Result<Orthotropic, Fault> {
    let parameters = Parameters::read(item, keys::ORTHOTROPIC)?;
    let constants = EngineeringConstants {
        youngs_moduli: parameters.numbers(["youngs_modulus_1", "youngs_modulus_2", "youngs_modulus_3"])?,
        poissons_ratios: parameters.numbers([
            "poissons_ratio_12",
            "poissons_ratio_23",
            "poissons_ratio_13",
        ])?,
        shear_moduli: parameters.numbers(["mu_12", "mu_23", "mu_13"])?,
    };
    let directions = [parameters.direction("axis_1")?, parameters.direction("axis_2")?];
    parameters.checked(Orthotropic::new(constants, directions))
}

fn holzapfel_gasser_ogden(item: Item<'_>) -> Result<HolzapfelGasserOgden, Fault> {
    let parameters = Parameters::read(item, keys::HOLZAPFEL_GASSER_OGDEN)?;
    let [mu, k1, k2, kappa] = parameters.numbers(["mu", "k1", "k2", "kappa"])?;
    let fibres = parameters.list("fibres")?;
    let fibres = fibres.iter().map(|item| item.numbers()).collect::<Result<Vec<_>, _>>()?;
    let (bulk_modulus, law) = parameters.volume()?;
    parameters.checked(HolzapfelGasserOgden::new(mu, [k1, k2], kappa, &fibres, bulk_modulus, law))
}

fn bar(item: Item<'_>) -> Result<Link, Fault> {
    let parameters = Parameters::read(item, keys::BAR)?;
    let [youngs_modulus, area] = parameters.numbers(["youngs_modulus", "area"])?;
    parameters.checked(Link::bar(youngs_modulus, area))
}

fn spring(item: Item<'_>) -> Result<Link, Fault> {
    let parameters = Parameters::read(item, keys::SPRING)?;
    let rest_length = parameters.table.get("rest_length").map(|item| item.number()).transpose()?;
    parameters.checked(Link::spring(parameters.number("stiffness")?, rest_length))
}

fn attraction(item: Item<'_>) -> Result<Link, Fault> {
    let parameters = Parameters::read(item, keys::ATTRACTION)?;
    parameters.checked(Link::attraction(parameters.number("strength")?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_law_of_volume_is_that_of_the_library() {
        let name = Volumetric::default().name();
        assert_eq!(DEFAULTS.matches("volumetric = ").count(), DEFAULTS.matches(&format!("'{name}'")).count());
    }
}
