//! Whole pipelines of the guided system, whose options are drawn with the bytes as a seed.

use super::Target;
use treesynth::testing::options;
use treesynth::testing::proptest::strategy::{Strategy as _, ValueTree as _};
use treesynth::testing::proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

pub(super) fn all() -> Vec<Target> {
    let target = |name, run| Target { name, seeds: vec![vec![0x5a; 256], (0..=255).collect()], run };
    vec![target("pipeline", pipeline)]
}

fn pipeline(bytes: &[u8]) -> bool {
    let mut seed = [0u8; 32];
    bytes
        .iter()
        .zip(0usize..)
        .for_each(|(&byte, at)| seed[at % 32] = seed[at % 32].wrapping_mul(3).wrapping_add(byte));
    let random = TestRng::from_seed(RngAlgorithm::ChaCha, &seed);
    let mut runner = TestRunner::new_with_rng(Config::default(), random);
    let Ok(tree) = options().new_tree(&mut runner) else { return false };
    let options = tree.current();
    let Ok(tree) = options.synth().synthesize(1) else { return false };
    assert_eq!(tree.check(), Ok(()));
    true
}
