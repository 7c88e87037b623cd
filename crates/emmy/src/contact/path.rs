//! Whether the entities of a pair meet on straight paths.

use super::closest::{Closest, PairKind, PairVectors, minus, pair_vectors};
use crate::tensor::{cross, dot3};

/// The distance that counts as a hit, relative to the extent of the paths.
const TOUCH: f64 = 1e-9;

/// The rounding of volumes, relative to the third power of the extent.
const ROUNDING: f64 = 1e-14;

/// The most intervals that are looked at.
const MAX_INTERVALS: usize = 10_000;

/// Whether the two sides of a pair meet while all entities go straight from the start to the end of a step.
///
/// Where they meet, their distance is zero, and with it the volume of the four entities, a cubic polynomial in time.
/// A part of the step has no hit if the Bernstein coefficients of this polynomial have one sign, or if the distance in
/// its middle is larger than the relative motion up to its ends. Other parts are halved, until a distance is at most
/// 1e-9 times the extent of the paths: a hit.
///
/// So no hit is missed, and paths that stay farther apart than this tolerance are no hit, with one exception: what is
/// undecided after 10,000 parts counts as a hit. Only coplanar entities and parallel edges have volumes without a sign,
/// and they have to slide along each other by a thousand times their distance. Positions that are not finite count as
/// a hit, unless the boxes of both paths have no common point.
///
/// A point and an edge are those of a plane body: an area in the x-y plane replaces the volume. In space, and for two
/// points, the answer is right too, but takes as many parts as for coplanar entities.
///
/// ```
/// use emmy::internals::contact::{PairKind, paths_meet};
/// let start = [[0.2, 0.2, 0.5], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let [through, short] = [-0.5, 0.1].map(|z| [[0.2, 0.2, z], start[1], start[2], start[3]]);
/// assert!(paths_meet(PairKind::PointTriangle, &start, &through));
/// assert!(!paths_meet(PairKind::PointTriangle, &start, &short));
/// ```
pub fn paths_meet(kind: PairKind, start: &PairVectors, end: &PairVectors) -> bool {
    if boxes_are_apart(kind, start, end) {
        return false;
    }
    // From one origin, as the digits of differences count.
    let n = kind.n_entities();
    let from_origin = |x: &PairVectors| pair_vectors(|a, i| if a < n { x[a][i] - start[0][i] } else { 0.0 });
    let (start, end) = (from_origin(start), from_origin(end));
    let largest = start.iter().chain(&end).flatten().fold(0.0, |size: f64, x| size.max(x.abs()));
    let mut search = Search {
        kind,
        touch: TOUCH * largest,
        rounding: ROUNDING * largest.powi(3),
        motion: relative_motion(kind, &start, &end),
        start,
        end,
        n_intervals: 0,
    };
    search.meets(0.0, 1.0, volumes(kind, &start, &end, largest))
}

/// Whether the boxes of the paths of the two sides have no common point.
fn boxes_are_apart(kind: PairKind, start: &PairVectors, end: &PairVectors) -> bool {
    (0..3).any(|i| {
        let mut ranges = [(f64::INFINITY, f64::NEG_INFINITY); 2];
        for a in 0..kind.n_entities() {
            let range = &mut ranges[usize::from(kind.is_first_side(a))];
            *range = (range.0.min(start[a][i]).min(end[a][i]), range.1.max(start[a][i]).max(end[a][i]));
        }
        ranges[0].0 > ranges[1].1 || ranges[1].0 > ranges[0].1
    })
}

/// The largest relative displacement of an entity of one side and one of the other: no distance changes by more.
fn relative_motion(kind: PairKind, start: &PairVectors, end: &PairVectors) -> f64 {
    let n = kind.n_entities();
    let displacement = |a: usize| minus(end[a], start[a]);
    let sides = |a: usize| (0..n).filter(move |b| kind.is_first_side(a) && !kind.is_first_side(*b));
    let pairs = (0..n).flat_map(|a| sides(a).map(move |b| (a, b)));
    let squares = pairs.map(|(a, b)| minus(displacement(a), displacement(b))).map(|u| dot3(u, u));
    squares.fold(0.0, f64::max).sqrt()
}

