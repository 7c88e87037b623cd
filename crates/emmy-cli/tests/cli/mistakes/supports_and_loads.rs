//! Supports and loads.

use super::{FIX, HISTORY, MESH, Mistake, TRACTION, changed};

pub(super) fn all() -> Vec<Mistake> {
    [loads(), histories(), measurements(), supports(), motions(), ties(), contacts()]
        .into_iter()
        .flatten()
        .collect()
}

fn load(name: &str, to: &str) -> Mistake {
    changed(name, TRACTION, to)
}

/// A tie beside the support.
fn tie(name: &str, keys: &str) -> Mistake {
    changed(name, "[[support]]", &format!("[[tie]]\n{keys}\n\n[[support]]"))
}

fn ties() -> Vec<Mistake> {
    let groups = "follower = \"y-max\"\nleader = \"x-min\"";
    vec![
        tie("tie-of-an-unknown-kind", &format!("{groups}\nkind = \"node\"")),
        tie("tie-below-nothing", &format!("{groups}\nkind = \"nodes\"\ntolerance = -0.1")),
        tie("tie-in-other-words", "slave = \"y-max\"\nmaster = \"x-min\"\nkind = \"nodes\""),
        tie("tie-to-itself", "follower = \"y-max\"\nleader = \"y-max\"\nkind = \"nodes\"").unseen(),
        tie("tie-of-groups-misspelt", "follower = \"y-mx\"\nleader = \"x-mn\"\nkind = \"nodes\"").unseen(),
        tie("tie-from-afar", "follower = \"y-max\"\nleader = \"y-min\"\nkind = \"nodes\"").unseen(),
        tie(
            "tie-of-groups-with-an-edge-in-common",
            "follower = \"y-min\"\nleader = \"x-min\"\nkind = \"nodes\"\ntolerance = 9",
        )
        .unseen(),
        changed("tie-misspelt", "[[support]]", "[[ties]]\nfollower = \"y-max\"\n\n[[support]]"),
    ]
}

/// A contact beside the support.
fn contact(name: &str, keys: &str) -> Mistake {
    changed(name, "[[support]]", &format!("[[contact]]\n{keys}\n\n[[support]]"))
}

fn contacts() -> Vec<Mistake> {
    let below = "obstacle.plane = { point = [0, -1, 0], normal = [0, 1, 0] }";
    vec![
        contact("contact-with-friction", &format!("surfaces = \"y-max\"\n{below}\nfriction = 0.3")),
        contact(
            "contact-with-an-obstacle-that-jumps",
            "surfaces = \"y-max\"\nobstacle = { plane = { point = [0, -1, 0], normal = [0, 1, 0] }, move = { y = \"0.1 + t\" } }",
        )
        .unseen(),
        contact("contact-of-two-surfaces", "surfaces = [\"y-max\", \"x-min\"]").unseen(),
        contact("contact-of-a-surface-with-itself", "surfaces = [\"y-max\", \"y-max\"]").unseen(),
        contact("contact-of-all-with-a-surface", "surfaces = [\"y-max\", \"all\"]").unseen(),
        contact(
            "contact-of-two-surfaces-with-an-obstacle",
            &format!("surfaces = [\"y-max\", \"x-min\"]\n{below}"),
        )
        .unseen(),
        contact("contact-without-an-obstacle", "surfaces = \"y-max\"").unseen(),
        contact(
            "contact-with-two-obstacles",
            "surfaces = \"y-max\"\nobstacle.sphere = { centre = [0, 5, 0], radius = 1 }\n\
             obstacle.plane = { point = [0, -1, 0], normal = [0, 1, 0] }",
        ),
        contact("contact-of-a-negative-distance", &format!("surfaces = \"all\"\n{below}\ndistance = -0.1")),
        contact("contact-of-a-group-misspelt", &format!("surfaces = \"y-mx\"\n{below}")).unseen(),
        contact(
            "contact-inside-the-obstacle",
            "surfaces = \"all\"\nobstacle.plane = { point = [0, 1, 0], normal = [0, 1, 0] }",
        )
        .unseen(),
        contact(
            "contact-without-a-normal",
            "surfaces = \"all\"\nobstacle.plane = { point = [0, -1, 0], normal = [0, 0, 0] }",
        )
        .unseen(),
        contact(
            "contact-on-the-wrong-side",
            "surfaces = \"y-max\"\nobstacle.plane = { point = [0, -1, 0], normal = [0, -2, 0] }",
        )
        .unseen(),
        contact(
            "contact-inside-a-ball",
            "surfaces = \"all\"\nobstacle.sphere = { centre = [0, 0, 0], radius = 9 }",
        )
        .unseen(),
        contact(
            "contact-outside-of-a-tube",
            "surfaces = \"all\"\n[contact.obstacle.cylinder]\npoint = [9, 0, 0]\naxis = [0, 1, 0]\nradius = 1\n\
             inside = true",
        )
        .unseen(),
        contact(
            "contact-without-a-gap",
            "surfaces = \"all\"\nobstacle.plane = { point = [0, 0, 0], normal = [0, 1, 0] }",
        )
        .unseen(),
        contact("contact-of-one-name-in-brackets", &format!("surfaces = [\"y-max\"]\n{below}")),
        contact(
            "contacts-of-one-name",
            &format!(
                "surfaces = \"y-max\"\nname = \"floor\"\n{below}\n\n[[contact]]\nsurfaces = \"x-min\"\n\
                 name = \"floor\"\n{below}"
            ),
        )
        .unseen(),
        contact("contact-named-as-a-support", &format!("surfaces = \"all\"\nname = \"y-min\"\n{below}"))
            .unseen(),
    ]
}

