//! Reads accessors: numbers in buffers.

use super::bytes::Buffers;
use ::gltf::accessor::sparse::{IndexType, Sparse};
use ::gltf::accessor::{Accessor, DataType, Dimensions};
use ::gltf::buffer::View;

/// The elements of an accessor as `N` numbers each; whole numbers that stand for 0 to 1 (or −1 to 1) are made so.
pub(super) fn numbers<const N: usize>(
    accessor: &Accessor<'_>,
    buffers: &Buffers,
) -> Result<Vec<[f64; N]>, String> {
    let at = accessor.index();
    if accessor.dimensions().multiplicity() != N || matches!(accessor.dimensions(), Dimensions::Mat2) {
        return Err(format!(
            "accessor {at} has {} numbers in an element, not {N}",
            accessor.dimensions().multiplicity()
        ));
    }
    let kind = accessor.data_type();
    let scale = if accessor.normalized() { 1.0 / largest(kind) } else { 1.0 };
    let mut list = Vec::new();
    each(accessor, buffers, |element| {
        let size = kind.size();
        let mut numbers = [0.0; N];
        for (i, number) in numbers.iter_mut().enumerate() {
            let stored = decode(kind, &element[i * size..(i + 1) * size]);
            // −128 of 127 is −1. Only of whole numbers: `max` would hide a NaN.
            *number = if scale < 1.0 { (stored * scale).max(-1.0) } else { stored };
        }
        list.push(numbers);
    })?;
    if list.iter().flatten().any(|n| !n.is_finite()) {
        return Err(format!("accessor {at} has a number that is not finite"));
    }
    Ok(list)
}

/// The elements of an accessor of indices.
pub(super) fn indices(accessor: &Accessor<'_>, buffers: &Buffers) -> Result<Vec<u32>, String> {
    let kind = accessor.data_type();
    let whole = matches!(kind, DataType::U8 | DataType::U16 | DataType::U32);
    if !whole || accessor.dimensions() != Dimensions::Scalar {
        return Err(format!("accessor {} is no list of indices", accessor.index()));
    }
    let mut list = Vec::new();
    each(accessor, buffers, |element| list.push(decode(kind, element) as u32))?;
    Ok(list)
}

/// Calls `element` with the bytes of each element.
fn each(accessor: &Accessor<'_>, buffers: &Buffers, mut element: impl FnMut(&[u8])) -> Result<(), String> {
    let at = accessor.index();
    let (count, size) = (accessor.count(), accessor.size());
    let replaced = accessor.sparse().map(|sparse| replaced(accessor, &sparse, buffers)).transpose()?;
    let Some(view) = accessor.view() else {
        let Some(replaced) = replaced else { return Err(format!("accessor {at} has no bufferView")) };
        return only_replaced(at, count, size, &replaced, element);
    };
    let what = || format!("accessor {at}");
    let elements = elements(&view, accessor.offset(), count, size, buffers, &what)?;
    let mut next = replaced.as_deref().unwrap_or_default().iter().peekable();
    for (i, own) in elements.enumerate() {
        match next.next_if(|(index, _)| *index == i) {
            Some((_, bytes)) => element(bytes),
            None => element(own),
        }
    }
    Ok(())
}

/// The elements that a sparse accessor replaces, with their numbers, which rise.
fn replaced<'b>(
    accessor: &Accessor<'_>,
    sparse: &Sparse<'_>,
    buffers: &'b Buffers,
) -> Result<Vec<(usize, &'b [u8])>, String> {
    let at = accessor.index();
    let (indices, values) = (sparse.indices(), sparse.values());
    let kind = match indices.index_type() {
        IndexType::U8 => DataType::U8,
        IndexType::U16 => DataType::U16,
        IndexType::U32 => DataType::U32,
    };
    let what = |part: &str| format!("the sparse {part} of accessor {at}");
    let of_indices = || what("indices");
    let of_values = || what("values");
    let (count, size) = (sparse.count(), accessor.size());
    let numbers = elements(&indices.view(), indices.offset(), count, kind.size(), buffers, &of_indices)?;
    let values = elements(&values.view(), values.offset(), count, size, buffers, &of_values)?;
    let list: Vec<(usize, &[u8])> = numbers.map(|bytes| decode(kind, bytes) as usize).zip(values).collect();
    if let Some(&(beyond, _)) = list.iter().find(|(index, _)| *index >= accessor.count()) {
        let elements = accessor.count();
        return Err(format!("{} name element {beyond}, but there are {elements}", of_indices()));
    }
    if list.windows(2).any(|pair| pair[0].0 >= pair[1].0) {
        return Err(format!("{} do not rise", of_indices()));
    }
    Ok(list)
}

/// The elements of a sparse accessor without a bufferView: zeros, but for those that are replaced.
fn only_replaced(
    at: usize,
    count: usize,
    size: usize,
    replaced: &[(usize, &[u8])],
    mut element: impl FnMut(&[u8]),
) -> Result<(), String> {
    // Nothing in the file bounds the number of zeros.
    if count > MOST_ZEROS {
        return Err(format!(
            "accessor {at} is sparse and has {count} elements; at most {MOST_ZEROS} can be read"
        ));
    }
    let zeros = vec![0; size];
    let mut next = replaced.iter().peekable();
    for i in 0..count {
        element(next.next_if(|(index, _)| *index == i).map_or(&zeros, |(_, bytes)| bytes));
    }
    Ok(())
}

/// Most elements of an accessor that has no bytes for them: 2²² positions take 100 MB.
const MOST_ZEROS: usize = 1 << 22;

/// The bytes of each of `count` elements of `size` bytes in a view; `what` names them in messages.
fn elements<'b>(
    view: &View<'_>,
    offset: usize,
    count: usize,
    size: usize,
    buffers: &'b Buffers,
    what: &dyn Fn() -> String,
) -> Result<impl Iterator<Item = &'b [u8]> + use<'b>, String> {
    let bytes = buffers.view(view)?;
    let stride = view.stride().unwrap_or(size);
    let last = count.saturating_sub(1);
    let end = last.checked_mul(stride).and_then(|n| n.checked_add(offset)).and_then(|n| n.checked_add(size));
    if count > 0 && end.is_none_or(|end| end > bytes.len()) {
        return Err(format!("{} goes beyond its bufferView", what()));
    }
    Ok((0..count).map(move |i| &bytes[offset + i * stride..][..size]))
}

fn decode(kind: DataType, bytes: &[u8]) -> f64 {
    let mut word = [0; 4];
    word[..bytes.len()].copy_from_slice(bytes);
    let half = [word[0], word[1]];
    match kind {
        DataType::I8 => f64::from(word[0] as i8),
        DataType::U8 => f64::from(word[0]),
        DataType::I16 => f64::from(i16::from_le_bytes(half)),
        DataType::U16 => f64::from(u16::from_le_bytes(half)),
        DataType::U32 => f64::from(u32::from_le_bytes(word)),
        DataType::F32 => f64::from(f32::from_le_bytes(word)),
    }
}

/// What stands for 1 in a normalised accessor.
fn largest(kind: DataType) -> f64 {
    match kind {
        DataType::I8 => 127.0,
        DataType::U8 => 255.0,
        DataType::I16 => 32767.0,
        DataType::U16 => 65535.0,
        DataType::U32 => f64::from(u32::MAX),
        DataType::F32 => 1.0,
    }
}
