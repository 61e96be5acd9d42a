//! Growth by example: trees that are grown after one are of its kind, and each is another.

use treesynth::glam::Vec3;
use treesynth::guided::Example;
use treesynth::metrics::diameter_at;
use treesynth::{Metrics, Skeleton, presets};

const NODES: usize = 40_000;

fn preset(name: &str) -> Skeleton {
    presets::by_name(name).unwrap().guided().unwrap().synth(NODES).synthesize(1).unwrap()
}

/// One of each of the other systems, of some thousand branches at most.
fn self_organized() -> Skeleton {
    let stand = presets::by_name("stand-decurrent").unwrap().stand().unwrap();
    let trees = stand.grow(stand.seed).unwrap().skeletons().unwrap();
    trees.into_iter().max_by_key(Skeleton::len).unwrap()
}

fn grown_over_years() -> Skeleton {
    let oak = presets::by_name("growth-spreading-oak").unwrap().grown().unwrap();
    oak.grow(oak.seed).unwrap().at(oak.ages[oak.ages.len() / 2]).unwrap().skeleton
}

fn measures(tree: &Skeleton) -> Vec<(&'static str, f64)> {
    let metrics = Metrics::of(tree);
    vec![
        ("tips", metrics.tips as f64),
        ("height", metrics.height),
        ("crown width", metrics.crown_width),
        ("total length", metrics.total_length),
        ("wood volume", metrics.wood_volume),
        ("surface area", metrics.surface_area),
        ("branch angle", metrics.mean_branch_angle.unwrap()),
        ("smoothed angle", metrics.mean_branch_angle_smoothed.unwrap()),
        ("tortuosity", metrics.mean_tortuosity.unwrap()),
        ("strahler order", f64::from(metrics.strahler_order)),
        ("trunk diameter", f64::from(tree.radii()[0]) * 2.0),
    ]
}

/// The median of ten lies within 15% of the example.
fn is_of_its_kind(tree: &Skeleton) {
    let example = Example::of(tree).unwrap().tuned(NODES, 8).unwrap();
    let grown: Vec<Skeleton> = (0..10).map(|seed| example.grow(NODES, 100 + seed).unwrap()).collect();
    for (i, one) in grown.iter().enumerate() {
        one.check().unwrap();
        assert!(grown[..i].iter().all(|other| other != one), "two trees are the same");
    }
    assert_eq!(example.grow(NODES, 100).unwrap(), grown[0], "the same seed gives another tree");
    let all: Vec<_> = grown.iter().map(measures).collect();
    let mut off = Vec::new();
    let eighth = |tree: &Skeleton| diameter_at(tree, Metrics::of(tree).height / 8.0).unwrap();
    // Below the first limbs a trunk narrows too; where limbs begin lower, each tree forks elsewhere.
    if f64::from(example.trunk().clear_bole) > Metrics::of(tree).height / 8.0 {
        for one in &grown {
            let ratio = eighth(one) / eighth(tree);
            assert!((ratio - 1.0).abs() < 0.15, "diameter at an eighth of the height: {ratio}");
        }
    }
    for (i, (name, own)) in measures(tree).into_iter().enumerate() {
        let mut ratios: Vec<f64> = all.iter().map(|tree| tree[i].1 / own).collect();
        ratios.sort_by(f64::total_cmp);
        let median = f64::midpoint(ratios[4], ratios[5]);
        println!("{name}: {own:.3}, median {median:.3} of it, {:.3} to {:.3}", ratios[0], ratios[9]);
        // Orders are whole: a sixth of 6 is one.
        let off_by = if name == "strahler order" { 1.0f64.max(0.15 * own) } else { 0.15 * own };
        if (median - 1.0).abs() * own > off_by + 1e-9 {
            off.push(format!("{name}: {median:.3}"));
        }
    }
    assert!(off.is_empty(), "{off:?}");
}

#[test]
fn ashes_after_an_ash() {
    is_of_its_kind(&preset("fine-ash"));
}

