//! Long work can be watched, and stopped within some 50 ms of work: asked of each by counting its reports, not by a clock.

use std::io::{Write, sink};
use std::ops::ControlFlow;
use std::sync::Mutex;
use treesynth::export::{
    ExportError, GlbOptions, PlyFormat, UsdStage, Watched, write_glb_parts, write_obj, write_ply, write_stl,
    write_usda, write_usdz,
};
use treesynth::foliage::{Foliage, FoliageError, Leaf, Leaves};
use treesynth::growth::{Architecture, Growth, GrowthError};
use treesynth::surface::blob::{BlobError, Skin};
use treesynth::surface::{Implicit, Levels, Part, Polygonizer, SurfaceError, Tubes};
use treesynth::{Observer, Progress, Silent, Skeleton, Work, presets};

/// Remembers what it is told, and breaks off at the `last` report.
struct Counter {
    told: Mutex<Vec<Progress>>,
    last: usize,
}

impl Counter {
    fn new(last: usize) -> Self {
        Self { told: Mutex::new(Vec::new()), last }
    }

    fn told(self) -> Vec<Progress> {
        self.told.into_inner().unwrap()
    }
}

impl Observer for Counter {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        let mut told = self.told.lock().unwrap();
        told.push(progress);
        if told.len() >= self.last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// The end of some work.
enum End {
    /// It went to its end, over so many units of what it makes.
    Done(usize),
    Cancelled,
}

/// A kind of work: its name, how many units of what it makes take 50 ms at the most, and the work.
type Kind<'a> = (&'static str, usize, Box<dyn Fn(&dyn Observer) -> End + 'a>);

fn tree() -> Skeleton {
    let preset = presets::by_name("figure-17e").unwrap().guided().unwrap();
    preset.synth(1500).synthesize(1).unwrap().relaxed(0.5, 2).unwrap()
}

fn thick() -> Skeleton {
    let tree = tree();
    let radii = tree.radii().iter().map(|radius| radius.max(0.03)).collect();
    tree.with_radii(radii).unwrap()
}

fn surface<T>(made: Result<T, SurfaceError>, units: impl Fn(&T) -> usize) -> End {
    match made {
        Err(SurfaceError::Cancelled) => End::Cancelled,
        made => End::Done(units(&made.unwrap())),
    }
}

fn file(written: Result<(), ExportError>, bytes: u64) -> End {
    match written {
        Err(ExportError::Cancelled) => End::Cancelled,
        written => {
            written.unwrap();
            End::Done(usize::try_from(bytes).unwrap())
        }
    }
}

/// Breaks the work off at several reports: it ends at once, and says so.
fn asked_of((name, at_most, work): &Kind<'_>) {
    let all = Counter::new(usize::MAX);
    let End::Done(units) = work(&all) else { panic!("{name} was not cancelled") };
    let told = all.told();
    assert!(told.len() > 1, "{name} reports once");
    assert!(
        told.len() * at_most >= units,
        "{name}: {} reports of {units} units, which may be {at_most} each",
        told.len()
    );
    for pair in told.windows(2) {
        if pair[0].work == pair[1].work {
            assert!(pair[0].fraction <= pair[1].fraction, "{name}: {pair:?}");
        } else {
            assert!((pair[0].fraction - 1.0).abs() < 1e-7, "{name}: {pair:?}");
        }
    }
    assert!((told[told.len() - 1].fraction - 1.0).abs() < 1e-7, "{name}: {:?}", told.last());
    let middle = told.len() / 2;
    for last in [1, 2, middle, told.len() * 3 / 4].into_iter().filter(|&last| last > 0 && last < told.len()) {
        let some = Counter::new(last);
        assert!(matches!(work(&some), End::Cancelled), "{name} goes on after report {last}");
        assert_eq!(some.told().len(), last, "{name} reports after it was cancelled");
    }
}

#[test]
fn surfaces() {
    let (tree, thick) = (tree(), thick());
    let skin = Skin::default().blob_tree(&thick).unwrap();
    let vertices = |mesh: &treesynth::surface::Mesh| mesh.positions.len();
    let kinds: Vec<Kind<'_>> = vec![
        ("Implicit", 20_000, Box::new(|o| surface(Implicit::default().mesh_observed(&thick, o), vertices))),
        (
            "Implicit in the wind",
            20_000,
            Box::new(|o| surface(Implicit::default().with_wind(true).mesh_observed(&thick, o), vertices)),
        ),
        (
            "Implicit of longer triangles",
            10_000,
            Box::new(|o| surface(Implicit::default().with_error(0.15).mesh_observed(&thick, o), vertices)),
        ),
        (
            "Polygonizer",
            10_000,
            Box::new(|o| surface(Polygonizer::default().with_voxel(0.03).mesh_observed(&skin, o), vertices)),
        ),
        (
            "Polygonizer with detail",
            10_000,
            Box::new(|o| surface(Polygonizer::default().with_detail(1.0).mesh_observed(&skin, o), vertices)),
        ),
        (
            "Tubes",
            100_000,
            Box::new(|o| {
                surface(
                    Tubes::default().with_sides(512).with_least_sides(64).mesh_observed(&tree, o),
                    vertices,
                )
            }),
        ),
        (
            "Levels",
            100_000,
            Box::new(|o| {
                surface(Levels::default().of_observed(&tree, o), |levels| {
                    levels.iter().map(|level| level.mesh.positions.len()).sum()
                })
            }),
        ),
        (
            "Skin",
            5_000,
            Box::new(|o| match Skin::default().blob_tree_observed(&thick, o) {
                Err(BlobError::Cancelled) => End::Cancelled,
                made => End::Done(made.unwrap().primitives()),
            }),
        ),
    ];
    kinds.iter().for_each(asked_of);
}

