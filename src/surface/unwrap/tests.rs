//! Properties of the coordinates of every triangle.

use super::*;
use crate::presets;
use crate::surface::Implicit;

struct Measured {
    /// Stretch of each triangle and its area, sorted by stretch; then the same of density.
    stretch: Vec<(f32, f32)>,
    density: Vec<(f32, f32)>,
    doubled: f32,
}

fn part(sorted: &[(f32, f32)], share: f32) -> f32 {
    let total: f32 = sorted.iter().map(|(_, area)| area).sum();
    let mut sum = 0.0;
    for &(value, area) in sorted {
        sum += area;
        if sum >= share * total {
            return value;
        }
    }
    sorted.last().map_or(0.0, |last| last.0)
}

fn measure(skeleton: &Skeleton, detail: f32, tile: f32) -> Measured {
    let plain = Implicit::default().with_detail(detail).mesh(skeleton).expect("a surface");
    let mut mesh = plain.clone();
    Unwrap::default().with_tile(tile).wrap(&mut mesh, skeleton).expect("in range");
    mesh.check().expect("sound");
    assert_eq!(mesh.triangles().len(), plain.triangles().len());
    let same = |(new, old): (&u32, &u32)| mesh.positions[*new as usize] == plain.positions[*old as usize];
    assert!(mesh.indices.iter().zip(&plain.indices).all(same), "triangles stay where they were");
    let (mut stretch, mut density) = (Vec::new(), Vec::new());
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
        let area = 0.5 * (b - a).cross(c - a).length();
        let uvs = corners.map(|corner| mesh.uvs[corner as usize]);
        let Some([most, least]) = densities([a, b, c], uvs) else { continue };
        stretch.push(((most / least.max(1e-9)) as f32, area));
        density.push(((most * least).sqrt() as f32 * tile, area));
    }
    stretch.sort_by(|a, b| a.0.total_cmp(&b.0));
    density.sort_by(|a, b| a.0.total_cmp(&b.0));
    let doubled = mesh.positions.len() as f32 / plain.positions.len() as f32 - 1.0;
    Measured { stretch, density, doubled }
}

#[test]
fn stretch_is_bounded_and_texels_are_even() {
    for (name, nodes) in [("figure-06b", 400), ("figure-18", 500), ("figure-17e", 300)] {
        let preset = presets::by_name(name).expect("a preset").guided().expect("guided");
        for seed in 0..2 {
            let tree = preset.synth(nodes).synthesize(seed).expect("a tree").relaxed(0.5, 3).expect("sound");
            // A tile that goes around the thinnest wood.
            let thinnest = tree.radii().iter().copied().filter(|radius| *radius > 0.0).fold(1e9, f32::min);
            let tile = 3.0 * thinnest;
            let found = measure(&tree, 1.5, tile);
            let stretch = [0.5, 0.95, 0.999, 1.0].map(|share| part(&found.stretch, share));
            let density = [0.0, 0.01, 0.05, 0.5, 0.95, 0.99, 1.0].map(|share| part(&found.density, share));
            println!("{name} {seed}: stretch {stretch:?}, density {density:?}, doubled {}", found.doubled);
            assert!(stretch[1] < 2.2 && stretch[3] < 4.1, "{name}: {stretch:?}");
            assert!(density[2] > 0.5 && density[4] < 2.0, "{name}: {density:?}");
            assert!(found.doubled < 0.6, "{name}: {}", found.doubled);
        }
    }
}

#[test]
fn no_triangle_spans_the_jump() {
    let positions = vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0];
    let pole = Skeleton::new(positions, vec![None, Some(0), Some(1)]).expect("a tree");
    let pole = pole.with_radii(vec![0.2; 3]).expect("radii");
    let mut mesh = Implicit::default().with_detail(4.0).mesh(&pole).expect("a surface");
    Unwrap::default().with_tile(0.2).wrap(&mut mesh, &pole).expect("in range");
    for corners in mesh.triangles() {
        let uvs = corners.map(|corner| mesh.uvs[corner as usize]);
        let widest =
            (uvs[0] - uvs[1]).length().max((uvs[1] - uvs[2]).length()).max((uvs[2] - uvs[0]).length());
        assert!(widest < 1.5, "{uvs:?}");
    }
    // Six tiles around, whole: what is doubled on the side is six apart.
    assert!(mesh.uvs.iter().any(|uv| uv.x > 3.0) && mesh.uvs.iter().any(|uv| uv.x < -1.0));
}

#[test]
fn what_is_wrong_is_named() {
    let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)]).expect("a tree");
    let thick = pole.clone().with_radii(vec![0.2; 2]).expect("radii");
    let mesh = Implicit::default().mesh(&thick).expect("a surface");
    let wrong = |unwrap: Unwrap, mesh: &Mesh, tree: &Skeleton| {
        unwrap.wrap(&mut mesh.clone(), tree).expect_err("out of range").to_string()
    };
    assert!(wrong(Unwrap::default().with_tile(0.0), &mesh, &thick).starts_with("Unwrap.tile"));
    assert!(
        wrong(Unwrap::default().with_least_radius(-1.0), &mesh, &thick).starts_with("Unwrap.least_radius")
    );
    assert!(wrong(Unwrap::default(), &mesh, &pole).contains("radius zero"));
    let mut broken = mesh.clone();
    broken.normals.pop();
    assert!(wrong(Unwrap::default(), &broken, &thick).starts_with("Unwrap.mesh"));
    // A root alone is a ball.
    let ball = Skeleton::new(vec![Vec3::ZERO], vec![None])
        .and_then(|root| root.with_radii(vec![0.3]))
        .expect("a ball");
    let mut mesh = Implicit::default().with_detail(3.0).mesh(&ball).expect("a surface");
    Unwrap::default().wrap(&mut mesh, &ball).expect("in range");
    mesh.check().expect("sound");
}
