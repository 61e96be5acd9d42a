use super::*;

#[test]
fn figure_15() {
    let ashes: Vec<Tree> = presets::guided()
        .filter(|preset| preset.figure == 15)
        .map(|preset| Tree::of(preset.name, 40_000, preset.seed))
        .collect();
    assert_eq!(ashes.len(), 6);
    // Six trees: cells of 60 cm that limbs pass through, in the same crown.
    let cells = |tree: &Tree| {
        let limbs = (0..tree.positions().len()).filter(|&node| tree.skeleton().stages()[node] == 1);
        let mut cells: Vec<_> =
            limbs.map(|node| (tree.positions()[node] / 0.6).floor().as_ivec3().to_array()).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    };
    let cells: Vec<_> = ashes.iter().map(cells).collect();
    for (number, a) in cells.iter().enumerate() {
        for b in &cells[..number] {
            let both = share(a, |cell| b.binary_search(cell).is_ok());
            ascending("limbs in common", &[both, 0.65]); // 0.35 to 0.55
        }
    }
    // One species: logarithms of what one would measure first, and their distance from the six trees' mean.
    let measures = |tree: &Tree| {
        let metrics = Metrics::of(tree.skeleton());
        let limbs = f64::from(mean(tree.paths(1).iter().map(Path::tilt)));
        [metrics.height, metrics.crown_width, metrics.tips as f64, metrics.total_length, limbs]
            .map(|measure| ln(measure as f32))
    };
    let of_ashes: Vec<[f32; 5]> = ashes.iter().map(measures).collect();
    let species: [f32; 5] = std::array::from_fn(|i| mean(of_ashes.iter().map(|measures| measures[i])));
    let away = |measures: &[f32; 5]| {
        mean(measures.iter().zip(species).map(|(measure, mean)| (measure - mean) * (measure - mean))).sqrt()
    };
    let others = ["figure-06a", "figure-10-tall", "figure-12-t06", "figure-17e", "figure-17i", "figure-18"]
        .map(|name| measures(&Tree::of(name, 40_000, 1)));
    ascending("one species", &[most(&of_ashes, away), 0.065, least(&others, away)]); // 0.05, 0.08
}

#[test]
fn figure_16() {
    let trees = ["figure-16-15", "figure-16-09", "figure-16-05", "figure-16-03"]
        .map(|name| Tree::of(name, 60_000, 1));
    let metrics = trees.each_ref().map(|tree| Metrics::of(tree.skeleton()));
    // Each lower than the one before, up to its highest tip, which is luck: on the mean of six seeds.
    let heights = ["figure-16-03", "figure-16-05", "figure-16-09", "figure-16-15"].map(|name| {
        mean((1..=6).map(|seed| Metrics::of(Tree::of(name, 60_000, seed).skeleton()).height as f32))
    });
    ascending(
        "tops",
        &[heights[0] + 0.1, heights[1], heights[1] + 0.8, heights[2], heights[2] + 0.8, heights[3]],
    ); // 6.5, 6.7, 9.3, 12.8
    // A tree's one farthest tip is luck: what most of the nodes keep within.
    let [a, b, c, d] = trees.each_ref().map(|tree| {
        let across = |p: &Vec3| p.with_y(0.0).length() * 2.0;
        quantile(tree.positions().iter().map(across), 0.95)
    });
    ascending("widths", &[a + 0.4, b, b + 0.5, c, c + 0.1, d]); // 7.4, 8.1, 8.9, 9.2
    let [a, b, c, d] = trees.each_ref().map(|tree| quantile(tree.positions().iter().map(|p| p.y), 0.85));
    ascending("heights", &[d + 0.2, c, c + 0.5, b, b + 1.0, a]);
    let lengths = metrics.map(|metrics| metrics.total_length as f32);
    ascending("as dense", &[lengths[3], lengths[0] * 1.35]); // 2760 to 3290 m
    // With the first tree's θ the branches of the last would end 33° steeper.
    let ends = |tree: &Tree| mean(tree.paths(0).iter().map(|path| path.tilt_at_end(4)));
    let [a, b, c, d] = trees.each_ref().map(ends);
    ascending("ends more level", &[a + 8.0, b, b + 10.0, c, c + 5.0, d]); // 45, 69, 90, 97
    ascending("by the rule", &[ends(&trees[3].ruled(0, Bend::from_axis(degrees(14.0)))), 80.0, d]); // 66, 100
}

