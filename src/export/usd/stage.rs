//! The text of a stage.

use super::material::Look;
use super::prim::{self, identifier};
use super::{Content, UsdStage};
use crate::export::Axes;
use crate::export::images::Uses;
use crate::export::pool::Pool;
use crate::shape::UpAxis;
use crate::surface::{Instance, Mesh, Part, Transform};
use glam::Vec3;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// All that is written.
pub(super) struct Layer<'s, 'a> {
    stage: &'s UsdStage<'a>,
    uses: &'s Uses<'a>,
    root: String,
    /// Axes without the origin, which is in the root's transform.
    axes: Axes,
    /// For a scene, the trees that differ, and the number of the tree of each asset.
    kinds: Vec<Tree<'a>>,
    assets: Vec<usize>,
}

/// Parts with their numbers among all.
type Tree<'a> = Vec<(usize, Part<'a>)>;

/// Key by which equal parts are found.
#[derive(PartialEq)]
struct Gist {
    mesh: usize,
    copies: Option<usize>,
    transform: Transform,
    look: Look,
}

/// The materials of a prim's scope, and names that are taken in it.
struct Looks {
    looks: Vec<(Look, String)>,
}

/// Names for prims side by side.
#[derive(Default)]
struct Names(BTreeMap<String, u32>);

impl Names {
    fn fresh(&mut self, name: &str) -> String {
        let word = identifier(name);
        let mut found = word.clone();
        while self.0.contains_key(&found) {
            let count = self.0.entry(word.clone()).or_insert(1);
            *count += 1;
            found = format!("{word}_{count}");
        }
        self.0.insert(found.clone(), 1);
        found
    }
}

fn seen<'a>(first: usize, parts: &[Part<'a>]) -> Tree<'a> {
    let all = parts.iter().enumerate().map(|(index, part)| (first + index, *part));
    all.filter(|(_, part)| part.triangles() > 0).collect()
}

impl<'s, 'a> Layer<'s, 'a> {
    pub(super) fn new(stage: &'s UsdStage<'a>, uses: &'s Uses<'a>) -> Self {
        let (kinds, assets) = kinds(stage, uses);
        let axes = stage.axes.with_origin(Vec3::ZERO);
        Self { stage, uses, root: identifier(&stage.name), axes, kinds, assets }
    }

    pub(super) fn write(&self, writer: &mut impl Write) -> io::Result<()> {
        let up = if self.axes.up() == UpAxis::Z { "Z" } else { "Y" };
        let root = &self.root;
        writeln!(writer, "#usda 1.0\n(\ndefaultPrim = \"{root}\"\ndoc = \"treesynth\"")?;
        writeln!(writer, "metersPerUnit = {}\nupAxis = \"{up}\"\n)", self.axes.unit())?;
        match &self.stage.content {
            Content::Parts(parts) => {
                writeln!(writer, "def Xform \"{root}\" (\nkind = \"component\"\n)\n{{")?;
                self.home(writer)?;
                self.tree(writer, &format!("/{root}"), &seen(0, parts))?;
                writeln!(writer, "}}")
            }
            Content::Variants(set, variants) => self.variants(writer, set, variants),
            Content::Scene(scene) => {
                let mut names = Names::default();
                let _ = names.fresh(root);
                let kinds: Vec<_> = self.kinds.iter().map(|_| names.fresh("Kind")).collect();
                for (kind, name) in self.kinds.iter().zip(&kinds) {
                    writeln!(writer, "class Xform \"{name}\" (\nkind = \"component\"\n)\n{{")?;
                    self.tree(writer, &format!("/{name}"), kind)?;
                    writeln!(writer, "}}")?;
                }
                writeln!(writer, "def Xform \"{root}\" (\nkind = \"group\"\n)\n{{")?;
                self.home(writer)?;
                let mut names = Names::default();
                let assets = scene.assets().iter().filter(|asset| asset.parts().iter().any(has_triangles));
                for (asset, &kind) in assets.zip(&self.assets) {
                    let name = names.fresh(asset.name());
                    let kind = &kinds[kind];
                    writeln!(
                        writer,
                        "def Xform \"{name}\" (\ninstanceable = true\nprepend references = </{kind}>\n)\n{{"
                    )?;
                    prim::operations(writer, asset.transform(), self.axes)?;
                    writeln!(writer, "}}")?;
                }
                writeln!(writer, "}}")
            }
        }
    }

