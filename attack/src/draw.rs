//! Random inputs: every kind of load, support, scheme, estimator, damping, solver and output, on tiny bodies.

use fastrand::Rng;

/// Length of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Length {
    /// About ten steps.
    Short,
    /// Some hundred steps, enough to stop the run.
    Long,
}

/// Schemes of degree k, with letters for their arguments.
const TIME_ELEMENTS: [&str; 9] =
    ["FE(k)", "FE(k+1)", "AS(k)", "AS(k+2)", "DGM", "DGM(0.5)", "AS(k+1,0.2)", "Lobatto(k+1)", "trapezoidal"];

/// Methods that are not time elements.
const CLASSIC: [&str; 6] = [
    "Newmark(0.25,0.5)",
    "Newmark(0.3,0.6)",
    "HHT(0.05)",
    "generalized-alpha(0.8)",
    "Bathe",
    "central-differences",
];

/// Materials of a stiffness of about 1000.
const MATERIALS: [&str; 8] = [
    "neo-hooke = { lambda = 800.0, mu = 400.0 }",
    "saint-venant-kirchhoff = { youngs_modulus = 1000.0, poissons_ratio = 0.3 }",
    "ciarlet-geymonat = { youngs_modulus = 1000.0, poissons_ratio = 0.2 }",
    "hencky = { youngs_modulus = 1000.0, poissons_ratio = 0.3 }",
    "mooney-rivlin = { c10 = 150.0, c01 = 50.0, bulk_modulus = 900.0 }",
    "yeoh = { c10 = 200.0, c20 = 10.0, c30 = 1.0, bulk_modulus = 900.0, volumetric = \"miehe\" }",
    "ogden = { mu = [300.0, -10.0], alpha = [1.3, -2.0], bulk_modulus = 900.0 }",
    "holzapfel-gasser-ogden = { mu = 300.0, k1 = 100.0, k2 = 1.0, fibres = [[1, 1, 0]], bulk_modulus = 900.0 }",
];

/// Histories of loads: constant, with kinks and jumps, smooth.
const HISTORIES: [&str; 5] = [
    "",
    "history = [[0.0, 0.0], [0.15, 1.0], [0.3, 0.2]]",
    "history = [[0.0, 1.0], [0.21, 1.0], [0.21, 0.0]]",
    "history = \"sin(9*t)\"",
    "history = \"exp(-((t - 0.2)/0.1)^2)\"",
];

/// An input, with its output in `run`.
pub fn input(rng: &mut Rng, length: Length) -> String {
    let draft = Draft::new(rng, length);
    let mut text = draft.mesh();
    text += &draft.region(rng);
    for _ in 0..rng.usize(..4) {
        text += &draft.load(rng);
    }
    text += &draft.supports(rng);
    text += &draft.initial(rng);
    text += &draft.time(rng);
    text += &draft.output(rng);
    text
}

/// Choices that determine the rest.
#[derive(Debug)]
struct Draft {
    is_plane: bool,
    is_element: bool,
    is_explicit: bool,
    scheme: String,
    degree: usize,
    until: f64,
    size: f64,
}

fn one_of<'a>(rng: &mut Rng, list: &[&'a str]) -> &'a str {
    list[rng.usize(..list.len())]
}

/// Three components up to a size; zero across the plane.
fn vector(rng: &mut Rng, size: f64) -> String {
    let mut component = || format!("{:.3}", size * (2.0 * rng.f64() - 1.0));
    format!("[{}, {}, {}]", component(), component(), component())
}

impl Draft {
    fn new(rng: &mut Rng, length: Length) -> Self {
        let is_element = rng.usize(..3) > 0;
        let mut degree = if is_element { 1 + rng.usize(..3) } else { 1 };
        let name = one_of(rng, if is_element { &TIME_ELEMENTS } else { &CLASSIC });
        if name == "trapezoidal" {
            degree = 1;
        }
        let k = |more: usize| (degree + more).to_string();
        let scheme = name.replace("k+1", &k(1)).replace("k+2", &k(2)).replace("(k", &format!("({degree}"));
        let is_explicit = name == "central-differences";
        let size = if is_explicit { 0.001 } else { [0.01, 0.02, 0.05][rng.usize(..3)] };
        let steps = match length {
            Length::Short => 12.0,
            Length::Long => 150.0,
        };
        let until = if is_explicit { 5.0 } else { 1.0 } * steps * size;
        Draft { is_plane: rng.usize(..4) == 0, is_element, is_explicit, scheme, degree, until, size }
    }

    /// Whether the scheme has a spectral radius, `AS(n,rho)` or `DGM(rho)`.
    fn dissipates(&self) -> bool {
        self.scheme.contains(',') || self.scheme.starts_with("DGM(")
    }

    /// Whether supports may move.
    fn can_drive(&self) -> bool {
        self.is_element && !self.dissipates()
    }

    /// Whether the scheme has all degrees.
    fn can_change_degree(&self) -> bool {
        self.scheme.starts_with("DGM") || self.scheme.starts_with("AS(")
    }

    fn mesh(&self) -> String {
        match self.is_plane {
            true => "mesh.rectangle = { size = [1, 2], cells = [1, 2] }\n".into(),
            false => "mesh.box = { size = [1, 2, 1], cells = [1, 2, 1] }\n".into(),
        }
    }