#[test]
fn trees_after_other_presets() {
    for name in ["fine-linden", "fine-oak", "fine-elm", "figure-06b", "figure-07"] {
        println!("{name}");
        is_of_its_kind(&preset(name));
    }
}

#[test]
fn trees_after_one_that_organized_itself() {
    // Its own trunk ends where the crown begins; the longest axis is a better one to grow limbs on.
    let tree = self_organized();
    let stages = tree.stages().to_vec();
    is_of_its_kind(&tree.with_stages(stages).unwrap());
}

#[test]
fn trees_after_one_that_grew_over_years() {
    is_of_its_kind(&grown_over_years());
}

#[test]
fn an_example_is_measured() {
    // A trunk of 4 m with pairs of twigs of 1 m at 45 degrees, every half metre from 2 m on.
    let mut nodes = vec![Vec3::ZERO];
    let mut parents = vec![None];
    for i in 1..=8u32 {
        nodes.push(Vec3::Y * i as f32 * 0.5);
        parents.push(Some(i - 1));
    }
    for i in 4..8u32 {
        for side in [-1.0, 1.0] {
            nodes.push(nodes[i as usize] + Vec3::new(side, 1.0, 0.0) * 0.5f32.sqrt());
            parents.push(Some(i));
        }
    }
    let orders = (0..nodes.len()).map(|node| u16::from(node > 8)).collect();
    let tree = Skeleton::new(nodes, parents).unwrap().with_orders(orders).unwrap();
    let example = Example::of(&tree).unwrap();
    let trunk = example.trunk();
    assert!(
        (trunk.clear_bole - 2.0).abs() < 1e-4
            && trunk.waywardness < 1e-4
            && trunk.chord.distance(Vec3::Y * 4.0) < 1e-4
    );
    let [_, twigs] = example.orders() else { panic!("{:?}", example.orders()) };
    assert_eq!(twigs.count, 8);
    assert!((twigs.length - 1.0).abs() < 1e-4 && twigs.length_spread < 1e-3);
    assert!((twigs.angle - std::f32::consts::FRAC_PI_4).abs() < 1e-4 && twigs.angle_spread < 1e-3);
    // Half of the trunk is bare, and eight twigs share the other.
    assert!((twigs.spacing - 0.25).abs() < 1e-4 && (twigs.bare_base - 0.5).abs() < 1e-4);
}

#[test]
fn a_stem_is_no_example() {
    // A trunk of one node.
    let tree = Skeleton::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![None, Some(0), Some(0)]).unwrap();
    let error = Example::of(&tree.with_orders(vec![0, 1, 1]).unwrap()).unwrap_err().to_string();
    assert!(error.contains("a trunk of 0 m"), "{error}");
    let stem = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)]).unwrap();
    assert_eq!(Example::of(&stem).unwrap_err().parameter, "Example.skeleton");
    let point = Skeleton::new(vec![Vec3::ZERO; 3], vec![None, Some(0), Some(0)]).unwrap();
    assert_eq!(Example::of(&point).unwrap_err().parameter, "Example.skeleton");
    // One node far from all others, as fuzzing found: sums of lengths are not finite.
    for far in [1.1e6, 1e20, f32::MAX] {
        let mut tree = preset("figure-06b");
        let mut places = tree.positions().to_vec();
        places[tree.len() - 1] = Vec3::X * far;
        tree = tree.with_positions(places).unwrap();
        assert_eq!(Example::of(&tree).unwrap_err().parameter, "Example.skeleton");
    }
}

/// Branches of each order.
fn counts(tree: &Skeleton) -> Vec<usize> {
    let mut counts = Vec::new();
    for branch in &tree.branches() {
        let order = usize::from(branch.order());
        counts.resize(counts.len().max(order + 1), 0);
        counts[order] += 1;
    }
    counts
}

