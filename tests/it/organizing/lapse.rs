//! Between two seasons nothing jumps.

use super::growth::stand;
use treesynth::Skeleton;
use treesynth::glam::Vec3;
use treesynth::self_organizing::{
    Forest, ForestError, Habit, Sag, SelfOrganizing, ShadowPropagation, Shedding, Tree,
};

/// From one frame to the next no node moves farther than the whole season's growth takes in that time.
fn assert_smooth(before: &Forest, after: &Forest) {
    const FRAMES: u8 = 8;
    let frame = |frame: u8| after.skeletons_since(before, f32::from(frame) / f32::from(FRAMES)).unwrap();
    let bits = |trees: &[Skeleton]| trees.iter().map(|tree| tree.positions().to_vec()).collect::<Vec<_>>();
    assert_eq!(bits(&frame(0)), bits(&before.skeletons().unwrap()));
    assert_eq!(bits(&frame(FRAMES)), bits(&after.skeletons().unwrap()));
    let inner: Vec<Vec<Skeleton>> = (1..FRAMES).map(frame).collect();
    for pair in inner.windows(2) {
        for (one, other) in pair[0].iter().zip(&pair[1]) {
            one.check().unwrap();
            assert_eq!(one.len(), other.len());
            assert!((0..one.len()).all(|node| one.parent(node) == other.parent(node)));
            let moved = one.positions().iter().zip(other.positions()).map(|(a, b)| a.distance(*b));
            let farthest = moved.fold(0.0, f32::max);
            // The longest branch that grows or falls within a season.
            assert!(farthest < 1.0 / f32::from(FRAMES), "{farthest} m");
            let thicker = one.radii().iter().zip(other.radii()).map(|(a, b)| (a - b).abs());
            assert!(thicker.fold(0.0, f32::max) < 0.01);
        }
    }
    // The first frame is near what stood, the last near what stands.
    let near = |trees: &[Skeleton], nodes: &[Vec3]| {
        trees
            .iter()
            .flat_map(Skeleton::positions)
            .all(|place| nodes.iter().any(|node| node.distance(*place) < 1.0 / f32::from(FRAMES)))
    };
    let nodes = |forest: &Forest| forest.trees().iter().flat_map(Tree::positions).collect::<Vec<_>>();
    // Seeds that have just fallen are where they are.
    let sown = after.trees().iter().filter(|tree| tree.born() == after.season()).map(Tree::foot);
    assert!(near(&inner[0], &[nodes(before), sown.collect()].concat()));
    assert!(near(&inner[inner.len() - 1], &[nodes(after), nodes(before)].concat()));
}

#[test]
fn forests_grow_without_a_jump() {
    for seed in 1..=3 {
        let shedding = Shedding::default().with_multiplier(0.6).with_grace(1);
        let mut forest = stand(seed);
        forest.habits_mut()[0] =
            Habit::default().with_shedding(shedding).with_sag(Sag::default().with_modulus(1e8));
        for _ in 0..9 {
            let before = forest.clone();
            forest.step().unwrap();
            assert_smooth(&before, &forest);
        }
        let before = forest.clone();
        let id = forest.trees()[0].ids().nth(9).unwrap();
        forest.cut(forest.trees()[0].number(), id).unwrap();
        forest.remove(forest.trees()[1].number()).unwrap();
        let trees = forest.skeletons_since(&before, 0.5).unwrap();
        assert_eq!(trees.len(), before.trees().len());
        assert_eq!(trees[0].len(), before.trees()[0].metamers() + 1);
    }
}

#[test]
fn one_tree_and_bad_parts() {
    let mut tree = SelfOrganizing::new(ShadowPropagation::default(), Habit::default(), 1);
    let before = tree.clone();
    assert_eq!(tree.skeleton_since(&before, 0.5).unwrap().len(), 1);
    tree.grow(5).unwrap();
    let half = tree.skeleton_since(&before, 0.5).unwrap();
    assert_eq!(half.len(), tree.metamers() + 1);
    let top = |tree: &Skeleton| tree.positions().iter().map(|node| node.y).fold(0.0, f32::max);
    let whole = top(&tree.skeleton().unwrap());
    assert!((top(&half) - 0.5 * whole).abs() < 0.01 * whole);
    for bad in [-0.1, 1.1, f32::NAN] {
        let error = tree.skeleton_since(&before, bad);
        assert!(matches!(error, Err(ForestError::Parameter(error)) if error.parameter == "part"));
    }
}
