//! Groups, probes and directories.

use super::{Mistake, PROBES, changed};

/// The beginning of [`BOX`](super::BOX), with units.
fn with_units(name: &str, units: &str) -> Mistake {
    changed(name, "title = \"box\"", &format!("title = \"box\"\n{units}"))
}

const SECOND: &str = "density = 1.0\nmaterial.neo-hooke = { lambda = 1.0, mu = 1.0 }\n\n[[load]]";

/// A list with one value.
fn value(group: &str, quantity: &str, measure: &str) -> String {
    format!("values = [{{ name = \"a\", {group}, quantity = \"{quantity}\", measure = \"{measure}\" }}]")
}

pub(super) fn all() -> Vec<Mistake> {
    vec![
        with_units("units-misspelt", "units.system = \"mm-t-z\""),
        with_units("units-that-are-not-consistent", "units.system = \"inch-lb-s\""),
        with_units("units-in-another-order", "units.system = \"kg-m-s\""),
        with_units("units-with-another-force", "units.system = \"mm-t-s-kN-MPa\""),
        with_units("units-with-another-stress", "units.system = \"mm-kg-ms-kN-MPa\""),
        with_units("units-without-a-table", "units = \"mm-t-s\""),
        with_units("units-without-a-system", "units = {}"),
        with_units("units-by-quantity", "units = { length = \"mm\" }"),
        with_units("units-by-number", "units.system = 3"),
        changed("group-misspelt", "y-max", "y-mx").unseen(),
        changed("group-in-capitals", "\"body\"", "\"Body\"").unseen(),
        changed("group-that-is-nowhere", "y-min", "clamp").unseen(),
        changed("group-of-cells-for-facets", "y-max", "body").unseen(),
        changed("group-of-facets-for-cells", "\"body\"", "\"y-max\"").unseen(),
        changed("group-by-number", "group = \"y-max\"", "group = 3"),
        changed("group-without-a-name", "group = \"y-max\"", "group = \"\""),
        changed("group-missing-of-a-load", "group = \"y-max\"\n", ""),
        changed("group-missing-of-a-support", "group = \"y-min\"\n", ""),
        changed("two-regions-of-one-group", "[[load]]", &format!("[[region]]\ngroup = \"body\"\n{SECOND}"))
            .unseen(),
        changed("two-regions-without-a-group", "[[load]]", &format!("[[region]]\n{SECOND}")).unseen(),
        changed("initial-velocity-of-nothing", "[initial]", "[initial]\ngroup = \"tip\"").unseen(),
        changed(
            "probes-of-one-name",
            PROBES,
            "probes = [{ name = \"a\", point = [0, 0, 0] }, { name = \"a\", point = [0, 2, 0] }]",
        )
        .unseen(),
        changed("probe-with-a-comma", PROBES, "probes = [{ name = \"a,b\", point = [0, 0, 0] }]"),
        changed(
            "probe-with-a-name-that-is-taken",
            PROBES,
            "probes = [{ name = \"angular_momentum\", point = [0, 0, 0] }]",
        ),
        changed("reactions-of-a-free-group", "every = 2", "every = 2\nreactions = [\"y-max\"]").unseen(),
        changed("reactions-of-a-group-misspelt", "every = 2", "every = 2\nreactions = [\"y-mni\"]").unseen(),
        changed("reactions-twice", "every = 2", "every = 2\nreactions = [\"y-min\", \"y-min\"]"),
        changed("reactions-not-in-a-list", "every = 2", "every = 2\nreactions = \"y-min\""),
        changed("extreme-of-a-tensor", "every = 2", "every = 2\nextremes = [\"cauchy_stress\"]"),
        changed("extreme-misspelt", "every = 2", "every = 2\nextremes = [\"von_mises\"]"),
        changed("extreme-of-another-body", "every = 2", "every = 2\nextremes = [\"axial_force\"]").unseen(),
        changed(
            "probe-of-an-unknown-quantity",
            "point = [0, 2, 0] }",
            "point = [0, 2, 0], quantities = [\"stress\"] }",
        ),
        changed("probe-without-quantities", "point = [0, 2, 0] }", "point = [0, 2, 0], quantities = [] }")
            .unseen(),
        changed(
            "probe-named-like-a-reaction",
            PROBES,
            "probes = [{ name = \"y-min_force\", point = [0, 0, 0] }]",
        )
        .unseen(),
        changed("value-of-an-unknown-group", PROBES, &value("group = \"steel\"", "velocity", "mean"))
            .unseen(),
        changed("value-total-at-nodes", PROBES, &value("group = \"y-max\"", "velocity", "total")).unseen(),
        changed(
            "value-of-cells-in-a-group-of-facets",
            PROBES,
            &value("group = \"y-max\"", "cell_strain_energy_density", "mean"),
        )
        .unseen(),
        changed("value-largest-of-a-tensor", PROBES, &value("group = \"body\"", "cauchy_stress", "max"))
            .unseen(),
        changed("value-of-an-unknown-measure", PROBES, &value("group = \"body\"", "velocity", "sum")),
        changed(
            "values-of-one-name",
            PROBES,
            "values = [{ name = \"a\", quantity = \"velocity\" }, { name = \"a\", quantity = \"velocity\" }]",
        )
        .unseen(),
        changed("probe-in-the-plane", "point = [0, 2, 0]", "point = [0, 2]"),
        changed("format-of-another-program", "every = 2", "every = 2\nformat = \"xdmf\""),
        changed("precision-of-another-language", "every = 2", "every = 2\nprecision = \"float32\""),
        changed("field-misspelt", "every = 2", "every = 2\nfields = [\"displacement\", \"von_mises\"]"),
        changed("field-twice", "every = 2", "every = 2\nfields = [\"velocity\", \"velocity\"]"),
        changed("fields-not-in-a-list", "every = 2", "every = 2\nfields = \"velocity\""),
        changed("directory-without-a-name", "directory = \"out\"", "directory = \" \""),
        changed("directory-that-is-a-file", "\"out\"", "\"notes.txt\"").beside("notes.txt", "mine").unseen(),
        changed("directory-below-a-file", "\"out\"", "\"notes.txt/out\"")
            .beside("notes.txt", "mine")
            .unseen(),
        changed("directory-of-somebody-else", "\"out\"", "\".\"").beside("notes.txt", "mine").unseen(),
        changed("group-of-nodes-misspelt", "group = \"y-max\"\ntraction", "group = \"y-mx\"\nnodal_force")
            .unseen(),
        changed("group-of-a-support-that-is-nowhere", "y-min", "floor").unseen(),
        changed("group-of-a-region-misspelt", "\"body\"", "\"bdy\"").unseen(),
        changed("group-of-the-initial-state-that-is-nowhere", "velocity = [0, 0, 0]", "group = \"tip\"")
            .unseen(),
        changed(
            "first-of-two-regions-without-a-group",
            "[[load]]",
            &format!("[[region]]\ngroup = \"body\"\n{SECOND}"),
        )
        .and("group = \"body\"\n", "")
        .unseen(),
        changed(
            "probe-named-like-a-column",
            PROBES,
            "probes = [{ name = \"linear_momentum\", point = [0, 0, 0] }]",
        ),
        changed("format-of-an-older-program", "every = 2", "every = 2\nformat = \"vtk\""),
        changed("precision-of-c", "every = 2", "every = 2\nprecision = \"float\""),
        changed("field-misspelt-by-a-letter", "every = 2", "every = 2\nfields = [\"cauchy_stres\"]"),
        changed("directory-of-an-empty-name", "directory = \"out\"", "directory = \"\""),
    ]
}
