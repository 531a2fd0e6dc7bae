//! Checks headers of LAS and LAZ against the size of the file, before a library allocates memory for what they say.
//!
//! Positions are those of the LAS 1.4 specification, table 3, and of the LASzip chunk table.

use super::ReadSeek;
use crate::input_error::InputError;
use las::Header;
use std::io::{Result, SeekFrom};

/// Refuses files whose headers ask for more memory than the file could fill. Leaves `input` at its start.
pub(super) fn check<R: ReadSeek>(name: &str, input: &mut R) -> std::result::Result<(), InputError> {
    let verdict = input.seek(SeekFrom::End(0)).and_then(|size| {
        let mut file = Checked { input, size };
        Ok(file.points()?.or(file.extended_records()?).or(file.chunks()?))
    });
    match verdict.and_then(|verdict| input.rewind().map(|()| verdict)) {
        Ok(None) => Ok(()),
        Ok(Some(message)) => Err(InputError::of_file(name, message)
            .with_help("the file is damaged or was cut off; get it again, or convert it to PLY")),
        Err(error) => Err(InputError::of_file(name, format!("cannot be read: {error}"))),
    }
}

/// Refuses a LAZ whose parts of a record are not as long as their kinds are, or not as the record: the library slices a record
/// by them and panics. Leaves `input` at its start.
pub(super) fn check_items<R: ReadSeek>(name: &str, input: &mut R) -> std::result::Result<(), InputError> {
    /// Bytes of each kind of part, by its number in the LASzip specification; extra bytes (0 and 14) have any.
    const SIZES: [(u16, u16); 8] = [(6, 20), (7, 8), (8, 6), (9, 29), (10, 30), (11, 6), (12, 8), (13, 29)];
    let fault = |message: String| {
        InputError::of_file(name, format!("not LAS: {message}"))
            .with_help("the file is damaged; get it again, or convert it to PLY")
    };
    let header = Header::new(&mut *input).map_err(|error| fault(error.to_string()))?;
    if header.point_format().is_compressed {
        let description = header.laz_vlr().map_err(|error| fault(error.to_string()))?;
        let record = u64::from(header.point_format().len());
        let known = |kind: u16, size: u16| SIZES.iter().all(|&(k, bytes)| k != kind || bytes == size);
        let items = description.items();
        if items.is_empty()
            || description.items_size() != record
            || !items.iter().all(|item| known(u16::from(item.item_type()), item.size()))
        {
            return Err(fault(format!(
                "the parts of a compressed record are not those of its {record} bytes"
            )));
        }
    }
    input.rewind().map_err(|error| InputError::of_file(name, format!("cannot be read: {error}")))
}

/// Where the minor number of the version is.
const MINOR_VERSION: u64 = 25;

struct Checked<'a, R> {
    input: &'a mut R,
    size: u64,
}

impl<R: ReadSeek> Checked<'_, R> {
    /// The bytes from `at` on; zeros if the file has less, which the library then finds out.
    fn bytes<const N: usize>(&mut self, at: u64) -> Result<[u8; N]> {
        let mut bytes = [0; N];
        if at.checked_add(N as u64).is_some_and(|end| end <= self.size) {
            self.input.seek(SeekFrom::Start(at))?;
            self.input.read_exact(&mut bytes)?;
        }
        Ok(bytes)
    }

    /// The number of points, which the library multiplies by the length of a record.
    fn points(&mut self) -> Result<Option<String>> {
        const OFFSET_TO_POINTS: u64 = 96;
        const RECORD_LENGTH: u64 = 105;
        const POINT_COUNT: u64 = 247;
        let [minor] = self.bytes(MINOR_VERSION)?;
        if minor < 4 {
            return Ok(None);
        }
        let count = u64::from_le_bytes(self.bytes(POINT_COUNT)?);
        let record = u64::from(u16::from_le_bytes(self.bytes(RECORD_LENGTH)?));
        let first = u64::from(u32::from_le_bytes(self.bytes(OFFSET_TO_POINTS)?));
        let end = count.checked_mul(record).and_then(|bytes| bytes.checked_add(first));
        Ok(end.is_none().then(|| format!("{count} points of {record} bytes are more than any file has")))
    }

    /// Records behind the points, which the library allocates as long as their headers say.
    fn extended_records(&mut self) -> Result<Option<String>> {
        const FIRST_RECORD: u64 = 235;
        const RECORD_COUNT: u64 = 243;
        const RECORD_LENGTH: u64 = 20;
        const RECORD_HEADER: u64 = 60;
        let [minor] = self.bytes(MINOR_VERSION)?;
        if minor < 4 {
            return Ok(None);
        }
        let mut at = u64::from_le_bytes(self.bytes(FIRST_RECORD)?);
        let count = u32::from_le_bytes(self.bytes(RECORD_COUNT)?);
        for record in 0..count {
            let length = u64::from_le_bytes(self.bytes(at.saturating_add(RECORD_LENGTH))?);
            let end = at.saturating_add(RECORD_HEADER).saturating_add(length);
            if end > self.size {
                let size = self.size;
                return Ok(Some(format!(
                    "extended record {record} at byte {at} ends behind the file's {size} bytes"
                )));
            }
            at = end;
        }
        Ok(None)
    }

    /// Entries of the chunk table, which the library makes room for; each chunk has at least a byte.
    fn chunks(&mut self) -> Result<Option<String>> {
        const OFFSET_TO_POINTS: u64 = 96;
        const POINT_FORMAT: u64 = 104;
        const CHUNK_COUNT: u64 = 4;
        let [format] = self.bytes(POINT_FORMAT)?;
        if format & 0xc0 == 0 {
            return Ok(None);
        }
        let points = u64::from(u32::from_le_bytes(self.bytes(OFFSET_TO_POINTS)?));
        let mut table = u64::from_le_bytes(self.bytes(points)?);
        // A writer that could not seek back puts the offset at the end of the file.
        if table >= self.size {
            table = u64::from_le_bytes(self.bytes(self.size.saturating_sub(8))?);
        }
        let count = u32::from_le_bytes(self.bytes(table.saturating_add(CHUNK_COUNT))?);
        let size = self.size;
        Ok((u64::from(count) > size)
            .then(|| format!("{count} chunks are announced, but the file has {size} bytes")))
    }
}
