//! glTF 2.0, the binary container (`.glb`).
//!
//! One scene, node, mesh and material, one buffer inside the file. Specification:
//! <https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>; the numbers below are its constants.

use super::ExportError;
use crate::ParameterError;
use crate::shape::Bounds;
use crate::surface::Mesh;
use std::fmt::Write as _;
use std::io::{self, Write};

/// `glTF`, `JSON` and `BIN\0` as little-endian numbers.
const MAGIC: u32 = 0x4654_6C67;
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BINARY: u32 = 0x004E_4942;
const VERSION: u32 = 2;

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// What a glTF file says besides the triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct GlbOptions {
    name: String,
    base_color: [f32; 3],
    roughness: f32,
    double_sided: bool,
}

impl Default for GlbOptions {
    /// Named `tree`, a grey-brown bark, roughness 0.9, seen from outside only.
    fn default() -> Self {
        Self { name: "tree".into(), base_color: [0.13, 0.095, 0.07], roughness: 0.9, double_sided: false }
    }
}

impl GlbOptions {
    /// The name of node, mesh and material; any text; default `tree`.
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// The material's colour, linear (not sRGB) red, green, blue, each 0 to 1; default a grey-brown bark.
    pub fn with_base_color(mut self, linear: [f32; 3]) -> Self {
        self.base_color = linear;
        self
    }

    /// The material's roughness, 0 (mirror) to 1 (chalk); default 0.9.
    pub fn with_roughness(mut self, roughness: f32) -> Self {
        self.roughness = roughness;
        self
    }

    /// Whether triangles are seen from behind too, as leaves should be; default false.
    pub fn with_double_sided(mut self, double_sided: bool) -> Self {
        self.double_sided = double_sided;
        self
    }

    fn check(&self) -> Result<(), ParameterError> {
        let holds = self.base_color.iter().all(|channel| (0.0..=1.0).contains(channel));
        ParameterError::unless(holds, "GlbOptions.base_color", self.base_color, "0 to 1 in each channel")?;
        let holds = (0.0..=1.0).contains(&self.roughness);
        ParameterError::unless(holds, "GlbOptions.roughness", self.roughness, "0 to 1")
    }
}

/// Writes `mesh` as a glTF 2.0 binary file: positions, normals and indices, and tangents, texture coordinates and
/// [wind weights](crate::surface::Wind) if there are any.
///
/// Wind weights are two attributes of the application's own, which viewers pass over: `_WIND_PIVOT`, the pivot in
/// metres (`VEC3`), and `_WIND`, level, phase and stiffness (`VEC3`), all floats.
///
/// glTF's axes and unit are this crate's (right-handed, +Y up, metres), so nothing is converted and every number
/// comes back as it is. The same mesh and options give the same bytes. O(vertices + triangles) time, O(1) memory.
///
/// ```
/// use treesynth::{export, glam::Vec3, surface::Mesh};
///
/// let triangle = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
/// let mut glb = Vec::new();
/// export::write_glb(&triangle, &export::GlbOptions::default().with_name("leaf"), &mut glb)?;
/// assert_eq!(&glb[..4], b"glTF");
/// # Ok::<(), export::ExportError>(())
/// ```
///
/// # Errors
/// A mesh without triangles, or whose arrays are not [sound](Mesh::check)
/// (triangles without area are written as they are); an option out of range; more than 4 GiB; whatever the
/// writer returns. Once a byte is written, nothing but the writer can fail.
pub fn write_glb(mesh: &Mesh, options: &GlbOptions, writer: impl Write) -> Result<(), ExportError> {
    options.check()?;
    if mesh.is_empty() {
        return Err(ExportError::EmptyMesh);
    }
    mesh.check_arrays()?;
    let bounds = mesh.bounds().ok_or(ExportError::EmptyMesh)?;

    let layout = Layout::of(mesh);
    let mut json = json(options, bounds, &layout).into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let bytes = 12 + 8 + json.len() as u64 + 8 + layout.bytes;
    if bytes > u64::from(u32::MAX) {
        return Err(ExportError::TooLarge { bytes, limit: u64::from(u32::MAX) });
    }

    let mut writer = io::BufWriter::with_capacity(1 << 16, writer);
    for word in [MAGIC, VERSION, bytes as u32, json.len() as u32, CHUNK_JSON] {
        writer.write_all(&word.to_le_bytes())?;
    }
    writer.write_all(&json)?;
    for word in [layout.bytes as u32, CHUNK_BINARY] {
        writer.write_all(&word.to_le_bytes())?;
    }
    // Every element is a whole number of 4-byte words, so each array starts aligned and the chunk needs no padding.
    for vector in mesh.positions.iter().chain(&mesh.normals) {
        write_floats(&mut writer, vector.to_array())?;
    }
    for tangent in &mesh.tangents {
        write_floats(&mut writer, tangent.to_array())?;
    }
    for uv in &mesh.uvs {
        write_floats(&mut writer, uv.to_array())?;
    }
    for wind in &mesh.wind {
        write_floats(&mut writer, wind.pivot.to_array())?;
    }
    for wind in &mesh.wind {
        write_floats(&mut writer, [wind.level, wind.phase, wind.stiffness])?;
    }
    for index in &mesh.indices {
        writer.write_all(&index.to_le_bytes())?;
    }
    // Flushing by hand: dropping a BufWriter swallows the error.
    writer.flush()?;
    Ok(())
}

