//! Results to compare: a file, an image or the numbers themselves.

use crate::hash::Hash;
use std::error::Error;
use std::io::Write as _;
use treesynth::asset::{AssetBuilder, Impostor};
use treesynth::cloud::{Frame, PlyEncoding};
use treesynth::export::{self, GlbOptions, PlyFormat, SvgOptions, UsdStage};
use treesynth::foliage::{Foliage, Leaf, Leaves};
use treesynth::glam::Vec3;
use treesynth::guided::{
    Edges, GradedYao, Graph, Lattice, NearSurface, PointCloud, PoissonDelaunay, PoissonSurface, PoissonYao,
};
use treesynth::presets::{self, Found, Season};
use treesynth::preview::{Preview, RayCaster};
use treesynth::reconstruct::Reconstruct;
use treesynth::scan::Scanner;
use treesynth::self_organizing::Environment;
use treesynth::shape::{Cuboid, HalfEllipsoid, Outline, TriangleMesh};
use treesynth::surface::{Implicit, Levels, Mask, Material, Mesh, Part, Polygonizer, Sway, Tubes, blob};
use treesynth::texture::{Bark, BarkKind};
use treesynth::{Forest, GraphBuilder, Metrics, Shape as _, Silent, Skeleton, format, species};

type Outcome = Result<(), Box<dyn Error>>;

/// One thing.
pub struct Made {
    pub name: String,
    /// Makes it and hashes every bit.
    pub hash: Box<dyn Fn() -> Result<u64, Box<dyn Error>>>,
}

fn made(name: impl Into<String>, make: impl Fn(&mut Hash) -> Outcome + 'static) -> Made {
    let hash = move || {
        let mut hash = Hash::default();
        make(&mut hash)?;
        Ok(hash.0)
    };
    Made { name: name.into(), hash: Box::new(hash) }
}

/// All of them, always in the same order.
pub fn all() -> Vec<Made> {
    let mut list: Vec<Made> = presets::all().map(of_preset).collect();
    list.extend(graphs());
    list.extend(surfaces());
    list.extend(pictures());
    list.extend(files());
    list
}

fn of_preset(found: Found) -> Made {
    let name = format!("preset {}", found.name());
    match found {
        Found::Guided(preset) => {
            made(name, |out| Ok(export::write_skeleton(&preset.synth(3_000).synthesize(preset.seed)?, out)?))
        }
        Found::Stand(stand) => made(name, |out| {
            let mut forest = stand.plant(stand.seed)?;
            for _ in 0..5 {
                forest.step()?;
                stand.tend(&mut forest)?;
            }
            of_forest(&forest, out)
        }),
        Found::Space(stand) => made(name, |out| {
            let mut forest = stand.plant(stand.seed)?;
            for _ in 0..5 {
                forest.step()?;
                stand.tend(&mut forest)?;
            }
            of_forest(&forest, out)
        }),
        Found::Variational(preset) => {
            made(name, |out| Ok(export::write_skeleton(&preset.synth(500)?.synthesize(preset.seed)?, out)?))
        }
        Found::Grown(preset) => made(name, |out| {
            let tree = preset.grow(preset.seed)?.at(preset.ages[0])?;
            preset.leaves(&tree).iter().for_each(|leaves| of_leaves(leaves, out));
            Ok(export::write_skeleton(&tree.skeleton, out)?)
        }),
        Found::Species(species) => made(name, |out| {
            let tree = species.request().with_height(3.0).with_seed(1).grow()?;
            tree.foliage().for_each(|leaves| of_leaves(leaves, out));
            Ok(export::write_skeleton(&tree.skeleton, out)?)
        }),
        other => made(name, move |_| Err(format!("there is no work for {:?}", other.system()).into())),
    }
}

fn of_forest<E: Environment>(forest: &Forest<E>, out: &mut Hash) -> Outcome {
    for tree in forest.trees() {
        out.bytes(&tree.number().to_le_bytes());
        out.numbers(tree.positions().flat_map(|place| place.to_array()).chain([tree.vigor()]));
    }
    Ok(())
}

