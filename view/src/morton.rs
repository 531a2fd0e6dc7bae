//! Morton codes: an order of the cells of a cubic lattice in which cells of one octant follow one another.

/// Bits of a cell number that go into a [`morton_code`], per axis: three times this fits into 64 bits.
pub const MORTON_BITS: u32 = 21;

/// The Morton code of a cell of a lattice with 2^[`MORTON_BITS`] cells per axis: bit k of x, y and z is bit 3k, 3k + 1
/// and 3k + 2 of the code. Higher bits of the numbers are ignored.
///
/// Cells whose codes agree in all but the lowest 3k bits lie in one cube of 2^k cells per axis.
///
/// ```
/// use pointillist_view::morton_code;
///
/// assert_eq!(morton_code([0b11, 0b01, 0b00]), 0b001_011);
/// ```
#[inline]
#[must_use]
pub fn morton_code(cell: [u32; 3]) -> u64 {
    let [x, y, z] = cell.map(spread);
    x | y << 1 | z << 2
}

/// Puts two zeros after each of the lowest [`MORTON_BITS`] bits of a number.
///
/// Each step moves the upper half of every group of bits apart from its lower half: groups of 32, 16, 8, 4, 2 bits.
#[inline]
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x) & 0x1f_ffff;
    x = (x | x << 32) & 0x1f_0000_0000_ffff;
    x = (x | x << 16) & 0x1f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_goes_to_its_place() {
        for bit in 0..MORTON_BITS {
            for axis in 0..3 {
                let mut cell = [0; 3];
                cell[axis] = 1 << bit;
                assert_eq!(morton_code(cell), 1 << (3 * bit as usize + axis), "bit {bit} of axis {axis}");
            }
        }
        assert_eq!(morton_code([u32::MAX; 3]), (1 << 63) - 1);
        assert_eq!(morton_code([1 << MORTON_BITS; 3]), 0);
    }
}
