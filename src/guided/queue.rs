//! The frontier of a search: nodes by cost, and by number where costs tie.
//!
//! A heap of the whole frontier takes a third of a search's time, so the frontier lies unordered in buckets of
//! nearly equal costs, and only the bucket that the search has come to is sorted. Buckets cover what the frontier
//! holds at a time; when all of them have been opened they are laid out anew. The order is exact, whatever the costs:
//! the bucket of a cost never falls as the cost rises.

use std::collections::BinaryHeap;

/// Entries of a bucket, on average; half and a quarter as many are 4% slower. The entries of a bucket are
/// worked out together.
const FILL: usize = 64;

/// Range of costs that the buckets cover, in ranges of most of the frontier; the rest is for nodes
/// that come while buckets are opened.
const WIDEN: usize = 2;

/// (cost, node) in one number whose order is theirs reversed, for both `Vec` and `BinaryHeap` pop the largest. The
/// bits of floats that are not negative are in the floats' order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry(u64);

impl Entry {
    #[inline]
    fn new(cost: f32, node: u32) -> Self {
        Self(!(u64::from(cost.to_bits()) << 32 | u64::from(node)))
    }

    #[inline]
    pub(super) fn node(self) -> u32 {
        !self.0 as u32
    }

    #[inline]
    pub(super) fn cost(self) -> f32 {
        f32::from_bits((!self.0 >> 32) as u32)
    }
}

/// Entries of a block: two lines of the cache.
const BLOCK: usize = 16;
/// No block.
const NONE: u32 = u32::MAX;

/// Lists that share their memory, in blocks: how full a bucket gets differs widely, and lists of their own would
/// need six times as much.
#[derive(Debug, Clone, Default)]
struct Buckets {
    /// The last block of each bucket, and the bucket's length.
    ends: Vec<(u32, u32)>,
    blocks: Vec<[Entry; BLOCK]>,
    /// The block before each block in its bucket.
    before: Vec<u32>,
    /// Blocks that no bucket has.
    free: Vec<u32>,
}

impl Buckets {
    /// Makes `count` empty buckets; all present ones must be empty.
    fn reset(&mut self, count: usize) {
        self.ends.clear();
        self.ends.resize(count, (NONE, 0));
    }

    #[inline]
    fn push(&mut self, bucket: usize, entry: Entry) {
        let (block, len) = &mut self.ends[bucket];
        if (*len as usize).is_multiple_of(BLOCK) {
            let new = self.free.pop().unwrap_or_else(|| {
                self.blocks.push([entry; BLOCK]);
                self.before.push(NONE);
                self.blocks.len() as u32 - 1
            });
            self.before[new as usize] = *block;
            *block = new;
        }
        self.blocks[*block as usize][*len as usize % BLOCK] = entry;
        *len += 1;
    }

    fn len(&self, bucket: usize) -> usize {
        self.ends[bucket].1 as usize
    }

    /// Empties a bucket.
    fn drain(&mut self, bucket: usize, mut each: impl FnMut(Entry)) {
        let (mut block, mut len) = std::mem::replace(&mut self.ends[bucket], (NONE, 0));
        while len > 0 {
            let filled = (len as usize - 1) % BLOCK + 1;
            self.blocks[block as usize][..filled].iter().for_each(|&entry| each(entry));
            self.free.push(block);
            (block, len) = (self.before[block as usize], len - filled as u32);
        }
    }
}

/// A priority queue of nodes by cost, for costs at least 0 and finite. Its memory is kept when it empties.
#[derive(Debug, Clone, Default)]
pub(super) struct Queue {
    /// The opened bucket, the least cost last.
    opened: Vec<Entry>,
    /// Entries that came later, but belong into a bucket that has been opened.
    late: BinaryHeap<Entry>,
    buckets: Buckets,
    /// The first bucket that has not been opened.
    next: usize,
    /// The buckets in use.
    count: usize,
    /// The cost that the first bucket begins at.
    base: f32,
    /// Buckets per unit of cost.
    scale: f32,
    /// Entries behind all buckets.
    far: Vec<Entry>,
}

impl Queue {
    pub(super) fn clear(&mut self) {
        self.opened.clear();
        self.late.clear();
        (self.next..self.count).for_each(|bucket| self.buckets.drain(bucket, |_| ()));
        self.far.clear();
        (self.next, self.count) = (0, 0);
    }

    #[inline]
    pub(super) fn push(&mut self, cost: f32, node: u32) {
        let (entry, bucket) = (Entry::new(cost, node), self.bucket(cost));
        if bucket >= self.count {
            self.far.push(entry);
        } else if bucket >= self.next {
            self.buckets.push(bucket, entry);
        } else {
            self.late.push(entry);
        }
    }

    /// Never falls as the cost rises. NaN, which is zero times infinity where all costs are one, becomes 0.
    #[inline]
    fn bucket(&self, cost: f32) -> usize {
        ((cost - self.base) * self.scale) as usize
    }

