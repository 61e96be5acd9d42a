use super::*;

#[test]
fn figure_18() {
    let tree = Tree::grow(typical(), 1, &stages("figure-18", 2));
    let fixed = tree.ruled(1, Bend::piecewise(degrees(60.0), 0.0, 1));
    let curved = tree.ruled(1, Bend::random(degrees(30.0), degrees(120.0), degrees(6.0), 1));
    let spread = |tree: &Tree| deviation(&tree.paths(1).iter().map(Path::tilt).collect::<Vec<_>>());
    ascending("many directions", &[spread(&fixed), 13.0, 16.0, spread(&tree)]); // 11, 18
    let tortuosity = |tree: &Tree| mean(tree.paths(1).iter().map(Path::tortuosity));
    ascending("straight", &[1.0, tortuosity(&tree), 1.19, tortuosity(&curved)]); // 1.16, 1.22
}

#[test]
fn figure_19() {
    let tree = Tree::grow(typical(), 1, &stages("figure-19", 2));
    // Turn of limbs of at least 12 hops from hop 5 to their ends.
    let turn = |tree: &Tree| {
        let long = tree.paths(1).into_iter().filter(|path| path.hops() >= 12);
        mean(long.map(|path| path.tilt_at_end(5) - path.tilt_between(3, 7)))
    };
    let [straight, down] =
        [0.0, 5.0].map(|rest| tree.ruled(1, Bend::piecewise(degrees(15.0), degrees(rest), 5)));
    ascending("slightly up", &[-35.0, turn(&tree), -10.0, 0.0, turn(&straight), 20.0, turn(&down)]); // -19, 11, 36
}

#[test]
fn figure_20() {
    let base = Vec3::Y * 4.4;
    let dome = HalfEllipsoid::new(base, Vec3::new(4.6, 5.0, 4.6));
    let shell = Shell::new(dome, 0.35).about(base);
    let tree = Tree::partial("figure-20", 40_000, 1, 2);
    let filled = tree.staged(1, Stage::new(Bend::constant(degrees(3.0)), InShape::poisson_disc(dome, 90)));
    let inside = |tree: &Tree| share(&tree.paths(1), |path| shell.contains(path.end()));
    ascending("endpoints in the shell", &[inside(&filled), 0.85, 0.999, inside(&tree)]); // 0.76, 1
    let bent = tree.ruled(1, Bend::constant(degrees(12.0)));
    let ends = |tree: &Tree| mean(tree.paths(1).iter().map(|path| path.tilt_at_end(4)));
    ascending("slightly bent", &[ends(&tree), 55.0, 65.0, ends(&bent)]); // 42, 79
}
