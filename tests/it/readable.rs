//! Options can be read, compared, printed and saved, and a preset's look can be changed.

use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Debug;
use treesynth::asset::{AssetBuilder, Impostor};
use treesynth::export::{Axes, Breeze, GlbOptions, SvgOptions};
use treesynth::foliage::{Arrangement, Foliage, Leaf};
use treesynth::glam::{DVec3, Vec2, Vec3};
use treesynth::growth::Architecture;
use treesynth::guided::{Canvas, DrawnLimbs, Leader, Shedding, Stroke};
use treesynth::presets::{self, Season};
use treesynth::preview::{Camera, Preview, RayCaster};
use treesynth::radius::{PipeModel, Stout, Taper, Variational};
use treesynth::self_organizing::{Habit, Phyllotaxis};
use treesynth::shape::{Import, UpAxis};
use treesynth::species::{self, Request};
use treesynth::surface::blob::Skin;
use treesynth::surface::{Capsules, Implicit, Levels, Material, Polygonizer, Tubes};
use treesynth::texture::Bark;
use treesynth::variational::Level;

/// To text and back; a field that nobody knows is refused; nothing is left out of what is printed.
fn survives<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) {
    let text = serde_json::to_string(value).unwrap();
    let read: T = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
    assert_eq!(read, *value, "{text}");
    let mut json = serde_json::to_value(value).unwrap();
    if let Some(fields) = json.as_object_mut() {
        fields.insert("nonesuch".to_owned(), 1.into());
        assert!(serde_json::from_value::<T>(json).is_err(), "{text}");
    }
    let printed = format!("{value:?}");
    assert!(!printed.contains(".."), "something is left out of {printed}");
}

#[test]
fn options_survive_their_text() {
    let foliage = Foliage::new(Leaf::sinuate().with_petiole(0.1)).with_arrangement(Arrangement::Whorled(4));
    survives(&foliage.clone().with_light(Vec3::new(0.1, 0.9, 0.0)).with_disorder(0.7));
    survives(&Tubes::default().with_error(0.01).with_collars(true).with_wind(true));
    survives(&Levels::default().with_count(5));
    survives(&Capsules::default().with_tolerance(0.1));
    survives(&Implicit::default().with_voxel(0.1));
    survives(&Polygonizer::default().with_colors(true));
    survives(&Material::bark().with_double_sided(true));
    survives(&Camera::default().with_azimuth(0.3));
    survives(&Preview::default().with_size(120, 80).with_ground_color([0.1, 0.2, 0.3]));
    survives(&RayCaster::new(Preview::default()).with_shadows(false));
    survives(&Axes::default().with_up(UpAxis::Z).with_unit(0.001));
    let tree = presets::by_name("figure-06b").unwrap().guided().unwrap().synth(300).synthesize(1).unwrap();
    let breeze = Breeze::of(&tree).unwrap().with_bones(9).with_gust(Vec3::Z * 0.2);
    survives(&GlbOptions::default().with_name("elm").with_coverages([0.5, 0.0]).with_breeze(breeze));
    survives(&SvgOptions::default().with_thinnest(0.3));
    survives(&Bark::pine().with_age(0.4));
    survives(&Impostor::default().with_grid(5));
    survives(
        &AssetBuilder::default()
            .with_foliage(foliage)
            .with_triangles(Some(9_000))
            .with_tubes(Tubes::default().with_sides(5)),
    );
    survives(&Import::default().with_up(UpAxis::Z).with_offset(DVec3::new(1.0, 2.0, 1.0 / 3.0)));
    survives(&Level::default().with_apical_control(0.4));
    survives(&Skin::default().with_age(7.0));
    let trunk = Stroke::new([Vec3::ZERO, Vec3::Y * 4.0]).with_diameters(0.1, 0.02);
    let limb = Stroke::on(Canvas::front(), [Vec2::Y * 2.0, Vec2::new(0.3, 2.5)]);
    survives(&DrawnLimbs::new(trunk).with_stroke(limb));
    survives(&Leader::new(Vec3::ZERO, Vec3::Y));
    survives(&Shedding::new().with_bare_end(0.3));
    survives(&Habit::default().with_phyllotaxis(Phyllotaxis::Spiral { divergence: 2.0 }));
    survives(&Architecture::spruce().with_years(7));
    survives(&Stout::new(Taper::new(PipeModel::default().with_tip_diameter(0.003)), 0.02));
    survives(&Variational::guided([Vec3::X, Vec3::Y], 3.0));
}

