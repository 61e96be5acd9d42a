//! The grid of [`ShadowPropagation`](super::ShadowPropagation): integers, so that what was added can be taken away. It
//! grows with what casts shadows.

use super::slice::{Group, LANES, Rows, Slice, reach};
use crate::{math, parallel};
use glam::{IVec3, Vec3};
use std::ops::{BitOr, Range};

/// The fewest and the most parts of a full shadow, a, that a cell counts in.
const PARTS: [f32; 2] = [512.0, 729.0];
/// The faintest shadow of a pyramid has so many parts if it can. Then the default's are 1.5^6 times as many, 729, and
/// all its shadows whole.
const FAINTEST: f32 = 64.0;
/// As long as all sums of a layer are at most this it counts in 16 bits. Four full shadows more still fit, the most
/// that a node casts.
const NARROW: u16 = u16::MAX - 4 * 729;
/// The most cells on an axis and in all.
pub(super) const MOST_ON_AXIS: i32 = 65_000;
pub(super) const MOST_CELLS: u64 = 1 << 29;
/// Rows are added to a layer in such numbers.
const BAND: usize = 32;

/// Shadows by cell.
#[derive(Debug, Clone, Default)]
pub(super) struct Grid {
    /// The lowest cell.
    low: IVec3,
    /// Cells on each axis; none before there are any nodes.
    size: IVec3,
    /// Cells added on each side in x and z, so that no pyramid sticks out.
    margin: usize,
    /// Cells from one row to the next.
    stride: usize,
    /// Number of parts of a full shadow.
    parts: f32,
    falloff: f32,
    /// Directions that light comes from, and their weights; empty if from above, in whole pyramids.
    light: Vec<(Vec3, f32)>,
    /// Values that a shadow adds, by q.
    powers: Vec<Slice>,
    /// From the ground up as far as nodes are.
    layers: Vec<Layer>,
}

/// Cells of one height: rows of x, as far in z as there were ever shadows.
#[derive(Debug, Clone, PartialEq, Default)]
struct Layer {
    rows: Range<usize>,
    cells: Cells,
}

/// Row after row, and a few more that belong to none.
#[derive(Debug, Clone, PartialEq)]
enum Cells {
    /// All at most [`NARROW`].
    Narrow(Vec<u16>),
    Wide(Vec<u32>),
}

/// The cell of a node that has appeared or fallen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Caster {
    /// From the lowest cell.
    cell: [u16; 3],
    falls: bool,
}

impl Grid {
    /// Of so many cells on each axis, for pyramids of this height that are divided by `falloff` at each cell down.
    /// Shadows lean away from where light comes from, if that is said by unit vectors with weights that add up to 1.
    pub(super) fn new(size: IVec3, height: u32, falloff: f32, light: Vec<(Vec3, f32)>) -> Self {
        let margin = if light.is_empty() { height as usize } else { reach(height) as usize };
        let parts = (FAINTEST * math::powf(falloff, height as f32)).round().clamp(PARTS[0], PARTS[1]);
        let stride = size.x as usize + 2 * margin;
        let low = IVec3::ZERO;
        let mut grid =
            Self { low, size, margin, stride, parts, falloff, light, powers: Vec::new(), layers: Vec::new() };
        grid.powers = grid.powers_of(1.0, height);
        grid
    }

    /// The slices of a shadow that is so many times as dark as a full one.
    fn powers_of(&self, shade: f32, height: u32) -> Vec<Slice> {
        let slice = |q: u32| {
            let power =
                |part: f32| (self.parts * shade * math::powf(self.falloff, -(q as f32)) * part + 0.5) as u16;
            if self.light.is_empty() || q == 0 {
                Slice::of_pyramid(q, power(1.0))
            } else {
                Slice::leaning(q, &self.light, power)
            }
        };
        (0..=height).map(slice).collect()
    }

    /// The lowest cell, and one beyond the highest.
    pub(super) fn range(&self) -> (IVec3, IVec3) {
        (self.low, self.low + self.size)
    }

