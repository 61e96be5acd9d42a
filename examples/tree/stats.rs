//! Figures of a run as JSON.

use crate::watch::Steps;
use serde_json::{Map, Value, json};
use treesynth::guided::Graph;
use treesynth::{Metrics, Skeleton};

pub(crate) fn stats(
    preset: &str,
    seed: u64,
    graph: &Graph,
    skeleton: &Skeleton,
    endpoints: &[usize],
    steps: &Steps,
    metrics: &Metrics,
) -> serde_json::Result<Value> {
    let milliseconds: Map<String, Value> =
        steps.iter().map(|(name, time)| (name.clone(), json!(time.as_secs_f64() * 1e3))).collect();
    Ok(json!({
        "preset": preset,
        "seed": seed,
        "nodes": graph.nodes(),
        "edges": graph.edges(),
        "endpoints": endpoints.iter().sum::<usize>(),
        "endpoints_by_stage": endpoints,
        "segments": skeleton.segments(),
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