fn of_leaves(leaves: &Leaves, out: &mut Hash) {
    for leaf in &leaves.instances {
        out.numbers(leaf.position.to_array().into_iter().chain(leaf.rotation.to_array()).chain([leaf.scale]));
    }
}

fn of_mesh(mesh: &Mesh, out: &mut Hash) {
    out.numbers(mesh.positions.iter().chain(&mesh.normals).flat_map(Vec3::to_array));
    out.numbers(mesh.tangents.iter().flat_map(|tangent| tangent.to_array()));
    out.numbers(mesh.uvs.iter().flat_map(|uv| uv.to_array()));
    let wind = mesh.wind.iter().flat_map(|wind| wind.moments.into_iter().chain(wind.axes));
    out.numbers(wind.flat_map(|vector| vector.to_array()));
    mesh.indices.iter().for_each(|index| out.bytes(&index.to_le_bytes()));
}

fn of_graph(graph: &Graph, out: &mut Hash) {
    out.numbers(graph.positions().iter().flat_map(Vec3::to_array));
    for node in 0..graph.nodes() as u32 {
        graph.neighbours(node).iter().for_each(|other| out.bytes(&other.to_le_bytes()));
    }
}

fn graphs() -> Vec<Made> {
    let region = Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0));
    let dome = HalfEllipsoid::new(Vec3::ZERO, Vec3::new(3.0, 2.0, 5.0));
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y, Vec3::Y + Vec3::Z, Vec3::Z];
    let walls = PoissonSurface::new(corners, vec![[0, 1, 2], [0, 2, 3], [5, 0, 3], [5, 3, 4]]);
    let points = || -> Vec<Vec3> {
        let cell = |i: u32| ((i * 7_919) % 1_009) as f32 / 1_009.0;
        (0..500).map(|i| Vec3::new(cell(i), cell(i + 300), cell(i + 600)) * 3.0).collect()
    };
    let builders: [(&str, Box<dyn GraphBuilder>); 9] = [
        ("surface", Box::new(walls.with_nodes(1_000))),
        ("delaunay", Box::new(PoissonDelaunay::new(region).with_nodes(1_000))),
        ("poisson", Box::new(PoissonYao::new(region).with_nodes(3_000))),
        ("dome", Box::new(PoissonYao::new(dome).with_nodes(3_000).with_sectors(12))),
        ("plane", Box::new(PoissonYao::new(region).with_nodes(3_000).planar())),
        ("graded", Box::new(GradedYao::new(region, NearSurface::new(dome, 1.0, 5.0, 2.0)).with_nodes(3_000))),
        ("lattice", Box::new(Lattice::new(region, 0.5))),
        ("cloud", Box::new(PointCloud::new(points(), Edges::Yao(8)))),
        ("nearest", Box::new(PointCloud::new(points(), Edges::Nearest(9)))),
    ];
    let of = |(name, builder): (&str, Box<dyn GraphBuilder>)| {
        made(format!("graph {name}"), move |out| {
            of_graph(&builder.build(5, &Silent)?, out);
            Ok(())
        })
    };
    builders.into_iter().map(of).collect()
}

/// A tree of the guided system, smoothed.
fn tree(name: &str) -> Result<Skeleton, Box<dyn Error>> {
    let preset = presets::by_name(name)?.guided()?;
    Ok(preset.synth(3_000).synthesize(preset.seed)?.relaxed(0.5, 3)?)
}

fn leaves(name: &str) -> Result<Leaves, Box<dyn Error>> {
    let preset = presets::by_name(name)?.guided()?;
    let foliage = preset.foliage(Season::Summer).ok_or("it has no leaves")?;
    Ok(foliage.place(&tree(name)?, preset.seed)?)
}

