//! Results of an independent implementation: forces and tangents of one step, motions, equilibria.

use emmy::body::{Formulation, PressureSpace};
use emmy::equilibrium::Equilibrium;
use emmy::internals::average::{Request, Rule};
use emmy::internals::body::StepInput;
use emmy::internals::quadrature::gauss;
use emmy::mesh::Facet;
use emmy::prelude::*;

use super::mapped;

/// Materials of the cases.
enum Rubber {
    Isochoric { mu: f64, bulk: f64, law: Volumetric },
    NeoHooke { lambda: f64, mu: f64 },
}

fn region(rubber: Rubber, formulation: Formulation, density: f64) -> Region {
    let region = match rubber {
        Rubber::Isochoric { mu, bulk, law } => {
            Region::new(NeoHookeIsochoric::new(mu, bulk, law).unwrap(), density)
        }
        Rubber::NeoHooke { lambda, mu } => Region::new(NeoHooke::new(lambda, mu).unwrap(), density),
    };
    region.with_formulation(formulation)
}

/// Two distorted cells that share a face.
fn two_cells_mesh(kind: CellKind) -> MeshBuilder {
    let is_plane = kind.dimension() == 2;
    let map = |[a, b, c]: [f64; 3]| match is_plane {
        true => [2.0 * a + 0.1 * (2.0 * b).sin(), b + 0.15 * a * b, 0.0],
        false => [2.0 * a + 0.1 * (2.0 * b).sin(), b + 0.15 * a * c, c - 0.1 * a * b],
    };
    mapped(kind, [2, 1, 1], map)
}

fn close(what: &str, value: &[f64], expected: &[f64], tolerance: f64) {
    let size = expected.iter().fold(0f64, |size, x| size.max(x.abs()));
    for (value, expected) in value.iter().zip(expected) {
        assert!((value - expected).abs() < tolerance * size, "{what}: {value} instead of {expected}");
    }
}

