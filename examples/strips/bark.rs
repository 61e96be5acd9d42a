//! Bark on a trunk.

use super::common::Failure;
use super::{Draw, labelled};
use treesynth::Skeleton;
use treesynth::glam::Vec3;
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::shape::Bounds;
use treesynth::surface::{Material, Part, Tubes};
use treesynth::texture::Bark;

pub(crate) const STRIPS: &[(&str, Draw)] = &[
    ("bark-kind", |size| {
        let kinds = [
            ("oak", Bark::oak()),
            ("pine", Bark::pine()),
            ("plane", Bark::plane()),
            ("birch", Bark::birch()),
            ("beech", Bark::beech()),
        ];
        kinds.into_iter().map(|(name, bark)| draw(&bark, name, size)).collect()
    }),
    ("bark-age", |size| over(&[0.0, 0.25, 0.5, 0.75, 1.0], size, |age| Bark::oak().with_age(age))),
    ("bark-size", |size| over(&[0.25, 0.4, 0.6, 0.9, 1.3], size, |metres| Bark::oak().with_size(metres))),
    ("bark-depth", |size| {
        over(&[0.0, 0.01, 0.02, 0.04, 0.08], size, |metres| Bark::oak().with_depth(metres))
    }),
    ("bark-spread", |size| over(&[0.0, 0.5, 1.0, 1.5, 2.0], size, |spread| Bark::pine().with_spread(spread))),
    ("bark-seed", |size| over(&[0.0, 1.0, 2.0, 3.0, 4.0], size, |seed| Bark::birch().with_seed(seed as u64))),
];

const RADIUS: f32 = 0.24;

fn over(values: &[f32], size: u32, bark: impl Fn(f32) -> Bark) -> Result<Vec<Picture>, Failure> {
    values.iter().map(|&value| draw(&bark(value), &value.to_string(), size)).collect()
}

fn draw(bark: &Bark, label: &str, size: u32) -> Result<Picture, Failure> {
    let set = bark.clone().with_resolution(512).bake()?;
    let points = (0..=10).map(|i| Vec3::Y * (0.2 * i as f32)).collect();
    let parents = (0..=10u32).map(|i| i.checked_sub(1)).collect();
    let trunk = Skeleton::new(points, parents)?.with_radii(vec![RADIUS; 11])?;
    let tubes = Tubes::default().with_sides(64).with_least_sides(64).with_root_flare(0.0);
    let mesh = tubes.with_tile(set.size).with_square_tiles(true).mesh(&trunk)?;
    // So that white bark in the sun is not whiter than paper.
    let look = Material::white().with_color([0.55; 3]).with_roughness(1.0);
    let frame = Bounds::new(Vec3::new(-0.3, 0.7, -RADIUS), Vec3::new(0.3, 1.3, RADIUS));
    let camera = Camera::default().with_elevation(0.0).with_azimuth(0.0).with_frame(frame).with_margin(0.0);
    let backdrop = [0.30, 0.36, 0.42];
    let preview = Preview::default()
        .with_size(size, size)
        .with_camera(camera)
        .with_ground(false)
        .with_background(backdrop, backdrop)
        .with_sun(Vec3::new(-0.75, 0.55, 0.65));
    let part = Part::new(&mesh).with_material(look).with_textures(&set.textures);
    Ok(labelled(preview.draw_parts(&[part])?, label))
}
