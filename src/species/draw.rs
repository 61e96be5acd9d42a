//! Random numbers that belong to a place in the tree, so that what changes elsewhere leaves them as they are.

use crate::math;
use crate::random::{self, Purpose};

/// The numbers of one axis: its key is made from that of the parent axis and its number there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draw {
    key: u64,
    next: u32,
}

impl Draw {
    pub(super) fn new(seed: u64) -> Self {
        Self { key: random::derive(seed, 0, Purpose::SPECIES), next: 0 }
    }

    /// The seed of a species' trees: two species differ at the same seed.
    pub(super) fn seed_of(latin: &str, seed: u64) -> u64 {
        latin.bytes().fold(seed, |key, byte| random::derive(key ^ u64::from(byte), 0, Purpose::SPECIES))
    }

    /// The numbers of the `index`-th thing of a kind that hangs on this.
    pub(super) fn child(&self, kind: u32, index: usize) -> Self {
        Self { key: random::derive(self.key ^ (index as u64), kind + 1, Purpose::SPECIES), next: 0 }
    }

    /// Evenly in [0, 1).
    pub(super) fn unit(&mut self) -> f32 {
        self.next += 1;
        random::unit(self.key, self.next, Purpose::SPECIES, 0)
    }

    pub(super) fn within(&mut self, [low, high]: [f32; 2]) -> f32 {
        low + (high - low) * self.unit()
    }

    /// A whole number, ends included.
    pub(super) fn whole(&mut self, [low, high]: [f32; 2]) -> usize {
        (low + (high - low + 1.0) * self.unit()).floor().min(high) as usize
    }

    /// Mean 0, standard deviation 1, within ±3.46: the sum of four even numbers, nearly normal.
    pub(super) fn normal(&mut self) -> f32 {
        let sum = self.unit() + self.unit() + self.unit() + self.unit();
        (sum - 2.0) * 1.732_050_8
    }

    /// About 1, whose logarithm has this standard deviation.
    pub(super) fn factor(&mut self, spread: f32) -> f32 {
        math::exp(spread * self.normal())
    }
}
