//! Whether surfaces are apart in the reference configuration: gaps, intersections, and bodies inside others.

#![allow(non_snake_case)]

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::candidates::Candidates;
use super::closest::{Closest, PairKind, minus};
use super::path::paths_meet;
use super::surface_layer::SurfaceLayer;
use super::tree::{Bounds, BoxTree};
use crate::tensor::{cross, dot3};

/// Gaps beyond this many thicknesses are not looked for.
const FARTHEST_GAP: f64 = 128.0;

/// Depths below this part of an edge are rounding.
const TOUCH: f64 = 1e-8;

/// An intersection of two surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intersection {
    /// Where an edge of one meets a triangle of the other.
    pub at: [f64; 3],
    /// The deepest of the ends of such edges inside the other body, and its distance to the surface \[length\]: no
    /// more than how deep the bodies overlap. `None` where they touch, or no end is inside.
    pub deepest: Option<([f64; 3], f64)>,
}

/// A part of a surface that is closed.
struct ClosedPart {
    body: u32,
    bounds: Bounds,
    triangles: Vec<[[f64; 3]; 3]>,
}

impl SurfaceLayer {
    fn reference_positions(&self) -> Vec<[f64; 3]> {
        let mut X = vec![[0.0; 3]; self.surface.n_entities()];
        self.surface.combine(&self.surface.positions, &mut X);
        X
    }

    /// Smallest distance between two bodies, with its place on one of them; `None` beyond 128 times the thickness of
    /// the layer.
    pub fn gap(&self) -> Option<(f64, [f64; 3])> {
        let X = self.reference_positions();
        let mut reach = self.layer.thickness;
        while reach < FARTHEST_GAP * self.layer.thickness {
            let mut candidates = Candidates::default();
            candidates.cover(&self.surface, |_| reach, &[&self.surface.positions]);
            let pairs = candidates.pairs.iter();
            let closest = pairs.map(|own| (own, Closest::new(own.kind, &own.vectors(&X))));
            let smaller =
                |closest: &Closest, than: &Closest| closest.squared_distance < than.squared_distance;
            let smallest = closest.reduce(|best, next| if smaller(&next.1, &best.1) { next } else { best });
            if let Some((pair, closest)) = smallest.filter(|(_, own)| own.squared_distance < reach * reach) {
                let x = pair.vectors(&X);
                let own = (0..2).filter(|entity| pair.kind.is_first_side(*entity));
                let at = own.fold([0.0; 3], |at, a| [0, 1, 2].map(|d| at[d] + closest.weights[a] * x[a][d]));
                return Some((closest.squared_distance.sqrt(), at));
            }
            reach *= 2.0;
        }
        None
    }

    /// Where an edge of one body and a triangle of another intersect; `None` if none do.
    pub fn intersection(&self) -> Option<Intersection> {
        let surface = &self.surface;
        let X = self.reference_positions();
        let place = |entity: u32| X[entity as usize];
        let bounds = |entities: &[u32]| {
            entities.iter().fold(Bounds::NONE, |sum, entity| sum.with(Bounds::of(place(*entity))))
        };
        let body_of =
            |triangle: u32| surface.body_of[surface.triangles[triangle as usize].corners[0] as usize];
        let boxes: Vec<Bounds> = surface.triangles.iter().map(|triangle| bounds(&triangle.corners)).collect();
        let mut tree = BoxTree::default();
        tree.fit(&boxes, 0..boxes.len() as u32);
        let mut first = None;
        // Ends of edges inside other bodies, with the length of the edge up to the surface.
        let mut inside: BTreeMap<(u32, u32), f64> = BTreeMap::new();
        for edge in &surface.edges {
            tree.for_each_meeting(&boxes, &bounds(&edge.ends), &mut |number| {
                if body_of(number) == surface.body_of[edge.ends[0] as usize] {
                    return;
                }
                // The point that moves along the edge meets the triangle.
                let [a, b, c] = surface.triangles[number as usize].corners.map(place);
                let [from, to] = edge.ends.map(place);
                if !paths_meet(PairKind::PointTriangle, &[from, a, b, c], &[to, a, b, c]) {
                    return;
                }
                let normal = cross(minus(b, a), minus(c, a));
                let heights = [from, to].map(|end| dot3(minus(end, a), normal));
                let change = heights[0] - heights[1];
                let part = if change == 0.0 { 0.0 } else { (heights[0] / change).clamp(0.0, 1.0) };
                let at = [0, 1, 2].map(|d| from[d] + part * (to[d] - from[d]));
                first.get_or_insert(at);
                for (end, height) in edge.ends.into_iter().zip(heights) {
                    let way = distance(place(end), at);
                    if height < 0.0 && way > TOUCH * distance(from, to) {
                        let known = inside.entry((end, body_of(number))).or_insert(way);
                        *known = known.min(way);
                    }
                }
            });
        }
        let at = first?;
        let depths = inside.into_iter().map(|((end, body), way)| {
            let end = place(end);
            // The distance, and the height above the nearest triangle; of several, above the one that faces the end.
            let mut nearest = (way, 0.0f64);
            tree.for_each_meeting(&boxes, &Bounds::of(end).inflated(way), &mut |number| {
                if body_of(number) != body {
                    return;
                }
                let [a, b, c] = surface.triangles[number as usize].corners.map(place);
                let distance = Closest::new(PairKind::PointTriangle, &[end, a, b, c]).squared_distance.sqrt();
                let normal = cross(minus(b, a), minus(c, a));
                let height = dot3(minus(end, a), normal) / dot3(normal, normal).sqrt();
                let is_as_near = distance <= nearest.0 * (1.0 + TOUCH);
                if distance < nearest.0 * (1.0 - TOUCH) || is_as_near && height.abs() > nearest.1.abs() {
                    nearest = (distance, height);
                }
            });
            (end, nearest, way)
        });
        // An edge may touch a triangle without leading inside.
        let real = depths.filter(|(_, (depth, height), way)| *height < 0.0 && *depth > TOUCH * way);
        let real = real.map(|(end, (depth, _), _)| (end, depth));
        let deepest = real.reduce(|best, next| if next.1 > best.1 { next } else { best });
        Some(Intersection { at, deepest })
    }

