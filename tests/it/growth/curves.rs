//! Curves and what species say of bad input.

use proptest::prelude::*;
use treesynth::ParameterError;
use treesynth::growth::{Architecture, Curve, Growth, GrowthError, Phenology};

fn line() -> Curve {
    Curve::new([[0.0, 0.0], [1.0, 1.0]]).expect("a line")
}

fn message<T: std::fmt::Debug>(result: Result<T, ParameterError>) -> String {
    result.expect_err("out of range").to_string()
}

#[test]
fn curves_refuse_what_is_no_function() {
    let nan = f32::NAN;
    let wrong: [(&[[f32; 2]], &str); 9] = [
        (&[], "Curve.points is 0"),
        (&[[0.5, 1.0], [0.2, 1.0]], "points[1].place is 0.2"),
        (&[[0.5, 1.0], [0.5, 2.0]], "points[1].place is 0.5"),
        (&[[-0.1, 1.0]], "points[0].place is -0.1"),
        (&[[0.0, 1.0], [1.1, 1.0]], "points[1].place is 1.1"),
        (&[[nan, 1.0]], "points[0].place is NaN"),
        (&[[0.0, nan]], "points[0].value is NaN"),
        (&[[0.0, f32::INFINITY]], "points[0].value is inf"),
        (&[[0.0, 1e13]], "points[0].value is 10000000000000.0"),
    ];
    for (points, expected) in wrong {
        let message = message(Curve::new(points.iter().copied()));
        assert!(message.contains(expected), "{message}");
    }
    assert!(Curve::new((0..10_001).map(|i| [i as f32 / 20_000.0, 0.0])).is_err());
    for control in [&[[0.0, 0.0]; 3][..], &[[0.0, 0.0]; 6], &[]] {
        assert!(message(Curve::bezier(control)).contains("Curve.bezier"));
    }
    assert!(
        message(Curve::bezier(&[[0.0, 0.0], [0.6, 0.0], [0.4, 1.0], [1.0, 1.0]])).contains("bezier[2].place")
    );
    assert!(Curve::bezier(&[[0.0, 0.0], [0.4, f32::NAN], [0.6, 1.0], [1.0, 1.0]]).is_err());
    assert!(line().scaled(f32::MAX).is_err());
}

proptest! {
    /// Through all points, between neighbours in between, level outside; and the same after a file.
    #[test]
    fn curves_are_monotone_between_points(
        steps in prop::collection::vec((1e-3f32..1.0, -1e3f32..1e3), 1..12),
        place in -0.5f32..1.5,
    ) {
        let whole: f32 = steps.iter().map(|step| step.0).sum::<f32>() * 1.01;
        let mut along = 0.0;
        let points: Vec<[f32; 2]> = steps
            .iter()
            .map(|&(step, value)| {
                along += step / whole;
                [along, value]
            })
            .collect();
        let curve = Curve::new(points.clone()).expect("ascending");
        for &[place, value] in &points {
            prop_assert!((curve.at(place) - value).abs() <= 1e-3 * value.abs().max(1.0));
        }
        let after = points.partition_point(|point| point[0] <= place);
        let neighbours = [after.saturating_sub(1), after.min(points.len() - 1)].map(|i| points[i][1]);
        let value = curve.at(place);
        prop_assert!(value >= neighbours[0].min(neighbours[1]) && value <= neighbours[0].max(neighbours[1]));
        let json = serde_json::to_string(&curve).expect("text");
        prop_assert_eq!(serde_json::from_str::<Curve>(&json).expect("a curve"), curve);
    }
}

#[test]
fn a_plot_is_a_document_with_the_curve_in_it() {
    let curve = Curve::new([[0.0, 2.0], [0.5, 8.0], [1.0, 5.0]]).expect("a curve");
    let text = curve.svg("height < crown & trunk");
    let svg = roxmltree::Document::parse(&text).expect("well-formed");
    let named = |name: &'static str| svg.descendants().filter(move |node| node.has_tag_name(name));
    assert_eq!(named("circle").count(), 3);
    let line = named("polyline").next().and_then(|line| line.attribute("points")).expect("a line");
    // Half way along the frame of 250, and at its top.
    assert!(line.contains("175.00,30.00"), "{line}");
    assert!(named("text").any(|text| text.text() == Some("height < crown & trunk")));
}

#[test]
fn files_with_bad_curves_are_refused() {
    for text in ["[[0.5,1],[0.2,1]]", "[]", "[[0,1e30]]", "[[2,1]]"] {
        assert!(serde_json::from_str::<Curve>(text).is_err(), "{text}");
    }
    let species = Architecture::spruce();
    let json = serde_json::to_value(&species).expect("text");
    assert_eq!(serde_json::from_value::<Architecture>(json.clone()).expect("a species"), species);
    let mut extra = json;
    extra["leaves"] = serde_json::json!(1);
    assert!(serde_json::from_value::<Architecture>(extra).is_err());
}

