//! The JSON half of a glTF file: what is in it, and which node shows what.

use super::array::{Array, Grid};
use super::buffer::{Buffer, Geometry};
use super::look::Looks;
use super::skin::{Animation, Skins, moves};
use super::text::{entry, escaped, list, numbers, push};
use super::{GlbOptions, Instancing, LevelNodes};
use crate::export::ExportError;
use crate::export::pool::Pool;
use crate::surface::{Instance, Mesh, Part, Scene, Transform};
use std::collections::BTreeMap;

/// Contents of the file, with everything in it named by its index.
pub(super) struct Document<'a> {
    options: GlbOptions,
    buffer: Buffer<'a>,
    looks: Looks<'a>,
    /// The buffer view of the first image.
    images: usize,
    geometries: Vec<Geometry>,
    /// Meshes of the file: a name, a geometry, a material.
    meshes: Vec<(&'a str, usize, usize)>,
    nodes: Vec<String>,
    root: usize,
    extensions: Vec<&'static str>,
    animation: Option<Animation>,
    known: Known<'a>,
}

/// Entries that are in the file already.
struct Known<'a> {
    meshes: Pool<'a, Mesh>,
    copies: Pool<'a, [Instance]>,
    /// Geometries by mesh and merged copies.
    geometries: BTreeMap<(usize, Option<usize>), usize>,
    /// Meshes of the file by geometry and material.
    entries: BTreeMap<(usize, usize), usize>,
    /// The accessors of instances: translation, rotation, scale, tint. They differ by mesh, since its grid is
    /// in them.
    instances: BTreeMap<(usize, usize), Vec<(&'static str, usize)>>,
}

impl<'a> Document<'a> {
    fn new(options: &GlbOptions) -> Self {
        let known = Known {
            meshes: Pool::new(),
            copies: Pool::new(),
            geometries: BTreeMap::new(),
            entries: BTreeMap::new(),
            instances: BTreeMap::new(),
        };
        Self {
            options: options.clone(),
            buffer: Buffer::default(),
            looks: Looks::new(),
            images: 0,
            geometries: Vec::new(),
            meshes: Vec::new(),
            nodes: Vec::new(),
            root: 0,
            extensions: Vec::new(),
            animation: None,
            known,
        }
    }