/// One step without a solver.
struct Evaluation {
    kind: CellKind,
    formulation: Formulation,
    rubber: Rubber,
    scheme: (&'static str, usize),
    /// At the start and the end of the step.
    energies: [f64; 2],
    /// Stage forces at the node of the last place, their norms, and the product of the tangent with the direction.
    forces: &'static [[f64; 3]],
    norms: &'static [f64],
    tangent: &'static [[f64; 3]],
}

fn evaluations() -> Vec<Evaluation> {
    vec![
        Evaluation {
            kind: CellKind::Hex8,
            formulation: Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
            rubber: Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::SimoTaylor },
            scheme: ("AS(5)", 1),
            energies: [62.68262919575977, 1042.2234634757835],
            forces: &[[-518.0002618420376, -486.94955509888126, -382.531000918774]],
            norms: &[4782.8687355520515],
            tangent: &[[7209.01171442596, 6748.819179792048, 5309.0091898920755]],
        },
        Evaluation {
            kind: CellKind::Hex8,
            formulation: Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
            rubber: Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::SimoTaylor },
            scheme: ("DGM", 1),
            energies: [62.68262919575977, 1042.2234634757835],
            forces: &[[-517.9986579581673, -486.94677303905223, -382.53354982372696]],
            norms: &[4782.892558474507],
            tangent: &[[7209.074610180767, 6748.819572031964, 5309.097764482964]],
        },
        Evaluation {
            kind: CellKind::Hex8,
            formulation: Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
            rubber: Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::SimoTaylor },
            scheme: ("DGM", 2),
            energies: [62.68262919575977, 604.1306974622108],
            forces: &[
                [-467.09611456106165, -426.3651373621416, -342.4254993437037],
                [-420.19091783326024, -416.7286624610758, -326.7788998140102],
            ],
            norms: &[3301.3019094411943, 5570.38162016242],
            tangent: &[
                [2552.365937544811, 2329.421282945003, 1881.3108043395446],
                [14912.693977104482, 14766.238149716142, 11554.997686151453],
            ],
        },
        Evaluation {
            kind: CellKind::Hex8,
            formulation: Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
            rubber: Rubber::NeoHooke { lambda: 20000.0, mu: 20.0 },
            scheme: ("AS(5)", 2),
            energies: [65.55829264456331, 707.4700139883795],
            forces: &[
                [-512.006929424032, -467.3632711234987, -375.55673982371627],
                [-458.4436968042462, -454.504521171945, -356.63560467646903],
            ],
            norms: &[3652.8791369419705, 6766.391736835972],
            tangent: &[
                [3166.666758134356, 2890.566711502464, 2334.1077638677566],
                [17556.67011884233, 17386.367205363644, 13612.912333376427],
            ],
        },
        Evaluation {
            kind: CellKind::Hex20,
            formulation: Formulation::ProjectedVolume(Some(PressureSpace::Linear)),
            rubber: Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::SimoTaylor },
            scheme: ("DGM", 1),
            energies: [128.03078431139187, 1656.5918924625817],
            forces: &[[736.4530710126803, 97.60241014137416, 118.63566775741815]],
            norms: &[8178.859619545545],
            tangent: &[[-2129.553800595465, -2018.0030280211963, -1777.1858181546]],
        },
        Evaluation {
            kind: CellKind::Hex27,
            formulation: Formulation::ProjectedVolume(Some(PressureSpace::Linear)),
            rubber: Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::SimoTaylor },
            scheme: ("DGM", 2),
            energies: [139.11105560075555, 965.9407603568387],
            forces: &[
                [-21.153881024846346, 4.006947255742775, 3.399829072235102],
                [17.310931772976407, 65.93231064747796, 55.02234574557229],
            ],
            norms: &[4157.551132462776, 6617.078289111187],
            tangent: &[
                [284.05056437144793, 330.2887129587214, 220.61698502466456],
                [1738.4882116803255, 2347.585641620781, 1685.767150969615],
            ],
        },
        Evaluation {
            kind: CellKind::Quad4,
            formulation: Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
            rubber: Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::SimoTaylor },
            scheme: ("DGM", 1),
            energies: [197.34443916797392, 858.1677538872658],
            forces: &[[-1485.3413924226384, -1112.4099171276139, 0.0]],
            norms: &[5698.9984945029555],
            tangent: &[[10574.281952979902, 7902.263141688279, 0.0]],
        },
        Evaluation {
            kind: CellKind::Quad8,
            formulation: Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
            rubber: Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::SimoTaylor },
            scheme: ("AS(5)", 1),
            energies: [230.7678414871753, 995.0407946546366],
            forces: &[[-539.8048453125834, -457.05483763943107, 0.0]],
            norms: &[5509.57454401732],
            tangent: &[[3839.6446101604574, 3222.1250434022036, 0.0]],
        },
        Evaluation {
            kind: CellKind::Quad9,
            formulation: Formulation::ProjectedVolume(Some(PressureSpace::Linear)),
            rubber: Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::SimoTaylor },
            scheme: ("DGM", 2),
            energies: [292.0439397812547, 941.0106964557376],
            forces: &[
                [-171.7195650924335, -34.27412402900542, 0.0],
                [267.5256049290927, 459.1362676173142, 0.0],
            ],
            norms: &[5484.476608067713, 7907.760038208082],
            tangent: &[
                [1206.7496138719482, 982.9550143716056, 0.0],
                [7911.993381562315, 7164.350257685141, 0.0],
            ],
        },
        Evaluation {
            kind: CellKind::Tri6,
            formulation: Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
            rubber: Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::SimoTaylor },
            scheme: ("DGM", 1),
            energies: [255.5343997058701, 1146.8959896469898],
            forces: &[[-792.2649950484454, -290.02224325006955, 0.0]],
            norms: &[6300.125387163996],
            tangent: &[[3886.6028549512125, 3192.4906046551578, 0.0]],
        },
        Evaluation {
            kind: CellKind::Tet10,
            formulation: Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
            rubber: Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::SimoTaylor },
            scheme: ("DGM", 1),
            energies: [95.78086219147603, 1538.0494481590579],
            forces: &[[-11.538978850899763, -55.012532850337806, 11.495851146145961]],
            norms: &[5273.655179274144],
            tangent: &[[44.02482326910743, 417.6713142722651, 121.63404615551502]],
        },
    ]
}

