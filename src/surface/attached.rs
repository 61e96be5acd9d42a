//! Whether each tube touches the branch that bears it, measured on the triangles.

use super::weave::Plan;
use super::{Mesh, Tubes};
use crate::Skeleton;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// The largest gap between a tube's first ring and the wood that bears it: metres, and radii of the tube.
const GAP: f64 = 2e-3;
const GAP_RADII: f64 = 0.1;
/// A gap that rounding makes, metres.
const NOTHING: f64 = 1e-5;
/// Triangles that share one box.
const CHUNK: usize = 16;

/// The tube of an axis: a closed body.
struct Tube {
    /// The vertices of its first ring.
    ring: Range<usize>,
    /// Its indices in the mesh.
    indices: Range<usize>,
    /// The number of the tube that bears it.
    parent: Option<usize>,
    /// Of its first internode, metres.
    radius: f64,
    place: Vec3,
}

/// How far off its parent branch a tube begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gap {
    /// Between the ring and the parent branch alone, metres.
    pub(super) parent: f64,
    /// Between the ring and the parent branch or what bears that, metres.
    pub(super) wood: f64,
    /// The radius of the tube.
    pub(super) radius: f64,
    pub(super) place: Vec3,
}

impl Gap {
    fn is_open(gap: f64, radius: f64) -> bool {
        gap > GAP.min(GAP_RADII * radius)
    }

    pub(super) fn is_off_its_parent(&self) -> bool {
        Self::is_open(self.parent, self.radius)
    }

    pub(super) fn floats(&self) -> bool {
        Self::is_open(self.wood, self.radius)
    }
}

/// The triangles of a tube, with boxes around each few of them.
struct Body {
    triangles: Vec<[DVec3; 3]>,
    boxes: Vec<[DVec3; 2]>,
}

impl Body {
    fn of(mesh: &Mesh, tube: &Tube) -> Self {
        let corner = |index: &u32| mesh.positions[*index as usize].as_dvec3();
        let triangles: Vec<[DVec3; 3]> = mesh.indices[tube.indices.clone()]
            .chunks_exact(3)
            .map(|indices| [corner(&indices[0]), corner(&indices[1]), corner(&indices[2])])
            .collect();
        let around = |chunk: &[[DVec3; 3]]| {
            let corners = chunk.as_flattened();
            corners.iter().fold([DVec3::MAX, DVec3::MIN], |[low, high], &p| [low.min(p), high.max(p)])
        };
        Self { boxes: triangles.chunks(CHUNK).map(around).collect(), triangles }
    }

    /// How far outside of it a point is; zero on it and within.
    fn outside(&self, point: DVec3) -> f64 {
        let distance = self.distance(point);
        if distance > NOTHING && self.holds(point) { 0.0 } else { distance }
    }

    fn distance(&self, point: DVec3) -> f64 {
        let mut best = f64::MAX;
        for (chunk, [low, high]) in self.triangles.chunks(CHUNK).zip(&self.boxes) {
            if point.distance_squared(point.clamp(*low, *high)) < best {
                for &triangle in chunk {
                    best = best.min(point.distance_squared(nearest(point, triangle)));
                }
            }
        }
        best.sqrt()
    }

    /// Whether its triangles wind around a point, from what a ray from there crosses. Several rays vote, for one may
    /// graze an edge.
    fn holds(&self, point: DVec3) -> bool {
        let ways =
            [DVec3::new(0.31, 0.53, 0.79), DVec3::new(-0.83, 0.27, 0.49), DVec3::new(0.43, -0.71, 0.56)];
        let votes = ways.iter().filter(|way| self.winding(point, **way) > 0).count();
        votes >= 2
    }

    fn winding(&self, point: DVec3, way: DVec3) -> i32 {
        let mut winding = 0;
        for (chunk, [low, high]) in self.triangles.chunks(CHUNK).zip(&self.boxes) {
            let [a, b] = [(*low - point) / way, (*high - point) / way];
            if a.min(b).max_element() > a.max(b).min_element() || a.max(b).min_element() < 0.0 {
                continue;
            }
            for [a, b, c] in chunk.iter().map(|triangle| triangle.map(|corner| corner - point)) {
                // Which side of each edge the ray passes.
                let sides = [way.dot(a.cross(b)), way.dot(b.cross(c)), way.dot(c.cross(a))];
                let facing = (b - a).cross(c - a);
                if sides.iter().all(|side| *side >= 0.0) && facing.dot(a) > 0.0 {
                    winding += 1;
                } else if sides.iter().all(|side| *side <= 0.0) && facing.dot(a) < 0.0 {
                    winding -= 1;
                }
            }
        }
        winding
    }
}

