//! Random valid inputs: the resolved input in the directory of a run is read as the same problem.

use std::path::Path;

use emmy_io::input::{self, Overrides, Problem};
use proptest::prelude::*;

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![1e-3..1e3, Just(1.0), Just(0.1), Just(1e-17), Just(123456789.125)]
}

fn signed() -> impl Strategy<Value = f64> {
    prop_oneof![-1e3..1e3, Just(0.0), Just(-0.0), Just(1e-300)]
}

fn vector() -> impl Strategy<Value = String> {
    (signed(), signed(), signed()).prop_map(|(x, y, z)| format!("[{x:?}, {y:?}, {z:?}]"))
}

fn material() -> impl Strategy<Value = String> {
    let law = prop::sample::select(vec!["", ", volumetric = 'miehe'", ", volumetric = 'liu'"]);
    prop_oneof![
        (number(), number()).prop_map(|(a, b)| format!("neo-hooke = {{ lambda = {a:?}, mu = {b:?} }}")),
        (number(), -0.9..0.49)
            .prop_map(|(e, nu)| format!("hencky = {{ youngs_modulus = {e:?}, poissons_ratio = {nu:?} }}")),
        (number(), number(), law.clone())
            .prop_map(|(a, k, law)| format!("gent = {{ mu = {a:?}, jm = 50, bulk_modulus = {k:?}{law} }}")),
        (number(), number(), law).prop_map(|(a, k, law)| format!(
            "ogden = {{ mu = [{a:?}], alpha = [2], bulk_modulus = {k:?}{law} }}"
        )),
    ]
}

fn history() -> impl Strategy<Value = String> {
    prop_oneof![
        Just(String::new()),
        (number(), signed()).prop_map(|(t, f)| format!("history = [[0, 0], [{t:?}, {f:?}]]\n")),
        Just("history = \"sin(2*pi*t)^2\"\n".to_string()),
        Just("history = '''exp(-t)'''\n".to_string()),
    ]
}

fn load() -> impl Strategy<Value = String> {
    let kind = prop_oneof![
        vector().prop_map(|v| format!("group = 'y-max'\ntraction = {v}")),
        vector().prop_map(|v| format!("group = \"x-min\"\nforce = {v}")),
        vector().prop_map(|v| format!("group = 'body'\nnodal_force = {v}")),
        signed().prop_map(|p| format!("group = 'z-max'\npressure = {p:?}")),
        vector().prop_map(|v| format!("acceleration = {v}")),
        signed().prop_map(|b| format!("body_force = [{b:?}, 'x*sin(t) - y', \"z^2*t\"]")),
    ];
    (kind, history()).prop_map(|(kind, history)| format!("[[load]]\n{kind}\n{history}"))
}

fn support() -> impl Strategy<Value = String> {
    prop_oneof![
        Just(String::new()),
        Just("[[support]]\ngroup = 'y-min'\nfix = ['x', 'z']\nuntil = 0.375\n".to_string()),
        Just("[support]\ngroup = 'y-min'\nmove = { x = \"0.1*t\", y = [[0, 0], [1, 0.5]] }\n".to_string()),
        Just("[[support]]\ngroup = 'x-min'\nsymmetry = true\n".to_string()),
        number().prop_map(|k| format!("[[support]]\ngroup = 'body'\nspring = {k:?}\n")),
    ]
}

fn time() -> impl Strategy<Value = String> {
    let scheme = prop::sample::select(vec!["DGM", "AS(3)", "FE(2)", "Lobatto(4)"]);
    (scheme, 1..3_usize, 0.1..2.0, 0.1..2.0, 0.01..0.2).prop_map(|(scheme, degree, first, second, size)| {
        let end = first + second;
        let steps =
            format!("[{{ until = {first:?}, size = {size:?} }}, {{ until = {end:?}, size = {first:?} }}]");
        format!("[time]\nscheme = '{scheme}'\ndegree = {degree}\nsteps = {steps}\n")
    })
}

fn rest() -> impl Strategy<Value = String> {
    let initial = vector().prop_map(|v| format!("[initial]\nangular_velocity = {v}\n"));
    let newton = (1e-12..0.1).prop_map(|tolerance| format!("[newton]\ntolerance = {tolerance:?}\n"));
    let output = (0..9_usize, vector()).prop_map(|(every, point)| {
        format!("[output]\nevery = {every}\nprobes = [{{ name = \"tip-1\", point = {point} }}]\n")
    });
    let limits = number().prop_map(|limit| format!("[limits]\nenergy = {limit:?}\n"));
    let some = |part: BoxedStrategy<String>| prop_oneof![Just(String::new()), part];
    (some(initial.boxed()), some(newton.boxed()), some(output.boxed()), some(limits.boxed()))
        .prop_map(|(a, b, c, d)| [a, b, c, d].concat())
}

fn valid_input() -> impl Strategy<Value = String> {
    let title = "[a-zA-Z0-9 \"\\\\#='{}äß∑\\t]{1,20}";
    let edge = || prop_oneof![1e-3..1e3, Just(1.0), Just(123456.125)];
    let mesh = (edge(), edge(), 1..3_usize)
        .prop_map(|(a, b, n)| format!("[mesh]\nbox = {{ size = [{a:?}, {b:?}, 1], cells = [1, {n}, 1] }}\n"));
    let loads = prop::collection::vec(load(), 0..3).prop_map(|loads| loads.concat());
    (title, mesh, number(), material(), loads, support(), time(), rest()).prop_map(
        |(title, mesh, density, material, loads, support, time, rest)| {
            let title = toml::Value::String(format!("t{title}"));
            let region = format!("[region]\ndensity = {density:?}\nmaterial.{material}\n");
            format!("title = {title}\n{mesh}{region}{loads}{support}{time}{rest}")
        },
    )
}