fn write_floats<const N: usize>(writer: &mut impl Write, floats: [f32; N]) -> io::Result<()> {
    floats.into_iter().try_for_each(|float| writer.write_all(&float.to_le_bytes()))
}

/// One array in the buffer.
struct View {
    offset: u64,
    bytes: u64,
    target: u32,
    count: usize,
    component: u32,
    kind: &'static str,
    /// `None` for the indices.
    attribute: Option<&'static str>,
}

struct Layout {
    views: Vec<View>,
    bytes: u64,
}

impl Layout {
    fn of(mesh: &Mesh) -> Self {
        let mut layout = Self { views: Vec::new(), bytes: 0 };
        layout.push(Some("POSITION"), mesh.positions.len(), 3, "VEC3");
        layout.push(Some("NORMAL"), mesh.normals.len(), 3, "VEC3");
        for (attribute, count, words, kind) in [
            ("TANGENT", mesh.tangents.len(), 4, "VEC4"),
            ("TEXCOORD_0", mesh.uvs.len(), 2, "VEC2"),
            ("_WIND_PIVOT", mesh.wind.len(), 3, "VEC3"),
            ("_WIND", mesh.wind.len(), 3, "VEC3"),
        ] {
            if count > 0 {
                layout.push(Some(attribute), count, words, kind);
            }
        }
        layout.push(None, mesh.indices.len(), 1, "SCALAR");
        layout
    }

    fn push(&mut self, attribute: Option<&'static str>, count: usize, words: u64, kind: &'static str) {
        let bytes = count as u64 * words * 4;
        let (target, component) =
            if attribute.is_some() { (ARRAY_BUFFER, FLOAT) } else { (ELEMENT_ARRAY_BUFFER, UNSIGNED_INT) };
        self.views.push(View { offset: self.bytes, bytes, target, count, component, kind, attribute });
        self.bytes += bytes;
    }
}

