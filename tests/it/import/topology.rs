//! Surfaces as programs leave them: walls, sheets with two sides, fins, cracks.

use super::obj::prism;
use super::{Read, has, is, refused};
use std::fmt::Write;
use treesynth::Shape;
use treesynth::glam::Vec3;
use treesynth::shape::{Flaws, TriangleMesh};

/// Cubes of 2 m at places of a lattice, each with vertices of its own, or sharing them.
fn cubes(
    places: &[[i32; 3]],
    shared: bool,
    turned: impl Fn(usize, usize) -> bool,
    start: impl Fn(usize) -> usize,
) -> Read {
    let (mut text, mut faces) = (String::new(), String::new());
    let mut vertices: Vec<[i32; 3]> = Vec::new();
    for (number, place) in places.iter().enumerate() {
        for (side, face) in super::FACES.iter().enumerate() {
            let mut corners: Vec<usize> = face
                .iter()
                .map(|&corner| {
                    let [x, y, z] = super::CORNERS[corner].map(i32::from);
                    let vertex = [x + 2 * place[0], y + 2 * place[1], z + 2 * place[2]];
                    let found = vertices.iter().position(|other| *other == vertex).filter(|_| shared);
                    found.unwrap_or_else(|| {
                        vertices.push(vertex);
                        vertices.len() - 1
                    })
                })
                .collect();
            corners.rotate_left(start(side));
            if turned(number, side) {
                corners.reverse();
            }
            let corners: Vec<String> = corners.iter().map(|corner| (corner + 1).to_string()).collect();
            writeln!(faces, "f {}", corners.join(" ")).unwrap();
        }
    }
    for [x, y, z] in vertices {
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    TriangleMesh::read_obj((text + &faces).as_bytes())
}

const fn never(_: usize, _: usize) -> bool {
    false
}

#[test]
fn sound_cubes_side_by_side_are_sound() {
    let row: Vec<[i32; 3]> = (0..3).map(|x| [x, 0, 0]).collect();
    let block: Vec<[i32; 3]> = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]).collect();
    let board: Vec<[i32; 3]> = block.iter().copied().filter(|[x, y, z]| (x + y + z) % 2 == 0).collect();
    let cases: [(&str, &[[i32; 3]], f32, f32); 6] = [
        ("face", &row[..2], 16.0, 40.0),
        ("row", &row, 24.0, 56.0),
        ("block", &block, 27.0 * 8.0, 36.0 * 6.0),
        ("edge", &[[0, 0, 0], [1, 1, 0]], 16.0, 48.0),
        ("corner", &[[0, 0, 0], [1, 1, 1]], 16.0, 48.0),
        ("board", &board, 14.0 * 8.0, 14.0 * 24.0),
    ];
    for (what, places, volume, area) in cases {
        for shared in [false, true] {
            for start in 0..4 {
                is(cubes(places, shared, never, |_| start), volume, area, what);
            }
        }
    }
}

#[test]
fn cubes_side_by_side_may_look_inward() {
    for places in
        [vec![[0, 0, 0], [1, 0, 0]], vec![[0, 0, 0], [1, 0, 0], [2, 0, 0]], vec![[0, 0, 0], [1, 1, 0]]]
    {
        let count = places.len();
        let volume = 8.0 * count as f32;
        for inward in 0..count {
            let mesh = cubes(&places, true, |cube, _| cube == inward, |_| 0).unwrap();
            assert!(
                (mesh.volume() - volume).abs() < 0.01,
                "{places:?} {inward}: {}, {}",
                mesh.volume(),
                mesh.flaws()
            );
            assert_eq!(mesh.flaws().open_sides, 0);
        }
        let all = cubes(&places, true, |_, _| true, |_| 0).unwrap();
        assert!((all.volume() - volume).abs() < 0.01);
    }
}

