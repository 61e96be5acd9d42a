//! The renderer as a whole.

use super::*;
use crate::surface::{Implicit, Instance, Tubes};
use crate::{Skeleton, math};
use glam::Quat;
use proptest::prelude::*;

const WHITE: [f32; 3] = [1.0; 3];

fn pole(radius: f32) -> Mesh {
    let points = (0..=20).map(|i| Vec3::new(0.02 * i as f32, 0.1 * i as f32, 0.0)).collect();
    let parents = (0..=20u32).map(|i| i.checked_sub(1)).collect();
    let skeleton =
        Skeleton::new(points, parents).and_then(|s| s.with_radii(vec![radius; 21])).expect("sound");
    Tubes::default().mesh(&skeleton).expect("has a surface")
}

/// Two triangles in the plane z = 0, seen from +Z.
fn board(half: f32) -> Mesh {
    let corner = |x: f32, y: f32| Vec3::new(x * half, y * half, 0.0);
    let positions = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    Mesh::new(positions, vec![Vec3::Z; 4], vec![0, 1, 2, 0, 2, 3])
}

fn black() -> Material {
    Material::bark().with_color([0.0; 3])
}

fn plain(width: u32, height: u32) -> Preview {
    Preview::default().with_size(width, height).with_background(WHITE, WHITE).with_ground(false)
}

fn level() -> Camera {
    Camera::default().with_elevation(0.0).with_projection(Projection::Orthographic)
}

/// Coverage of each row by something black, pixels.
fn rows(picture: &Picture) -> Vec<f32> {
    let linear = |v: u8| {
        let v = f32::from(v) / 255.0;
        if v <= 0.04045 { v / 12.92 } else { math::powf((v + 0.055) / 1.055, 2.4) }
    };
    let rows = picture.pixels().chunks(picture.width() as usize);
    rows.map(|row| row.iter().map(|pixel| 1.0 - linear(pixel[0])).sum()).collect()
}

#[test]
fn a_board_covers_its_pixels() {
    let camera = level().with_margin(0.25);
    let picture = plain(64, 64).with_camera(camera).with_bark(black()).draw(&board(1.0)).expect("a picture");
    for (y, covered) in rows(&picture).into_iter().enumerate() {
        let expected = if (16..48).contains(&y) { 32.0 } else { 0.0 };
        assert!((covered - expected).abs() < 0.1, "{covered} in row {y}");
    }
}

