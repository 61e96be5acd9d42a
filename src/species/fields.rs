//! Every field of a species, in the order of its text form, with its range.

use super::data::{Laterals, LeafData, Species};
use super::organ::Organ;
use super::text::Fields;

const COLOR: [f32; 2] = [0.0, 255.0];
const PART: [f32; 2] = [0.0, 1.0];
const METRES: [f32; 2] = [0.0, 200.0];
const DEGREES: [f32; 2] = [-180.0, 180.0];

impl Species {
    /// Every field, in the order of the text form; for reading and for writing.
    pub(super) fn fields(&mut self, fields: &mut impl Fields) {
        fields.text("name", &mut self.name);
        fields.text("latin", &mut self.latin);
        fields.text("aliases", &mut self.aliases);
        fields.text("about", &mut self.about);
        fields.section("size");
        let size = &mut self.size;
        fields.numbers("height", &mut size.height, [0.1, 130.0]);
        fields.numbers("diameter", &mut size.diameter, [0.005, 10.0]);
        fields.number("usual_diameter", &mut size.usual_diameter, [0.005, 10.0]);
        fields.numbers("height_at", &mut size.height_at, [0.5, 130.0]);
        fields.numbers("width_at", &mut size.width_at, [0.1, 60.0]);
        fields.numbers("leaf_area_at", &mut size.leaf_area_at, [0.1, 5000.0]);
        fields.numbers("spread", &mut size.spread, PART);
        fields.numbers("slenderness", &mut size.slenderness, [1.0, 400.0]);
        fields.number("growth", &mut size.growth, [0.0001, 0.2]);
        fields.section("trunk");
        let trunk = &mut self.trunk;
        fields.numbers("stems", &mut trunk.stems, [1.0, 40.0]);
        fields.number("leader", &mut trunk.leader, [0.05, 1.0]);
        fields.numbers("forks", &mut trunk.forks, [1.0, 12.0]);
        fields.number("fork_angle", &mut trunk.fork_angle, [0.0, 90.0]);
        fields.number("lean", &mut trunk.lean, [0.0, 45.0]);
        fields.number("sweep", &mut trunk.sweep, [0.0, 45.0]);
        fields.numbers("profile", &mut trunk.profile, [0.01, 1.2]);
        fields.number("flare", &mut trunk.flare, [0.0, 3.0]);
        fields.numbers("roots", &mut trunk.roots, [0.0, 12.0]);
        fields.numbers("clear", &mut trunk.clear, [0.0, 0.97]);
        fields.section("crown");
        let crown = &mut self.crown;
        fields.list("profile", &mut crown.profile, [0.0, 1.0], 2..=12);
        fields.numbers("eccentricity", &mut crown.eccentricity, [0.0, 0.8]);
        fields.number("roughness", &mut crown.roughness, [0.0, 0.6]);
        fields.number("shed", &mut crown.shed, [0.0, 0.9]);
        fields.section("limbs");
        let limbs = &mut self.limbs;
        fields.number("count", &mut limbs.count, [0.0, 400.0]);
        fields.number("whorl_spacing", &mut limbs.whorl_spacing, [0.0, 10.0]);
        fields.numbers("whorl", &mut limbs.whorl, [1.0, 20.0]);
        fields.number("between", &mut limbs.between, [0.0, 40.0]);
        fields.numbers("angle", &mut limbs.angle, DEGREES);
        fields.number("angle_spread", &mut limbs.angle_spread, [0.0, 60.0]);
        fields.numbers("rise", &mut limbs.rise, DEGREES);
        fields.numbers("rise_at_end", &mut limbs.rise_at_end, DEGREES);
        fields.number("unequal", &mut limbs.unequal, PART);
        fields.number("crooked", &mut limbs.crooked, [0.0, 90.0]);
        fields.number("bare", &mut limbs.bare, PART);
        fields.numbers("length", &mut limbs.length, METRES);
        fields.number("forks", &mut limbs.forks, [0.0, 6.0]);
        fields.number("forks_angle", &mut limbs.forks_angle, [5.0, 90.0]);
        fields.number("thickest", &mut limbs.thickest, [0.05, 1.0]);
        fields.numbers("dead", &mut limbs.dead, [0.0, 40.0]);
        fields.section("branches");
        self.branches.fields(fields);
        fields.section("twigs");
        self.twigs.fields(fields);
        fields.section("shoots");
        let shoots = &mut self.shoots;
        fields.number("radius", &mut shoots.radius, [0.1, 100.0]);
        fields.number("radius_cv", &mut shoots.radius_cv, [0.0, 0.5]);
        fields.number("length", &mut shoots.length, [0.005, 3.0]);
        fields.number("length_spread", &mut shoots.length_spread, [0.0, 2.0]);
        fields.number("short", &mut shoots.short, PART);
        fields.number("short_length", &mut shoots.short_length, [0.001, 0.5]);
        fields.number("spacing", &mut shoots.spacing, [0.005, 5.0]);
        fields.number("angle", &mut shoots.angle, [0.0, 180.0]);
        fields.number("rise", &mut shoots.rise, [-10.0, 10.0]);
        fields.choice("stand", &mut shoots.stand);
        fields.section("leaves");
        self.leaves.fields(fields);
        fields.section("bark");
        let bark = &mut self.bark;
        fields.choice("kind", &mut bark.kind);
        fields.numbers("trunk", &mut bark.trunk, COLOR);
        fields.numbers("limbs", &mut bark.limbs, COLOR);
        fields.numbers("twigs", &mut bark.twigs, COLOR);
        fields.numbers("foot", &mut bark.foot, COLOR);
        fields.number("tile", &mut bark.tile, [0.0, 10.0]);
        fields.number("depth", &mut bark.depth, [0.0, 0.2]);
        fields.numbers("palette", &mut bark.palette, COLOR);
        fields.number("spread", &mut bark.spread, [0.0, 2.0]);
        fields.tables("organs", &mut self.organs, Organ::MOST, Organ::fields);
    }
}

