//! Files are whole or not there, however a run ends.

mod common;

use common::World;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The small run whose files must stand, and a large one under the same names.
const SMALL: &[&str] =
    &["grow", "figure-06c", "--nodes", "500", "--textures", "none", "--format", "obj,glb,json"];
const LARGE: &[&str] =
    &["grow", "figure-06c", "--nodes", "20000", "--budget", "none", "--format", "obj,glb,json"];

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_the_old_files() {
    let world = World::new();
    world.run(SMALL).ok();
    let files = world.files();
    let old: Vec<Vec<u8>> = files.iter().map(|file| world.read(file)).collect();
    for (signal, status) in [("INT", Some(130)), ("TERM", Some(130)), ("KILL", None)] {
        let mut child = world.command(LARGE).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        // Amid the first file.
        let start = Instant::now();
        while !world.files().iter().any(|file| file.contains(".tmp"))
            && start.elapsed() < Duration::from_secs(60)
        {
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(
            Command::new("kill")
                .arg(format!("-{signal}"))
                .arg(child.id().to_string())
                .status()
                .unwrap()
                .success()
        );
        assert_eq!(child.wait().unwrap().code(), status, "{signal}");
        for (file, old) in files.iter().zip(&old) {
            assert!(world.read(file) == *old, "{signal}: {file}");
        }
        if signal != "KILL" {
            world.has_no_remains();
        }
    }
    // A killed run leaves files under other names, which do not trouble the next run.
    world.run(SMALL).ok();
}

#[test]
fn of_two_runs_at_once_one_has_all_files() {
    let world = World::new();
    let run = |seed: &'static str, out: &'static str| {
        world
            .command(&[SMALL, &["--seed", seed, "--out", out]].concat())
            .stdout(Stdio::null())
            .spawn()
            .unwrap()
    };
    let names = ["figure-06c.obj", "figure-06c.mtl", "figure-06c.glb", "figure-06c.json"];
    for (seed, out) in [("1", "a"), ("2", "b")] {
        assert!(run(seed, out).wait().unwrap().success());
    }
    for _ in 0..5 {
        for mut child in [run("1", "both"), run("2", "both")] {
            assert!(child.wait().unwrap().success());
        }
        let is_all = |of: &str| {
            names
                .iter()
                .all(|name| world.read(&format!("both/{name}")) == world.read(&format!("{of}/{name}")))
        };
        assert!(is_all("a") || is_all("b"));
    }
    world.has_no_remains();
}
