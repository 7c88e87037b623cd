//! Forces of pairs in a step.

mod reference;

use super::closest::{PairKind, PairTangent, PairVectors, pair_vectors};
use super::layer::{Layer, LayerLaw};
use super::links::PairState;
use super::pair::Pair;
use super::step::PairStage;
use crate::average::Rule;
use crate::tensor::{cross, dot3};

pub(super) const KINDS: [PairKind; 4] =
    [PairKind::PointTriangle, PairKind::PointEdge, PairKind::PointVertex, PairKind::EdgeEdge];

/// `sum_a left_a . right_a`.
pub(super) fn product(left: &PairVectors, right: &PairVectors) -> f64 {
    (0..4).map(|a| dot3(left[a], right[a])).sum()
}

/// Numbers between -1 and 1 (SplitMix64).
pub(super) struct Random(pub u64);

impl Random {
    pub(super) fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Vectors of the entities of a pair.
    pub(super) fn vectors(&mut self, kind: PairKind, size: f64) -> PairVectors {
        let mut vectors = PairVectors::default();
        let all = vectors[..kind.n_entities()].as_flattened_mut();
        all.iter_mut().for_each(|component| *component = size * self.number());
        vectors
    }
}

/// A step of a pair, with results.
struct Step {
    pair: Pair,
    rule: Rule,
    start: PairState,
    rates: Vec<PairVectors>,
}

impl Step {
    /// Large random steps near the layer, in which the closest point changes its face.
    fn random(random: &mut Random, kind: PairKind, k: usize, law: LayerLaw) -> Step {
        let layer = Layer { modulus: 100.0, thickness: 1.0, law };
        let pair = Pair { kind, weight: 0.7, layer };
        let start = PairState::new(kind, random.vectors(kind, 0.8));
        let rates = (0..k).map(|_| random.vectors(kind, 0.6)).collect();
        Step { pair, rule: Rule::discrete_gradient(k), start, rates }
    }

    fn k(&self) -> usize {
        self.rates.len()
    }

    /// Stage forces, and the state at the end.
    fn forces(&self) -> (Vec<PairVectors>, PairState) {
        let (mut stages, mut forces) =
            (vec![PairStage::default(); self.k()], vec![PairVectors::default(); self.k()]);
        let end = self.pair.forces(&self.rule, &self.start, &self.rates, &mut stages, &mut forces, &mut []);
        (forces, end)
    }

    fn tangents(&self) -> Vec<PairTangent> {
        let k = self.k();
        let (mut stages, mut tangents) = (vec![PairStage::default(); k], vec![PairTangent::default(); k * k]);
        let mut forces = vec![PairVectors::default(); k];
        self.pair.forces(&self.rule, &self.start, &self.rates, &mut stages, &mut forces, &mut tangents);
        tangents
    }

    /// Positions at a Gauss point.
    fn positions(&self, i: usize) -> PairVectors {
        let row = &self.rule.coefficients()[i * self.k()..];
        let path = |e: usize, c: usize| row.iter().zip(&self.rates).map(|(a, x)| a * x[e][c]).sum::<f64>();
        pair_vectors(|e, c| self.start.positions[e][c] + path(e, c))
    }

    /// Largest component of the stage forces.
    fn size(forces: &[PairVectors]) -> f64 {
        forces.as_flattened().as_flattened().iter().fold(0.0, |size, force| size.max(force.abs()))
    }
}

#[test]
fn forces_and_energies_are_those_of_another_implementation() {
    let layer = Layer { modulus: 100.0, thickness: 0.5, law: LayerLaw::Smooth };
    for (n, case) in reference::CASES.iter().enumerate() {
        let pair = Pair { kind: case.kind, weight: 1.0, layer };
        let start = PairState::new(case.kind, case.start);
        let rule = Rule::discrete_gradient(case.rates.len());
        let step = Step { pair, rule, start, rates: case.rates.to_vec() };
        let (forces, end) = step.forces();
        for (own, expected) in [start, end].iter().zip(case.energies) {
            let own = pair.energy(own);
            assert!((own - expected).abs() <= 1e-10 * expected, "case {n}: {own} {expected}");
        }
        let size = Step::size(case.forces);
        let components = case.forces.as_flattened().as_flattened();
        for (own, expected) in forces.as_flattened().as_flattened().iter().zip(components) {
            assert!((own - expected).abs() <= 1e-10 * size, "case {n}: {own} {expected}");
        }
    }
    assert_eq!(reference::CASES.len(), 24);
}

