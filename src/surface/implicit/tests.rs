use super::field::Felt;
use super::solid::{Coverage, Part};
use super::solid_tests::polygonize;
use super::*;
use crate::math;
use crate::surface::sample::any_skeleton;
use glam::Vec3;
use proptest::prelude::*;

/// Vertices less edges plus triangles, after a check that the mesh is sound, closed, oriented and a manifold.
pub(super) fn euler(mesh: &Mesh) -> Result<i64, String> {
    mesh.check().map_err(|e| e.to_string())?;
    let mut sides: Vec<[u32; 2]> = mesh.triangles().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    sides.sort_unstable();
    if let Some([side, ..]) = sides.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(format!("two triangles have the side {side:?}"));
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

pub(super) fn volume(mesh: &Mesh) -> f64 {
    let corners = mesh.triangles().map(|t| t.map(|index| mesh.positions[index as usize].as_dvec3()));
    corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

fn silent() -> Watch<'static> {
    Watch::silent()
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
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn forks_are_closed(radius in 0.004f32..0.1, angle in 0.3f32..2.8, detail in 1.0f32..4.0) {
        let mesh = Implicit::default().with_detail(detail).mesh(&fork(radius, angle)).expect("a surface");
        prop_assert_eq!(euler(&mesh), Ok(2));
    }

    #[test]
    fn forks_of_longer_triangles_are_closed_and_near(
        radius in 0.004f32..0.1, angle in 0.3f32..2.8, detail in 1.0f32..6.0, error in 0.02f32..0.25,
    ) {
        let (skeleton, plain) = (fork(radius, angle), Implicit::default().with_detail(detail));
        let mesh = plain.clone().with_error(error).mesh(&skeleton).expect("a surface");
        prop_assert_eq!(euler(&mesh), Ok(2));
        let all = plain.mesh(&skeleton).expect("a surface");
        prop_assert!(mesh.positions.len() < all.positions.len());
        let mut left = all.positions.iter().zip(&all.normals);
        prop_assert!(mesh.positions.iter().zip(&mesh.normals).all(|vertex| left.any(|v| v == vertex)));
    }

    #[test]
    fn any_skeleton_has_a_closed_mesh_or_a_named_error(skeleton in any_skeleton(40, 3.0, |scale, part| scale * math::powf(10.0, -2.5 * part)), blend in 0.01f32..2.0, error in 0.0f32..0.25) {
        match Implicit::default()
            .with_most_blocks(3000).with_blend(blend).with_error(error).mesh(&skeleton) {
            Ok(mesh) => { prop_assert!(euler(&mesh).map_err(TestCaseError::fail)? % 2 == 0); }
            Err(error) => prop_assert!(matches!(error,
                SurfaceError::NoRadii { .. } | SurfaceError::TooManyBlocks { .. }), "{error}"),
        }
    }
}

#[test]
fn a_straight_branch_has_its_cylinders_volume() {
    // Bent neither along the lattice nor across it.
    let way = Vec3::new(0.3, 1.0, 0.2).normalize();
    let mesh = Implicit::default()
        .with_detail(8.0)
        .mesh(&chain(&[Vec3::ZERO, way * 0.4, way], 0.1))
        .expect("a surface");
    assert_eq!(euler(&mesh), Ok(2));
    // A cylinder of 1 m and a ball.
    let whole = std::f64::consts::PI * (0.01 + 4.0 / 3.0 * 0.001);
    assert!((volume(&mesh) / whole - 1.0).abs() < 0.01, "{} of {whole}", volume(&mesh));
}

/// Blending adds no more than the blend width around.
#[test]
fn a_fork_has_the_volume_of_its_branches_and_what_blending_adds() {
    let volume_at = |blend: f32| {
        volume(
            &Implicit::default()
                .with_detail(8.0)
                .with_blend(blend)
                .mesh(&fork(0.05, 1.2))
                .expect("a surface"),
        )
    };
    // Trunk, and the branch where it is outside of it: its axis comes out after 0.1 / sin 1.2.
    let trunk = std::f64::consts::PI * (0.01 * 2.0 + 4.0 / 3.0 * 0.001);
    let branch = std::f64::consts::PI
        * (0.0025 * (1.0 - 0.1 / f64::from(math::sin(1.2))) + 2.0 / 3.0 * 0.05f64.powi(3));
    let (sharp, round, wide) = (volume_at(0.01), volume_at(0.5), volume_at(1.5));
    assert!((sharp / (trunk + branch) - 1.0).abs() < 0.01, "{sharp} of {}", trunk + branch);
    assert!(round > sharp && round < sharp * 1.02, "{round} {sharp}");
    assert!(wide > round && wide < sharp * 1.15, "{wide} {sharp}");
}

/// All of a field.
fn whole(field: &Field) -> Felt<'_> {
    match field.part(None, field.bounds()) {
        Coverage::Crossed(part) => part,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_gradient_is_the_differences_and_the_normals() {
    let skeleton = fork(0.06, 1.0);
    let (field, voxel) = Implicit::default().field(&skeleton).expect("sound");
    let mesh = polygonize(&&field, voxel, 10_000, Finish::Plain).expect("a mesh");
    let all = whole(&field);
    for (&position, &normal) in mesh.positions.iter().zip(&mesh.normals) {
        let (value, slope) = all.gradient(position);
        let step = 1e-3;
        let difference = |axis: Vec3| {
            (all.value(position + axis * step) - all.value(position - axis * step)) / (2.0 * step)
        };
        let differences = Vec3::from_array(Vec3::AXES.map(difference));
        assert!(slope.distance(differences) < 0.05 * slope.length(), "{slope} {differences} at {position}");
        assert!(normal.dot(-slope.normalize()) > 0.9999);
        assert!(value.abs() / slope.length() < 0.06, "{value} at {position}");
    }
}

/// Blocks see what the whole field is, and the surface passes nowhere else.
#[test]
fn blocks_are_as_dense_as_the_whole_field() {
    let (field, voxel) = Implicit::default().field(&fork(0.05, 0.8)).expect("sound");
    let bricks =
        Bricks::new(&&field, &Voxels { side: voxel, per_detail: 1.0, most_blocks: 10_000 }, &silent())
            .expect("blocks");
    let all = whole(&field);
    for (number, brick) in bricks.leaves.iter().enumerate() {
        let values = bricks.sample(number);
        for cell in 0..64 {
            let offset = brick::voxel(cell).as_vec3();
            let value = all.value(bricks.middle(brick, 0) + offset * bricks.step(brick.level));
            assert_eq!(values[cell as usize].to_bits(), value.to_bits());
            assert_eq!(brick.inside >> cell & 1 == 1, value > 0.0, "{value}");
        }
    }
    let mut random = 1u32;
    let mut next = || {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        random >> 16
    };
    for _ in 0..20_000 {
        let corner = glam::IVec3::new(next() as i32 % 128, next() as i32 % 128, next() as i32 % 128);
        if let brick::Place::Empty(inside) = bricks.find(corner, 0) {
            let middle = bricks.place(corner) + 0.5 * bricks.step(0);
            assert_eq!(all.value(middle) > 0.0, inside, "{middle}");
        }
    }
}

/// Long twigs in several patches, at all sizes of voxels.
#[test]
fn longer_triangles_are_few_and_near() {
    let mut points = vec![Vec3::ZERO, Vec3::Y * 3.0];
    for i in 0..40 {
        let (sin, cos) = math::sin_cos(i as f32);
        points.push(Vec3::new(cos, 3.5 + i as f32 * 0.05, sin));
    }
    let parents = (0..points.len()).map(|i| if i == 0 { None } else { Some(u32::from(i > 1)) }).collect();
    let radii = (0..points.len()).map(|i| if i < 2 { 0.1 } else { 0.004 + i as f32 * 1e-4 }).collect();
    let skeleton = Skeleton::new(points, parents).and_then(|s| s.with_radii(radii)).expect("sound");
    let surface = Implicit::default().with_detail(1.5);
    let (field, voxel) = surface.field(&skeleton).expect("sound");
    let [plain, mesh] =
        [0.0, 0.1].map(|error| surface.clone().with_error(error).mesh(&skeleton).expect("a surface"));
    let voxels = Voxels { side: voxel, per_detail: 1.0, most_blocks: 1_000_000 };
    assert!(Bricks::new(&&field, &voxels, &silent()).expect("blocks").leaves.len() > 3 * march::PATCH);
    assert_eq!(euler(&mesh), euler(&plain));
    assert!(
        mesh.positions.len() * 3 < plain.positions.len(),
        "{} {}",
        mesh.positions.len(),
        plain.positions.len()
    );
    // Middles of triangles: in voxels as fine as the radius there.
    let all = whole(&field);
    let off = |mesh: &Mesh| {
        let middles =
            mesh.triangles().map(|t| t.map(|i| mesh.positions[i as usize]).iter().sum::<Vec3>() / 3.0);
        let mut off: Vec<f32> = middles
            .map(|middle| {
                let (value, slope) = all.gradient(middle);
                value.abs() / slope.length()
            })
            .collect();
        off.sort_by(f32::total_cmp);
        [off[off.len() / 2], off[off.len() * 99 / 100], off[off.len() - 1]].map(|off| off / voxel)
    };
    let ([_, most_of, worst], [_, most_of_plain, worst_of_plain]) = (off(&mesh), off(&plain));
    assert!(most_of < most_of_plain + 0.05, "{most_of} {most_of_plain}");
    assert!(worst < worst_of_plain * 1.1, "{worst} {worst_of_plain}");
}

#[test]
fn a_thousand_children_and_turning_back_are_no_trouble() {
    let mut points = vec![Vec3::ZERO, Vec3::Y];
    let mut parents = vec![None, Some(0)];
    for i in 0..1000 {
        let (sin, cos) = math::sin_cos(i as f32);
        points.push(Vec3::new(cos, 1.0 + i as f32 * 1e-3, sin));
        parents.push(Some(1));
    }
    let nodes = points.len();
    let skeleton =
        Skeleton::new(points, parents).and_then(|s| s.with_radii(vec![0.03; nodes])).expect("sound");
    let mesh = Implicit::default().mesh(&skeleton).expect("a surface");
    assert!(euler(&mesh).expect("closed") % 2 == 0);
    let back = chain(&[Vec3::ZERO, Vec3::Y, Vec3::Y, Vec3::Y * 0.5, Vec3::Y * 1.5], 0.1);
    assert_eq!(euler(&Implicit::default().mesh(&back).expect("a surface")), Ok(2));
}

#[test]
fn twigs_thinner_than_a_voxel_are_thickened() {
    let twig = chain(&[Vec3::ZERO, Vec3::new(0.5, 1.0, 0.3)], 1e-6);
    let mesh = Implicit::default().with_voxel(0.05).mesh(&twig).expect("a surface");
    assert_eq!(euler(&mesh), Ok(2));
    assert!(mesh.positions.iter().all(|p| p.x > -0.06 && p.y < 1.06));
}

#[test]
fn faults_are_named() {
    let pole = chain(&[Vec3::ZERO, Vec3::Y], 0.1);
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-6] {
        assert!(
            matches!(Implicit::default().with_voxel(bad).mesh(&pole), Err(SurfaceError::Parameter(_))),
            "{bad}"
        );
    }
    for bad in [-1.0, f32::NAN, f32::INFINITY, 65.0] {
        assert!(matches!(Implicit::default().with_error(bad).mesh(&pole), Err(SurfaceError::Parameter(_))));
    }
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY, 65.0] {
        assert!(matches!(Implicit::default().with_detail(bad).mesh(&pole), Err(SurfaceError::Parameter(_))));
        assert!(matches!(Implicit::default().with_blend(bad).mesh(&pole), Err(SurfaceError::Parameter(_))));
    }
    let few = Implicit::default().with_most_blocks(10).with_voxel(0.001).with_detail(64.0);
    assert!(matches!(few.mesh(&pole), Err(SurfaceError::TooManyBlocks { most: 10, .. })));
    // Nothing but empty cubes around what is thin beside what is thick: fuzzing found it to go on for minutes.
    let tiny = Vec3::splat(1e-20);
    let far = Vec3::new(f32::EPSILON, std::f32::consts::PI, 0.984_375);
    let near = Vec3::new(0.984_375, f32::EPSILON, 1e-20);
    let places = vec![far, Vec3::Z * f32::EPSILON, near, tiny, tiny];
    let parents = vec![None, Some(0), Some(1), Some(2), Some(3)];
    let uneven = Skeleton::new(places, parents)
        .and_then(|tree| tree.with_radii(vec![1e-20, 1.671_875, 1e3, 0.0, 0.0]));
    let error = Implicit::default().with_most_blocks(200).mesh(&uneven.expect("a tree"));
    assert!(matches!(error, Err(SurfaceError::TooManyBlocks { most: 200, .. })));
    let bare = chain(&[Vec3::ZERO, Vec3::Y], 0.0);
    assert_eq!(Implicit::default().mesh(&bare), Err(SurfaceError::NoRadii { nodes: 2 }));
    let far = chain(&[Vec3::ZERO, Vec3::X * 1e20], 0.1);
    assert!(matches!(Implicit::default().mesh(&far), Err(SurfaceError::TooFar { node: 1, .. })));
}
