//! Data flows one way: a module imports only from its left.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// From left to right; modules in one entry do not import from each other.
const LAYERS: &[&[&str]] = &[
    &["math", "random", "parameter", "observer", "parallel", "text", "recipe"],
    &["nearest", "ply"],
    &["shape", "field"],
    &["skeleton", "cloud"],
    &["format"],
    &["radius", "metrics", "texture"],
    &["guided", "growth", "self_organizing", "variational"],
    &["surface"],
    &["foliage"],
    &["export", "preview", "asset", "scan", "reconstruct"],
    &["species"],
    &["presets"],
    &["testing"],
];

fn layer(module: &str) -> Option<usize> {
    LAYERS.iter().position(|modules| modules.contains(&module))
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The paths after `crate::`: one, or those of a group.
fn paths(after: &str) -> Vec<&str> {
    let Some(list) = after.strip_prefix('{') else { return vec![after] };
    let (mut depth, mut start, mut found) = (0, 0, Vec::new());
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' | ',' if depth == 0 => {
                found.push(list[start..at].trim());
                start = at + 1;
                if c == '}' {
                    break;
                }
            }
            '}' => depth -= 1,
            _ => {}
        }
    }
    found
}

#[test]
fn modules_import_only_from_their_left() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src, &mut files);
    assert!(files.len() > 40);
    // The module of each name that lib.rs re-exports.
    let lib = fs::read_to_string(src.join("lib.rs")).unwrap();
    let origin = |name: &str| {
        lib.lines()
            .filter_map(|line| line.strip_prefix("pub use ")?.split_once("::"))
            .find(|(_, names)| names.split(|c: char| !c.is_alphanumeric()).any(|n| n == name))
            .map(|(module, _)| module.to_owned())
    };
    let mut imports = 0;
    for file in files.iter().filter(|file| !file.ends_with("lib.rs")) {
        let module = file.strip_prefix(&src).unwrap().components().next().unwrap();
        let module = module.as_os_str().to_str().unwrap().trim_end_matches(".rs");
        let own = layer(module).unwrap_or_else(|| panic!("{module} has no layer"));
        let text = fs::read_to_string(file).unwrap();
        // Unit tests and documentation may look anywhere.
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap().lines();
        let code: Vec<_> = code.filter(|line| !line.trim_start().starts_with("//")).collect();
        let text = code.join("\n");
        if file.ends_with("tests.rs") || file.ends_with("sample.rs") {
            continue;
        }
        for (_, after) in text.match_indices("crate::").map(|(at, _)| text.split_at(at + 7)) {
            for name in paths(after) {
                let name: String = name.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                let from = if layer(&name).is_some() { name.clone() } else { origin(&name).unwrap_or(name) };
                if from == module || from.is_empty() || from == "mint" {
                    continue;
                }
                imports += 1;
                let theirs = layer(&from).unwrap_or_else(|| panic!("{}: what is {from}?", file.display()));
                assert!(theirs < own, "{}: {module} imports from {from}, to its right", file.display());
            }
        }
    }
    assert!(imports > 60, "only {imports} imports found");
}

#[test]
fn features_are_documented() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest = fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let features = manifest.split("[features]").nth(1).unwrap().split("\n[").next().unwrap();
    let names: Vec<_> = features
        .lines()
        .filter_map(|line| Some(line.split_once(" = ")?.0))
        .filter(|name| !name.starts_with('#') && *name != "default")
        .collect();
    assert_eq!(names.len(), 11);
    for file in ["README.md", "src/lib.rs"] {
        let text = fs::read_to_string(root.join(file)).unwrap();
        for name in &names {
            assert!(text.contains(&format!("| `{name}` |")), "{file} does not list the feature {name}");
        }
    }
}

/// Files and folders of `src/guided`, each with those it imports from.
fn guided() -> BTreeMap<String, BTreeSet<String>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/guided");
    let mut files = Vec::new();
    sources(&folder, &mut files);
    let mut imports: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for file in files {
        let path = file.strip_prefix(&folder).unwrap();
        let unit = path.components().next().unwrap().as_os_str().to_str().unwrap().trim_end_matches(".rs");
        if unit == "mod" {
            continue;
        }
        let text = fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap();
        // `super` is the folder itself for its own files, and for the `mod.rs` of a folder in it.
        let is_own = path.components().count() == 1 || path.ends_with("mod.rs");
        for line in code.lines().filter(|line| line.starts_with("use ")) {
            let after = line
                .strip_prefix("use crate::guided::")
                .or_else(|| line.strip_prefix("use super::").filter(|_| is_own));
            let name = after.and_then(|after| after.split([':', ';']).next()).unwrap_or_default();
            let is_inside = folder.join(unit).join(format!("{name}.rs")).exists();
            if name.starts_with(char::is_lowercase) && name != unit && !is_inside {
                imports.entry(unit.to_owned()).or_default().insert(name.to_owned());
            }
        }
        imports.entry(unit.to_owned()).or_default();
    }
    imports
}

#[test]
fn guided_is_a_line() {
    let mut imports = guided();
    assert!(imports.len() > 10 && imports.values().map(BTreeSet::len).sum::<usize>() > 20, "{imports:?}");
    // Modules that import from none of the rest come off, until nothing or a circle is left.
    while !imports.is_empty() {
        let free: Vec<String> = imports
            .iter()
            .filter(|(_, from)| from.iter().all(|name| !imports.contains_key(name)))
            .map(|(name, _)| name.clone())
            .collect();
        assert!(!free.is_empty(), "these import from each other in a circle: {imports:?}");
        for name in &free {
            imports.remove(name);
        }
    }
}