/// Each option just beyond its range, and what the message calls it.
#[test]
fn species_name_what_is_out_of_range() {
    let species = Architecture::default;
    let flat = |value: f32| Curve::constant(value).expect("a value");
    let year = Phenology::default;
    let nan = f32::NAN;
    let wrong =
        vec![
            ("Architecture.years is 0", species().with_years(0)),
            ("Architecture.years is 1001", species().with_years(1001)),
            ("Architecture.least_shoot", species().with_least_shoot(0.0)),
            ("Architecture.least_shoot", species().with_least_shoot(nan)),
            ("Architecture.longest_branch", species().with_longest_branch(0.0)),
            ("Architecture.least_scale", species().with_least_scale(1.1)),
            ("Architecture.most_order is 17", species().with_most_order(17)),
            ("Architecture.divergence", species().with_divergence(7.0)),
            ("Architecture.stoutness", species().with_stoutness(-0.1)),
            ("Architecture.twig_radius", species().with_twig_radius(0.0)),
            ("Architecture.variation", species().with_variation(nan)),
            ("Architecture.scale_variation", species().with_scale_variation(1.0)),
            ("Architecture.tropism", species().with_tropism(f32::NEG_INFINITY)),
            ("Architecture.height", species().with_height(flat(-1.0))),
            ("Architecture.young_silhouette", species().with_young_silhouette(flat(11.0))),
            ("Architecture.mature_silhouette", species().with_mature_silhouette(flat(-0.1))),
            ("Architecture.short_heading", species().with_short_heading(flat(2.6))),
            ("Architecture.long_heading", species().with_long_heading(flat(-2.6))),
            ("Architecture.branch_scale", species().with_branch_scale(flat(1.1))),
            ("Architecture.lifespan", species().with_lifespan(flat(-1.0))),
            ("Architecture.metamers", species().with_metamers(flat(1001.0))),
            ("Architecture.shoot_scale", species().with_shoot_scale(flat(-0.1))),
            ("Architecture.branching_angle", species().with_branching_angle(flat(0.0))),
            ("Phenology.season", species().with_phenology(year().with_season(0.5, 0.5))),
            ("Phenology.season", species().with_phenology(year().with_season(nan, 0.5))),
            ("Phenology.leaf_years is 0", species().with_phenology(year().with_leaf_years(0))),
            ("Phenology.stagger", species().with_phenology(year().with_stagger(1.0))),
            ("Phenology.bud_size", species().with_phenology(year().with_bud_size(-0.1))),
            ("Phenology.leaf_angle", species().with_phenology(year().with_leaf_angle(4.0))),
            ("Phenology.internode_growth", species().with_phenology(year().with_internode_growth(flat(0.5)))),
            (
                "Phenology.internode_growth",
                species().with_phenology(year().with_internode_growth(
                    Curve::new([[0.0, 0.5], [0.5, 0.2], [1.0, 1.0]]).expect("a curve"),
                )),
            ),
            ("Phenology.leaf_growth", species().with_phenology(year().with_leaf_growth(flat(2.0)))),
            ("Phenology.bud_growth", species().with_phenology(year().with_bud_growth(flat(-1.0)))),
            ("Phenology.leaf_size", species().with_phenology(year().with_leaf_size(flat(-1.0)))),
            ("Phenology.leaf_share", species().with_phenology(year().with_leaf_share(flat(1.5)))),
            (
                "Phenology.leaf_colors",
                species().with_phenology(year().with_leaf_colors([flat(0.5), flat(2.0), flat(0.5)])),
            ),
        ];
    for (name, species) in wrong {
        let message = message(species.check());
        assert!(message.starts_with(name) && message.contains("but must be"), "{message}");
        assert!(Growth::new(species, 1).is_err());
    }
}

#[test]
fn ages_out_of_range_are_named() {
    let growth = Growth::new(Architecture::default().with_years(3), 1).expect("a tree");
    for age in [-0.1, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3.001] {
        let error = growth.at(age).expect_err("no such age");
        assert!(matches!(error, GrowthError::Parameter(_)), "{error}");
        assert!(error.to_string().starts_with("Growth.age is "), "{error}");
        assert!(error.to_string().ends_with("0 to 3 years, the greatest age of the species"), "{error}");
    }
    let seed = growth.at(0.0).expect("a seed");
    assert_eq!((seed.skeleton.len(), seed.ids.as_slice(), seed.leaves.len()), (1, &[0][..], 0));
    assert_eq!(growth.at(-0.0).expect("the same"), seed);
}

#[test]
fn a_limit_keeps_the_years_before() {
    let whole = Growth::new(Architecture::default(), 1).expect("a tree");
    let limited = Growth::with_most_nodes(Architecture::default(), 1, 5000).expect("some years");
    let years = limited.years();
    assert!((2..27).contains(&years) && limited.nodes() <= 5000);
    let age = f32::from(years);
    // All but the radii, which are measured by the wood of the last year there is.
    let [limited_tree, whole_tree] = [&limited, &whole].map(|growth| growth.at(age).expect("it stands"));
    assert_eq!(limited_tree.skeleton.positions(), whole_tree.skeleton.positions());
    assert_eq!((limited_tree.ids, limited_tree.dead), (whole_tree.ids, whole_tree.dead));
    let error = limited.at(age + 0.5).expect_err("beyond the limit");
    assert!(matches!(error, GrowthError::Limit { limit: 5000, nodes: 5001.., .. }), "{error}");
    assert!(error.to_string().contains(&format!("up to the age of {years}")), "{error}");
    for limit in [0, (1 << 31) + 1] {
        let message = message(Growth::with_most_nodes(Architecture::default(), 1, limit));
        assert!(message.starts_with("Growth.most_nodes"), "{message}");
    }
    let none = Growth::with_most_nodes(Architecture::default(), 1, 1).expect("a seed");
    assert_eq!((none.years(), none.nodes()), (0, 1));
    assert_eq!(none.at(0.0).expect("a seed").skeleton.len(), 1);
    assert!(none.at(0.5).is_err());
}