    /// Takes the chosen origin to zero.
    fn home(&self, writer: &mut impl Write) -> io::Result<()> {
        let place = self.stage.axes.placed(Vec3::ZERO);
        if place == Vec3::ZERO {
            return Ok(());
        }
        let [x, y, z] = place.to_array();
        writeln!(writer, "double3 xformOp:translate = ({x}, {y}, {z})")?;
        writeln!(writer, "uniform token[] xformOpOrder = [\"xformOp:translate\"]")
    }

    fn variants(
        &self,
        writer: &mut impl Write,
        set: &str,
        variants: &[(String, Vec<Part<'a>>)],
    ) -> io::Result<()> {
        let root = &self.root;
        writeln!(writer, "def Xform \"{root}\" (\nkind = \"component\"")?;
        writeln!(writer, "variants = {{\nstring {set} = \"{}\"\n}}", variants[0].0)?;
        writeln!(writer, "prepend variantSets = \"{set}\"\n)\n{{")?;
        self.home(writer)?;
        let mut first = 0;
        let mut trees = Vec::new();
        for (name, parts) in variants {
            trees.push((name, seen(first, parts)));
            first += parts.len();
        }
        let path = format!("/{root}");
        let all = trees.iter().flat_map(|(_, tree)| tree);
        let looks = self.looks(writer, &path, all)?;
        writeln!(writer, "variantSet \"{set}\" = {{")?;
        for (name, tree) in &trees {
            writeln!(writer, "\"{name}\" {{")?;
            self.prims(writer, &path, tree, &looks)?;
            writeln!(writer, "}}")?;
        }
        writeln!(writer, "}}\n}}")
    }

    /// Materials and parts below a prim.
    fn tree(&self, writer: &mut impl Write, path: &str, tree: &Tree<'a>) -> io::Result<()> {
        let looks = self.looks(writer, path, tree)?;
        self.prims(writer, path, tree, &looks)
    }

    fn looks<'t>(
        &self,
        writer: &mut impl Write,
        path: &str,
        parts: impl IntoIterator<Item = &'t (usize, Part<'a>)>,
    ) -> io::Result<Looks>
    where
        'a: 't,
    {
        let mut names = Names::default();
        let mut looks: Vec<(Look, String)> = Vec::new();
        writeln!(writer, "def Scope \"Looks\"\n{{")?;
        for (index, part) in parts {
            let look = Look::of(part, *index, self.uses);
            if !looks.iter().any(|(other, _)| *other == look) {
                let name = names.fresh(part.name());
                let path = format!("{path}/Looks/{name}");
                look.write(writer, &path, &name)?;
                looks.push((look, path));
            }
        }
        writeln!(writer, "}}")?;
        Ok(Looks { looks })
    }

    fn prims(&self, writer: &mut impl Write, path: &str, tree: &Tree<'a>, looks: &Looks) -> io::Result<()> {
        let mut names = Names::default();
        let _ = names.fresh("Looks");
        for (index, part) in tree {
            let look = Look::of(part, *index, self.uses);
            let material =
                looks.looks.iter().find(|(other, _)| *other == look).map_or("", |(_, path)| path.as_str());
            let name = names.fresh(part.name());
            prim::write(writer, part, (&format!("{path}/{name}"), &name), material, self.axes)?;
        }
        Ok(())
    }
}

fn has_triangles(part: &Part<'_>) -> bool {
    part.triangles() > 0
}

/// The trees of a scene that differ, and which of them each asset is, leaving out what has no triangles.
fn kinds<'a>(stage: &UsdStage<'a>, uses: &Uses<'a>) -> (Vec<Tree<'a>>, Vec<usize>) {
    let mut kinds = Vec::new();
    let mut assets = Vec::new();
    let Content::Scene(scene) = &stage.content else { return (kinds, assets) };
    let mut meshes = Pool::<'a, Mesh>::new();
    let mut copies = Pool::<'a, [Instance]>::new();
    let mut gists: Vec<Vec<Gist>> = Vec::new();
    let mut first = 0;
    for asset in scene.assets() {
        let tree = seen(first, asset.parts());
        first += asset.parts().len();
        if tree.is_empty() {
            continue;
        }
        let gist = |(index, part): &(usize, Part<'a>)| Gist {
            mesh: meshes.index(part.mesh()),
            copies: part.instances().map(|instances| copies.index(instances)),
            transform: part.transform(),
            look: Look::of(part, *index, uses),
        };
        let gist: Vec<_> = tree.iter().map(gist).collect();
        let kind = gists.iter().position(|other| *other == gist).unwrap_or_else(|| {
            kinds.push(tree);
            gists.push(gist);
            gists.len() - 1
        });
        assets.push(kind);
    }
    (kinds, assets)
}
