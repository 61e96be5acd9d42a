//! Meshes and instances as prims.

use crate::export::Axes;
use crate::surface::{Instance, Mesh, Part, Transform};
use glam::Vec3;
use std::io::{self, Write};

/// A word as USD names prims: letters, digits and `_`, beginning with no digit.
pub(super) fn identifier(name: &str) -> String {
    let mut word = name.replace(|c: char| !c.is_ascii_alphanumeric() && c != '_', "_");
    if word.is_empty() || word.starts_with(|c: char| c.is_ascii_digit()) {
        word.insert(0, '_');
    }
    word
}

/// `key = [item, item]`.
fn array<T>(
    writer: &mut impl Write,
    key: &str,
    items: impl IntoIterator<Item = T>,
    mut item: impl FnMut(&mut dyn Write, T) -> io::Result<()>,
) -> io::Result<()> {
    write!(writer, "{key} = [")?;
    for (i, one) in items.into_iter().enumerate() {
        if i > 0 {
            writer.write_all(b", ")?;
        }
        item(writer, one)?;
    }
    writer.write_all(b"]")
}

fn triple(writer: &mut (impl Write + ?Sized), [x, y, z]: [f32; 3]) -> io::Result<()> {
    write!(writer, "({x}, {y}, {z})")
}

/// The operations that bring a prim to its place, if there are any.
pub(super) fn operations(writer: &mut impl Write, transform: Transform, axes: Axes) -> io::Result<()> {
    if transform.is_identity() {
        return Ok(());
    }
    let [x, y, z] = axes.placed(transform.position).to_array();
    writeln!(writer, "double3 xformOp:translate = ({x}, {y}, {z})")?;
    let [w, x, y, z] = quaternion(transform.rotation, axes);
    writeln!(writer, "quatf xformOp:orient = ({w}, {x}, {y}, {z})")?;
    let scale = transform.scale;
    writeln!(writer, "float3 xformOp:scale = ({scale}, {scale}, {scale})")?;
    writeln!(
        writer,
        "uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\", \"xformOp:scale\"]"
    )
}

/// A quaternion in the file's axes, the real part first.
fn quaternion(rotation: glam::Quat, axes: Axes) -> [f32; 4] {
    let [x, y, z] = axes.turned(Vec3::new(rotation.x, rotation.y, rotation.z)).to_array();
    [rotation.w, x, y, z]
}

/// The prim `path` of a part, whose last word is `name`, in the material of a path. `axes` are without an origin.
pub(super) fn write(
    writer: &mut impl Write,
    part: &Part<'_>,
    (path, name): (&str, &str),
    material: &str,
    axes: Axes,
) -> io::Result<()> {
    let Some(copies) = part.instances() else {
        return mesh(writer, part, name, material, axes, part.transform(), true);
    };
    let tinted = copies.iter().any(Instance::is_tinted);
    // The colours of the prototype's vertices would hide those of the points.
    if tinted && !part.mesh().colors.is_empty() {
        let merged = part.mesh().merged(copies).map_err(io::Error::other)?;
        let whole = Part::new(&merged).with_material(part.material());
        return mesh(writer, &whole, name, material, axes, part.transform(), true);
    }
    writeln!(writer, "def PointInstancer \"{name}\"\n{{")?;
    operations(writer, part.transform(), axes)?;
    array(writer, "point3f[] positions", copies, |writer, copy| {
        triple(writer, axes.placed(copy.position).to_array())
    })?;
    array(writer, "\nquath[] orientations", copies, |writer, copy| {
        let [w, x, y, z] = quaternion(copy.rotation, axes);
        write!(writer, "({w}, {x}, {y}, {z})")
    })?;
    array(writer, "\nfloat3[] scales", copies, |writer, copy| triple(writer, [copy.scale; 3]))?;
    array(writer, "\nint[] protoIndices", copies, |writer, _| writer.write_all(b"0"))?;
    if tinted {
        let look = Vec3::from_array(part.material().color());
        array(writer, "\ncolor3f[] primvars:displayColor", copies, |writer, copy| {
            triple(writer, (look * Vec3::from_array(copy.tint)).to_array())
        })?;
        write!(writer, " (\ninterpolation = \"vertex\"\n)")?;
    }
    let [low, high] = extent(part.mesh(), copies, axes);
    array(writer, "\nfloat3[] extent", [low, high], |writer, corner| triple(writer, corner.to_array()))?;
    writeln!(writer, "\nrel prototypes = <{path}/Prototype>")?;
    mesh(writer, part, "Prototype", material, axes, Transform::IDENTITY, !tinted)?;
    writeln!(writer, "}}")
}

