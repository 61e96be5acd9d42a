use glam::{DVec3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::shape::UpAxis;

fn read(text: &str) -> Result<Cloud, CloudError> {
    Cloud::read_xyz(&Frame::default().with_up(UpAxis::Y), text.as_bytes())
}

#[test]
fn texts_of_many_kinds_are_one_cloud() {
    let points = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-0.5, 1e-3, 4.0)];
    for text in [
        "1 2 3\n-.5 1e-3 4",
        "2\r\n1 2 3 255 0 0\r\n-.5 1e-3 4 1 1 1\r\n",
        "X,Y,Z,Intensity\n1,2,3,7\n-0.5,0.001,4,7\n",
        "//intensity x y z\n9 1 2 3\n9 -0.5 0.001 4\n",
        "# x y z\n\n1\t2\t3\n# more\n-0.5;0.001;4\n",
        "\"z\";\"y\";\"x\"\n3;2;1\n4;1e-3;-.5",
        "easting northing up\n1 2 3\n-0.5 0.001 4\n",
    ] {
        assert_eq!(read(text).expect(text).points(), points, "{text}");
    }
}

#[test]
fn what_is_wrong_is_named() {
    for (text, part) in [
        ("1 2 3\n4 5\n", "line 2: \"4 5\" must have the three numbers"),
        ("1 2 3\n4 x 6\n", "line 2, column 2: \"x\" must be a finite number"),
        ("1 2 nan\n", "line 1, column 3: \"nan\""),
        ("1 2 3\nx y z\n", "line 2, column 1"),
        ("\u{1f}\u{8b}", "line 1"),
    ] {
        let error = read(text).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains(part) || text.starts_with('\u{1f}'), "{text}: {error}");
    }
    assert!(read("").expect("no points").is_empty());
    assert!(read("0 0 0\n2e6 0 0\n1e300 0 0\n").is_err());
    let gz = Cloud::read_xyz(&Frame::default(), &b"\x1f\x8b\x08"[..]).map_err(|error| error.to_string());
    assert!(gz.expect_err("packed").contains("gzip"));
    let frame = Frame::default().with_unit(0.0);
    assert!(matches!(Cloud::read_xyz(&frame, &b"1 2 3"[..]), Err(CloudError::Parameter(_))));
    assert!(Cloud::new(vec![Vec3::ZERO, Vec3::NAN]).is_err());
    assert!(read("1 2 3").expect("a point").thinned(0.0).is_err());
}

#[test]
fn ply_of_every_kind_of_number_is_read() {
    let kinds = [
        ("char", 1),
        ("uchar", 1),
        ("short", 2),
        ("ushort", 2),
        ("int", 4),
        ("uint", 4),
        ("float", 4),
        ("double", 8),
        ("int64", 8),
        ("uint64", 8),
    ];
    for (kind, size) in kinds {
        for big in [false, true] {
            let order = if big { "big" } else { "little" };
            let mut file = format!(
                "ply\nformat binary_{order}_endian 1.0\nelement camera 1\nproperty list uchar int seen\nelement vertex 2\n\
                 property uchar red\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\nend_header\n"
            )
            .into_bytes();
            file.extend([1, 9, 9, 9, 9]);
            for point in [[1_u8, 2, 3], [4, 5, 6]] {
                file.push(200);
                for value in point {
                    let mut bytes = match kind {
                        "float" => f32::from(value).to_le_bytes().to_vec(),
                        "double" => f64::from(value).to_le_bytes().to_vec(),
                        _ => u64::from(value).to_le_bytes()[..size].to_vec(),
                    };
                    if big {
                        bytes.reverse();
                    }
                    file.extend(bytes);
                }
            }
            let cloud = Cloud::read_ply(&Frame::default().with_up(UpAxis::Y), &file[..]).expect(kind);
            assert_eq!(cloud.points(), [Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0)], "{kind}");
            for end in 0..file.len() {
                assert!(Cloud::read_ply(&Frame::default(), &file[..end]).is_err(), "{kind} cut at {end}");
            }
        }
    }
}