fn history(name: &str, history: &str) -> Mistake {
    changed(name, HISTORY, &format!("history = {history}"))
}

/// A body force on all cells in place of the traction.
fn body_force(name: &str, force: &str) -> Mistake {
    changed(name, &format!("group = \"y-max\"\n{TRACTION}"), &format!("body_force = {force}"))
}

/// An observer that turns, in place of the traction.
fn rotation(name: &str, rotation: &str) -> Mistake {
    changed(name, &format!("group = \"y-max\"\n{TRACTION}\n{HISTORY}"), &format!("rotation = {rotation}"))
}

fn support(name: &str, to: &str) -> Mistake {
    changed(name, FIX, to)
}

fn loads() -> Vec<Mistake> {
    vec![
        load("two-kinds-of-load", "force = [1, 0, 0]\ntraction = [0, 0, 10]"),
        load("traction-and-force", "traction = [0, 0, 1]\nforce = [0, 0, 1]"),
        load("pressure-and-traction", "pressure = 10\ntraction = [0, 0, 1]"),
        load("pressure-misspelt", "presure = 10"),
        load("load-by-another-name", "point_force = [0, 0, 10]"),
        changed("no-kind-of-load", &format!("{TRACTION}\n"), ""),
        load("attraction-with-a-history", "attraction = { centre = [0, 9, 0], strength = 1 }").unseen(),
        changed(
            "attraction-without-strength",
            &format!("{TRACTION}\n{HISTORY}"),
            "attraction = { centre = [0, 9, 0], strength = 0 }",
        ),
        changed(
            "attraction-without-a-centre",
            &format!("{TRACTION}\n{HISTORY}"),
            "attraction = { strength = 1 }",
        ),
        body_force("body-force-of-two-components", "[0, 0]"),
        body_force("body-force-of-one-expression", "\"x\""),
        body_force("body-force-of-an-unknown-variable", "[0, 0, \"r*t\"]").unseen(),
        body_force("body-force-with-a-kink", "[0, 0, \"abs(x)\"]").unseen(),
        body_force("body-force-with-half-an-expression", "[0, 0, \"x +\"]").unseen(),
        body_force("body-force-with-a-pole", "[0, 0, \"x/(t - 0.25)\"]").unseen(),
        body_force("body-force-with-a-pole-at-the-end", "[0, 0, \"x*tan(pi*t)\"]").unseen(),
        body_force("body-force-that-is-undefined-somewhere", "[\"ln(y - 1)\", 0, 0]").unseen(),
        load("body-force-on-facets", "body_force = [0, 0, \"x\"]").unseen(),
        load("rotation-of-a-group", "rotation = { axis = [0, 0, 1], speed = 2 }").unseen(),
        rotation("rotation-in-a-motion", "{ axis = [0, 0, 1], speed = 2 }").unseen(),
        rotation("rotation-of-two-observers", "{ axis = [0, 0, 1], speed = 2 }")
            .and("[[load]]", "[[load]]\nrotation = { axis = [1, 0, 0], speed = 3 }\n\n[[load]]")
            .unseen(),
        rotation("rotation-with-a-misspelt-key", "{ axes = [0, 0, 1], speed = 2 }"),
        rotation("rotation-by-another-name", "{ axis = [0, 0, 1], omega = 2 }"),
        rotation("rotation-about-nothing", "{ axis = [0, 0, 0], speed = 2 }").unseen(),
        rotation("rotation-about-a-number", "{ axis = 3, speed = 2 }"),
        rotation("rotation-without-a-speed", "{ axis = [0, 0, 1] }"),
        rotation("rotation-at-no-speed", "{ axis = [0, 0, 1], speed = 0 }"),
        load("drag-on-a-group", "drag = 0.5").unseen(),
        changed("drag-that-pushes", &format!("group = \"y-max\"\n{TRACTION}\n{HISTORY}"), "drag = -0.5"),
    ]
}