/// A box around all copies, not the least one.
fn extent(mesh: &Mesh, copies: &[Instance], axes: Axes) -> [Vec3; 2] {
    let bounds = mesh.bounds().map_or([Vec3::ZERO; 2], |bounds| [bounds.min, bounds.max]);
    let [low, high] = bounds;
    let radius = 0.5 * low.distance(high);
    let around = |[least, most]: [Vec3; 2], copy: &Instance| {
        let middle = copy.transform().point(0.5 * (low + high));
        let reach = Vec3::splat(radius * copy.scale);
        [least.min(middle - reach), most.max(middle + reach)]
    };
    let [least, most] = copies.iter().fold([Vec3::INFINITY, Vec3::NEG_INFINITY], around);
    let [a, b] = [axes.placed(least), axes.placed(most)];
    [a.min(b), a.max(b)]
}

fn mesh(
    writer: &mut impl Write,
    part: &Part<'_>,
    name: &str,
    material: &str,
    axes: Axes,
    transform: Transform,
    colored: bool,
) -> io::Result<()> {
    let mesh = part.mesh();
    writeln!(writer, "def Mesh \"{name}\" (\nprepend apiSchemas = [\"MaterialBindingAPI\"]\n)\n{{")?;
    operations(writer, transform, axes)?;
    writeln!(writer, "rel material:binding = <{material}>\nuniform token subdivisionScheme = \"none\"")?;
    writeln!(writer, "uniform bool doubleSided = {}", u8::from(part.material().is_double_sided()))?;
    let bounds = mesh.bounds().map_or([Vec3::ZERO; 2], |bounds| [bounds.min, bounds.max]);
    let [a, b] = bounds.map(|corner| axes.placed(corner));
    array(writer, "float3[] extent", [a.min(b), a.max(b)], |writer, corner| {
        triple(writer, corner.to_array())
    })?;
    array(writer, "\nint[] faceVertexCounts", mesh.triangles(), |writer, _| writer.write_all(b"3"))?;
    array(writer, "\nint[] faceVertexIndices", &mesh.indices, |writer, index| write!(writer, "{index}"))?;
    array(writer, "\npoint3f[] points", &mesh.positions, |writer, &position| {
        triple(writer, axes.placed(position).to_array())
    })?;
    array(writer, "\nnormal3f[] normals", &mesh.normals, |writer, &normal| {
        triple(writer, axes.turned(normal).to_array())
    })?;
    write!(writer, " (\ninterpolation = \"vertex\"\n)\n")?;
    if !mesh.uvs.is_empty() {
        array(writer, "texCoord2f[] primvars:st", &mesh.uvs, |writer, uv| {
            write!(writer, "({}, {})", uv.x, 1.0 - uv.y)
        })?;
        write!(writer, " (\ninterpolation = \"vertex\"\n)\n")?;
    }
    let look = Vec3::from_array(part.material().color());
    if !mesh.colors.is_empty() {
        array(writer, "color3f[] primvars:displayColor", &mesh.colors, |writer, &own| {
            triple(writer, (look * Vec3::from_array(own)).to_array())
        })?;
        write!(writer, " (\ninterpolation = \"vertex\"\n)\n")?;
    } else if colored {
        let [red, green, blue] = look.to_array();
        writeln!(writer, "color3f[] primvars:displayColor = [({red}, {green}, {blue})]")?;
    }
    writeln!(writer, "}}")
}
