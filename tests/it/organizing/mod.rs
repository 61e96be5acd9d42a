//! Trees and forests that organize themselves.

mod axes;
#[cfg(feature = "json")]
mod compact;
mod dead;
mod garden;
mod growth;
mod landscape;
mod lapse;
mod light;
mod parts;
mod room;
mod sag;
#[cfg(feature = "json")]
mod saved;
mod space;
mod stands;
mod sun;
mod tended;
mod thinning;

use crate::sample::fnv1a;
use treesynth::self_organizing::{Environment, Forest};

/// Of every bit of every tree.
fn forest_hash<E: Environment>(forest: &Forest<E>) -> u64 {
    let trees = forest.trees().iter().flat_map(|tree| {
        let places = tree.positions().flat_map(|place| place.to_array().map(f32::to_bits));
        let buds = tree.buds().map(|[main, lateral]| u32::from(main) + 2 * u32::from(lateral));
        let one = [tree.number(), u32::from(tree.born()), tree.vigor().to_bits()];
        one.into_iter().chain(places).chain(buds).chain(tree.child_counts()).collect::<Vec<_>>()
    });
    fnv1a(trees.flat_map(u32::to_le_bytes))
}
