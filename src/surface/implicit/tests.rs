use super::*;
use crate::math;
use glam::Vec3;
use proptest::prelude::*;

/// Vertices less edges plus triangles, after a check that the mesh is sound, closed, oriented and a manifold.
fn euler(mesh: &Mesh) -> Result<i64, String> {
    mesh.check().map_err(|e| e.to_string())?;
    let mut sides: Vec<[u32; 2]> = mesh.triangles().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    sides.sort_unstable();
    if let Some(pair) = sides.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(format!("two triangles have the side {:?}", pair[0]));
    }
    if let Some(side) = sides.iter().find(|[a, b]| sides.binary_search(&[*b, *a]).is_err()) {
        return Err(format!("the side {side:?} is open"));
    }
    // Around each vertex one fan: following the sides opposite to it comes round through all of them.
    let mut opposite: Vec<[u32; 3]> =
        mesh.triangles().flat_map(|[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]]).collect();
    opposite.sort_unstable();
    let fans: Vec<_> = opposite.chunk_by(|x, y| x[0] == y[0]).collect();
    if fans.len() != mesh.positions.len() {
        return Err("a vertex is in no triangle".to_owned());
    }
    for fan in fans {
        let (mut steps, mut at) = (0, fan[0][1]);
        while steps == 0 || at != fan[0][1] {
            at = fan.iter().find(|t| t[1] == at).ok_or("a fan is open")?[2];
            steps += 1;
        }
        if steps != fan.len() {
            return Err(format!("vertex {} has several fans", fan[0][0]));
        }
    }
    Ok(mesh.positions.len() as i64 - sides.len() as i64 / 2 + mesh.triangles().len() as i64)
}

fn volume(mesh: &Mesh) -> f64 {
    let corners = mesh.triangles().map(|t| t.map(|index| mesh.positions[index as usize].as_dvec3()));
    corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

fn chain(points: &[Vec3], radius: f32) -> Skeleton {
    let parents = (0..points.len() as u32).map(|i| i.checked_sub(1)).collect();
    let skeleton = Skeleton::new(points.to_vec(), parents).expect("a chain is a skeleton");
    skeleton.with_radii(vec![radius; points.len()]).expect("radii are sound")
}

#[test]
fn a_single_node_is_a_ball() {
    let mesh = Implicit::default().with_detail(16.0).mesh(&chain(&[Vec3::ONE], 0.3)).expect("a ball");
    assert_eq!(euler(&mesh), Ok(2));
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        assert!((position.distance(Vec3::ONE) - 0.3).abs() < 0.002);
        assert!(normal.abs_diff_eq((*position - Vec3::ONE).normalize(), 1e-3));
    }
    let ball = 4.0 / 3.0 * std::f64::consts::PI * 0.027;
    assert!((volume(&mesh) / ball - 1.0).abs() < 0.01, "{}", volume(&mesh) / ball);
}

/// A trunk of radius 0.1 along +Y, and a branch of radius `radius` that leaves it at 1 m at `angle` radians from +Y.
fn fork(radius: f32, angle: f32) -> Skeleton {
    let (sin, cos) = math::sin_cos(angle);
    let tip = Vec3::Y + Vec3::new(sin, cos, 0.0);
    let points = vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, tip];
    let skeleton = Skeleton::new(points, vec![None, Some(0), Some(1), Some(1)]).expect("sound");
    let stages = vec![0, 0, 0, 1];
    skeleton.with_radii(vec![0.1, 0.1, 0.1, radius]).and_then(|s| s.with_stages(stages)).expect("sound")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn forks_are_closed(radius in 0.004f32..0.1, angle in 0.3f32..2.8, detail in 1.0f32..4.0) {
        let mesh = Implicit::default().with_detail(detail).mesh(&fork(radius, angle)).expect("a surface");
        prop_assert_eq!(euler(&mesh), Ok(2));
    }

    #[test]
    fn any_skeleton_has_a_closed_mesh_or_a_named_error(skeleton in any_skeleton(), blend in 0.01f32..2.0) {
        match Implicit::default().with_most_blocks(3000).with_blend(blend).mesh(&skeleton) {
            Ok(mesh) => { prop_assert!(euler(&mesh).map_err(|e| TestCaseError::fail(e))? % 2 == 0); }
            Err(error) => prop_assert!(matches!(error,
                SurfaceError::NoRadii { .. } | SurfaceError::TooManyBlocks { .. }), "{error}"),
        }
    }
}

prop_compose! {
    fn any_skeleton()(
        nodes in prop::collection::vec((any::<prop::sample::Index>(), -1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0,
            0.0f32..2.5, 0u8..10), 1..40),
        scale in -6.0f32..3.0,
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
            radii.push(if kind == 2 { 0.0 } else { scale * math::powf(10.0, -radius) });
        }
        Skeleton::new(points, parents).and_then(|s| s.with_radii(radii)).expect("made to be sound")
    }
}