fn json(options: &GlbOptions, bounds: Bounds, layout: &Layout) -> String {
    let name = escaped(&options.name);
    let [red, green, blue] = options.base_color.map(f64::from);
    let mut views = String::new();
    let mut accessors = String::new();
    let mut attributes = String::new();
    for (i, view) in layout.views.iter().enumerate() {
        let comma = if i == 0 { "" } else { "," };
        // Writing to a String cannot fail.
        let _ = write!(
            views,
            r#"{comma}{{"buffer":0,"byteOffset":{},"byteLength":{},"target":{}}}"#,
            view.offset, view.bytes, view.target
        );
        let _ = write!(
            accessors,
            r#"{comma}{{"bufferView":{i},"componentType":{},"count":{},"type":"{}""#,
            view.component, view.count, view.kind
        );
        if i == 0 {
            let _ = write!(accessors, r#","min":{},"max":{}"#, vector(bounds.min), vector(bounds.max));
        }
        accessors.push('}');
        if let Some(attribute) = view.attribute {
            let _ = write!(attributes, r#"{comma}"{attribute}":{i}"#);
        }
    }
    format!(
        concat!(
            r#"{{"asset":{{"version":"2.0","generator":"treesynth {version}"}},"#,
            r#""scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"name":{name},"mesh":0}}],"#,
            r#""meshes":[{{"name":{name},"primitives":[{{"attributes":{{{attributes}}},"#,
            r#""indices":{indices},"material":0,"mode":4}}]}}],"#,
            r#""materials":[{{"name":{name},"pbrMetallicRoughness":{{"#,
            r#""baseColorFactor":[{red},{green},{blue},1],"metallicFactor":0,"roughnessFactor":{rough}}},"#,
            r#""doubleSided":{double}}}],"#,
            r#""accessors":[{accessors}],"bufferViews":[{views}],"buffers":[{{"byteLength":{bytes}}}]}}"#,
        ),
        version = env!("CARGO_PKG_VERSION"),
        name = name,
        attributes = attributes,
        indices = layout.views.len() - 1,
        red = red,
        green = green,
        blue = blue,
        rough = f64::from(options.roughness),
        double = options.double_sided,
        accessors = accessors,
        views = views,
        bytes = layout.bytes,
    )
}

/// As doubles: their shortest text reads back as the same value in either precision.
fn vector(v: glam::Vec3) -> String {
    let [x, y, z] = v.to_array().map(f64::from);
    format!("[{x},{y},{z}]")
}

/// `text` as a JSON string, quotes included.
fn escaped(text: &str) -> String {
    let mut out = String::from('"');
    for char in text.chars() {
        match char {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            control if control < ' ' => {
                let _ = write!(out, "\\u{:04x}", control as u32);
            }
            other => out.push(other),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{MeshError, Tubes};
    use crate::{Skeleton, math};
    use glam::Vec3;
    use serde_json::Value;

    fn tree() -> Mesh {
        let points: Vec<_> =
            (0..10).map(|i| Vec3::new(math::sin(i as f32) / 3.0, i as f32 / 7.0, 0.1)).collect();
        let parents = (0..10u32).map(|i| i.checked_sub(1)).collect();
        let skeleton =
            Skeleton::new(points, parents).and_then(|s| s.with_radii(vec![0.03; 10])).expect("sound");
        Tubes::default().with_wind(true).mesh(&skeleton).expect("has a surface")
    }

    fn word(bytes: &[u8], at: usize) -> u32 {
        u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
    }

    /// Splits a file into its JSON and its buffer, checking the container on the way.
    fn read(glb: &[u8]) -> (Value, &[u8]) {
        assert_eq!((word(glb, 0), word(glb, 4), word(glb, 8)), (MAGIC, 2, glb.len() as u32));
        let json = word(glb, 12) as usize;
        assert_eq!((word(glb, 16), json % 4), (CHUNK_JSON, 0));
        let binary = &glb[20 + json..];
        assert_eq!((word(binary, 0) as usize, word(binary, 4)), (binary.len() - 8, CHUNK_BINARY));
        assert_eq!(binary.len() % 4, 0);
        (serde_json::from_slice(&glb[20..20 + json]).expect("valid JSON"), &binary[8..])
    }

    fn written(mesh: &Mesh, options: &GlbOptions) -> Vec<u8> {
        let mut glb = Vec::new();
        write_glb(mesh, options, &mut glb).expect("a vector takes everything");
        glb
    }

    #[test]
    fn everything_comes_back() {
        let mesh = tree();
        let glb = written(&mesh, &GlbOptions::default());
        let (json, buffer) = read(&glb);
        assert_eq!(json["buffers"][0]["byteLength"], buffer.len());
        let number = |value: &Value| value.as_u64().expect("a number") as usize;
        let views = json["bufferViews"].as_array().expect("views");
        let accessors = json["accessors"].as_array().expect("accessors");
        let primitive = &json["meshes"][0]["primitives"][0];
        let mut end = 0;
        for view in views {
            assert_eq!((number(&view["byteOffset"]), end % 4), (end, 0));
            end += number(&view["byteLength"]);
        }
        assert_eq!((end, accessors.len()), (buffer.len(), views.len()));

        // The words of an accessor, which has a view of its own.
        let words = |accessor: &Value, count: usize, kind: &str, target: u64| -> Vec<u32> {
            let accessor = number(accessor);
            let view = &views[accessor];
            assert_eq!(number(&accessors[accessor]["count"]), count);
            assert_eq!(
                (accessors[accessor]["type"].as_str(), view["target"].as_u64()),
                (Some(kind), Some(target))
            );
            let start = number(&view["byteOffset"]);
            (start..start + number(&view["byteLength"])).step_by(4).map(|at| word(buffer, at)).collect()
        };
        let vertices = mesh.positions.len();
        let same = |attribute: &str, kind: &str, floats: Vec<f32>| {
            let found = words(&primitive["attributes"][attribute], vertices, kind, 34962);
            assert!(found == floats.into_iter().map(f32::to_bits).collect::<Vec<_>>(), "{attribute}");
        };
        same("POSITION", "VEC3", mesh.positions.iter().flat_map(Vec3::to_array).collect());
        same("NORMAL", "VEC3", mesh.normals.iter().flat_map(Vec3::to_array).collect());
        same("TANGENT", "VEC4", mesh.tangents.iter().flat_map(glam::Vec4::to_array).collect());
        same("TEXCOORD_0", "VEC2", mesh.uvs.iter().flat_map(glam::Vec2::to_array).collect());
        same("_WIND_PIVOT", "VEC3", mesh.wind.iter().flat_map(|wind| wind.pivot.to_array()).collect());
        let weights = mesh.wind.iter().flat_map(|wind| [wind.level, wind.phase, wind.stiffness]);
        same("_WIND", "VEC3", weights.collect());
        assert_eq!(words(&primitive["indices"], mesh.indices.len(), "SCALAR", 34963), mesh.indices);

        let position = &accessors[0];
        let bounds = mesh.bounds().expect("vertices");
        for axis in 0..3 {
            for (key, bound) in [("min", bounds.min), ("max", bounds.max)] {
                let value = position[key][axis].as_f64().expect("a number");
                assert_eq!(value.to_bits(), f64::from(bound[axis]).to_bits());
            }
        }
    }

    #[test]
    fn attributes_are_optional() {
        let bare = tree();
        let mesh = Mesh::new(bare.positions, bare.normals, bare.indices);
        let glb = written(&mesh, &GlbOptions::default());
        let (json, _) = read(&glb);
        let attributes = json["meshes"][0]["primitives"][0]["attributes"].as_object().expect("attributes");
        assert_eq!(attributes.keys().collect::<Vec<_>>(), ["NORMAL", "POSITION"]);
        assert_eq!(json["accessors"].as_array().map(Vec::len), Some(3));
    }

    #[test]
    fn names_are_escaped() {
        for name in ["", "a \"quoted\" \\ name", "line\nbreak\t\u{1}\u{7f}", "Lärche 落葉松 🌲"] {
            let glb = written(&tree(), &GlbOptions::default().with_name(name));
            let (json, _) = read(&glb);
            assert_eq!(json["nodes"][0]["name"], name);
        }
    }

    #[test]
    fn extreme_numbers_come_back() {
        for scale in [f32::MIN_POSITIVE, 1e-30, 1.0 / 3.0, 1e30] {
            let text = vector(Vec3::new(scale, -scale, -0.0));
            let back: [f32; 3] = serde_json::from_str(&text).expect("valid JSON");
            assert_eq!(back.map(f32::to_bits), [scale, -scale, -0.0].map(f32::to_bits));
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let write = |mesh: &Mesh, options: &GlbOptions| write_glb(mesh, options, io::sink());
        let fine = GlbOptions::default();
        assert!(matches!(write(&Mesh::default(), &fine), Err(ExportError::EmptyMesh)));
        let mut broken = tree();
        broken.positions[3].y = f32::NAN;
        assert!(matches!(
            write(&broken, &fine),
            Err(ExportError::Mesh(MeshError::Position { vertex: 3, .. }))
        ));
        for options in [fine.clone().with_base_color([0.0, f32::NAN, 0.0]), fine.with_roughness(1.5)] {
            assert!(matches!(write(&tree(), &options), Err(ExportError::Parameter(_))));
        }
    }

    /// Takes so many bytes, then fails.
    struct Full(usize);

    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let taken = bytes.len().min(self.0);
            self.0 -= taken;
            if taken == 0 { Err(io::ErrorKind::StorageFull.into()) } else { Ok(taken) }
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_full_disk_is_reported() {
        let mesh = tree();
        let length = written(&mesh, &GlbOptions::default()).len();
        for room in [0, 1, 13, 100, length / 2, length - 1] {
            let result = write_glb(&mesh, &GlbOptions::default(), Full(room));
            assert!(matches!(result, Err(ExportError::Io(e)) if e.kind() == io::ErrorKind::StorageFull));
        }
        assert!(write_glb(&mesh, &GlbOptions::default(), Full(length)).is_ok());
    }
}
