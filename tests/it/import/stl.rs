//! STL as programs write it.

use super::{CORNERS, Read, has, is, is_cube, refused, triangles};
use std::fmt::Write;
use std::io::Cursor;
use treesynth::Shape;
use treesynth::glam::Vec3;
use treesynth::shape::TriangleMesh;

fn read(bytes: impl AsRef<[u8]>) -> Read {
    TriangleMesh::read_stl(Cursor::new(bytes.as_ref()))
}

/// Text without its first and last lines; `coordinate` writes a number.
fn facets(normal: &str, coordinate: impl Fn(u8) -> String) -> String {
    let mut text = String::new();
    for corners in triangles() {
        write!(text, "facet normal {normal}\n  outer loop\n").unwrap();
        for corner in corners {
            let [x, y, z] = corner.map(&coordinate);
            writeln!(text, "    vertex {x} {y} {z}").unwrap();
        }
        text += "  endloop\nendfacet\n";
    }
    text
}

fn text(normal: &str) -> String {
    format!("solid a\n{}endsolid a\n", facets(normal, |x| format!("{x}.0")))
}

fn binary(header: &[u8], count: u32, normal: f32, attribute: [u8; 2]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend(count.to_le_bytes());
    for corners in triangles() {
        bytes.extend([normal; 3].map(f32::to_le_bytes).as_flattened());
        let corners = corners.map(|corner| corner.map(|x| f32::from(x).to_le_bytes()));
        bytes.extend(corners.as_flattened().as_flattened());
        bytes.extend(attribute);
    }
    bytes
}

const TETRAHEDRON: [[[i32; 3]; 3]; 4] = [
    [[0, 0, 0], [0, 1, 0], [1, 0, 0]],
    [[0, 0, 0], [1, 0, 0], [0, 0, 1]],
    [[0, 0, 0], [0, 0, 1], [0, 1, 0]],
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
];

