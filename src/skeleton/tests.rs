use super::*;

/// A fork of two, each with what no other node has.
fn fork() -> Skeleton {
    let places = vec![Vec3::ZERO, Vec3::Y, Vec3::new(0.5, 2.0, 0.0), Vec3::new(-0.5, 2.0, 0.0)];
    Skeleton::new(places, vec![None, Some(0), Some(1), Some(1)])
        .and_then(|tree| tree.with_radii(vec![0.4, 0.3, 0.2, 0.1]))
        .and_then(|tree| tree.with_stages(vec![0, 1, 1, 2]))
        .and_then(|tree| tree.with_orders(vec![0, 0, 0, 1]))
        .and_then(|tree| tree.with_hops(vec![0, 7, 8, 9]))
        .expect("a tree")
}

#[test]
fn what_was_set_is_read() {
    let tree = fork();
    assert_eq!((tree.len(), tree.is_empty(), tree.segments()), (4, false, 3));
    assert_eq!(tree.radii(), [0.4, 0.3, 0.2, 0.1]);
    assert_eq!((tree.stages(), tree.orders()), (&[0, 1, 1, 2][..], &[0, 0, 0, 1][..]));
    assert_eq!(tree.hops(), [0, 7, 8, 9]);
    assert_eq!([0, 1, 2, 3].map(|node| tree.parent(node)), [None, Some(0), Some(1), Some(1)]);
    assert_eq!(tree.edges().collect::<Vec<_>>(), [(1, 0), (2, 1), (3, 1)]);
    assert_eq!(tree.tips().collect::<Vec<_>>(), [2, 3]);
    let root = Skeleton::new(vec![Vec3::X], vec![None]).expect("a root");
    assert_eq!((root.len(), root.is_empty(), root.segments()), (1, false, 0));
}

#[test]
fn the_check_names_what_is_no_tree() {
    assert_eq!(fork().check(), Ok(()));
    // Nothing but this module can make these.
    let with = |change: fn(&mut Skeleton)| {
        let mut tree = fork();
        change(&mut tree);
        tree.check()
    };
    let length = |array| Err(SkeletonError::Length { array, length: 3, nodes: 4 });
    assert_eq!(with(|tree| tree.radii.truncate(3)), length("radii"));
    assert_eq!(with(|tree| tree.hops.truncate(3)), length("hops"));
    assert_eq!(with(|tree| tree.parents[2] = 2), Err(SkeletonError::ParentNotBefore { node: 2, parent: 2 }));
    let error = with(|tree| tree.positions[3].y = f32::INFINITY);
    assert!(matches!(error, Err(SkeletonError::Position { node: 3, .. })), "{error:?}");
    for radius in [-0.1, f32::NAN, f32::INFINITY] {
        let mut tree = fork();
        tree.radii[1] = radius;
        assert!(matches!(tree.check(), Err(SkeletonError::Radius { node: 1, .. })), "{radius}");
    }
}
