//! Trees after examples of any form: an error that says why there are none, or sound trees.

use super::Target;
use super::numbers::Numbers;
use super::options::{seeds, tree};
use treesynth::Skeleton;
use treesynth::glam::Vec3;
use treesynth::guided::Example;

pub(super) fn all() -> Vec<Target> {
    vec![Target { name: "example", seeds: seeds(400), run: example }]
}

/// Up to sixty nodes that mostly go up and aside, borne by any before them.
fn bush(n: &mut Numbers<'_>) -> Option<Skeleton> {
    let count = 2 + u32::from(n.byte() % 60);
    let (mut places, mut parents) = (vec![Vec3::ZERO], vec![None]);
    for node in 1..count {
        let parent = if n.is_set() { u32::from(n.byte()) % node } else { node - 1 };
        let [x, y, z] = [(); 3].map(|()| f32::from(n.byte()) / 256.0);
        let way = if n.is_set() { Vec3::splat(n.float()) } else { Vec3::new(x - 0.5, y, z - 0.5) };
        places.push(places[parent as usize] + way);
        parents.push(Some(parent));
    }
    let tree = Skeleton::new(places, parents).ok()?;
    let radii = (0..count).map(|_| f32::from(n.byte()) / 256.0).collect();
    tree.with_radii(radii).ok()
}

fn example(bytes: &[u8]) -> bool {
    let mut n = Numbers(bytes);
    let tree = if n.byte() < 160 { bush(&mut n) } else { tree(&mut n) };
    let Some(tree) = tree else { return false };
    let Ok(example) = Example::of(&tree) else { return false };
    for order in example.orders() {
        assert!(order.length.is_finite() && order.angle.is_finite() && order.bend.is_finite(), "{order:?}");
    }
    let nodes = if n.is_set() { n.count() as usize } else { 300 };
    let nodes = if nodes > 1_000 && nodes < 1 << 28 { nodes % 1_000 } else { nodes };
    let Ok(example) = example.tuned(nodes, u32::from(n.byte() % 3)) else { return false };
    let Ok(grown) = example.grow(nodes, 1) else { return false };
    assert_eq!(grown.check(), Ok(()));
    if let Ok(tree) = example.synth(nodes).synthesize(1) {
        assert_eq!(tree.check(), Ok(()));
    }
    true
}
