//! Leaves on one bent twig with a fork.

use super::common::Failure;
use super::{Draw, PAPER, labelled};
use treesynth::Skeleton;
use treesynth::foliage::{Arrangement, Foliage, Leaf};
use treesynth::glam::Vec3;
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::shape::Bounds;
use treesynth::surface::{Part, Tubes};

pub(crate) const STRIPS: &[(&str, Draw)] = &[
    ("leaf-kind", |size| {
        let kinds = [
            ("ovate", Leaf::ovate()),
            ("deltoid", Leaf::deltoid()),
            ("lobed", Leaf::lobed()),
            ("pinnate", Leaf::pinnate().with_petiole(0.1)),
            ("needles", Leaf::needles()),
        ];
        kinds.into_iter().map(|(name, leaf)| draw(&foliage_of(leaf), name, size)).collect()
    }),
    ("arrangement", |size| {
        let all = [
            ("Alternate", Arrangement::Alternate),
            ("Opposite", Arrangement::Opposite),
            ("Decussate", Arrangement::Decussate),
            ("Whorled(3)", Arrangement::Whorled(3)),
            ("SPIRAL", Arrangement::SPIRAL),
        ];
        all.into_iter().map(|(name, all)| draw(&foliage().with_arrangement(all), name, size)).collect()
    }),
    ("leaf-spacing", |size| {
        over(&[0.01, 0.02, 0.03, 0.05, 0.1], size, |metres| foliage().with_spacing(metres))
    }),
    ("leaf-size", |size| over(&[0.03, 0.05, 0.07, 0.1, 0.14], size, |metres| foliage().with_size(metres))),
    ("size-at-tip", |size| over(&[0.2, 0.5, 1.0, 1.5, 2.0], size, |ratio| foliage().with_size_at_tip(ratio))),
    ("size-by-order", |size| {
        over(&[0.4, 0.7, 1.0, 1.3, 1.6], size, |ratio| foliage().with_size_by_order(ratio))
    }),
    ("size-variation", |size| {
        over(&[0.0, 0.2, 0.4, 0.6, 0.9], size, |part| foliage().with_size_variation(part))
    }),
    ("leaf-reach", |size| over(&[0.02, 0.1, 0.2, 0.3, 0.6], size, |metres| foliage().with_reach(metres))),
    ("leaf-angle", |size| {
        over(&[0.0, 30.0, 60.0, 90.0, 120.0], size, |angle| foliage().with_angle(angle.to_radians()))
    }),
    ("leaf-rise", |size| over(&[-1.5, -0.5, 0.0, 0.5, 1.5], size, |rise| foliage().with_rise(rise))),
    ("leaf-turn", |size| over(&[0.0, 0.25, 0.5, 0.75, 1.0], size, |share| foliage().with_turn(share))),
    ("leaf-disorder", |size| {
        over(&[0.0, 0.25, 0.5, 0.75, 1.0], size, |angle| foliage().with_disorder(angle))
    }),
    ("leaf-kept", |size| over(&[1.0, 0.75, 0.5, 0.25, 0.1], size, |share| foliage().with_kept(share))),
    ("tint-variation", |size| {
        over(&[0.0, 0.2, 0.4, 0.6, 0.9], size, |spread| foliage().with_tint_variation(spread))
    }),
    ("petiole", |size| {
        over(&[0.0, 0.2, 0.5, 1.0, 1.5], size, |share| foliage_of(Leaf::ovate().with_petiole(share)))
    }),
];

fn foliage() -> Foliage {
    foliage_of(Leaf::ovate().with_petiole(0.2))
}

fn foliage_of(leaf: Leaf) -> Foliage {
    Foliage::new(leaf).with_spacing(0.03).with_size(0.07).with_reach(0.5).with_thickest(0.01)
}

fn over(values: &[f32], size: u32, foliage: impl Fn(f32) -> Foliage) -> Result<Vec<Picture>, Failure> {
    values.iter().map(|&value| draw(&foliage(value), &value.to_string(), size)).collect()
}

fn draw(foliage: &Foliage, label: &str, size: u32) -> Result<Picture, Failure> {
    let twig = twig()?;
    let (bark, leaves) = (Tubes::default().with_root_flare(0.0).mesh(&twig)?, foliage.place(&twig, 2)?);
    let frame = Bounds::new(Vec3::new(-0.16, 0.02, -0.16), Vec3::new(0.3, 0.5, 0.16));
    let preview = Preview::default()
        .with_size(size, size)
        .with_background(PAPER, PAPER)
        .with_ground(false)
        .with_camera(Camera::default().with_azimuth(0.4).with_elevation(0.3).with_frame(frame));
    Ok(labelled(preview.draw_parts(&[Part::new(&bark), leaves.part()])?, label))
}

/// A twig of half a metre that leans to the right, with one side twig.
fn twig() -> Result<Skeleton, Failure> {
    let main = |i: usize| {
        let t = i as f32 / 10.0;
        Vec3::new(0.16 * t * t, 0.42 * t, 0.0)
    };
    let mut places: Vec<Vec3> = (0..=10).map(main).collect();
    let mut parents: Vec<Option<u32>> = (0..=10u32).map(|i| i.checked_sub(1)).collect();
    for i in 1..=4u32 {
        let t = i as f32;
        places.push(main(5) + Vec3::new(-0.03, 0.032, 0.012) * t);
        parents.push(Some(if i == 1 { 5 } else { 9 + i }));
    }
    let radii = (0..places.len()).map(|i| if i <= 10 { 0.006 - 0.0004 * i as f32 } else { 0.002 }).collect();
    Ok(Skeleton::new(places, parents)?.with_radii(radii)?)
}
