//! Reads the points of single nodes.

use super::super::block::{CloudBlock, CloudOptions, Gather, Has, Stop};
use super::super::colour::ColourCode;
use super::super::las_axis::Axis;
use super::super::scalar::SCALARS;
use super::super::{las_check, las_file, with_sink};
use super::hierarchy::{CopcChunk, CopcHierarchy};
use crate::input;
use crate::input_error::InputError;
use las::{Header, PointData, PointDataBuilder};
use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor};
use laz::{LazItem, LazItemType};
use pointillist_octree::Tree;
use std::io::{Cursor, Read, Seek, SeekFrom};

/// Points that are decompressed before memory for more is asked for: a count alone is nobody's word.
const POINTS_AT_ONCE: usize = 1 << 16;

/// A COPC file, open: its octree, and the points of each node.
#[derive(Debug)]
pub struct CopcFile<R> {
    name: String,
    input: R,
    header: Header,
    items: Vec<LazItem>,
    hierarchy: CopcHierarchy,
    code: ColourCode,
}

impl<R: Read + Seek + Send + Sync + 'static> CopcFile<R> {
    /// Reads the hierarchy, and the points of one node, whose colours say whether they have 8 or 16 bits. `name` is how messages call the file.
    ///
    /// # Errors
    ///
    /// [`InputError`] with a [`super::CopcError`] in words, or for a header that the library refuses.
    pub fn new(name: &str, mut input: R) -> Result<Self, InputError> {
        let hierarchy = CopcHierarchy::read(&mut input).map_err(|error| damaged(name, &error.to_string()))?;
        input.rewind().map_err(|error| input::cannot_read(name, &error))?;
        las_check::check(name, &mut input)?;
        las_check::check_items(name, &mut input)?;
        let of_library = |error: las::Error| damaged(name, &error.to_string());
        let header = Header::new(&mut input).map_err(of_library)?;
        let items = header.laz_vlr().map_err(of_library)?.items().clone();
        let name = name.to_owned();
        let mut file = Self { name, input, header, items, hierarchy, code: ColourCode::Short };
        // The first in the file, as for those that are read from its beginning.
        if let Some(first) = file.tree().nodes().iter().position(|node| node.count > 0) {
            let records = file.read(first as u32)?;
            file.code = las_file::colour_code(&file.points(records)?);
        }
        Ok(file)
    }

    /// Its octree.
    pub fn tree(&self) -> &Tree {
        &self.hierarchy.tree
    }

    /// Points that the header announces beyond those of the nodes.
    pub fn missing(&self) -> u64 {
        self.hierarchy.announced - self.tree().points()
    }

    /// Bytes of a node in the file.
    pub fn bytes_of(&self, node: u32) -> u64 {
        self.chunk(node).bytes.into()
    }

    fn chunk(&self, node: u32) -> CopcChunk {
        self.hierarchy.chunks[node as usize]
    }

    fn points(&self, records: Vec<u8>) -> Result<PointData, InputError> {
        let points = PointDataBuilder::new().for_header(&self.header).build_from_bytes(records);
        points.map_err(|error| damaged(&self.name, &error.to_string()))
    }

    /// The records of a node, decompressed.
    ///
    /// # Errors
    ///
    /// [`InputError`] for points that are not what the hierarchy says, or damaged.
    pub fn read(&mut self, node: u32) -> Result<Vec<u8>, InputError> {
        let count = self.tree().nodes()[node as usize].count as usize;
        if count == 0 {
            return Ok(vec![]);
        }
        let chunk = self.chunk(node);
        let at = format!("the node at byte {}", chunk.offset);
        let mut packed = vec![];
        self.input
            .seek(SeekFrom::Start(chunk.offset))
            .and_then(|_| self.input.by_ref().take(chunk.bytes.into()).read_to_end(&mut packed))
            .map_err(|error| input::cannot_read(&self.name, &error))?;
        check_layers(&packed, &self.items, count)
            .map_err(|message| damaged(&self.name, &format!("{at}: {message}")))?;
        self.decompress(packed, count)
            .map_err(|error| damaged(&self.name, &format!("{at} cannot be unpacked: {error}")))
    }

    fn decompress(&self, packed: Vec<u8>, count: usize) -> laz::Result<Vec<u8>> {
        let mut decompressor = LayeredPointRecordDecompressor::new(Cursor::new(packed));
        decompressor.set_fields_from(&self.items)?;
        let record = usize::from(self.header.point_format().len());
        let mut records = vec![];
        for first in (0..count).step_by(POINTS_AT_ONCE) {
            let begin = records.len();
            records.resize(begin + POINTS_AT_ONCE.min(count - first) * record, 0);
            decompressor.decompress_many(&mut records[begin..])?;
        }
        Ok(records)
    }

    /// Hands out the points of records that [`Self::read`] gave, as `read_cloud` does.
    ///
    /// # Errors
    ///
    /// Points that are not finite, unless they may be dropped; colours that cannot be; or that of `sink`.
    pub fn blocks(
        &self,
        records: &[u8],
        options: &CloudOptions,
        sink: &mut dyn FnMut(CloudBlock<'_>) -> Result<(), InputError>,
    ) -> Result<(), InputError> {
        let points = self.points(records.to_vec())?;
        let transforms = self.header.transforms();
        let axes = [transforms.x, transforms.y, transforms.z].map(|axis| Axis::new(axis.scale, axis.offset));
        with_sink(sink, options, |gather: &mut Gather<'_>| -> Result<(), Stop> {
            gather.expect(Has {
                colours: self.header.point_format().has_color,
                scalars: [true; SCALARS],
                ..Has::default()
            });
            las_file::push(&self.name, &points, self.code, &axes, 0, gather)?;
            gather.finish_part(&self.name)
        })
    }
}

fn damaged(name: &str, message: &str) -> InputError {
    InputError::of_file(name, message)
        .with_help("the file is damaged or was cut off; get it again, or make it again of the cloud that it was made from")
}

/// Refuses points that are not as long or as many as they are said to be: the library allocates what they say.
///
/// A chunk has its first record, the number of its points, the length of each layer, and the layers.
fn check_layers(packed: &[u8], items: &[LazItem], count: usize) -> Result<(), String> {
    let layers = items.iter().map(|item| match item.item_type() {
        LazItemType::Point14 => 9,
        LazItemType::RGBNIR14 => 2,
        LazItemType::Byte14(bytes) => usize::from(bytes),
        _ => 1,
    });
    let first: usize = items.iter().map(|item| usize::from(item.size())).sum();
    let numbers = 1 + layers.sum::<usize>();
    let Some(numbers) = packed.get(first..first + 4 * numbers) else {
        return Err(format!("{} bytes are too few for any points", packed.len()));
    };
    let mut numbers =
        numbers.chunks_exact(4).map(|b| u64::from(u32::from_le_bytes(std::array::from_fn(|i| b[i]))));
    let own = numbers.next().unwrap_or_default();
    if own != count as u64 {
        return Err(format!("it has {own} points, but the hierarchy announces {count}"));
    }
    let head = first + 4 + 4 * numbers.len();
    let needed = numbers.sum::<u64>() + head as u64;
    if needed > packed.len() as u64 {
        return Err(format!("its layers take {needed} bytes, but it has {}", packed.len()));
    }
    Ok(())
}