#[test]
fn forces_and_tangents_of_a_step() {
    for case in evaluations() {
        let body = Body::builder(two_cells_mesh(case.kind).build().unwrap())
            .region(region(case.rubber, case.formulation, 1.0))
            .build()
            .unwrap();
        let (scheme, k) = case.scheme;
        let scheme: Scheme = scheme.parse().unwrap();
        let rule = Rule::new(scheme.time_element().unwrap().rule, k);
        let is_plane = case.kind.dimension() == 2;
        let field = |s: f64| -> Vec<f64> {
            let of_node = |&[x, y, z]: &[f64; 3]| {
                let third = 0.04 * (2.0 * s - x + y + 2.0 * z).sin();
                [
                    0.06 * (1.0 + s + 2.0 * x - y + 0.5 * z).sin(),
                    0.05 * (0.7 * s + x + 1.5 * y - z).cos(),
                    if is_plane { 0.0 } else { third },
                ]
            };
            body.mesh().points().iter().flat_map(of_node).collect()
        };
        let displacement = field(0.0);
        let rates: Vec<f64> = (1..=k).flat_map(|i| field(i as f64)).map(|x| 1.5 * x).collect();
        let n = body.n_dofs();
        let end: Vec<f64> = (0..n)
            .map(|dof| {
                displacement[dof] + (0..k).map(|j| rule.weights()[j] * rates[j * n + dof]).sum::<f64>()
            })
            .collect();
        close(
            "energy",
            &[body.strain_energy(&displacement), body.strain_energy(&end)],
            &case.energies,
            1e-11,
        );
        let step = StepInput {
            rule: &rule,
            tangent_factor: 1.0,
            displacement: &displacement,
            rates: &rates,
            coordinates: &[],
            damping: Default::default(),
            local: None,
        };
        let mut assembly = body.assembly(step.rule);
        body.assemble(&step, Request::Tangent, &vec![0.0; k * k], &mut assembly).unwrap();
        let mut force = vec![0.0; k * n];
        assembly.matrix.copy_force(&mut force);
        let direction: Vec<f64> =
            (1..=k).flat_map(|i| body.mesh().points().iter().flatten().map(move |x| i as f64 * x)).collect();
        let mut product = vec![0.0; k * n];
        assembly.matrix.multiply(body.pattern(), &direction, &mut product);
        let place =
            if is_plane { [2.0 + 0.1 * 2f64.sin(), 1.15, 0.0] } else { [2.0 + 0.1 * 2f64.sin(), 1.15, 0.9] };
        let node = body.mesh().nearest_node(place);
        for i in 0..k {
            let stage = &force[i * n..(i + 1) * n];
            close("force", &stage[3 * node..3 * node + 3], &case.forces[i], 1e-9);
            let square: f64 = (0..n).filter(|&dof| !body.fixed()[dof]).map(|dof| stage[dof].powi(2)).sum();
            close("norm", &[square.sqrt()], &[case.norms[i]], 1e-10);
            close("tangent", &product[i * n + 3 * node..i * n + 3 * node + 3], &case.tangent[i], 1e-8);
        }
    }
}

struct Expected {
    /// Reference position of the node, and its position at the end.
    probe: ([f64; 3], [f64; 3]),
    kinetic: f64,
    strain: f64,
    angular_momentum: [f64; 3],
}

/// The L-shaped block under tractions of half the height of the paper, from rest.
fn l_block(region: Region) -> (Body, State) {
    l_block_under(&[(0.0, 0.0), (0.5, 0.5), (1.0, 0.0)], region)
}

fn l_block_under(table: &[(f64, f64)], region: Region) -> (Body, State) {
    let loads = [("face-a", 1.0), ("face-b", -1.0)].map(|(group, sign)| {
        let traction = [256.0, 512.0, 768.0].map(|t| sign * t / 9.0);
        Load::traction(group, traction).over(table).unwrap()
    });
    let body = Body::builder(mesh::l_block(1.0).unwrap()).region(region).loads(&loads).build().unwrap();
    let state = State::initial(&body, 0.0, &[]).unwrap();
    (body, state)
}

