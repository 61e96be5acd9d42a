//! A tree of a species, scanned and reconstructed.

use treesynth::glam::Vec3;
use treesynth::metrics::diameter_at;
use treesynth::radius::check_radii;
use treesynth::reconstruct::Reconstruct;
use treesynth::scan::Scanner;
use treesynth::surface::{Part, Tubes};
use treesynth::{Skeleton, species};

/// Volume of what is thicker than 5 cm.
fn wood(tree: &Skeleton) -> f32 {
    let thick = tree.edges().filter(|&(node, _)| tree.radii()[node] > 0.025);
    let volume = |(node, parent): (usize, usize)| {
        std::f32::consts::PI
            * tree.radii()[node]
            * tree.radii()[node]
            * tree.positions()[node].distance(tree.positions()[parent])
    };
    thick.map(volume).sum()
}

#[test]
fn species_come_back_from_their_clouds() {
    for (name, seed) in [("ash", 2), ("London plane", 3)] {
        let request = species::by_name(name).unwrap().request();
        let truth = request.with_height(8.0).with_day(20.0).with_seed(seed).grow().unwrap().skeleton;
        let mesh = Tubes::default().with_sides(32).with_root_flare(0.0).mesh(&truth).unwrap();
        let scanner = Scanner::around(Vec3::Y * 1.7, 9.0, 3).with_step(0.0012);
        let cloud = scanner.scan(&[Part::new(&mesh)], seed).unwrap().cloud;
        let found = Reconstruct::default().reconstruct(&cloud).unwrap().skeleton;
        check_radii(&found, found.radii()).unwrap();
        let [dbh, wanted] = [&found, &truth].map(|tree| diameter_at(tree, 1.3).unwrap());
        assert!((dbh - wanted).abs() < 0.005, "{name}: {dbh} {wanted}");
        let ratio = wood(&found) / wood(&truth);
        assert!((0.88..1.12).contains(&ratio), "{name}: {ratio}");
    }
}
