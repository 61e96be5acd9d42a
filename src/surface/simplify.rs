//! Chains of balls with as few as keep near the others.

use glam::{Vec3, Vec4};

/// Longer chains are taken in pieces, so that the time stays linear however they wind.
const LONGEST: usize = 256;

/// The numbers of the balls to keep, so that each of the others differs in place and radius together by at most
/// `error` metres from what lies between its kept neighbours (Ramer 1972, Douglas and Peucker 1973, in the four
/// dimensions of place and radius). The first and the last are kept. O(n) time for chains of any length.
pub(super) fn simplify(count: usize, ball: impl Fn(usize) -> (Vec3, f32), error: f32) -> Vec<u32> {
    let mut kept = vec![0];
    let mut ends = Vec::new();
    for start in (0..count.saturating_sub(1)).step_by(LONGEST) {
        ends.push((start + LONGEST).min(count - 1));
        let mut start = start;
        while let Some(&end) = ends.last() {
            if let Some(middle) = farthest(start, end, &ball, error) {
                ends.push(middle);
            } else {
                kept.push(end as u32);
                start = end;
                ends.pop();
            }
        }
    }
    kept
}

/// The ball that is farthest from the straight way between two others, if that is more than `error`.
fn farthest(start: usize, end: usize, ball: &impl Fn(usize) -> (Vec3, f32), error: f32) -> Option<usize> {
    let at = |i: usize| {
        let (position, radius) = ball(i);
        position.extend(radius)
    };
    let (from, to) = (at(start), at(end));
    let way: Vec4 = to - from;
    let length_squared = way.length_squared();
    let mut best = (error * error, None);
    for i in start + 1..end {
        let offset = at(i) - from;
        let t = if length_squared > 0.0 { (offset.dot(way) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
        let distance = (offset - way * t).length_squared();
        if distance > best.0 {
            best = (distance, Some(i));
        }
    }
    best.1
}
