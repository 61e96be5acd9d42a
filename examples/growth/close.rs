//! A fork of the trunk, close up, as it ages: figure 7 of the paper.

use super::common::Failure;
use treesynth::glam::{Quat, Vec3};
use treesynth::growth::{Growth, TreeAtAge};
use treesynth::presets::Grown;
use treesynth::preview::{Camera, Picture, Preview, RayCaster};
use treesynth::surface::blob::Skin;
use treesynth::{Bounds, Silent, Skeleton};

/// The years after which the fork is shown.
const YEARS: [f32; 4] = [1.0, 4.0, 7.0, 10.0];

/// The skin of a tree, old enough for its year: stages count from 1.
pub(crate) fn skin(preset: &Grown, age: f32) -> Skin {
    Skin::default().with_age(age + 1.0).with_bark(preset.bark().color())
}

/// The fork of the thickest limb that is old enough, from one distance; nothing if there is none.
pub(crate) fn sheet(preset: &Grown, growth: &Growth, size: u32) -> Result<Option<Picture>, Failure> {
    let oldest = growth.at(f32::from(growth.years()))?;
    let tree = &oldest.skeleton;
    let branches = tree.branches();
    let trunk: Vec<u32> = branches.iter().next().map(|trunk| trunk.nodes().to_vec()).unwrap_or_default();
    let limbs = branches.iter().skip(1).map(|limb| [limb.nodes()[0], limb.nodes()[1]]);
    let old =
        |node: u32| f32::from(tree.stages()[node as usize]) - 1.0 + YEARS[3] <= f32::from(growth.years());
    let limbs = limbs.filter(|limb| trunk.contains(&limb[0]) && old(limb[1]));
    let radius = |node: u32| tree.radii()[node as usize];
    let Some([base, first]) = limbs.max_by(|a, b| radius(a[1]).total_cmp(&radius(b[1]))) else {
        return Ok(None);
    };
    let ids = [base, first].map(|node| oldest.ids[node as usize]);
    let sprouted = f32::from(tree.stages()[first as usize]) - 1.0;
    let last = growth.at(sprouted + YEARS[3])?;
    let reach = last.node(ids[0]).map_or(0.0, |node| last.skeleton.radii()[node]) * 5.0;
    let mut pictures = Vec::new();
    for years in YEARS {
        let age = sprouted + years;
        let stand = growth.at(age)?;
        let Some((fork, middle, way)) = cut(&stand, ids, reach)? else { return Ok(None) };
        let around = Vec3::splat(0.5 * reach);
        // Across the limb, with the sun behind the left shoulder.
        let azimuth = treesynth::math::atan2(-way.z, way.x);
        let frame = Bounds::new(middle - around, middle + around);
        let preview = Preview::default()
            .with_size(size, size)
            .with_ground(false)
            .with_camera(Camera::default().with_azimuth(azimuth).with_frame(frame))
            .with_sun(Quat::from_rotation_y(azimuth) * Vec3::new(-0.55, 0.95, 0.8));
        let bark = skin(preset, age).blob_tree(&fork)?;
        let mut picture = RayCaster::new(preview).draw(&bark, &[], &Silent)?;
        let unit = if years > 1.0 { "years" } else { "year" };
        picture.label(&format!("{years} {unit}"), 8, 8, 1 + size / 400, [70, 70, 70]);
        pictures.push(picture);
    }
    Ok(Some(Picture::sheet(&pictures, 4, 4, [255; 3])?))
}

/// What is within `reach` metres of the fork along trunk and limb; the fork's place, and which way the limb leads.
fn cut(stand: &TreeAtAge, ids: [u32; 2], reach: f32) -> Result<Option<(Skeleton, Vec3, Vec3)>, Failure> {
    let tree = &stand.skeleton;
    let [Some(base), Some(first)] = ids.map(|id| stand.node(id)) else { return Ok(None) };
    let middle = tree.positions()[base];
    let near = |&node: &u32| tree.positions()[node as usize].distance(middle) <= 2.0 * reach;
    let branches = tree.branches();
    let trunk = branches.iter().next().map(|trunk| trunk.nodes().to_vec()).unwrap_or_default();
    let limb = branches.iter().find(|branch| branch.nodes()[1..].first() == Some(&(first as u32)));
    let limb = limb.map(|limb| limb.nodes()[1..].to_vec()).unwrap_or_default();
    let trunk: Vec<u32> = trunk.into_iter().filter(near).collect();
    let limb: Vec<u32> = limb.into_iter().take_while(near).collect();
    let Some(fork) = trunk.iter().position(|&node| node as usize == base) else { return Ok(None) };
    let parents = (0..trunk.len()).map(|i| i.checked_sub(1));
    let parents =
        parents.chain((0..limb.len()).map(|i| Some(if i == 0 { fork } else { trunk.len() + i - 1 })));
    let nodes: Vec<usize> = trunk.iter().chain(&limb).map(|&node| node as usize).collect();
    let way = limb.last().map_or(Vec3::X, |&tip| tree.positions()[tip as usize] - middle);
    let part = Skeleton::new(
        nodes.iter().map(|&node| tree.positions()[node]).collect(),
        parents.map(|parent| parent.map(|parent| parent as u32)).collect(),
    )?
    .with_radii(nodes.iter().map(|&node| tree.radii()[node]).collect())?
    .with_stages(nodes.iter().map(|&node| tree.stages()[node]).collect())?;
    Ok(Some((part, middle, way)))
}
