//! Reads accessors: numbers in buffers.

use super::bytes::Buffers;
use ::gltf::accessor::{Accessor, DataType, Dimensions};

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
    if accessor.sparse().is_some() {
        return Err(format!("accessor {at} is sparse, which is not in this version yet"));
    }
    let view = accessor.view().ok_or_else(|| format!("accessor {at} has no bufferView"))?;
    let bytes = buffers.view(&view)?;
    let size = accessor.size();
    let stride = view.stride().unwrap_or(size);
    let last = accessor.count().saturating_sub(1);
    let end = last
        .checked_mul(stride)
        .and_then(|n| n.checked_add(accessor.offset()))
        .and_then(|n| n.checked_add(size));
    if accessor.count() > 0 && end.is_none_or(|end| end > bytes.len()) {
        return Err(format!("accessor {at} goes beyond its bufferView"));
    }
    for i in 0..accessor.count() {
        let start = accessor.offset() + i * stride;
        element(&bytes[start..start + size]);
    }
    Ok(())
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
