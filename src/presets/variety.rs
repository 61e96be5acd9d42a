//! Figures 15 to 17: one species many times, a range of crowns, and many species.

use super::look::{ASH, BARE, BIRCH, HAZEL, LINDEN, OAK, POPLAR, SPRUCE};
use super::rotation::ash;
use super::{Preset, Site, degrees, fork, trunk};
use crate::guided::{Bend, ByHeight, Count, InShape, Recipe, Side, SourceElevation, StageRecipe};
use crate::shape::{Cone, Cylinder, Ellipsoid, HalfEllipsoid, Union};
use glam::Vec3;

pub(super) const PRESETS: &[Preset] = &[
    Preset::new("figure-15-1", 15, "The ash of figure 6 (c), first of six.", ash).seed(11).like(ASH),
    Preset::new("figure-15-2", 15, "The ash of figure 6 (c), second of six.", ash).seed(12).like(ASH),
    Preset::new("figure-15-3", 15, "The ash of figure 6 (c), third of six.", ash).seed(13).like(ASH),
    Preset::new("figure-15-4", 15, "The ash of figure 6 (c), fourth of six.", ash).seed(14).like(ASH),
    Preset::new("figure-15-5", 15, "The ash of figure 6 (c), fifth of six.", ash).seed(15).like(ASH),
    Preset::new("figure-15-6", 15, "The ash of figure 6 (c), sixth of six.", ash).seed(16).like(ASH),
    Preset::new("figure-16-15", 16, "Half-ellipsoid of aspect 1.5, θ = 14°.", |nodes| {
        crown(nodes, 1.5, 14.0)
    }),
    Preset::new("figure-16-09", 16, "Half-ellipsoid of aspect 0.9, θ = 20°.", |nodes| {
        crown(nodes, 0.9, 20.0)
    }),
    Preset::new("figure-16-05", 16, "Half-ellipsoid of aspect 0.5, θ = 26°.", |nodes| {
        crown(nodes, 0.5, 26.0)
    }),
    Preset::new("figure-16-03", 16, "Half-ellipsoid of aspect 0.3, θ = 32°.", |nodes| {
        crown(nodes, 0.3, 32.0)
    }),
    Preset::new(
        "figure-17a",
        17,
        "Few endpoints first, many later: distinct limbs, clustered twigs.",
        clusters,
    )
    .like(OAK),
    Preset::new("figure-17b", 17, "α1 = 30°, α2 = -10°, h0 = 3 above, α = 8° drooping below.", two_habits)
        .like(LINDEN),
    Preset::new("figure-17c", 17, "Short horizontal branches on a spindle: a dead tree.", spindle).like(BARE),
    Preset::new(
        "figure-17d",
        17,
        "A cottonwood: broad, airy, endpoints higher than their sources.",
        cottonwood,
    )
    .like(POPLAR),
    Preset::new("figure-17e", 17, "Sources steeper with height, in a cone.", steepening_cone).like(SPRUCE),
    Preset::new("figure-17f", 17, "A shrub: many endpoints at once, upright.", upright_shrub).like(HAZEL),
    Preset::new("figure-17g", 17, "A birch with a divided trunk.", birch).like(BIRCH),
    Preset::new("figure-17h", 17, "A shrub: many endpoints at once, spreading.", spreading_shrub).like(HAZEL),
    Preset::new("figure-17i", 17, "Sources steeper with height, in a tall oval.", steepening_oval)
        .like(LINDEN),
    Preset::new("figure-17j", 17, "A zelkova: two iterations, no small twigs.", zelkova),
];

/// Figure 16: crowns lower and lower and wider and wider. Of equal volume, the last would be as high as the one before:
/// with θ = 32° its limbs rise a metre above their endpoints on their way out. So the volume falls a little with the aspect.
fn crown(nodes: usize, aspect: f32, theta: f32) -> Recipe {
    // An exponent of 2/3 would keep the volume, 1 the width.
    let height = 6.4 * crate::math::powf(aspect / 0.9, 0.92);
    let width = height / aspect;
    let base = 2.0;
    let dome = HalfEllipsoid::with_aspect(Vec3::Y * base, height, aspect);
    let site = Site::new(width + 4.0, base + height + 2.0 + 1.2 / aspect, nodes);
    site.tree(0.4)
        .stage(site.limbs(Bend::from_axis(degrees(theta)), dome, 60))
        .stage(site.twigs(3, 400))
        .stage(site.twigs(2, 1800))
        .stage(site.twigs(1, 3500))
}

fn clusters(nodes: usize) -> Recipe {
    let site = Site::new(12.0, 11.5, nodes);
    let dome = HalfEllipsoid::new(Vec3::Y * 5.6, Vec3::new(3.6, 4.0, 3.6));
    site.tree(0.45)
        .stage(site.limbs(Bend::piecewise(degrees(6.0), degrees(-4.0), 12), dome, 9))
        .stage(StageRecipe::new(fork(), site.surface(4, 60).with_outermost(0.4)))
        .stage(site.outer_twigs(2, 1500, 0.5))
        .stage(site.outer_twigs(2, 3000, 0.5))
}

