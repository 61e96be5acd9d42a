//! Every importer under thousands of bent files: no panic, no hang, no more memory than the file calls for.

use std::io::Cursor;
use std::panic::catch_unwind;
use treesynth::rand::{Rng, RngExt};
use treesynth::random::{Purpose, stream};
use treesynth::shape::{Import, MeshFormat, Outline};

/// How often each reader is run; more by `TREESYNTH_MUTATIONS`.
fn runs() -> u64 {
    std::env::var("TREESYNTH_MUTATIONS").ok().and_then(|runs| runs.parse().ok()).unwrap_or(20_000)
}

/// Words that break readers.
const WORDS: [&[u8]; 26] = [
    b"-1",
    b"0",
    b"4294967295",
    b"4294967296",
    b"18446744073709551615",
    b"-9223372036854775808",
    b"1e39",
    b"1e400",
    b"nan",
    b"inf",
    b"\\\n",
    b"\r",
    b"\n",
    b" ",
    b"#",
    b"/",
    b"f ",
    b"v ",
    b"solid ",
    b"endloop",
    b"vertex ",
    b"end_header\n",
    b"element none 4294967295\n",
    b"property list uint uint many\n",
    b"\xFF\xFF\xFF\xFF",
    b"\0\0\0\0",
];

fn bend(bytes: &mut Vec<u8>, random: &mut impl Rng) {
    for _ in 0..random.random_range(1..6) {
        let at = random.random_range(0..bytes.len().max(1)).min(bytes.len());
        let end = (at + random.random_range(0..20_usize)).min(bytes.len());
        match random.random_range(0..8) {
            0 if at < bytes.len() => bytes[at] = random.random(),
            1 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let part = bytes[at..end].to_vec();
                let to = random.random_range(0..=bytes.len());
                bytes.splice(to..to, part);
            }
            4 => bytes.truncate(at),
            5 => bytes
                .splice(at..end, WORDS[random.random_range(0..WORDS.len())].iter().copied())
                .for_each(drop),
            6 => bytes
                .splice(at..at, WORDS[random.random_range(0..WORDS.len())].iter().copied())
                .for_each(drop),
            _ => {
                // A number for a number.
                let digits = |byte: &u8| byte.is_ascii_digit();
                if let Some(start) = bytes[at..].iter().position(digits).map(|start| at + start) {
                    let end = bytes[start..]
                        .iter()
                        .position(|byte| !digits(byte))
                        .map_or(bytes.len(), |end| start + end);
                    let number = random.random::<u64>() >> random.random_range(0..64);
                    bytes.splice(start..end, number.to_string().into_bytes()).for_each(drop);
                }
            }
        }
    }
}

/// Runs a reader on bent files; a panic names the file.
fn run(what: &str, seeds: &[Vec<u8>], read: impl Fn(&[u8]) -> bool + std::panic::RefUnwindSafe) {
    let (mut read_well, runs) = (0, runs());
    for run in 0..runs {
        let mut random = stream(run, 0, Purpose::CUSTOM, 1);
        let mut bytes = seeds[random.random_range(0..seeds.len())].clone();
        bend(&mut bytes, &mut random);
        let start = std::time::Instant::now();
        let well = catch_unwind(|| read(&bytes));
        assert!(well.is_ok(), "{what}, run {run}: {:?}", String::from_utf8_lossy(&bytes));
        read_well += u64::from(well.unwrap_or_default());
        assert!(start.elapsed().as_secs() < 20, "{what}, run {run} took {:?}", start.elapsed());
    }
    assert!(read_well > 0 && read_well < runs, "{what}: {read_well} of {runs} were read");
}

fn mesh(format: MeshFormat) -> impl Fn(&[u8]) -> bool {
    move |bytes| Import::default().read(format, Cursor::new(bytes)).is_ok()
}

/// The cube in a format of this crate's exporters, and texts of more kinds.
fn written(format: MeshFormat) -> Vec<Vec<u8>> {
    use treesynth::export::{GlbOptions, PlyFormat, write_glb, write_obj, write_ply, write_stl};
    use treesynth::glam::Vec3;
    use treesynth::surface::{Mesh, Part};
    let corners: Vec<Vec3> =
        super::CORNERS.iter().map(|corner| Vec3::from_array(corner.map(f32::from))).collect();
    let indices = super::FACES
        .iter()
        .flat_map(|&[a, b, c, d]| [a, b, c, a, c, d])
        .map(|corner| corner as u32)
        .collect();
    let mesh = Mesh::new(corners, vec![Vec3::Y; 8], indices);
    let parts = [Part::new(&mesh)];
    let mut bytes = Vec::new();
    match format {
        MeshFormat::Obj => write_obj(&parts, "a.mtl", &mut bytes).unwrap(),
        MeshFormat::Stl => write_stl(&parts, &mut bytes).unwrap(),
        MeshFormat::Ply => write_ply(&parts, PlyFormat::Binary, &mut bytes).unwrap(),
        _ => write_glb(&mesh, &GlbOptions::default(), &mut bytes).unwrap(),
    }
    let mut files = vec![bytes];
    if format == MeshFormat::Ply {
        let mut text = Vec::new();
        write_ply(&parts, PlyFormat::Ascii, &mut text).unwrap();
        files.push(text);
    }
    files
}