    /// Makes room for cells from `low` to `high`, with some to spare; false if that would be more than there can be.
    pub(super) fn fit(&mut self, low: IVec3, high: IVec3) -> bool {
        let (first, end) = self.range();
        if low.cmpge(first).all() && high.cmplt(end).all() {
            return true;
        }
        let spare = self.size / 4 + 8;
        let allowed = |low: IVec3, end: IVec3| {
            let size = end - low;
            size.max_element() <= MOST_ON_AXIS
                && size.to_array().iter().map(|&cells| cells as u64).product::<u64>() <= MOST_CELLS
        };
        let choose = |spare: IVec3| {
            let below = IVec3::select(low.cmplt(first), low - spare, first);
            let above = IVec3::select(high.cmpge(end), high + 1 + spare, end);
            (below, above)
        };
        let (mut below, mut above) = choose(spare);
        if !allowed(below, above) {
            (below, above) = choose(IVec3::ZERO);
        }
        if !allowed(below, above) {
            return false;
        }
        let stride = (above.x - below.x) as usize + 2 * self.margin;
        let (shift, aside) = ((first.z - below.z) as usize, (first.x - below.x) as usize);
        if (stride, aside, shift) != (self.stride, 0, 0) {
            for layer in &mut self.layers {
                layer.widen(self.stride, stride, aside, shift);
            }
        }
        let under = (first.y - below.y) as usize;
        self.layers.splice(0..0, (0..under).map(|_| Layer::default()));
        (self.low, self.size, self.stride) = (below, above - below, stride);
        true
    }

    /// Shadow cast from `cell`, which is in range.
    pub(super) fn caster(&self, cell: IVec3, falls: bool) -> Caster {
        Caster { cell: (cell - self.low).to_array().map(|c| c as u16), falls }
    }

    /// `true` if it is still to be made.
    pub(super) fn is_empty(&self) -> bool {
        self.powers.is_empty()
    }

    /// Number of parts of a full shadow; 1 before there are any nodes.
    #[inline]
    pub(super) fn full(&self) -> f32 {
        self.powers.first().map_or(1.0, |slice| f32::from(slice.middle()))
    }

    /// The sum in a cell, in parts; 0 outside.
    #[inline]
    pub(super) fn at(&self, cell: IVec3) -> u32 {
        // Cells outside by less than the margin exist too, others wrap to far outside.
        let (margin, cell) = (self.margin as i32, cell - self.low);
        let (x, y, z) = ((cell.x + margin) as usize, cell.y as usize, (cell.z + margin) as usize);
        match self.layers.get(y) {
            Some(layer) if x < self.stride && layer.rows.contains(&z) => layer.at(z, x, self.stride),
            _ => 0,
        }
    }