impl Laterals {
    fn fields(&mut self, fields: &mut impl Fields) {
        fields.choice("stand", &mut self.stand);
        fields.number("spacing", &mut self.spacing, [0.01, 20.0]);
        fields.number("angle", &mut self.angle, [0.0, 180.0]);
        fields.number("angle_spread", &mut self.angle_spread, [0.0, 60.0]);
        fields.number("ratio", &mut self.ratio, [0.0, 10.0]);
        fields.numbers("length", &mut self.length, METRES);
        fields.number("rise", &mut self.rise, [-10.0, 10.0]);
        fields.number("flat", &mut self.flat, PART);
        fields.number("crooked", &mut self.crooked, [0.0, 90.0]);
        fields.number("bare", &mut self.bare, PART);
        fields.number("unequal", &mut self.unequal, PART);
    }
}

impl LeafData {
    fn fields(&mut self, fields: &mut impl Fields) {
        fields.choice("shape", &mut self.shape);
        fields.number("length", &mut self.length, [0.001, 12.0]);
        fields.number("petiole", &mut self.petiole, [0.0, 3.0]);
        fields.choice("stand", &mut self.stand);
        fields.number("spacing", &mut self.spacing, [0.001, 2.0]);
        fields.number("reach", &mut self.reach, [0.001, 20.0]);
        fields.number("angle", &mut self.angle, [0.0, 180.0]);
        fields.number("rise", &mut self.rise, [-10.0, 10.0]);
        fields.number("turn", &mut self.turn, PART);
        fields.number("disorder", &mut self.disorder, PART);
        fields.flag("evergreen", &mut self.evergreen);
        fields.numbers("summer", &mut self.summer, COLOR);
        fields.numbers("autumn", &mut self.autumn, COLOR);
        fields.ascending("days", &mut self.days, [1.0, 366.0]);
    }
}
