//! PLY as programs write it.

use super::{CORNERS, FACES, Read, is, is_cube, refused};
use treesynth::shape::TriangleMesh;

fn read(bytes: impl AsRef<[u8]>) -> Read {
    TriangleMesh::read_ply(bytes.as_ref())
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
const LIST: &str = "property list uchar int vertex_indices\n";

fn text_of(
    vertex: &str,
    face: &str,
    vertices: impl Fn([u8; 3]) -> String,
    faces: impl Fn([usize; 4]) -> String,
) -> String {
    let body: String = CORNERS
        .iter()
        .map(|corner| vertices(*corner) + "\n")
        .chain(FACES.iter().map(|face| faces(*face) + "\n"))
        .collect();
    format!(
        "ply\nformat ascii 1.0\ncomment own file\nelement vertex 8\n{vertex}element face 6\n{face}end_header\n{body}"
    )
}

fn plain(corner: [u8; 3]) -> String {
    corner.map(|x| x.to_string()).join(" ")
}

fn four(face: [usize; 4]) -> String {
    format!("4 {}", face.map(|corner| corner.to_string()).join(" "))
}

fn text() -> String {
    text_of(XYZ, LIST, plain, four)
}

#[test]
fn texts_are_read_as_they_are_written() {
    let text = text();
    let with = |vertex: &str, line: fn([u8; 3]) -> String| text_of(vertex, LIST, line, four);
    let quality = format!("{XYZ}property float quality\n");
    let swapped = "property uchar red\nproperty double z\nproperty double x\nproperty list uchar float more\nproperty double y\n";
    let cases: Vec<(&str, Vec<u8>)> = vec![
        ("plain", text.clone().into()),
        ("nan", with(&quality, |c| plain(c) + " nan").into()),
        ("NaN", with(&quality, |c| plain(c) + " NaN").into()),
        ("-inf", with(&quality, |c| plain(c) + " -inf").into()),
        ("-nan(ind)", with(&quality, |c| plain(c) + " -nan(ind)").into()),
        (
            "odd names",
            with(&format!("{XYZ}property float scalar_Roughness_(0.01)\n"), |c| plain(c) + " 0.5").into(),
        ),
        (
            "names of words",
            with(&format!("{XYZ}property float scalar Roughness (m)\n"), |c| plain(c) + " 0.5").into(),
        ),
        ("another order", with(swapped, |[x, y, z]| format!("255 {z} {x} 2 7 nan {y}")).into()),
        ("exponents", with(XYZ, |c| c.map(|x| format!("{x}.0E+00")).join(" ")).into()),
        ("signs", with(XYZ, |c| c.map(|x| format!("+{x}.")).join(" ")).into()),
        (
            "upper-case names",
            text.replace("float x", "float X")
                .replace("float y", "float Y")
                .replace("float z", "float Z")
                .into(),
        ),
        ("vertex_index", text.replace("vertex_indices", "vertex_index").into()),
        ("types by bits", text.replace("uchar int", "uint8 int32").replace("float", "float32").into()),
        ("blank lines", text.replace("4 4 6 7 5", "\n  \n4 4 6 7 5").into()),
        ("blank lines at the end", (text.clone() + "\n\n  \n").into()),
        ("byte order mark", format!("\u{feff}{text}").into()),
        ("tabs", text.replace(' ', "\t").into()),
        ("spaces", text.replace('\n', "  \n").replace("element ", " element   ").into()),
        ("CR LF", text.replace('\n', "\r\n").into()),
        ("CR", text.replace('\n', "\r").into()),
        ("Latin-1", [b"ply\ncomment B\xE4ume\nobj_info \xFC\n", &text.as_bytes()[4..]].concat()),
        ("one line", (text.clone() + "\n").replace("\n0 0 2\n", " 0 0 2 ").into()),
        ("comment in the body", text.replace("4 4 6 7 5", "comment here are faces\n4 4 6 7 5").into()),
        ("no end of line", text.trim_end().into()),
        (
            "indices as fractions",
            text_of(XYZ, "property list uchar float vertex_indices\n", plain, |f| {
                format!("4.0 {}", f.map(|c| format!("{c}.0")).join(" "))
            })
            .into(),
        ),
        (
            "edges between",
            text.replace(
                "element face",
                "element edge 2\nproperty int vertex1\nproperty int vertex2\nelement face",
            )
            .replace("2 2 2\n", "2 2 2\n0 1\n1 2\n")
            .into(),
        ),
        ("elements of nothing", text.replace("element face", "element none 4294967296\nelement face").into()),
        ("faces first", {
            let faces: String = FACES.iter().map(|face| four(*face) + "\n").collect();
            let vertices: String = CORNERS.iter().map(|corner| plain(*corner) + "\n").collect();
            format!("ply\nformat ascii 1.0\nelement face 6\n{LIST}element vertex 8\n{XYZ}end_header\n{faces}{vertices}").into()
        }),
    ];
    for (what, bytes) in cases {
        is_cube(read(bytes), what);
    }
    let half = with(XYZ, |c| c.map(|x| if x == 0 { "-.5" } else { ".5" }).join(" "));
    is(read(half), 1.0, 6.0, "no whole part");
}

/// Numbers of each type, in both byte orders.
fn number(kind: &str, value: f64, big: bool) -> Vec<u8> {
    let mut bytes = match kind {
        "char" => (value as i8).to_le_bytes().to_vec(),
        "uchar" => (value as u8).to_le_bytes().to_vec(),
        "short" => (value as i16).to_le_bytes().to_vec(),
        "ushort" => (value as u16).to_le_bytes().to_vec(),
        "int" => (value as i32).to_le_bytes().to_vec(),
        "uint" => (value as u32).to_le_bytes().to_vec(),
        "float" => (value as f32).to_le_bytes().to_vec(),
        _ => value.to_le_bytes().to_vec(),
    };
    if big {
        bytes.reverse();
    }
    bytes
}

fn binary(coordinate: &str, count: &str, index: &str, big: bool, end: &str) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let header = format!(
        "ply\nformat binary_{order}_endian 1.0\ncomment own file\nelement material 2\nproperty list uchar double values\nproperty uchar id\n\
        element vertex 8\nproperty {coordinate} x\nproperty {coordinate} y\nproperty {coordinate} z\nproperty uchar red\n\
        element face 6\nproperty uchar flags\nproperty list {count} {index} vertex_indices\nproperty list uchar float texcoord\n\
        element edge 1\nproperty int vertex1\nend_header\n"
    );
    let mut bytes = header.replace('\n', end).into_bytes();
    for length in [0, 3] {
        bytes.push(length);
        (0..length).for_each(|_| bytes.extend(number("double", f64::NAN, big)));
        bytes.push(7);
    }
    for corner in CORNERS {
        bytes.extend(corner.iter().flat_map(|&x| number(coordinate, f64::from(x), big)));
        bytes.push(0x0A);
    }
    for face in FACES {
        bytes.push(0x0D);
        bytes.extend(number(count, 4.0, big));
        bytes.extend(face.iter().flat_map(|&corner| number(index, corner as f64, big)));
        bytes.push(1);
        bytes.extend(number("float", 0.5, big));
    }
    bytes.extend([0; 4]);
    bytes
}

