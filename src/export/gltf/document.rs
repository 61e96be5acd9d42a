//! The JSON half of a glTF file.

use super::skin::{Skins, moves};
use super::{Data, GlbOptions, Instancing, attributes};
use crate::surface::{Instance, Material, Mesh, Part};
use std::fmt::Write as _;

/// What is written, with everything in it named by its index.
pub(super) struct Document<'a> {
    /// Each becomes a buffer view and an accessor.
    arrays: Vec<Data<'a>>,
    meshes: Vec<MeshEntry<'a>>,
    materials: Vec<(&'a str, Material)>,
    /// What each level shows, the finest first.
    levels: Vec<Vec<Placed<'a>>>,
    breeze: Option<Breath<'a>>,
}

/// The bones and their animation, with their arrays.
struct Breath<'a> {
    skins: &'a Skins<'a>,
    inverses: usize,
    times: usize,
    turns: Vec<usize>,
}

/// A mesh of the file: a mesh with a material.
struct MeshEntry<'a> {
    name: &'a str,
    mesh: &'a Mesh,
    material: usize,
    attributes: Vec<(&'static str, usize)>,
    indices: usize,
}

/// A mesh of the file in its places.
struct Placed<'a> {
    name: &'a str,
    mesh: usize,
    instances: Option<&'a [Instance]>,
    /// Translation, rotation and scale of the instances, if they are arrays.
    arrays: Option<[usize; 3]>,
    /// Whether bones move it.
    moves: bool,
}