    /// The least cost and its node. `keep` is asked about entries when their bucket is opened, soon before they are
    /// popped; those it does not keep are gone.
    #[inline]
    pub(super) fn pop(&mut self, mut keep: impl FnMut(f32, u32) -> bool) -> Option<(f32, u32)> {
        loop {
            if let Some((cost, node, _)) = self.pop_opened() {
                return Some((cost, node));
            }
            self.open(&mut keep)?;
        }
    }

    /// The least cost and its node in the bucket that is open, `None` when it is empty; and the entry's place in
    /// [`opened`](Self::opened), unless it came late.
    #[inline]
    pub(super) fn pop_opened(&mut self) -> Option<(f32, u32, Option<usize>)> {
        let least = match self.late.peek() {
            Some(late) if self.opened.last().is_none_or(|opened| opened < late) => (self.late.pop()?, None),
            _ => (self.opened.pop()?, Some(self.opened.len())),
        };
        let (entry, place) = least;
        Some((entry.cost(), entry.node(), place))
    }

    /// Rest of the open bucket, the least cost last.
    #[inline]
    pub(super) fn opened(&self) -> &[Entry] {
        &self.opened
    }

    /// Opens the next bucket; `None` when nothing is left.
    pub(super) fn open(&mut self, keep: &mut impl FnMut(f32, u32) -> bool) -> Option<()> {
        while self.next == self.count {
            self.lay_out()?;
        }
        // Without a branch, for which are kept cannot be foretold.
        let (first, mut kept) = (self.opened.len(), self.opened.len());
        self.opened.resize(first + self.buckets.len(self.next), Entry(0));
        let opened = &mut self.opened;
        self.buckets.drain(self.next, |entry| {
            opened[kept] = entry;
            kept += usize::from(keep(entry.cost(), entry.node()));
        });
        self.opened.truncate(kept);
        self.opened.sort_unstable();
        self.next += 1;
        Some(())
    }

    /// New buckets for what is far, but for the highest costs: if they are few they would make the buckets too wide.
    fn lay_out(&mut self) -> Option<()> {
        let last = self.far.len().checked_sub(1)?;
        // High costs come first.
        let (_, high, low) = self.far.select_nth_unstable(last / 8);
        let high = high.cost();
        self.base = low.iter().map(|entry| entry.cost()).fold(high, f32::min);
        let count = self.far.len().div_ceil(FILL);
        self.count = count * WIDEN;
        self.next = 0;
        // Infinite where all costs are one: they have the first bucket to themselves.
        self.scale = count as f32 / (high - self.base);
        self.buckets.reset(self.count);
        let mut far = std::mem::take(&mut self.far);
        far.retain(|&entry| {
            let bucket = self.bucket(entry.cost());
            let is_far = bucket >= self.count;
            if !is_far {
                self.buckets.push(bucket, entry);
            }
            is_far
        });
        self.far = far;
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    /// Costs as they come about: many that tie, tiny and huge ones, those of a usual search.
    fn cost() -> impl Strategy<Value = f32> {
        prop_oneof![
            Just(0.0f32),
            (0u8..4).prop_map(f32::from),
            0.0f32..10.0,
            Just(f32::from_bits(1)),
            Just(f32::MAX),
            any::<f32>().prop_filter("finite", |cost| cost.is_finite()).prop_map(f32::abs),
        ]
    }

    proptest! {
        #[test]
        fn pops_in_the_order_of_a_sorted_set(
            rounds in prop::collection::vec((prop::collection::vec(cost(), 0..200), 0usize..250), 1..20),
        ) {
            let (mut queue, mut sorted) = (Queue::default(), BTreeSet::new());
            let mut node = 0;
            for (pushed, pops) in rounds {
                for cost in pushed {
                    queue.push(cost, node);
                    sorted.insert((cost.to_bits(), node));
                    node += 1;
                }
                for _ in 0..pops {
                    let popped = queue.pop(|_, _| true).map(|(cost, node)| (cost.to_bits(), node));
                    prop_assert_eq!(popped, sorted.pop_first());
                }
            }
            queue.clear();
            prop_assert_eq!(queue.pop(|_, _| true), None);
        }

        #[test]
        fn what_is_not_kept_is_gone(costs in prop::collection::vec(cost(), 0..300)) {
            let mut queue = Queue::default();
            for (node, &cost) in costs.iter().enumerate() {
                queue.push(cost, node as u32);
            }
            let even: Vec<u32> = std::iter::from_fn(|| queue.pop(|_, node| node % 2 == 0)).map(|(_, node)| node).collect();
            prop_assert!(even.iter().all(|node| node % 2 == 0));
            prop_assert_eq!(even.len(), costs.len().div_ceil(2));
        }
    }
}
