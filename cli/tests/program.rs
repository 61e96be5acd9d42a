//! The program as a user or a script meets it: exit status, output, files.

mod common;

use common::{Run, World, cube, heart};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write;

#[test]
fn everything_is_listed_for_people_and_for_programs() {
    let world = World::new();
    let all = world.run(&["list", "--json"]).json();
    let all = all.as_array().unwrap().clone();
    assert!(all.len() > 100, "{}", all.len());
    let kinds: BTreeSet<&str> = all.iter().map(|entry| entry["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, BTreeSet::from(["preset", "shape", "species", "stand", "years"]));
    let species = world.run(&["list", "species", "--json"]).json();
    for entry in species.as_array().unwrap() {
        for range in ["height", "dbh", "age"] {
            let [low, high] = [0, 1].map(|i| entry[range][i].as_f64().unwrap());
            assert!(0.0 < low && low < high, "{entry}");
        }
    }
    let text = world.run(&["list", "--find", "betula"]).ok();
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.starts_with("grow    silver birch"), "{text}");
    assert!(world.files().is_empty());
}

#[test]
fn a_species_becomes_every_kind_of_file() {
    let world = World::new();
    let run = world.run(&[
        "grow",
        "Betula pendula",
        "--height",
        "4",
        "--seed",
        "3",
        "--budget",
        "2000",
        "--textures",
        "128",
        "--levels",
        "2",
        "--size",
        "100",
        "--format",
        "glb,obj,ply,stl,usdz,usda,png,svg,json,swc,qsm,mtg",
        "--out",
        "o",
        "--json",
    ]);
    assert!(run.errors.is_empty(), "no bar on a pipe: {}", run.errors);
    let report = run.json();
    assert_eq!((report["name"].as_str(), report["seed"].as_u64()), (Some("silver birch"), Some(3)));
    assert!((report["numbers"]["height"].as_f64().unwrap() - 4.0).abs() < 0.04);
    let triangles: Vec<u64> =
        report["triangles"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect();
    // Two levels and an impostor.
    assert!(triangles.len() == 3 && triangles[0] <= 2000 && triangles[1] <= 600, "{triangles:?}");
    let files: Vec<&str> =
        report["files"].as_array().unwrap().iter().map(|file| file.as_str().unwrap()).collect();
    assert_eq!(files.len(), 12);
    for file in files {
        assert!(world.read(file).len() > 100, "{file}");
    }
    assert!(world.read("o/silver-birch.glb").starts_with(b"glTF"));
    assert!(world.files().iter().any(|file| file == "o/silver-birch.mtl"));
    world.has_no_remains();
    // Each skeleton is the same tree.
    let of = |file: &str| world.run(&["measure", file, "--json"]).json()[0]["metrics"].clone();
    let first = of("o/silver-birch.json");
    for file in ["o/silver-birch.swc", "o/silver-birch.csv", "o/silver-birch.mtg"] {
        let other = of(file);
        for measure in ["nodes", "tips", "height", "total_length"] {
            assert_eq!(other[measure], first[measure], "{file}: {measure}");
        }
    }
}

#[test]
fn the_same_command_gives_the_same_bytes_on_any_number_of_threads() {
    let world = World::new();
    for (threads, out) in [("1", "a"), ("3", "b")] {
        let arguments = [
            "--nodes",
            "3000",
            "--textures",
            "128",
            "--format",
            "glb,json",
            "--threads",
            threads,
            "--out",
            out,
        ];
        world.run(&[&["grow", "figure-06c"], &arguments[..]].concat()).ok();
    }
    // Nodes before refinement, and what is in the model, part by part.
    let report = world.run(&["grow", "fine-oak", "--nodes", "3000", "--format", "obj", "--json"]).json();
    let parts = report["parts"].as_object().unwrap();
    let sum: u64 = parts.values().map(|part| part["triangles"].as_u64().unwrap()).sum();
    assert_eq!(report["triangles"][0], sum);
    assert!(parts.contains_key("bark") && parts.contains_key("cards"), "{parts:?}");
    for file in ["figure-06c.glb", "figure-06c.json"] {
        assert!(world.read(&format!("a/{file}")) == world.read(&format!("b/{file}")), "{file}");
    }
}

#[test]
fn a_species_of_ones_own_grows() {
    let world = World::new();
    std::fs::write(world.path("my.toml"), "name = \"my tree\"\nlatin = \"Arbor mea\"\n").unwrap();
    let report = world
        .run(&["grow", "--species-file", "my.toml", "--height", "3", "--format", "json", "--json"])
        .json();
    assert_eq!(report["name"], "my tree");
    assert!(world.files().contains(&"out/my-tree.json".to_owned()));
    std::fs::write(world.path("bad.toml"), "name = \"my tree\"\nheigth = 3\n").unwrap();
    let error = world.run(&["grow", "--species-file", "bad.toml"]).failed(1);
    assert!(error.contains("--species-file bad.toml") && error.contains("heigth"), "{error}");
}

#[test]
fn shapes_are_filled_from_meshes_drawings_and_presets() {
    let world = World::new();
    // Capitals are no other kind.
    std::fs::write(world.path("CUBE.OBJ"), cube()).unwrap();
    std::fs::write(world.path("heart.svg"), heart()).unwrap();
    for (shape, file) in
        [("CUBE.OBJ", "cube"), ("heart.svg", "heart"), ("variational-14-oak", "variational-14-oak")]
    {
        let report = world
            .run(&[
                "shape",
                shape,
                "--nodes",
                "60",
                "--format",
                "glb,json",
                "--textures",
                "none",
                "--energy",
                "--json",
            ])
            .json();
        assert!(world.read(&format!("out/{file}.energy.png")).starts_with(b"\x89PNG"));
        assert!(report["internodes"].as_u64().unwrap() > 60, "{report}");
        assert!(world.read(&format!("out/{file}.glb")).starts_with(b"glTF"));
    }
    let tall = world
        .run(&["shape", "CUBE.OBJ", "--height", "3", "--nodes", "2000", "--format", "json", "--json"])
        .json();
    let height = tall["metrics"]["height"].as_f64().unwrap();
    assert!((3.0..=3.8).contains(&height), "{height}");
}

#[test]
fn stands_and_forests_of_species_grow() {
    let world = World::new();
    let stand = world
        .run(&[
            "forest",
            "stand-shyness",
            "--seasons",
            "4",
            "--size",
            "64",
            "--animation",
            "--models",
            "--json",
        ])
        .json();
    assert_eq!((stand["seasons"].as_u64(), stand["trees"].as_u64()), (Some(4), Some(9)));
    // The last season's files are those of the stand.
    assert!(world.read("out/stand-shyness/004.png") == world.read("out/stand-shyness.png"));
    assert!(world.read("out/stand-shyness/004.glb").starts_with(b"glTF"));
    let pictures = |file: &str| {
        let bytes = world.read(file);
        bytes.windows(4).filter(|chunk| chunk == b"fcTL").count()
    };
    assert_eq!(pictures("out/stand-shyness.apng"), 4);
    let film = ["--seasons", "4", "--size", "64", "--animation", "--frames", "3", "--name", "film"];
    world.run(&[&["forest", "stand-shyness", "--format", "png"], &film[..]].concat()).ok();
    assert_eq!(pictures("out/film.apng"), 12);
    let forest = world
        .run(&[
            "forest",
            "hazel",
            "beech",
            "--trees",
            "7",
            "--variants",
            "1",
            "--height",
            "4",
            "--spacing",
            "3",
            "--budget",
            "500",
            "--textures",
            "128",
            "--size",
            "64",
            "--format",
            "glb,png",
            "--json",
        ])
        .json();
    let counts: u64 =
        forest["species"].as_array().unwrap().iter().map(|kind| kind[1].as_u64().unwrap()).sum();
    assert_eq!((counts, forest["different"].as_u64()), (7, Some(2)));
    assert!(forest["triangles"].as_u64().unwrap() <= 7 * 500);
    // Each mesh is in the file once.
    assert!(world.read("out/forest-hazel-beech.glb").starts_with(b"glTF"));
    world.has_no_remains();
}

#[test]
fn trees_grow_over_the_years() {
    let world = World::new();
    let report = world
        .run(&[
            "years",
            "cottonwood",
            "--age",
            "6.5",
            "--frames",
            "2",
            "--size",
            "64",
            "--format",
            "glb,png,json",
            "--json",
        ])
        .json();
    assert_eq!(report["age"], 6.5);
    for file in [".glb", ".png", ".json", ".apng", "-sheet.png"] {
        assert!(!world.read(&format!("out/growth-15-cottonwood{file}")).is_empty(), "{file}");
    }
    let span = ["--from", "2.6", "--to", "4.6", "--frames", "3", "--stills", "--no-sheet", "--size", "64"];
    for (name, look) in [("tubes", None), ("skin", Some("--skin"))] {
        let options = [&["years", "cottonwood", "--format", "json", "--name", name], &span[..]].concat();
        world.run(&options.into_iter().chain(look).collect::<Vec<_>>()).ok();
        assert!(world.read(&format!("out/{name}/0002.png")).starts_with(b"\x89PNG"));
    }
    assert!(world.read("out/tubes/0002.png") != world.read("out/skin/0002.png"));
    // Models in a skin: colours and all, in every format of triangles.
    let formats = "glb,obj,ply,stl,usdz";
    let model = ["--frames", "0", "--no-sheet", "--surface", "skin", "--format", formats, "--name", "model"];
    for (name, age) in [("cottonwood", "2.6"), ("norway-maple", "3.6")] {
        let report = world.run(&[&["years", name, "--age", age, "--json"], &model[..]].concat()).json();
        assert!(report["triangles"][0].as_u64().unwrap() > 5000, "{report}");
        for ending in formats.split(',') {
            assert!(world.read(&format!("out/model.{ending}")).len() > 100_000, "{ending}");
        }
        let header = world.read("out/model.ply");
        assert!(String::from_utf8_lossy(&header[..600]).contains("red"), "no colours");
    }
    world.has_no_remains();
}

#[test]
fn files_are_converted_there_and_back() {
    let world = World::new();
    world.run(&["grow", "hazel", "--height", "3", "--format", "json", "--name", "a"]).ok();
    let first: Value = serde_json::from_slice(&world.read("out/a.json")).unwrap();
    let mut from = "out/a.json".to_owned();
    for to in ["b.mtg", "c.swc", "deep/er/d.json", "e.glb", "f.stl", "g.obj", "h.svg", "i.png", "j.usdz"] {
        world.run(&["convert", &from, to]).ok();
        assert!(world.read(to).len() > 100, "{to}");
        if ["b.mtg", "c.swc", "deep/er/d.json"].contains(&to) {
            from = to.to_owned();
        }
    }
    let last: Value = serde_json::from_slice(&world.read("deep/er/d.json")).unwrap();
    for kept in ["positions", "parents", "radii"] {
        assert_eq!(last[kept], first[kept], "{kept}");
    }
    // Other axes and another unit there, and the same on the way back.
    world.run(&["convert", "out/a.json", "mm.swc", "--up", "y", "--unit", "0.001"]).ok();
    world.run(&["convert", "mm.swc", "back.json", "--up-in", "y", "--unit-in", "0.001"]).ok();
    let height =
        |file: &str| world.run(&["measure", file, "--json"]).json()[0]["metrics"]["height"].as_f64().unwrap();
    assert!((height("back.json") - height("out/a.json")).abs() < 1e-5);
    world.has_no_remains();
}

#[test]
fn points_are_thinned_and_made_a_tree() {
    let world = World::new();
    // A trunk of 10 cm and 3 m in a survey's coordinates.
    let mut text = String::new();
    for ring in 0..300 {
        for side in 0..24 {
            let angle = f64::from(side) * std::f64::consts::TAU / 24.0;
            let (x, y) = (
                478_123.0 + 0.1 * libm_cos(angle),
                5_429_876.0 + 0.1 * libm_cos(angle - std::f64::consts::FRAC_PI_2),
            );
            writeln!(text, "{x:.4} {y:.4} {:.4}", 211.0 + f64::from(ring) * 0.01).unwrap();
        }
    }
    std::fs::write(world.path("scan.xyz"), &text).unwrap();
    world.run(&["convert", "scan.xyz", "thin.ply", "--thin", "0.05"]).ok();
    world.run(&["convert", "thin.ply", "again.xyz"]).ok();
    let thin = String::from_utf8(world.read("again.xyz")).unwrap();
    assert!(thin.lines().count() < 2000 && thin.starts_with("47812"), "{}", &thin[..60]);
    let measured = world.run(&["measure", "scan.xyz", "--json"]).json();
    let [height, diameter] =
        ["height", "breast_height_diameter"].map(|what| measured[0]["metrics"][what].as_f64().unwrap());
    assert!((height - 3.0).abs() < 0.2 && (diameter - 0.2).abs() < 0.02, "{height} {diameter}");
    world.run(&["convert", "scan.xyz", "tree.csv"]).ok();
    // Back in the survey's coordinates.
    assert!(String::from_utf8(world.read("tree.csv")).unwrap().contains("478123"));
}

#[test]
fn help_completion_and_pipes_work() {
    let world = World::new();
    for command in ["list", "grow", "shape", "forest", "years", "measure", "convert", "completions"] {
        let help = world.run(&[command, "--help"]).ok();
        assert!(help.contains("Examples:"), "{help}");
    }
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = world.run(&["completions", shell]).ok();
        assert!(script.contains("stand-spacing"), "{shell}");
    }
    assert!(world.run(&["--version"]).ok().starts_with("treesynth "));
    // A reader that closes the pipe is no error.
    world.run_closed(&["list"]).ok();
    let Run { status, .. } = world.run(&[]);
    assert_eq!(status, Some(2));
}

fn libm_cos(angle: f64) -> f64 {
    // Of a test's circle, to 1e-6.
    let mut angle = angle % std::f64::consts::TAU;
    if angle > std::f64::consts::PI {
        angle -= std::f64::consts::TAU;
    }
    let square = angle * angle;
    (1..12).rev().fold(1.0, |sum, i| 1.0 - sum * square / f64::from((2 * i - 1) * 2 * i))
}