fn histories() -> Vec<Mistake> {
    vec![
        history("history-that-goes-back", "[[0.5, 0.0], [0.0, 1.0]]").unseen(),
        history("history-without-entries", "[]"),
        history("history-of-an-unknown-function", "\"2*sine(t)\"").unseen(),
        history("history-of-an-unknown-function-after-spaces", "\"2 * sine(t)\"").unseen(),
        history("history-of-an-unknown-variable", "\"2*x\"").unseen(),
        history("history-with-an-open-bracket", "\"sin(2*pi*t\"").unseen(),
        history("history-of-a-function-left-open", "\"sin(t\"").unseen(),
        history("history-as-in-python", "\"t**2\"").unseen(),
        history("history-with-a-product-left-out", "\"2 pi t\"").unseen(),
        history("history-with-a-kink", "\"min(t, 1)\"").unseen(),
        history("history-with-a-ramp", "'max(t, 1)'").unseen(),
        history("history-with-a-pole", "\"1/(t - 0.25)\"").unseen(),
        history("history-with-a-pole-at-the-end", "\"tan(pi*t)\"").unseen(),
        history("history-with-an-infinite-rate", "\"sqrt(t)\"").unseen(),
    ]
}

/// A history from a file of this content.
fn measured(name: &str, text: impl Into<Vec<u8>>) -> Mistake {
    history(name, "{ file = \"pulse.csv\", time = \"t\", value = \"force\" }")
        .beside("pulse.csv", text)
        .unseen()
}

fn measurements() -> Vec<Mistake> {
    let rows = "t,force\n0,0\n1,1\n";
    let of = |name: &str, text: &str| history(name, text).beside("pulse.csv", rows);
    let base =
        |name: &str, text: &str| support(name, &format!("accelerate = {text}")).beside("pulse.csv", rows);
    vec![
        of("measured-without-a-column", "{ file = \"pulse.csv\", time = \"t\" }"),
        of("measured-with-a-key-misspelt", "{ file = \"pulse.csv\", time = \"t\", values = \"force\" }"),
        of(
            "measured-with-a-factor-as-text",
            "{ file = \"pulse.csv\", time = \"t\", value = \"force\", factor = \"2\" }",
        ),
        of("measured-by-a-number", "7"),
        of(
            "measured-in-a-column-that-is-not-there",
            "{ file = \"pulse.csv\", time = \"t\", value = \"forse\" }",
        )
        .unseen(),
        of("measured-in-a-file-misspelt", "{ file = \"puls.csv\", time = \"t\", value = \"force\" }")
            .unseen(),
        of(
            "measured-in-a-file-that-is-not-there",
            "{ file = \"other.dat\", time = \"t\", value = \"force\" }",
        )
        .unseen(),
        of("measured-in-a-folder", "{ file = \".\", time = \"t\", value = \"force\" }").unseen(),
        measured("measured-words", "t,force\n0,0\n0.1,off\n"),
        measured("measured-unsorted", "t,force\n0,0\n0.2,1\n0.1,2\n"),
        measured("measured-once", "t,force\n0,0\n"),
        measured("measured-infinities", "t,force\n0,0\n0.1,inf\n"),
        measured("measured-with-decimal-commas", "t;force\n0;0\n0,1;0,5\n"),
        measured("measured-with-commas-everywhere", "t,force\n0,0,0,0\n0,1,0,5\n"),
        measured("measured-without-names-of-columns", "0,0\n0.1,1\n"),
        measured("measured-with-a-gap", "t,force\n0,0\n0.1\n"),
        measured("measured-in-nothing", ""),
        measured("measured-in-utf-16", b"\xff\xfet\0,\0f\0"),
        measured("measured-in-a-spreadsheet", b"PK\x03\x04\x14\0\x06\0"),
        base("accelerated-by-a-number", "{ x = 9.81 }"),
        base("accelerated-by-nothing", "{}"),
        base("accelerated-along-no-component", "{ u = \"t\" }"),
        base("accelerated-and-moved", "{ x = \"t\" }\nmove = { x = \"t\" }").unseen(),
        base("accelerated-and-fixed", "{ x = \"t\" }\nfix = [\"x\"]").unseen(),
        base("accelerated-by-a-pole", "{ x = \"1/(t - 0.25)\" }").unseen(),
        base("accelerated-by-a-pole-at-the-end", "{ x = \"tan(pi*t)\" }").unseen(),
        base("accelerated-without-end", "{ x = [[0, 1e308], [1, 1e308]] }")
            .and("until = 0.5", "until = 1e10")
            .unseen(),
        base(
            "accelerated-by-a-file-that-is-not-there",
            "{ y = { file = \"quake.csv\", time = \"t\", value = \"ay\" } }",
        )
        .unseen(),
        support("accelerate-misspelt", "acceleration = { x = \"t\" }"),
    ]
}

