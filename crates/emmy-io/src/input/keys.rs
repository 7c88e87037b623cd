//! Every key of the input, by table. A key that is not here is an error.
//!
//! A new key is described in `docs/input.md` and in `schema`; tests of both name it until it is.

/// Keys of a table, with the name by which messages speak of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Keys {
    /// Name of the table.
    pub(super) table: &'static str,
    /// Its keys.
    pub(super) keys: &'static [&'static str],
}

const fn keys(table: &'static str, keys: &'static [&'static str]) -> Keys {
    Keys { table, keys }
}

pub(super) const ROOT: Keys = keys(
    "the input",
    &[
        "title", "mesh", "region", "mass", "load", "support", "initial", "time", "newton", "solver",
        "output", "limits",
    ],
);
pub(super) const MESH: Keys = keys("[mesh]", &["l-block", "box", "rectangle", "network", "file", "scale"]);
pub(super) const L_BLOCK: Keys = keys("l-block", &["cell_size"]);
pub(super) const BOX: Keys = keys("box", &["size", "cells"]);
pub(super) const RECTANGLE: Keys = keys("rectangle", &["size", "cells"]);
pub(super) const NETWORK: Keys = keys("network", &["points", "links", "groups", "link_groups"]);
pub(super) const MASS: Keys = keys("[[mass]]", &["group", "mass"]);
pub(super) const REGION: Keys =
    keys("[[region]]", &["group", "density", "thickness", "material", "viscosity"]);
pub(super) const VISCOSITY: Keys = keys("`viscosity`", &["time", "shear", "bulk"]);
pub(super) const MATERIAL: Keys = keys(
    "material",
    &[
        "saint-venant-kirchhoff",
        "neo-hooke",
        "ciarlet-geymonat",
        "hencky",
        "mooney-rivlin",
        "yeoh",
        "gent",
        "arruda-boyce",
        "ogden",
        "orthotropic",
        "holzapfel-gasser-ogden",
        "bar",
        "spring",
        "attraction",
    ],
);
pub(super) const BAR: Keys = keys("bar", &["youngs_modulus", "area"]);
pub(super) const SPRING: Keys = keys("spring", &["stiffness", "rest_length"]);
pub(super) const ATTRACTION: Keys = keys("attraction", &["strength"]);
pub(super) const ATTRACTION_TO_A_POINT: Keys = keys("the attraction of a [[load]]", &["centre", "strength"]);
pub(super) const PARAMETERS: Keys = keys("a material", &["lambda", "mu", "youngs_modulus", "poissons_ratio"]);
pub(super) const MOONEY_RIVLIN: Keys = keys("mooney-rivlin", &["c10", "c01", "bulk_modulus", "volumetric"]);
pub(super) const YEOH: Keys = keys("yeoh", &["c10", "c20", "c30", "bulk_modulus", "volumetric"]);
pub(super) const GENT: Keys = keys("gent", &["mu", "jm", "bulk_modulus", "volumetric"]);
pub(super) const ARRUDA_BOYCE: Keys = keys("arruda-boyce", &["mu", "lambda_m", "bulk_modulus", "volumetric"]);
pub(super) const OGDEN: Keys = keys("ogden", &["mu", "alpha", "bulk_modulus", "volumetric"]);
pub(super) const ORTHOTROPIC: Keys = keys(
    "orthotropic",
    &[
        "youngs_modulus_1",
        "youngs_modulus_2",
        "youngs_modulus_3",
        "poissons_ratio_12",
        "poissons_ratio_23",
        "poissons_ratio_13",
        "mu_12",
        "mu_23",
        "mu_13",
        "axis_1",
        "axis_2",
    ],
);
pub(super) const HOLZAPFEL_GASSER_OGDEN: Keys =
    keys("holzapfel-gasser-ogden", &["mu", "k1", "k2", "kappa", "fibres", "bulk_modulus", "volumetric"]);
pub(super) const LOAD: Keys = keys(
    "[[load]]",
    &[
        "group",
        "traction",
        "force",
        "nodal_force",
        "pressure",
        "acceleration",
        "attraction",
        "drag",
        "history",
    ],
);
pub(super) const SUPPORT: Keys =
    keys("[[support]]", &["group", "fix", "move", "rotate", "symmetry", "spring", "until"]);
pub(super) const MOVE: Keys = keys("move", &["x", "y", "z"]);
pub(super) const ROTATE: Keys = keys("rotate", &["axis", "about", "angle"]);
pub(super) const INITIAL: Keys =
    keys("[initial]", &["group", "velocity", "angular_velocity", "about", "gradient"]);
pub(super) const TIME: Keys =
    keys("[time]", &["scheme", "degree", "steps", "smallest_step", "adaptive", "until"]);
pub(super) const ADAPTIVE: Keys = keys(
    "`adaptive`",
    &[
        "tolerance",
        "min_size",
        "max_size",
        "first_size",
        "length",
        "velocity",
        "estimator",
        "min_degree",
        "max_degree",
    ],
);
pub(super) const PHASE: Keys = keys("a phase of steps", &["until", "size"]);
pub(super) const NEWTON: Keys = keys("[newton]", &["tolerance", "max_iterations"]);
pub(super) const SOLVER: Keys = keys("[solver]", &["kind"]);
pub(super) const OUTPUT: Keys = keys(
    "[output]",
    &[
        "directory",
        "every",
        "interval",
        "format",
        "precision",
        "fields",
        "checkpoint_every",
        "log_every",
        "probes",
    ],
);
pub(super) const PROBE: Keys = keys("a probe", &["name", "point"]);
pub(super) const LIMITS: Keys = keys("[limits]", &["energy", "angular_momentum"]);

/// Every table. `schema` describes each of them.
pub(super) const TABLES: [Keys; 35] = [
    ROOT,
    MESH,
    L_BLOCK,
    BOX,
    RECTANGLE,
    NETWORK,
    MASS,
    REGION,
    VISCOSITY,
    MATERIAL,
    BAR,
    SPRING,
    ATTRACTION,
    ATTRACTION_TO_A_POINT,
    PARAMETERS,
    MOONEY_RIVLIN,
    YEOH,
    GENT,
    ARRUDA_BOYCE,
    OGDEN,
    ORTHOTROPIC,
    HOLZAPFEL_GASSER_OGDEN,
    LOAD,
    SUPPORT,
    MOVE,
    ROTATE,
    INITIAL,
    TIME,
    ADAPTIVE,
    PHASE,
    NEWTON,
    SOLVER,
    OUTPUT,
    PROBE,
    LIMITS,
];

/// Words that people bring from elsewhere, and the keys they stand for.
const KIN: &[(&str, &str)] = &[
    ("E", "youngs_modulus"),
    ("tol", "tolerance"),
    ("dt_min", "min_size"),
    ("dt_max", "max_size"),
    ("nu", "poissons_ratio"),
    ("rho", "density"),
    ("young", "youngs_modulus"),
    ("poisson", "poissons_ratio"),
    ("G", "mu"),
    ("k", "stiffness"),
    ("l0", "rest_length"),
    ("cross_section", "area"),
    ("truss", "bar"),
    ("gravitation", "attraction"),
    ("point-mass", "mass"),
    ("nodes", "points"),
    ("elements", "links"),
    ("center", "centre"),
    ("shear_modulus", "mu"),
    ("K", "bulk_modulus"),
    ("bulk", "bulk_modulus"),
    ("Jm", "jm"),
    ("c1", "c10"),
    ("c2", "c01"),
    ("C10", "c10"),
    ("C01", "c01"),
    ("C20", "c20"),
    ("C30", "c30"),
    ("locking_stretch", "lambda_m"),
    ("lambda_L", "lambda_m"),
    ("E1", "youngs_modulus_1"),
    ("E2", "youngs_modulus_2"),
    ("E3", "youngs_modulus_3"),
    ("nu12", "poissons_ratio_12"),
    ("nu23", "poissons_ratio_23"),
    ("nu13", "poissons_ratio_13"),
    ("G12", "mu_12"),
    ("G23", "mu_23"),
    ("G13", "mu_13"),
    ("fiber", "fibres"),
    ("fibers", "fibres"),
    ("dispersion", "kappa"),
    ("svk", "saint-venant-kirchhoff"),
    ("mooney", "mooney-rivlin"),
    ("eight-chain", "arruda-boyce"),
    ("hgo", "holzapfel-gasser-ogden"),
    ("dt", "size"),
    ("h", "size"),
    ("time_step", "size"),
    ("step_size", "size"),
    ("end_time", "until"),
    ("order", "degree"),
    ("method", "scheme"),
    ("gravity", "acceleration"),
    ("point_force", "nodal_force"),
    ("concentrated_force", "nodal_force"),
    ("p", "pressure"),
    ("follower_pressure", "pressure"),
    ("surface_load", "traction"),
    ("omega", "angular_velocity"),
    ("center", "about"),
    ("boundary", "support"),
    ("fixed", "fix"),
    ("release", "until"),
    ("mirror", "symmetry"),
    ("displacement", "move"),
    ("prescribe", "move"),
    ("rotation", "rotate"),
    ("amplitude", "history"),
    ("variables", "fields"),
    ("arrays", "fields"),
    ("file_format", "format"),
];

impl Keys {
    /// The key of this table that is meant by a word which does not belong to it, or the table it belongs to.
    pub(super) fn advice(self, word: &str) -> Option<String> {
        if word.split_once('.').is_some_and(|(first, _)| self.keys.contains(&first)) {
            return Some(format!("without the quotes: {word}"));
        }
        let mut kin = KIN.iter().filter(|(other, _)| *other == word).map(|(_, key)| *key);
        let first = kin.clone().next();
        let here = kin.find(|key| self.keys.contains(key)).map(|key| format!("did you mean `{key}`?"));
        here.or_else(|| super::suggest::did_you_mean(word, self.keys.iter().copied()))
            .or_else(|| self.elsewhere(word))
            .or_else(|| first.and_then(|key| self.elsewhere(key)))
    }

    /// The table that has a key: the one around this table, if it has it.
    fn elsewhere(self, word: &str) -> Option<String> {
        let own = self.table.trim_matches('`');
        let mut tables = TABLES.iter().filter(|table| table.keys.contains(&word));
        let around = tables.clone().find(|table| table.keys.contains(&own));
        around.or_else(|| tables.next()).map(|table| format!("`{word}` belongs in {}", table.table))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reference_has_every_key() {
        let page = include_str!("../../../../docs/input.md");
        for Keys { table, keys } in TABLES {
            for key in keys {
                assert!(page.contains(&format!("`{key}`")), "docs/input.md lacks `{key}` of {table}");
            }
        }
    }
}