/// Programs for foliage write each face both ways round; other programs write all of it twice.
#[test]
fn sheets_with_two_sides_count_once() {
    for reversed in [true, false] {
        for start in 0..4 {
            let mesh = cubes(
                &[[0, 0, 0], [0, 0, 0]],
                true,
                |cube, _| reversed && cube == 1,
                |side| (side + start) % 4,
            )
            .unwrap();
            has(&mesh, 8.0, 24.0, "double");
            assert_eq!(mesh.flaws(), Flaws::default().with(|flaws| flaws.doubled = 12));
            assert!(mesh.contains(Vec3::ONE) && !mesh.contains(Vec3::splat(2.1)));
        }
    }
}

/// Changes a struct that others cannot write out.
trait With: Sized {
    fn with(self, change: impl FnOnce(&mut Self)) -> Self;
}

impl With for Flaws {
    fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }
}

fn cube_and(more: &str) -> Read {
    let cube = prism(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]], 2.0, 0);
    TriangleMesh::read_obj((cube + more).as_bytes())
}

#[test]
fn sheets_beside_a_solid_are_left_out() {
    let fin = cube_and("v 1 5 0\nf 3 4 9\n").unwrap();
    has(&fin, 8.0, 24.0, "fin");
    assert_eq!(fin.flaws(), Flaws::default().with(|flaws| flaws.loose = 1));
    let mut cards = String::new();
    for i in 0..6 {
        writeln!(cards, "v {i} 3 0\nv {i}.5 3 0\nv {i}.5 4 {i}\nv {i} 4 {i}\nf -4 -3 -2 -1\nf -1 -2 -3 -4")
            .unwrap();
    }
    let leafy = cube_and(&cards).unwrap();
    has(&leafy, 8.0, 24.0, "cards with two sides");
    assert_eq!(leafy.flaws().loose, 12);
    let single = cube_and(&cards.replace("f -1 -2 -3 -4\n", "")).unwrap();
    has(&single, 8.0, 24.0, "cards");
    assert_eq!(single.flaws(), Flaws::default().with(|flaws| flaws.loose = 12));
    // Alone they enclose nothing.
    assert!(TriangleMesh::read_obj(cards.as_bytes()).is_err());
}

#[test]
fn what_is_nested_or_overlaps_counts_once() {
    let within = "v .5 .5 .5\nv 1.5 .5 .5\nv 1.5 1.5 .5\nv .5 1.5 .5\nv .5 .5 1.5\nv 1.5 .5 1.5\nv 1.5 1.5 1.5\nv .5 1.5 1.5\n";
    let outward = "f 13 14 15 16\nf 12 11 10 9\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16\n";
    let inward = "f 16 15 14 13\nf 9 10 11 12\nf 13 14 10 9\nf 14 15 11 10\nf 15 16 12 11\nf 16 13 9 12\n";
    let nested = cube_and(&format!("{within}{outward}")).unwrap();
    assert!((nested.volume() - 8.0).abs() < 0.01 && nested.contains(Vec3::ONE));
    let cavity = cube_and(&format!("{within}{inward}")).unwrap();
    assert!(
        (cavity.volume() - 7.0).abs() < 1e-3
            && !cavity.contains(Vec3::ONE)
            && cavity.contains(Vec3::splat(0.25))
    );
    let over = "v 1 0 0\nv 3 0 0\nv 3 2 0\nv 1 2 0\nv 1 0 2\nv 3 0 2\nv 3 2 2\nv 1 2 2\n";
    let overlapping = cube_and(&format!("{over}{outward}")).unwrap();
    assert!((overlapping.volume() - 12.0).abs() < 0.03, "{}", overlapping.volume());
    assert!(overlapping.contains(Vec3::new(1.5, 1.0, 1.0)) && overlapping.contains(Vec3::new(2.5, 1.0, 1.0)));
}