    /// The document of a tree in at least one level, each with triangles.
    pub(super) fn of_levels(
        levels: &[impl AsRef<[Part<'a>]>],
        options: &GlbOptions,
    ) -> Result<Self, ExportError> {
        let mut document = Self::new(options);
        let home = document.home();
        let named = options.levels == LevelNodes::Named && levels.len() > 1;
        let root = if named { Some(document.node()) } else { None };
        // The levels' nodes come first; then what hangs on them.
        let nodes: Vec<_> = levels.iter().map(|_| document.node()).collect();
        for (index, (level, &node)) in levels.iter().zip(&nodes).enumerate() {
            let name = match (named, index) {
                (true, _) => format!("{}_LOD{index}", options.name),
                (false, 0) => options.name.clone(),
                (false, _) => format!("{}_lod{index}", options.name),
            };
            let transform = if named { Transform::IDENTITY } else { home };
            let mut text = document.group(&name, transform, level.as_ref())?;
            if !named && index == 0 && levels.len() > 1 {
                document.extensions.push("MSFT_lod");
                let ids = list(&nodes[1..], ToString::to_string);
                push(&mut text, format_args!(r#","extensions":{{"MSFT_lod":{{"ids":[{ids}]}}}}"#));
                if !options.coverages.is_empty() {
                    let coverages = numbers(&options.coverages);
                    push(&mut text, format_args!(r#","extras":{{"MSFT_screencoverage":{coverages}}}"#));
                }
            }
            document.nodes[node] = text + "}";
        }
        if let Some(root) = root {
            document.nodes[root] = parent(&options.name, home, &nodes);
        }
        Ok(document.finished())
    }

    /// The document of a tree that a breeze moves: its skinned meshes side by side with its bones, and the
    /// parts that stand still.
    pub(super) fn of_breeze<'b: 'a>(
        parts: &[Part<'b>],
        skins: &'a Skins<'a>,
        options: &GlbOptions,
    ) -> Result<Self, ExportError> {
        let mut document = Self::new(options);
        let root = document.node();
        let (moving, still): (Vec<_>, Vec<_>) =
            parts.iter().filter(|part| part.triangles() > 0).partition(|part| moves(part));
        let first = document.nodes.len();
        document.nodes.extend(skins.nodes(first));
        let mut children = vec![first];
        for part in moving {
            let material = document.looks.material(part);
            let geometry = document.geometry(part.mesh(), None)?;
            // A mesh of two parts has them already.
            let known = document.geometries[geometry].primitives.iter();
            let skinned =
                known.flat_map(|primitive| &primitive.attributes).any(|(name, _)| *name == "JOINTS_0");
            let attributes = skins.attributes(part.mesh()).filter(|_| !skinned);
            for (name, array) in attributes.into_iter().flatten() {
                let accessor = document.buffer.whole(array);
                for primitive in &mut document.geometries[geometry].primitives {
                    primitive.attributes.push((name, accessor));
                }
            }
            let mesh = document.mesh(part.name(), geometry, material);
            children.push(document.nodes.len());
            document.nodes.push(shown(part.name(), mesh, Transform::IDENTITY) + r#","skin":0}"#);
        }
        let others = document.nodes.len();
        for part in still {
            document.part(part)?;
        }
        children.extend(others..document.nodes.len());
        document.nodes[root] = parent(&options.name, document.home(), &children);
        document.animation = Some(Animation {
            first,
            bones: skins.rig.joints.len(),
            inverses: document.buffer.whole(Array::Matrices(&skins.inverses)),
            times: document.buffer.whole(Array::Times(&skins.times)),
            turns: skins.turns.iter().map(|turns| document.buffer.whole(Array::Turns(turns))).collect(),
        });
        Ok(document.finished())
    }

    /// The document of a scene in which something has triangles.
    pub(super) fn of_scene(scene: &Scene<'a>, options: &GlbOptions) -> Result<Self, ExportError> {
        let mut document = Self::new(options);
        let root = document.node();
        let seen = |part: &Part<'_>| part.triangles() > 0;
        let mut nodes = Vec::new();
        for asset in scene.assets().iter().filter(|asset| asset.parts().iter().any(seen)) {
            let node = document.node();
            document.nodes[node] = document.group(asset.name(), asset.transform(), asset.parts())? + "}";
            nodes.push(node);
        }
        document.nodes[root] = parent(&options.name, document.home(), &nodes);
        Ok(document.finished())
    }

    /// Offset that takes the chosen origin to zero.
    fn home(&self) -> Transform {
        // Minus zero would be another number.
        Transform::at(glam::Vec3::ZERO - self.options.origin)
    }

    fn finished(mut self) -> Self {
        self.images = self.buffer.arrays().len();
        for file in self.looks.files(&self.options) {
            self.buffer.view(Array::Bytes(file));
        }
        self
    }

    /// A node whose text comes later.
    fn node(&mut self) -> usize {
        self.nodes.push(String::new());
        self.nodes.len() - 1
    }

    /// The text of a node with some parts, but for its closing bracket.
    fn group(&mut self, name: &str, transform: Transform, parts: &[Part<'a>]) -> Result<String, ExportError> {
        let seen: Vec<_> = parts.iter().filter(|part| part.triangles() > 0).collect();
        // A mesh alone needs no node around it; importers expect geometry in the levels themselves.
        if let [part] = seen[..]
            && (part.instances().is_none() || self.options.instancing == Instancing::Merged)
        {
            let (mesh, own) = self.whole(part)?;
            return Ok(shown(name, mesh, transform.after(&own)));
        }
        let first = self.nodes.len();
        for part in seen {
            self.part(part)?;
        }
        let children: Vec<_> = (first..self.nodes.len()).collect();
        let mut text = parent(name, transform, &children);
        text.pop();
        Ok(text)
    }

    /// The mesh of a part with all its copies in it, and what takes it to its place.
    fn whole(&mut self, part: &Part<'a>) -> Result<(usize, Transform), ExportError> {
        let material = self.looks.material(part);
        let geometry = self.geometry(part.mesh(), part.instances())?;
        let mesh = self.mesh(part.name(), geometry, material);
        Ok((mesh, part.transform().after(&self.scaled(geometry))))
    }

    /// The nodes of a part.
    fn part(&mut self, part: &Part<'a>) -> Result<(), ExportError> {
        let instances = match (self.options.instancing, part.instances()) {
            (Instancing::Merged, _) | (_, None) => {
                let (mesh, transform) = self.whole(part)?;
                self.nodes.push(shown(part.name(), mesh, transform) + "}");
                return Ok(());
            }
            (_, Some(instances)) => instances,
        };
        let material = self.looks.material(part);
        let geometry = self.geometry(part.mesh(), None)?;
        if self.options.instancing == Instancing::Nodes {
            let scaled = self.scaled(geometry);
            for copy in instances {
                let material = self.looks.tinted(material, copy.tint);
                let mesh = self.mesh(part.name(), geometry, material);
                let transform = part.transform().after(&copy.transform()).after(&scaled);
                self.nodes.push(shown_at(part.name(), mesh, transform, true) + "}");
            }
            return Ok(());
        }
        let mesh = self.mesh(part.name(), geometry, material);
        let attributes =
            list(self.instances(geometry, instances), |(name, accessor)| format!(r#""{name}":{accessor}"#));
        self.extensions.push("EXT_mesh_gpu_instancing");
        let mut node = shown(part.name(), mesh, part.transform());
        push(
            &mut node,
            format_args!(
                r#","extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{{attributes}}}}}}}}}"#
            ),
        );
        self.nodes.push(node);
        Ok(())
    }

    fn geometry(&mut self, mesh: &'a Mesh, merged: Option<&'a [Instance]>) -> Result<usize, ExportError> {
        let copies = merged.map(|copies| self.known.copies.index(copies));
        let key = (self.known.meshes.index(mesh), copies);
        if let Some(&found) = self.known.geometries.get(&key) {
            return Ok(found);
        }
        let geometry = self.buffer.geometry(mesh, merged, self.options.quantization, self.options.wind)?;
        self.geometries.push(geometry);
        self.known.geometries.insert(key, self.geometries.len() - 1);
        Ok(self.geometries.len() - 1)
    }

    fn mesh(&mut self, name: &'a str, geometry: usize, material: usize) -> usize {
        let meshes = &mut self.meshes;
        *self.known.entries.entry((geometry, material)).or_insert_with(|| {
            meshes.push((name, geometry, material));
            meshes.len() - 1
        })
    }

    /// Transform that takes a rounded mesh back to its size.
    fn scaled(&self, geometry: usize) -> Transform {
        self.geometries[geometry].grid.map_or(Transform::IDENTITY, Grid::transform)
    }

    fn instances(&mut self, geometry: usize, copies: &'a [Instance]) -> &[(&'static str, usize)] {
        let grid = self.geometries[geometry].grid;
        let buffer = &mut self.buffer;
        let key = (geometry, self.known.copies.index(copies));
        self.known.instances.entry(key).or_insert_with(|| {
            let mut accessors = vec![
                ("TRANSLATION", buffer.whole(Array::Translations(copies, grid))),
                ("ROTATION", buffer.whole(Array::Rotations(copies))),
                ("SCALE", buffer.whole(Array::Scales(copies, grid))),
            ];
            if copies.iter().any(Instance::is_tinted) {
                accessors.push(("_COLOR_0", buffer.whole(Array::Tints(copies))));
            }
            accessors
        })
    }

    pub(super) fn arrays(&self) -> &[Array<'a>] {
        self.buffer.arrays()
    }

    pub(super) fn bytes(&self) -> u64 {
        self.buffer.bytes()
    }

    pub(super) fn json(&self) -> String {
        let mut used = self.extensions.clone();
        let required: &[&str] = if self.options.quantization { &["KHR_mesh_quantization"] } else { &[] };
        used.extend(required);
        if self.looks.transmits() {
            used.push("KHR_materials_diffuse_transmission");
        }
        used.sort_unstable();
        used.dedup();
        let quoted = |name: &&str| format!("\"{name}\"");
        format!(
            concat!(
                r#"{{"asset":{{"version":"2.0","generator":"treesynth {version}"}},{used}{required}"#,
                r#""scene":0,"scenes":[{{"nodes":[{root}]}}],"nodes":[{nodes}],{animation}"meshes":[{meshes}],"#,
                r#"{looks}"accessors":[{accessors}],"bufferViews":[{views}],"#,
                r#""buffers":[{{"byteLength":{bytes}}}]}}"#,
            ),
            version = env!("CARGO_PKG_VERSION"),
            used = entry("extensionsUsed", &used, quoted),
            required = entry("extensionsRequired", required, quoted),
            root = self.root,
            nodes = self.nodes.join(","),
            animation = self.animation.as_ref().map_or(String::new(), Animation::text),
            meshes = list(&self.meshes, |mesh| self.mesh_text(mesh)),
            looks = self.looks.text(self.images, &self.options),
            accessors = self.buffer.accessors_text(),
            views = self.buffer.views_text(),
            bytes = self.bytes(),
        )
    }

    fn mesh_text(&self, (name, geometry, material): &(&str, usize, usize)) -> String {
        let primitives = list(&self.geometries[*geometry].primitives, |primitive| {
            format!(
                r#"{{"attributes":{{{}}},"indices":{},"material":{material},"mode":4}}"#,
                list(&primitive.attributes, |(name, index)| format!(r#""{name}":{index}"#)),
                primitive.indices,
            )
        });
        format!(r#"{{"name":{},"primitives":[{primitives}]}}"#, escaped(name))
    }
}

/// A node with others below it.
fn parent(name: &str, transform: Transform, children: &[usize]) -> String {
    let children = list(children, ToString::to_string);
    format!(r#"{{"name":{}{},"children":[{children}]}}"#, escaped(name), placed(transform, false))
}

/// A node that shows a mesh, but for its closing bracket.
fn shown(name: &str, mesh: usize, transform: Transform) -> String {
    shown_at(name, mesh, transform, false)
}

fn shown_at(name: &str, mesh: usize, transform: Transform, whole: bool) -> String {
    format!(r#"{{"name":{},"mesh":{mesh}{}"#, escaped(name), placed(transform, whole))
}

/// Position of a node: all three coordinates, or what changes something.
fn placed(transform: Transform, whole: bool) -> String {
    let Transform { position, rotation, scale } = transform;
    let mut text = String::new();
    if whole || position != glam::Vec3::ZERO {
        push(&mut text, format_args!(r#","translation":{}"#, numbers(&position.to_array())));
    }
    if whole || rotation != glam::Quat::IDENTITY {
        push(&mut text, format_args!(r#","rotation":{}"#, numbers(&rotation.to_array())));
    }
    if whole || scale.to_bits() != 1.0_f32.to_bits() {
        push(&mut text, format_args!(r#","scale":{}"#, numbers(&[scale; 3])));
    }
    text
}
