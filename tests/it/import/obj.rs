//! OBJ as programs write it.

use super::{CORNERS, FACES, Read, is, is_cube, refused};
use std::fmt::Write;
use treesynth::shape::TriangleMesh;

fn read(bytes: impl AsRef<[u8]>) -> Read {
    TriangleMesh::read_obj(bytes.as_ref())
}

fn vertices(line: impl Fn(usize, [u8; 3]) -> String) -> String {
    CORNERS.iter().enumerate().map(|(number, corner)| line(number, *corner) + "\n").collect()
}

fn plain() -> String {
    vertices(|_, [x, y, z]| format!("v {x} {y} {z}"))
}

fn faces(corner: impl Fn(usize) -> String) -> String {
    FACES.iter().map(|face| format!("f {}\n", face.map(&corner).join(" "))).collect()
}

fn counted() -> String {
    faces(|corner| (corner + 1).to_string())
}

fn cube() -> String {
    plain() + &counted()
}

#[test]
fn dialects_are_read() {
    let cube = cube();
    let lines: Vec<&str> = cube.lines().collect();
    let continued = cube.replace("f 1 2 4 3", "f 1 2 \\\n 4 3").replace("v 2 0 2", "v 2 \\\r\n 0 \\\r\n2");
    let cases: Vec<(&str, Vec<u8>)> = vec![
        ("Latin-1 comment", [b"# B\xE4ume\n", cube.as_bytes()].concat()),
        ("Latin-1 group", [cube.as_bytes(), b"g B\xE4ume\nusemtl \xFC\n"].concat()),
        ("continued", continued.into()),
        (
            "comments at line ends",
            lines.iter().map(|line| format!("{line} # here\n")).collect::<String>().into(),
        ),
        ("comment with a backslash", format!("# C:\\models\\\n{cube}").into()),
        ("name with a backslash", cube.replacen("f 1", "usemtl a\\\nf 1", 1).into()),
        ("colours", (vertices(|_, [x, y, z]| format!("v {x} {y} {z} .1 .2 .3")) + &counted()).into()),
        (
            "colours with alpha",
            (vertices(|_, [x, y, z]| format!("v {x} {y} {z} .1 .2 .3 1")) + &counted()).into(),
        ),
        (
            "half coloured",
            (vertices(|i, [x, y, z]| format!("v {x} {y} {z}{}", if i < 4 { " 1 0 0" } else { "" }))
                + &counted())
                .into(),
        ),
        ("CR", cube.replace('\n', "\r").into()),
        ("CR LF", cube.replace('\n', "\r\n").into()),
        ("byte order mark", format!("\u{feff}{cube}").into()),
        ("NUL", (cube.clone() + "\0").into()),
        ("weight 1", (vertices(|_, [x, y, z]| format!("v {x} {y} {z} 1.0")) + &counted()).into()),
        ("weight 2", (vertices(|_, [x, y, z]| format!("v {x} {y} {z} 2")) + &counted()).into()),
        ("weight 0", (vertices(|_, [x, y, z]| format!("v {x} {y} {z} 0")) + &counted()).into()),
        ("tabs", cube.replace(' ', "\t ").replace('\n', "  \n  ").into()),
        ("capitals", cube.to_uppercase().into()),
        ("fo", cube.replace("f ", "fo ").into()),
        (
            "numbers",
            (vertices(|_, c| {
                let [x, y, z] = c.map(|x| format!("+{x}.0E+00"));
                format!("v {x} {y} {z}")
            }) + &counted())
                .into(),
        ),
        ("no end of line", cube.trim_end().into()),
    ];
    for (what, bytes) in cases {
        is_cube(read(bytes), what);
    }
}