/// What `grow` promises without `tuned`: the example's number of branches of each order within 10%, on coarse graphs too.
#[test]
fn orders_have_the_examples_numbers() {
    for name in ["fine-oak", "fine-ash", "fine-linden", "figure-06b", "figure-07"] {
        let synth = presets::by_name(name).unwrap().guided().unwrap().synth(8_000);
        let tree = synth.synthesize(1).unwrap();
        let example = Example::of(&tree).unwrap();
        for seed in 1..=6 {
            let [wanted, found] = [counts(&tree), counts(&example.grow(8_000, seed).unwrap())];
            assert_eq!(wanted.len(), found.len(), "{name}, seed {seed}: {wanted:?} {found:?}");
            for (wanted, found) in wanted.iter().zip(&found) {
                let off = found.abs_diff(*wanted) as f32;
                assert!(off <= 0.1 * *wanted as f32 + 1.0, "{name}, seed {seed}: {wanted} {found}");
            }
        }
    }
}

#[test]
fn numbers_of_nodes_out_of_range_are_named() {
    let example = Example::of(&preset("figure-06b")).unwrap();
    for nodes in [0, 1, 200_000_001, usize::MAX] {
        for error in [
            example.grow(nodes, 1).unwrap_err().to_string(),
            example.clone().tuned(nodes, 1).unwrap_err().to_string(),
            example.synth(nodes).synthesize(1).unwrap_err().to_string(),
        ] {
            assert!(error.contains("nodes") && error.contains(&nodes.to_string()), "{error}");
        }
    }
}

/// Files may leave the root without thickness; the trunk has it all the same.
#[test]
fn a_root_without_thickness_takes_the_trunks() {
    let tree = preset("figure-06b");
    let mut radii = tree.radii().to_vec();
    radii[0] = 0.0;
    let without = tree.clone().with_radii(radii).unwrap();
    let [whole, example] = [&tree, &without].map(|tree| Example::of(tree).unwrap());
    let ratio = example.trunk().diameter / whole.trunk().diameter;
    assert!((0.9..=1.0).contains(&ratio), "{ratio}");
    let [whole, example] = [whole, example].map(|example| example.grow(8_000, 1).unwrap().radii()[0]);
    assert!((0.9..=1.0).contains(&(example / whole)), "{example} {whole}");
}

/// A trunk of 4 m with one limb of 2 m, level at 1.6 m, that bears twigs to both sides, level too, at 45 degrees.
fn one_limb() -> Skeleton {
    let mut nodes: Vec<Vec3> = (0..11u8).map(|i| Vec3::Y * 0.4 * f32::from(i)).collect();
    let mut parents: Vec<Option<u32>> = (0..11u32).map(|i| i.checked_sub(1)).collect();
    for i in 1..=10u32 {
        nodes.push(Vec3::new(0.2 * i as f32, 1.6, 0.0));
        parents.push(Some(if i == 1 { 4 } else { 9 + i }));
    }
    for i in 0..9u32 {
        nodes.push(nodes[11 + i as usize] + Vec3::new(0.2, 0.0, if i % 2 == 0 { 0.2 } else { -0.2 }));
        parents.push(Some(11 + i));
    }
    let stages = (0..nodes.len()).map(|node| u16::from(node > 10) + u16::from(node > 20)).collect();
    Skeleton::new(nodes, parents).unwrap().with_stages(stages).unwrap()
}

/// Limbs without length, as some files have them, are not cut into a million internodes.
#[test]
fn limbs_without_length_make_no_millions() {
    let nodes: Vec<Vec3> = (0..40u8).map(|i| Vec3::Y * 0.5 * f32::from(i % 20)).collect();
    let parents = (0..40u32).map(|i| if i < 20 { i.checked_sub(1) } else { Some(i - 20) }).collect();
    let stages = (0..40).map(|i| u16::from(i >= 20)).collect();
    let tree = Skeleton::new(nodes, parents).unwrap().with_stages(stages).unwrap();
    let example = Example::of(&tree).unwrap();
    for seed in 1..=3 {
        let grown = example.grow(4_000, seed).unwrap();
        assert!(grown.len() < 200, "{} nodes", grown.len());
    }
}

