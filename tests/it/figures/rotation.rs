use super::*;

/// Half the crookedness of a 3D graph's paths is in its edges: 1.15 is as straight as they come.
const STRAIGHT: f32 = 1.2;

#[test]
fn figure_02() {
    let paths = |name| -> Vec<Path> {
        (1..=10).flat_map(|seed| Tree::of(name, TYPICAL_NODES, seed).paths(0)).collect()
    };
    // Area between path and chord over the chord squared, positive above it; tilt of the first quarter.
    let bulge = |path: &Path| {
        let (start, chord) = (path.start(), path.end() - path.start());
        let doubled: f32 = path.0.windows(2).map(|pair| (pair[0] - start).cross(pair[1] - start).z).sum();
        -doubled * 0.5 / chord.length_squared()
    };
    let first = |path: &Path| path.tilt_between(0, path.hops() / 4);
    let (unguided, guided) = (paths("figure-02-unguided"), paths("figure-02-guided"));
    ascending("crooked, but straight", &[-0.05, least(&unguided, bulge), most(&unguided, bulge), 0.04]);
    ascending("over", &[0.05, least(&guided, bulge)]); // 0.08
    let first = |paths: &[Path]| mean(paths.iter().map(first));
    ascending("upwards at first", &[first(&guided), 18.0, 24.0, first(&unguided)]);
}

#[test]
fn figure_03() {
    // Cosine between the vectors of neighbours, in the less coherent stage.
    let coherence = |tree: &Tree| {
        let mut search = Search::new(&tree.graph);
        let mut of_stage = |stage| {
            tree.synth().grow_stage(&mut search, stage, tree.seed, &Silent).unwrap();
            mean((0..tree.graph.nodes() as u32).flat_map(|node| {
                let vector = search.vector(node);
                let others = tree.graph.neighbours(node).iter().filter_map(|&to| search.vector(to));
                others.filter_map(|other| Some(vector?.dot(other))).collect::<Vec<_>>()
            }))
        };
        (0..tree.stages.len()).map(&mut of_stage).fold(1.0, f32::min)
    };
    let trees: Vec<Tree> = (1..=6).map(|seed| Tree::of("figure-03", TYPICAL_NODES, seed)).collect();
    for tree in &trees {
        assert_eq!(tree.growth.endpoints.iter().map(Vec::len).collect::<Vec<_>>(), [8, 45]);
        let jitter = tree.ruled(0, Jitter::new(Bend::constant(degrees(4.0)), degrees(120.0)));
        ascending("coherence", &[coherence(&jitter), 0.3, 0.9, coherence(tree)]); // 0.14, 0.96
    }
    let forks = |trees: &[Tree]| mean(trees.iter().flat_map(|tree| tree.forks(1)));
    let none = each(&trees, |tree| tree.ruled(1, Bend::none()));
    ascending("forks of the second iteration", &[forks(&none), 27.5, 30.0, forks(&trees)]); // 26, 32
}

#[test]
fn figure_05() {
    // On paths of more than 20 hops: how the tilt changes up to there, and after that.
    let left = several(6, "figure-05-left", TYPICAL_NODES, 1);
    let right = each(&left, |tree| tree.as_preset("figure-05-right"));
    let none = each(&left, |tree| tree.ruled(0, Bend::none()));
    let turn = |trees: &[Tree], from: usize, to: usize| {
        let at = |path: &Path, hop: usize| path.tilt_between(hop - 5, hop);
        let paths = paths(trees, 0).into_iter().filter(|path| path.hops() >= 28);
        mean(paths.map(|path| at(&path, to.min(path.hops())) - at(&path, from)))
    };
    let [first, last] = [(5, 20), (20, usize::MAX)]
        .map(|(from, to)| [&none, &left, &right].map(|trees| turn(trees, from, to)));
    ascending("out and down", &[first[0], 2.0, 5.0, first[1], 17.5, first[2]]); // -3, 9, 26
    ascending("then up again, straight, or on down", &[last[2], -5.0, last[0], 15.0, last[1]]); // -14, 0, 27
}

#[test]
fn figure_06() {
    let trees = ["figure-06a", "figure-06b", "figure-06c", "figure-06d"]
        .map(|name| Tree::grow(typical(), 1, &stages(name, 2)));
    let [a, b, c, d] = trees.each_ref().map(|tree| tree.paths(1));
    // All limbs; and the course of those of at least 12 hops.
    let spread = |paths: &[Path]| deviation(&paths.iter().map(Path::tilt).collect::<Vec<_>>());
    let tortuosity = |paths: &[Path]| mean(paths.iter().map(Path::tortuosity));
    let course = |paths: &[Path]| {
        let long: Vec<&Path> = paths.iter().filter(|path| path.hops() >= 12).collect();
        [(0, 5), (4, 8)]
            .map(|(from, to)| mean(long.iter().map(|path| path.tilt_between(from, to))))
            .into_iter()
            .chain([mean(long.iter().map(|path| path.tilt_at_end(5)))])
            .collect::<Vec<_>>()
    };
    let (a_course, b_course, d_course) = (course(&a), course(&b), course(&d));
    let drooping = |paths: &[Path]| share(paths, |path| path.tilt_at_end(4) > 90.0);
    ascending("a: curved downward, all the way", &[20.0, a_course[0], a_course[1], 90.0, a_course[2]]);
    ascending("a: drooping tips", &[drooping(&b), 0.1, 0.35, drooping(&a)]); // 0.03, 0.49
    ascending("b: at about 60°", &[50.0, mean(b.iter().map(Path::tilt)), 70.0]);
    ascending("b: straight", &[1.0, tortuosity(&b), STRAIGHT, tortuosity(&a)]); // 1.15, 1.27
    ascending("b: straight", &[-10.0, b_course[2] - b_course[0], 10.0]); // 6; in (a) 71
    ascending("c: in different directions", &[spread(&b), 13.0, 16.0, spread(&c)]); // 10, 18
    ascending("c: straight", &[1.0, tortuosity(&c), 1.23, tortuosity(&a)]); // 1.17 to 1.2, 1.27
    ascending("d: out", &[d_course[0] + 10.0, d_course[1]]); // 46 to 64
    ascending("d: then up", &[d_course[2] + 10.0, d_course[1]]); // 64 to 45, in (b) 63 to 62
}

