use super::*;
use crate::surface::sample::any_skeleton;
use glam::{Vec2, Vec3};
use proptest::prelude::*;
use std::f32::consts::TAU;

fn chain(points: &[Vec3], radius: f32) -> Skeleton {
    let parents = (0..points.len() as u32).map(|i| i.checked_sub(1)).collect();
    let skeleton = Skeleton::new(points.to_vec(), parents).expect("a chain is a skeleton");
    skeleton.with_radii(vec![radius; points.len()]).expect("radii are sound")
}

/// Tubes as the skeleton has them, with nothing added.
fn plain() -> Tubes {
    Tubes::default().with_root_flare(0.0).with_collars(false).with_turn(4.0).with_sides(6)
}

fn mesh_with(tubes: &Tubes, skeleton: &Skeleton) -> Mesh {
    let mesh = tubes.mesh(skeleton).expect("the skeleton has a surface");
    mesh.check().expect("the mesh is sound");
    assert_eq!((mesh.uvs.len(), mesh.tangents.len()), (mesh.positions.len(), mesh.positions.len()));
    mesh
}

fn mesh_of(skeleton: &Skeleton) -> Mesh {
    mesh_with(&plain(), skeleton)
}

/// A trunk of radius 0.1 along +Y, and a branch of radius `radius` that leaves it at 1 m at `angle` radians from +Y.
fn fork(radius: f32, angle: f32) -> Skeleton {
    let (sin, cos) = math::sin_cos(angle);
    let mut points: Vec<_> = (0..8).map(|i| Vec3::Y * (i as f32 * 0.25)).collect();
    let mut parents: Vec<_> = (0..8u32).map(|i| i.checked_sub(1)).collect();
    for i in 1..5u32 {
        points.push(Vec3::Y + Vec3::new(sin, cos, 0.0) * (i as f32 * 0.2));
        parents.push(Some(if i == 1 { 4 } else { 6 + i }));
    }
    let radii = (0..12).map(|node| if node < 8 { 0.1 } else { radius }).collect();
    Skeleton::new(points, parents).and_then(|s| s.with_radii(radii)).expect("sound")
}

fn corners(mesh: &Mesh, triangle: [u32; 3]) -> [Vec3; 3] {
    triangle.map(|index| mesh.positions[index as usize])
}

#[test]
fn a_straight_tube_faces_outward() {
    let points: Vec<_> = (0..5).map(|i| Vec3::Y * i as f32).collect();
    let mesh = mesh_of(&chain(&points, 0.1));
    assert_eq!(mesh.positions.len(), 5 * 7 + 1);
    assert_eq!(mesh.triangles().len(), 4 * 12 + 6);
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals).take(5 * 7) {
        let radial = position.with_y(0.0);
        assert!((radial.length() - 0.1).abs() < 1e-6);
        assert!(normal.abs_diff_eq(radial / 0.1, 1e-5), "{normal} at {position}");
    }
    for [a, b, c] in mesh.triangles().map(|t| t.map(|index| mesh.positions[index as usize])) {
        let (facing, middle) = ((b - a).cross(c - a), (a + b + c) / 3.0);
        assert!(facing.dot(middle - Vec3::Y * middle.y.min(4.0)) > 0.0);
    }
}

#[test]
fn radii_are_the_skeletons() {
    let points: Vec<_> = (0..4).map(|i| Vec3::new(0.0, i as f32, 0.0)).collect();
    let radii = [0.4, 0.3, 0.2, 0.0];
    let skeleton = chain(&points, 1.0).with_radii(radii.to_vec()).expect("sound");
    let mesh = mesh_of(&skeleton);
    assert_eq!(mesh.positions.len(), 3 * 7 + 1, "a tip of radius zero is one vertex");
    for position in &mesh.positions {
        let node = position.y.round() as usize;
        assert!((position.with_y(0.0).length() - radii[node]).abs() < 1e-6);
    }
    assert!(mesh.normals[10].y > 0.05, "the normals of a cone lean towards its tip");
}

#[test]
fn a_branch_starts_at_its_parent_node_with_its_own_radius() {
    let y = |y: f32| Vec3::new(0.0, y, 0.0);
    let twig = Skeleton::new(
        vec![y(0.0), y(1.0), y(2.0), y(3.0), Vec3::new(1.0, 1.0, 0.0)],
        vec![None, Some(0), Some(1), Some(2), Some(1)],
    );
    let radii = vec![0.5, 0.4, 0.3, 0.2, 0.05];
    let mesh = mesh_of(&twig.and_then(|twig| twig.with_radii(radii)).expect("sound"));
    let trunk = 4 * 7 + 1;
    let sides = 4;
    for position in &mesh.positions[trunk..=trunk + sides] {
        assert!(((*position - y(1.0)).length() - 0.05).abs() < 1e-6);
    }
}