    /// Adds the pyramids of all `casters`, of this shade each, or takes them away. Sums of integers do not depend on
    /// the order.
    pub(super) fn cast(&mut self, casters: &[Caster], shade: f32) {
        let height = self.powers.len();
        let Some(top) = casters.iter().map(|caster| usize::from(caster.cell[1])).max() else { return };
        if self.layers.len() <= top {
            self.layers.resize_with(top + 1, Layer::default);
        }
        // Number of casters of each height, and the range of their z.
        let mut found = vec![(0usize, usize::MAX, 0); top + 1];
        for caster in casters {
            let (count, low, high) = &mut found[usize::from(caster.cell[1])];
            let z = usize::from(caster.cell[2]) + self.margin;
            (*count, *low, *high) = (*count + 1, z.min(*low), z.max(*high));
        }
        // Their slices in each layer: cells to add to and rows.
        let slices = &self.powers;
        let shades: Vec<(usize, Range<usize>)> = (0..=top)
            .map(|y| {
                let above = found[y..].iter().take(height).enumerate().filter(|(_, found)| found.0 > 0);
                let none = Range { start: usize::MAX, end: 0 };
                above.fold((0, none), |(cells, rows), (q, &(count, low, high))| {
                    let slice = &slices[q];
                    let first = low.wrapping_add_signed(slice.z as isize);
                    let end = high.wrapping_add_signed(slice.z as isize) + slice.count;
                    (cells + count * slice.cells(), rows.start.min(first)..rows.end.max(end))
                })
            })
            .collect();
        // Layers next to each other are a task.
        let tasks = parallel::tasks();
        let share = shades.iter().map(|shade| shade.0).sum::<usize>() / tasks;
        let other = (shade.to_bits() != 1f32.to_bits()).then(|| self.powers_of(shade, height as u32 - 1));
        let (margin, stride, powers) = (self.margin, self.stride, other.as_ref().unwrap_or(&self.powers));
        let most = self.size.z as usize + 2 * margin;
        let mut rest = &mut self.layers[..=top];
        let mut parts = Vec::new();
        let (mut first, mut cells) = (0, 0);
        for (y, shade) in shades.iter().enumerate() {
            cells += shade.0;
            if cells > share || y == top {
                let (part, others) = rest.split_at_mut(y + 1 - first);
                parts.push((first, part));
                (rest, first, cells) = (others, y + 1, 0);
            }
        }
        parallel::each_mut(&mut parts, |_, (first, layers)| {
            for (layer, (_, rows)) in layers.iter_mut().zip(&shades[*first..]) {
                layer.reserve(rows, stride, most);
            }
            for caster in casters {
                let [x, y, z] = caster.cell.map(usize::from);
                let (x, z) = (x + margin, z + margin);
                let last = *first + layers.len() - 1;
                if y < *first || y >= last + height {
                    continue;
                }
                for q in y.saturating_sub(last)..(y - *first + 1).min(height) {
                    let layer = &mut layers[y - q - *first];
                    let slice = &powers[q];
                    let z = z.wrapping_add_signed(slice.z as isize);
                    let x = x.wrapping_add_signed(slice.x as isize);
                    if caster.falls {
                        layer.add::<true>(z, x, stride, slice);
                    } else {
                        layer.add::<false>(z, x, stride, slice);
                    }
                }
            }
        });
    }
}

impl Default for Cells {
    fn default() -> Self {
        Self::Narrow(Vec::new())
    }
}

/// Grids are equal if their shadows are, whatever room they have.
impl PartialEq for Grid {
    fn eq(&self, other: &Self) -> bool {
        let holds = |one: &Self, other: &Self| {
            one.layers.iter().enumerate().all(|(y, layer)| {
                layer.rows.clone().all(|z| {
                    (0..one.stride).all(|x| {
                        let at = IVec3::new(x as i32, y as i32, z as i32)
                            - IVec3::new(one.margin as i32, 0, one.margin as i32);
                        layer.at(z, x, one.stride) == other.at(at + one.low)
                    })
                })
            })
        };
        holds(self, other) && holds(other, self)
    }
}

impl Layer {
    /// Gives each row `stride` cells, of which the old ones are those from `aside` on, and moves rows by `shift` in z.
    fn widen(&mut self, old: usize, stride: usize, aside: usize, shift: usize) {
        if self.rows.is_empty() {
            return;
        }
        match &mut self.cells {
            Cells::Narrow(cells) => *cells = widened(cells, old, stride, aside, self.rows.len()),
            Cells::Wide(cells) => *cells = widened(cells, old, stride, aside, self.rows.len()),
        }
        self.rows = self.rows.start + shift..self.rows.end + shift;
    }

    #[inline]
    fn at(&self, z: usize, x: usize, stride: usize) -> u32 {
        let place = (z - self.rows.start) * stride + x;
        match &self.cells {
            Cells::Narrow(cells) => u32::from(cells[place]),
            Cells::Wide(cells) => cells[place],
        }
    }