    fn region(&self, rng: &mut Rng) -> String {
        let mut text = format!("[[region]]\ndensity = 1.5\nmaterial.{}\n", one_of(rng, &MATERIALS));
        if self.is_element && rng.usize(..4) == 0 {
            text += "viscosity = { time = 0.01, shear = 0.5, bulk = 0.1 }\n";
        }
        if rng.usize(..5) == 0 {
            text += "[[mass]]\ngroup = \"x-max\"\nmass = 0.3\n";
        }
        text
    }

    fn load(&self, rng: &mut Rng) -> String {
        let group = one_of(rng, &["x-max", "y-max", "x-min", "y-min"]);
        let history = one_of(rng, &HISTORIES);
        let kind = match rng.usize(..9) {
            0 => format!("group = \"{group}\"\ntraction = {}\n{history}", vector(rng, 60.0)),
            1 => format!("group = \"{group}\"\nforce = {}\n{history}", vector(rng, 60.0)),
            2 => format!("group = \"{group}\"\nnodal_force = {}\n{history}", vector(rng, 20.0)),
            3 | 4 => format!("group = \"{group}\"\npressure = {:.2}\n{history}", 80.0 * rng.f64() - 20.0),
            5 => format!("acceleration = {}\n{history}", vector(rng, 10.0)),
            7 => format!(
                "body_force = [\"{:.2}*sin(7*t)\", \"30*x*y*cos(4*t)\", 0]\n{history}",
                60.0 * rng.f64()
            ),
            6 if self.is_element => format!("drag = {:.3}", rng.f64()),
            6 => return String::new(),
            _ => "attraction = { centre = [4.0, 1.0, 0.0], strength = 20.0 }".into(),
        };
        format!("[[load]]\n{kind}\n")
    }

    fn supports(&self, rng: &mut Rng) -> String {
        let until = match rng.bool() {
            true => format!("until = {:.4}\n", self.until * (0.2 + 0.6 * rng.f64())),
            false => String::new(),
        };
        let support = match rng.usize(..8) {
            0 | 1 => format!("group = \"y-min\"\nfix = [\"x\", \"y\", \"z\"]\n{until}"),
            2 => format!("group = \"y-min\"\nfix = [\"y\"]\n{until}"),
            3 => "group = \"y-min\"\nspring = 50.0\n".into(),
            4 if self.can_drive() => {
                format!(
                    "group = \"y-min\"\nmove = {{ x = \"0.05*sin(7*t)\", y = [[0, 0], [0.2, 0.02]] }}\n{until}"
                )
            }
            5 if self.can_drive() => {
                format!("group = \"y-min\"\nrotate = {{ axis = [0, 0, 1], angle = \"t^2\" }}\n{until}")
            }
            _ => return String::new(),
        };
        format!("[[support]]\n{support}")
    }

    fn initial(&self, rng: &mut Rng) -> String {
        if rng.usize(..4) == 0 {
            return String::new();
        }
        let spin = match self.is_plane {
            true => "[0, 0, 2.0]".into(),
            false => vector(rng, 3.0),
        };
        let velocity = if self.is_plane { "[0.5, -0.2, 0]".into() } else { vector(rng, 1.0) };
        format!("[initial]\nvelocity = {velocity}\nangular_velocity = {spin}\nabout = [0.5, 1.0, 0.0]\n")
    }

    fn time(&self, rng: &mut Rng) -> String {
        let (until, size) = (self.until, self.size);
        let head = format!("[time]\nscheme = \"{}\"\ndegree = {}\n", self.scheme, self.degree);
        let steps = if self.is_element && rng.usize(..3) == 0 {
            let estimators: &[&str] = match self.degree {
                1 if !self.dissipates() => &["difference", "residual", "element", "sampled"],
                _ => &["residual", "element", "sampled"],
            };
            let (estimator, tolerance) = (one_of(rng, estimators), 2e-4 * (0.1 + rng.f64()));
            let degrees = match estimator {
                "residual" | "sampled" if self.can_change_degree() => "min_degree = 1, max_degree = 3, ",
                _ => "",
            };
            let estimator = format!("{degrees}estimator = \"{estimator}\"");
            format!("adaptive = {{ tolerance = {tolerance:.1e}, {estimator} }}\nuntil = {until}\n")
        } else if rng.bool() {
            format!(
                "steps = [{{ until = {}, size = {size} }}, {{ until = {until}, size = {} }}]\n",
                0.4 * until,
                0.7 * size
            )
        } else {
            format!("steps = [{{ until = {until}, size = {size} }}]\n")
        };
        let solver = one_of(rng, &["auto", "direct", "iterative"]);
        // Too few iterations for some steps, so that they are cut.
        let newton = if self.is_explicit { 20 } else { [20, 20, 6][rng.usize(..3)] };
        format!("{head}{steps}[newton]\nmax_iterations = {newton}\n[solver]\nkind = \"{solver}\"\n")
    }

    fn output(&self, rng: &mut Rng) -> String {
        let format = one_of(rng, &["vtu", "vtkhdf"]);
        let (every, checkpoints) = ([1, 3, 20][rng.usize(..3)], [1, 4, 15][rng.usize(..3)]);
        let precision = one_of(rng, &["double", "single"]);
        format!(
            "[output]\ndirectory = \"run\"\nevery = {every}\nformat = \"{format}\"\nprecision = \"{precision}\"\n\
             checkpoint_every = {checkpoints}\nprobes = [{{ name = \"tip\", point = [0, 2, 0] }}]\n"
        )
    }
}
