//! Drawings beside the trees of figures 10 and 11: the volume of the crown, and the surface that
//! endpoints are chosen from.

use super::{Failure, Options};
use treesynth::glam::Vec3;
use treesynth::guided::{Graph, Search, TreeSynth};
use treesynth::math::{cbrt, sin_cos};
use treesynth::presets::Preset;
use treesynth::preview::{Picture, Preview};
use treesynth::shape::Ellipsoid;
use treesynth::surface::{Instance, Material, Mesh, Part, Tubes};
use treesynth::{Silent, Skeleton};

/// Six meridians and five parallels of an ellipsoid as wires so many metres across.
pub(crate) fn wires(volume: Ellipsoid, thickness: f32) -> Result<Mesh, Failure> {
    const STEPS: u32 = 48;
    let turn = |share: f32| sin_cos(share * std::f32::consts::TAU);
    let meridians = (0..6).map(|i| turn(i as f32 / 12.0)).map(|(sin, cos)| {
        let place = move |(across, up): (f32, f32)| Vec3::new(across * sin, up, across * cos);
        (0..=STEPS).map(|step| place(turn(step as f32 / STEPS as f32))).collect::<Vec<_>>()
    });
    let parallels = (1..6).map(|i| turn(i as f32 / 12.0)).map(|(across, up)| {
        let place = move |(sin, cos): (f32, f32)| Vec3::new(across * sin, up, across * cos);
        (0..=STEPS).map(|step| place(turn(step as f32 / STEPS as f32))).collect()
    });
    let mut mesh = Mesh::default();
    for circle in meridians.chain(parallels) {
        let places: Vec<Vec3> = circle.into_iter().map(|p| volume.center() + volume.radii() * p).collect();
        let parents = (0..places.len() as u32).map(|node| node.checked_sub(1)).collect();
        let radii = vec![thickness * 0.5; places.len()];
        let wire = Tubes::default().mesh(&Skeleton::new(places, parents)?.with_radii(radii)?)?;
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(wire.positions);
        mesh.normals.extend(wire.normals);
        mesh.indices.extend(wire.indices.iter().map(|index| first + index));
    }
    Ok(mesh)
}

/// An octahedron on each place.
fn dots(places: &[Vec3], size: f32) -> Vec<Instance> {
    let stand = |&position: &Vec3| Instance { position, scale: size, ..Instance::IDENTITY };
    places.iter().map(stand).collect()
}

fn dot() -> Mesh {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
    let faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    Mesh::new(axes.to_vec(), axes.to_vec(), faces.concat())
}

/// Figure 11: left, the nodes so many hops off the tree; right, those of them in the exclusion zone in red, and in green the
/// outermost fraction t that endpoints are chosen from.
pub(crate) fn surface(
    preset: &Preset,
    synth: &TreeSynth,
    graph: &Graph,
    options: &Options,
) -> Result<Vec<Picture>, Failure> {
    let (hops, outermost) = (3, 0.6);
    let stages = preset.partial_stages.unwrap_or(synth.stages().len());
    let growth = synth.clone().first_stages(stages).grow(&mut Search::new(graph), preset.seed, &Silent)?;
    let mut seen = vec![false; graph.nodes()];
    growth.nodes.iter().for_each(|&node| seen[node as usize] = true);
    let mut ring = growth.nodes.clone();
    for _ in 0..hops {
        let next = ring.iter().flat_map(|&node| graph.neighbours(node)).copied();
        ring = next.filter(|&to| !std::mem::replace(&mut seen[to as usize], true)).collect();
    }
    // As `HopSurface` orders them: by hops from the root, then by distance.
    let root = graph.position(graph.root());
    let away = |node: u32| (graph.hops_from_root()[node as usize], graph.position(node).distance(root));
    ring.sort_by(|&a, &b| away(b).partial_cmp(&away(a)).unwrap_or(std::cmp::Ordering::Equal));
    let places: Vec<Vec3> = ring.iter().map(|&node| graph.position(node)).collect();
    let kept = (outermost * places.len() as f32).ceil() as usize;
    let tree = growth.skeleton.relaxed(0.5, 3)?;
    let (mesh, dot) = (Tubes::default().mesh(&tree)?, dot());
    // A third of the spacing in a region of 12 m.
    let size = 4.0 / cbrt(graph.nodes() as f32);
    let (outer, inner) = (dots(&places[..kept], size), dots(&places[kept..], size));
    let [green, red] = [[96, 150, 84], [186, 84, 66]].map(|color| Material::bark().with_srgb(color));
    let paper = [0.97, 0.965, 0.955];
    let preview = Preview::default().with_size(options.size, options.size).with_background(paper, paper);
    let mut pictures = Vec::new();
    for (inside, label) in [(green, "the surface"), (red, "the exclusion zone")] {
        let parts = [
            Part::new(&mesh).with_material(preset.bark()),
            Part::new(&dot).with_material(green).with_instances(&outer),
            Part::new(&dot).with_material(inside).with_instances(&inner),
        ];
        let mut picture = preview.draw_parts(&parts)?;
        picture.label(&format!("{}, {label}", preset.name), 6, 6, 1, [60, 60, 60]);
        pictures.push(picture);
    }
    Ok(pictures)
}