    /// Makes room for `rows`, of which there are `most`.
    fn reserve(&mut self, rows: &Range<usize>, stride: usize, most: usize) {
        let has = &self.rows;
        if rows.is_empty() || has.start <= rows.start && rows.end <= has.end {
            return;
        }
        let rows =
            if has.is_empty() { rows.clone() } else { rows.start.min(has.start)..rows.end.max(has.end) };
        // Bands are counted from where the grid began, so rows that were there before it grew may lie across.
        let rows = rows.start / BAND * BAND..(rows.end.div_ceil(BAND) * BAND).min(most).max(rows.end);
        let (len, from) = (rows.len() * stride, has.start.saturating_sub(rows.start) * stride);
        match &mut self.cells {
            Cells::Narrow(cells) => *cells = moved(cells, len, from),
            Cells::Wide(cells) => *cells = moved(cells, len, from),
        }
        self.rows = rows;
    }

    /// Adds a slice of a shadow from `z` and `x` on, or takes it away.
    #[inline]
    fn add<const FALLS: bool>(&mut self, z: usize, x: usize, stride: usize, slice: &Slice) {
        let start = (z - self.rows.start) * stride + x;
        match &mut self.cells {
            Cells::Narrow(cells) => {
                if add_slice::<u16, FALLS>(&mut cells[start..], stride, slice) {
                    self.cells = Cells::Wide(cells.iter().map(|&sum| u32::from(sum)).collect());
                }
            }
            Cells::Wide(cells) => {
                add_slice::<u32, FALLS>(&mut cells[start..], stride, slice);
            }
        }
    }
}

/// `len` cells, those there were from `from` on.
fn moved<T: Copy + Default>(cells: &[T], len: usize, from: usize) -> Vec<T> {
    // The last group of the last row may reach beyond it.
    let mut moved = vec![T::default(); len + LANES];
    let old = cells.len().saturating_sub(LANES);
    moved[from..from + old].copy_from_slice(&cells[..old]);
    moved
}

/// `rows` rows of `old` cells as rows of `stride`, the old cells from `aside` on.
fn widened<T: Copy + Default>(cells: &[T], old: usize, stride: usize, aside: usize, rows: usize) -> Vec<T> {
    let mut wide = vec![T::default(); rows * stride + LANES];
    for (from, to) in cells.chunks_exact(old).zip(wide.chunks_exact_mut(stride)).take(rows) {
        to[aside..aside + old].copy_from_slice(from);
    }
    wide
}

/// Unit of the cells' counts.
trait Sum: Copy + Default + Eq + BitOr<Output = Self> + From<u16> {
    fn plus(self, power: Self) -> Self;

    fn minus(self, power: Self) -> Self;

    /// Not zero if there may soon be no room for more.
    fn excess(self) -> Self;
}

impl Sum for u16 {
    #[inline]
    fn plus(self, power: u16) -> u16 {
        self.wrapping_add(power)
    }

    #[inline]
    fn minus(self, power: u16) -> u16 {
        self.wrapping_sub(power)
    }

    #[inline]
    fn excess(self) -> u16 {
        self.saturating_sub(NARROW)
    }
}

impl Sum for u32 {
    #[inline]
    fn plus(self, power: u32) -> u32 {
        self.wrapping_add(power)
    }

    #[inline]
    fn minus(self, power: u32) -> u32 {
        self.wrapping_sub(power)
    }

    #[inline]
    fn excess(self) -> u32 {
        0
    }
}

/// Adds a slice to the cells from its first on, or takes it away. Whether there may soon be no room for more.
#[inline]
fn add_slice<T: Sum, const FALLS: bool>(cells: &mut [T], stride: usize, slice: &Slice) -> bool {
    match &slice.rows {
        Rows::Same(row) => add_square::<T, FALLS>(cells, stride, slice.count / 2, row),
        Rows::Each(rows) => {
            let mut excess = false;
            for (z, row) in rows.iter().enumerate() {
                for (i, group) in row.chunks(1).enumerate() {
                    excess |= add_rows::<T, FALLS, 1, 1>(&mut cells[z * stride + i * LANES..], stride, group);
                }
            }
            excess
        }
    }
}