#[test]
fn vertices_have_colors_of_their_own() {
    let mut mesh = board(1.0);
    mesh.colors = vec![[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
    let bark = Material::bark().with_color(WHITE);
    let picture = plain(64, 64).with_camera(level()).with_bark(bark).draw(&mesh).expect("a picture");
    let row = &picture.pixels()[32 * 64 + 12..32 * 64 + 52];
    assert!(row.is_sorted_by(|a, b| a[0] >= b[0] && a[2] <= b[2]), "red turns into blue: {row:?}");
    assert!(row[0][0] > row[39][0] + 60 && row[39][2] > row[0][2] + 60 && row.iter().all(|p| p[1] == 0));
}

#[test]
fn a_wire_is_as_dark_as_it_is_wide_and_never_broken() {
    for width in [0.05, 0.2, 0.5, 0.8, 1.5, 4.0] {
        let scale = 92.0 / 2.0;
        let mesh = pole(0.5 * width / scale);
        let picture = plain(100, 100).with_camera(level()).with_bark(black()).draw(&mesh).expect("a picture");
        // The pole leans, and its polygon is narrower than its circle.
        let expected = width * 1.02;
        for (y, covered) in rows(&picture).into_iter().enumerate().skip(8).take(84) {
            let error = (covered - expected).abs() / expected;
            assert!(error < 0.25, "{covered} of {expected} in row {y}");
        }
    }
}

#[test]
fn the_back_is_seen_if_asked_for() {
    let mesh = board(1.0);
    let behind = plain(32, 32).with_camera(level().with_azimuth(std::f32::consts::PI));
    let seen =
        |part: Part<'_>| -> f32 { rows(&behind.draw_parts(&[part]).expect("a picture")).into_iter().sum() };
    let part = Part::new(&mesh);
    assert!(seen(part.with_material(black())) < 0.1);
    assert!(seen(part.with_material(black().with_double_sided(true))) > 500.0);
}

#[test]
fn what_is_nearer_hides_what_is_farther() {
    let mut near = board(0.5);
    near.positions.iter_mut().for_each(|p| p.z = 1.0);
    let far = board(1.0);
    let colored = |color| Material::bark().with_color(color);
    let parts = [
        Part::new(&near).with_material(colored([0.9, 0.0, 0.0])),
        Part::new(&far).with_material(colored([0.0, 0.0, 0.9])),
    ];
    for parts in [[parts[0], parts[1]], [parts[1], parts[0]]] {
        let picture = plain(64, 64).with_camera(level()).draw_parts(&parts).expect("a picture");
        let [red, _, blue] = picture.pixel(32, 32).expect("inside");
        assert!(red > 100 && blue < 10);
        let [red, _, blue] = picture.pixel(8, 8).expect("inside");
        assert!(red < 10 && blue > 50);
    }
}

#[test]
fn a_trunk_has_a_shadow_on_the_ground() {
    let preview = plain(100, 100).with_ground(true).with_sun(Vec3::new(-1.0, 1.0, 0.0));
    let picture =
        preview.with_camera(Camera::default().with_elevation(0.4)).draw(&pole(0.05)).expect("a picture");
    let darkest = |columns: std::ops::Range<u32>| {
        columns
            .flat_map(|x| (0..100).map(move |y| (x, y)))
            .filter_map(|(x, y)| picture.pixel(x, y))
            .map(|p| p[0])
            .min()
    };
    assert!(darkest(75..100) < Some(200), "to the right, away from the sun");
    assert!(darkest(0..25) > Some(230));
}

/// Three boards about the axis, each turned and scaled otherwise.
fn boards() -> Vec<Instance> {
    let place = |i: f32| Instance {
        position: Vec3::new(math::cos(i * 2.0), i * 0.7, math::sin(i * 2.0)),
        rotation: Quat::from_xyzw(0.0, math::sin(i), 0.0, math::cos(i)),
        scale: 0.4 + 0.1 * i,
        ..Instance::IDENTITY
    };
    (0..3).map(|i| place(i as f32)).collect()
}

#[test]
fn instances_are_drawn_like_copies() {
    let (one, instances) = (board(1.0), boards());
    let mut all = Mesh::default();
    for instance in &instances {
        let first = all.positions.len() as u32;
        all.positions.extend(one.positions.iter().map(|&p| instance.matrix() * p + instance.position));
        all.normals.extend(one.normals.iter().map(|&n| instance.rotation_matrix() * n));
        all.indices.extend(one.indices.iter().map(|index| first + index));
    }
    let draw = |part: Part<'_>| {
        let preview = Preview::default().with_size(90, 80);
        preview.draw_parts(&[part.with_material(Material::leaf())]).expect("a picture")
    };
    assert_eq!(draw(Part::new(&one).with_instances(&instances)), draw(Part::new(&all)));
}

#[test]
fn light_comes_through_leaves_alone() {
    let lit = |material: Material| {
        let preview = plain(16, 16).with_sun(Vec3::NEG_Z).with_camera(level());
        let picture =
            preview.draw_parts(&[Part::new(&board(1.0)).with_material(material)]).expect("a picture");
        picture.pixel(8, 8).expect("inside")[1]
    };
    assert!(lit(Material::leaf()) > lit(Material::leaf().with_double_sided(false)) + 40);
}

/// Marching cubes make triangles of all widths side by side.
#[test]
fn narrow_triangles_between_others_leave_hardly_a_crack() {
    let points = vec![Vec3::ZERO, Vec3::new(0.3, 1.0, 0.1)];
    let rod = Skeleton::new(points, vec![None, Some(0)]).and_then(|rod| rod.with_radii(vec![0.06; 2]));
    for detail in [2.0, 4.0, 8.0] {
        let mesh =
            Implicit::default().with_detail(detail).mesh(rod.as_ref().expect("sound")).expect("a surface");
        let preview = plain(100, 200).with_transparency(true).with_camera(level());
        let picture = preview.draw(&mesh).expect("a picture");
        let (mut inner, mut open) = (0, 0);
        let alpha = |x: usize, y: usize| picture.alpha()[y * 100 + x];
        for (x, y) in (3..197).flat_map(|y| (3..97).map(move |x| (x, y))) {
            let is_inner = (y - 3..=y + 3).all(|y| (x - 3..=x + 3).all(|x| alpha(x, y) > 0));
            inner += usize::from(is_inner);
            open += usize::from(is_inner && alpha(x, y) < 255);
        }
        assert!(inner > 1000 && open * 500 < inner, "{open} of {inner}");
    }
}

#[test]
fn a_transparent_picture_is_opaque_where_the_tree_is() {
    let small = plain(64, 64).with_camera(level().with_margin(0.25)).with_transparency(true);
    let picture = small.draw(&board(1.0)).expect("a picture");
    for (i, alpha) in picture.alpha().iter().enumerate() {
        let inside = [i % 64, i / 64].iter().all(|place| (16..48).contains(place));
        assert_eq!(*alpha, if inside { 255 } else { 0 });
    }
    let edge = small.with_size(61, 61).draw(&board(1.0)).expect("a picture");
    let bark = edge.pixel(30, 30).expect("inside");
    let half = edge.alpha().iter().position(|alpha| (1..255).contains(alpha)).expect("edges are smooth");
    let off = edge.pixels()[half][0].abs_diff(bark[0]);
    assert!(off < 24, "an edge has the colour of the board, not of what is behind it: {off}");

    let mut sheet = Picture::new(64, 64, [10, 20, 30]).expect("a sound size");
    sheet.blit(&picture, 0, 0);
    assert_eq!((sheet.pixel(0, 0), sheet.pixel(32, 32)), (Some([10, 20, 30]), picture.pixel(32, 32)));
    let shadow = plain(64, 64).with_ground(true).with_transparency(true);
    let shadow =
        shadow.with_camera(Camera::default().with_elevation(0.5)).draw(&pole(0.1)).expect("a picture");
    let dark = shadow.pixels().iter().zip(shadow.alpha());
    assert!(dark.filter(|(color, alpha)| **color == [0; 3] && (20..230).contains(*alpha)).count() > 20);
}

#[test]
fn a_turntable_turns_in_its_place() {
    let (mesh, instances) = (board(1.0), boards());
    let parts = [Part::new(&mesh).with_material(Material::leaf()).with_instances(&instances)];
    let preview = Preview::default().with_size(60, 60);
    let pictures: Vec<_> = preview.turntable(&parts, 4).collect::<Result<_, _>>().expect("four pictures");
    assert_eq!(pictures.len(), 4);
    assert!(pictures.windows(2).all(|pair| pair[0] != pair[1]));
    let mut file = Vec::new();
    Picture::write_animation(&pictures, 100, &mut file).expect("memory takes everything");
    let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().expect("a PNG");
    assert_eq!(reader.info().animation_control().map(|control| control.num_frames), Some(4));
    for picture in &pictures {
        let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut pixels).expect("a frame");
        assert_eq!(pixels, picture.pixels().as_flattened());
    }
    let other = Picture::new(5, 5, [0; 3]).expect("a sound size");
    for wrong in [&[][..], &[pictures[0].clone(), other]] {
        assert!(matches!(Picture::write_animation(wrong, 1, &mut file), Err(PreviewError::Parameter(_))));
    }
    assert!(matches!(Picture::write_animation(&pictures, 1, &mut [0u8; 50][..]), Err(PreviewError::Io(_))));
}

