//! Leaves, buds and shoots through the year.

use treesynth::growth::{Architecture, Curve, Growth, Phenology, TreeAtAge};

fn curve<const N: usize>(points: [[f32; 2]; N]) -> Curve {
    Curve::new(points).expect("a curve")
}

fn at(species: Architecture, age: f32) -> TreeAtAge {
    Growth::new(species, 1).expect("a species in range").at(age).expect("an age in range")
}

fn with(change: impl Fn(Phenology) -> Phenology) -> Architecture {
    let species = Architecture::default().with_most_order(1);
    let phenology = change(species.phenology().clone());
    species.with_phenology(phenology)
}

#[test]
fn leaves_that_fell_stay_away() {
    let species = with(|year| year.with_leaf_share(curve([[0.0, 1.0], [0.4, 0.9], [0.5, 0.0], [0.8, 1.0]])));
    let leaves = [3.42, 3.6, 3.9, 4.42].map(|age| at(species.clone(), age).leaves.len());
    assert!(leaves[0] > 0 && leaves[3] > 0, "{leaves:?}");
    assert_eq!(leaves[1..3], [0, 0]);
}

#[test]
fn new_year_leaves_buds_as_they_are() {
    let species = with(|year| year.with_bud_growth(Curve::constant(0.5).expect("a curve")));
    let buds = [4.0, 4.001].map(|age| {
        let buds = at(species.clone(), age).buds;
        buds.iter().map(|bud| bud.length.to_bits()).collect::<Vec<_>>()
    });
    assert!(buds[0].len() > 20 && buds[0] == buds[1], "{} {}", buds[0].len(), buds[1].len());
}

#[test]
fn buds_follow_each_other_up_the_shoot() {
    let tree = at(with(|year| year.with_season(0.3, 0.7).with_stagger(0.5)).with_most_order(0), 3.55);
    // Of the trunk's last shoot, without the bud at the tip.
    let lengths: Vec<f32> = tree.buds.iter().map(|bud| bud.length).collect();
    let axils = &lengths[..lengths.len() - 1];
    assert!(axils.len() > 3 && axils.windows(2).all(|pair| pair[0] > pair[1]), "{axils:?}");
}

/// A hundred metamers in a tenth of a millimetre, 24 m up: less than a float's step each.
#[test]
fn the_shortest_internodes_keep_their_laterals() {
    let constant = |value| Curve::constant(value).expect("a curve");
    let species = Architecture::default()
        .with_height(curve([[0.0, 0.0], [0.3, 24.0], [1.0, 24.0]]))
        .with_least_shoot(1e-4)
        .with_metamers(constant(100.0))
        .with_lifespan(constant(1000.0))
        .with_most_order(1);
    let tree = at(species, 14.0).skeleton;
    let (stages, orders) = (tree.stages(), tree.orders());
    for year in 1..=14 {
        let trunk = (0..tree.len()).filter(|&node| orders[node] == 0 && stages[node] == year).count();
        assert!(trunk > 60, "{trunk} metamers of year {year}");
        let laterals = tree
            .edges()
            .filter(|&(node, bearer)| orders[node] == 1 && orders[bearer] == 0 && stages[bearer] == year);
        assert!(year == 14 || laterals.count() > 20, "of year {year}");
    }
}