#[test]
fn a_closed_base_closes_the_body() {
    let skeleton = chain(&[Vec3::ZERO, Vec3::Y, Vec3::new(0.5, 2.0, 0.3)], 0.2);
    let mesh = mesh_with(&Tubes::default().with_closed_base(true).with_root_flare(0.0), &skeleton);
    // The divergence theorem: the volume is the same wherever it is seen from, if and only if nothing is open.
    let volume = |eye: Vec3| -> f32 {
        let corners = mesh.triangles().map(|t| t.map(|index| mesh.positions[index as usize] - eye));
        corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    };
    assert!(volume(Vec3::ZERO) > 0.2 && volume(Vec3::ZERO) < 0.3);
    assert!((volume(Vec3::ZERO) - volume(Vec3::new(3.0, -2.0, 5.0))).abs() < 1e-4);
}

#[test]
fn a_root_alone_and_a_heap_of_nodes_are_empty() {
    assert!(mesh_of(&chain(&[Vec3::ONE], 0.1)).is_empty());
    assert!(mesh_of(&chain(&[Vec3::ONE; 5], 0.1)).is_empty());
}

#[test]
fn faults_are_named() {
    let skeleton = chain(&[Vec3::ZERO, Vec3::Y], 0.0);
    assert_eq!(Tubes::default().mesh(&skeleton), Err(SurfaceError::NoRadii { nodes: 2 }));
    let far = chain(&[Vec3::ZERO, Vec3::X * 1e20], 0.1);
    assert!(matches!(Tubes::default().mesh(&far), Err(SurfaceError::TooFar { node: 1, .. })));
    for tubes in [Tubes::default().with_sides(2), Tubes::default().with_least_sides(5000)] {
        assert!(matches!(tubes.mesh(&skeleton), Err(SurfaceError::Parameter(_))));
    }
}

#[test]
fn a_thousand_children_at_one_node() {
    let mut points = vec![Vec3::ZERO, Vec3::Y];
    let mut parents = vec![None, Some(0)];
    for i in 0..1000 {
        let (sin, cos) = math::sin_cos(i as f32);
        points.push(Vec3::new(cos, 1.0 + i as f32 * 1e-3, sin));
        parents.push(Some(1));
    }
    let nodes = points.len();
    let skeleton =
        Skeleton::new(points, parents).and_then(|s| s.with_radii(vec![0.01; nodes])).expect("sound");
    assert_eq!(mesh_of(&skeleton).triangles().len(), 999 * 18 + 30);
}

#[test]
fn no_length_and_turning_back_are_no_trouble() {
    let up = Vec3::Y;
    let mesh = mesh_of(&chain(&[Vec3::ZERO, up, up, up, up * 2.0], 0.1));
    assert_eq!(mesh.triangles().len(), 2 * 12 + 6, "internodes without length are passed over");
    let back = mesh_of(&chain(&[Vec3::ZERO, up, up * 0.5, up * 1.5], 0.1));
    assert_eq!(back.triangles().len(), 3 * 18, "a tube for each way");
    for position in &back.positions {
        assert!(position.with_y(0.0).length() < 0.1 + 1e-6);
    }
}

