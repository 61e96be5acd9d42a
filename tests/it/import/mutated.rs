//! Every fuzz target under thousands of bent files: no panic, no hang, no more memory than the file calls for.

#[path = "../../fuzz/targets/mod.rs"]
mod targets;

use std::panic::catch_unwind;
use treesynth::rand::{Rng, RngExt};
use treesynth::random::{Purpose, stream};

/// Number of runs of each target; more by `TREESYNTH_MUTATIONS`.
fn runs() -> u64 {
    std::env::var("TREESYNTH_MUTATIONS").ok().and_then(|runs| runs.parse().ok()).unwrap_or(20_000)
}

/// Words that break readers.
const WORDS: [&[u8]; 26] = [
    b"-1",
    b"0",
    b"4294967295",
    b"4294967296",
    b"18446744073709551615",
    b"-9223372036854775808",
    b"1e39",
    b"1e400",
    b"nan",
    b"inf",
    b"\\\n",
    b"\r",
    b"\n",
    b" ",
    b"#",
    b"/",
    b"f ",
    b"v ",
    b"solid ",
    b"endloop",
    b"vertex ",
    b"end_header\n",
    b"element none 4294967295\n",
    b"property list uint uint many\n",
    b"\xFF\xFF\xFF\xFF",
    b"\0\0\0\0",
];

fn bend(bytes: &mut Vec<u8>, random: &mut impl Rng) {
    for _ in 0..random.random_range(1..6) {
        let at = random.random_range(0..bytes.len().max(1)).min(bytes.len());
        let end = (at + random.random_range(0..20_usize)).min(bytes.len());
        match random.random_range(0..8) {
            0 if at < bytes.len() => bytes[at] = random.random(),
            1 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let part = bytes[at..end].to_vec();
                let to = random.random_range(0..=bytes.len());
                bytes.splice(to..to, part);
            }
            4 => bytes.truncate(at),
            5 => bytes
                .splice(at..end, WORDS[random.random_range(0..WORDS.len())].iter().copied())
                .for_each(drop),
            6 => bytes
                .splice(at..at, WORDS[random.random_range(0..WORDS.len())].iter().copied())
                .for_each(drop),
            _ => {
                // A number for a number.
                let digits = |byte: &u8| byte.is_ascii_digit();
                if let Some(start) = bytes[at..].iter().position(digits).map(|start| at + start) {
                    let end = bytes[start..]
                        .iter()
                        .position(|byte| !digits(byte))
                        .map_or(bytes.len(), |end| start + end);
                    let number = random.random::<u64>() >> random.random_range(0..64);
                    bytes.splice(start..end, number.to_string().into_bytes()).for_each(drop);
                }
            }
        }
    }
}

/// Runs a target on bent files; a panic names the file.
fn run(name: &str, share: u64) {
    let target =
        targets::all().into_iter().find(|target| target.name == name).expect("a target of that name");
    let (mut taken, runs) = (0, runs() / share);
    for run in 0..runs {
        let mut random = stream(run, 0, Purpose::CUSTOM, 1);
        let mut bytes = target.seeds[random.random_range(0..target.seeds.len())].clone();
        bend(&mut bytes, &mut random);
        let start = std::time::Instant::now();
        let outcome = catch_unwind(|| (target.run)(&bytes));
        assert!(outcome.is_ok(), "{name}, run {run}: {:?}", String::from_utf8_lossy(&bytes));
        taken += u64::from(outcome.unwrap_or_default());
        assert!(start.elapsed().as_secs() < 20, "{name}, run {run} took {:?}", start.elapsed());
    }
    assert!(taken > 0 && taken < runs, "{name}: {taken} of {runs} were taken");
}

macro_rules! bent {
    ($($name:ident: $share:literal),* $(,)?) => {
        $(#[test]
        fn $name() {
            run(stringify!($name), $share);
        })*

        #[test]
        fn every_target_is_here() {
            let names: Vec<_> = targets::all().iter().map(|target| target.name).collect();
            assert_eq!(names, [$(stringify!($name)),*]);
        }
    };
}

// Each with the share of the runs that its work leaves time for, one of so many.
bent! {
    obj: 1, stl: 2, ply: 1, gltf: 1, path: 1, svg: 1, qsm: 1, swc: 1, mtg: 1, xyz: 1, cloud: 1, las: 100, e57: 1,
    skeleton: 1, recipe: 1, species: 4, forest: 4, colonization: 4, compact: 4,
    tubes: 40, implicit: 20, skin: 20, leaves: 4, bark: 20, picture: 200, radii: 1, pipeline: 200,
    example: 40, landscape: 40, stand: 40,
}