fn supports() -> Vec<Mistake> {
    let second = "[[support]]\ngroup = \"x-min\"\nfix = [\"x\"]\n\n[initial]";
    vec![
        changed("support-without-a-kind", &format!("{FIX}\n"), ""),
        support("component-that-is-none", "fix = [\"x\", \"w\"]"),
        support("components-by-number", "fix = [1, 2, 3]"),
        support("components-as-flags", "fix = [true, true, false]"),
        support("nothing-fixed", "fix = []"),
        support("fix-by-another-name", "fixed = [\"x\"]"),
        support("fixed-until-the-start", "fix = [\"x\"]\nuntil = 0.0"),
        support("until-misspelt", "fix = [\"x\"]\nuntill = 1.0"),
        support("fixed-and-moved", "fix = [\"x\"]\nmove = { x = \"t\" }").unseen(),
        support("fixed-here-and-moved-there", "move = { x = \"t\" }").and("[initial]", second).unseen(),
        support("spring-that-is-released", "spring = 1.0\nuntil = 0.2").unseen(),
        support("spring-that-is-released-after-the-end", "spring = 1.0\nuntil = 1.0").unseen(),
        support("symmetry-of-a-body", "symmetry = true").with(&["--set", "support.0.group=body"]).unseen(),
        support("no-symmetry", "symmetry = false"),
        support("symmetry-misspelt", "symetry = true"),
    ]
}

/// Driven supports.
fn motions() -> Vec<Mistake> {
    let plane = "rectangle = { size = [1, 2], cells = [1, 2] }";
    vec![
        support("moved-by-a-number", "move = { x = 0.1 }"),
        support("moved-by-one", "move = { x = 1.0 }"),
        support("moved-by-nothing", "move = {}"),
        support("moved-along-no-component", "move = { u = \"t\" }"),
        support("moved-by-another-name", "displacement = { x = \"t\" }"),
        support("moved-by-half-an-expression", "move = { x = \"t*\" }").unseen(),
        support("moved-by-a-jump", "move = { y = [[0, 0], [1, 0], [1, 2]] }").unseen(),
        support("moved-at-an-infinite-rate", "move = { y = \"t*ln(t)\" }").unseen(),
        support("moved-from-elsewhere", "move = { x = \"cos(t)\" }").unseen(),
        support("moved-from-one", "move = { x = \"1 + t\" }").unseen(),
        support("moved-by-a-scheme-that-cannot", "move = { x = \"t\" }").and("AS(2)", "Bathe").unseen(),
        support("fixed-and-turned", "fix = [\"x\"]\nrotate = { axis = [0, 0, 1], angle = \"t\" }").unseen(),
        support("fixed-along-y-and-turned", "fix = [\"y\"]\nrotate = { axis = [0, 0, 1], angle = \"t\" }")
            .unseen(),
        support("turned-about-no-axis", "rotate = { axis = [0, 0, 0], angle = \"t\" }").unseen(),
        support("turned-without-an-axis", "rotate = { angle = \"t\" }"),
        support("turned-by-no-angle", "rotate = { axis = [0, 0, 1] }"),
        support("turned-from-elsewhere", "rotate = { axis = [0, 0, 1], angle = \"cos(t)\" }").unseen(),
        support("turned-about-a-centre", "rotate = { axis = [0, 0, 1], center = [0, 0, 0], angle = \"t\" }"),
        support("turned-out-of-the-plane", "rotate = { axis = [0, 1, 0], angle = \"t\" }")
            .and(MESH, plane)
            .unseen(),
    ]
}
