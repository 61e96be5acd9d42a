//! Thickness of wood: the pipe model, with rings that stay.

use super::architecture::Architecture;

/// The least and the greatest exponent. Within them the cross-sections of two branches of a fork are together
/// 1 to 1.12 times that of their parent branch.
const EXPONENTS: [f64; 2] = [2.0, 2.4];
/// Least and greatest radius of twigs, as multiples of the species' own: within them it is changed so that
/// the trunk gets its thickness.
const TWIGS: [f32; 2] = [0.5, 1.5];

/// The part of a pipe with which a shoot comes out of its bud: so that both that come from the end of last year's shoot are
/// together as thick as that end.
const LEAST: f64 = 0.45;

/// The radius of wood by its pipes: `r = r_1 n^(1/a)`, Shinozaki and others 1964.
#[derive(Debug, Clone, Copy)]
pub(super) struct Thickness {
    /// Radius of a single pipe, metres.
    twig: f32,
    /// 1 / a.
    power: f64,
}

impl Thickness {
    /// Chosen so that the trunk base at the greatest age, with `pipes` pipes, is as thick as the species says
    /// for its length.
    pub(super) fn new(architecture: &Architecture, trunk_length: f32, pipes: f64) -> Self {
        let base =
            architecture.stoutness * trunk_length * (trunk_length / architecture.longest_branch).sqrt();
        let ratio = f64::from(base.max(architecture.twig_radius) / architecture.twig_radius);
        let pipes = pipes.max(1.0);
        let wanted = if ratio > 1.0 { libm::log(pipes) / libm::log(ratio) } else { EXPONENTS[1] };
        let exponent = wanted.clamp(EXPONENTS[0], EXPONENTS[1]);
        let power = 1.0 / exponent;
        let needed = base / libm::pow(pipes, power) as f32;
        let [least, most] = TWIGS.map(|times| times * architecture.twig_radius);
        Self { twig: needed.clamp(least, most), power }
    }

    /// Metres; never 0, not even of a shoot that begins to unfold.
    pub(super) fn radius(&self, pipes: f64) -> f32 {
        self.twig * libm::pow(pipes.max(LEAST), self.power) as f32
    }
}
