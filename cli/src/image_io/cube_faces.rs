//! Pictures of all directions as the six faces of a cube, in the order +X −X +Y −Y +Z −Z.

/// Texels of a face's side if a picture of this size is a strip of six faces, side by side or one below another.
pub fn strip_face([width, height]: [usize; 2]) -> Option<usize> {
    let side = width.min(height);
    (width.max(height) == side.checked_mul(6)? && side > 0).then_some(side)
}

/// The faces of a strip of `face`² texels each, one after the other.
pub fn faces_of_strip<T: Copy>(face: usize, width: usize, pixels: &[T]) -> Vec<T> {
    if width == face {
        return pixels.to_vec();
    }
    let texel = |i: usize| {
        let (number, y, x) = (i / (face * face), i / face % face, i % face);
        pixels[y * width + number * face + x]
    };
    (0..6 * face * face).map(texel).collect()
}

/// What is wrong with a face of `size` texels beside a first one of `first`, as the end of a sentence.
pub fn face_fault([width, height]: [usize; 2], first: [usize; 2]) -> Option<String> {
    let side = first[0];
    ([width, height] != [side, side])
        .then(|| format!("is {width}×{height}; all six faces of a cube must be {side}×{side}"))
}