/// The two distorted cells in free flight.
fn two_cells(kind: CellKind, region: Region) -> (Body, State) {
    let body = Body::builder(two_cells_mesh(kind).build().unwrap()).region(region).build().unwrap();
    let motion = InitialVelocity {
        angular_velocity: [0.3, 0.5, 0.8],
        gradient: [[0.4, 0.0, 0.0], [0.0, -0.25, 0.0], [0.0, 0.0, -0.15]],
        ..Default::default()
    };
    let state = State::initial(&body, 0.0, &[motion]).unwrap();
    (body, state)
}

/// Cook's membrane: clamped at the left, a shear force on the right edge.
fn cook_body(kind: CellKind, m: usize, region: Region, force: f64) -> Body {
    let map = |[a, b, _]: [f64; 3]| [48.0 * a, 44.0 * a + (44.0 - 28.0 * a) * b, 0.0];
    let mut builder = mapped(kind, [m, m, 1], map);
    let mesh = builder.clone().build().unwrap();
    let left = (0..mesh.n_nodes() as u32).filter(|&node| mesh.points()[node as usize][0].abs() < 1e-9);
    builder.node_group("left", left.collect::<Vec<_>>());
    let is_right = |&node: &u32| (mesh.points()[node as usize][0] - 48.0).abs() < 1e-9;
    let right = (0..mesh.n_cells() as u32)
        .flat_map(|cell| {
            let n_facets = mesh.cell(cell as usize).kind.facets().len() as u8;
            (0..n_facets).map(move |local| Facet { cell, local })
        })
        .filter(|&facet| mesh.facet_nodes(facet).all(|node| is_right(&node)));
    builder.facet_group("right", right.collect::<Vec<_>>());
    Body::builder(builder.build().unwrap())
        .region(region)
        .support(Support::fixed("left"))
        .load(Load::traction("right", [0.0, force / 16.0, 0.0]))
        .build()
        .unwrap()
}

fn cook(kind: CellKind, m: usize, region: Region) -> (Body, State) {
    let body = cook_body(kind, m, region, 50.0);
    let state = State::initial(&body, 0.0, &[]).unwrap();
    (body, state)
}

fn assert_motion(
    (body, state): (Body, State),
    (scheme, degree): (&str, usize),
    (h, steps): (f64, usize),
    expected: &Expected,
) {
    let scheme = scheme.parse::<Scheme>().unwrap().with_degree(degree).unwrap();
    let mut motion = Motion::starting(&body, scheme, NewtonSettings::default(), state).unwrap();
    for _ in 0..steps {
        motion.step(h).unwrap();
    }
    let record = motion.record();
    let probe = motion.state().position(&body, body.mesh().nearest_node(expected.probe.0));
    close("probe", &probe, &expected.probe.1, 1e-9);
    close("kinetic energy", &[record.kinetic_energy], &[expected.kinetic], 1e-8);
    close("strain energy", &[record.strain_energy], &[expected.strain], 1e-7);
    close("angular momentum", &record.angular_momentum, &expected.angular_momentum, 1e-9);
}

#[test]
fn lblock_p0_1e3_as5_k1() {
    let region = region(
        Rubber::Isochoric { mu: 500.0, bulk: 500000.0, law: Volumetric::SimoTaylor },
        Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
        0.5,
    );
    assert_motion(
        l_block(region),
        ("AS(5)", 1),
        (0.02, 50),
        &Expected {
            probe: ([0.0, 10.0, 0.0], [3.923192211001064, 7.034725483606474, 7.062910116400676]),
            kinetic: 2603.8103258421993,
            strain: 190.9825867824421,
            angular_momentum: [1225.8980104911866, 721.8771686277515, -889.8841159155623],
        },
    );
}

