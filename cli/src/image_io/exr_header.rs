//! The order of what an EXR's header says.

/// Bytes of the magic number and the version, before the header.
const START: usize = 8;

/// Sorts the attributes of a file with one header by their names: the library writes those that it does not know in the order of a hash map, and
/// then the same picture would have other bytes every time. Their lengths stay, and so do all places within the file.
///
/// # Panics
///
/// The bytes are not what the library writes.
pub(super) fn sort_attributes(file: &mut [u8]) {
    const PROMISE: &str = "a header that was just written";
    let end_of_text = |from: usize| from + file[from..].iter().position(|&byte| byte == 0).expect(PROMISE);
    // Each is a name, a type, both with a 0 behind them, a length and as many bytes; a 0 ends the header.
    let mut attributes = vec![];
    let mut at = START;
    while file[at] != 0 {
        let name_end = end_of_text(at);
        let length_at = end_of_text(name_end + 1) + 1;
        let (length, _) = file[length_at..].split_first_chunk().expect(PROMISE);
        let end = length_at + 4 + u32::from_le_bytes(*length) as usize;
        attributes.push((file[at..name_end].to_vec(), file[at..end].to_vec()));
        at = end;
    }
    attributes.sort();
    let sorted: Vec<u8> = attributes.into_iter().flat_map(|(_, bytes)| bytes).collect();
    file[START..at].copy_from_slice(&sorted);
}