#[test]
fn figure_17a() {
    let dome = HalfEllipsoid::new(Vec3::Y * 5.6, Vec3::new(3.6, 4.0, 3.6));
    let trees = several(3, "figure-17a", 100_000, 4);
    let many = each(&trees, |tree| {
        let rule = Bend::piecewise(degrees(6.0), degrees(-4.0), 12);
        tree.staged(0, Stage::new(rule, InShape::poisson_disc(dome, 60)))
    });
    // The same limbs, and then endpoints all over the crown.
    let filled = each(&trees, |tree| {
        let rule = Bend::piecewise(degrees(30.0), 0.0, 1);
        tree.staged(1, Stage::new(rule, InShape::poisson_disc(dome, 60)))
    });
    for (tree, many) in trees.iter().zip(&many) {
        let limbs = |tree: &Tree| stems(tree, 5.0).len() as f32;
        ascending("distinct limbs", &[limbs(tree), 10.0, 30.0, limbs(many)]); // 9, 48
        let later = tree.growth.endpoints[1..].concat().len() as f32;
        ascending("endpoints later", &[150.0 * tree.growth.endpoints[0].len() as f32, later]); // 9, 3500
    }
    // Of the twenty tips nearest to a tip, those on the same limb.
    let together = |tree: &Tree| {
        let mut limbs = vec![None; tree.positions().len()];
        for limb in stems(tree, 5.0) {
            limbs[limb] = Some(limb);
        }
        for (node, parent) in tree.skeleton().edges() {
            limbs[node] = limbs[node].or(limbs[parent]);
        }
        let tips = tree.skeleton().tips().filter_map(|tip| Some((limbs[tip]?, tree.positions()[tip])));
        let tips: Vec<(usize, Vec3)> = tips.collect();
        mean(tips.iter().step_by(5).map(|&(limb, place)| {
            let mut others: Vec<_> = tips.iter().map(|tip| (tip.1.distance(place), tip.0)).collect();
            others.sort_by(|a, b| a.0.total_cmp(&b.0));
            share(&others[1..=20], |other| other.1 == limb)
        }))
    };
    // Half a metre and more from all of the tree, in the crown.
    let gaps = |tree: &Tree| {
        let steps = |from: i32| (from..=13).map(|step| step as f32 * 0.3);
        let places =
            steps(-13).flat_map(|x| steps(0).flat_map(move |y| steps(-13).map(move |z| Vec3::new(x, y, z))));
        let inside: Vec<Vec3> = places.map(|p| p + Vec3::Y * 5.6).filter(|&p| dome.contains(p)).collect();
        share(&inside, |p| tree.positions().iter().all(|node| node.distance_squared(*p) > 0.25))
    };
    let of = |measure: &dyn Fn(&Tree) -> f32| {
        [&trees, &many, &filled].map(|trees| mean(trees.iter().map(measure)))
    };
    let ([right, many, _], [gaps, fewer, fewest]) = (of(&together), of(&gaps));
    ascending("clusters", &[many, 0.54, 0.66, right]); // 0.49, 0.77
    ascending("gaps between them", &[fewer.max(fewest), 0.03, 0.04, gaps]); // 0.014, 0.078
}

#[test]
fn figure_17b() {
    let trees = several(3, "figure-17b", 100_000, 2);
    let [droop, rise] = [(8.0, 8.0, 3), (30.0, -10.0, 3)]
        .map(|(first, rest, hops)| Bend::piecewise(degrees(first), degrees(rest), hops));
    let swapped = each(&trees, |tree| tree.ruled(1, ByHeight::new(5.8, rise.clone(), droop.clone())));
    // Turn of limbs of more than 6 hops, below and above.
    let turns = |trees: &[Tree]| {
        let (low, high): (Vec<Path>, Vec<Path>) =
            paths(trees, 1).into_iter().filter(|path| path.hops() > 6).partition(|path| path.start().y < 5.8);
        [low, high].map(|paths| mean(paths.iter().map(|path| path.tilt_at_end(4) - path.tilt_between(1, 4))))
    };
    let ([low, high], [other_low, other_high]) = (turns(&trees), turns(&swapped));
    ascending("drooping below", &[other_low, 0.0, 20.0, low]); // -22, 34
    ascending("rising above", &[high, 2.0, 20.0, other_high]); // -17, 45
}

