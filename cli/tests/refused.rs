//! Impossible values are refused before work begins, by the option's name, its value and
//! the allowed range.

mod common;

use common::{World, cube, heart};
use std::fs;

/// Runs that are refused, and what the message must have.
#[test]
fn wrong_command_lines_name_the_option_its_value_and_what_is_allowed() {
    let world = World::new();
    fs::write(world.path("cube.obj"), cube()).unwrap();
    fs::write(world.path("heart.svg"), heart()).unwrap();
    fs::write(world.path("tree.swc"), "1 1 0 0 0 0.1 -1\n2 1 0 0 1 0.1 1\n").unwrap();
    let cases: &[(&[&str], &[&str])] = &[
        (&["grow", "oak", "--seed", "-1"], &["--seed", "'-1'", "0 to 18446744073709551615"]),
        (&["grow", "oak", "--seed", "18446744073709551616"], &["--seed", "0 to 18446744073709551615"]),
        (&["grow", "fine-oak", "--nodes", "5"], &["--nodes", "'5'", "100 to 200000000"]),
        (&["grow", "fine-oak", "--nodes", "0"], &["--nodes", "'0'", "100 to 200000000"]),
        (&["grow", "fine-oak", "--nodes", "1000000000"], &["--nodes", "'1000000000'", "100 to 200000000"]),
        (&["grow", "fine-oak", "--nodes", "1e9"], &["--nodes", "'1e9'", "100 to 200000000"]),
        (&["grow", "fine-oak", "--nodes", "abc"], &["--nodes", "'abc'", "100 to 200000000"]),
        (&["grow", "oak", "--nodes", "5000"], &["--nodes", "species"]),
        (&["grow", "oak", "--season", "autumn"], &["--season", "--day"]),
        (&["grow", "fine-oak", "--height", "5"], &["--height", "fine-oak", "preset"]),
        (&["grow", "oak", "--height", "NaN"], &["--height", "'NaN'", "0.01 to 1000 m"]),
        (&["grow", "oak", "--height", "-5"], &["--height", "'-5'", "0.01 to 1000 m"]),
        (&["grow", "silver birch", "--height", "60"], &["--height 60", "silver birch", "must be 2 to"]),
        (&["grow", "oak", "--age", "5000"], &["--age 5000", "must be 1 to"]),
        (&["grow", "oak", "--day", "367"], &["--day", "'367'", "1 to 366"]),
        (&["grow", "oak", "--height", "20", "--dbh", "0.05"], &["--height 20 --dbh 0.05", "must be"]),
        (&["grow", "oak", "--textures", "500"], &["--textures", "'500'", "power of two"]),
        (&["grow", "oak", "--budget", "99"], &["--budget", "'99'", "100 to 100000000"]),
        (&["grow", "oak", "--levels", "9"], &["--levels", "'9'", "1 to 8"]),
        (&["grow", "oak", "--size", "0"], &["--size", "'0'", "16 to 8192 pixels"]),
        (&["grow", "oak", "--format", "fbx"], &["--format", "'fbx'", "glb"]),
        (&["grow", "oak", "--format", ""], &["--format"]),
        (&["grow", "oak", "--out", ""], &["--out", "value is required"]),
        (&["grow", "oak", "--name", "../up"], &["--name", "'../up'"]),
        (&["grow", "oak", "--surface", "closed", "--wind"], &["--wind", "--surface"]),
        (&["grow", "oak", "--detail", "2"], &["--detail", "--surface"]),
        (&["grow", "oak", "--surface", "skin", "--levels", "2"], &["--levels", "--surface skin"]),
        (&["forest", "oak", "--surface", "skin"], &["skin", "species"]),
        (&["grow", "oka"], &["\"oka\"", "near names"]),
        (&["grow", ""], &["must not be empty"]),
        (&["grow"], &["NAME"]),
        (&["grow", "stand-wall"], &["stand-wall", "treesynth forest"]),
        (&["grow", "variational-14-oak"], &["treesynth shape"]),
        (&["grow", "growth-15-cottonwood"], &["treesynth years"]),
        (&["grow", "oak", "--threads", "0"], &["--threads", "'0'", "1 to 1024"]),
        (&["forest", "stand-wall", "--seasons", "-1"], &["--seasons", "'-1'", "1 to 200"]),
        (&["forest", "stand-wall", "--seasons", "4294967295"], &["--seasons", "1 to 200 seasons"]),
        (&["forest", "stand-wall", "--size", "0"], &["--size", "16 to 8192"]),
        (&["forest", "stand-wall", "--trees", "4"], &["--trees", "stand-wall"]),
        (&["forest", "stand-wall", "--day", "200"], &["--day", "stand-wall"]),
        (&["forest", "stand-wall", "--frames", "2"], &["--animation"]),
        (
            &["forest", "stand-wall", "--animation", "--frames", "25"],
            &["--frames", "'25'", "1 to 24 pictures"],
        ),
        (&["forest", "oak", "--models"], &["--models", "species"]),
        (&["forest", "oak", "--seasons", "4"], &["--seasons", "species"]),
        (&["forest", "oak", "stand-wall"], &["stand-wall", "alone"]),
        (&["forest", "oak", "--format", "glb,json"], &["--format json", "many"]),
        (&["forest", "oak", "--height", "500"], &["--height 500", "must be"]),
        (&["shape", "cube.obj", "heart.svg"], &["heart.svg"]),
        (&["shape", "cube.obj", "--nodes", "1"], &["--nodes", "'1'", "4 to 10000000 shape nodes"]),
        (&["shape", "cube.obj", "--height", "NaN"], &["--height", "'NaN'", "0.01 to 10000"]),
        (&["shape", "cube.obj", "--height", "0"], &["--height", "'0'", "0.01 to 10000"]),
        (&["shape", "cube.obj", "--height", "-5"], &["--height", "'-5'", "0.01 to 10000"]),
        (&["shape", "heart.svg", "--up-in", "z"], &["--up-in", "mesh"]),
        (&["shape", "variational-14-oak", "--height", "3"], &["--height", "preset"]),
        (&["shape", "tree.swc"], &["tree.swc", ".obj"]),
        (&["shape", "cube.obj", "--size", "1"], &["--size", "16 to 8192"]),
        (&["years", ""], &["must not be empty"]),
        (&["years", "cottonwood", "--age", "99"], &["--age is 99", "0 to"]),
        (&["years", "cottonwood", "--age", "0"], &["--age is 0", "sprouted"]),
        (&["years", "cottonwood", "--frames", "1"], &["--frames is 1", "2 to 1000"]),
        (&["years", "cottonwood", "--from", "5", "--to", "4"], &["--from is 5 and --to is 4", "below"]),
        (&["years", "cottonwood", "--to", "99"], &["--to is 99", "0 to"]),
        (&["years", "silver birch"], &["\"silver birch\"", "species"]),
        (&["measure"], &["FILE"]),
        (&["measure", "tree.xml"], &["tree.xml", "--from"]),
        (&["measure", "tree.swc", "--height", "3"], &["--height", "--species"]),
        (&["measure", "x.json", "--up-in", "z"], &["x.json", "--up-in"]),
        (&["measure", "--species", "oak", "--unit-in", "2"], &["--unit-in", "files"]),
        (&["convert", "tree.swc", "tree.xyz"], &["tree.xyz", "no points"]),
        (&["convert", "tree.swc", "tree.fbx"], &["tree.fbx", ".glb"]),
        (&["convert", "tree.swc", "tree.glb", "--up", "z"], &["--up", "glb"]),
        (&["convert", "tree.swc", "tree.json", "--thin", "1"], &["--thin", "points"]),
        (&["convert", "tree.swc", "tree.json", "--tree", "2"], &["--tree is 2", "1 to 1"]),
        (&["list", "trees"], &["'trees'", "species"]),
        (&["plant"], &["'plant'"]),
    ];
    for (arguments, texts) in cases {
        let error = world.run(arguments).failed(2);
        for text in *texts {
            assert!(error.contains(text), "{arguments:?}: no {text:?} in {error}");
        }
    }
    // Nothing was grown, nothing written.
    assert_eq!(world.files(), ["cube.obj", "heart.svg", "tree.swc"]);
}