#[test]
fn work_is_the_change_of_energy_without_resultant_and_moment() {
    let mut random = Random(4);
    for _ in 0..300 {
        for (kind, k) in KINDS.into_iter().flat_map(|kind| (1..=3).map(move |k| (kind, k))) {
            for law in [LayerLaw::Smooth, LayerLaw::Linear] {
                let step = Step::random(&mut random, kind, k, law);
                let (forces, end) = step.forces();
                let b = step.rule.weights();
                let work: f64 = (0..k).map(|i| b[i] * product(&forces[i], &step.rates[i])).sum();
                let (psi_1, psi_2) = (step.pair.energy(&step.start), step.pair.energy(&end));
                let size = Step::size(&forces);
                let error = work - (psi_2 - psi_1);
                assert!(error.abs() <= 1e-11 * (psi_1 + psi_2 + size), "{kind:?} {k}: {error:e} of {size:e}");
                for c in 0..3 {
                    let resultant: f64 = forces.as_flattened().iter().map(|force| force[c]).sum();
                    assert!(resultant.abs() <= 1e-14 * size, "{kind:?} {k}: {resultant:e} of {size:e}");
                    let moment = |(i, force): (usize, &PairVectors)| {
                        let q = step.positions(i);
                        b[i] * (0..4).map(|a| cross(q[a], force[a])[c]).sum::<f64>()
                    };
                    let moment: f64 = forces.iter().enumerate().map(moment).sum();
                    assert!(moment.abs() <= 1e-13 * size, "{kind:?} {k}: {moment:e} of {size:e}");
                }
            }
        }
    }
}

#[test]
fn two_links_are_symmetric_in_time() {
    let mut random = Random(5);
    for kind in KINDS {
        for _ in 0..300 {
            let step = Step::random(&mut random, kind, 1, LayerLaw::Smooth);
            let (forces, end) = step.forces();
            let rates = vec![step.rates[0].map(|rate| rate.map(|component| -component))];
            let (reverse, _) = Step { start: end, rates, ..step }.forces();
            let size = Step::size(&forces);
            for (own, other) in forces.as_flattened().as_flattened().iter().zip(reverse[0].as_flattened()) {
                assert!((own - other).abs() <= 1e-12 * size, "{kind:?}: {own} {other}");
            }
        }
    }
}

#[test]
fn without_motion_forces_are_gradients() {
    let mut random = Random(6);
    for (kind, k) in KINDS.into_iter().flat_map(|kind| (1..=3).map(move |k| (kind, k))) {
        let mut step = Step::random(&mut random, kind, k, LayerLaw::Smooth);
        step.rates = vec![PairVectors::default(); k];
        let gradient = step.pair.gradient(&step.start);
        let second = step.pair.second_derivative(&step.start);
        let (forces, tangents) = (step.forces().0, step.tangents());
        for i in 0..k {
            let (own, size) = (forces[i].as_flattened(), Step::size(&[gradient]));
            assert!(own.iter().zip(gradient.as_flattened()).all(|(own, g)| (own - g).abs() <= 1e-14 * size));
            // With higher degrees, the stages alone move.
            for j in (0..k).filter(|_| k > 1) {
                let a_ij = step.rule.coefficients()[i * k + j];
                let entries = |tangent: &PairTangent| {
                    *tangent.as_flattened().as_flattened().as_flattened().first_chunk::<144>().unwrap()
                };
                let (own, second) = (entries(&tangents[i * k + j]), entries(&second));
                assert!(
                    own.iter()
                        .zip(second)
                        .all(|(own, s)| (own - a_ij * s).abs() <= 1e-12 * s.abs().max(size))
                );
            }
        }
    }
}

/// Work along the surface is rounding, which should not be corrected.
#[test]
fn forces_of_sliding_pairs_are_gradients() {
    let (mut random, mut n) = (Random(9), 0);
    for trial in 0..4000 {
        let (kind, k) = (PairKind::PointTriangle, 2 + trial % 2);
        let mut step = Step::random(&mut random, kind, k, LayerLaw::Smooth);
        let [t, u] = step.start.face().tangents;
        // The point moves in the plane of the triangle, all entities move together.
        let rate = |random: &mut Random| {
            let (v, w) = (0.1 * random.number(), 0.1 * random.number());
            let own = |e: usize, c: usize| if e == 0 { v * t[c] + w * u[c] } else { 0.0 };
            pair_vectors(|e, c| [7.0, 3.0, 2.0][c] + own(e, c))
        };
        step.rates = (0..k).map(|_| rate(&mut random)).collect();
        let (forces, end) = step.forces();
        let states: Vec<PairState> = (0..k).map(|i| PairState::new(kind, step.positions(i))).collect();
        let all: Vec<PairState> = [step.start, end].into_iter().chain(states.clone()).collect();
        if !is_smooth(&all, &[]) || all.iter().any(|state| state.closest.dimension < 2) {
            continue;
        }
        n += 1;
        for (force, state) in forces.iter().zip(states) {
            let gradient = step.pair.gradient(&state);
            let size = Step::size(&[gradient]);
            for (own, gradient) in force.as_flattened().iter().zip(gradient.as_flattened()) {
                assert!((own - gradient).abs() <= 1e-14 * size, "{own} {gradient}");
            }
        }
    }
    assert!(n > 100, "{n}");
}

/// The derivative along a direction.
fn along(tangent: &PairTangent, u: &PairVectors) -> PairVectors {
    pair_vectors(|a, i| (0..4).map(|b| dot3(tangent[a][b][i], u[b])).sum())
}