fn surfaces() -> Vec<Made> {
    let mut list = vec![
        made("surface tubes", |out| {
            of_mesh(&Tubes::default().with_closed_base(true).with_wind(true).mesh(&tree("figure-18")?)?, out);
            Ok(())
        }),
        made("surface tubes of an error", |out| {
            of_mesh(&Tubes::default().with_error(0.002).mesh(&tree("figure-18")?)?, out);
            Ok(())
        }),
        made("surface levels", |out| {
            for level in Levels::default().of(&tree("figure-06c")?)? {
                out.numbers([level.error]);
                of_mesh(&level.mesh, out);
            }
            Ok(())
        }),
        made("surface implicit", |out| {
            of_mesh(&Implicit::default().with_voxel(0.03).with_error(0.1).mesh(&tree("figure-06c")?)?, out);
            Ok(())
        }),
        made("leaves of a preset", |out| {
            of_leaves(&leaves("figure-06c")?, out);
            Ok(())
        }),
        made("leaves, spiral", |out| {
            let foliage = Foliage::new(Leaf::ovate()).with_thickest(0.1);
            of_leaves(&foliage.place(&tree("figure-07")?, 2)?, out);
            Ok(())
        }),
        made("metrics", |out| Ok(write!(out, "{:?}", Metrics::of(&tree("figure-07")?))?)),
    ];
    list.extend(blob::presets().filter(|preset| preset.name != "blob-07-10").map(|preset| {
        made(format!("solid {}", preset.name), move |out| {
            let solid = preset.blob_tree()?;
            of_mesh(&Polygonizer::default().with_voxel(0.01).with_colors(true).mesh(&solid)?, out);
            Ok(())
        })
    }));
    list
}

fn pictures() -> Vec<Made> {
    let mut list: Vec<Made> = BarkKind::ALL
        .into_iter()
        .map(|kind| {
            made(format!("bark {kind:?}"), move |out| {
                let bark = Bark::of_kind(kind).with_seed(7).with_resolution(64).bake()?;
                Ok(write!(out, "{bark:?}")?)
            })
        })
        .collect();
    list.extend([
        made("picture of bark and leaves", |out| {
            let (bark, leaves) = (Tubes::default().mesh(&tree("figure-06c")?)?, leaves("figure-06c")?);
            let parts = [Part::new(&bark), leaves.part()];
            let picture = Preview::default().with_size(120, 160).draw_parts(&parts)?;
            picture.pixels().iter().for_each(|pixel| out.bytes(pixel));
            Ok(picture.write_png(out)?)
        }),
        made("picture of a solid", |out| {
            let solid = blob::by_name("blob-07-04").ok_or("no such solid")?.blob_tree()?;
            let preview = Preview::default().with_size(80, 80);
            let picture = RayCaster::new(preview).draw(&solid, &[], &Silent)?;
            picture.pixels().iter().for_each(|pixel| out.bytes(pixel));
            Ok(())
        }),
        made("asset of a species, GLB with images", |out| {
            let species = species::by_name("silver birch")?;
            let tree = species.request().with_height(4.0).with_seed(1).grow()?;
            for level in tree.levels_in_wind(Some(4_000), 128, &[1.0, 0.4])? {
                export::write_glb_parts(&level.parts(), &GlbOptions::default(), &mut *out)?;
            }
            Ok(())
        }),
        made("asset of a preset, USDZ with snow", |out| {
            let skeleton = tree("figure-06c")?;
            let builder = AssetBuilder::default()
                .with_triangles(Some(5_000))
                .with_texture_size(128)
                .with_foliage(Foliage::new(Leaf::ovate()).with_thickest(0.1))
                .with_bark_of(&Bark::of_kind(BarkKind::ALL[0]).with_resolution(64))?;
            let asset = builder.build(&skeleton, 3)?;
            Ok(export::write_usdz(&UsdStage::of_parts(&asset.parts()), out)?)
        }),
        made("impostors", |out| {
            let (bark, leaves) = (Tubes::default().mesh(&tree("figure-06c")?)?, leaves("figure-06c")?);
            let parts = [Part::new(&bark), leaves.part()];
            let impostor = Impostor::default().with_texture_size(128).with_grid(4);
            export::write_glb_parts(
                &impostor.billboards(&parts)?.parts(),
                &GlbOptions::default(),
                &mut *out,
            )?;
            let octahedral = impostor.octahedral(&parts)?;
            Ok(write!(out, "{}", octahedral.json())?)
        }),
        made("snow", |out| {
            let bark = Tubes::default().mesh(&tree("figure-06c")?)?;
            Ok(write!(out, "{:?}", Mask::snow().values(&bark))?)
        }),
    ]);
    list
}

