//! The README and the guide: what they link to is there.

use std::fs;
use std::path::{Path, PathBuf};

/// All Markdown files of the repository's top and of `docs`.
fn pages() -> Vec<PathBuf> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut pages = vec![top.join("README.md"), top.join("CHANGELOG.md")];
    for folder in ["docs", "docs/guide"] {
        let files = fs::read_dir(top.join(folder)).expect("a folder of pages");
        pages.extend(files.map(|file| file.expect("a file").path()));
    }
    pages.retain(|page| page.extension().is_some_and(|ending| ending == "md"));
    pages
}

#[test]
fn links_lead_somewhere() {
    let pages = pages();
    assert!(pages.len() > 10, "{} pages", pages.len());
    let mut links = 0;
    for page in &pages {
        let text = fs::read_to_string(page).expect("UTF-8");
        for rest in text.split("](").skip(1) {
            let link = rest.split([')', '#', ' ']).next().unwrap_or_default();
            if link.is_empty() || link.contains("://") || link.contains("::") || link.contains('`') {
                continue;
            }
            links += 1;
            let to = page.parent().expect("a folder").join(link);
            assert!(to.exists(), "{} links to {link}, which is not there", page.display());
        }
    }
    assert!(links > 100, "{links} links");
}

#[test]
fn every_page_of_the_guide_can_be_found() {
    let readme = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).expect("UTF-8");
    for page in pages() {
        let name = page.file_name().expect("a file").to_string_lossy().into_owned();
        if page.parent().is_some_and(|folder| folder.ends_with("guide")) {
            assert!(readme.contains(&format!("docs/guide/{name}")), "the README does not link to {name}");
        }
    }
    assert!(readme.lines().count() < 250, "{} lines", readme.lines().count());
}

/// The text of all files of the library.
fn sources(folder: &Path, text: &mut String) {
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("a file").path();
        if path.is_dir() {
            sources(&path, text);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            text.push_str(&fs::read_to_string(path).expect("UTF-8"));
        }
    }
}

#[test]
fn rustdoc_finds_the_words_that_people_look_for() {
    let mut text = String::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut text);
    let words = [
        "oak",
        "birch",
        "palm",
        "bark",
        "leaf",
        "LOD",
        "wind",
        "imposter",
        "impostor",
        "billboard",
        "branch",
        "trunk",
        "forest",
        "skeleton",
        "glb",
        "usdz",
    ];
    for word in words {
        let is_alias = text.lines().any(|line| {
            line.trim_start().starts_with("#[doc(alias") && line.contains(&format!("\"{word}\""))
        });
        // rustdoc finds parts of names, too.
        let is_name = text.lines().any(|line| {
            let mut rest = line.split_whitespace();
            let is_item = rest.next() == Some("pub")
                && matches!(rest.next(), Some("fn" | "struct" | "enum" | "mod" | "trait"));
            is_item && rest.next().is_some_and(|name| name.to_lowercase().contains(&word.to_lowercase()))
        });
        assert!(is_alias || is_name, "{word} finds nothing");
    }
}
