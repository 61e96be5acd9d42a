use super::*;
use proptest::prelude::*;

fn chain(points: &[Vec3], radius: f32) -> Skeleton {
    let parents = (0..points.len() as u32).map(|i| i.checked_sub(1)).collect();
    let skeleton = Skeleton::new(points.to_vec(), parents).expect("a chain is a skeleton");
    skeleton.with_radii(vec![radius; points.len()]).expect("radii are sound")
}

fn mesh_of(skeleton: &Skeleton) -> Mesh {
    let mesh = Tubes::default().mesh(skeleton).expect("the skeleton has a surface");
    mesh.check().expect("the mesh is sound");
    assert_eq!(mesh.uvs.len(), mesh.positions.len());
    mesh
}

#[test]
fn a_straight_tube_faces_outward() {
    let points: Vec<_> = (0..5).map(|i| Vec3::Y * i as f32).collect();
    let mesh = mesh_of(&chain(&points, 0.1));
    assert_eq!(mesh.positions.len(), 5 * 13 + 1);
    assert_eq!(mesh.triangles().len(), 4 * 24 + 12);
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals).take(5 * 13) {
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
    assert_eq!(mesh.positions.len(), 3 * 13 + 1, "a tip of radius zero is one vertex");
    for position in &mesh.positions {
        let node = position.y.round() as usize;
        assert!((position.with_y(0.0).length() - radii[node]).abs() < 1e-6);
    }
    assert!(mesh.normals[20].y > 0.05, "the normals of a cone lean towards its tip");
}

#[test]
fn a_branch_starts_at_its_bearing_node_with_its_own_radius() {
    let y = |y: f32| Vec3::new(0.0, y, 0.0);
    let twig = Skeleton::new(
        vec![y(0.0), y(1.0), y(2.0), y(3.0), Vec3::new(1.0, 1.0, 0.0)],
        vec![None, Some(0), Some(1), Some(2), Some(1)],
    );
    let radii = vec![0.5, 0.4, 0.3, 0.2, 0.05];
    let mesh = mesh_of(&twig.and_then(|twig| twig.with_radii(radii)).expect("sound"));
    let trunk = 4 * 13 + 1;
    let sides = (12.0 * (0.05f32 / 0.5).sqrt()).ceil() as usize;
    for position in &mesh.positions[trunk..=trunk + sides] {
        assert!(((*position - y(1.0)).length() - 0.05).abs() < 1e-6);
    }
}

#[test]
fn a_closed_base_closes_the_body() {
    let skeleton = chain(&[Vec3::ZERO, Vec3::Y, Vec3::new(0.5, 2.0, 0.3)], 0.2);
    let mesh = Tubes::default().with_closed_base(true).mesh(&skeleton).expect("has a surface");
    mesh.check().expect("sound");
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
    assert_eq!(mesh_of(&skeleton).triangles().len(), 1000 * 36 + 24);
}

#[test]
fn no_length_and_turning_back_are_no_trouble() {
    let up = Vec3::Y;
    let mesh = mesh_of(&chain(&[Vec3::ZERO, up, up, up, up * 2.0], 0.1));
    assert_eq!(mesh.triangles().len(), 2 * 24 + 12, "internodes without length are passed over");
    let back = mesh_of(&chain(&[Vec3::ZERO, up, up * 0.5, up * 1.5], 0.1));
    assert_eq!(back.triangles().len(), 3 * 36, "a tube for each way");
    for position in &back.positions {
        assert!(position.with_y(0.0).length() < 0.1 + 1e-6);
    }
}

prop_compose! {
    fn any_skeleton()(
        nodes in prop::collection::vec((any::<prop::sample::Index>(), -1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0,
            -6.0f32..3.0, 0u8..10), 1..60),
        scale in -6.0f32..4.0,
    ) -> Skeleton {
        let scale = math::powf(10.0, scale);
        let mut points: Vec<Vec3> = Vec::new();
        let (mut parents, mut radii) = (Vec::new(), Vec::new());
        for (i, (parent, x, y, z, radius, kind)) in nodes.into_iter().enumerate() {
            let parent = (i > 0).then(|| if kind < 5 { i - 1 } else { parent.index(i) });
            let from = parent.map_or(Vec3::ZERO, |p| points[p]);
            points.push(match kind {
                0 => from,
                1 => points.first().copied().unwrap_or_default(),
                _ => from + Vec3::new(x, y, z) * scale,
            });
            parents.push(parent.map(|p| p as u32));
            radii.push(if kind == 2 { 0.0 } else { math::powf(10.0, radius) });
        }
        Skeleton::new(points, parents).and_then(|s| s.with_radii(radii)).expect("made to be sound")
    }
}

proptest! {
    #[test]
    fn any_skeleton_has_a_sound_mesh_or_a_named_error(
        skeleton in any_skeleton(), sides in 3u32..20, closed in any::<bool>(),
    ) {
        let tubes = Tubes::default().with_sides(sides).with_closed_base(closed);
        match tubes.mesh(&skeleton) {
            Ok(mesh) => prop_assert_eq!(mesh.check(), Ok(())),
            Err(error) => prop_assert!(matches!(error, SurfaceError::NoRadii { .. }), "{error}"),
        }
    }
}
