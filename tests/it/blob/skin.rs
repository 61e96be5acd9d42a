//! Scars and ridges where and when section 3.2 has them.

use crate::sample::fnv1a;
use treesynth::glam::Vec3;
use treesynth::surface::blob::{BlobTree, Skin, by_name, fork, presets};
use treesynth::{Skeleton, presets as trees};

const YEARS: [f32; 4] = [1.0, 4.0, 7.0, 10.0];

fn skin(years: f32) -> Skin {
    Skin::default().with_age(years + 1.0)
}

fn worn(skin: &Skin, skeleton: &Skeleton) -> BlobTree {
    skin.blob_tree(skeleton).expect("a skin")
}

/// The first point of the surface on the way from a point outwards.
fn surface(tree: &BlobTree, from: Vec3, way: Vec3) -> Vec3 {
    let (mut inside, mut outside) = (0.0f32, 0.2);
    assert!(tree.value(from) > 0.0 && tree.value(from + way * outside) < 0.0);
    for _ in 0..40 {
        let middle = 0.5 * (inside + outside);
        if tree.value(from + way * middle) > 0.0 { inside = middle } else { outside = middle }
    }
    from + way * inside
}

fn brightness(tree: &BlobTree, at: Vec3) -> f32 {
    tree.color(at).iter().sum()
}

/// The greatest change of the normal between two points a hundredth of a radius apart, along the main axis on the side
/// without the lateral.
fn sharpest(tree: &BlobTree, skeleton: &Skeleton) -> f32 {
    let (radius, top) = (skeleton.radii()[8], skeleton.positions()[8]);
    let normal = |i: i32| {
        let from = top + Vec3::Y * (i as f32 * 0.01 * radius);
        tree.gradient(surface(tree, from, Vec3::NEG_X)).1.normalize()
    };
    (-120..120).map(|i| normal(i).angle_between(normal(i + 1))).fold(0.0, f32::max)
}

#[test]
fn the_scar_of_the_main_axis_fades() {
    let (mut sharp, mut dark) = (Vec::new(), Vec::new());
    for years in YEARS {
        let skeleton = fork(years).expect("a fork");
        let tree = worn(&skin(years), &skeleton);
        sharp.push(sharpest(&tree, &skeleton));
        let [at, below] = [8, 2].map(|node| surface(&tree, skeleton.positions()[node], Vec3::NEG_X));
        dark.push(brightness(&tree, at) / brightness(&tree, below));
    }
    assert!(sharp[0] > 0.5, "a crease at first: {sharp:?}");
    assert!(sharp.windows(2).all(|pair| pair[1] < pair[0]), "{sharp:?}");
    assert!(sharp[3] < 0.08, "smooth in the end: {sharp:?}");
    assert!(dark[0] < 0.2 && dark.windows(2).all(|pair| pair[1] > pair[0]), "{dark:?}");
    assert!(dark[3] > 0.99, "{dark:?}");
}

/// Around the lateral's base at first; in the end only in the axil.
#[test]
fn the_scar_of_the_lateral_becomes_a_ridge() {
    let (mut above, mut below) = (Vec::new(), Vec::new());
    for years in YEARS {
        let skeleton = fork(years).expect("a fork");
        let tree = worn(&skin(years), &skeleton);
        let (foot, next) = (skeleton.positions()[7], skeleton.positions()[21]);
        let (out, thick) = ((next - foot).normalize(), skeleton.radii()[7]);
        // The darkest that is seen from between the axis and the lateral.
        let darkest = |axis: Vec3| {
            let from = (axis + out).normalize();
            let aside = (axis - out).normalize();
            let seen = (-40..=40).filter_map(|i| {
                let start = foot + from * (10.0 * thick) + aside * (0.05 * thick * i as f32);
                let mut steps = (0..1200).map(|k| start - from * (0.01 * thick * k as f32));
                steps.find(|&point| tree.value(point) > 0.0)
            });
            seen.map(|point| brightness(&tree, point)).fold(f32::INFINITY, f32::min)
        };
        above.push(darkest(Vec3::Y));
        below.push(darkest(Vec3::NEG_Y));
    }
    assert!(above.iter().all(|&dark| dark < 0.2), "{above:?}");
    assert!(below[0] < 0.12 && below.windows(2).all(|pair| pair[1] >= pair[0]), "{below:?}");
    assert!(below[3] > 0.36, "the bark's own colour: {below:?}");
}

