//! Clouds of stems, ground and stray points at any places, and options of any value.

use super::Target;
use super::numbers::Numbers;
use super::options::{seeds, some_of};
use treesynth::cloud::Cloud;
use treesynth::glam::Vec3;
use treesynth::reconstruct::{Reconstruct, ReconstructedStand};

pub(super) fn all() -> Vec<Target> {
    vec![Target { name: "stand", seeds: seeds(256), run: stand }]
}

fn place(n: &mut Numbers<'_>) -> Vec3 {
    Vec3::new(n.float(), n.float(), n.float())
}

/// Points around a line from one place to another.
fn stem(n: &mut Numbers<'_>, points: &mut Vec<Vec3>) {
    let base = Vec3::new(f32::from(n.byte()) / 64.0, f32::from(n.byte()) / 256.0, f32::from(n.byte()) / 64.0);
    let (from, to) = if n.is_set() { (place(n), place(n)) } else { (base, base + Vec3::Y * 2.0) };
    let (radius, count) = (f32::from(n.byte()) / 1024.0, 20 + 2 * u16::from(n.byte()));
    for point in 0..count {
        let (sin, cos) = (f32::from(point) * 2.4).sin_cos();
        points.push(from.lerp(to, f32::from(point) / f32::from(count)) + Vec3::new(cos, 0.0, sin) * radius);
    }
}

/// Level or sloping, of cells of a tenth of a metre.
fn ground(n: &mut Numbers<'_>, points: &mut Vec<Vec3>) {
    let (height, slope, side) = (n.float(), n.float(), 10 + u16::from(n.byte() % 32));
    for at in 0..side * side {
        let [x, z] = [at % side, at / side].map(|at| f32::from(at) * 0.1);
        points.push(Vec3::new(x, height + slope * x, z));
    }
}

fn is_sound(stand: &ReconstructedStand, cloud: &Cloud) {
    assert!(!stand.trees.is_empty() && stand.owners.len() == cloud.len());
    let mut own = vec![0; stand.trees.len()];
    for owner in stand.owners.iter().flatten() {
        own[*owner as usize] += 1;
    }
    assert!(own.iter().sum::<usize>() + stand.ground <= cloud.len());
    for (tree, own) in stand.trees.iter().zip(own) {
        assert_eq!(tree.skeleton.check(), Ok(()));
        assert!(tree.left_out <= own && tree.is_measured.len() == tree.skeleton.len());
        assert!(tree.skeleton.edges().all(|(node, parent)| {
            let radii = tree.skeleton.radii();
            radii[node] > 0.0 && radii[node] <= radii[parent]
        }));
    }
}

fn stand(bytes: &[u8]) -> bool {
    let mut n = Numbers(bytes);
    let reconstruct = some_of!(
        n,
        Reconstruct::default(),
        with_side(float),
        with_gap(float),
        with_tip_radius(float),
        with_ground(is_set),
    );
    let mut points = Vec::new();
    for _ in 0..n.byte() % 4 {
        stem(&mut n, &mut points);
    }
    if n.is_set() {
        ground(&mut n, &mut points);
    }
    for _ in 0..n.byte() % 8 {
        points.push(place(&mut n));
    }
    let bases: Vec<Vec3> = (0..n.byte() % 4).map(|_| place(&mut n)).collect();
    let Ok(cloud) = Cloud::new(points) else { return false };
    let found = reconstruct.reconstruct_stand(&cloud);
    if let Ok(stand) = &found {
        is_sound(stand, &cloud);
        let bases = reconstruct.trunk_bases(&cloud).expect("as many as there are trees");
        assert_eq!(bases.len(), stand.trees.len());
    }
    let given = reconstruct.reconstruct_stand_at(&cloud, &bases);
    if let Ok(stand) = &given {
        is_sound(stand, &cloud);
    }
    found.is_ok() || given.is_ok()
}