#[test]
fn figure_07() {
    let trees = several(8, "figure-07", 60_000, 1);
    // Turn of paths away from up, by the angle of their ends to the axis.
    let turns = |trees: &[Tree]| {
        let turns: Vec<(f32, f32)> = paths(trees, 0)
            .iter()
            .map(|path| (path.tilt(), path.tilt_at_end(5) - path.tilt_at_start(5)))
            .collect();
        [(0.0, 20.0), (20.0, 35.0), (35.0, 90.0)].map(|(low, high)| {
            mean(turns.iter().filter(|turn| (low..high).contains(&turn.0)).map(|turn| turn.1))
        })
    };
    let right = turns(&trees);
    ascending("the more, the farther out", &[5.0, right[0], 40.0, right[1], 85.0, right[2]]); // 26, 65, 106
    // A constant angle that bends the outer branches as far bends the inner ones twice as far.
    let constant = turns(&each(&trees, |tree| tree.ruled(0, Bend::constant(degrees(9.0))))); // 25, 51, 76
    let inside = (right[0] / right[2]) / (constant[0] / constant[2]);
    ascending("straighter inside than that", &[inside, 0.88]); // 0.62 to 0.81
    let upright = Tree::of("figure-06b", 60_000, 1);
    ascending(
        "wide",
        &[upright.width_over_height(), 1.0, Tree::of("figure-07", 60_000, 1).width_over_height()],
    );
}

#[test]
fn figure_08() {
    let a = grown("figure-08a", 40_000, 2);
    let [b, c] = ["figure-08b", "figure-08c"].map(|name| each(&a, |tree| tree.as_preset(name)));
    // Degrees that a path winds about the axis.
    let winding = |path: &Path| -> f32 {
        let turn = |a: Vec3, b: Vec3| atan2(a.cross(b).y, a.dot(b)).to_degrees();
        path.0.windows(2).map(|pair| turn(pair[0].with_y(0.0), pair[1].with_y(0.0))).sum()
    };
    let left_handed = Helix::with_angle(Vec3::ZERO, -degrees(40.0));
    let left_handed = each(&a, |tree| tree.ruled(0, FollowField::new(left_handed)));
    ascending("a: winding", &[most(&paths(&left_handed, 0), winding), 0.0, least(&paths(&a, 0), winding)]);
    let turn = |trees: &[Tree]| mean(paths(trees, 0).iter().map(winding));
    ascending("a: a turn", &[turn(&b), 100.0, 260.0, turn(&a)]); // -12 to 44, 335 to 377
    ascending("a: rising", &[0.99, share(&paths(&a, 0), |path| path.end().y > path.start().y)]);

    let internodes = |trees: &[Tree], stage| -> Vec<(Vec3, Vec3)> {
        trees.iter().flat_map(|tree| tree.internodes(stage..stage + 1)).collect()
    };
    let to_x = |trees: &[Tree]| mean(internodes(trees, 1).iter().map(|(_, direction)| direction.x));
    let mirrored = Rotation::new(Vec3::new(-7.0, 0.0, 0.0), Vec3::Z);
    let mirrored = each(&b, |tree| tree.ruled(1, FollowField::new(mirrored)));
    // The endpoints of the first iteration are all around: what sweeps is the second. -0.45, -0.04, 0.40
    ascending("b: to one side", &[to_x(&mirrored), -0.3, to_x(&a), 0.3, to_x(&b)]);

    let onion = SphericalMeridians::new(Vec3::Y * 5.0);
    let along = |trees: &[Tree], stage| {
        mean(internodes(trees, stage).iter().map(|&(middle, direction)| onion.at(middle).dot(direction)))
    };
    ascending("c: up along spheres", &[along(&a, 0).max(along(&b, 0)), 0.65, 0.75, along(&c, 0)]); // 0.50, 0.63, 0.81
    // Of later iterations too: all of them follow the field. With forks instead the cosine falls.
    let whole = Tree::of("figure-08c", 40_000, 1);
    let forked = whole.ruled(3, Bend::piecewise(degrees(30.0), 0.0, 1));
    let last = |tree: &Tree| {
        let internodes = tree.internodes(3..4);
        mean(internodes.iter().map(|&(middle, direction)| onion.at(middle).dot(direction)))
    };
    ascending("c: twigs in the field", &[last(&forked) + 0.05, last(&whole)]); // 0.61, 0.69
    ascending("c: up along spheres", &[along(&a, 1).max(along(&b, 1)), 0.5, 0.65, along(&c, 1)]); // 0.37, 0.37, 0.76
}