/// A part of a mesh without its name.
fn part() -> impl Strategy<Value = String> {
    let shape = prop_oneof![
        (number(), 1..3_usize)
            .prop_map(|(a, n)| format!("box = {{ size = [1, {a:?}, 1], cells = [1, {n}, 2] }}")),
        (number(), number(), 3..5_usize).prop_map(|(a, b, n)| format!(
            "ring = {{ inner = {a:?}, outer = {:?}, height = 1, cells = [1, {n}, 1] }}",
            a + b
        )),
        (number(), number(), 1..4_usize).prop_map(|(a, b, n)| format!(
            "cylinder = {{ radius = {a:?}, height = {b:?}, cells = [{n}, 1] }}"
        )),
        (number(), 1..4_usize).prop_map(|(a, n)| format!("ball = {{ radius = {a:?}, cells = {n} }}")),
    ];
    let turn = (vector(), signed(), prop::option::of(vector())).prop_filter_map(
        "no axis",
        |(axis, angle, about)| {
            let about = about.map_or(String::new(), |about| format!(", about = {about}"));
            let is_zero = axis.split([',', '[', ']']).all(|x| x.trim().parse().unwrap_or(0.0) == 0.0);
            (!is_zero).then(|| format!(", turn = {{ axis = {axis}, angle = {angle:?}{about} }}"))
        },
    );
    let scale = number().prop_map(|scale| format!(", scale = {scale:?}"));
    let at = vector().prop_map(|at| format!(", at = {at}"));
    (shape, prop::option::of(turn), prop::option::of(scale), prop::option::of(at)).prop_map(
        |(shape, turn, scale, at)| [Some(shape), turn, scale, at].into_iter().flatten().collect::<String>(),
    )
}

fn input_of_parts() -> impl Strategy<Value = String> {
    (prop::collection::vec(part(), 1..4), prop::option::of(number()), material()).prop_map(|(parts, scale, material)| {
        let named = parts.iter().enumerate().map(|(i, part)| format!("{{ name = 'p-{i}', {part} }}"));
        let scale = scale.map_or(String::new(), |scale| format!("scale = {scale:?}\n"));
        format!(
            "[mesh]\nparts = [{}]\n{scale}[region]\ndensity = 1\nmaterial.{material}\n[time]\nscheme = 'DGM'\n\
             degree = 1\nsteps = [{{ until = 1, size = 0.5 }}]\n",
            named.collect::<Vec<_>>().join(", ")
        )
    })
}

/// All data of a problem from its input.
fn said(problem: &Problem) -> String {
    let Problem {
        title,
        body,
        supports,
        nodal,
        loads,
        initial,
        scheme,
        plan,
        newton,
        output,
        limits,
        notes,
        ..
    } = problem;
    let (mesh, regions) = (body.mesh(), body.regions());
    format!(
        "{title:?} {mesh:?} {regions:?} {supports:?} {nodal:?} {loads:?} {initial:?} {scheme} {plan:?} {newton:?} \
         {output:?} {limits:?} {notes:?}"
    )
}

fn read(directory: &Path, text: &str, flags: &[String]) -> Result<Problem, String> {
    let file = directory.join("input.toml");
    std::fs::write(&file, text).unwrap();
    let overrides = Overrides { set: flags.to_vec(), ..Default::default() };
    input::read(&file, &overrides).map_err(|error| format!("{error}\n{text}"))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..Default::default() })]

    #[test]
    fn the_resolved_input_is_the_same_problem(text in valid_input()) {
        let directory = tempfile::tempdir().unwrap();
        let first = read(directory.path(), &text, &[]).map_err(TestCaseError::fail)?;
        let second = read(directory.path(), &first.resolved, &[]).map_err(TestCaseError::fail)?;
        prop_assert_eq!(said(&first), said(&second), "{}\n{}", text, first.resolved);
        prop_assert_eq!(&first.resolved, &second.resolved);
    }

    #[test]
    fn parts_are_the_same_in_the_resolved_input(text in input_of_parts()) {
        let directory = tempfile::tempdir().unwrap();
        // Shifts of 1e3 beside sizes of 1e-17 make cells without volume, which is an error in both.
        let first = match read(directory.path(), &text, &[]) {
            Ok(first) => first,
            Err(error) => {
                prop_assert!(error.contains("mesh"), "{}", error);
                return Ok(());
            }
        };
        let second = read(directory.path(), &first.resolved, &[]).map_err(TestCaseError::fail)?;
        prop_assert_eq!(said(&first), said(&second), "{}\n{}", text, first.resolved);
        prop_assert_eq!(&first.resolved, &second.resolved);
    }

    /// A value has the same meaning in the file and in a flag.
    #[test]
    fn a_flag_is_as_good_as_the_file(text in valid_input(), density in number(), points in 3..9_usize) {
        let directory = tempfile::tempdir().unwrap();
        let flags = [format!("region.density={density:?}"), format!("time.scheme=AS({points})")];
        let by_flags = read(directory.path(), &text, &flags).map_err(TestCaseError::fail)?;
        let changed: Vec<String> = text
            .lines()
            .map(|line| match line.split(" = ").next() {
                Some("density") => format!("density = {density:?}"),
                Some("scheme") => format!("scheme = \"AS({points})\""),
                _ => line.to_string(),
            })
            .collect();
        let by_file = read(directory.path(), &changed.join("\n"), &[]).map_err(TestCaseError::fail)?;
        prop_assert_eq!(said(&by_flags), said(&by_file));
        prop_assert_eq!(by_flags.resolved, by_file.resolved);
    }
}
