use super::*;

#[test]
fn figure_09() {
    // Mean distance from the axis, in the top quarter for the middle.
    let narrowing = |tree: &Tree| {
        let top = tree.positions().iter().map(|p| p.y).fold(0.0, f32::max);
        let across = |low: f32, high: f32| {
            let layer = tree.positions().iter().filter(|p| (low * top..=high * top).contains(&p.y));
            mean(layer.map(|p| p.with_y(0.0).length()))
        };
        across(0.75, 1.0) / across(0.35, 0.55)
    };
    let cone = several(4, "figure-09-cone", 40_000, 4);
    let [half, boxed] =
        ["figure-09-half-ellipsoid", "figure-09-box"].map(|name| each(&cone, |tree| tree.as_preset(name)));
    let [cone, half, boxed] = [&cone, &half, &boxed].map(|trees| mean(trees.iter().map(narrowing)));
    ascending("narrow, round and wide at the top", &[cone, 0.6, half, 0.83, boxed, 1.1]); // 0.5, 0.73, 0.91
}

#[test]
fn figure_10() {
    // The volume drawn is that of the second iteration's endpoints.
    for preset in presets::guided() {
        assert_eq!(preset.volume().is_some(), preset.figure == 10, "{}", preset.name);
        let Some(volume) = preset.volume() else { continue };
        let tree = Tree::partial(preset.name, NODES, 1, 2);
        let inside = |&node: &u32| volume.contains(tree.graph.position(node));
        assert!(tree.growth.endpoints[1].len() > 60 && tree.growth.endpoints[1].iter().all(inside));
    }
    let tall = Tree::of("figure-10-tall", 40_000, 1);
    let wide = tall.as_preset("figure-10-wide");
    ascending("whole trees", &[tall.width_over_height(), 0.75, 0.95, wide.width_over_height()]); // 0.66, 1.03
    let (tall, wide) = (tall.after(2), wide.after(2));
    ascending("two iterations", &[tall.width_over_height(), 0.5, 0.8, wide.width_over_height()]); // 0.40, 0.90
}

#[test]
fn figures_01_04_and_11() {
    let of = |figure| presets::guided().filter(move |preset| preset.figure == figure).collect::<Vec<_>>();
    assert_eq!([of(1).len(), of(4).len(), of(11).len()], [3, 1, 1]);
    // Each iteration of figure 4 adds branches, finer ones.
    let tree = Tree::of("figure-04", 40_000, 1);
    assert_eq!(tree.stages.len(), 4);
    let tips: Vec<f32> = (1..=4).map(|stages| tree.after(stages).skeleton().tips().count() as f32).collect();
    ascending("tips", &[tips[0], 2.0, tips[1], 100.0, tips[2], 550.0, tips[3]]);
    // The tree of figure 11 is that of figure 12 with t = 0.6.
    let eleven = Tree::of("figure-11", NODES, 1);
    assert_eq!(eleven.skeleton(), Tree::of("figure-12-t06", NODES, 1).skeleton());
}

#[test]
fn figure_12() {
    // The part of trunk and limbs nearer to the root: the share of its nodes that bear something.
    let clothed = |tree: &Tree| {
        let skeleton = tree.skeleton();
        let frame = skeleton.stages().iter().filter(|&&stage| stage < 2).count();
        let mut bears = vec![false; frame];
        for (_, parent) in skeleton.edges().filter(|&(node, parent)| node >= frame && parent < frame) {
            bears[parent] = true;
        }
        let mut nodes: Vec<usize> = (0..frame).collect();
        nodes.sort_by(|&a, &b| tree.positions()[a].length().total_cmp(&tree.positions()[b].length()));
        share(&nodes[..frame / 2], |&node| bears[node])
    };
    let away = |tree: &Tree| mean(tree.internodes(2..5).iter().map(|(middle, _)| middle.length()));
    let t03 = grown("figure-12-t03", 40_000, 5);
    let [t06, t10] = ["figure-12-t06", "figure-12-t10"].map(|name| each(&t03, |tree| tree.as_preset(name)));
    let all = |of: &dyn Fn(&Tree) -> f32| [&t10, &t06, &t03].map(|trees| mean(trees.iter().map(of)));
    let ([t10, t06, t03], [near, middle, far]) = (all(&clothed), all(&away));
    ascending("inner parts with twigs", &[t03, 0.11, t06, 0.5, t10]); // 0.01, 0.24, 0.76
    ascending("distance of twigs from the root, m", &[near, 7.5, middle, 8.9, far]); // 6.6, 8.6, 9.4
}

#[test]
fn figure_13() {
    let lower = |tree: &Tree, stage| share(&tree.paths(stage), |path| path.end().y < path.start().y);
    let tips = |tree: &Tree| mean(tree.paths(2).iter().map(|path| path.tilt_at_end(3)));
    for tree in grown("figure-13", 60_000, 5) {
        assert!((2..5).all(|stage| lower(&tree, stage) >= 1.0), "all endpoints lower than their sources");
        let surface = HopSurface::new(5, Count::UpTo(350)).with_outermost(0.8);
        let anywhere = tree.staged(2, Stage::new(Bend::piecewise(degrees(120.0), degrees(6.0), 1), surface));
        ascending("lower without the policy", &[lower(&anywhere, 2), 0.8]); // 0.68
        let upright = tree.ruled(2, Bend::piecewise(degrees(30.0), 0.0, 1));
        ascending("hanging tips", &[tips(&upright), 105.0, tips(&anywhere), 120.0, tips(&tree)]); // 102, 110, 130
    }
}

#[test]
fn figure_14() {
    let first = Tree::of("figure-14-1000", TYPICAL_NODES, 1);
    let trees = ["figure-14-1000", "figure-14-2000", "figure-14-4000"].map(|name| first.as_preset(name));
    let [one, two, four] = trees.each_ref().map(|tree| {
        let mut endpoints = tree.growth.endpoints.concat();
        endpoints.sort_unstable();
        endpoints.dedup();
        endpoints.len() as f32
    });
    ascending("endpoints", &[900.0, one, 1100.0, 1800.0, two, 2200.0, 3600.0, four, 4400.0]);
    // Endpoints on the way to other endpoints are no tips.
    let [one, two, four] = trees.each_ref().map(|tree| tree.skeleton().tips().count() as f32);
    ascending("tips", &[650.0, one, 1000.0, 1300.0, two, 1800.0, 2400.0, four]); // 747, 1423, 2599
}