#[test]
fn requests_survive_their_text() {
    let oak = species::by_name("English oak").unwrap();
    survives(&oak.request());
    survives(&oak.request().with_height(9.0).with_dbh(0.3).with_day(280.0).with_seed(7).in_a_stand(4.0));
    survives(&oak.request().with_age(40.0).with_years_dead(3.0).with_storm_damage(0.4));
    let mut own = oak.clone();
    own.limbs.crooked *= 2.0;
    let request = own.request().with_height(9.0);
    survives(&request);
    let text = serde_json::to_string(&request).unwrap();
    assert_eq!(serde_json::from_str::<Request>(&text).unwrap().species(), &own);
    let text = serde_json::to_string(&oak.request()).unwrap();
    assert!(text.contains(r#""species":"English oak""#), "{text}");
    // What would come back as another is refused.
    assert!(serde_json::to_string(&oak.request().with_height(f32::NAN)).is_err());
    let mut odd = oak.clone();
    odd.limbs.crooked = 1e9;
    let error = serde_json::to_string(&odd.request()).unwrap_err().to_string();
    assert!(error.contains("limbs.crooked"), "{error}");
    let error = serde_json::from_str::<Request>(&text.replace("English oak", "Englisch oak")).unwrap_err();
    assert!(error.to_string().contains("English oak"), "{error}");
}

#[test]
fn what_is_set_can_be_read() {
    let foliage = Foliage::new(Leaf::ovate()).with_size(0.3).with_arrangement(Arrangement::Alternate);
    assert_eq!((foliage.size(), foliage.arrangement()), (0.3, Arrangement::Alternate));
    let tubes = Tubes::default().with_sides(9).with_error(0.02);
    assert_eq!((tubes.sides(), tubes.error()), (9, Some(0.02)));
    let habit = Habit::default().with_tropism(Vec3::NEG_Y, 0.3);
    assert_eq!((habit.tropism(), habit.tropism_weight()), (Vec3::NEG_Y, 0.3));
    let builder = AssetBuilder::default().with_tubes(tubes.clone()).with_kinds(3);
    assert_eq!((builder.tubes(), builder.kinds(), builder.foliage()), (&tubes, 3, None));
    let kind = Architecture::cottonwood().with_forking(0.25);
    assert_eq!(kind.forking(), 0.25);
    assert_eq!(kind.clone().with_height(kind.branch_scale().clone()).height(), kind.branch_scale());
}

/// "Leaves a fifth larger" on any preset that has some.
#[test]
fn a_presets_leaves_can_be_a_fifth_larger() {
    let mut in_leaf = 0;
    for preset in presets::guided() {
        let Some(foliage) = preset.foliage(Season::Summer) else { continue };
        let larger = foliage.clone().with_size(foliage.size() * 1.2);
        let tree = preset.synth(1_000).synthesize(preset.seed).unwrap();
        let (own, theirs) = (foliage.place(&tree, 1).unwrap(), larger.place(&tree, 1).unwrap());
        assert_eq!(own.instances.len(), theirs.instances.len(), "{}", preset.name);
        for (one, other) in own.instances.iter().zip(&theirs.instances) {
            assert!((other.scale / one.scale - 1.2).abs() < 1e-4, "{}", preset.name);
        }
        in_leaf += 1;
    }
    assert!(in_leaf > 40);
    let stand = presets::by_name("stand-decurrent").unwrap().stand().unwrap();
    let foliage = stand.foliage(Season::Summer).unwrap();
    assert!(foliage.size() > 0.0 && stand.foliage(Season::Winter).is_none());
}
