//! Whether an EXR can hold what its header says: asked before the decoder allocates memory on the header's word.
//!
//! The decoder takes sizes and subsampling as they come, and a header of a few bytes, or one flipped bit in it, may ask for
//! more memory than there is or for a division by zero. Both would end the program without a message.

use super::ExrError;
use crate::memory;
use exr::block::chunk::CompressedBlock;
use exr::meta::attribute::Compression;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use std::io::Cursor;

/// Bytes of a pixel at most while a picture is decoded: as stored, as four floats, and as our own pixels.
pub(super) const DECODED_PIXEL_BYTES: u128 = 3 * 4 * 4;

/// Least bytes of a block in the file: its place in the table of offsets (8), where it lies (4), its length (4).
const BLOCK_BYTES: u128 = 16;
/// Most bytes of a block: its length is a signed number of 32 bits.
const MOST_BLOCK_BYTES: u128 = i32::MAX as u128;
/// Which of the 64-bit words at the head of a block with DWA compression say how long something is once unpacked.
const DWA_SIZES: [usize; 5] = [1, 6, 7, 8, 9];
/// Room for the padding of small blocks.
const DWA_PADDING: u64 = 1 << 16;

/// Looks at the header of every layer, and at the sizes in blocks that have some.
///
/// # Errors
///
/// What the decoder cannot be trusted with, and [`ExrError::Memory`] for a picture that does not fit.
pub(super) fn check(bytes: &[u8]) -> Result<(), ExrError> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false)?;
    meta.headers.iter().try_for_each(|header| check_layer(header, bytes.len() as u128))?;
    let is_looked_into = |header: &Header| is_dwa(header) || header.blocks != BlockDescription::ScanLines;
    if meta.headers.iter().any(is_looked_into) { check_blocks(bytes) } else { Ok(()) }
}

fn is_dwa(header: &Header) -> bool {
    matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_))
}

fn check_layer(header: &Header, file_bytes: u128) -> Result<(), ExrError> {
    if header.deep {
        return Err(ExrError::Deep);
    }
    let list = &header.channels.list;
    if let Some(channel) = list.iter().find(|c| c.sampling.x() != 1 || c.sampling.y() != 1) {
        return Err(ExrError::Subsampled(channel.name.to_string()));
    }
    let [width, height] = [header.layer_size.width(), header.layer_size.height()];
    let pixels = width as u128 * height as u128;
    let pixel_bytes: u128 = list.iter().map(|c| c.sample_type.bytes_per_sample() as u128).sum();
    let too_short =
        || ExrError::TooShort { width, height, channels: list.len(), file_bytes: file_bytes as u64 };
    // Saturating: the product of three sizes that are anything up to 2³¹ and a count that the file has room for.
    let stored = pixels.saturating_mul(pixel_bytes);
    if header.chunk_count as u128 * BLOCK_BYTES > file_bytes
        || stored > file_bytes.saturating_mul(largest_ratio(header.compression))
    {
        return Err(too_short());
    }
    let block_pixels = match header.blocks {
        BlockDescription::ScanLines => width as u128 * header.compression.scan_lines_per_block() as u128,
        BlockDescription::Tiles(tiles) => tiles.tile_size.width() as u128 * tiles.tile_size.height() as u128,
    };
    let block = block_pixels.saturating_mul(pixel_bytes);
    if block > MOST_BLOCK_BYTES {
        return Err(ExrError::Block { bytes: block });
    }
    let needed = stored.saturating_add(pixels * DECODED_PIXEL_BYTES).saturating_add(block);
    memory::check(needed, || format!("its {width}×{height} pixels take")).map_err(ExrError::Memory)
}

/// Looks at what blocks say of themselves: which level a tile belongs to, and the sizes with which DWA compression begins.
fn check_blocks(bytes: &[u8]) -> Result<(), ExrError> {
    let reader = exr::block::read(Cursor::new(bytes), false)?;
    let headers = reader.headers().to_vec();
    for chunk in reader.filter_chunks(false, |_, tile, _| tile.is_largest_resolution_level())? {
        let chunk = chunk?;
        let packed = match &chunk.compressed_block {
            CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
            CompressedBlock::Tile(tile) if tile.coordinates.is_largest_resolution_level() => {
                &tile.compressed_pixels_le
            }
            CompressedBlock::Tile(_) => return Err(ExrError::Level),
            _ => return Err(ExrError::Deep),
        };
        let dwa = headers.get(chunk.layer_index).filter(|header| is_dwa(header));
        dwa.map_or(Ok(()), |header| check_dwa(packed, header.max_block_byte_size()))?;
    }
    Ok(())
}

/// Looks at the sizes at the head of a block whose pixels take at most `raw` bytes.
fn check_dwa(packed: &[u8], raw: usize) -> Result<(), ExrError> {
    // No section is longer than all samples, padded to blocks of 8 × 8 and with a byte for each run.
    let most = 4 * raw as u64 + DWA_PADDING;
    let (words, _) = packed.as_chunks::<8>();
    let sizes = DWA_SIZES.iter().filter_map(|&at| words.get(at)).map(|word| u64::from_le_bytes(*word));
    // Pixels that do not get shorter are stored as they are, without sizes.
    match sizes.max().filter(|&size| packed.len() != raw && size > most) {
        Some(size) => Err(ExrError::Block { bytes: size.into() }),
        None => Ok(()),
    }
}

/// How many bytes of samples one byte of a file can stand for.
fn largest_ratio(compression: Compression) -> u128 {
    // Deflate: 258 bytes for a length and a distance of one bit each.
    const DEFLATE: u128 = 1032;
    // Runs of up to 128 bytes in two.
    const RUNS: u128 = 64;
    match compression {
        Compression::Uncompressed => 1,
        Compression::RLE => RUNS,
        // 16-bit numbers, runs of up to 255 of them in nine bits.
        Compression::PIZ => 512,
        // Blocks of 32 bytes in three.
        Compression::B44 | Compression::B44A => 11,
        Compression::ZIP1 | Compression::ZIP16 | Compression::PXR24 => DEFLATE,
        // Runs, deflated.
        _ => DEFLATE * RUNS,
    }
}
