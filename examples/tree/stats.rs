//! Figures of a run as JSON.

use crate::levels::triangles;
use crate::watch::Steps;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use treesynth::guided::Graph;
use treesynth::surface::Part;
use treesynth::{Metrics, Skeleton};

#[allow(clippy::too_many_arguments, reason = "a report of everything")]
pub(crate) fn stats(
    preset: &str,
    seed: u64,
    graph: &Graph,
    skeleton: &Skeleton,
    endpoints: &[usize],
    steps: &Steps,
    metrics: &Metrics,
    levels: &[Vec<Part<'_>>],
) -> serde_json::Result<Value> {
    let milliseconds: Map<String, Value> =
        steps.iter().map(|(name, time)| (name.clone(), json!(time.as_secs_f64() * 1e3))).collect();
    // Several parts of one name are counted together.
    let mut counts: BTreeMap<&str, [u64; 3]> = BTreeMap::new();
    for part in &levels[0] {
        let sums = counts.entry(part.name()).or_default();
        for (sum, more) in
            sums.iter_mut().zip([part.copies().len() as u64, part.vertices(), part.triangles()])
        {
            *sum += more;
        }
    }
    let parts: Map<String, Value> = counts
        .into_iter()
        .map(|(name, [copies, vertices, triangles])| {
            (name.to_owned(), json!({ "copies": copies, "vertices": vertices, "triangles": triangles }))
        })
        .collect();
    Ok(json!({
        "preset": preset,
        "seed": seed,
        "nodes": graph.nodes(),
        "edges": graph.edges(),
        "endpoints": endpoints.iter().sum::<usize>(),
        "endpoints_by_stage": endpoints,
        "segments": skeleton.segments(),
        "parts": parts,
        "triangles_by_level": levels.iter().map(|level| triangles(level)).collect::<Vec<_>>(),
        "milliseconds": milliseconds,
        "peak_memory_bytes": peak_memory(),
        "metrics": serde_json::to_value(metrics)?,
    }))
}

/// The most memory the process had at once; known on Linux alone.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches(" kB").trim().parse::<u64>().ok().map(|kilobytes| kilobytes * 1024)
}
