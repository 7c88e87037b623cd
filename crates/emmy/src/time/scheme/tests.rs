//! Names, ranges and degrees of schemes.

use super::*;

#[test]
fn every_scheme_prints_as_it_parses() {
    for text in [
        "FE(1)",
        "FE(12)",
        "AS(5)",
        "DGM",
        "trapezoidal",
        "Lobatto(3)",
        "Newmark(0.25, 0.5)",
        "AS(5, 0.8)",
        "DGM(0)",
        "DGM(0.25)",
        "HHT(0.05)",
        "HHT(0)",
        "generalized-alpha(0.8)",
        "Bathe",
        "central-differences",
    ] {
        let scheme: Scheme = text.parse().unwrap();
        assert_eq!(scheme.name(), text);
        assert_eq!(scheme.to_string().parse(), Ok(scheme));
    }
    assert_eq!(
        "Newmark(.25,5e-1)".parse(),
        Ok(Scheme::Newmark(NewmarkFamily::Newmark { beta: 0.25, gamma: 0.5 }))
    );
    assert_eq!("AS(5, 0.8), degree 3".parse::<Scheme>().unwrap().to_string(), "AS(5, 0.8), degree 3");
    for text in [
        "",
        "FE",
        "FE(0)",
        "FE(-1)",
        "AS(5",
        "AS 5",
        "DG",
        "FE(1.5)",
        "FE(99999999999999999999)",
        "DGM, degree",
        "DGM, degree x",
        "DGM, degree 9",
        "AS(1), degree 2",
    ] {
        assert!(matches!(text.parse::<Scheme>(), Err(Error::Scheme { .. })), "{text}");
    }
}

#[test]
fn every_row_of_the_table_is_found_by_its_form() {
    for row in &SCHEMES {
        let text = row.form.replace("gamma", "0.5").replace("(n", "(2").replace("beta", "0.25");
        let text = ["rho", "alpha"].iter().fold(text, |text, name| match text.split_once('(') {
            Some((word, arguments)) => format!("{word}({}", arguments.replace(name, "0.3")),
            None => text,
        });
        let scheme: Scheme = text.parse().unwrap();
        assert_eq!(scheme.name().replace(' ', ""), text.replace(' ', ""));
    }
}

#[test]
fn parameters_out_of_range_are_rejected_with_the_range() {
    for (text, hint) in [
        ("Newmark(0, 0.5)", "central-differences"),
        ("Newmark(-0.25, 0.5)", "(0, 1]"),
        ("Newmark(NaN, 0.5)", "(0, 1]"),
        ("Newmark(0.25, 0.4)", "[0.5, 1]"),
        ("Newmark(0.25)", "Newmark(beta, gamma)"),
        ("Newmark", "Newmark(0.25, 0.5)"),
        ("HHT(-0.05)", "counted positive"),
        ("HHT(0.34)", "[0, 1/3]"),
        ("HHT(inf)", "[0, 1/3]"),
        ("generalized-alpha(1.01)", "[0, 1]"),
        ("DGM(1.5)", "[0, 1]"),
        ("AS(3, -0.1)", "[0, 1]"),
        ("generalized-alpha", "generalized-alpha(0.8)"),
    ] {
        let error = text.parse::<Scheme>().unwrap_err().to_string();
        assert!(error.contains(hint) && error.contains(text), "{error}");
    }
    let newmark = Scheme::Newmark(NewmarkFamily::Newmark { beta: 0.25, gamma: f64::NAN });
    assert!(newmark.check().is_err());
    for text in ["Newmark(0.25, 0.5)", "HHT(0.05)", "generalized-alpha(0.8)", "Bathe", "central-differences"]
    {
        let scheme: Scheme = text.parse().unwrap();
        assert_eq!(scheme.with_degree(1), Ok(scheme));
        assert!(scheme.with_degree(2).unwrap_err().to_string().contains("degree 1"));
    }
}

#[test]
fn rules_with_too_few_points_are_rejected() {
    for (scheme, degree) in
        [("FE(1)", 2), ("AS(2)", 3), ("trapezoidal", 2), ("Lobatto(2)", 2), ("DGM", 0), ("DGM", 9)]
    {
        let scheme: Scheme = scheme.parse().unwrap();
        assert!(scheme.with_degree(degree).is_err(), "{scheme} {degree}");
    }
    for (scheme, degree) in [("FE(2)", 2), ("AS(3)", 3), ("trapezoidal", 1), ("Lobatto(3)", 2), ("DGM", 4)] {
        scheme.parse::<Scheme>().unwrap().with_degree(degree).unwrap();
    }
}
