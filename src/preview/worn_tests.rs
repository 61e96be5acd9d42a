//! Images on surfaces.

use super::*;
use crate::math;
use crate::surface::Instance;
use crate::texture::{Image, Textures};
use glam::Vec2;

/// A board of 2 m in the plane z = 0, seen from +Z, that shows an image upright.
fn board() -> Mesh {
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let positions = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let uvs = positions.iter().map(|p| Vec2::new(0.5 + 0.5 * p.x, 0.5 - 0.5 * p.y)).collect();
    Mesh::new(positions, vec![Vec3::Z; 4], vec![0, 1, 2, 0, 2, 3]).with_uvs(uvs)
}

fn white() -> Material {
    Material::white().with_double_sided(true)
}

fn preview() -> Preview {
    let level = Camera::default().with_elevation(0.0).with_projection(Projection::Orthographic);
    let plain = Preview::default().with_size(64, 64).with_ground(false).with_camera(level.with_margin(0.25));
    plain.with_background([1.0; 3], [1.0; 3])
}

fn image(side: u32, channels: u8, texel: impl Fn(u32, u32) -> [u8; 4]) -> Image {
    let all = (0..side * side).flat_map(|i| texel(i % side, i / side).into_iter().take(channels.into()));
    Image::new(side, side, channels, all.collect()).expect("sizes are right")
}

fn flat(rgb: [u8; 3]) -> Image {
    image(1, 3, |_, _| [rgb[0], rgb[1], rgb[2], 255])
}

fn drawn(textures: &Textures) -> Picture {
    let mesh = board();
    preview()
        .draw_parts(&[Part::new(&mesh).with_material(white()).with_textures(textures)])
        .expect("a picture")
}

fn is_near(a: &Picture, b: &Picture, steps: u8) -> bool {
    let all = |picture: &Picture| picture.pixels().as_flattened().to_vec();
    all(a).into_iter().zip(all(b)).all(|(a, b)| a.abs_diff(b) <= steps)
}

#[test]
fn a_board_shows_its_image_upright() {
    let color = |x: u32, y: u32| [40 + 50 * x as u8, 40 + 50 * y as u8, 90, 255];
    let picture = drawn(&Textures::default().with_base_color(image(4, 3, color)));
    for (x, y) in [(0, 0), (3, 0), (1, 2), (3, 3)] {
        let [r, g, b, _] = color(x, y);
        let plain = preview()
            .draw_parts(&[Part::new(&board()).with_material(white().with_srgb([r, g, b]))])
            .expect("a picture");
        let place = (16 + 8 * x + 4, 16 + 8 * y + 4);
        let (seen, wanted) = (picture.pixel(place.0, place.1), plain.pixel(place.0, place.1));
        let (seen, wanted) = (seen.expect("inside"), wanted.expect("inside"));
        for channel in 0..3 {
            // The pixel is a quarter of a texel off the texel's middle.
            assert!(seen[channel].abs_diff(wanted[channel]) <= 12, "{seen:?} for {wanted:?} at {x}, {y}");
        }
    }
}

#[test]
fn one_color_is_the_same_as_a_material() {
    let worn = drawn(&Textures::default().with_base_color(flat([120, 90, 60])));
    let mesh = board();
    let plain = preview()
        .draw_parts(&[Part::new(&mesh).with_material(white().with_srgb([120, 90, 60]))])
        .expect("a picture");
    assert!(is_near(&worn, &plain, 1));
}

#[test]
fn flat_normals_change_nothing() {
    let color = || Textures::default().with_base_color(flat([120, 90, 60]));
    assert!(is_near(&drawn(&color()), &drawn(&color().with_normal(flat([128, 128, 255]))), 1));
}

#[test]
fn relief_turns_to_the_sun_or_away() {
    let brightness = |normal: [u8; 3]| {
        let textures = Textures::default().with_base_color(flat([120; 3])).with_normal(flat(normal));
        drawn(&textures).pixel(32, 32).expect("inside")[0]
    };
    // The sun stands left above.
    let level = brightness([128, 128, 255]);
    assert!(brightness([64, 128, 238]) > level + 5 && brightness([192, 128, 238]) < level - 5);
    assert!(brightness([128, 192, 238]) > level + 5 && brightness([128, 64, 238]) < level - 5);
}

#[test]
fn a_derived_tangent_is_the_given_one() {
    let relief = image(8, 3, |x, y| [(90 + 10 * x) as u8, (90 + 10 * y) as u8, 240, 255]);
    let textures = Textures::default().with_normal(relief);
    let mut mesh = board();
    let draw = |mesh: &Mesh| {
        preview().draw_parts(&[Part::new(mesh).with_material(white()).with_textures(&textures)])
    };
    let derived = draw(&mesh).expect("a picture");
    mesh.tangents = vec![Vec3::X.extend(1.0); 4];
    assert!(is_near(&derived, &draw(&mesh).expect("a picture"), 1));
}

/// The left half is there.
fn half() -> Textures {
    let color = image(16, 4, |x, _| [10, 10, 10, if x < 8 { 255 } else { 0 }]);
    Textures::default().with_base_color(color).with_alpha_cutoff(0.5)
}

#[test]
fn holes_are_holes() {
    let picture = drawn(&half());
    let [left, right] = [24, 40].map(|x| picture.pixel(x, 32).expect("inside"));
    assert!(left[0] < 60 && right == [255; 3], "{left:?} {right:?}");
    let uncut = Textures::default().with_base_color(half().base_color().expect("there is one").clone());
    assert!(drawn(&uncut).pixel(40, 32).expect("inside")[0] < 60, "without a cutoff alpha is ignored");
}

