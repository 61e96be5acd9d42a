//! Properties of every kind of bark.

use super::*;

const AGES: [f32; 3] = [0.0, 0.5, 1.0];

/// All kinds with some seeds, ages and sizes in pixels.
fn each(pixels: &[u32], seeds: u64, mut check: impl FnMut(&Bark, &BarkSet)) {
    for kind in BarkKind::ALL {
        for seed in 0..seeds {
            for age in AGES {
                for &pixels in pixels {
                    let bark = Bark::of_kind(kind).with_age(age).with_seed(seed).with_resolution(pixels);
                    check(&bark, &bark.bake().expect("options are in range"));
                }
            }
        }
    }
}

fn maps(set: &BarkSet) -> [&Image; 4] {
    let textures = &set.textures;
    let all = [textures.base_color(), textures.normal(), textures.occlusion_roughness_metallic()];
    let [color, normal, fine] = all.map(|map| map.expect("a bark has all three"));
    [color, normal, fine, &set.height]
}

/// Mean difference between pairs of neighbours along each line across x (or y): the first entry is the seam.
fn differences(image: &Image, down: bool) -> Vec<f32> {
    let side = image.width();
    let pixel =
        |along: u32, across: u32| if down { image.pixel(across, along) } else { image.pixel(along, across) };
    let between = |along: u32| -> f32 {
        let pairs = (0..side).flat_map(|across| {
            let (here, before) = (pixel(along, across), pixel(along + side - 1, across));
            here.iter().zip(before).map(|(a, b)| f32::from(a.abs_diff(*b)))
        });
        pairs.sum::<f32>() / (side * u32::from(image.channels())) as f32
    };
    (0..side).map(between).collect()
}

#[test]
fn opposite_edges_continue() {
    each(&[16, 64, 128], 2, |bark, set| {
        // Among few pairs of lines the seam's may be the most different by chance.
        let chance = if bark.resolution == 16 { 1.4 } else { 1.1 };
        for (number, map) in maps(set).into_iter().enumerate() {
            for down in [false, true] {
                let all = differences(map, down);
                let inside = all[1..].iter().fold(0.0, |most: f32, &d| most.max(d));
                assert!(
                    all[0] <= chance * inside + 0.5,
                    "{} > {inside}: map {number}, {down}, {bark:?}",
                    all[0]
                );
            }
        }
    });
}

#[test]
fn normals_are_of_unit_length_and_the_slopes_of_the_heights() {
    each(&[64], 2, |bark, set| {
        let [_, normals, _, heights] = maps(set);
        let side = bark.resolution;
        let step = set.size / side as f32;
        let normal =
            |x, y| -> [f32; 3] { std::array::from_fn(|i| f32::from(normals.pixel(x, y)[i]) / 127.5 - 1.0) };
        let height = |x: u32, y: u32| f32::from(heights.pixel(x, y)[0]) / 255.0 * set.depth;
        let rounding = 0.5 / 127.5;
        for line in 0..side {
            for down in [false, true] {
                let (mut climb, mut bound) = (0.0, 1.02 * set.depth / 255.0);
                let at = |i: u32| if down { (line, i) } else { (i, line) };
                for i in 4..side - 4 {
                    let (x, y) = at(i);
                    let [nx, ny, nz] = normal(x, y);
                    let length = (nx * nx + ny * ny + nz * nz).sqrt();
                    assert!((length - 1.0).abs() < 1.8 * rounding, "{length} in {bark:?}");
                    // Up the image is +Y, and rows go down.
                    let slope = if down { ny / nz } else { -nx / nz };
                    climb += slope * step;
                    bound += 1.3 * step * rounding * (1.0 + slope.abs()) / nz;
                }
                let end = |a: u32, b: u32| {
                    let ((ax, ay), (bx, by)) = (at(a), at(b));
                    0.5 * (height(ax, ay) + height(bx, by))
                };
                let expected = end(side - 4, side - 5) - end(4, 3);
                assert!((climb - expected).abs() <= bound, "{climb} for {expected} (+- {bound}) in {bark:?}");
            }
        }
    });
}

fn mean_color(image: &Image) -> [f32; 3] {
    let mut sum = [0.0f64; 3];
    for pixel in image.bytes().chunks_exact(3) {
        for (sum, &channel) in sum.iter_mut().zip(pixel) {
            *sum += f64::from(math::linear(f32::from(channel) / 255.0));
        }
    }
    let pixels = f64::from(image.width() * image.height());
    sum.map(|sum| math::srgb((sum / pixels) as f32) * 255.0)
}

