//! Rays against formulas, pictures against promises.

use super::sample::{Shape, Union, one};
use super::*;
use crate::Silent;
use glam::Vec3;

#[test]
fn look() {
    let t = std::time::Instant::now();
    let tree = crate::presets::by_name("figure-18").unwrap().synth(std::env::var("NODES").map_or(150_000, |n| n.parse().unwrap())).synthesize(1).unwrap().relaxed(0.5, 3).unwrap();
    let shapes = (1..tree.len()).map(|i| {
        let p = tree.parent(i).unwrap();
        (Shape::Capsule(tree.positions()[p], tree.positions()[i], tree.radii()[i]), [0.16, 0.118, 0.088])
    });
    let solid = Union(shapes.collect());
    println!("{} capsules {:?}", solid.0.len(), t.elapsed());
    let preview = Preview::default().with_size(768, 768);
    let t = std::time::Instant::now();
    let picture = RayCaster::new(preview.clone()).cast(&solid, &[], &Silent).unwrap();
    println!("{:?}", t.elapsed());
    picture.write_png(std::fs::File::create("out/ray.png").unwrap()).unwrap();
    let t = std::time::Instant::now();
    let picture = RayCaster::new(preview.clone()).draw_implicit(&crate::surface::Implicit::default(), &tree, &[], &Silent).unwrap();
    println!("{:?}", t.elapsed());
    picture.write_png(std::fs::File::create("out/field.png").unwrap()).unwrap();
    let t = std::time::Instant::now();
    let mesh = crate::surface::Tubes::default().mesh(&tree).unwrap();
    preview.draw(&mesh).unwrap().write_png(std::fs::File::create("out/mesh.png").unwrap()).unwrap();
    println!("mesh {:?}", t.elapsed());
    let _ = one;
    let _ = Vec3::X;
}