#[test]
fn bent_obj_files() {
    let mut seeds = written(MeshFormat::Obj);
    let outline = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    seeds.push(super::obj::prism(&outline, 2.0, 1).into_bytes());
    seeds.push(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvn 0 0 1\nf -4/-1/-1 -2//-1 -3\nf 1 2 4\nf 1 4 3\nf 2 3 \\\n4\n".to_vec());
    run("OBJ", &seeds, mesh(MeshFormat::Obj));
}

#[test]
fn bent_stl_files() {
    let mut seeds = written(MeshFormat::Stl);
    let facet = |corners: [[i32; 3]; 3]| {
        let lines: String = corners.iter().map(|[x, y, z]| format!("vertex {x} {y} {z}\n")).collect();
        format!("facet normal 0 0 0\nouter loop\n{lines}endloop\nendfacet\n")
    };
    let [o, x, y, z] = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let facets: String = [[o, y, x], [o, x, z], [o, z, y], [x, y, z]].map(facet).concat();
    seeds.push(format!("solid a\n{facets}endsolid a\n").into_bytes());
    run("STL", &seeds, mesh(MeshFormat::Stl));
}

#[test]
fn bent_ply_files() {
    run("PLY", &written(MeshFormat::Ply), mesh(MeshFormat::Ply));
}

#[test]
fn bent_gltf_files() {
    run("glTF", &written(MeshFormat::Gltf), mesh(MeshFormat::Gltf));
}

#[test]
fn bent_path_data() {
    let seeds = [
        "M5 9 C-3 3 2 -1 5 2 S8 -1 13 3 Q1 1 5 9 T2 2Z",
        "M 0 1 A 1 1 0 0 1 2 1 A 1 1 0 0 1 0 1 Z M .5 1 a .5 .5 0 0 0 1 0 a .5 .5 0 0 0 -1 0 z",
        "m0 0h4v4h-4zl1 1 1-1zM1 1v2h2v-2z",
        "M0,-5 2.9389,4.0451 -4.7553,-1.5451 4.7553,-1.5451 -2.9389,4.0451z",
    ];
    let seeds = seeds.map(|data| data.as_bytes().to_vec());
    run("path data", &seeds, |bytes| {
        Outline::from_svg_path(&String::from_utf8_lossy(bytes)).is_ok_and(|outline| outline.check().is_ok())
    });
}

#[test]
fn bent_drawings() {
    let drawing = r##"<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 9 9" width="3cm"><style>.a{fill:red}</style>
        <defs><path id="p" d="M0 0h4v4h-4z"/></defs><use xlink:href="#p" transform="rotate(30 1 2)"/><g class="a"><circle r="2"/><rect width="10%" height="3"/>
        <path fill-rule="evenodd" d="M0 0h4v4h-4zM1 1h2v2h-2z"/></g></svg>"##;
    run("SVG", &[drawing.as_bytes().to_vec()], |bytes| {
        Outline::from_svg(&String::from_utf8_lossy(bytes)).is_ok()
    });
}

#[cfg(feature = "json")]
#[test]
fn bent_skeletons() {
    let fork = r#"{"positions":[[0,0,0],[0,1,0],[1,2,0],[-1,2,0.5]],"parents":[null,0,1,1],"radii":[0.2,0.1,0.05,0.05],
        "stages":[0,0,1,1],"orders":[0,0,0,1],"hops":[0,1,1,1]}"#;
    run("JSON", &[fork.as_bytes().to_vec()], |bytes| {
        treesynth::export::read_skeleton(bytes).is_ok_and(|skeleton| skeleton.check().is_ok())
    });
}

#[test]
fn bent_tables_of_trees() {
    use treesynth::cloud::{Cloud, Frame, PlyEncoding};
    use treesynth::format::{
        FormatError, Trees, read_mtg, read_qsm, read_swc, write_mtg, write_qsm, write_swc,
    };
    use treesynth::glam::Vec3;
    let nodes = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 2.0, 0.0], [-1.0, 2.0, 0.5]].map(Vec3::from);
    let tree = treesynth::Skeleton::new(nodes.to_vec(), vec![None, Some(0), Some(1), Some(1)]).unwrap();
    let tree = tree.with_radii(vec![0.2, 0.1, 0.05, 0.05]).unwrap();
    let frame = Frame::default();
    let sound = |read: Result<Trees, FormatError>| {
        read.is_ok_and(|trees| trees.trees.iter().all(|tree| tree.check().is_ok()))
    };
    let mut file = Vec::new();
    write_qsm(&tree, &frame, &mut file).unwrap();
    run("QSM", &[file], |bytes| sound(read_qsm(&Frame::default(), bytes)));
    let mut file = Vec::new();
    write_swc(&tree, &frame, &mut file).unwrap();
    run("SWC", &[file], |bytes| sound(read_swc(&Frame::default(), bytes)));
    let mut file = Vec::new();
    write_mtg(&tree, &frame, &mut file).unwrap();
    run("MTG", &[file], |bytes| sound(read_mtg(&Frame::default(), bytes)));
    let cloud = Cloud::new(nodes.to_vec()).unwrap();
    let mut files = vec![Vec::new(); 4];
    cloud.write_xyz(&frame, &mut files[0]).unwrap();
    run("XYZ", &files[..1], |bytes| Cloud::read_xyz(&Frame::default(), bytes).is_ok());
    for (file, encoding) in
        files[1..].iter_mut().zip([PlyEncoding::Text, PlyEncoding::Little, PlyEncoding::Big])
    {
        cloud.write_ply(&frame, encoding, file).unwrap();
    }
    run("PLY clouds", &files[1..], |bytes| Cloud::read_ply(&Frame::default(), bytes).is_ok());
}