#[test]
fn shadows_have_the_same_holes() {
    let mesh = board();
    let textures = half();
    let part = [Part::new(&mesh).with_material(white()).with_textures(&textures)];
    let placed = Placed::all(&part);
    let bounds = mesh.bounds().expect("there are vertices");
    let bounds = Bounds { min: bounds.min - 1.0, max: bounds.max + 1.0 };
    let mut map = shadow::ShadowMap::new(Vec3::Z, bounds);
    for (number, corners) in placed[0].triangles().enumerate() {
        let cut = placed[0].cut(number, corners);
        let share = cut.expect("it has holes").share;
        assert!((share - 0.5).abs() < 0.3, "{share}");
        map.add(corners.map(|corner| placed[0].positions[corner as usize]), true, cut);
    }
    map.finish();
    let light = |x: f32| map.light(Vec3::new(x, 0.2, -0.5), Vec3::Z);
    assert!(light(-0.5) < 0.01 && light(0.5) > 0.99, "{} {}", light(-0.5), light(0.5));
}

#[test]
fn a_tint_multiplies() {
    let mesh = board();
    let tint = [0.5, 0.25, 1.0];
    let tinted = [Instance { tint, ..Instance::IDENTITY }];
    let color = [0.6, 0.4, 0.2];
    let draw = |part: Part<'_>| preview().draw_parts(&[part]).expect("a picture");
    let product = std::array::from_fn(|channel| color[channel] * tint[channel]);
    let plain = [Instance::IDENTITY];
    let one = draw(Part::new(&mesh).with_material(white().with_color(color)).with_instances(&tinted));
    let other = draw(Part::new(&mesh).with_material(white().with_color(product)).with_instances(&plain));
    assert_eq!(one, other);
    let textures = Textures::default().with_base_color(flat([255; 3]));
    let part = Part::new(&mesh).with_material(white().with_color(color)).with_textures(&textures);
    assert!(is_near(&draw(part.with_instances(&tinted)), &one, 1), "with an image too");
}

#[test]
fn light_from_behind_has_its_own_color() {
    let from_behind = |transmission: Option<[u8; 3]>| {
        let textures = Textures::default().with_base_color(flat([90; 3]));
        let textures = match transmission {
            Some(color) => textures.with_transmission(flat(color)),
            None => textures,
        };
        let mesh = board();
        let part = Part::new(&mesh).with_material(white()).with_textures(&textures);
        let picture = preview().with_sun(Vec3::NEG_Z).draw_parts(&[part]).expect("a picture");
        picture.pixel(32, 32).expect("inside")
    };
    let [plain, dark, green] = [None, Some([0; 3]), Some([40, 160, 20])].map(from_behind);
    assert!(
        dark[1] < plain[1] && green[1] > plain[1] && green[1] > green[0] + 40,
        "{dark:?} {plain:?} {green:?}"
    );
}

#[test]
fn what_is_far_does_not_alias() {
    let checks = image(512, 3, |x, y| if (x + y) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] });
    let grey = flat([188; 3]);
    let worn = drawn(&Textures::default().with_base_color(checks));
    assert!(is_near(&worn, &drawn(&Textures::default().with_base_color(grey)), 3));
}

#[test]
fn smooth_images_shine() {
    let shine = |roughness: u8| {
        let fine = flat([255, roughness, 0]);
        let textures =
            Textures::default().with_base_color(flat([40; 3])).with_occlusion_roughness_metallic(fine);
        let mesh = board();
        let part = Part::new(&mesh).with_material(white()).with_textures(&textures);
        let picture = preview().with_sun(Vec3::Z).draw_parts(&[part]).expect("a picture");
        picture.pixel(32, 32).expect("inside")[0]
    };
    assert!(shine(80) > shine(250) + 20, "{} {}", shine(80), shine(250));
}

#[test]
fn images_need_texture_coordinates() {
    let textures = half();
    let mut mesh = board();
    mesh.uvs.clear();
    let error =
        preview().draw_parts(&[Part::new(&mesh).with_textures(&textures)]).expect_err("no coordinates");
    assert!(matches!(error, PreviewError::Mesh(MeshError::NoUvs { vertices: 4 })));
    assert!(error.to_string().contains("has textures but no texture coordinates"), "{error}");
    let wrong = Textures::default().with_alpha_cutoff(2.0);
    let error = preview().draw_parts(&[Part::new(&board()).with_textures(&wrong)]).expect_err("out of range");
    assert!(error.to_string().starts_with("Textures.alpha_cutoff"), "{error}");
}

#[test]
fn any_coordinates_give_a_picture() {
    let textures = half().with_normal(flat([128, 128, 255])).with_transmission(flat([9, 99, 9]));
    for scale in [0.0, 1e-20, 1.0, 1e6, 1e30] {
        let mut mesh = board();
        mesh.uvs.iter_mut().enumerate().for_each(|(i, uv)| *uv = *uv * scale - i as f32 * math::sin(scale));
        let camera = Camera::default().with_elevation(0.02);
        let part = Part::new(&mesh).with_material(white()).with_textures(&textures);
        assert!(preview().with_camera(camera).draw_parts(&[part]).is_ok());
    }
}