#[test]
fn other_statements_are_passed_over() {
    let before = "mtllib does/not exist.mtl\nvp 0.1 0.2 1\ncurv2 1\no B\u{e4}ume \u{6728}\ng one two\nusemtl\nusemtl my material\ns 1\nmg 1 0.5\n";
    let after = "s off\nl 1 2 3 4 5\np 3\ncstype bspline\ndeg 3 3\nsurf 0 1 0 1 1 2 3 4\nparm u 0 0 0 1 1 1\ntrim 0 1 1\nend\nbevel on\nlod 2\n\
        shadow_obj x\nctech cparm 2.0\ncall sub.obj 1\ncsh -echo hi\nunknown 1 2\nf 1 2\nf 3\nf\nl 1/1 2/2\nvt\nvn a b c\n";
    is_cube(read(before.to_owned() + &cube() + after), "all of them");
    let lines: String = plain() + "l 1 2 3 4\nl 1 3 5\np 1\n";
    refused(read(lines), &["no triangle"], "lines alone");
    let mesh = read(cube() + "f 1 1 2\nf 1 2 2 1\n").unwrap();
    super::has(&mesh, 8.0, 24.0, "repeated corners");
    let groups: String = cube().lines().map(|line| format!("g a\n{line}\n")).collect();
    is_cube(read(groups), "a group a line");
}

#[test]
fn corners_are_named_in_many_ways() {
    let cube = |corner: fn(usize) -> String| plain() + "vt 0 0\nvn 0 0 1\n" + &faces(corner);
    is_cube(read(cube(|i| format!("{}/1/1", i + 1))), "all three");
    is_cube(read(cube(|i| format!("{}//1", i + 1))), "no texture");
    is_cube(read(cube(|i| format!("{}/1", i + 1))), "no normal");
    is_cube(read(cube(|i| format!("{}//", i + 1))), "slashes");
    is_cube(read(cube(|i| format!("{0}/{0}/{0}", i + 1))), "textures and normals that are not there");
    is_cube(read(cube(|i| format!("{}", i as i32 - 8))), "relative");
    is_cube(read(cube(|i| format!("{}/-1/-1", i as i32 - 8))), "relative, all three");
    is_cube(read(counted() + &plain()), "faces first");
}

#[test]
fn what_a_face_names_must_be_there() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 0 1\nvt 0 0\nvn 0 0 1\n";
    let face = |face: &str, words: &[&str]| refused(read(format!("{triangle}{face}\n")), words, face);
    face("f -9 2 3", &["OBJ, line 6", "-9", "-3 to -1"]);
    face("f 1/-9 2/1 3/1", &["OBJ, line 6", "vt", "-9", "-1 to -1"]);
    face("f 1//-9 2//1 3//1", &["OBJ, line 6", "vn", "-9"]);
    face("f 1/-9223372036854775808 2 3", &["OBJ, line 6", "vt"]);
    face("f 1//-99999999999999999999 2 3", &["OBJ, line 6", "vn"]);
    face("f -9223372036854775808 2 3", &["OBJ, line 6"]);
    face("f 0 1 2", &["OBJ, line 6", "\"0\"", "or from 1"]);
    face("f 4 1 2", &["OBJ, line 6", "vertex 4", "has 3"]);
    face("f 99999999999999999999 1 2", &["OBJ, line 6", "99999999999999999999"]);
    face("f 1.0 2.0 3.0", &["OBJ, line 6", "\"1.0\"", "whole number"]);
    face("f a b c", &["OBJ, line 6", "\"a\""]);
    // Those that name nothing enclose nothing, but are no trouble.
    face("f 1//9223372036854775807 2//1 3//1", &["encloses nothing"]);
    refused(read("f -1 -2 -3\n"), &["OBJ, line 1", "no v line before it"], "nothing there");
    refused(read("v 1 2\n"), &["OBJ, line 1", "2 coordinates"], "two coordinates");
    refused(read("v 1 2 a\n"), &["OBJ, line 1", "\"a\"", "finite number"], "no number");
    refused(read("v 1 2 nan\n"), &["OBJ, line 1", "\"nan\""], "not finite");
    refused(read(format!("v 1 2 {}\n", "9x".repeat(100_000))), &["OBJ, line 1", "…"], "a long word");
    refused(read(""), &["OBJ", "empty"], "empty");
    refused(read("# nothing\n"), &["no triangle"], "a comment");
    refused(read(plain()), &["no triangle"], "no faces");
    refused(read(b"\x1f\x8b\x08\0\0"), &["OBJ", "1f 8b", "unpacked"], "gzip");
}

