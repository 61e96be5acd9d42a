//! The target that `TREESYNTH_FUZZ` names; without one, a list of them. `TREESYNTH_SEEDS` is a folder that gets files to begin with.
#![no_main]

mod targets;

use libfuzzer_sys::fuzz_target;
use std::sync::OnceLock;
use targets::Target;

static TARGET: OnceLock<Target> = OnceLock::new();

fn begin() {
    let name = std::env::var("TREESYNTH_FUZZ").unwrap_or_default();
    let Some(target) = targets::all().into_iter().find(|target| target.name == name) else {
        targets::all().iter().for_each(|target| println!("{}", target.name));
        std::process::exit(2);
    };
    if let Some(folder) = std::env::var_os("TREESYNTH_SEEDS") {
        for (number, seed) in target.seeds.iter().enumerate() {
            std::fs::write(std::path::Path::new(&folder).join(format!("seed-{number}")), seed)
                .expect("a folder");
        }
    }
    // libFuzzer's hook ends the program at a panic that is caught, as those of the decoder of LAZ are; what is not caught ends it
    // all the same.
    drop(std::panic::take_hook());
    let _ = TARGET.set(target);
}

fuzz_target!(init: begin(), |bytes: &[u8]| {
    let target = TARGET.get().expect("it has begun");
    (target.run)(bytes);
});
