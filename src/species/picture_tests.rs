//! Properties of pictures of species, at every size.

use super::by_name;
use crate::asset::Likeness;
use crate::preview::{Camera, Picture, Preview};
use crate::surface::{Material, Part, Tubes};
use std::error::Error;

/// The part of a picture that is not seen through.
fn cover(picture: &Picture) -> f64 {
    let alpha = picture.alpha();
    alpha.iter().map(|&alpha| f64::from(alpha)).sum::<f64>() / (255.0 * alpha.len() as f64)
}

/// A dense crown of thin leaves covers as much of a small picture as of a large one.
#[test]
fn crowns_cover_as_much_in_pictures_of_any_size() -> Result<(), Box<dyn Error>> {
    let mut wrong = Vec::new();
    for name in ["Norway spruce", "silver birch", "English oak"] {
        let tree = by_name(name)?.request().with_height(9.0).with_day(196.0).grow()?;
        let bark = tree.bark_mesh(&Tubes::default().with_sides(6).with_least_sides(3))?;
        let wood = Part::new(&bark).with_material(Material::white());
        let parts: Vec<Part<'_>> =
            std::iter::once(wood).chain(tree.foliage().map(crate::foliage::Leaves::part)).collect();
        let of = |side: u32| -> Result<f64, Box<dyn Error>> {
            let camera = Camera::default().with_elevation(0.05);
            let preview = Preview::default().with_size(side, side).with_camera(camera).with_ground(false);
            Ok(cover(&preview.with_transparency(true).draw_parts(&parts)?))
        };
        let whole = of(1920)?;
        for side in [60, 240, 960] {
            let off = of(side)? / whole - 1.0;
            if off.abs() > 0.03 {
                wrong.push(format!("{name}: {:+.1}% of {whole:.4} at {side} pixels", 100.0 * off));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    Ok(())
}

/// A level within a budget is of the colour of the whole tree, at the size at which it is to be used.
#[test]
fn levels_keep_the_color_of_the_tree() -> Result<(), Box<dyn Error>> {
    let mut wrong = Vec::new();
    for name in ["Norway spruce", "silver birch", "English oak"] {
        let tree = by_name(name)?.request().with_height(9.0).with_day(196.0).grow()?;
        let whole = tree.levels(None, 256, &[1.0])?;
        for level in tree.levels(Some(20_000), 256, &[1.0, 0.3])? {
            let pixels = (level.pixels(tree.numbers.height) as u32).clamp(60, 240);
            let like = Likeness::of(&level.parts(), &whole[0].parts(), pixels)?;
            if like.color > 2.1 {
                wrong.push(format!("{name}: {:.1} Lab, {} triangles", like.color, level.triangles()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    Ok(())
}