#[test]
fn lblock_p0_1e5_dgm_k1() {
    let region = region(
        Rubber::Isochoric { mu: 500.0, bulk: 50000000.0, law: Volumetric::SimoTaylor },
        Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
        0.5,
    );
    assert_motion(
        l_block(region),
        ("DGM", 1),
        (0.02, 50),
        &Expected {
            probe: ([0.0, 10.0, 0.0], [3.923917280049672, 7.034665483085145, 7.062767349666866]),
            kinetic: 2603.770266533579,
            strain: 190.78193386416348,
            angular_momentum: [1225.8566279006034, 721.8598378741418, -889.8587678829796],
        },
    );
}

#[test]
fn lblock_p0_1e3_dgm_k2() {
    let region = region(
        Rubber::Isochoric { mu: 500.0, bulk: 500000.0, law: Volumetric::SimoTaylor },
        Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
        0.5,
    );
    // The reference averages the load over a step with five Gauss points, also over the corner of the hat.
    let gauss = gauss(5);
    let distances = gauss.points.iter().zip(&gauss.weights).map(|([c], weight)| weight * (c - 0.5).abs());
    let corner = 0.5 - 0.04 * distances.sum::<f64>();
    let table = [(0.0, 0.0), (0.48, 0.48), (0.48, corner), (0.52, corner), (0.52, 0.48), (1.0, 0.0)];
    assert_motion(
        l_block_under(&table, region),
        ("DGM", 2),
        (0.04, 25),
        &Expected {
            probe: ([0.0, 10.0, 0.0], [3.926858592503456, 7.030617433284979, 7.0618443738120655]),
            kinetic: 2606.5344849955072,
            strain: 189.72631460798718,
            angular_momentum: [1226.5499567050415, 722.2714273250177, -890.3642704516933],
        },
    );
}

#[test]
fn lblock_p0_neo_hooke_as5_k1() {
    let region = region(
        Rubber::NeoHooke { lambda: 500000.0, mu: 500.0 },
        Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
        0.5,
    );
    assert_motion(
        l_block(region),
        ("AS(5)", 1),
        (0.02, 50),
        &Expected {
            probe: ([0.0, 10.0, 0.0], [3.9452739583914855, 7.035582033599939, 7.056158869028859]),
            kinetic: 2603.0549102634827,
            strain: 184.1801640221941,
            angular_momentum: [1224.621669386642, 721.5800118084513, -889.2605643345149],
        },
    );
}

#[test]
fn spin_hex27_p1_as_k2() {
    let region = region(
        Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::SimoTaylor },
        Formulation::ProjectedVolume(Some(PressureSpace::Linear)),
        1.0,
    );
    assert_motion(
        two_cells(CellKind::Hex27, region),
        ("AS(6)", 2),
        (0.025, 16),
        &Expected {
            probe: (
                [2.0909297426825684, 1.15, 0.9],
                [2.0318091199535515, 1.6137027727796733, 0.6153916207261118],
            ),
            kinetic: 0.9735708913329931,
            strain: 0.04139475088777999,
            angular_momentum: [-0.9393237253668152, 1.5785891715125802, 1.646141807557914],
        },
    );
}

#[test]
fn spin_hex20_p1_dgm_k1() {
    let region = region(
        Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::Quadratic },
        Formulation::ProjectedVolume(Some(PressureSpace::Linear)),
        1.0,
    );
    assert_motion(
        two_cells(CellKind::Hex20, region),
        ("DGM", 1),
        (0.025, 16),
        &Expected {
            probe: (
                [2.0909297426825684, 1.15, 0.9],
                [2.0311038900263716, 1.612400512291037, 0.6158261032485891],
            ),
            kinetic: 0.9749224533478105,
            strain: 0.04004318887296641,
            angular_momentum: [-0.9393237253668176, 1.5785891715125842, 1.646141807557917],
        },
    );
}