#[test]
fn the_same_input_gives_the_same_picture() {
    let draw = || Preview::default().with_size(80, 60).draw(&pole(0.02)).expect("a picture");
    assert_eq!(draw(), draw());
}

#[test]
fn faults_are_named() {
    let small = plain(16, 16);
    assert!(matches!(small.draw(&Mesh::default()), Err(PreviewError::EmptyMesh)));
    assert!(matches!(small.draw_parts(&[]), Err(PreviewError::EmptyMesh)));
    let mut mesh = pole(0.1);
    mesh.positions[5].x = f32::NAN;
    assert!(matches!(small.draw(&mesh), Err(PreviewError::Mesh(MeshError::Position { vertex: 5, .. }))));
    mesh.positions[5].x = 1e12;
    assert!(matches!(small.draw(&mesh), Err(PreviewError::TooFar { .. })));
    mesh.positions[5].x = 0.0;
    mesh.normals[7] = Vec3::NAN;
    assert!(matches!(small.draw(&mesh), Err(PreviewError::Mesh(MeshError::Normal { vertex: 7, .. }))));
    let nan = f32::NAN;
    let wrong = [
        small.clone().with_size(0, 10),
        small.clone().with_size(u32::MAX, u32::MAX),
        small.clone().with_supersampling(0),
        small.clone().with_supersampling(9),
        small.clone().with_sun(Vec3::ZERO),
        small.clone().with_sun(Vec3::NAN),
        small.clone().with_bark(Material::bark().with_color([2.0, 0.0, 0.0])),
        small.clone().with_background([nan; 3], WHITE),
        small.clone().with_ground_color([-1.0; 3]),
        small.clone().with_ground_height(f32::INFINITY),
        small.clone().with_camera(Camera::default().with_azimuth(nan)),
        small.clone().with_camera(Camera::default().with_elevation(2.0)),
        small.clone().with_camera(Camera::default().with_margin(0.5)),
        small.clone().with_camera(level().with_projection(Projection::Perspective { field_of_view: 0.0 })),
        small.clone().with_camera(level().with_frame(Bounds { min: Vec3::ONE, max: Vec3::ZERO })),
        small.clone().with_camera(level().with_frame(Bounds { min: Vec3::ZERO, max: Vec3::splat(nan) })),
    ];
    for preview in wrong {
        assert!(matches!(preview.draw(&pole(0.1)), Err(PreviewError::Parameter(_))), "{preview:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn any_mesh_has_a_picture(
        points in prop::collection::vec(prop::array::uniform3(-1.0f32..1.0), 3..12),
        indices in prop::collection::vec(any::<prop::sample::Index>(), 3..60),
        scale in prop::sample::select(vec![0.0f32, 1e-12, 1e-3, 1.0, 1e4, 9e8]),
        azimuth in -7.0f32..7.0, elevation in -1.57f32..1.57, perspective in any::<bool>(),
        frame in prop::option::of(prop::array::uniform3(0.0f32..2.0)),
        size in (1u32..60, 1u32..60), samples in 1u32..4, two_sided in any::<bool>(),
    ) {
        let positions: Vec<_> = points.iter().map(|&p| Vec3::from_array(p) * scale).collect();
        let indices: Vec<_> = indices.iter().map(|i| i.index(points.len()) as u32).collect();
        let mesh = Mesh::new(positions, vec![Vec3::Y; points.len()], indices[..indices.len() / 3 * 3].to_vec());
        let projection =
            if perspective { Projection::Perspective { field_of_view: 1.0 } } else { Projection::Orthographic };
        let mut camera =
            Camera::default().with_azimuth(azimuth).with_elevation(elevation).with_projection(projection);
        if let Some(high) = frame {
            camera = camera.with_frame(Bounds { min: Vec3::ZERO, max: Vec3::from_array(high) });
        }
        let preview = Preview::default().with_size(size.0, size.1).with_supersampling(samples).with_camera(camera);
        let picture = preview.draw_parts(&[Part::new(&mesh).with_material(black().with_double_sided(two_sided))]);
        prop_assert_eq!(picture.map(|p| (p.width(), p.height())).ok(), Some(size));
    }
}

/// A board that stands half in the ground is cut where it meets that, seen from above; from the same board without a ground nothing is cut.
#[test]
fn the_ground_hides_what_is_below_it() {
    let frame = Bounds::new(Vec3::splat(-1.0), Vec3::splat(1.0));
    let camera = Camera::default().with_elevation(0.5).with_azimuth(0.0).with_frame(frame);
    for projection in [Projection::Orthographic, Projection::Perspective { field_of_view: 0.6 }] {
        let preview = plain(200, 200)
            .with_camera(camera.clone().with_projection(projection))
            .with_bark(black())
            .with_ground_height(0.0);
        let covered = |preview: &Preview| -> f32 {
            let picture = preview.draw(&board(0.9)).expect("a picture");
            picture.pixels().iter().filter(|pixel| pixel[0] < 40).count() as f32
        };
        let (whole, half) = (covered(&preview), covered(&preview.clone().with_ground(true)));
        assert!((half / whole - 0.5).abs() < 0.06, "{half} of {whole}");
        assert!((covered(&preview.with_ground(true).with_ground_height(-0.9)) / whole - 1.0).abs() < 0.01);
    }
}
