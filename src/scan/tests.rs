use glam::Vec3;

use super::*;
use crate::Skeleton;
use crate::surface::{Instance, Mesh, Tubes};

/// A pole 2 m high and 0.1 m thick, with a twig to +X.
fn tree() -> Skeleton {
    let nodes = vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(0.6, 1.2, 0.0)];
    let tree = Skeleton::new(nodes, vec![None, Some(0), Some(1), Some(1)]);
    tree.and_then(|tree| tree.with_radii(vec![0.1, 0.1, 0.1, 0.02])).expect("a tree")
}

fn bark() -> Mesh {
    Tubes::default().with_sides(48).with_root_flare(0.0).with_wind(true).mesh(&tree()).expect("a mesh")
}

fn sheet() -> Mesh {
    let corners = vec![Vec3::new(0.0, -1.0, -1.0), Vec3::new(0.0, -1.0, 1.0), Vec3::new(0.0, 1.0, 0.0)];
    Mesh::new(corners, vec![Vec3::X; 3], vec![0, 1, 2])
}

#[test]
fn points_lie_on_what_the_truth_says() {
    let bark = bark();
    let leaf = Mesh::new(vec![Vec3::ZERO, Vec3::X * 0.1, Vec3::Z * 0.1], vec![Vec3::Y; 3], vec![0, 1, 2]);
    let at = [Instance { position: Vec3::new(0.6, 1.2, 0.0), node: 3, ..Instance::IDENTITY }];
    let parts = [Part::new(&bark), Part::new(&leaf).with_instances(&at)];
    let scanner = Scanner::around(Vec3::Y * 1.7, 6.0, 3).with_step(0.002).with_noise(0.0).with_ground(0.0);
    let scan = scanner.scan(&parts, 1).expect("a scan");
    assert_eq!(scan.cloud.len(), scan.truth.len());
    let mut seen = [0; 4];
    for (&point, truth) in scan.cloud.points().iter().zip(&scan.truth).filter(|(_, truth)| !truth.is_mixed) {
        match truth.part {
            Truth::GROUND => assert!(point.y.abs() < 5e-3, "{point}"),
            1 => {
                seen[3] += 1;
                assert_eq!(truth.node, 3);
                assert!(point.distance(at[0].position) < 0.16);
            }
            _ => {
                seen[truth.place as usize] += 1;
                let trunk = point.with_y(0.0).length();
                // The mesh is inscribed; a beam at a rim has the mean of its ranges.
                let fits = truth.node > 2 || (trunk - 0.1).abs() < 0.012 || point.y > 1.99;
                assert!(fits, "{point} {truth:?}");
            }
        }
    }
    assert!(seen[..3].iter().all(|&count| count > 200) && seen[3] > 3, "{seen:?}");
}

#[test]
fn what_is_behind_is_hidden_and_edges_are_mixed() {
    let sheet = sheet();
    let (near, far) = (Part::new(&sheet), Part::new(&sheet).at(Vec3::X * -0.03, glam::Quat::IDENTITY, 1.5));
    let scanner = Scanner::new(vec![Vec3::X * 5.0]).with_step(0.004).with_beam(0.01, 0.004).with_noise(0.0);
    let scan = scanner.scan(&[near, far], 1).expect("a scan");
    let mixed = scan.truth.iter().filter(|truth| truth.is_mixed).count();
    assert!(mixed > 20, "{mixed}");
    for (point, truth) in scan.cloud.points().iter().zip(&scan.truth) {
        // At a rim, the mean range is that of rays beside the middle one.
        let slack = if truth.share < 1.0 { 0.01 } else { 1e-3 };
        let own = [0.0, -0.03][truth.part as usize];
        let fits =
            if truth.is_mixed { (-0.04..=0.01).contains(&point.x) } else { (point.x - own).abs() < slack };
        assert!(fits, "{point} {truth:?}");
        // Behind the near sheet nothing is seen.
        let hidden = truth.part == 1 && point.y.abs() < 0.3 && point.z.abs() < 0.1;
        assert!(!hidden, "{point}");
    }
    // Farther apart than the separation they are two echoes.
    let far = Part::new(&sheet).at(Vec3::X * -1.0, glam::Quat::IDENTITY, 2.0);
    let single = scanner.scan(&[near, far], 1).expect("a scan");
    let double = scanner.with_echoes(2).scan(&[near, far], 1).expect("a scan");
    assert!(double.cloud.len() > single.cloud.len() && double.truth.iter().all(|truth| !truth.is_mixed));
}

#[test]
fn noise_is_as_wide_as_it_says_and_seeded() {
    let sheet = sheet();
    let part = [Part::new(&sheet)];
    let scanner = Scanner::new(vec![Vec3::X * 3.0]).with_step(0.002).with_beam(0.0, 0.0).with_noise(0.01);
    let scan = scanner.scan(&part, 3).expect("a scan");
    let range = |point: &Vec3| {
        f64::from(
            (*point - Vec3::X * 3.0).length() - 3.0 * (*point - Vec3::X * 3.0).length() / (3.0 - point.x),
        )
    };
    let n = scan.cloud.len() as f64;
    assert!(n > 10_000.0);
    let squares: f64 = scan.cloud.points().iter().map(|point| range(point).powi(2)).sum();
    assert!(((squares / n).sqrt() - 0.01).abs() < 3e-4, "{}", (squares / n).sqrt());
    assert_eq!(scanner.scan(&part, 3).expect("a scan"), scan);
    assert_ne!(scanner.scan(&part, 4).expect("a scan").cloud, scan.cloud);
}

#[test]
fn bad_options_are_named() {
    let sheet = sheet();
    let part = [Part::new(&sheet)];
    let good = || Scanner::new(vec![Vec3::X * 3.0]).with_step(0.05);
    for (scanner, name) in [
        (Scanner::new(vec![]), "places"),
        (Scanner::new(vec![Vec3::NAN]), "places"),
        (good().with_step(0.0), "step"),
        (good().with_step(f32::NAN), "step"),
        (good().with_beam(-1.0, 0.0), "exit"),
        (good().with_beam(0.0, 2.0), "divergence"),
        (good().with_noise(-0.1), "noise"),
        (good().with_separation(f32::INFINITY), "separation"),
        (good().with_echoes(0), "echoes"),
        (good().with_range(0.0), "range"),
        (good().with_ground(f32::NAN), "ground"),
    ] {
        let error = scanner.scan(&part, 0).map(|scan| scan.cloud.len()).expect_err(name).to_string();
        assert!(error.contains(name), "{error}");
    }
    assert!(good().scan(&[], 0).expect("nothing").cloud.is_empty());
    let broken = Mesh::new(vec![Vec3::NAN; 3], vec![Vec3::X; 3], vec![0, 1, 2]);
    assert!(good().scan(&[Part::new(&broken)], 0).is_err());
    // Within the scene, above it and below it.
    for place in [Vec3::X * 0.01, Vec3::Y * 4.0, Vec3::Y * -4.0, Vec3::ZERO] {
        assert!(Scanner::new(vec![place]).with_step(0.01).scan(&part, 0).is_ok());
    }
}