/// Twigs of a lone limb stand at the angle to it that the example's have, and limb and twigs are as long.
#[test]
fn a_lone_limb_bears_its_twigs_as_the_example() {
    let tree = one_limb();
    let example = Example::of(&tree).unwrap();
    for seed in 1..=6 {
        let grown = example.grow(10_000, seed).unwrap();
        let at = |node: u32| grown.positions()[node as usize];
        let chord = |nodes: &[u32]| at(nodes[nodes.len() - 1]) - at(nodes[0]);
        let branches = grown.branches();
        let limb =
            branches.iter().find(|branch| branch.order() == 1).map(|limb| chord(limb.nodes())).unwrap();
        assert!((1.2..2.5).contains(&limb.length()), "seed {seed}: a limb of {} m", limb.length());
        let twigs = branches.iter().filter(|branch| branch.order() == 2).map(|twig| chord(twig.nodes()));
        let twigs: Vec<Vec3> = twigs.collect();
        let mean = twigs.iter().map(|twig| twig.angle_between(limb)).sum::<f32>() / twigs.len() as f32;
        assert!((mean - std::f32::consts::FRAC_PI_4).abs() < 0.3, "seed {seed}: twigs at {mean}");
    }
}

/// Largest distance of the lowest `share` of a trunk's way from the line between its ends, over the line's length.
fn bole_strays(tree: &Skeleton, share: f32) -> f32 {
    let branches = tree.branches();
    let trunk = branches.iter().next().unwrap();
    let points: Vec<Vec3> = trunk.nodes().iter().map(|&node| tree.positions()[node as usize]).collect();
    let whole: f32 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let mut way = 0.0;
    let mut bole = vec![points[0]];
    for pair in points.windows(2) {
        way += pair[0].distance(pair[1]);
        if way <= share * whole {
            bole.push(pair[1]);
        }
    }
    let chord = bole[bole.len() - 1] - bole[0];
    let away = |point: &Vec3| (point - bole[0]).reject_from(chord).length();
    bole.iter().map(away).fold(0.0, f32::max) / chord.length()
}

/// Trunks go on in limbs that turn aside; the boles of the kind are no more crooked than the example's for that.
#[test]
fn boles_are_as_straight_as_the_examples() {
    for name in ["fine-oak", "fine-ash", "fine-linden", "fine-elm", "figure-06b", "figure-07"] {
        let tree = preset(name);
        let example = Example::of(&tree).unwrap();
        let wanted = bole_strays(&tree, 0.3);
        let mut found: Vec<f32> =
            (1..=9).map(|seed| bole_strays(&example.grow(20_000, seed).unwrap(), 0.3)).collect();
        found.sort_by(f32::total_cmp);
        println!("{name}: {wanted}, waywardness {}, found {found:?}", example.trunk().waywardness);
        assert!(found[4] <= wanted + 0.03 && found[8] <= wanted + 0.06, "{name}: {wanted}, found {found:?}");
    }
}

/// A trunk that goes on in a limb ends low; trees without tuning are as tall as the example all the same.
#[test]
fn trees_are_as_tall_as_the_example() {
    for name in ["fine-oak", "fine-ash", "fine-linden", "fine-elm", "figure-06b", "figure-07"] {
        for nodes in [8_000, 40_000] {
            let tree = presets::by_name(name).unwrap().guided().unwrap().synth(nodes).synthesize(1).unwrap();
            let example = Example::of(&tree).unwrap();
            let height = |tree: &Skeleton| Metrics::of(tree).height;
            let found: Vec<f64> =
                (1..=6).map(|seed| height(&example.grow(nodes, seed).unwrap()) / height(&tree)).collect();
            assert!(found.iter().all(|ratio| (0.8..1.2).contains(ratio)), "{name}, {nodes}: {found:.2?}");
        }
    }
}