#[test]
fn small_flaws_do_not_matter_and_are_told() {
    let centre = |mesh: &TriangleMesh, what: &str| {
        assert!((mesh.volume() - 8.0).abs() < 0.01 && mesh.contains(Vec3::ONE), "{what}: {}", mesh.volume());
    };
    // Every vertex a few micrometres off for each face.
    let mut cracked = String::new();
    for (side, face) in super::FACES.iter().enumerate() {
        for [x, y, z] in face.map(|corner| super::CORNERS[corner]) {
            writeln!(cracked, "v {x}.00000{side} {y} {z}").unwrap();
        }
        cracked += "f -4 -3 -2 -1\n";
    }
    let mesh = TriangleMesh::read_obj(cracked.as_bytes()).unwrap();
    centre(&mesh, "cracked");
    assert!(mesh.flaws().open_sides > 0);
    for wrong in 0..6 {
        let mesh = cubes(&[[0, 0, 0]], true, |_, side| side == wrong, |_| 0).unwrap();
        centre(&mesh, "one side inward");
        assert_eq!(mesh.flaws().turned, 2);
    }
    let half = cubes(&[[0, 0, 0]], true, |_, side| side % 2 == 0, |_| 0).unwrap();
    centre(&half, "half inward");
    assert_eq!(half.flaws().turned, 6);
    let open = prism(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]], 2.0, 0);
    let open: String =
        open.lines().filter(|line| *line != "f 5 6 7 8").map(|line| format!("{line}\n")).collect();
    let mesh = TriangleMesh::read_obj(open.as_bytes()).unwrap();
    assert!(mesh.flaws().open_sides == 4 && mesh.flaws().doubt > 0.1 && mesh.contains(Vec3::ONE));
    refused(
        TriangleMesh::read_obj(
            &b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\nf 4 5 6\n"[..],
        ),
        &["open sides"],
        "two triangles",
    );
}

/// However long and thin: what is inside is told in a time that does not grow with the triangles.
#[test]
fn slivers_cost_no_more_than_others() {
    for tilt in [0.0, 0.7_f64] {
        let outline = |count: u32| {
            let ring = move |i: u32| f64::from(i) / f64::from(count) * std::f64::consts::TAU;
            (0..count).map(ring).map(|angle| [angle.cos(), angle.sin()]).collect::<Vec<_>>()
        };
        let count = 4000;
        let turned = |line: &str| {
            let Some(rest) = line.strip_prefix("v ") else { return line.to_owned() };
            let p: Vec<f64> = rest.split(' ').map(|x| x.parse().unwrap()).collect();
            let (sin, cos) = tilt.sin_cos();
            format!("v {} {} {}", p[0], cos * p[1] - sin * p[2], sin * p[1] + cos * p[2])
        };
        // Caps as fans from one corner, the worst that programs write.
        let mut text: String = prism(&outline(count), 2.0, 0)
            .lines()
            .filter(|line| line.split(' ').count() < 100)
            .map(|line| turned(line) + "\n")
            .collect();
        for i in 2..count {
            writeln!(text, "f 1 {} {}\nf {} {} {}", i + 1, i, count + 1, count + i, count + i + 1).unwrap();
        }
        let mesh = is(
            TriangleMesh::read_obj(text.as_bytes()),
            std::f32::consts::TAU,
            6.0 * std::f32::consts::PI,
            "cylinder",
        );
        let place = |i: u32| {
            let share = |step: f64| (f64::from(i) * step).fract() as f32;
            mesh.bounds().at(Vec3::new(share(0.819_172_5), share(0.671_043_6), share(0.549_700_5)))
        };
        let start = std::time::Instant::now();
        let inside = (0..200_000).filter(|&i| mesh.contains(place(i))).count();
        let share = inside as f32 / 200_000.0 * mesh.bounds().volume() / mesh.volume();
        assert!((share - 1.0).abs() < 0.01, "{share}");
        // A microsecond or two each in fact; by the plain sum it would take minutes.
        assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    }
}
