//! Rules, weights and endpoints of guided trees: a trunk, limbs, and twigs, of which one option changes.

use super::common::Failure;
use super::{Draw, PAPER, labelled};
use treesynth::glam::Vec3;
use treesynth::guided::{
    Apart, Bend, Blend, Count, ForkAngle, Guided, GuidedPower, GuidingRule, HopSurface, InShape, Jitter,
    LimbSurface, NearestTo, PoissonYao, Shedding, Stage, TreeSynth, WeightFn,
};
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::radius::PipeModel;
use treesynth::shape::{Bounds, Cuboid, Ellipsoid};
use treesynth::surface::Tubes;

pub(crate) const STRIPS: &[(&str, Draw)] = &[
    ("bend-angle", |size| {
        over(&[0.0, 20.0, 40.0, 60.0, 90.0], size, |angle| {
            limbs(Bend::piecewise(rad(angle), 0.0, 1).with_hop_length(0.25))
        })
    }),
    ("bend-hops", |size| {
        over(&[1.0, 2.0, 4.0, 8.0, 16.0], size, |hops| {
            limbs(Bend::piecewise(rad(12.0), 0.0, hops as u32).with_hop_length(0.25))
        })
    }),
    ("bend-rest", |size| {
        over(&[-10.0, -5.0, 0.0, 5.0, 10.0], size, |rest| {
            limbs(Bend::piecewise(rad(50.0), rad(rest), 1).with_hop_length(0.25))
        })
    }),
    ("bend-constant", |size| {
        over(&[0.0, 5.0, 10.0, 15.0, 20.0], size, |angle| {
            limbs(Bend::constant(rad(angle)).with_hop_length(0.25))
        })
    }),
    ("bend-random", |size| {
        over(&[0.0, 15.0, 30.0, 60.0, 90.0], size, |spread| {
            limbs(Bend::random(rad(40.0 - spread), rad(40.0 + spread), 0.0, 1).with_hop_length(0.25))
        })
    }),
    ("bend-from-axis", |size| {
        over(&[0.0, 8.0, 16.0, 24.0, 32.0], size, |theta| {
            limbs(Bend::from_axis(rad(theta)).with_hop_length(0.25))
        })
    }),
    ("fork-angle", |size| {
        over(&[15.0, 40.0, 65.0, 90.0, 115.0], size, |angle| limbs(ForkAngle::new(rad(angle), Bend::none())))
    }),
    ("fork-spread", |size| {
        over(&[0.0, 10.0, 20.0, 40.0, 60.0], size, |spread| {
            limbs(ForkAngle::new(rad(60.0), Bend::none()).with_spread(rad(spread)))
        })
    }),
    ("fork-divergence", |size| {
        over(&[72.0, 90.0, 120.0, 137.5, 180.0], size, |angle| {
            limbs(ForkAngle::new(rad(60.0), Bend::none()).with_divergence(rad(angle), 0.3))
        })
    }),
    ("jitter", |size| {
        over(&[0.0, 20.0, 40.0, 60.0, 90.0], size, |angle| limbs(Jitter::new(bend(), rad(angle))))
    }),
    ("blend", |size| {
        over(&[0.0, 0.25, 0.5, 0.75, 1.0], size, |share| {
            limbs(Blend::new(Bend::from_axis(rad(30.0)).with_hop_length(0.25), bend(), share))
        })
    }),
    ("length-exponent", |size| {
        over(&[0.5, 1.0, 1.5, 2.0, 3.0], size, |exponent| {
            weighed(GuidedPower::new(1.0).with_length_exponent(exponent))
        })
    }),
    ("deviation-exponent", |size| {
        over(&[0.0, 0.5, 1.0, 2.0, 4.0], size, |exponent| {
            weighed(GuidedPower::new(1.0).with_deviation_exponent(exponent))
        })
    }),
    ("apart", |size| over(&[0.0, 1.0, 3.0, 10.0, 30.0], size, |price| weighed(Apart::new(Guided, price)))),
    ("limb-count", |size| {
        over(&[5.0, 10.0, 20.0, 40.0, 80.0], size, |count| grown(bend(), Guided, count as usize, twigs()))
    }),
    ("hops", |size| {
        over(&[1.0, 2.0, 3.0, 5.0, 8.0], size, |hops| {
            twigged(HopSurface::new(hops as u32, 300).with_hop_length(0.2))
        })
    }),
    ("twig-count", |size| {
        over(&[50.0, 100.0, 200.0, 400.0, 800.0], size, |count| {
            twigged(HopSurface::new(2, Count::UpTo(count as usize)).with_hop_length(0.2))
        })
    }),
    ("outermost", |size| {
        over(&[0.2, 0.4, 0.6, 0.8, 1.0], size, |share| {
            twigged(HopSurface::new(2, Count::UpTo(300)).with_hop_length(0.2).with_outermost(share))
        })
    }),
    ("random-weights", |size| {
        over(&[0.0, 0.2, 0.4, 0.6, 0.9], size, |share| {
            twigged(HopSurface::new(3, 300).with_hop_length(0.2).with_random_weights(share))
        })
    }),
    ("limb-spacing", |size| {
        over(&[0.1, 0.2, 0.4, 0.8, 1.6], size, |metres| {
            twigged(LimbSurface::new(2, metres).with_hop_length(0.2))
        })
    }),
    ("bare-base", |size| {
        over(&[0.0, 0.25, 0.5, 0.75, 0.9], size, |share| {
            twigged(LimbSurface::new(2, 0.2).with_hop_length(0.2).with_bare_base(share))
        })
    }),
    ("bare-end", |size| {
        over(&[0.5, 0.75, 1.0, 1.5, 2.5], size, |metres| {
            grown(bend(), Guided, 40, HopSurface::new(2, Count::UpTo(60)).with_hop_length(0.2))
                .with_shedding(Shedding::new().with_bare_end(metres))
        })
    }),
];

