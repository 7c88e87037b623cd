//! Formulations of cells: what `check` says of them, and their results.

use super::{BOX, Place};

/// Lines of `emmy check` under a word.
fn lines(input: &str, word: &str) -> Vec<String> {
    let report = Place::with(input).succeed(&["check", "box.toml"]).stdout;
    let own = report.lines().filter_map(|line| line.strip_prefix(&format!("{word:<11}")));
    own.map(str::to_string).collect()
}

/// [`BOX`] with a material, further keys of its region, and a number of cells along its edges.
fn region(material: &str, keys: &str, cells: &str) -> String {
    let input = BOX.replace("neo-hooke = { lambda = 1000.0, mu = 500.0 }", &format!("{material}\n{keys}"));
    input.replace("cells = [1, 2, 1]", &format!("cells = {cells}"))
}

const RUBBER: &str = "neo-hooke-isochoric = { mu = 1.0, bulk_modulus = 5000.0 }";
const STEEL: &str = "neo-hooke = { youngs_modulus = 1e3, poissons_ratio = 0.3 }";
const MODES: &str = "formulation = 'incompatible-modes'";
const PROJECTED: &str = "formulation = 'projected-volume'";

#[test]
fn check_says_what_the_cells_of_a_region_took() {
    assert!(lines(BOX, "cells").is_empty());
    for (keys, expected) in [
        (PROJECTED, "body: projected-volume, 128 hex8 (constant pressure)"),
        (
            "formulation = 'projected-volume'\npressure = 'constant'",
            "body: projected-volume, 128 hex8 (constant pressure)",
        ),
        (MODES, "body: incompatible-modes, 128 hex8"),
    ] {
        assert_eq!(lines(&region(RUBBER, keys, "[4, 8, 4]"), "cells"), [expected]);
    }
}

/// nu = (3 K - 2 mu)/(2 (3 K + mu)): 0.4999 for K = 5000 mu.
#[test]
fn check_advises_where_rubber_meets_the_standard_formulation() {
    assert_eq!(
        lines(&region(RUBBER, "", "[4, 8, 4]"), "advice"),
        [
            "region `body`: Poisson's ratio 0.4999, bulk over shear modulus 5000: cells with the standard formulation lock, \
              that is, are too stiff; give hex8 formulation = \"projected-volume\""
        ]
    );
    let steel = |poissons_ratio: &str| region(&STEEL.replace("0.3", poissons_ratio), "", "[4, 8, 4]");
    assert_eq!(lines(&steel("0.4501"), "advice").len(), 1);
    assert!(lines(&steel("0.4499"), "advice").is_empty());
    assert!(lines(&region(RUBBER, PROJECTED, "[4, 8, 4]"), "advice").is_empty());
}

#[test]
fn check_advises_where_linear_hexahedra_are_few_over_a_thickness() {
    let thin = |material, keys| lines(&region(material, keys, "[3, 8, 4]"), "advice");
    let advice = &thin(STEEL, "")[..];
    let [advice] = advice else { panic!("{advice:?}") };
    assert!(advice.contains("about 3 cells (hex8) over its thickness along x"), "{advice}");
    assert!(advice.contains("formulation = \"incompatible-modes\""), "{advice}");
    let rubber = thin(RUBBER, "");
    assert!(
        rubber.len() == 2
            && rubber[1]
                .ends_with("take hex27 or hex20 (quad9 in a plane) with formulation = \"projected-volume\""),
        "{rubber:?}"
    );
    assert!(thin(RUBBER, PROJECTED)[0].contains("take hex27 or hex20"));
    assert!(lines(&region(STEEL, "", "[4, 8, 4]"), "advice").is_empty());
}

/// Tetrahedra of four nodes lock in any formulation.
#[test]
fn check_sends_tet4_to_tet10() {
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../emmy-io/tests/meshes/tet4-41-ascii.msh");
    let advice = |material| {
        let input = format!(
            "mesh.file = '{mesh}'\nregion = {{ density = 1.0, material.{material} }}\n\
             time = {{ scheme = 'DGM', degree = 1, steps = [{{ until = 1.0, size = 0.1 }}] }}\n"
        );
        lines(&input, "advice")
    };
    let steel = advice(STEEL);
    assert_eq!(steel.len(), 1);
    assert!(steel[0].ends_with("no formulation helps; mesh with tet10"), "{steel:?}");
    let advice = advice(RUBBER);
    assert_eq!(advice.len(), 1);
    assert!(
        advice[0].contains("the volume of tet4 is constant in a cell, so it locks in any case; use tet10")
    );
    assert!(!advice[0].contains("projected-volume"), "{advice:?}");
}

/// A parallelepiped with edges at 45 degrees: its scaled Jacobian is sin 45 = 0.707107.
#[test]
fn check_names_the_limits_of_incompatible_modes() {
    let advice = lines(&region(STEEL, MODES, "[4, 8, 4]"), "advice");
    assert_eq!(advice.len(), 1);
    assert!(advice[0].contains("compressed below about 0.68"), "{advice:?}");
    let rubber = lines(&region(RUBBER, MODES, "[4, 8, 4]"), "advice");
    assert!(rubber.len() == 2 && rubber[0].contains("lock in volume near clamps; take hex27"), "{rubber:?}");
    let mut mesh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n".to_string();
    for (node, [x, y, z]) in
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 1], [2, 0, 1], [2, 1, 1], [1, 1, 1]]
            .iter()
            .enumerate()
    {
        mesh += &format!("{} {x} {y} {z}\n", node + 1);
    }
    mesh += "$EndNodes\n$Elements\n1\n1 5 2 1 1 1 2 3 4 5 6 7 8\n$EndElements\n";
    let place = Place::with(&format!(
        "mesh.file = 'skewed.msh'\nregion = {{ density = 1.0, material.{STEEL}, {MODES} }}\n\
         time = {{ scheme = 'DGM', degree = 1, steps = [{{ until = 1.0, size = 0.1 }}] }}\n"
    ));
    place.write("skewed.msh", &mesh);
    let report = place.succeed(&["check", "box.toml"]).stdout;
    assert!(report.contains("cell 0 is skewed (scaled Jacobian 0.707107)"), "{report}");
}

#[test]
fn the_list_of_elements_has_their_formulations() {
    let list = Place::new().succeed(&["list", "elements"]).stdout;
    for line in [
        "hex8       trilinear hexahedron, 8 nodes; constant pressure, incompatible modes",
        "hex27      triquadratic hexahedron, 27 nodes; linear pressure",
        "quad9      biquadratic quadrilateral in plane strain, 9 nodes; linear or constant pressure",
        "tet4       linear tetrahedron, 4 nodes",
    ] {
        assert!(list.lines().any(|own| own == line), "{line}\n{list}");
    }
}