fn tetrahedron(name: &str, at: i32) -> String {
    let mut text = format!("solid {name}\n");
    for corners in TETRAHEDRON {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in corners {
            writeln!(text, "vertex {} {y} {z}", x + at).unwrap();
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid " + name + "\n"
}

#[test]
fn all_solids_of_a_file_are_one_model() {
    let mesh = is(read(tetrahedron("a", 0) + &tetrahedron("b", 3)), 1.0 / 3.0, 4.732, "two");
    assert!(mesh.triangles().len() == 8 && mesh.contains(Vec3::new(3.2, 0.2, 0.2)));
    let many: String = (0..20).map(|i| tetrahedron("facet vertex solid", 2 * i)).collect();
    is(read(many), 20.0 / 6.0, 20.0 * 2.366, "twenty, of odd names");
    // The first without its end.
    let two = tetrahedron("a", 0).replace("endsolid a\n", "") + &tetrahedron("b", 3);
    is(read(two), 1.0 / 3.0, 4.732, "one end");
    let cut = tetrahedron("a", 0);
    refused(read(&cut[..cut.len() - 11]), &["STL, line 29", "endsolid", "cut short"], "no end");
    for end in [100, 200, 300] {
        refused(read(&cut[..end]), &["STL, line"], "cut");
    }
}

#[test]
fn a_text_may_begin_in_many_ways() {
    let plain = tetrahedron("a", 0);
    let begins = |first: &str| plain.replacen("solid a\n", first, 1);
    let capitals = plain.to_uppercase();
    let indented: String = plain.lines().map(|line| format!("   \t{line}\n")).collect();
    let variants: Vec<(&str, Vec<u8>)> = vec![
        ("nameless", begins("solid\n").into()),
        ("capitals", capitals.into()),
        ("first in capitals", begins("SOLID a\n").into()),
        ("blank line first", (String::from("\n \n") + &plain).into()),
        ("byte order mark", (String::from("\u{feff}") + &plain).into()),
        ("Latin-1", [b"solid B\xE4ume\n", &plain.as_bytes()[8..]].concat()),
        ("tab", begins("solid\ta\n").into()),
        ("CR LF", plain.replace('\n', "\r\n").into()),
        ("CR", plain.replace('\n', "\r").into()),
        ("indented", indented.into()),
        ("comment", begins("solid a ; made by\ncolor 0.5 0.5 0.5\n").into()),
        ("no end of line", plain.trim_end().into()),
        (
            "one line",
            plain
                .replace("solid a\n", "solid a\r")
                .replace('\n', " ")
                .replace("endsolid a\r", "\nendsolid")
                .into(),
        ),
        ("end loop", plain.replace("endloop", "end loop").replace("endfacet", "end facet").into()),
        ("no normals", plain.replace(" normal 0 0 0", "").into()),
    ];
    for (what, bytes) in variants {
        is(read(bytes), 1.0 / 6.0, 2.366, what);
    }
}

#[test]
fn normals_do_not_matter() {
    for normal in
        ["nan nan nan", "-nan(ind) -nan(ind) 1.#QNAN", "inf 0 0", "0,0 0,0 1,0", "1e999 0 0", "0 0 0"]
    {
        is_cube(read(text(normal)), normal);
    }
    for normal in [f32::NAN, f32::INFINITY] {
        is_cube(read(binary(b"", 12, normal, [0; 2])), "binary");
    }
    // A facet without an area has no normal.
    let needle = "facet normal nan nan nan\nouter loop\nvertex 0 0 0\nvertex 0 0 2\nvertex 0 0 1\nendloop\nendfacet\nendsolid";
    let mesh = read(text("0 0 0").replace("endsolid", needle)).unwrap();
    has(&mesh, 8.0, 24.0, "needle");
}

#[test]
fn numbers_are_those_of_c() {
    let with =
        |coordinate: fn(u8) -> String| read(format!("solid a\n{}endsolid\n", facets("0 0 0", coordinate)));
    is_cube(with(|x| format!("{x}.000000E+00")), "exponents");
    is_cube(with(|x| format!("+{x}.")), "signs, no fraction");
    is_cube(with(|x| if x == 0 { "-0.0".into() } else { "2".into() }), "minus zero");
    is(with(|x| if x == 0 { "-.5".into() } else { ".5".into() }), 1.0, 6.0, "no whole part");
    let one = |word: &'static str, has: &[&str]| {
        let text = text("0 0 0").replacen("vertex 0.0 0.0 2.0", &format!("vertex 0.0 0.0 {word}"), 1);
        refused(read(text), has, word);
    };
    one("1e39", &["STL, line 5", "\"1e39\"", "finite"]);
    one("nan", &["STL, line 5", "\"nan\""]);
    one("0,0", &["STL, line 5", "\"0,0\""]);
    one("", &["STL, line 5", "\"\""]);
    // A loop of four is a square.
    let mut squares = String::from("solid a\n");
    for face in super::FACES {
        squares += "facet\nouter loop\n";
        for [x, y, z] in face.map(|corner| CORNERS[corner]) {
            writeln!(squares, "vertex {x} {y} {z}").unwrap();
        }
        squares += "endloop\nendfacet\n";
    }
    is_cube(read(squares + "endsolid"), "squares");
    refused(
        read("solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid"),
        &["line 6", "2 vertices"],
        "two corners",
    );
}

#[test]
fn the_length_tells_a_binary_file() {
    is_cube(read(binary(b"", 12, 0.0, [0; 2])), "plain");
    is_cube(read(binary(b"solid of a CAD program", 12, 0.0, [0; 2])), "solid");
    is_cube(read(binary(b"solid\nfacet normal 0 0 0\n", 12, 0.0, [0; 2])), "text in the header");
    is_cube(read(binary(b"COLOR=\x01\x02\x03\x04,MATERIAL=", 12, 0.0, [0xFF; 2])), "colours");
    // Ten triangles: the count is a line feed.
    let ten = &binary(b"solid", 10, 0.0, [0; 2])[..84 + 500];
    assert!(read(ten).is_ok_and(|mesh| mesh.triangles().len() == 10));
}

#[test]
fn counts_are_not_believed() {
    let count = |count: u32| binary(b"", count, 0.0, [0; 2]);
    is_cube(read(count(0)), "never filled in");
    is_cube(read(count(u32::MAX)), "never filled in either");
    is_cube(read(count(6)), "too few");
    is_cube(read([count(12), vec![7; 126]].concat()), "more after it");
    refused(
        read(&count(12)[..564]),
        &["STL, byte 80", "12 triangles", "684 bytes", "has 564", "cut short"],
        "cut",
    );
    refused(read(count(4_294_967_294)), &["STL, byte 80", "4294967294"], "too many");
    refused(read([0; 83]), &["STL, byte 0", "83 bytes"], "shorter than a header");
    refused(read(&count(12)[..109]), &["STL, byte 80"], "half a triangle");
    refused(read(&count(0)[..84]), &["no triangle"], "header alone");
    refused(read([]), &["STL", "empty"], "empty");
    refused(read("hello"), &["STL", "\"hello\"", "solid"], "a text");
    refused(read(b"\x1f\x8b\x08\0\0"), &["STL", "1f 8b", "unpacked"], "gzip");
    refused(read("<!DOCTYPE html><html>"), &["STL", "web page"], "a page");
    for (corner, value) in [(96, f32::NAN), (100, f32::INFINITY)] {
        let mut bytes = count(12);
        bytes[corner..corner + 4].copy_from_slice(&value.to_le_bytes());
        refused(read(bytes), &["STL, byte 84", "vertex 0 of triangle 0", "finite"], "not finite");
    }
    let one = tetrahedron("a", 0).replace("endloop", "").replace("vertex", "");
    refused(read(one), &["no triangle"], "no vertices");
}
