//! Clouds of laser scanners: LAS, LAZ, E57.

use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex};

use e57::{E57Writer, Quaternion, Record, RecordValue, Transform, Translation};
use proptest::prelude::*;
use treesynth::cloud::{Cloud, CloudError, Frame};
use treesynth::glam::{DVec3, Vec3};
use treesynth::shape::UpAxis;

/// A file in memory that can be looked at after its writer is gone.
#[derive(Debug, Clone, Default)]
struct Shared(Arc<Mutex<Cursor<Vec<u8>>>>);

impl Shared {
    fn content(&self) -> Vec<u8> {
        self.0.lock().expect("one thread").get_ref().clone()
    }
}

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().expect("one thread").write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Shared {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.0.lock().expect("one thread").read(bytes)
    }
}

impl Seek for Shared {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.lock().expect("one thread").seek(to)
    }
}

fn las(cloud: &Cloud, frame: &Frame, is_compressed: bool) -> Vec<u8> {
    let file = Shared::default();
    cloud.write_las(frame, is_compressed, file.clone()).expect("it fits");
    file.content()
}

fn read_las(frame: &Frame, bytes: &[u8]) -> Result<Cloud, CloudError> {
    Cloud::read_las(frame, Cursor::new(bytes.to_vec()))
}

/// An E57 file of two scans: the second is turned a quarter about Z and moved by `moved`.
fn e57(points: &[DVec3], moved: DVec3) -> Vec<u8> {
    let file = Shared::default();
    let mut writer = E57Writer::new(file.clone(), "file").expect("a file");
    for (number, turn) in [0.0, 0.25 * std::f64::consts::PI].into_iter().enumerate() {
        let prototype = vec![Record::CARTESIAN_X_F64, Record::CARTESIAN_Y_F64, Record::CARTESIAN_Z_F64];
        let mut scan = writer.add_pointcloud(&format!("scan {number}"), prototype).expect("a scan");
        if number == 1 {
            let rotation = Quaternion { w: turn.cos(), x: 0.0, y: 0.0, z: turn.sin() };
            let translation = Translation { x: moved.x, y: moved.y, z: moved.z };
            scan.set_transform(Some(Transform { rotation, translation }));
        }
        for point in points {
            scan.add_point(point.to_array().map(RecordValue::Double).to_vec()).expect("a point");
        }
        scan.finalize().expect("a scan");
    }
    writer.finalize().expect("a file");
    file.content()
}

#[test]
fn scans_stand_where_their_poses_put_them() -> Result<(), CloudError> {
    let points = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.0, 0.0, 0.5)];
    let file = e57(&points, DVec3::new(10.0, 0.0, 1.0));
    let cloud = Cloud::read_e57(&Frame::default(), Cursor::new(&file))?;
    // A quarter turn about Z: x, y becomes -y, x. Then +Z up becomes +Y up.
    let expected = [(1.0, 2.0, 3.0), (-4.0, 0.0, 0.5), (8.0, 1.0, 4.0), (10.0, -4.0, 1.5)];
    for (point, (x, y, z)) in cloud.points().iter().zip(expected) {
        assert!(point.distance(Vec3::new(x, z, -y)) < 1e-5, "{point} {x} {y} {z}");
    }
    assert_eq!(cloud.len(), 4);
    Ok(())
}

