//! Forests in the compact form.

use super::growth::stand;
use super::saved::{finish, stopped_at};
use treesynth::glam::Vec3;
use treesynth::self_organizing::{Environment, Forest, Habit, ShadowPropagation, SpaceColonization};
use treesynth::shape::Sphere;

/// In the compact form.
fn packed<E: Environment + serde::Serialize + serde::de::DeserializeOwned>(
    forest: &Forest<E>,
) -> (Forest<E>, usize) {
    let mut bytes = Vec::new();
    forest.write_compact(&mut bytes).expect("a forest can be written");
    let read = Forest::read_compact(&bytes[..]).expect("what was just written");
    // Nothing is lost of what JSON has.
    let text = |forest: &Forest<E>| serde_json::to_string(forest).expect("a forest can be written");
    assert_eq!(text(&read), text(forest));
    (read, bytes.len())
}

/// At any moment, under both environments, and in a seventh of the bytes of JSON.
#[test]
fn the_compact_form_is_the_same_forest() {
    for seed in 1..=3 {
        let straight = finish(stand(seed), 8);
        for stop in 0..30 {
            let forest = stopped_at(seed, stop);
            let (read, _) = packed(&forest);
            assert_eq!(read.trees(), forest.trees());
            assert_eq!(finish(read, 8), straight, "seed {seed}, stopped at report {stop}");
        }
        let mut forest = stand(seed).with_parts(3).with_most_metamers(400_000).with_most_trees(77);
        forest.grow(14).expect("no limit is near");
        let node = forest.trees()[0].ids().nth(5).expect("it has grown");
        forest.cut(0, node).expect("it stands");
        let (read, bytes) = packed(&forest);
        let text = serde_json::to_string(&forest).expect("a forest can be written").len();
        assert!(
            bytes < 21 * forest.metamers() && 6 * bytes < text,
            "{bytes} of {text}, {}",
            forest.metamers()
        );
        assert_eq!(finish(read, 18), finish(forest, 18));
        let ball = Sphere::new(Vec3::Y * 0.5, 0.5);
        let space = SpaceColonization::in_shape(&ball, 1500, seed).expect("a sound shape");
        let mut forest = Forest::new(space, Habit::default(), seed);
        forest.plant(Vec3::ZERO).expect("there is room");
        forest.grow(6).expect("no limit is near");
        assert_eq!(finish(packed(&forest).0, 12), finish(forest, 12));
    }
}

/// Damaged bytes are an error or another sound forest, and never more than that.
#[test]
fn damaged_bytes_are_refused() {
    let mut forest = stand(1);
    forest.grow(4).expect("no limit is near");
    let mut bytes = Vec::new();
    forest.write_compact(&mut bytes).expect("a forest can be written");
    let read = |bytes: &[u8]| Forest::<ShadowPropagation>::read_compact(bytes);
    for end in (0..bytes.len()).step_by(23) {
        assert!(read(&bytes[..end]).is_err(), "cut off at {end} of {}", bytes.len());
    }
    let mut refused = 0;
    for place in (0..bytes.len()).step_by(11) {
        let mut bent = bytes.clone();
        bent[place] ^= 1 << (place % 8);
        match read(&bent) {
            Err(_) => refused += 1,
            Ok(read) => {
                for tree in read.skeletons().expect("radii") {
                    tree.check().expect("a sound tree");
                }
            }
        }
    }
    assert!(refused * 20 > bytes.len() / 11, "{refused} of {}", bytes.len() / 11);
    assert!(read(b"treesynth forest 1\n\xff\xff\xff\xff\xff\xff\xff\xff{}").is_err());
    assert!(read(b"{}").is_err());
}