#[test]
fn figure_17c() {
    for tree in grown("figure-17c", 40_000, 3) {
        let tilt = |tree: &Tree| mean(tree.paths(1).iter().map(Path::tilt));
        let forks = tree.ruled(1, Bend::piecewise(degrees(30.0), 0.0, 1));
        ascending("level", &[tilt(&forks), 60.0, 70.0, tilt(&tree), 100.0]); // 42, 78
        ascending("spindly", &[tree.width_over_height(), 0.45]); // 0.4
        ascending("short, m", &[mean(tree.paths(1).iter().map(Path::length)), 1.8]); // 1.3
        ascending("dead", &[tree.skeleton().tips().count() as f32, 370.0]);
    }
}

#[test]
fn figure_17d() {
    let tree = Tree::of("figure-17d", 60_000, 1);
    let higher = |tree: &Tree, stage| share(&tree.paths(stage), |path| path.end().y > path.start().y);
    assert!((1..4).all(|stage| higher(&tree, stage) >= 1.0), "all endpoints higher than their sources");
    let surface = HopSurface::new(4, Count::UpTo(500)).with_outermost(0.5);
    let anywhere = tree.staged(2, Stage::new(Bend::piecewise(degrees(30.0), 0.0, 1), surface));
    ascending("higher without the policy", &[higher(&anywhere, 2), 0.985]); // 0.97
    ascending("broad", &[1.1, tree.width_over_height()]); // 1.27
}

#[test]
fn figure_17e_and_i() {
    for name in ["figure-17e", "figure-17i"] {
        let trees = several(4, name, TYPICAL_NODES, 2);
        // Pearson's correlation of the source's height and the limb's tilt.
        let steepening = |trees: &[Tree]| {
            let limbs: Vec<_> =
                paths(trees, 1).iter().map(|path| (path.start().y, path.tilt_at_start(8))).collect();
            correlation(&limbs)
        };
        let fixed = each(&trees, |tree| tree.ruled(1, Bend::piecewise(degrees(60.0), 0.0, 1)));
        // 17e: -0.6 and 0.1. 17i: -0.57 and -0.15.
        ascending("steeper with height", &[steepening(&trees), -0.43, -0.3, steepening(&fixed)]);
    }
}

#[test]
fn figure_17f_g_h() {
    let trees = |name| grown(name, 40_000, 1);
    let shoots = |trees: &[Tree], height| -> Vec<usize> {
        trees.iter().map(|tree| stems(tree, height).len()).collect()
    };
    for name in ["figure-17f", "figure-17h"] {
        let trees = trees(name);
        let fewest = |height| least(&shoots(&trees, height), |&count| count as f32);
        ascending("shoots at half a metre", &[6.0, fewest(0.5)]); // 9, 24
        ascending("shoots at two metres", &[30.0, fewest(2.0)]); // 45, 53
        // And none of them is a trunk: its share of the cross-section.
        let tree = Tree::of(name, 40_000, 1);
        let radii = tree.skeleton().radii();
        let areas: Vec<f32> = stems(&tree, 1.0).into_iter().map(|node| radii[node] * radii[node]).collect();
        ascending("the thickest", &[most(&areas, |&area| area) / areas.iter().sum::<f32>(), 0.3]); // 0.15
    }
    assert_eq!(shoots(&trees("figure-17c"), 2.0), [1, 1], "a trunk");
    let birches = several(6, "figure-17g", 20_000, 1);
    // The height at which it parts depends on the seed: from the ground to four metres.
    let parted = |height| mean(shoots(&birches, height).into_iter().map(|count| count as f32));
    ascending("a trunk", &[0.99, parted(0.5), 1.9]); // 1.5
    ascending("in two", &[1.75, parted(6.0), 2.01]); // 2
}

#[test]
fn figure_17j() {
    let thickness = |name| {
        let tree = Tree::of(name, 100_000, 1);
        let mut radii = tree.skeleton().radii().to_vec();
        radii.sort_by(f32::total_cmp);
        (radii[radii.len() / 2] / radii[radii.len() - 1], tree)
    };
    let (right, tree) = thickness("figure-17j");
    assert_eq!(tree.stages.len(), 2, "two iterations");
    ascending("few tips", &[tree.skeleton().tips().count() as f32, 1000.0]);
    for name in ["figure-07", "figure-17a", "figure-17f"] {
        let (other, tree) = thickness(name);
        ascending("no small twigs", &[other, 0.032, 0.042, right]); // 0.022 to 0.027, 0.049
        ascending("many tips", &[1050.0, tree.skeleton().tips().count() as f32]);
    }
}
