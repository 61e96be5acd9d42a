//! Numbers made of bytes: those that break programs more often than others.

/// Takes numbers from bytes; zeros when there are no more.
pub(super) struct Numbers<'a>(pub(super) &'a [u8]);

const ODD: [f32; 24] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.0,
    10.0,
    1e-3,
    1e3,
    1e-6,
    1e6,
    1e-20,
    1e20,
    1e-45,
    f32::MIN_POSITIVE,
    f32::EPSILON,
    f32::MAX,
    f32::MIN,
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    16_777_216.0,
    4_294_967_296.0,
    std::f32::consts::PI,
];

impl Numbers<'_> {
    pub(super) fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    fn four(&mut self) -> [u8; 4] {
        [self.byte(), self.byte(), self.byte(), self.byte()]
    }

    /// One option in eight or so is set.
    pub(super) fn is_set(&mut self) -> bool {
        self.byte() > 220
    }

    /// An odd number, one in a usual range, or any bits.
    pub(super) fn float(&mut self) -> f32 {
        match self.byte() {
            kind @ 0..=127 => ODD[kind as usize % ODD.len()],
            128..=223 => f32::from(self.byte()) / 64.0,
            _ => f32::from_le_bytes(self.four()),
        }
    }

    pub(super) fn count(&mut self) -> u32 {
        match self.byte() {
            0..=15 => u32::MAX,
            16..=31 => 0,
            32..=47 => u32::from_le_bytes(self.four()),
            few => u32::from(few) - 48,
        }
    }
}
