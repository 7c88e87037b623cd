//! Material models.

use emmy::material::Volumetric;
use serde_json::{Value, json};

use super::super::keys::{self, Keys};
use super::kinds::{Table, exactly, list, number, positive, vector, words};

/// `material`: exactly one model.
pub(super) fn material() -> Value {
    let elastic = |what: &str| pair(what);
    let table = Table::new(keys::MATERIAL, "Material: exactly one model with its parameters")
        .may("saint-venant-kirchhoff", elastic("St. Venant-Kirchhoff: large rotation, small strain"))
        .may("neo-hooke", elastic("Compressible neo-Hooke: large strain"))
        .may("ciarlet-geymonat", elastic("Ciarlet-Geymonat: large strain, strong compression too"))
        .may("hencky", elastic("Hencky: metals and polymers, stretches from 0.7 to 1.3"))
        .may("mooney-rivlin", mooney_rivlin())
        .may("yeoh", yeoh())
        .may("gent", gent())
        .may("arruda-boyce", arruda_boyce())
        .may("ogden", ogden())
        .may("orthotropic", orthotropic())
        .may("holzapfel-gasser-ogden", holzapfel_gasser_ogden())
        .may("bar", bar())
        .may("spring", spring())
        .may("attraction", attraction());
    table.rule("minProperties", json!(1)).rule("maxProperties", json!(1)).schema()
}

fn pair(what: &str) -> Value {
    Table::new(keys::PARAMETERS, what)
        .may("lambda", number("First Lamé parameter [stress], above -2/3 mu"))
        .may("mu", positive("Shear modulus [stress]"))
        .may("youngs_modulus", positive("Young's modulus E [stress]"))
        .may("poissons_ratio", poissons_ratio())
        .one_of(&[&["lambda", "mu"], &["youngs_modulus", "poissons_ratio"]])
        .rule("maxProperties", json!(2))
        .schema()
}

fn poissons_ratio() -> Value {
    json!({
        "description": "Poisson's ratio nu, between -1 and 0.5",
        "type": "number",
        "exclusiveMinimum": -1,
        "exclusiveMaximum": 0.5,
    })
}

/// A model with a bulk modulus and a law of volume.
fn with_volume(keys: Keys, what: &str) -> Table {
    let law = "Law of volume W_vol(J)";
    Table::new(keys, what)
        .must("bulk_modulus", positive("Bulk modulus K [stress]"))
        .may("volumetric", words(&Volumetric::ALL.map(Volumetric::name), law))
}

fn mooney_rivlin() -> Value {
    with_volume(keys::MOONEY_RIVLIN, "Mooney-Rivlin: rubber, moderate strain")
        .must("c10", number("Modulus [stress]; mu = 2 (c10 + c01)"))
        .must("c01", number("Modulus [stress]"))
        .schema()
}

fn yeoh() -> Value {
    with_volume(keys::YEOH, "Yeoh: filled rubber")
        .must("c10", positive("Modulus [stress]; mu = 2 c10"))
        .must("c20", number("Modulus [stress]"))
        .must("c30", number("Modulus [stress]"))
        .schema()
}

fn gent() -> Value {
    with_volume(keys::GENT, "Gent: rubber with a limit of its stretch")
        .must("mu", positive("Shear modulus [stress]"))
        .must("jm", positive("Limit of the first invariant less 3"))
        .schema()
}

fn arruda_boyce() -> Value {
    let locking = "Locking stretch of a chain, above 1";
    with_volume(keys::ARRUDA_BOYCE, "Arruda-Boyce: rubber, eight chains")
        .must("mu", positive("Shear modulus at small strain [stress]"))
        .must("lambda_m", json!({ "description": locking, "type": "number", "exclusiveMinimum": 1 }))
        .schema()
}

fn ogden() -> Value {
    let numbers = |what: &str| list(1, json!({ "type": "number" }), what);
    with_volume(keys::OGDEN, "Ogden: rubber, any strain")
        .must("mu", numbers("Moduli, one a term [stress]"))
        .must("alpha", numbers("Exponents, one a term, not 0"))
        .schema()
}

fn orthotropic() -> Value {
    let mut table =
        Table::new(keys::ORTHOTROPIC, "Orthotropic: wood, plies, bone; large rotation, small strain");
    for key in ["youngs_modulus_1", "youngs_modulus_2", "youngs_modulus_3"] {
        table = table.must(key, positive("Young's modulus along an axis of the material [stress]"));
    }
    for key in ["poissons_ratio_12", "poissons_ratio_23", "poissons_ratio_13"] {
        let what =
            "Contraction along the second axis over extension along the first, under tension along the first";
        table = table.must(key, number(what));
    }
    for key in ["mu_12", "mu_23", "mu_13"] {
        table = table.must(key, positive("Shear modulus in a plane of two axes [stress]"));
    }
    table
        .may("axis_1", vector("Direction of axis 1, of any length"))
        .may("axis_2", vector("A direction in the plane of axes 1 and 2, on the side of axis 2"))
        .schema()
}

fn holzapfel_gasser_ogden() -> Value {
    let dispersion = "Dispersion of the fibres: 0 parallel, 1/3 in all directions alike";
    let direction = exactly(3, json!({ "type": "number" }), "Direction of a family of fibres, of any length");
    with_volume(keys::HOLZAPFEL_GASSER_OGDEN, "Holzapfel-Gasser-Ogden: soft tissue with fibres")
        .must("mu", positive("Shear modulus of the matrix [stress]"))
        .must("k1", positive("Stiffness of the fibres [stress]"))
        .must("k2", positive("How fast the fibres stiffen"))
        .may("kappa", json!({ "description": dispersion, "type": "number", "minimum": 0, "maximum": 0.3333333333333334 }))
        .must("fibres", list(1, direction, "Directions of the families of fibres, such as [[1, 0, 0]]"))
        .schema()
}

fn bar() -> Value {
    Table::new(keys::BAR, "Bar: links with mass, for trusses and cables under tension")
        .must("youngs_modulus", positive("Young's modulus E [stress]"))
        .must("area", positive("Cross section A [length²]"))
        .schema()
}

fn spring() -> Value {
    let rest = "Length without force [length]; left out: the reference length of each link";
    Table::new(keys::SPRING, "Spring: links without mass")
        .must("stiffness", positive("Stiffness k [force/length]"))
        .may("rest_length", json!({ "description": rest, "type": "number", "minimum": 0 }))
        .schema()
}

fn attraction() -> Value {
    let what = "Strength g of the potential -g/distance [energy·length]; negative: repulsion";
    Table::new(keys::ATTRACTION, "Attraction: links without mass, such as gravitation")
        .must("strength", json!({ "description": what, "type": "number", "not": { "const": 0 } }))
        .schema()
}