#[test]
fn the_mean_color_is_the_one_asked_for() {
    let check = |bark: &Bark, set: &BarkSet| {
        let mean = mean_color(maps(set)[0]);
        for (mean, wanted) in mean.into_iter().zip(bark.color) {
            assert!((mean - f32::from(wanted)).abs() < 2.0, "{mean} for {wanted} in {bark:?}");
        }
    };
    each(&[16, 128], 2, check);
    for kind in BarkKind::ALL {
        for (color, spread) in [([90, 60, 40], 0.0), ([60, 90, 120], 1.6), ([200, 190, 180], 0.7)] {
            let bark = Bark::of_kind(kind).with_color(color).with_spread(spread).with_resolution(64);
            check(&bark, &bark.bake().expect("options are in range"));
            let young = bark.young();
            check(&young, &young.bake().expect("options are in range"));
        }
    }
}

#[test]
fn old_bark_is_rougher_than_young() {
    for kind in [BarkKind::Ridged, BarkKind::Netted, BarkKind::Plated, BarkKind::Scaly, BarkKind::Stringy] {
        let slope = |age| {
            let set = Bark::of_kind(kind).with_age(age).with_resolution(256).bake().expect("in range");
            let up = maps(&set)[1].bytes().chunks_exact(3).map(|normal| f64::from(normal[2])).sum::<f64>();
            255.0 - up / (256.0 * 256.0)
        };
        let [young, middle, old] = [0.05, 0.4, 1.0].map(slope);
        assert!(young < middle && middle < old && old > 4.0 * young, "{kind:?}: {young} {middle} {old}");
    }
}

/// Fowler, Noll and Vo's hash of all bytes.
fn hash(set: &BarkSet) -> u64 {
    let bytes = maps(set).into_iter().flat_map(|map| map.bytes().iter().copied());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn bits_are_pinned() {
    let hashes = BarkKind::ALL.map(|kind| {
        hash(&Bark::of_kind(kind).with_seed(7).with_resolution(64).bake().expect("options are in range"))
    });
    assert_eq!(hashes, PINNED, "{hashes:#x?}");
}
const PINNED: [u64; 11] = [
    0x95f4_a6b1_4957_c28b,
    0x894f_6842_b5ef_3f9a,
    0x2e27_a17c_6f24_a3a0,
    0x8d21_3b71_1151_73b1,
    0x6b93_4171_2a53_3174,
    0x4430_baf1_c673_040d,
    0x67de_7032_62a0_fca5,
    0xaa3f_8676_ee34_e397,
    0x5fb0_8975_fad3_311e,
    0x2931_c810_ddad_4a73,
    0x623e_654e_ca56_b714,
];

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_matter() {
    let with = |threads: usize, bark: &Bark| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        pool.install(|| bark.bake().expect("options are in range"))
    };
    for kind in BarkKind::ALL {
        let bark = Bark::of_kind(kind).with_resolution(128).with_spread(1.2);
        assert!(with(1, &bark) == with(2, &bark), "{kind:?}");
    }
}

#[test]
fn seeds_and_ages_matter() {
    for kind in BarkKind::ALL {
        let bark = Bark::of_kind(kind).with_resolution(32);
        let bake = |bark: Bark| bark.bake().expect("options are in range").textures;
        assert!(bake(bark.clone()) != bake(bark.clone().with_seed(1)), "{kind:?}");
        assert!(bake(bark.clone()) != bake(bark.clone().with_age(0.3)), "{kind:?}");
    }
}

#[test]
fn what_is_wrong_is_named() {
    let bark = Bark::oak;
    for (wrong, name) in [
        (bark().with_size(0.0), "Bark.size"),
        (bark().with_size(f32::NAN), "Bark.size"),
        (bark().with_depth(-0.1), "Bark.depth"),
        (bark().with_depth(0.2), "Bark.depth"),
        (bark().with_age(1.5), "Bark.age"),
        (bark().with_age(f32::NAN), "Bark.age"),
        (bark().with_spread(3.0), "Bark.spread"),
        (bark().with_resolution(0), "Bark.resolution"),
        (bark().with_resolution(8), "Bark.resolution"),
        (bark().with_resolution(1000), "Bark.resolution"),
        (bark().with_resolution(16384), "Bark.resolution"),
    ] {
        let error = wrong.bake().expect_err("out of range").to_string();
        assert!(error.starts_with(name), "{error}");
    }
}
