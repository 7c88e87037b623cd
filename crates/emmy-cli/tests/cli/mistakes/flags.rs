//! Flags of the command line.

use super::{BOX, Mistake, whole};

fn flag(name: &str, flags: &'static [&'static str]) -> Mistake {
    whole(name, BOX).with(flags).unseen()
}

pub(super) fn all() -> Vec<Mistake> {
    vec![
        flag("set-without-a-value", &["--set", "time.scheme"]),
        flag("set-to-nothing", &["--set", "time.scheme="]),
        flag("set-nothing", &["--set", "=DGM"]),
        flag("set-a-key-that-is-none", &["--set", "time.shceme=DGM"]),
        flag("set-in-a-section-that-is-none", &["--set", "tme.scheme=DGM"]),
        flag("set-a-scheme-that-is-none", &["--set", "time.scheme=DGX"]),
        flag("set-a-word-for-a-number", &["--set", "region.0.density=heavy"]),
        flag("set-a-number-with-a-unit", &["--set", "region.0.density=7850kg"]),
        flag("set-a-number-that-is-none", &["--set", "newton.tolerance=nan"]),
        flag("set-a-list-left-open", &["--set", "load.0.traction=[1, 2"]),
        flag("set-a-text-and-a-line-after-it", &["--set", "title=\"a\" # c\nx=1"]),
        flag("set-a-list-that-is-too-short", &["--set", "load.0.traction=[1, 2]"]),
        flag("set-an-item-that-is-not-there", &["--set", "load.1.traction=[1, 2, 3]"]),
        flag("set-a-list-without-a-number", &["--set", "time.steps.size=0.1"]),
        flag("set-an-item-of-one-table", &["--set", "initial.0.velocity=[1, 0, 0]"]),
        flag("set-inside-a-text", &["--set", "title.text=box"]),
        flag("set-with-spaces-in-the-key", &["--set", "time scheme=DGM"]),
        flag("set-twice-and-the-second-is-wrong", &["--set", "time.degree=1", "--set", "time.degree=none"]),
        flag("set-a-parameter-without-effect", &["--set", "parameters.E=5"]),
        flag("dt-of-several-phases", &["--dt", "0.1"]),
        flag(
            "dt-of-adaptive-steps",
            &[
                "--set",
                "time.steps=",
                "--set",
                "time.adaptive.tolerance=1e-4",
                "--set",
                "time.until=1",
                "--dt",
                "0.1",
            ],
        ),
        flag("dt-that-is-none", &["--set", "time.steps=[{ until = 1, size = 1 }]", "--dt", "-0.1"]),
        flag("degree-flag-too-high", &["--degree", "9"]),
        flag("until-before-the-start", &["--until", "-1"]),
        flag("until-the-start", &["--until", "0"]),
        flag("until-never", &["--until", "inf"]),
        flag("until-a-word", &["--until", "end"]),
        flag("no-threads", &["--threads", "0"]),
        flag("flag-misspelt", &["--ouput", "other"]),
        flag("output-that-is-a-file", &["--output", "box.toml"]),
        flag("set-an-item-of-a-list-of-one", &["--set", "load.1.traction=[1,2,3]"]),
        flag("set-two-components", &["--set", "load.0.traction=[1,2]"]),
        flag("set-a-list-that-ends-in-a-comma", &["--set", "load.0.traction=[1,2,"]),
        flag("set-without-an-equals-sign", &["--set", "title"]),
        flag("set-a-number-inside-a-text", &["--set", "title.x=1"]),
        flag("until-a-number-that-is-none", &["--until", "nan"]),
        flag("modes-more-than-degrees-of-freedom", &["--count", "25"]).of("modes"),
        flag("modes-none", &["--count", "0"]).of("modes"),
        flag("modes-in-a-file", &["--output", "./box.toml"]).of("modes"),
    ]
}
