//! Skeletons as JSON: what is cut short, foreign or wrong is refused with its place.

use crate::sample::cube_graph;
use serde_json::{Value, json};
use treesynth::export::{ReadError, read_skeleton, write_skeleton};
use treesynth::glam::Vec3;
use treesynth::guided::{Bend, NearestTo, PoissonYao, Stage, TreeSynth};
use treesynth::{Skeleton, presets};

/// A small tree that the crate has grown, and its text.
fn small() -> (Skeleton, String) {
    let synth = TreeSynth::new(PoissonYao::new(crate::sample::plot(6.0, 6.0)))
        .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 3.0)))
        .stage(Stage::new(Bend::constant(0.2), NearestTo::new(Vec3::new(2.0, 3.0, 0.0))));
    let tree = synth.synthesize_on(&cube_graph(300, 1), 1).expect("a small tree");
    let mut text = Vec::new();
    write_skeleton(&tree, &mut text).expect("vectors take everything");
    (tree, String::from_utf8(text).expect("JSON is UTF-8"))
}

fn refused(text: &[u8]) -> String {
    match read_skeleton(text) {
        Err(error @ ReadError::Syntax { .. }) => {
            let text = error.to_string();
            let ReadError::Syntax { reason, line, .. } = error else { unreachable!() };
            // Faults of the tree have no place in the text.
            let start = if line == 0 { "not a skeleton in JSON: " } else { "not a skeleton in JSON (line " };
            assert!(text.starts_with(start), "{text}");
            reason
        }
        other => panic!("{} gave {other:?}", String::from_utf8_lossy(text)),
    }
}

/// The tree's text with one value changed.
fn changed(change: impl FnOnce(&mut Value)) -> String {
    let mut value: Value = serde_json::from_str(&small().1).expect("JSON");
    change(&mut value);
    refused(value.to_string().as_bytes())
}

#[test]
fn a_grown_tree_comes_back_bit_for_bit() {
    let (tree, text) = small();
    assert_eq!(read_skeleton(text.as_bytes()).expect("its own text"), tree);
    let ash = presets::by_name("figure-06c")
        .expect("a preset")
        .guided()
        .unwrap()
        .synth(3000)
        .synthesize(1)
        .expect("a tree");
    let mut text = Vec::new();
    write_skeleton(&ash, &mut text).expect("vectors take everything");
    assert_eq!(read_skeleton(&text[..]).expect("its own text"), ash);
}

#[test]
fn every_truncation() {
    let (_, text) = small();
    assert!(text.len() > 300);
    for end in 0..text.len() {
        refused(&text.as_bytes()[..end]);
    }
    assert!(refused(format!("{text},").as_bytes()).contains("trailing"));
    assert!(refused(text.repeat(2).as_bytes()).contains("trailing"));
}

#[test]
fn every_bent_byte_ends_well() {
    let (_, text) = small();
    for at in 0..text.len() {
        for byte in [0, b'"', b'9', b'-', b'[', b'}', b'e', 0xff] {
            let mut bytes = text.clone().into_bytes();
            bytes[at] = byte;
            if let Ok(skeleton) = read_skeleton(&bytes[..]) {
                assert!(skeleton.check().is_ok());
            }
        }
    }
}

#[test]
fn foreign_texts() {
    let geometry = json!({"type": "FeatureCollection", "features": [{"geometry": {"coordinates": [1, 2]}}]});
    let gltf = json!({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{}]});
    for foreign in [geometry, gltf, json!(null), json!(true), json!(3.5), json!("tree"), json!([]), json!({})]
    {
        refused(foreign.to_string().as_bytes());
    }
    let texts: [&[u8]; 7] = [
        b"",
        b"   \n\n",
        b"glTF\x02\0\0\0",
        b"solid tree\nendsolid",
        b"\xef\xbb\xbf{}",
        b"<svg/>",
        b"\x89PNG\r\n\x1a\n",
    ];
    for text in texts {
        refused(text);
    }
    for deep in ["[", "{\"positions\":["] {
        refused(deep.repeat(200_000).as_bytes());
    }
}

const ARRAYS: [&str; 6] = ["positions", "parents", "radii", "stages", "orders", "hops"];

#[test]
fn fields_missing_extra_and_of_wrong_type() {
    for array in ARRAYS {
        let reason = changed(|tree| drop(tree.as_object_mut().expect("an object").remove(array)));
        assert!(reason.contains(&format!("missing field `{array}`")), "{reason}");
        for wrong in [json!(null), json!(1), json!("x"), json!({}), json!(true), json!([["x"]]), json!([{}])]
        {
            changed(|tree| tree[array] = wrong);
        }
        for wrong in [json!("1"), json!([]), json!(false), json!({"x": 1})] {
            changed(|tree| tree[array][1] = wrong);
        }
    }
    let reason = changed(|tree| tree["leaves"] = json!([]));
    assert!(reason.contains("unknown field `leaves`"), "{reason}");
    for (array, wrong) in [("stages", json!(70_000)), ("hops", json!(1u64 << 33)), ("orders", json!(-1))] {
        changed(|tree| tree[array][1] = wrong);
    }
    for wrong in [json!(0.5), json!(-1), json!(1e20)] {
        changed(|tree| tree["parents"][2] = wrong);
    }
}

#[test]
fn arrays_of_wrong_lengths() {
    let nodes = small().0.len();
    for array in ARRAYS {
        let reason = changed(|tree| drop(tree[array].as_array_mut().expect("an array").pop()));
        assert!(array == "positions" || reason.contains(array), "{reason}");
        assert!(reason.contains(&nodes.to_string()) || reason.contains(&(nodes - 1).to_string()), "{reason}");
        changed(|tree| {
            let array = tree[array].as_array_mut().expect("an array");
            array.push(array[1].clone());
        });
        changed(|tree| tree[array] = json!([]));
    }
    changed(|tree| ARRAYS.iter().for_each(|&array| tree[array] = json!([])));
    changed(|tree| tree["positions"][1] = json!([0.0, 1.0]));
    changed(|tree| tree["positions"][1] = json!([0.0, 1.0, 2.0, 3.0]));
}

#[test]
fn cycles_and_dangling_parents() {
    let last = small().0.len() - 1;
    for (node, parent) in [(1, 1), (1, last), (2, 2), (last, last), (last, last + 1), (3, 4_000_000_000)] {
        let reason = changed(|tree| tree["parents"][node] = json!(parent));
        assert!(reason.contains(&format!("node {node} has the parent {parent}")), "{reason}");
    }
    let reason = changed(|tree| tree["parents"][0] = json!(1));
    assert!(reason.contains("node 0 is the root"), "{reason}");
    let reason = changed(|tree| tree["parents"][2] = json!(null));
    assert!(reason.contains("node 2 has no parent"), "{reason}");
}

#[test]
fn numbers_that_are_none() {
    for wrong in [json!(null), json!("NaN"), json!(1e39), json!(-1e300)] {
        changed(|tree| tree["positions"][1][2] = wrong.clone());
        changed(|tree| tree["radii"][1] = wrong);
    }
    let reason = changed(|tree| tree["radii"][1] = json!(-0.25));
    assert!(reason.contains("node 1 has the radius -0.25"), "{reason}");
    for token in ["NaN", "Infinity", "-Infinity", "1e999", "0x10", "+1", ".5", "01"] {
        let text = small().1.replacen("\"radii\":[", &format!("\"radii\":[{token},"), 1);
        refused(text.as_bytes());
    }
}
