//! Apache Parquet: the trees of a landscape as a table that pandas, Polars, `DuckDB` and R read.
//!
//! | column | type | |
//! |---|---|---|
//! | `tile_x`, `tile_z` | int32 | the tile |
//! | `number` | int64 | of the tree in its tile |
//! | `species` | string | as it was named |
//! | `x`, `y`, `z` | double | place of the foot in the landscape, metres, +Y up |
//! | `age` | int32 | seasons |
//! | `is_dead` | boolean | whether it is dead and stands |
//! | `metamers` | int64 | |
//! | `height`, `crown_width` | double | metres |
//! | `breast_height_diameter`, `crown_base` | double, or null where the tree has none | metres |
//! | `projected_area` | double | square metres |
//! | `crown_volume`, `stem_volume`, `wood_volume` | double | cubic metres |
//!
//! Measures are those of [`Metrics`](crate::Metrics).

use super::ExportError;
use crate::ParameterError;
use crate::self_organizing::TreeRecord;
use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int32Type, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;
use std::io::Write;
use std::sync::Arc;

/// A column's name and values.
enum Column<'a> {
    Integer(&'static str, fn(&TreeRecord) -> i32),
    Long(&'static str, fn(&TreeRecord) -> i64),
    Flag(&'static str, fn(&TreeRecord) -> bool),
    Text(&'static str, &'a [&'a str]),
    Number(&'static str, fn(&TreeRecord) -> f64),
    /// Null where there is none.
    Sparse(&'static str, fn(&TreeRecord) -> Option<f64>),
}

use Column::{Flag, Integer, Long, Number, Sparse, Text};

fn columns<'a>(species: &'a [&'a str]) -> [Column<'a>; 18] {
    [
        Integer("tile_x", |tree| tree.tile.x),
        Integer("tile_z", |tree| tree.tile.y),
        Long("number", |tree| tree.number.into()),
        Text("species", species),
        Number("x", |tree| tree.place.x),
        Number("y", |tree| tree.place.y),
        Number("z", |tree| tree.place.z),
        Integer("age", |tree| tree.age.into()),
        Flag("is_dead", |tree| tree.is_dead),
        Long("metamers", |tree| tree.metamers as i64),
        Number("height", |tree| tree.metrics.height),
        Sparse("breast_height_diameter", |tree| tree.metrics.breast_height_diameter),
        Sparse("crown_base", |tree| tree.metrics.crown_base),
        Number("crown_width", |tree| tree.metrics.crown_width),
        Number("projected_area", |tree| tree.metrics.projected_area),
        Number("crown_volume", |tree| tree.metrics.crown_volume),
        Number("stem_volume", |tree| tree.metrics.stem_volume),
        Number("wood_volume", |tree| tree.metrics.wood_volume),
    ]
}

impl Column<'_> {
    fn schema(&self) -> Result<Type, ParquetError> {
        let (name, physical) = match *self {
            Integer(name, _) => (name, Physical::INT32),
            Long(name, _) => (name, Physical::INT64),
            Flag(name, _) => (name, Physical::BOOLEAN),
            Text(name, _) => (name, Physical::BYTE_ARRAY),
            Number(name, _) | Sparse(name, _) => (name, Physical::DOUBLE),
        };
        let is_sparse = matches!(self, Sparse(..));
        let repetition = if is_sparse { Repetition::OPTIONAL } else { Repetition::REQUIRED };
        let kind = if matches!(self, Text(..)) { ConvertedType::UTF8 } else { ConvertedType::NONE };
        Type::primitive_type_builder(name, physical)
            .with_repetition(repetition)
            .with_converted_type(kind)
            .build()
    }

    fn write<W: Write + Send>(
        &self,
        trees: &[TreeRecord],
        group: &mut SerializedRowGroupWriter<'_, W>,
    ) -> Result<(), ParquetError> {
        fn all<T: DataType, W: Write + Send>(
            values: &[T::T],
            present: Option<&[i16]>,
            group: &mut SerializedRowGroupWriter<'_, W>,
        ) -> Result<(), ParquetError> {
            let Some(mut column) = group.next_column()? else { return Ok(()) };
            column.typed::<T>().write_batch(values, present, None)?;
            column.close()
        }
        match *self {
            Integer(_, of) => all::<Int32Type, W>(&trees.iter().map(of).collect::<Vec<_>>(), None, group),
            Long(_, of) => all::<Int64Type, W>(&trees.iter().map(of).collect::<Vec<_>>(), None, group),
            Flag(_, of) => all::<BoolType, W>(&trees.iter().map(of).collect::<Vec<_>>(), None, group),
            Number(_, of) => all::<DoubleType, W>(&trees.iter().map(of).collect::<Vec<_>>(), None, group),
            Text(_, species) => {
                let names: Vec<ByteArray> = trees.iter().map(|tree| species[tree.species].into()).collect();
                all::<ByteArrayType, W>(&names, None, group)
            }
            Sparse(_, of) => {
                let present: Vec<i16> = trees.iter().map(|tree| of(tree).is_some().into()).collect();
                let values: Vec<f64> = trees.iter().filter_map(of).collect();
                all::<DoubleType, W>(&values, Some(&present), group)
            }
        }
    }
}

/// Writes an inventory as a table, one row per tree in the order given. `species` names each species by its number. The same trees
/// make the same bytes. O(n).
///
/// ```
/// use treesynth::export::write_parquet;
/// use treesynth::glam::IVec2;
/// use treesynth::self_organizing::{Habit, Landscape, ShadowPropagation};
///
/// let light = |bounds| ShadowPropagation::new(bounds).with_cell(0.1);
/// let landscape = Landscape::new(light, Habit::default().with_length(0.1), 1).with_tile(2).with_margin(1);
/// let trees = landscape.inventory(IVec2::ZERO, &landscape.grow(IVec2::ZERO, 6)?)?;
/// let mut table = Vec::new();
/// write_parquet(&trees, &["oak"], &mut table)?;
/// assert_eq!(table[..4], *b"PAR1");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A species without a name, and the writer's own.
pub fn write_parquet(
    trees: &[TreeRecord],
    species: &[&str],
    writer: impl Write + Send,
) -> Result<(), ExportError> {
    let most = trees.iter().map(|tree| tree.species).max().map_or(0, |species| species + 1);
    let range = "a name for each species of the trees";
    ParameterError::unless(species.len() >= most, "species", species.len(), range)?;
    table(trees, &columns(species), writer).map_err(|error| match error {
        ParquetError::External(inner) => match inner.downcast() {
            Ok(io) => ExportError::Io(*io),
            Err(other) => ExportError::Io(std::io::Error::other(other)),
        },
        other => ExportError::Io(std::io::Error::other(other)),
    })
}

fn table(
    trees: &[TreeRecord],
    columns: &[Column<'_>],
    writer: impl Write + Send,
) -> Result<(), ParquetError> {
    let fields = columns.iter().map(|column| column.schema().map(Arc::new)).collect::<Result<_, _>>()?;
    let schema = Type::group_type_builder("trees").with_fields(fields).build()?;
    let properties = Arc::new(WriterProperties::builder().build());
    let mut file = SerializedFileWriter::new(writer, Arc::new(schema), properties)?;
    let mut group = file.next_row_group()?;
    for column in columns {
        column.write(trees, &mut group)?;
    }
    group.close()?;
    file.close()?;
    Ok(())
}