/// Adds `powers` to the first cells of 2q + 1 rows, or takes them away. Whether there may soon be no room for more.
///
/// Not inline: in the loop over q it would have to keep numbers for each of its arms in step.
#[inline(never)]
fn add_square<T: Sum, const FALLS: bool>(cells: &mut [T], stride: usize, q: usize, powers: &[Group]) -> bool {
    // Fixed sizes make straight code; few have a pyramid higher than 7 cells.
    match (q, powers) {
        (0, [_]) => add_rows::<T, FALLS, 1, 1>(cells, stride, powers),
        (1, [_]) => add_rows::<T, FALLS, 3, 1>(cells, stride, powers),
        (2, [_]) => add_rows::<T, FALLS, 5, 1>(cells, stride, powers),
        (3, [_]) => add_rows::<T, FALLS, 7, 1>(cells, stride, powers),
        (4, [_, _]) => add_rows::<T, FALLS, 9, 2>(cells, stride, powers),
        (5, [_, _]) => add_rows::<T, FALLS, 11, 2>(cells, stride, powers),
        (6, [_, _]) => add_rows::<T, FALLS, 13, 2>(cells, stride, powers),
        (7, [_, _]) => add_rows::<T, FALLS, 15, 2>(cells, stride, powers),
        _ => (0..=2 * q).fold(false, |excess, row| {
            powers.chunks(1).enumerate().fold(excess, |excess, (i, power)| {
                excess | add_rows::<T, FALLS, 1, 1>(&mut cells[row * stride + i * LANES..], stride, power)
            })
        }),
    }
}