proptest! {
    #[test]
    fn any_skeleton_has_a_sound_mesh_or_a_named_error(
        skeleton in any_skeleton(60, 4.0, |_, part| math::powf(10.0, 9.0 * part - 6.0)), sides in 3u32..20, flags in any::<[bool; 4]>(), flare in 0.0f32..3.0,
        error in -4.0f32..2.0, turn in 0.05f32..4.0,
    ) {
        let mut tubes = Tubes::default().with_sides(sides).with_closed_base(flags[0]).with_collars(flags[1])
            .with_wind(flags[2]).with_root_flare(flare).with_turn(turn);
        if flags[3] {
            tubes = tubes.with_error(math::powf(10.0, error));
        }
        match tubes.mesh(&skeleton) {
            Ok(mesh) => prop_assert_eq!(mesh.check(), Ok(())),
            Err(error) => prop_assert!(matches!(error, SurfaceError::NoRadii { .. }), "{error}"),
        }
    }

    /// In a crotch of less than a right angle the faces of parent branch and branch face each other, and the
    /// fillet between them agrees with neither.
    #[test]
    fn normals_agree_with_triangles(radius in 0.01f32..0.09, angle in 1.1f32..2.0) {
        let mesh = mesh_with(&Tubes::default(), &fork(radius, angle));
        for triangle in mesh.triangles() {
            let [a, b, c] = corners(&mesh, triangle);
            let normals = triangle.map(|index| mesh.normals[index as usize]);
            prop_assert!((b - a).cross(c - a).dot(normals.iter().sum()) > 0.0, "a normal points inward at {a}");
        }
    }

    #[test]
    fn tangents_agree_with_textures(radius in 0.01f32..0.09, angle in 0.5f32..2.6) {
        let mesh = mesh_with(&Tubes::default().with_collars(false), &fork(radius, angle));
        for triangle in mesh.triangles() {
            let [a, b, c] = corners(&mesh, triangle);
            let normals = triangle.map(|index| mesh.normals[index as usize]);
            // The apex of a tip has one texture coordinate for all around.
            let (sin, cos) = math::sin_cos(angle);
            let tips = [Vec3::Y * 1.85, Vec3::Y + Vec3::new(sin, cos, 0.0) * (0.8 + radius)];
            if [a, b, c].iter().any(|corner| tips.iter().any(|tip| corner.abs_diff_eq(*tip, 1e-5))) {
                continue;
            }
            let [ua, ub, uc] = triangle.map(|index| mesh.uvs[index as usize]);
            let (s, t) = (ub - ua, uc - ua);
            let along_u = ((b - a) * t.y - (c - a) * s.y) / s.perp_dot(t);
            let along_v = ((c - a) * s.x - (b - a) * t.x) / s.perp_dot(t);
            for (index, normal) in triangle.into_iter().zip(normals) {
                let tangent = mesh.tangents[index as usize];
                let bitangent = normal.cross(tangent.truncate()) * tangent.w;
                prop_assert!(along_u.normalize().dot(tangent.truncate()) > 0.3, "{along_u} {tangent}");
                prop_assert!(along_v.normalize().dot(bitangent) < -0.3, "{along_v} {bitangent}");
            }
        }
    }

    #[test]
    fn a_collar_starts_within_its_parent_branch_and_ends_outside(radius in 0.005f32..0.09, angle in 0.5f32..2.6) {
        let skeleton = fork(radius, angle);
        let tubes = Tubes::default().with_root_flare(0.0);
        let mesh = mesh_with(&tubes, &skeleton);
        let sides = tubes.sides_of(radius, 0.1) as usize;
        // The trunk: a ring per node, the dome and the apex.
        let branch = &mesh.positions[8 * 13 + 13 + 1..];
        let distance = |position: &Vec3| position.with_y(0.0).length();
        for (position, normal) in branch.iter().zip(&mesh.normals[8 * 13 + 13 + 1..]).take(sides) {
            prop_assert!(distance(position) < 0.1 && distance(position) > 0.06, "{position}");
            prop_assert!(normal.dot(position.with_y(0.0).normalize()) > 0.97, "{normal} at {position}");
        }
        let end = (1 + (sides / 3).clamp(1, 4)) * (sides + 1);
        for position in branch[end..].iter().take(sides) {
            prop_assert!(distance(position) > 0.1, "{position}");
        }
    }
}

#[test]
fn axes_are_smooth_and_go_through_the_nodes() {
    let points = [Vec3::ZERO, Vec3::Y, Vec3::new(1.0, 2.0, 0.0), Vec3::new(1.0, 3.0, 0.0)];
    let turn = 0.1;
    let mesh = mesh_with(&plain().with_turn(turn), &chain(&points, 0.01));
    let centers: Vec<Vec3> = mesh.positions[..mesh.positions.len() - 1]
        .chunks(7)
        .map(|ring| ring[1..].iter().sum::<Vec3>() / 6.0)
        .collect();
    for point in points {
        assert!(centers.iter().any(|center| center.abs_diff_eq(point, 1e-5)), "{point} is not on the axis");
    }
    let ways: Vec<Vec3> = centers.windows(2).map(|pair| pair[1] - pair[0]).collect();
    for pair in ways.windows(2) {
        assert!(math::angle_between(pair[0], pair[1]) < 3.0 * turn);
    }
}

#[test]
fn frames_do_not_twist() {
    // A flat curve: what stands across its plane stays so.
    let points: Vec<_> = (0..30).map(|i| Vec3::new(math::sin(i as f32 * 0.4), i as f32 * 0.2, 0.0)).collect();
    let mesh = mesh_of(&chain(&points, 0.05));
    let across: Vec<f32> = mesh.normals[..30 * 7].chunks(7).map(|ring| ring[0].z).collect();
    assert!(across.iter().all(|z| (z - across[0]).abs() < 1e-4), "{across:?}");
}

