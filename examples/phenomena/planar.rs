//! The faces of a planar graph.

use treesynth::guided::Graph;
use treesynth::math::atan2;

/// The triangles between the edges of a planar graph that lies in the plane z = 0 and has every edge both ways,
/// counter-clockwise.
pub(crate) fn triangles(graph: &Graph) -> Vec<[u32; 3]> {
    let mut found = Vec::new();
    for node in 0..graph.nodes() as u32 {
        let here = graph.position(node);
        let angle = |&to: &u32| {
            let way = graph.position(to) - here;
            atan2(way.y, way.x)
        };
        let mut around = graph.neighbours(node).to_vec();
        around.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        for (i, &next) in around.iter().enumerate() {
            let after = around[(i + 1) % around.len()];
            let (a, b) = (graph.position(next) - here, graph.position(after) - here);
            let turns_left = a.x * b.y - a.y * b.x > 0.0;
            if node < next && node < after && turns_left && graph.neighbours(next).contains(&after) {
                found.push([node, next, after]);
            }
        }
    }
    found
}