#[test]
fn trees_and_leaves() {
    let tree = tree();
    let foliage = Foliage::new(Leaf::ovate()).with_spacing(0.005);
    let growth = Growth::new(Architecture::cottonwood(), 1).unwrap();
    let kinds: Vec<Kind<'_>> = vec![
        (
            "Foliage",
            20_000,
            Box::new(|o| match foliage.place_observed(&tree, 1, o) {
                Err(FoliageError::Cancelled) => End::Cancelled,
                made => End::Done(made.unwrap().instances.len()),
            }),
        ),
        (
            "Growth",
            20_000,
            Box::new(|o| {
                match Growth::with_most_nodes_observed(Architecture::cottonwood(), 1, 4_000_000, o) {
                    Err(GrowthError::Cancelled) => End::Cancelled,
                    made => End::Done(made.unwrap().branches()),
                }
            }),
        ),
        (
            "Growth at an age",
            20_000,
            Box::new(|o| match growth.at_observed(20.5, o) {
                Err(GrowthError::Cancelled) => End::Cancelled,
                made => End::Done(made.unwrap().skeleton.len()),
            }),
        ),
    ];
    kinds.iter().for_each(asked_of);
}

#[cfg(feature = "texture")]
#[test]
fn assets() {
    use treesynth::asset::{Asset, AssetBuilder, AssetError, Impostor};
    let tree = tree();
    let builder = AssetBuilder::default()
        .with_foliage(Foliage::new(Leaf::ovate()))
        .with_texture_size(256)
        .with_triangles(Some(4_000));
    let asset = |made: Result<Asset, AssetError>| match made {
        Err(AssetError::Cancelled) => End::Cancelled,
        made => End::Done(made.unwrap().triangles()),
    };
    let whole = builder.build(&tree, 1).unwrap();
    let parts = whole.parts();
    let kinds: Vec<Kind<'_>> = vec![
        ("AssetBuilder", 1_000, Box::new(|o| asset(builder.build_observed(&tree, 1, o)))),
        (
            "AssetBuilder's levels",
            1_000,
            Box::new(|o| match builder.levels_observed(&tree, 1, &[1.0, 0.3], o) {
                Err(AssetError::Cancelled) => End::Cancelled,
                made => End::Done(made.unwrap().iter().map(Asset::triangles).sum()),
            }),
        ),
        (
            "Impostor",
            1_000,
            Box::new(|o| asset(Impostor::default().with_texture_size(256).billboards_observed(&parts, o))),
        ),
        (
            "octahedral Impostor",
            1_000,
            Box::new(|o| {
                let views = Impostor::default().with_texture_size(256).with_grid(4);
                match views.octahedral_observed(&parts, o) {
                    Err(AssetError::Cancelled) => End::Cancelled,
                    made => {
                        made.unwrap();
                        End::Done(16)
                    }
                }
            }),
        ),
    ];
    kinds.iter().for_each(asked_of);
}

/// Has something write through a watched writer.
fn written(observer: &dyn Observer, write: impl Fn(&mut dyn Write) -> Result<(), ExportError>) -> End {
    let mut writer = Watched::new(sink(), observer);
    let result = write(&mut writer);
    file(result, writer.written())
}

#[test]
fn files() {
    let tree = tree();
    let bark = Tubes::default().with_sides(32).mesh(&tree).unwrap();
    let leaves: Leaves = Foliage::new(Leaf::ovate()).place(&tree, 1).unwrap();
    let parts = [Part::new(&bark), leaves.part()];
    let most = 1 << 17;
    let kinds: Vec<Kind<'_>> = vec![
        ("GLB", most, Box::new(|o| written(o, |w| write_glb_parts(&parts, &GlbOptions::default(), w)))),
        ("OBJ", most, Box::new(|o| written(o, |w| write_obj(&parts, "a.mtl", w)))),
        ("PLY", most, Box::new(|o| written(o, |w| write_ply(&parts, PlyFormat::Binary, w)))),
        ("text PLY", most, Box::new(|o| written(o, |w| write_ply(&parts, PlyFormat::Ascii, w)))),
        ("STL", most, Box::new(|o| written(o, |w| write_stl(&parts, w)))),
        ("USDA", most, Box::new(|o| written(o, |w| write_usda(&UsdStage::of_parts(&parts), w)))),
        ("USDZ", most, Box::new(|o| written(o, |w| write_usdz(&UsdStage::of_parts(&parts), w)))),
    ];
    kinds.iter().for_each(asked_of);
}

#[cfg(feature = "json")]
#[test]
fn skeletons_as_text() {
    let tree = tree();
    let kind: Kind<'_> =
        ("JSON", 1 << 17, Box::new(|o| written(o, |w| treesynth::export::write_skeleton(&tree, w))));
    asked_of(&kind);
}

/// The result is the same with an observer and without.
#[test]
fn watching_changes_nothing() {
    let tree = thick();
    let counter = Counter::new(usize::MAX);
    assert_eq!(Implicit::default().mesh_observed(&tree, &counter), Implicit::default().mesh(&tree));
    assert_eq!(Levels::default().of_observed(&tree, &counter), Levels::default().of(&tree));
    let leaves = Foliage::new(Leaf::ovate());
    assert_eq!(leaves.place_observed(&tree, 1, &counter), leaves.place(&tree, 1));
    let told = counter.told();
    assert!(told.iter().any(|p| p.work == Work::Surface) && told.iter().any(|p| p.work == Work::Leaves));
    assert!(Tubes::default().mesh_observed(&tree, &Silent).is_ok());
}