#[test]
fn textures_count_metres_along_and_whole_tiles_around() {
    let skeleton = fork(0.03, 1.0);
    let mesh = mesh_with(&plain().with_tile(0.2), &skeleton);
    let trunk = &mesh.uvs[..8 * 7];
    for (node, ring) in trunk.chunks(7).enumerate() {
        assert!(ring.iter().all(|uv| (uv.y - node as f32 * 0.25 / 0.2).abs() < 1e-4));
        assert_eq!((ring[0].x, ring[6].x), (0.0, (TAU * 0.1 / 0.2).round()));
    }
    // The branch goes on where it springs, at 1 m; thinner than a tile, it shows one.
    let branch = &mesh.uvs[8 * 7 + 1..];
    assert!((branch[0].y - 5.0).abs() < 1e-4);
    assert_eq!(branch[4], Vec2::new(1.0, branch[0].y));
}

#[test]
fn the_foot_is_flared_and_level() {
    let mesh = mesh_with(
        &Tubes::default().with_root_flare(0.8),
        &chain(&[Vec3::ZERO, Vec3::new(0.3, 1.0, 0.0)], 0.1),
    );
    for position in &mesh.positions[..13] {
        assert!(position.y.abs() < 1e-6 && (position.length() - 0.18).abs() < 1e-6, "{position}");
    }
    let top = Vec3::new(0.3, 1.0, 0.0);
    assert!(mesh.positions.iter().all(|p| p.distance(top) > 0.3 || p.distance(top) < 0.32 + 0.1));
}

#[test]
fn wind_tells_branches_apart_and_leaves_the_ground() {
    let skeleton = fork(0.03, 1.0);
    let mesh = mesh_with(&Tubes::default().with_wind(true).with_root_flare(0.0), &skeleton);
    assert_eq!(mesh.wind.len(), mesh.positions.len());
    let trunk = mesh.wind.iter().take_while(|wind| wind.axes == [Vec3::ZERO; 2]).count();
    assert!(mesh.wind[..trunk].iter().all(|wind| wind.moments[1..] == [Vec3::ZERO; 2]));
    assert!(trunk < mesh.wind.len());
    for (wind, position) in mesh.wind.iter().zip(&mesh.positions) {
        assert_eq!((wind.flutter, wind.axes[1], wind.moments[2]), (0.0, Vec3::ZERO, Vec3::ZERO));
        assert!(position.y != 0.0 || wind.moments == [Vec3::ZERO; 3], "the ground moves");
    }
    let farthest =
        |level: usize| mesh.wind.iter().map(|wind| wind.moments[level].length()).fold(0.0, f32::max);
    assert!(farthest(0) > 0.0 && farthest(1) > 0.0);
}

#[test]
fn wind_of_internodes_without_length_is_finite() {
    // Lengths of which rounding may leave a little less than nothing, and then no length at all.
    for i in 0..200 {
        let far = Vec3::X * (100.0 + i as f32 * 0.037);
        let skeleton =
            Skeleton::new(vec![Vec3::ZERO, Vec3::Y, far, far], vec![None, Some(0), Some(0), Some(2)]);
        let skeleton = skeleton.and_then(|s| s.with_radii(vec![0.7, 0.6, 0.508 + i as f32 * 0.001, 1e-6]));
        let skeleton = skeleton.and_then(|s| s.with_orders(vec![0, 0, 1, 1])).expect("sound");
        assert_eq!(mesh_with(&Tubes::default().with_wind(true), &skeleton).check(), Ok(()));
    }
}

#[test]
fn an_error_is_kept() {
    // An arc of a circle of radius 1 m, so fine that it counts as smooth.
    let points: Vec<_> = (0..200)
        .map(|i| math::sin_cos(i as f32 * 0.01))
        .map(|(sin, cos)| Vec3::new(1.0 - cos, sin, 0.0))
        .collect();
    let mut before = usize::MAX;
    for error in [0.0005, 0.005, 0.05] {
        let mesh = mesh_with(&Tubes::default().with_root_flare(0.0).with_error(error), &chain(&points, 0.1));
        for [a, b, c] in mesh.triangles().map(|triangle| corners(&mesh, triangle)) {
            let middle = (a + b + c) / 3.0;
            // The domes at the ends are none of the arc.
            if middle.y > 0.0 && math::atan2(middle.y, 1.0 - middle.x) < 1.98 {
                let off = Vec2::new(middle.with_z(0.0).distance(Vec3::X) - 1.0, middle.z).length() - 0.1;
                assert!(off.abs() <= 2.0 * error, "{middle} is {off} m off");
            }
        }
        assert!(mesh.triangles().len() < before);
        before = mesh.triangles().len();
    }
}

