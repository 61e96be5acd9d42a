//! Figures 9 to 14: places of endpoints.

use super::look::{LINDEN, MAPLE, POPLAR, WILLOW};
use super::{Preset, Site, degrees, fork, trunk};
use crate::guided::{Bend, Recipe, Side, StageRecipe};
use crate::shape::{Cone, Cuboid, Ellipsoid, HalfEllipsoid, ShapeRecipe};
use glam::Vec3;

pub(super) const PRESETS: &[Preset] = &[
    Preset::new("figure-09-cone", 9, "First endpoints in a cone.", |nodes| {
        bounded(nodes, Cone::new(Vec3::Y * 3.2, 3.4, 7.0))
    })
    .like(LINDEN),
    Preset::new("figure-09-box", 9, "The same parameters, first endpoints in a box.", |nodes| {
        bounded(nodes, Cuboid::centered(Vec3::Y * 6.6, Vec3::new(5.4, 5.4, 5.4)))
    })
    .like(LINDEN),
    Preset::new(
        "figure-09-half-ellipsoid",
        9,
        "The same parameters, first endpoints in a half-ellipsoid.",
        |nodes| bounded(nodes, HalfEllipsoid::new(Vec3::Y * 5.2, Vec3::new(4.2, 4.2, 4.2))),
    )
    .like(LINDEN),
    Preset::new("figure-10-tall", 10, "A trunk, then a crown in a tall ellipsoid.", |nodes| {
        crowned(nodes, TALL, 9.2)
    })
    .partial(2)
    .within(TALL)
    .like(POPLAR),
    Preset::new("figure-10-wide", 10, "A trunk, then a crown in a wide ellipsoid.", |nodes| {
        crowned(nodes, WIDE, 8.0)
    })
    .partial(2)
    .within(WIDE)
    .like(MAPLE),
    Preset::new(
        "figure-11",
        11,
        "The nodes three hops off the tree, and those of them in the exclusion zone.",
        |nodes| excluded(nodes, 0.6),
    )
    .partial(2),
    Preset::new("figure-12-t03", 12, "t = 0.3: twigs only in the outer regions.", |nodes| {
        excluded(nodes, 0.3)
    }),
    Preset::new("figure-12-t06", 12, "t = 0.6: a good balance.", |nodes| excluded(nodes, 0.6)),
    Preset::new("figure-12-t10", 12, "t = 1: the entire tree is covered with twigs.", |nodes| {
        excluded(nodes, 1.0)
    }),
    Preset::new("figure-13", 13, "Endpoints lower than their sources: branches hang.", hanging)
        .partial(2)
        .like(WILLOW),
    Preset::new(
        "figure-14-1000",
        14,
        "About 1000 endpoints, some 750 of them tips: the others lie on the way to these.",
        |nodes| dense(nodes, [60, 240, 700]),
    )
    .like(MAPLE),
    Preset::new(
        "figure-14-2000",
        14,
        "About 2000 endpoints, some 1400 of them tips: the others lie on the way to these.",
        |nodes| dense(nodes, [60, 440, 1500]),
    )
    .like(MAPLE),
    Preset::new(
        "figure-14-4000",
        14,
        "About 4000 endpoints, some 2600 of them tips: the others lie on the way to these.",
        |nodes| dense(nodes, [60, 940, 3000]),
    )
    .like(MAPLE),
];

const TALL: Ellipsoid = Ellipsoid::new(Vec3::new(0.0, 6.4, 0.0), Vec3::new(2.1, 3.8, 2.1));
const WIDE: Ellipsoid = Ellipsoid::new(Vec3::new(0.0, 7.4, 0.0), Vec3::new(4.2, 1.8, 4.2));

fn bounded(nodes: usize, volume: impl Into<ShapeRecipe>) -> Recipe {
    let site = Site::new(12.0, 12.0, nodes);
    site.tree(0.4)
        .stage(site.limbs(Bend::piecewise(degrees(5.0), degrees(-3.0), 12), volume, 60))
        .stage(site.twigs(3, 400))
        .stage(site.twigs(2, 1800))
        .stage(site.twigs(1, 3500))
}

fn crowned(nodes: usize, crown: Ellipsoid, height: f32) -> Recipe {
    let site = Site::new(12.5, 12.5, nodes);
    site.tree(0.36)
        .stage(trunk(height))
        .stage(site.limbs(Bend::piecewise(degrees(60.0), degrees(-1.0), 1), crown, 90))
        .stage(site.twigs(2, 500))
        .stage(site.twigs(2, 2000))
        .stage(site.twigs(1, 3500))
}

fn excluded(nodes: usize, outermost: f32) -> Recipe {
    let site = Site::new(12.5, 12.5, nodes);
    let crown = Ellipsoid::new(Vec3::Y * 6.8, Vec3::new(3.3, 2.9, 3.3));
    site.tree(0.4)
        .stage(trunk(8.2))
        .stage(site.limbs(Bend::piecewise(degrees(60.0), 0.0, 1), crown, 60))
        .stage(site.outer_twigs(3, 500, outermost))
        .stage(site.outer_twigs(2, 2000, outermost))
        .stage(site.outer_twigs(1, 3000, outermost))
}

fn hanging(nodes: usize) -> Recipe {
    let site = Site::new(13.0, 11.5, nodes);
    let crown = HalfEllipsoid::new(Vec3::Y * 5.5, Vec3::new(3.8, 4.2, 3.8));
    let lower = |hops, count| {
        let endpoints = site.surface(hops, count).with_outermost(0.9).only(Side::Lower);
        StageRecipe::new(site.by_length(Bend::piecewise(degrees(120.0), degrees(6.0), 1)), endpoints)
    };
    site.tree(0.4)
        .stage(trunk(7.0))
        .stage(site.limbs(Bend::piecewise(degrees(30.0), degrees(6.0), 1), crown, 60))
        .stage(lower(4, 350))
        .stage(lower(4, 900))
        .stage(lower(3, 2500))
}

fn dense(nodes: usize, [first, second, third]: [usize; 3]) -> Recipe {
    let site = Site::new(12.0, 12.0, nodes);
    let crown = HalfEllipsoid::new(Vec3::Y * 4.8, Vec3::new(3.4, 4.8, 3.4));
    site.tree(0.36)
        .stage(trunk(8.4))
        .stage(site.limbs(Bend::piecewise(degrees(60.0), degrees(-1.0), 1), crown, first))
        .stage(StageRecipe::new(fork(), site.surface(3, second)))
        .stage(site.twigs(2, third))
}