fn rad(degrees: f32) -> f32 {
    degrees.to_radians()
}

fn bend() -> Bend {
    Bend::piecewise(rad(50.0), rad(-4.0), 1).with_hop_length(0.25)
}

fn twigs() -> HopSurface {
    HopSurface::new(2, Count::UpTo(300)).with_hop_length(0.2)
}

fn limbs(rule: impl GuidingRule + 'static) -> TreeSynth {
    grown(rule, Guided, 25, twigs())
}

fn weighed(weight: impl WeightFn + 'static) -> TreeSynth {
    grown(bend(), weight, 25, twigs())
}

fn twigged(twigs: impl treesynth::guided::EndpointPolicy + 'static) -> TreeSynth {
    grown(bend(), Guided, 25, twigs)
}

/// The tree of all strips: limbs by this rule and weight, as many as `count`; then twigs.
fn grown(
    rule: impl GuidingRule + 'static,
    weight: impl WeightFn + 'static,
    count: usize,
    twigs: impl treesynth::guided::EndpointPolicy + 'static,
) -> TreeSynth {
    let region = Cuboid::new(Vec3::new(-4.0, 0.0, -4.0), Vec3::new(4.0, 8.0, 4.0));
    let crown = Ellipsoid::new(Vec3::Y * 4.8, Vec3::new(2.6, 2.2, 2.6));
    // Thick twigs, which are seen in small pictures.
    TreeSynth::new(PoissonYao::new(region).with_nodes(40_000))
        .with_radius(PipeModel::default().with_exponent(2.8).with_tip_diameter(0.032))
        .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 6.0)))
        .stage(Stage::new(rule, InShape::poisson_disc(crown, Count::UpTo(count))).with_weight(weight))
        .stage(Stage::new(Bend::piecewise(rad(30.0), 0.0, 1).with_hop_length(0.25), twigs))
}

/// A tree for each value, from the same side and of the same seed.
fn over(values: &[f32], size: u32, synth: impl Fn(f32) -> TreeSynth) -> Result<Vec<Picture>, Failure> {
    let frame = Bounds::new(Vec3::new(-2.6, 0.0, -2.6), Vec3::new(2.6, 7.4, 2.6));
    let preview = Preview::default()
        .with_size(size, size)
        .with_background(PAPER, PAPER)
        .with_camera(Camera::default().with_frame(frame));
    let picture = |&value: &f32| {
        let tree = synth(value).synthesize(3)?.relaxed(0.5, 3)?;
        Ok(labelled(preview.draw(&Tubes::default().mesh(&tree)?)?, &value.to_string()))
    };
    values.iter().map(picture).collect()
}
