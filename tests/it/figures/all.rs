use super::*;

/// Share of the tree's nodes within a spacing of the region's sides and top.
fn share_at_border(tree: &Tree, planar: bool) -> f32 {
    let (graph, everywhere) = (&tree.graph, tree.graph.positions());
    let (low, high) =
        everywhere.iter().fold((Vec3::MAX, Vec3::MIN), |(low, high), &p| (low.min(p), high.max(p)));
    let edges = (0..graph.nodes() as u32).flat_map(|from| {
        graph.neighbours(from).iter().map(move |&to| graph.position(from).distance(graph.position(to)))
    });
    let spacing = edges.fold(f32::MAX, f32::min);
    share(tree.positions(), |&p| {
        let near = (p - low).min(high - p);
        near.x < spacing || high.y - p.y < spacing || (!planar && near.z < spacing)
    })
}

/// No crown is cut off flat by the region's sides or its top, all taper, and a trunk is bare.
///
/// k hops of a coarse graph are a longer way than k hops of the paper's, so a tree that reaches the border is grown
/// again in finer ones: all keep off it at 60,000 nodes, but for figures 13 and 17 (d), which take 150,000.
#[test]
fn all_presets() {
    for preset in presets::guided().filter(|preset| preset.figure != 15) {
        let name = preset.name;
        let tree = [NODES, 60_000, TYPICAL_NODES]
            .iter()
            .map(|&nodes| Tree::of(name, nodes, preset.seed))
            .find(|tree| share_at_border(tree, preset.planar) <= 0.01)
            .unwrap_or_else(|| panic!("{name} reaches the border"));
        let radii = tree.skeleton().radii();
        let tips: Vec<f32> = tree.skeleton().tips().map(|tip| radii[tip] / radii[0]).collect();
        ascending(&format!("{name}: tips for the foot"), &[most(&tips, |&tip| tip), 0.35]);
        let has_trunk = tree.growth.endpoints[0].len() == 1 && !preset.planar;
        // Twigs all over the trunk are what t = 1 shows.
        if has_trunk && name != "figure-12-t10" {
            let low = 0.2 * tree.positions().iter().map(|p| p.y).fold(0.0, f32::max);
            assert_eq!(stems(&tree, low).len(), 1, "{name}");
            let others =
                tree.positions().iter().zip(tree.skeleton().stages()).filter(|&(_, &stage)| stage > 0);
            let others: Vec<&Vec3> = others.map(|(position, _)| position).collect();
            // The crown of 17 (c) begins there.
            let limit = if name == "figure-17c" { 0.12 } else { 0.02 };
            ascending(&format!("{name}: branches low down"), &[share(&others, |p| p.y < low), limit]);
        }
    }
}