/// Prisms on outlines, each from any of its corners.
#[test]
fn concave_faces_keep_their_area() {
    type Case<'a> = (&'a str, &'a [[f64; 2]], f64, f32, f32);
    let cases: [Case<'_>; 4] = [
        ("L", &[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]], 2.0, 10.0, 34.0),
        ("dart", &[[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]], 3.0, 3.0, 23.9017),
        (
            "plus",
            &[
                [1.0, 0.0],
                [2.0, 0.0],
                [2.0, 1.0],
                [3.0, 1.0],
                [3.0, 2.0],
                [2.0, 2.0],
                [2.0, 3.0],
                [1.0, 3.0],
                [1.0, 2.0],
                [0.0, 2.0],
                [0.0, 1.0],
                [1.0, 1.0],
            ],
            1.0,
            5.0,
            22.0,
        ),
        // Corners in the middle of its straight sides, which its walls meet.
        ("square", &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0]], 2.0, 8.0, 24.0),
    ];
    for (name, outline, depth, volume, area) in cases {
        for start in 0..outline.len() {
            is(read(prism(outline, depth, start)), volume, area, &format!("{name} from {start}"));
        }
    }
    let star: Vec<[f64; 2]> = (0..10)
        .map(|i| {
            let (radius, angle) =
                (if i % 2 == 0 { 3.0 } else { 1.0 }, f64::from(i) * 0.2 * std::f64::consts::PI);
            [radius * angle.cos(), radius * angle.sin()]
        })
        .collect();
    for start in 0..10 {
        is(read(prism(&star, 1.0, start)), 8.8168, 40.3181, "star");
    }
}

/// A counter-clockwise outline with a depth; its caps begin with a corner of choice.
pub(crate) fn prism(outline: &[[f64; 2]], depth: f64, start: usize) -> String {
    let count = outline.len();
    let mut text = String::new();
    for z in [0.0, depth] {
        for [x, y] in outline {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
    }
    let mut face = |corners: &[usize]| {
        let corners: Vec<String> = corners.iter().map(|corner| (corner + 1).to_string()).collect();
        writeln!(text, "f {}", corners.join(" ")).unwrap();
    };
    let cap: Vec<usize> = (0..count).map(|i| (start + i) % count).collect();
    face(&cap.iter().map(|corner| corner + count).collect::<Vec<_>>());
    face(&cap.iter().rev().copied().collect::<Vec<_>>());
    for i in 0..count {
        let j = (i + 1) % count;
        face(&[i, j, j + count, i + count]);
    }
    text
}

/// Caps of thousands of corners.
#[test]
fn round_caps_are_read_in_no_time() {
    let outline: Vec<[f64; 2]> = (0..3000)
        .map(|i| {
            let angle = std::f64::consts::TAU * f64::from(i) / 3000.0;
            [angle.cos(), angle.sin()]
        })
        .collect();
    let mesh =
        is(read(prism(&outline, 1.0, 7)), std::f32::consts::PI, 4.0 * std::f32::consts::PI, "cylinder");
    assert_eq!(mesh.triangles().len(), 2 * 2998 + 2 * 3000);
}

/// A face over many lines takes time in proportion.
#[test]
fn long_lines_are_read_in_no_time() {
    let continued = cube() + "f 1 " + &"\\\n 1 ".repeat(200_000) + "\n";
    assert!(read(continued).is_ok());
    let long = cube() + "g " + &"x".repeat(5_000_000) + "\nf 1 " + &"2 ".repeat(500_000) + "\n";
    assert!(read(long).is_ok());
}