fn files() -> Vec<Made> {
    let parts = |out: &mut Hash, write: fn(&[Part<'_>], &mut Hash) -> Outcome| -> Outcome {
        let skeleton = tree("figure-07")?;
        let mut bark = Tubes::default().with_wind(true).mesh(&skeleton)?;
        Sway::of(&skeleton)?.clothe(&mut bark);
        let leaves = leaves("figure-07")?;
        write(&[Part::new(&bark).with_material(Material::white()), leaves.part()], out)
    };
    let writers: [(&str, fn(&[Part<'_>], &mut Hash) -> Outcome); 6] = [
        ("GLB", |parts, out| Ok(export::write_glb_parts(parts, &GlbOptions::default(), out)?)),
        ("GLB, quantized", |parts, out| {
            Ok(export::write_glb_parts(parts, &GlbOptions::default().with_quantization(true), out)?)
        }),
        ("OBJ", |parts, out| Ok(export::write_obj(parts, "tree.mtl", out)?)),
        ("PLY", |parts, out| Ok(export::write_ply(parts, PlyFormat::Binary, out)?)),
        ("STL", |parts, out| Ok(export::write_stl(parts, out)?)),
        ("USDA", |parts, out| Ok(export::write_usda(&UsdStage::of_parts(parts), out)?)),
    ];
    let mut list: Vec<Made> = writers
        .into_iter()
        .map(|(name, write)| made(format!("file {name}"), move |out| parts(out, write)))
        .collect();
    list.extend([
        made("file SVG", |out| {
            Ok(export::write_svg(&tree("figure-07")?, &SvgOptions::default(), out)?)
        }),
        made("file SWC, MTG, QSM", |out| {
            let (tree, frame) = (tree("figure-07")?, Frame::default());
            format::write_swc(&tree, &frame, &mut *out)?;
            format::write_mtg(&tree, &frame, &mut *out)?;
            Ok(format::write_qsm(&tree, &frame, out)?)
        }),
        made("file of a forest", |out| {
            let Found::Stand(stand) = presets::by_name("stand-generations")? else { return Err("no stand".into()) };
            let mut forest = stand.plant(stand.seed)?;
            (0..4).try_for_each(|_| forest.step().map(|_| ()))?;
            Ok(forest.write_compact(out)?)
        }),
        made("a model and a drawing as shapes", |out| {
            let mut file = Vec::new();
            let crown = Outline::from_svg("<svg xmlns='http://www.w3.org/2000/svg'><path d='M5 9 C-3 3 2 -1 5 2 C8 -1 13 3 5 9Z'/></svg>")?;
            let bark = Implicit::default().with_voxel(0.05).mesh(&tree("figure-06c")?)?;
            export::write_obj(&[Part::new(&bark)], "none.mtl", &mut file)?;
            let model = TriangleMesh::read_obj(&file[..])?;
            let mut random = treesynth::random::stream(9, 0, treesynth::random::Purpose::CUSTOM, 0);
            for _ in 0..200 {
                out.numbers(model.sample(&mut random).unwrap_or(Vec3::ZERO).to_array());
            }
            out.numbers([model.volume()]);
            Ok(write!(out, "{crown:?}")?)
        }),
        made("a scan and the tree made of it", |out| {
            let skeleton = presets::by_name("figure-06c")?.guided()?.synth(1_000).synthesize(1)?;
            let bark = Tubes::default().with_root_flare(0.0).mesh(&skeleton)?;
            let scanner = Scanner::around(Vec3::Y * 1.6, 7.0, 3).with_step(0.004);
            let scan = scanner.scan(&[Part::new(&bark)], 1)?;
            scan.cloud.write_ply(&Frame::default(), PlyEncoding::Little, &mut *out)?;
            Ok(export::write_skeleton(&Reconstruct::default().reconstruct(&scan.cloud)?.skeleton, out)?)
        }),
    ]);
    list
}