#[test]
fn files_that_cannot_be_read_or_written_are_named() {
    let world = World::new();
    fs::write(world.path("afile"), "").unwrap();
    fs::write(world.path("cube.obj"), cube()).unwrap();
    fs::write(world.path("bad.swc"), "1 1 0 0 zero 0.1 -1\n").unwrap();
    fs::write(world.path("bad.json"), "{").unwrap();
    fs::write(world.path("blank.svg"), "<svg xmlns=\"http://www.w3.org/2000/svg\"/>").unwrap();
    fs::create_dir(world.path("folder.obj")).unwrap();
    fs::create_dir(world.path("folder.json")).unwrap();
    let cases: &[(&[&str], &[&str])] = &[
        (&["grow", "oak", "--out", "afile"], &["--out afile", "it is a file"]),
        (&["grow", "oak", "--out", "afile/below"], &["--out afile/below"]),
        (&["grow", "--species-file", "none.toml"], &["--species-file none.toml"]),
        (&["shape", "nothere.obj"], &["nothere.obj"]),
        (&["shape", "nothere.svg"], &["nothere.svg"]),
        (&["shape", "blank.svg"], &["blank.svg"]),
        (&["shape", "folder.obj"], &["folder.obj", "folder"]),
        (&["shape", "cube.obj", "--nodes", "60", "--out", "afile"], &["--out afile"]),
        (&["measure", "nothere.swc"], &["nothere.swc"]),
        (&["measure", "bad.swc"], &["bad.swc", "line 1"]),
        (&["measure", "bad.json"], &["bad.json"]),
        (&["measure", "folder.json"], &["folder.json", "it is a folder"]),
        (&["convert", "bad.json", "out.swc"], &["bad.json"]),
        (&["convert", "cube.obj", "afile/x.swc", "--from", "json"], &["afile"]),
    ];
    for (arguments, texts) in cases {
        let error = world.run(arguments).failed(1);
        for text in *texts {
            assert!(error.contains(text), "{arguments:?}: no {text:?} in {error}");
        }
    }
    assert_eq!(world.files(), ["afile", "bad.json", "bad.swc", "blank.svg", "cube.obj"]);
}