#[test]
fn spin_hex8_p0_converged() {
    let region = region(
        Rubber::Isochoric { mu: 20.0, bulk: 20000.0, law: Volumetric::SimoTaylor },
        Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
        1.0,
    );
    assert_motion(
        two_cells(CellKind::Hex8, region),
        ("DGM", 3),
        (0.00625, 64),
        &Expected {
            probe: (
                [2.0909297426825684, 1.15, 0.9],
                [2.009347947866893, 1.61585427424175, 0.6266933472644308],
            ),
            kinetic: 0.9332182407785564,
            strain: 0.0425698344830173,
            angular_momentum: [-0.9053466814840443, 1.519827194867463, 1.583372274787016],
        },
    );
}

#[test]
fn cook_dynamic_quad4_p0() {
    let region = region(
        Rubber::Isochoric { mu: 80.1938, bulk: 400942.0, law: Volumetric::Quadratic },
        Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
        1.0,
    );
    assert_motion(
        cook(CellKind::Quad4, 8, region),
        ("DGM", 1),
        (0.5, 24),
        &Expected {
            probe: ([48.0, 60.0, 0.0], [43.50555772383038, 66.19614838059377, 0.0]),
            kinetic: 19.896466187285238,
            strain: 287.60607835779,
            angular_momentum: [0.0, 0.0, 5134.638094371815],
        },
    );
}

#[test]
fn cook_dynamic_quad9_p1() {
    let region = region(
        Rubber::Isochoric { mu: 80.1938, bulk: 400942.0, law: Volumetric::Quadratic },
        Formulation::ProjectedVolume(Some(PressureSpace::Linear)),
        1.0,
    );
    assert_motion(
        cook(CellKind::Quad9, 4, region),
        ("AS(5)", 1),
        (0.5, 24),
        &Expected {
            probe: ([48.0, 60.0, 0.0], [43.58313573615313, 66.16639222309244, 0.0]),
            kinetic: 26.659233817966776,
            strain: 281.40166884818217,
            angular_momentum: [0.0, 0.0, 5748.8697469638155],
        },
    );
}

/// Displacement of the upper right corner and strain energy.
#[test]
fn equilibria_of_cooks_membrane() {
    let cases = [
        (
            CellKind::Quad4,
            8,
            Formulation::Standard,
            [-0.07985798471776206, 2.2190697203135628],
            110.98134236993812,
        ),
        (
            CellKind::Quad4,
            8,
            Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
            [-5.395907731708064, 6.618591218740221],
            321.2142213278203,
        ),
        (
            CellKind::Quad4,
            16,
            Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
            [-5.655417448599877, 6.814447754007546],
            329.82286552304765,
        ),
        (
            CellKind::Quad8,
            8,
            Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
            [-6.2438618064851426, 7.214832197165919],
            339.5519529401178,
        ),
        (
            CellKind::Quad8,
            8,
            Formulation::ProjectedVolume(Some(PressureSpace::Linear)),
            [-5.694626284723363, 6.811739047160259],
            329.37345034522195,
        ),
        (
            CellKind::Quad9,
            8,
            Formulation::ProjectedVolume(Some(PressureSpace::Linear)),
            [-5.790772416717402, 6.9034723007515595],
            334.0347073950447,
        ),
        (
            CellKind::Quad9,
            16,
            Formulation::ProjectedVolume(Some(PressureSpace::Linear)),
            [-5.814938085087711, 6.9196286734290595],
            334.4463670231904,
        ),
        (
            CellKind::Tri6,
            8,
            Formulation::ProjectedVolume(Some(PressureSpace::Constant)),
            [-5.879743081279578, 6.985859377751268],
            335.7981945542092,
        ),
    ];
    for (kind, m, formulation, tip, energy) in cases {
        let rubber = Rubber::Isochoric { mu: 80.1938, bulk: 400942.0, law: Volumetric::Quadratic };
        let body = cook_body(kind, m, region(rubber, formulation, 1.0), 100.0);
        let equilibrium = Equilibrium::new(&body, 0.0, 5).unwrap();
        let state = equilibrium.start(NewtonSettings::default(), &[], &mut []).unwrap();
        let node = body.mesh().nearest_node([48.0, 60.0, 0.0]);
        close("tip", &state.displacement[3 * node..3 * node + 2], &tip, 1e-9);
        close("energy", &[body.strain_energy(&state.displacement)], &[energy], 1e-8);
    }
}
