//! Shadows are what a sum over all nodes gives, and space is what is left of it.

use crate::sample::cases;
use proptest::prelude::*;
use treesynth::Shape;
use treesynth::glam::Vec3;
use treesynth::self_organizing::{
    Bud, Environment, Habit, SelfOrganizing, ShadowPropagation, Shedding, SpaceColonization,
};
use treesynth::shape::Sphere;

const CELL: f32 = 0.02;

fn cell(point: Vec3) -> [i64; 3] {
    ((point - Vec3::new(-2.0, 0.0, -2.0)) / CELL).to_array().map(|x| x.floor() as i64)
}

/// Straight from the text: `a · b^-q` of each node whose pyramid holds the point.
fn brute_force(nodes: &[Vec3], point: Vec3, height: i64) -> f64 {
    let at = cell(point);
    let shadow = |node: &Vec3| {
        let from = cell(*node);
        let q = from[1] - at[1];
        let aside = (from[0] - at[0]).abs().max((from[2] - at[2]).abs());
        if (0..=height).contains(&q) && aside <= q { 0.8 * 1.5f64.powi(-(q as i32)) } else { 0.0 }
    };
    nodes.iter().map(shadow).sum()
}

fn near(points: &[Vec3]) -> Vec<Vec3> {
    let steps = [-3, 0, 2].map(|step| step as f32 * CELL);
    let around = steps.map(|x| steps.map(|y| steps.map(|z| Vec3::new(x, y, z))));
    let around = around.as_flattened().as_flattened();
    points.iter().flat_map(|point| around.iter().map(move |step| *point + *step)).collect()
}

proptest! {
    #![proptest_config(cases(20))]

    #[test]
    fn shadows_are_sums_over_all_nodes(
        nodes in prop::collection::vec(prop::array::uniform3(-0.15f32..0.15), 1..150), height in 0u32..9,
    ) {
        let nodes: Vec<Vec3> = nodes.into_iter().map(|n| Vec3::from_array(n) + Vec3::new(0.3, 0.16, 1.95)).collect();
        let mut light = ShadowPropagation::default().with_height(height);
        light.update(&nodes, &[]);
        // The ground is the bottom of the box; to the sides the grid grows with what casts shadows.
        let above = |point: &Vec3| point.y >= 0.0;
        let standing: Vec<Vec3> = nodes.iter().copied().filter(above).collect();
        for point in near(&nodes).into_iter().filter(above) {
            let sum = brute_force(&standing, point, i64::from(height));
            prop_assert!((f64::from(light.shadow(point)) - sum).abs() < 1e-2, "{point}: {sum}");
        }
    }

    /// After any growth, shedding and cutting, the grid is to the bit that of the nodes that stand.
    #[test]
    fn the_grid_is_that_of_what_stands(
        seed: u64, parts in 1u32..5,
        steps in prop::collection::vec((1u32..5, any::<prop::sample::Index>(), any::<bool>()), 1..6),
    ) {
        let habit = Habit::default().with_shedding(Shedding::default().with_multiplier(0.6).with_grace(1));
        let mut tree = SelfOrganizing::new(ShadowPropagation::default(), habit, seed).with_parts(parts);
        for (seasons, node, cuts) in steps {
            tree.grow(seasons).unwrap();
            let Some(standing) = tree.tree() else { break };
            if cuts && standing.metamers() > 0 {
                let node = standing.ids().nth(1 + node.index(standing.metamers())).unwrap();
                tree.cut(node).unwrap();
            }
            let nodes: Vec<Vec3> = tree.tree().unwrap().positions().collect();
            let mut rebuilt = ShadowPropagation::default();
            rebuilt.update(&nodes, &[]);
            let asked = near(&nodes);
            let bits = |light: &ShadowPropagation| -> Vec<u32> {
                asked.iter().map(|point| light.shadow(*point).to_bits()).collect()
            };
            prop_assert_eq!(bits(tree.environment()), bits(&rebuilt));
        }
    }
}

#[test]
fn shadows_can_be_capped() {
    let node = Vec3::new(0.01, 1.01, 0.01);
    let mut light = ShadowPropagation::default().with_darkest(1.0);
    light.update(&[node], &[]);
    assert!((light.shadow(node) - 0.8).abs() < 1e-4);
    light.update(&[node, node], &[]);
    assert_eq!(light.shadow(node), 1.0);
}

/// Records what its buds are told, and otherwise is the default light with one node more.
struct Probe(ShadowPropagation, std::sync::Mutex<Vec<(f32, Vec3)>>);

impl Environment for Probe {
    fn light(&self, bud: &Bud<'_>) -> f32 {
        self.1.lock().unwrap().push((self.0.light(bud), self.0.direction(bud)));
        0.0
    }
    fn direction(&self, _: &Bud<'_>) -> Vec3 {
        Vec3::Y
    }
    fn update(&mut self, appeared: &[Vec3], fallen: &[Vec3]) {
        self.0.update(appeared, fallen);
    }
}

/// C for a bud alone, upwards; less, and away from it, beside another's shadow.
#[test]
fn buds_turn_from_shadows() {
    let told = |others: &[Vec3]| {
        let mut light = ShadowPropagation::default();
        light.update(others, &[]);
        let mut tree = SelfOrganizing::new(Probe(light, Vec::new().into()), Habit::default(), 1);
        tree.step().unwrap();
        tree.environment().1.lock().unwrap()[0]
    };
    let (alone, direction) = told(&[]);
    assert!((alone - 2.5).abs() < 1e-4);
    assert_eq!(direction, Vec3::Y);
    // Three cells up and three to the right: the foot's cell lies on the edge of its pyramid.
    let (beside, direction) = told(&[Vec3::new(0.07, 0.07, 0.01)]);
    assert!((beside - (2.5 - 0.8 / 3.375)).abs() < 1e-3, "{beside}");
    assert!(direction.x < -0.1 && direction.z.abs() < 1e-3, "{direction}");
}

/// Under space colonization all growth is where markers were perceived, markers near nodes are taken, and a cut frees
/// them for the branch to grow again.
#[test]
fn space_is_colonized() {
    let ball = Sphere::new(Vec3::Y * 0.5, 0.5);
    let space = SpaceColonization::in_shape(&ball, 4000, 3).unwrap();
    let mut tree = SelfOrganizing::new(space, Habit::default().with_optimal_weight(0.4), 1);
    tree.grow(14).unwrap();
    let nodes: Vec<Vec3> = tree.tree().unwrap().positions().collect();
    assert!(nodes.len() > 500, "{}", nodes.len());
    let space = tree.environment();
    let taken =
        space.markers().iter().filter(|marker| nodes.iter().any(|node| node.distance(**marker) <= 0.04));
    assert_eq!(taken.count(), space.markers().len() - space.free());
    assert!(space.free() < 3000);
    let reach = Sphere::new(Vec3::Y * 0.5, 0.5 + 0.12 + 0.1);
    assert!(nodes.iter().all(|node| reach.contains(*node)));
    let (before, free) = (tree.metamers(), space.free());
    let second = tree.tree().unwrap().ids().nth(2).unwrap();
    tree.cut(second).unwrap();
    let (stump, freed) = (tree.metamers(), tree.environment().free());
    assert!(stump < before / 2 && freed > free + 100);
    tree.grow(12).unwrap();
    assert!(tree.metamers() > 2 * stump && tree.environment().free() < freed - 100);
}
