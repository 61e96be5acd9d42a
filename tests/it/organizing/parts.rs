//! Seasons in parts: shoots in the shade of those that have just grown.

use super::forest_hash;
use super::growth::{PINNED, stand};
use treesynth::self_organizing::{Forest, Habit, SelfOrganizing, ShadowPropagation};

fn grown(parts: u32, seasons: u32) -> Forest {
    let mut forest = stand(1).with_parts(parts);
    forest.grow(seasons).expect("no limit is near");
    forest
}

#[test]
fn one_part_is_the_default() {
    assert_eq!(forest_hash(&grown(1, 12)), PINNED);
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let hashes = [1, 2, 8].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| [3, 64].map(|parts| forest_hash(&grown(parts, 12))))
    });
    assert!(hashes.iter().all(|&hash| hash == hashes[0]), "{hashes:x?}");
    assert_eq!(hashes[0], IN_PARTS, "equal seeds no longer give equal forests: a line for CHANGELOG.md");
}
const IN_PARTS: [u64; 2] = [0xee0b_c273_9a5e_fdfd, 0x72d4_40a9_aca2_9505];

#[cfg(feature = "json")]
#[test]
fn saved_forests_keep_their_parts() {
    let straight = forest_hash(&grown(3, 10));
    let saved = serde_json::to_value(grown(3, 6)).expect("a forest can be written");
    let mut read: Forest = serde_json::from_value(saved.clone()).expect("it has grown");
    read.grow(4).expect("no limit is near");
    assert_eq!(forest_hash(&read), straight);
    // Without them there is one.
    let mut without = saved;
    without.as_object_mut().expect("a map").remove("parts");
    let mut read: Forest = serde_json::from_value(without).expect("it has grown");
    let mut one = grown(3, 6).with_parts(1);
    read.grow(4).expect("no limit is near");
    one.grow(4).expect("no limit is near");
    assert_eq!(forest_hash(&read), forest_hash(&one));
    assert_ne!(forest_hash(&read), straight);
}

/// By the original's rules, bud after bud, one tree of the bench has 22,523 metamers on the mean of 32 seeds.
#[test]
fn three_parts_have_about_the_originals_metamers() {
    let mean = |parts: u32| {
        let metamers = |seed: u64| {
            let light = ShadowPropagation::default().with_falloff(1.5f32.sqrt());
            let mut tree = SelfOrganizing::new(light, Habit::default(), seed).with_parts(parts);
            tree.grow(20).expect("no limit is near");
            tree.metamers()
        };
        (1..=16).map(metamers).sum::<usize>() / 16
    };
    let (one, three) = (mean(1), mean(3));
    assert!(three.abs_diff(22_523) * 100 < 22_523 * 12, "{three}");
    assert!(one < three, "{one} {three}");
}
