//! Users on another glam version come and go through mint.

use treesynth::glam::Vec3;
use treesynth::mint;

#[test]
fn vectors_pass_through_mint() {
    let theirs = mint::Vector3 { x: 1.0f32, y: 2.0, z: 3.0 };
    let ours = Vec3::from(theirs);
    assert_eq!(ours, Vec3::new(1.0, 2.0, 3.0));
    let back = mint::Point3::<f32>::from(ours);
    assert_eq!([back.x, back.y, back.z].map(f32::to_bits), [1.0f32, 2.0, 3.0].map(f32::to_bits));
}