    /// A part of a body that lies inside a part of another one, where no surfaces intersect: the numbers of both
    /// bodies and a node of the inner part. `part_of`: the part of each node of the mesh, if the surface has its whole
    /// boundary.
    ///
    /// Inside is where the triangles of a boundary have the solid angle 4 pi together, and none in its cavities.
    pub fn enclosed(&self, part_of: impl Fn(u32) -> Option<u32>) -> Option<([u32; 2], [f64; 3])> {
        let surface = &self.surface;
        let X = self.reference_positions();
        let mut parts: BTreeMap<u32, ClosedPart> = BTreeMap::new();
        for triangle in &surface.triangles {
            let first = triangle.corners[0];
            let node = surface.entity(first).next().map(|(number, _)| surface.nodes[number]);
            let Some(part) = node.and_then(&part_of) else { continue };
            let own = parts.entry(part).or_insert_with(|| ClosedPart {
                body: surface.body_of[first as usize],
                bounds: Bounds::NONE,
                triangles: Vec::new(),
            });
            let corners = triangle.corners.map(|corner| X[corner as usize]);
            own.bounds = corners.iter().fold(own.bounds, |sum, corner| sum.with(Bounds::of(*corner)));
            own.triangles.push(corners);
        }
        let parts: Vec<ClosedPart> = parts.into_values().collect();
        let boxes: Vec<Bounds> = parts.iter().map(|part| part.bounds).collect();
        let mut tree = BoxTree::default();
        tree.fit(&boxes, 0..boxes.len() as u32);
        parts.iter().find_map(|inner| {
            let node = inner.triangles[0][0];
            let mut found = None;
            tree.for_each_meeting(&boxes, &Bounds::of(node), &mut |number| {
                let outer = &parts[number as usize];
                if found.is_none() && outer.body != inner.body && outer.winds_around(node) {
                    found = Some(([inner.body, outer.body], node));
                }
            });
            found
        })
    }
}

impl ClosedPart {
    /// Whether a point is inside. The solid angle of a triangle is that of van Oosterom and Strackee (1983).
    fn winds_around(&self, point: [f64; 3]) -> bool {
        let angle = |corners: &[[f64; 3]; 3]| {
            let [a, b, c] = corners.map(|corner| minus(corner, point));
            let [r_a, r_b, r_c] = [a, b, c].map(|arm| dot3(arm, arm).sqrt());
            let volume = dot3(a, cross(b, c));
            2.0 * volume.atan2(r_a * r_b * r_c + dot3(a, b) * r_c + dot3(b, c) * r_a + dot3(c, a) * r_b)
        };
        self.triangles.iter().map(angle).sum::<f64>() > 2.0 * PI
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let link = minus(a, b);
    dot3(link, link).sqrt()
}