/// Without scars and ridges nothing is dark or sharp; away from them they make no difference.
#[test]
fn marks_stay_where_they_belong() {
    let skeleton = fork(4.0).expect("a fork");
    let marked = worn(&skin(4.0), &skeleton);
    let plain = worn(&skin(4.0).with_scars(0.0).with_ridges(0.0), &skeleton);
    assert!(sharpest(&plain, &skeleton) < 0.08);
    let (mut same, mut other) = (0, 0);
    for i in 0..40_000 {
        let unit = |n: u32| (i as u32).wrapping_mul(n).wrapping_mul(2_654_435_761) as f32 / u32::MAX as f32;
        let point = Vec3::new(unit(1) * 0.2 - 0.05, 0.2 + unit(7919) * 0.32, unit(104_729) * 0.1 - 0.05);
        let equal = marked.value(point).to_bits() == plain.value(point).to_bits();
        let near = point.distance(skeleton.positions()[8]) < 0.08;
        assert!(equal || near, "{point}");
        same += u32::from(equal && plain.value(point) > -0.5);
        other += u32::from(!equal);
    }
    assert!(same > 1000 && other > 200, "{same} {other}");
}

#[test]
fn any_skeleton_can_wear_it() {
    for name in ["figure-06c", "figure-13", "figure-18"] {
        let preset = trees::by_name(name).unwrap().guided().unwrap();
        let skeleton = preset.synth(4000).synthesize(preset.seed).expect("a tree");
        let tree = worn(&Skin::default(), &skeleton);
        assert!(tree.primitives() > skeleton.segments());
        for (&position, node) in skeleton.positions().iter().zip(0..) {
            let (value, gradient) = tree.gradient(position);
            assert!(value > 0.0 && gradient.is_finite(), "{name}: node {node} is not inside: {value}");
        }
    }
    let alone = Skeleton::new(vec![Vec3::ONE], vec![None]).and_then(|root| root.with_radii(vec![0.2]));
    let ball = worn(&Skin::default(), &alone.expect("a root"));
    assert!(ball.value(Vec3::ONE + Vec3::X * 0.2).abs() < 1e-5);
    // Nodes in one place, and a branch that turns back.
    let [up, back] = [Vec3::Y, Vec3::Y * 0.5];
    let odd =
        Skeleton::new(vec![Vec3::ZERO, up, up, back, up], vec![None, Some(0), Some(1), Some(2), Some(1)]);
    let odd = odd.and_then(|odd| odd.with_radii(vec![0.1; 5])).expect("a skeleton");
    assert!(worn(&Skin::default(), &odd.with_stages(vec![0, 1, 2, 3, 4]).expect("stages")).value(up) > 0.0);
}

/// The trunk base is flat and as wide as it is above; what lies on the ground is cut off across.
#[test]
fn trunks_end_on_the_ground() {
    for way in [Vec3::Y, Vec3::new(0.4, 1.0, -0.3).normalize(), Vec3::X, Vec3::new(1.0, 0.2, 0.0).normalize()]
    {
        for (scale, internode) in [(1.0, 0.3), (1.0, 0.01), (0.02, 3.0)] {
            let radius = 0.1 * scale;
            let places: Vec<Vec3> = (0..200).map(|i| way * (internode * scale * i as f32)).collect();
            let parents = (0..200u32).map(|i| i.checked_sub(1)).collect();
            let pole = Skeleton::new(places, parents).and_then(|pole| pole.with_radii(vec![radius; 200]));
            let tree = worn(&Skin::default(), &pole.expect("a pole"));
            let up = if way.y > 0.5 { Vec3::Y } else { way };
            let (right, ahead) = up.any_orthonormal_pair();
            let (mut full, mut below) = (0, 0);
            for i in 0..400 {
                let (sin, cos) = treesynth::math::sin_cos(i as f32 * 0.7);
                let aside = (right * cos + ahead * sin) * (radius * 1.3 * (i as f32 / 400.0));
                full += usize::from(tree.value(aside + up * (0.01 * radius)) > 0.0);
                below += usize::from(tree.value(aside - up * (0.04 * radius)) > 0.0);
            }
            assert!(below == 0 && full > 270, "{way} {scale} {internode}: {full} {below}");
        }
    }
}

#[test]
fn figures_are_there_and_the_same_as_ever() {
    let names: Vec<_> = presets().map(|preset| preset.name).collect();
    assert!((4..=7).all(|figure| presets().any(|preset| preset.figure == figure)));
    assert!(names.iter().all(|name| by_name(name).is_some()) && by_name("blob-08").is_none());
    let numbers = presets().flat_map(|preset| {
        let tree = preset.blob_tree().expect("a solid");
        (0..4096u32).flat_map(move |i| {
            let at = [i % 16, i / 16 % 16, i / 256].map(|k| (k as f32 + 0.5) / 16.0);
            let point = preset.view.at(Vec3::from(at));
            let (value, gradient) = tree.gradient(point);
            [value, gradient.x, gradient.y, gradient.z].into_iter().chain(tree.color(point)).map(f32::to_bits)
        })
    });
    let hash = fnv1a(numbers.flat_map(u32::to_le_bytes));
    assert_eq!(hash, 0x3958_c93d_4993_981b, "{hash:#018x}");
}