#[test]
fn square_tiles_are_square_at_every_radius() {
    let points: Vec<_> = (0..60).map(|i| Vec3::new(0.0, 0.05 * i as f32, 0.0)).collect();
    for (from, to, tile) in [(0.3, 0.02, 0.25), (0.02, 0.004, 0.5), (0.2, 0.2, 0.2)] {
        let radius = |i: usize| from + (to - from) * i as f32 / 59.0;
        let skeleton = chain(&points, 0.1).with_radii((0..60).map(radius).collect()).expect("sound");
        let tubes = plain().with_tile(tile).with_sides(64).with_least_sides(64);
        let worst = |tubes: &Tubes| {
            let mesh = mesh_with(tubes, &skeleton);
            let rings: Vec<_> = (0..60).map(|ring| ring * 65).collect();
            let mut worst = 1.0f32;
            for pair in rings.windows(2) {
                let [below, above] = [pair[0], pair[1]];
                let around = mesh.uvs[below + 64].x - mesh.uvs[below].x;
                assert!(around >= 1.0 && (around - around.round()).abs() < 1e-6, "{around} tiles around");
                assert!(mesh.uvs[above].y > mesh.uvs[below].y, "v runs on");
                let thick =
                    0.5 * (mesh.positions[below].with_y(0.0) + mesh.positions[above].with_y(0.0)).length();
                let wide = TAU * thick / around;
                let long = mesh.positions[below].distance(mesh.positions[above])
                    / (mesh.uvs[above].y - mesh.uvs[below].y);
                worst = worst.max(wide / long).max(long / wide);
            }
            worst
        };
        let square = worst(&tubes.clone().with_square_tiles(true));
        assert!(square < 1.05, "{square}");
        assert!((from - to).abs() < 1e-6 || worst(&tubes) > 2.0, "by default they are drawn out");
    }
}

#[test]
fn square_tiles_change_nothing_but_v() {
    let skeleton = fork(0.03, 1.0);
    let tubes = Tubes::default().with_closed_base(true);
    let (plain, square) =
        (mesh_with(&tubes, &skeleton), mesh_with(&tubes.clone().with_square_tiles(true), &skeleton));
    assert_eq!((&plain.positions, &plain.indices), (&square.positions, &square.indices));
    assert!(plain.uvs.iter().zip(&square.uvs).all(|(a, b)| (a.x - b.x).abs() < 1e-9));
    assert!(plain.uvs != square.uvs);
}

/// Limbs made up for what is left out by up to the error, and looked like cactus arms at 0.26 m.
#[test]
fn no_limb_swells() {
    for name in ["figure-17e", "figure-06c", "fine-oak"] {
        let preset = crate::presets::by_name(name).expect("a preset").guided().unwrap();
        let tree = preset.synth(3000).synthesize(1).expect("a tree").relaxed(0.5, 3).expect("sound options");
        let branches = tree.branches();
        for error in [0.001, 0.01, 0.05, 0.26, 1.0] {
            let dropped = Tubes::default().with_error(error).dropped(&tree, &branches);
            for &radius in tree.radii() {
                let widened = dropped.widened(radius);
                assert!(widened >= radius && widened <= 1.3001 * radius, "{name}: {radius} m to {widened} m");
            }
        }
    }
}

#[test]
fn tubes_keep_a_budget_and_branches_go_one_after_another() {
    for name in ["figure-17e", "figure-06c", "fine-oak"] {
        let preset = crate::presets::by_name(name).expect("a preset").guided().unwrap();
        let tree = preset.synth(3000).synthesize(1).expect("a tree").relaxed(0.5, 3).expect("sound options");
        let mut finer: Option<(f32, Vec<bool>)> = None;
        for triangles in [20_000, 5_000, 1_000, 200, 40] {
            let (level, kept) = Tubes::default()
                .within_keeping(&tree, triangles, &Watch::silent())
                .expect("room for a trunk");
            assert!(level.mesh.triangles().len() <= triangles);
            level.mesh.check().expect("a sound mesh");
            assert!(kept[0], "the trunk stays");
            if let Some((error, before)) = &finer {
                assert!(level.error >= *error);
                assert!(
                    kept.iter().zip(before).all(|(now, before)| *before || !now),
                    "{name}: a branch came back"
                );
            }
            finer = Some((level.error, kept));
        }
    }
}
