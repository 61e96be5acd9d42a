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