impl<'a> Document<'a> {
    /// `None` if there is no level, or one without a triangle.
    pub(super) fn new<'b: 'a>(
        levels: &[impl AsRef<[Part<'b>]>],
        options: &GlbOptions,
        skins: Option<&'a Skins<'a>>,
    ) -> Option<Self> {
        let mut document = Self {
            arrays: Vec::new(),
            meshes: Vec::new(),
            materials: Vec::new(),
            levels: Vec::new(),
            breeze: None,
        };
        document.breeze = skins.map(|skins| Breath {
            skins,
            inverses: document.array(Data::Matrices(&skins.inverses)),
            times: document.array(Data::Times(&skins.times)),
            turns: skins.turns.iter().map(|turns| document.array(Data::Turns(turns))).collect(),
        });
        for level in levels {
            let seen = level.as_ref().iter().filter(|part| part.triangles() > 0);
            let level: Vec<_> = seen.map(|part| document.placed(part, options)).collect();
            if level.is_empty() {
                return None;
            }
            document.levels.push(level);
        }
        (!document.levels.is_empty()).then_some(document)
    }

    fn placed(&mut self, part: &Part<'a>, options: &GlbOptions) -> Placed<'a> {
        let mesh = self.mesh(part, options);
        let instances = part.instances();
        let arrays = instances.filter(|_| options.instancing == Instancing::Extension).map(|instances| {
            [Data::Translations(instances), Data::Rotations(instances), Data::Scales(instances)]
                .map(|data| self.array(data))
        });
        let moves = self.breeze.is_some() && moves(part);
        Placed { name: part.name(), mesh, instances, arrays, moves }
    }

    fn array(&mut self, data: Data<'a>) -> usize {
        self.arrays.push(data);
        self.arrays.len() - 1
    }

    fn mesh(&mut self, part: &Part<'a>, options: &GlbOptions) -> usize {
        let (name, mesh) = (part.name(), part.mesh());
        let look = (name, part.material());
        let material = self.materials.iter().position(|other| *other == look).unwrap_or_else(|| {
            self.materials.push(look);
            self.materials.len() - 1
        });
        let same = |entry: &MeshEntry<'_>| std::ptr::eq(entry.mesh, mesh) && entry.material == material;
        if let Some(index) = self.meshes.iter().position(same) {
            return index;
        }
        let skin = self.breeze.as_ref().and_then(|breeze| breeze.skins.attributes(mesh));
        let all = attributes(mesh, options).into_iter().chain(skin.into_iter().flatten());
        let attributes = all.map(|(name, data)| (name, self.array(data))).collect();
        let indices = self.array(Data::Indices(&mesh.indices));
        self.meshes.push(MeshEntry { name, mesh, material, attributes, indices });
        self.meshes.len() - 1
    }

    pub(super) fn arrays(&self) -> impl Iterator<Item = Data<'a>> {
        self.arrays.iter().copied()
    }

    pub(super) fn bytes(&self) -> u64 {
        self.arrays().map(Data::bytes).sum()
    }

    pub(super) fn json(&self, options: &GlbOptions) -> String {
        let extensions = self.extensions();
        let used = if extensions.is_empty() {
            String::new()
        } else {
            format!(r#""extensionsUsed":[{}],"#, list(extensions, |name| format!("\"{name}\"")))
        };
        format!(
            concat!(
                r#"{{"asset":{{"version":"2.0","generator":"treesynth {version}"}},{used}"#,
                r#""scene":0,"scenes":[{{"nodes":[{roots}]}}],"nodes":[{nodes}],{breeze}"meshes":[{meshes}],"#,
                r#""materials":[{materials}],"accessors":[{accessors}],"bufferViews":[{views}],"#,
                r#""buffers":[{{"byteLength":{bytes}}}]}}"#,
            ),
            version = env!("CARGO_PKG_VERSION"),
            used = used,
            roots = list(0..=self.moving(), |root| root.to_string()),
            nodes = self.nodes(options).join(","),
            breeze = self.breeze.as_ref().map_or(String::new(), |breeze| breeze.json(self.moving() + 1)),
            meshes = list(&self.meshes, mesh),
            materials = list(&self.materials, |(name, look)| material(name, look)),
            accessors = self.accessors(),
            views = self.views(),
            bytes = self.bytes(),
        )
    }

    fn extensions(&self) -> Vec<&'static str> {
        let instancing = self.levels.iter().flatten().any(|placed| placed.arrays.is_some());
        [("EXT_mesh_gpu_instancing", instancing), ("MSFT_lod", self.levels.len() > 1)]
            .into_iter()
            .filter_map(|(name, used)| used.then_some(name))
            .collect()
    }

    /// The number of nodes that bones move; they follow node 0.
    fn moving(&self) -> usize {
        self.levels.iter().flatten().filter(|placed| placed.moves).count()
    }

    /// The tree, what moves beside it, the bones, and what stands still.
    fn moving_nodes(&self, breeze: &Breath<'_>, options: &GlbOptions) -> Vec<String> {
        let mut nodes = Vec::new();
        for placed in self.levels.iter().flatten().filter(|placed| placed.moves) {
            nodes.push(format!(r#"{{"name":{},"mesh":{},"skin":0}}"#, escaped(placed.name), placed.mesh));
        }
        let first = 1 + nodes.len();
        breeze.bones(first, &mut nodes);
        let others = 1 + nodes.len();
        for placed in self.levels.iter().flatten().filter(|placed| !placed.moves) {
            placed.nodes(&mut nodes);
        }
        let children = list([first].into_iter().chain(others..=nodes.len()), |child| child.to_string());
        nodes.insert(0, format!(r#"{{"name":{},"children":[{children}]}}"#, escaped(&options.name)));
        nodes
    }

    /// The levels' nodes first, so that node 0 is the finest; then what hangs on them.
    fn nodes(&self, options: &GlbOptions) -> Vec<String> {
        if let Some(breeze) = &self.breeze {
            return self.moving_nodes(breeze, options);
        }
        let levels = self.levels.len();
        let mut roots = Vec::new();
        let mut others = Vec::new();
        for (index, level) in self.levels.iter().enumerate() {
            let name = if index == 0 { options.name.clone() } else { format!("{}_lod{index}", options.name) };
            let mut node = format!(r#"{{"name":{}"#, escaped(&name));
            // A mesh alone needs no node around it; importers expect geometry in the levels themselves.
            if let [Placed { mesh, instances: None, .. }] = &level[..] {
                push(&mut node, format_args!(r#","mesh":{mesh}"#));
            } else {
                let first = levels + others.len();
                for placed in level {
                    placed.nodes(&mut others);
                }
                let children = list(first..levels + others.len(), |child| child.to_string());
                push(&mut node, format_args!(r#","children":[{children}]"#));
            }
            if index == 0 && levels > 1 {
                let ids = list(1..levels, |id| id.to_string());
                push(&mut node, format_args!(r#","extensions":{{"MSFT_lod":{{"ids":[{ids}]}}}}"#));
                if !options.coverages.is_empty() {
                    let coverages = numbers(&options.coverages);
                    push(&mut node, format_args!(r#","extras":{{"MSFT_screencoverage":{coverages}}}"#));
                }
            }
            roots.push(node + "}");
        }
        roots.append(&mut others);
        roots
    }

    fn accessors(&self) -> String {
        let bounds = |index: usize| {
            if let Data::Times(times) = self.arrays[index] {
                let [low, high] = [times.first()?, times.last()?].map(|time| numbers(&[*time]));
                return Some(format!(r#","min":{low},"max":{high}"#));
            }
            let entry = self.meshes.iter().find(|entry| entry.attributes[0].1 == index)?;
            let bounds = entry.mesh.bounds()?;
            let [low, high] = [bounds.min, bounds.max].map(|corner| numbers(&corner.to_array()));
            Some(format!(r#","min":{low},"max":{high}"#))
        };
        list(self.arrays().enumerate(), |(index, data)| {
            format!(
                r#"{{"bufferView":{index},"componentType":{},"count":{},"type":"{}"{}}}"#,
                data.component(),
                data.count(),
                data.kind().1,
                bounds(index).unwrap_or_default(),
            )
        })
    }

    fn views(&self) -> String {
        let mut offset = 0;
        list(self.arrays(), |data| {
            let start = offset;
            offset += data.bytes();
            let target = data.target().map_or(String::new(), |target| format!(r#","target":{target}"#));
            format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{}{target}}}"#, data.bytes())
        })
    }
}

impl Breath<'_> {
    /// The nodes of the bones, the first of which has the number `first`.
    fn bones(&self, first: usize, nodes: &mut Vec<String>) {
        let joints = &self.skins.rig.joints;
        for (number, joint) in joints.iter().enumerate() {
            let parent = joint.parent.map_or(glam::Vec3::ZERO, |parent| joints[usize::from(parent)].position);
            let mut node = format!(
                r#"{{"name":"bone {number}","translation":{}"#,
                numbers(&(joint.position - parent).to_array())
            );
            let borne = (0..joints.len()).filter(|&i| joints[i].parent.map(usize::from) == Some(number));
            let children = list(borne, |child| (first + child).to_string());
            if !children.is_empty() {
                push(&mut node, format_args!(r#","children":[{children}]"#));
            }
            nodes.push(node + "}");
        }
    }

    /// The skin and the animation.
    fn json(&self, first: usize) -> String {
        let joints = self.skins.rig.joints.len();
        format!(
            concat!(
                r#""skins":[{{"inverseBindMatrices":{inverses},"skeleton":{first},"joints":[{joints}]}}],"#,
                r#""animations":[{{"name":"breeze","channels":[{channels}],"samplers":[{samplers}]}}],"#,
            ),
            inverses = self.inverses,
            first = first,
            joints = list(first..first + joints, |joint| joint.to_string()),
            channels = list(1..joints, |bone| format!(
                r#"{{"sampler":{},"target":{{"node":{},"path":"rotation"}}}}"#,
                bone - 1,
                first + bone
            )),
            samplers = list(&self.turns, |turns| format!(
                r#"{{"input":{},"interpolation":"LINEAR","output":{turns}}}"#,
                self.times
            )),
        )
    }
}

impl Placed<'_> {
    fn nodes(&self, nodes: &mut Vec<String>) {
        let start = format!(r#"{{"name":{},"mesh":{}"#, escaped(self.name), self.mesh);
        match (self.instances, self.arrays) {
            (None, _) => nodes.push(start + "}"),
            (Some(_), Some([translation, rotation, scale])) => nodes.push(format!(
                concat!(
                    r#"{start},"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":"#,
                    r#"{{"TRANSLATION":{translation},"ROTATION":{rotation},"SCALE":{scale}}}}}}}}}"#,
                ),
                start = start,
                translation = translation,
                rotation = rotation,
                scale = scale,
            )),
            (Some(instances), None) => nodes.extend(instances.iter().map(|instance| {
                format!(
                    r#"{start},"translation":{},"rotation":{},"scale":{}}}"#,
                    numbers(&instance.position.to_array()),
                    numbers(&instance.rotation.to_array()),
                    numbers(&[instance.scale; 3]),
                )
            })),
        }
    }
}

fn mesh(entry: &MeshEntry<'_>) -> String {
    let MeshEntry { name, material, attributes, indices, .. } = entry;
    format!(
        concat!(
            r#"{{"name":{name},"primitives":[{{"attributes":{{{attributes}}},"#,
            r#""indices":{indices},"material":{material},"mode":4}}]}}"#,
        ),
        name = escaped(name),
        attributes = list(attributes, |(name, index)| format!(r#""{name}":{index}"#)),
        indices = indices,
        material = material,
    )
}

fn material(name: &str, look: &Material) -> String {
    let [red, green, blue] = look.color();
    format!(
        concat!(
            r#"{{"name":{name},"pbrMetallicRoughness":{{"baseColorFactor":{color},"#,
            r#""metallicFactor":0,"roughnessFactor":{rough}}},"doubleSided":{double}}}"#,
        ),
        name = escaped(name),
        color = numbers(&[red, green, blue, 1.0]),
        rough = f64::from(look.roughness()),
        double = look.is_double_sided(),
    )
}

fn push(text: &mut String, more: std::fmt::Arguments<'_>) {
    // Writing to a String cannot fail.
    let _ = text.write_fmt(more);
}

/// The items' texts with commas between them.
fn list<T>(items: impl IntoIterator<Item = T>, text: impl FnMut(T) -> String) -> String {
    items.into_iter().map(text).collect::<Vec<_>>().join(",")
}

/// As doubles: their shortest text reads back as the same value in either precision.
pub(super) fn numbers(floats: &[f32]) -> String {
    let mut text = String::from("[");
    for (i, float) in floats.iter().enumerate() {
        push(&mut text, format_args!("{}{}", if i > 0 { "," } else { "" }, f64::from(*float)));
    }
    text + "]"
}

/// `text` as a JSON string, quotes included.
fn escaped(text: &str) -> String {
    let mut out = String::from('"');
    for char in text.chars() {
        match char {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            control if control < ' ' => push(&mut out, format_args!("\\u{:04x}", control as u32)),
            other => out.push(other),
        }
    }
    out.push('"');
    out
}