proptest! {
    #[test]
    fn round_trips_lose_nothing(
        points in prop::collection::vec(prop::array::uniform3(-999.0_f32..999.0), 0..40),
        up in prop::sample::select(vec![UpAxis::Y, UpAxis::Z]),
        unit in prop::sample::select(vec![1.0, 0.001, 0.0254]),
        offset in prop::sample::select(vec![DVec3::ZERO, DVec3::new(478_123.0, 5_429_876.0, 211.0)]),
    ) {
        let cloud = Cloud::new(points.into_iter().map(Vec3::from_array).collect()).expect("finite");
        let frame = Frame::default().with_up(up).with_unit(unit).with_offset(offset);
        let mut files = vec![Vec::new(); 4];
        cloud.write_xyz(&frame, &mut files[0]).expect("written");
        for (file, encoding) in files[1..].iter_mut().zip([PlyEncoding::Text, PlyEncoding::Little, PlyEncoding::Big]) {
            cloud.write_ply(&frame, encoding, file).expect("written");
        }
        for (at, file) in files.iter().enumerate() {
            let back = if at == 0 { Cloud::read_xyz(&frame, &file[..]) } else { Cloud::read_ply(&frame, &file[..]) };
            let back = back.expect("read");
            prop_assert_eq!(back.offset(), offset);
            prop_assert_eq!(back.len(), cloud.len());
            for (a, b) in back.points().iter().zip(cloud.points()) {
                let tolerance = if offset == DVec3::ZERO { 0.0 } else { 1e-4_f32.max(b.length() * 1e-7) };
                prop_assert!(a.distance(*b) <= tolerance, "{a} {b}");
            }
        }
    }
}

#[test]
fn texts_of_points_are_read_or_refused_but_never_shifted() {
    let read = |text: &str| Cloud::read_xyz(&Frame::default(), text.as_bytes());
    let first =
        |text: &str| read(text).unwrap_or_else(|error| panic!("{text:?}: {error}")).points()[0].to_array();
    for text in [
        "1 2 3",
        "1,2,3",
        "1; 2; 3",
        "1\t2\t3\t",
        "name,x,y,z\noak,1,2,3",
        "id,label,x,y,z,i\n7,,1,2,3,90",
        "\"x\" \"y\" \"z\"\n\"1\" 1 2 3",
        "# made by hand\n1\n1 2 3",
        "// turned about x, y and z by 0\n1 2 3 4 5 6 7 8",
        "//X Y Z R\n1 2 3 255",
    ] {
        // Up is z in the file, y in the cloud.
        assert_eq!(first(text).map(f32::to_bits), [1.0_f32, 3.0, -2.0].map(f32::to_bits), "{text:?}");
    }
    for (text, what) in [
        ("1,25;2,5;3,75", "with a decimal point"),
        ("x;y;z\n1,25;2,5;3,75", "must be a finite number"),
        ("1,25 2,5 3,75", "must be a finite number"),
        ("LASF\0\0", "LAS"),
        ("# .PCD v0.7\nFIELDS x y z\n1 2 3", "PCD"),
        ("this is\nno cloud", "no text of points"),
    ] {
        let error = read(text).expect_err(text).to_string();
        assert!(error.contains(what), "{text:?}: {error}");
    }
    let error = Cloud::open(&Frame::default(), "there-is-none.xyz").unwrap_err().to_string();
    assert!(error.contains("there-is-none.xyz"), "{error}");
}

#[test]
fn what_an_f32_cannot_hold_is_refused() {
    let survey = "0 0 0\n530000.25 180000.5 12.125\n530001.25 180002.5 14.125\n";
    let error = Cloud::read_xyz(&Frame::default(), survey.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("within 10 km") && error.contains("with_offset"), "{error}");
    let pair = |apart: u32| format!("530000 0 0\n{} 0 0\n", 530_000 + apart);
    assert!(Cloud::read_xyz(&Frame::default(), pair(10_000).as_bytes()).is_ok());
    assert!(Cloud::read_xyz(&Frame::default(), pair(10_001).as_bytes()).is_err());
    let apart = survey.split_once('\n').expect("two lines").1;
    let cloud = Cloud::read_xyz(&Frame::default(), apart.as_bytes()).expect("a survey");
    assert_eq!(
        (cloud.points()[1] - cloud.points()[0]).to_array().map(f32::to_bits),
        [1.0_f32, 2.0, -2.0].map(f32::to_bits)
    );
    let header = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    let error =
        Cloud::read_ply(&Frame::default(), format!("{header}1 2 3 255 0 0\n4 5 6 255 0 0\n").as_bytes());
    let error = error.unwrap_err().to_string();
    assert!(error.contains("line 8") && error.contains("more numbers"), "{error}");
    assert_eq!(
        Cloud::read_ply(&Frame::default(), format!("{header}1 2 3\n4 5 6 \n").as_bytes())
            .expect("sound")
            .len(),
        2
    );
}