#[test]
fn files_are_opened_by_their_endings() -> Result<(), Box<dyn std::error::Error>> {
    let cloud = Cloud::new(vec![Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)])?;
    let folder = std::env::temp_dir().join(format!("treesynth-lidar-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let e57 = e57(&[DVec3::ZERO, DVec3::new(1.0, -3.0, 2.0)], DVec3::ZERO);
    let frame = Frame::default();
    for (name, bytes, count) in
        [("a.las", las(&cloud, &frame, false), 2), ("a.LAZ", las(&cloud, &frame, true), 2), ("a.e57", e57, 4)]
    {
        std::fs::write(folder.join(name), bytes)?;
        let read = Cloud::open(&frame, folder.join(name))?;
        assert_eq!(read.len(), count, "{name}");
        assert_eq!(read.points()[..2], *cloud.points(), "{name}");
    }
    std::fs::remove_dir_all(folder)?;
    Ok(())
}

#[test]
fn coordinates_that_do_not_fit_are_refused() -> Result<(), CloudError> {
    let cloud = Cloud::new(vec![Vec3::ZERO, Vec3::X * 500.0])?;
    let millimetres = Frame::default().with_unit(0.001);
    let error = cloud.write_las(&millimetres, false, Shared::default()).expect_err("32 bits").to_string();
    assert!(error.starts_with("LAS, point 0: "), "{error}");
    Ok(())
}

/// A disk that is full after some bytes.
#[derive(Debug)]
struct Full(Cursor<Vec<u8>>, usize);

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.0.get_ref().len() + bytes.len() > self.1 {
            return Err(io::Error::other("the disk is full"));
        }
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Full {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

#[test]
fn a_full_disk_is_an_error() -> Result<(), CloudError> {
    let points =
        (0..50_000_u32).map(|i| Vec3::new((i % 97) as f32, (i % 89) as f32 * 0.37, (i % 83) as f32 * 0.7));
    let cloud = Cloud::new(points.collect())?;
    for is_compressed in [false, true] {
        for room in [0, 100, 300, 1000] {
            let file = Full(Cursor::new(Vec::new()), room);
            let error = cloud.write_las(&Frame::default(), is_compressed, file).expect_err("it is full");
            assert!(error.to_string().contains("the disk is full"), "{error}");
        }
    }
    Ok(())
}

fn clouds() -> impl Strategy<Value = Cloud> {
    let point = prop::array::uniform3(-900.0_f32..900.0).prop_map(Vec3::from);
    prop::collection::vec(point, 0..300).prop_map(|points| Cloud::new(points).expect("near"))
}

proptest! {
    #[test]
    fn las_comes_back_to_a_tenth_of_a_millimetre(
        cloud in clouds(),
        is_compressed: bool,
        is_z_up: bool,
        east in prop_oneof![Just(0.0), 1e5..1e6_f64],
    ) {
        let up = if is_z_up { UpAxis::Z } else { UpAxis::Y };
        let frame = Frame::default().with_up(up).with_offset(DVec3::new(east.floor(), 0.0, 0.0));
        let read = read_las(&frame, &las(&cloud, &frame, is_compressed))?;
        prop_assert_eq!(read.len(), cloud.len());
        for (&read, &own) in read.points().iter().zip(cloud.points()) {
            prop_assert!(read.distance(own) < 2e-4, "{read} {own}");
        }
    }

    /// Whatever stands in the file: a cloud or an error.
    #[test]
    fn bent_files_are_read_or_refused(
        cloud in clouds(),
        is_compressed: bool,
        cut in 0.0..1.0_f64,
        changes in prop::collection::vec((0.0..1.0_f64, any::<u8>()), 0..8),
        is_cut: bool,
    ) {
        let places: Vec<DVec3> = cloud.points().iter().map(|point| point.as_dvec3()).collect();
        for (is_las, mut bytes) in [
            (true, las(&cloud, &Frame::default(), is_compressed)),
            (false, e57(&places, DVec3::ZERO)),
        ] {
            for (at, byte) in &changes {
                let at = (at * bytes.len() as f64) as usize;
                bytes[at] = *byte;
            }
            if is_cut {
                bytes.truncate((cut * bytes.len() as f64) as usize);
            }
            let read = if is_las {
                read_las(&Frame::default(), &bytes)
            } else {
                Cloud::read_e57(&Frame::default(), Cursor::new(&bytes))
            };
            if let Err(error) = read {
                prop_assert!(error.to_string().len() < 2000);
            }
        }
    }
}

#[test]
fn lengths_that_the_file_cannot_hold_are_refused() {
    let cloud = Cloud::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y]).expect("a cloud");
    let told = |bytes: &[u8]| read_las(&Frame::default(), bytes).expect_err("it cannot be").to_string();
    let mut laz = las(&cloud, &Frame::default(), true);
    let place =
        |bytes: &[u8], at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("4")) as usize;
    let table = place(&laz, place(&laz, 96));
    // 34 gigabytes of chunks: the decoder would take them and the process would end.
    laz[table + 4..table + 8].fill(0xFF);
    assert!(told(&laz).contains("table of chunks") && told(&laz).contains("4294967295"), "{}", told(&laz));
    // Version 1.4, one extended record of half of all bytes that can be numbered.
    let mut las = vec![0; 375 + 60];
    las[..4].copy_from_slice(b"LASF");
    (las[24], las[25], las[104]) = (1, 4, 6);
    for (at, number) in [(94, 375u16), (105, 30)] {
        las[at..at + 2].copy_from_slice(&number.to_le_bytes());
    }
    las[96..100].copy_from_slice(&375u32.to_le_bytes());
    for axis in 0..3 {
        las[131 + 8 * axis..139 + 8 * axis].copy_from_slice(&0.01f64.to_le_bytes());
    }
    las[235..243].copy_from_slice(&375u64.to_le_bytes());
    las[243..247].copy_from_slice(&1u32.to_le_bytes());
    las[395..403].copy_from_slice(&(u64::MAX / 2).to_le_bytes());
    assert!(told(&las).contains("extended record"), "{}", told(&las));
}