#[test]
fn every_type_is_read_in_both_orders() {
    let whole = ["char", "uchar", "short", "ushort", "int", "uint"];
    for big in [false, true] {
        for count in whole {
            for index in whole.iter().chain(&["float", "double"]) {
                is_cube(read(binary("float", count, index, big, "\n")), &format!("{count} {index} {big}"));
            }
        }
        for coordinate in whole.iter().chain(&["double"]) {
            is_cube(read(binary(coordinate, "uchar", "int", big, "\n")), coordinate);
        }
        for end in ["\r\n", "\r"] {
            is_cube(read(binary("float", "uchar", "int", big, end)), "line ends");
        }
    }
}

#[test]
fn counts_are_not_believed() {
    let huge = |count: &str| text().replace("element vertex 8", &format!("element vertex {count}"));
    for count in ["400000000", "4294967295", "4294967296", "18446744073709551615"] {
        refused(read(huge(count)), &["PLY"], count);
        let faces = text().replace("element face 6", &format!("element face {count}"));
        refused(read(faces), &["PLY, line", "6 of \"face\"", "cut short"], count);
        let mut bytes = binary("float", "uchar", "int", false, "\n");
        let header = b"element vertex 8";
        let at = bytes.windows(header.len()).position(|window| window == header).unwrap() + header.len() - 1;
        bytes.splice(at..=at, count.bytes());
        refused(read(bytes), &["PLY"], count);
    }
    let mut long = binary("float", "uint", "int", false, "\n");
    let at = long.len() - 4 - 6 * (1 + 4 + 16 + 1 + 4) + 1;
    long[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes());
    refused(read(long), &["PLY, byte", "cut short"], "a list without end");
    for end in [10, 50, 100, 150, 200] {
        assert!(read(&binary("float", "uchar", "int", false, "\n")[..end]).is_err());
        refused(read(&text()[..text().len() - end]), &["PLY"], "cut");
    }
}