/// Bernstein's coefficients of the volume of the paths.
fn volumes(kind: PairKind, start: &PairVectors, end: &PairVectors, largest: f64) -> [f64; 4] {
    let edges = |x: &PairVectors| match kind {
        PairKind::PointTriangle | PairKind::EdgeEdge => [1, 2, 3].map(|a| minus(x[a], x[0])),
        PairKind::PointEdge => [minus(x[1], x[0]), minus(x[2], x[0]), [0.0, 0.0, largest]],
        PairKind::PointVertex => [[0.0; 3]; 3],
    };
    let both = [edges(start), edges(end)];
    let volume = |[u, v, w]: [usize; 3]| dot3(both[u][0], cross(both[v][1], both[w][2]));
    let mean = |at: [[usize; 3]; 3]| at.map(volume).iter().sum::<f64>() / 3.0;
    [
        volume([0, 0, 0]),
        mean([[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        mean([[0, 1, 1], [1, 0, 1], [1, 1, 0]]),
        volume([1, 1, 1]),
    ]
}

struct Search {
    kind: PairKind,
    start: PairVectors,
    end: PairVectors,
    motion: f64,
    touch: f64,
    rounding: f64,
    n_intervals: usize,
}

impl Search {
    /// Whether there is a hit between two times, with the coefficients of the volume in between.
    fn meets(&mut self, from: f64, to: f64, volumes: [f64; 4]) -> bool {
        let rounding = self.rounding;
        if volumes.iter().all(|volume| *volume > rounding) || volumes.iter().all(|volume| *volume < -rounding)
        {
            return false;
        }
        self.n_intervals += 1;
        let middle = 0.5 * (from + to);
        let x = pair_vectors(|a, i| (1.0 - middle) * self.start[a][i] + middle * self.end[a][i]);
        let distance = Closest::new(self.kind, &x).squared_distance.sqrt();
        // The tolerance exceeds the rounding of distances.
        if distance > 0.5 * (to - from) * self.motion + self.touch {
            return false;
        }
        if distance <= self.touch || distance.is_nan() || self.n_intervals >= MAX_INTERVALS {
            return true;
        }
        let (first, second) = halves(volumes);
        self.meets(from, middle, first) || self.meets(middle, to, second)
    }
}

/// Coefficients in both halves of an interval, by de Casteljau's algorithm.
fn halves([a, b, c, d]: [f64; 4]) -> ([f64; 4], [f64; 4]) {
    let [ab, bc, cd] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d)];
    let [abc, bcd] = [0.5 * (ab + bc), 0.5 * (bc + cd)];
    let middle = 0.5 * (abc + bcd);
    ([a, ab, abc, middle], [middle, bcd, cd, d])
}

#[cfg(test)]
mod tests {
    use super::super::tests::Random;
    use super::*;

    const TRIANGLE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    fn with_point(p: [f64; 3]) -> PairVectors {
        [p, TRIANGLE[0], TRIANGLE[1], TRIANGLE[2]]
    }

    /// Whether two paths meet, for all four choices of what is the start and of an origin far away.
    fn meet(kind: PairKind, start: &PairVectors, end: &PairVectors) -> bool {
        let far = |x: &PairVectors| pair_vectors(|a, i| x[a][i] + [7.0, -20.0, 11.0][i]);
        let all = [
            paths_meet(kind, start, end),
            paths_meet(kind, end, start),
            paths_meet(kind, &far(start), &far(end)),
        ];
        assert_eq!(all, [all[0]; 3], "{kind:?} {start:?} {end:?}");
        all[0]
    }

    #[test]
    fn points_meet_triangles() {
        let meets = |start, end| meet(PairKind::PointTriangle, &with_point(start), &with_point(end));
        assert!(meets([0.2, 0.2, 0.1], [0.2, 0.2, -0.1]));
        assert!(!meets([0.8, 0.8, 0.1], [0.8, 0.8, -0.1]));
        assert!(!meets([0.2, 0.2, 0.1], [0.3, 0.3, 0.01]));
        // Onto the triangle, at the end or at the start.
        assert!(meets([0.2, 0.2, 0.1], [0.2, 0.2, 0.0]));
        // Through a corner and through an edge.
        assert!(meets([0.0, 0.0, 0.1], [0.0, 0.0, -0.1]));
        assert!(meets([0.5, 0.5, 0.1], [0.5, 0.5, -0.1]));
        // In the plane: past a corner, and through an edge.
        assert!(!meets([-0.5, 0.4, 0.0], [0.5, -0.6, 0.0]));
        assert!(meets([-0.5, 0.4, 0.0], [0.5, 0.4, 0.0]));
        // Along the triangle, close to it.
        assert!(!meets([-1.0, 0.3, 1e-5], [2.0, 0.3, 1e-5]));
    }

    #[test]
    fn a_touch_is_a_hit() {
        // An edge along x shrinks to a point and grows again, while it goes down: its volume with an edge along y is
        // (1 - 2 alpha)^2 up to a factor. In the middle, it is at x = shift.
        let turning = |s: f64, shift: f64| {
            [[shift - s, 0.0, s], [shift + s, 0.0, s], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]]
        };
        let meets = |shift| meet(PairKind::EdgeEdge, &turning(1.0, shift), &turning(-1.0, shift));
        assert!(meets(0.0) && meets(1e-10));
        assert!(!meets(0.1) && !meets(1e-4) && !meets(1e-7));
    }

    #[test]
    fn parallel_edges_meet_if_their_distance_vanishes() {
        let edges = |y: f64, x: f64| [[0.0; 3], [1.0, 0.0, 0.0], [x, y, 0.0], [x + 1.0, y, 0.0]];
        assert!(meet(PairKind::EdgeEdge, &edges(0.1, 0.5), &edges(-0.1, 0.5)));
        assert!(!meet(PairKind::EdgeEdge, &edges(0.1, 1.5), &edges(-0.1, 1.2)));
        assert!(!meet(PairKind::EdgeEdge, &edges(0.01, -2.0), &edges(0.01, 2.0)));
    }

    /// Volumes in an oblique plane are rounding, which does not rule hits out.
    #[test]
    fn points_meet_triangles_in_oblique_planes() {
        let mut random = Random(10);
        for _ in 0..200 {
            let [origin, u, v, shift] = random.vectors(PairKind::PointTriangle, 1.0);
            let at = |s: f64, t: f64| [0, 1, 2].map(|i| origin[i] + s * u[i] + t * v[i]);
            let (s, t) = (3.0 * random.number(), 3.0 * random.number());
            // Halfway, the point is the centroid.
            let third = 1.0 / 3.0;
            let at_time = |sign: f64| {
                let x = [at(third + sign * s, third + sign * t), at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)];
                x.map(|x| [0, 1, 2].map(|i| x[i] + sign * shift[i]))
            };
            assert!(meet(PairKind::PointTriangle, &at_time(-1.0), &at_time(1.0)));
        }
    }

    #[test]
    fn points_meet_edges_in_the_plane() {
        let with = |p: [f64; 3]| [p, [0.0; 3], [1.0, 0.2, 0.0], [0.0; 3]];
        let meets = |start, end| meet(PairKind::PointEdge, &with(start), &with(end));
        assert!(meets([0.3, 1.0, 0.0], [0.4, -1.0, 0.0]));
        assert!(!meets([1.3, 1.0, 0.0], [1.4, -1.0, 0.0]));
        assert!(!meets([-2.0, 1e-4, 0.0], [-1e-4, 1e-4, 0.0]));
        let two = |p: [f64; 3]| [p, [0.0; 3], [0.0; 3], [0.0; 3]];
        assert!(meet(PairKind::PointVertex, &two([1.0; 3]), &two([-2.0; 3])));
        assert!(!meet(PairKind::PointVertex, &two([1.0; 3]), &two([-2.0, -2.0, -1.0])));
    }

    #[test]
    fn numbers_that_are_none_count_as_a_hit() {
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(paths_meet(
                PairKind::PointTriangle,
                &with_point([0.2; 3]),
                &with_point([bad, 0.2, -0.1])
            ));
        }
    }

    /// Random paths against many samples: a hit has a sample that is as near as a step between samples, and a miss has
    /// neither such a sample nor a change of sign of the volume with a closest point inside.
    #[test]
    fn random_paths_meet_where_samples_do() {
        const SAMPLES: usize = 2000;
        let mut random = Random(11);
        let (mut n_hits, mut n_misses) = (0, 0);
        for trial in 0..1000 {
            let kind = [PairKind::PointTriangle, PairKind::EdgeEdge][trial % 2];
            let (start, end) = (random.vectors(kind, 1.0), random.vectors(kind, 1.0));
            let at = |sample: usize| {
                let alpha = sample as f64 / SAMPLES as f64;
                pair_vectors(|a, i| start[a][i] + alpha * (end[a][i] - start[a][i]))
            };
            let step = relative_motion(kind, &start, &end) / SAMPLES as f64;
            let (mut smallest, mut crosses, mut last) = (f64::INFINITY, false, 0.0);
            for sample in 0..=SAMPLES {
                let x = at(sample);
                let closest = Closest::new(kind, &x);
                smallest = closest.squared_distance.sqrt().min(smallest);
                let [u, v, w] = [1, 2, 3].map(|a| minus(x[a], x[0]));
                let volume = dot3(u, cross(v, w));
                // Far enough inside that the closest point is inside at the zero as well.
                let is_inside = closest.weights.iter().all(|weight| weight.abs() > 0.05);
                crosses |= volume * last < 0.0 && is_inside && closest.squared_distance < step * step;
                last = volume;
            }
            if meet(kind, &start, &end) {
                n_hits += 1;
                assert!(smallest <= step, "{kind:?} {start:?} {end:?}");
            } else {
                n_misses += 1;
                assert!(!crosses && smallest > 0.0, "{kind:?} {start:?} {end:?}");
            }
        }
        assert!(n_hits > 50 && n_misses > 50, "{n_hits} {n_misses}");
    }
}