/// Whether a derivative equals the central differences of fourth order of values at -2h, -h, h, 2h.
fn assert_derivative(own: &PairVectors, values: &[PairVectors; 4], h: f64, what: &str) {
    let size = Step::size(&[*own]);
    for (e, c) in (0..4).flat_map(|e| (0..3).map(move |c| (e, c))) {
        let [f, g, k, l] = values.map(|value| value[e][c]);
        let difference = (8.0 * (k - g) - (l - f)) / (12.0 * h);
        let rounding = 1e-14 * Step::size(values) / h;
        let error = (own[e][c] - difference).abs();
        assert!(error <= 1e-7 * size + rounding, "{what}: {error:e} of {size:e}, {rounding:e}");
    }
}

const OFFSETS: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];

#[test]
fn derivatives_of_energies_agree_with_differences() {
    let (mut random, mut n, h) = (Random(7), 0, 2e-5);
    for (kind, law) in KINDS.into_iter().flat_map(|kind| [(kind, LayerLaw::Smooth), (kind, LayerLaw::Linear)])
    {
        for _ in 0..100 {
            let step = Step::random(&mut random, kind, 1, law);
            let (pair, x, u) = (step.pair, step.start.positions, random.vectors(kind, 1.0));
            let at = |offset: &f64| PairState::new(kind, pair_vectors(|e, c| x[e][c] + h * offset * u[e][c]));
            let states = [0, 1, 2, 3].map(|i| at(&OFFSETS[i]));
            if !is_smooth(&[step.start], &states) {
                continue;
            }
            n += 1;
            let second = pair.second_derivative(&step.start);
            assert_derivative(&along(&second, &u), &states.map(|state| pair.gradient(&state)), h, "second");
            let slope = product(&pair.gradient(&step.start), &u);
            let single = |energy: f64| [[energy, 0.0, 0.0], [0.0; 3], [0.0; 3], [0.0; 3]];
            assert_derivative(&single(slope), &states.map(|state| single(pair.energy(&state))), h, "first");
            let entries = second.as_flattened().as_flattened().as_flattened();
            let size = entries.iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
            let symmetric = (0..144).all(|at| {
                let (a, b, i, j) = (at / 36, at / 9 % 4, at / 3 % 3, at % 3);
                (second[a][b][i][j] - second[b][a][j][i]).abs() <= 1e-14 * size
            });
            assert!(symmetric, "{kind:?}");
        }
    }
    assert!(n > 300, "{n}");
}

/// Whether states have the same faces as the neighbours, are away from distance zero and on one side of the layer.
fn is_smooth(states: &[PairState], neighbours: &[PairState]) -> bool {
    let key = |state: &PairState| {
        let face = state.face();
        (face.directions, state.closest.squared_distance < 1.0)
    };
    let is_good = |state: &PairState| {
        let face = state.face();
        let [t, u] = face.tangents.map(|t| dot3(t, t));
        let normal = cross(face.tangents[0], face.tangents[1]);
        let is_flat = state.closest.dimension == 2 && dot3(normal, normal) < 0.04 * t * u;
        let is_short = [t, u][..state.closest.dimension].iter().any(|size| *size < 0.04);
        state.closest.squared_distance > 0.04 && !is_flat && !is_short
    };
    let n = states.len();
    states.iter().all(is_good)
        && neighbours.iter().enumerate().all(|(i, near)| key(near) == key(&states[i % n]))
}

#[test]
fn tangents_agree_with_differences() {
    let (mut random, h) = (Random(8), 2e-5);
    for (kind, k) in KINDS.into_iter().flat_map(|kind| (1..=3).map(move |k| (kind, k))) {
        let mut n = 0;
        for trial in 0..400 {
            let law = [LayerLaw::Smooth, LayerLaw::Linear][trial % 2];
            let step = Step::random(&mut random, kind, k, law);
            let tangents = step.tangents();
            for j in 0..k {
                let u = random.vectors(kind, 1.0);
                let moved = |offset: f64| {
                    let mut rates = step.rates.clone();
                    rates[j] = pair_vectors(|e, c| step.rates[j][e][c] + h * offset * u[e][c]);
                    Step { rates, rule: step.rule.clone(), ..step }
                };
                let moved = OFFSETS.map(moved);
                let states = |step: &Step| {
                    let mut states = vec![step.forces().1];
                    states.extend((0..k).filter(|_| k > 1).map(|i| PairState::new(kind, step.positions(i))));
                    states
                };
                let neighbours: Vec<PairState> = moved.iter().flat_map(states).collect();
                if !is_smooth(&states(&step), &neighbours) {
                    continue;
                }
                n += 1;
                for i in 0..k {
                    let own = along(&tangents[i * k + j], &u);
                    assert_derivative(
                        &own,
                        &[0, 1, 2, 3].map(|at| moved[at].forces().0[i]),
                        h,
                        &format!("{kind:?} {k}"),
                    );
                }
            }
        }
        assert!(n > 50, "{kind:?} {k}: {n}");
    }
}