fn two_habits(nodes: usize) -> Recipe {
    let site = Site::new(12.0, 12.0, nodes);
    let oval = Ellipsoid::new(Vec3::Y * 6.4, Vec3::new(3.2, 3.5, 3.2));
    let drooping = site.by_length(Bend::constant(degrees(8.0)));
    let rising = site.by_length(Bend::piecewise(degrees(30.0), degrees(-10.0), 3));
    let rule = ByHeight::new(5.8, drooping, rising);
    site.tree(0.4)
        .stage(trunk(8.8))
        .stage(StageRecipe::new(rule, InShape::poisson_disc(oval, Count::UpTo(100))))
        .stage(site.twigs(2, 500))
        .stage(site.twigs(2, 2000))
        .stage(site.twigs(1, 3500))
}

fn spindle(nodes: usize) -> Recipe {
    let site = Site::new(7.0, 11.0, nodes);
    let narrow = Cone::new(Vec3::Y * 1.6, 1.6, 8.2);
    site.tree(0.3)
        .stage(trunk(9.6))
        .stage(site.limbs(Bend::piecewise(degrees(90.0), 0.0, 1), narrow, 110))
        .stage(StageRecipe::new(Bend::piecewise(degrees(20.0), 0.0, 1), site.surface(3, 260)))
}

pub(super) fn cottonwood(nodes: usize) -> Recipe {
    let site = Site::new(15.0, 11.5, nodes);
    let broad = HalfEllipsoid::new(Vec3::Y * 4.0, Vec3::new(5.2, 5.4, 5.2));
    let higher = |hops, count| {
        StageRecipe::new(fork(), site.surface(hops, count).with_outermost(0.5).only(Side::Higher))
    };
    site.tree(0.6)
        .stage(site.limbs(Bend::piecewise(degrees(5.0), degrees(-2.0), 10), broad, 14))
        .stage(higher(5, 90))
        .stage(higher(4, 500))
        .stage(higher(2, 3500))
}

fn steepening(rule: Bend, top: f32) -> SourceElevation<Bend> {
    SourceElevation::new(rule, [degrees(100.0), degrees(25.0)], [1.5, top])
}

fn steepening_cone(nodes: usize) -> Recipe {
    let site = Site::new(10.0, 11.5, nodes);
    let rule = steepening(site.by_length(Bend::constant(degrees(1.0))), 9.0);
    site.tree(0.35)
        .stage(trunk(9.8))
        .stage(StageRecipe::new(
            rule,
            InShape::poisson_disc(Cone::new(Vec3::Y * 2.2, 3.0, 8.2), Count::UpTo(130)),
        ))
        .stage(site.twigs(2, 600))
        .stage(site.twigs(1, 2200))
        .stage(site.twigs(1, 3500))
}

fn steepening_oval(nodes: usize) -> Recipe {
    let site = Site::new(10.0, 12.5, nodes);
    let oval = Ellipsoid::new(Vec3::Y * 6.9, Vec3::new(2.5, 3.4, 2.5));
    let rule = steepening(site.by_length(Bend::constant(degrees(-3.0))), 9.0);
    site.tree(0.35)
        .stage(trunk(8.0))
        .stage(StageRecipe::new(rule, InShape::poisson_disc(oval, Count::UpTo(90))))
        .stage(site.twigs(2, 500))
        .stage(site.twigs(2, 2000))
        .stage(site.twigs(1, 3500))
}

fn upright_shrub(nodes: usize) -> Recipe {
    let site = Site::new(10.0, 10.0, nodes);
    let oval = HalfEllipsoid::new(Vec3::Y * 2.4, Vec3::new(2.7, 5.6, 2.7));
    site.tree(0.35)
        .stage(site.limbs(Bend::piecewise(degrees(8.0), degrees(-3.0), 5), oval, 120))
        .stage(site.twigs(2, 600))
        .stage(site.twigs(2, 2400))
        .stage(site.twigs(1, 3500))
}

fn spreading_shrub(nodes: usize) -> Recipe {
    let site = Site::new(13.0, 8.0, nodes);
    let dome = HalfEllipsoid::new(Vec3::Y * 0.8, Vec3::new(4.4, 4.6, 4.4));
    site.tree(0.35)
        .stage(site.limbs(Bend::constant(degrees(5.0)), dome, 160))
        .stage(site.twigs(2, 700))
        .stage(site.twigs(2, 2400))
        .stage(site.twigs(1, 3500))
}

fn birch(nodes: usize) -> Recipe {
    let site = Site::new(10.0, 11.5, nodes);
    let fork_tops = Cylinder::new(Vec3::Y * 8.2, 1.2, 0.8);
    let crown = Union::new(
        Ellipsoid::new(Vec3::Y * 6.2, Vec3::new(2.6, 3.6, 2.6)),
        Cylinder::new(Vec3::Y * 3.0, 1.2, 1.5),
    );
    site.tree(0.35)
        .stage(site.limbs(Bend::piecewise(degrees(1.0), degrees(-0.5), 12), fork_tops, 2))
        .stage(site.limbs(Bend::piecewise(degrees(40.0), degrees(5.0), 1), crown, 90))
        .stage(site.twigs(2, 500))
        .stage(site.twigs(2, 2000))
        .stage(site.twigs(1, 3500))
}

fn zelkova(nodes: usize) -> Recipe {
    let site = Site::new(12.0, 11.0, nodes);
    let vase = HalfEllipsoid::new(Vec3::Y * 5.0, Vec3::new(4.2, 4.6, 4.2));
    site.tree(0.5)
        .stage(site.limbs(Bend::piecewise(degrees(4.0), degrees(-1.0), 12), vase, 90))
        .stage(site.twigs(3, 900))
}