/// The point of a triangle that is nearest (Ericson 2004, "Real-Time Collision Detection", 5.1.5).
fn nearest(point: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let [d1, d2] = [ab, ac].map(|side| side.dot(point - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let [d3, d4] = [ab, ac].map(|side| side.dot(point - b));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let [d5, d6] = [ab, ac].map(|side| side.dot(point - c));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let total = va + vb + vc;
    a + ab * (vb / total) + ac * (vc / total)
}

/// The tubes of a plan, and their mesh. Their bases are closed, so that inside and outside can be told.
fn tubes(plan: &Plan, options: &Tubes) -> (Vec<Tube>, Mesh) {
    let mut tubes: Vec<Tube> = Vec::new();
    let (mut vertices, mut indices) = (0, 0);
    let mesh = plan.weave_each(&options.clone().with_closed_base(true), |axis, mesh| {
        let first = axis.base;
        let number = tubes.len();
        let parent = match axis.bearer {
            Some(node) => plan.axes.place(node).map(|(axis, _)| axis).filter(|parent| *parent != number),
            // After a sharp turn the branch goes on from the end of its last part.
            None => number.checked_sub(1).filter(|last| plan.axes.all[*last].branch == axis.branch),
        };
        let all = vertices..mesh.positions.len();
        let ring = vertices..(vertices + axis.sides as usize + 1).min(all.end);
        // A tube that begins with no radius begins with one vertex.
        let is_point = !axis.has_collar && plan.axes.stations[axis.stations.start].radius == 0.0;
        let ring = if is_point { vertices..vertices + 1 } else { ring };
        let radius = f64::from(first.radius);
        tubes.push(Tube {
            ring,
            indices: indices..mesh.indices.len(),
            parent,
            radius,
            place: first.position,
        });
        (vertices, indices) = (mesh.positions.len(), mesh.indices.len());
    });
    (tubes, mesh)
}

/// How far off its parent branch each tube of a skeleton begins.
pub(super) fn gaps(skeleton: &Skeleton, options: &Tubes) -> Vec<Gap> {
    let plan = options.plan(skeleton).expect("a skeleton with a surface");
    let (tubes, mesh) = tubes(&plan, options);
    let mut bodies: Vec<Option<Body>> = tubes.iter().map(|_| None).collect();
    let mut gaps = Vec::new();
    for tube in &tubes {
        let Some(parent) = tube.parent else { continue };
        let mut gap = Gap { parent: 0.0, wood: 0.0, radius: tube.radius, place: tube.place };
        for point in &mesh.positions[tube.ring.clone()] {
            let mut outside = |number: usize| {
                let body = bodies[number].get_or_insert_with(|| Body::of(&mesh, &tubes[number]));
                body.outside(point.as_dvec3())
            };
            let mut least = outside(parent);
            gap.parent = gap.parent.max(least);
            let mut above = tubes[parent].parent;
            while let Some(number) = above.filter(|_| least > NOTHING) {
                least = least.min(outside(number));
                above = tubes[number].parent;
            }
            gap.wood = gap.wood.max(least);
        }
        gaps.push(gap);
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets;

    fn report(name: &str, gaps: &[Gap]) {
        let count = |open: fn(&Gap) -> bool| gaps.iter().filter(|gap| open(gap)).count();
        let worst = gaps.iter().copied().max_by(|a, b| a.wood.total_cmp(&b.wood));
        println!(
            "{name}: {} tubes, {} off their parents, {} float, {} by over 1 cm, worst {worst:?}",
            gaps.len(),
            count(Gap::is_off_its_parent),
            count(Gap::floats),
            count(|gap| gap.wood > 0.01),
        );
    }

    fn nodes() -> usize {
        std::env::var("NODES").map_or(10_000, |n| n.parse().expect("a number"))
    }

    #[test]
    fn guided() {
        let mut all = Vec::new();
        for preset in presets::all() {
            let tree = preset.synth(nodes()).synthesize(preset.seed).expect("a tree");
            let gaps = gaps(&tree.relaxed(0.5, 3).expect("sound"), &Tubes::default());
            report(preset.name, &gaps);
            all.extend(gaps);
        }
        report("all", &all);
    }
}
