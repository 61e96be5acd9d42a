//! A hierarchy of bounding boxes over points, without pointers.

use glam::Vec3;
use smallvec::SmallVec;

/// Points in spatial order, in groups of [`WIDTH`]; the boxes of a level in groups of `WIDTH` make the next.
#[derive(Debug)]
pub(super) struct Bvh<'a> {
    positions: &'a [Vec3],
    /// The points' numbers in Morton order.
    order: Vec<u32>,
    /// Boxes (min, max), the finest level first, the last level a single group.
    levels: Vec<Vec<(Vec3, Vec3)>>,
}

const WIDTH: usize = 8;

/// Boxes to visit: (squared distance at least, level, number). Eight levels of boxes fit without allocation.
type Stack = SmallVec<[(f32, u32, u32); 64]>;

impl<'a> Bvh<'a> {
    /// O(n log n); O(n) for points that are in Morton order already.
    pub(super) fn new(positions: &'a [Vec3]) -> Self {
        let (min, max) = positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), &p| (min.min(p), max.max(p)));
        let scale = (1u32 << 21) as f32 / (max - min).max_element().max(f32::MIN_POSITIVE);
        let mut keyed: Vec<(u64, u32)> =
            positions.iter().zip(0..).map(|(&p, i)| (morton(((p - min) * scale).to_array()), i)).collect();
        keyed.sort_unstable();
        let order: Vec<u32> = keyed.into_iter().map(|(_, i)| i).collect();
        let mut levels: Vec<Vec<(Vec3, Vec3)>> = vec![
            order
                .chunks(WIDTH)
                .map(|group| enclose(group.iter().map(|&i| (positions[i as usize], positions[i as usize]))))
                .collect(),
        ];
        while let Some(level) = levels.last().filter(|level| level.len() > WIDTH) {
            let coarser = level.chunks(WIDTH).map(|group| enclose(group.iter().copied())).collect();
            levels.push(coarser);
        }
        Self { positions, order, levels }
    }

    /// The point nearest to `from` among those `accept` lets through, nearer than `best` = (squared distance,
    /// number); ties go to the lower number. `skip` says that a box (min, max) holds no acceptable point.
    pub(super) fn nearest(
        &self,
        from: Vec3,
        mut best: (f32, u32),
        skip: impl Fn(Vec3, Vec3) -> bool,
        accept: impl Fn(Vec3, u32) -> bool,
    ) -> (f32, u32) {
        let top = self.levels.len() - 1;
        let mut stack = Stack::new();
        let push_group = |stack: &mut Stack, level: usize, first: usize, best: f32| {
            let begin = stack.len();
            let boxes = &self.levels[level];
            for (i, &(min, max)) in
                boxes.iter().enumerate().take((first + WIDTH).min(boxes.len())).skip(first)
            {
                // A little low, so that rounding never hides a point at the very border.
                let bound = (from.clamp(min, max)).distance_squared(from) * 0.999_999;
                if bound <= best && !skip(min, max) {
                    stack.push((bound, level as u32, i as u32));
                }
            }
            // The nearest on top.
            stack[begin..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        };
        push_group(&mut stack, top, 0, best.0);
        while let Some((bound, level, index)) = stack.pop() {
            if bound > best.0 {
                continue;
            }
            let first = index as usize * WIDTH;
            if level > 0 {
                push_group(&mut stack, level as usize - 1, first, best.0);
                continue;
            }
            for &number in &self.order[first..(first + WIDTH).min(self.order.len())] {
                let position = self.positions[number as usize];
                let distance = position.distance_squared(from);
                if (distance, number) < best && accept(position, number) {
                    best = (distance, number);
                }
            }
        }
        best
    }
}

fn enclose(boxes: impl Iterator<Item = (Vec3, Vec3)>) -> (Vec3, Vec3) {
    boxes.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), (a, b)| (min.min(a), max.max(b)))
}

/// Interleaves the bits of three coordinates of at most 21 bits, so that near points get near numbers.
pub(super) fn morton(cell: [f32; 3]) -> u64 {
    let spread = |x: f32| {
        let mut v = u64::from((x as u32).min((1 << 21) - 1));
        v = (v | v << 32) & 0x001f_0000_0000_ffff;
        v = (v | v << 16) & 0x001f_0000_ff00_00ff;
        v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
        v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
        (v | v << 2) & 0x1249_2492_4924_9249
    };
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}