#[test]
fn what_is_missing_is_named() {
    let text = text();
    let bent = |from: &str, to: &str, words: &[&str]| refused(read(text.replace(from, to)), words, to);
    bent(
        "element face 6\nproperty list uchar int vertex_indices",
        "element tristrips 6\nproperty list int int vertex_indices",
        &["PLY", "face", "\"tristrips\""],
    );
    bent(
        "element face 6\nproperty list uchar int vertex_indices",
        "element edge 6\nproperty list int int vertex_indices",
        &["PLY", "face", "\"edge\""],
    );
    bent("element vertex 8", "element point 8", &["PLY", "vertex", "\"point\""]);
    bent("float z", "float w", &["PLY", "x, y and z", "\"w\""]);
    bent("vertex_indices", "corners", &["PLY", "vertex_indices", "\"corners\""]);
    bent("list uchar int", "int", &["PLY", "vertex_indices"]);
    bent("property float x", "property list uchar float x", &["PLY", "list"]);
    bent("property float x", "property vector x", &["PLY, line 5", "\"vector\""]);
    bent("ascii", "utf8", &["PLY, line 2", "\"utf8\"", "ascii"]);
    bent("ascii 1.0", "ascii 2.0", &["PLY, line 2", "\"2.0\""]);
    bent("ply", "PLYX", &["PLY, line 1", "\"PLYX\"", "ply"]);
    bent("format ascii 1.0\n", "", &["PLY", "format"]);
    bent("element vertex 8", "element vertex eight", &["PLY, line 4", "eight"]);
    bent("end_header", "endheader", &["PLY, line 10", "endheader"]);
    bent("\n2 2 2\n", "\n2 2 nan\n", &["PLY, line 18", "vertex 7", "finite"]);
    bent("\n2 2 2\n", "\n2 2 two\n", &["PLY, line 18", "\"two\"", "number"]);
    bent("4 0 1 3 2", "4 0 1 3 8", &["PLY, line 19", "vertex 8", "there are 8"]);
    bent("4 0 1 3 2", "4 0 1 3 -1", &["PLY, line 19", "\"-1\"", "whole number"]);
    bent("4 0 1 3 2", "4 0 1 3 1.5", &["PLY, line 19", "\"1.5\""]);
    bent("4 0 1 3 2", "-4 0 1 3 2", &["PLY, line 19", "\"-4\""]);
    refused(read(""), &["PLY", "empty"], "empty");
    refused(read(b"\x1f\x8b\x08\0\0"), &["PLY", "1f 8b", "unpacked"], "gzip");
    refused(
        read(
            "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n",
        ),
        &["no triangle"],
        "nothing",
    );
}

#[test]
fn concave_faces_keep_their_area() {
    let outline = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]];
    for start in 0..6 {
        let mut body = String::new();
        for z in [0, 2] {
            for [x, y] in outline {
                body += &format!("{x} {y} {z}\n");
            }
        }
        let cap: Vec<usize> = (0..6).map(|i| (start + i) % 6).collect();
        let list = |corners: Vec<usize>| {
            corners.iter().fold(corners.len().to_string(), |text, c| format!("{text} {c}")) + "\n"
        };
        body += &list(cap.iter().map(|c| c + 6).collect());
        body += &list(cap.iter().rev().copied().collect());
        (0..6).for_each(|i| body += &list(vec![i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6]));
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 12\n{XYZ}element face 8\n{LIST}end_header\n{body}"
        );
        is(read(text), 10.0, 34.0, "L");
    }
}