#[inline]
fn add_rows<T: Sum, const FALLS: bool, const ROWS: usize, const GROUPS: usize>(
    cells: &mut [T],
    stride: usize,
    powers: &[Group],
) -> bool {
    let powers: &[Group] = &powers[..GROUPS];
    let mut excess = [T::default(); LANES];
    let cells = &mut cells[..(ROWS - 1) * stride + GROUPS * LANES];
    for row in 0..ROWS {
        let row = &mut cells[row * stride..][..GROUPS * LANES];
        for (group, powers) in row.as_chunks_mut::<LANES>().0.iter_mut().zip(powers) {
            if FALLS {
                *group = std::array::from_fn(|i| group[i].minus(T::from(powers[i])));
            } else {
                *group = std::array::from_fn(|i| group[i].plus(T::from(powers[i])));
                excess = std::array::from_fn(|i| excess[i] | group[i].excess());
            }
        }
    }
    excess.iter().fold(T::default(), |all, excess| all | *excess) != T::default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::self_organizing::Daylight;
    use proptest::prelude::*;

    const SIZE: IVec3 = IVec3::new(11, 9, 70);

    /// Sum of what the nodes in `cells` add to `at`, one by one.
    fn brute_force(grid: &Grid, cells: &[IVec3], at: IVec3) -> u32 {
        let power = |cell: &IVec3| {
            let q = usize::try_from(cell.y - at.y).ok().filter(|&q| q < grid.powers.len())?;
            let slice = &grid.powers[q];
            let (x, z) = (at.x - cell.x - slice.x, at.z - cell.z - slice.z);
            match &slice.rows {
                Rows::Same(_) => {
                    let inside = (x.max(z) <= 2 * q as i32) && x.min(z) >= 0;
                    inside.then(|| u32::from(slice.middle()))
                }
                Rows::Each(rows) => {
                    let row = rows.get(usize::try_from(z).ok()?)?;
                    let x = usize::try_from(x).ok()?;
                    row.get(x / LANES).map(|group| u32::from(group[x % LANES]))
                }
            }
        };
        cells.iter().filter_map(power).sum()
    }

    fn assert_sums(grid: &Grid, cells: &[IVec3]) {
        for y in -1..=SIZE.y {
            for z in 0..SIZE.z {
                for x in 0..SIZE.x {
                    let at = IVec3::new(x, y, z);
                    let sum = if y < 0 { 0 } else { brute_force(grid, cells, at) };
                    assert_eq!(grid.at(at), sum, "{at}");
                }
            }
        }
    }

    fn casters(grid: &Grid, cells: &[IVec3], falls: bool) -> Vec<Caster> {
        cells.iter().map(|&cell| grid.caster(cell, falls)).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

        /// Also where so much shade falls that 16 bits are too few.
        #[test]
        fn sums_are_exact_through_growth_and_fall(
            height in 0u32..12, threads in 1usize..4, dense in 0i32..300, latitude in prop::option::of(-1.5f32..1.5),
            cells in prop::collection::vec((0..SIZE.x, 0..SIZE.y, 0..SIZE.z), 1..60), part in any::<prop::sample::Index>(),
        ) {
            let mut cells: Vec<IVec3> = cells.into_iter().map(IVec3::from).collect();
            let place = cells[0];
            cells.extend((0..dense).map(|i| IVec3::new(place.x, (place.y + i % 2).min(SIZE.y - 1), place.z)));
            let kept = part.index(cells.len());
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| {
                let light = latitude.map_or_else(Vec::new, |at| Daylight::at_latitude(at).directions());
                let mut grid = Grid::new(SIZE, height, 1.3, light);
                for some in cells.chunks(50) {
                    grid.cast(&casters(&grid, some, false), 1.0);
                }
                assert_sums(&grid, &cells);
                grid.cast(&casters(&grid, &cells[kept..], true), 1.0);
                assert_sums(&grid, &cells[..kept]);
            });
        }
    }

    /// A leaning shadow is as dark at each depth as the pyramid, but for what is cut off, and falls away from the light.
    #[test]
    fn leaning_shadows_are_as_dark_as_the_pyramid() {
        let sum = |slice: &Slice| match &slice.rows {
            Rows::Same(_) => slice.cells() as f32 * f32::from(slice.middle()),
            Rows::Each(rows) => rows.iter().flatten().flatten().map(|&power| f32::from(power)).sum(),
        };
        for latitude in [-0.9f32, 0.0, 0.4, 0.9] {
            let light = Daylight::at_latitude(latitude).directions();
            let (leaning, plain) = (Grid::new(SIZE, 6, 1.5, light), Grid::new(SIZE, 6, 1.5, Vec::new()));
            for (one, other) in leaning.powers.iter().zip(&plain.powers) {
                let part = sum(one) / sum(other);
                assert!((0.93..1.01).contains(&part), "{} for {} at {latitude}", sum(one), sum(other));
            }
            let last = &leaning.powers[6];
            let Rows::Each(rows) = &last.rows else { panic!("it leans") };
            let along = rows
                .iter()
                .zip(last.z..)
                .map(|(row, z)| row.iter().flatten().map(|&power| f32::from(power)).sum::<f32>() * z as f32);
            let mean = along.sum::<f32>() / sum(last);
            assert!(
                // In the tropics the sun is on both sides of the zenith.
                if latitude.abs() < 0.5 { mean.abs() < 0.2 } else { mean * latitude < -0.3 * latitude.abs() },
                "{mean}"
            );
        }
    }

    #[test]
    fn only_layers_in_deep_shade_are_wide() {
        let mut grid = Grid::new(SIZE, 2, 8.0, Vec::new());
        assert_eq!(grid.powers.iter().map(Slice::middle).collect::<Vec<_>>(), [729, 91, 11]);
        let node = casters(&grid, &[IVec3::new(5, 5, 30)], false);
        let wide = |grid: &Grid| -> Vec<usize> {
            let layers = grid.layers.iter().enumerate();
            layers.filter(|(_, layer)| matches!(layer.cells, Cells::Wide(_))).map(|(y, _)| y).collect()
        };
        for nodes in 1..=1000 {
            grid.cast(&node, 1.0);
            let expected: &[usize] = match nodes {
                0..=85 => &[],
                86..=688 => &[5],
                _ => &[4, 5],
            };
            assert_eq!(wide(&grid), expected, "{nodes} nodes");
            assert_eq!(grid.at(IVec3::new(5, 5, 30)), nodes * 729);
        }
        // There are cells where there is shade only, in whole bands.
        let rows: Vec<_> = grid.layers.iter().map(|layer| layer.rows.clone()).collect();
        assert_eq!(rows, [0..0, 0..0, 0..0, 0..2 * BAND, 0..2 * BAND, BAND..2 * BAND]);
    }
}
