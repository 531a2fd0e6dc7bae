//! The name of a node: its level, and where it is among the cubes of that level.

/// A cube of an octree: level 0 is the root, and each level has cubes of half the side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeKey {
    /// 0 to [`NodeKey::DEEPEST`].
    pub level: u8,
    /// Cubes from the low side along x, y and z, each below 2^level.
    pub place: [u32; 3],
}

impl NodeKey {
    /// The cube of the whole tree.
    pub const ROOT: Self = Self { level: 0, place: [0; 3] };

    /// The deepest level whose cubes can be named.
    pub const DEEPEST: u8 = 31;

    /// One of the eight cubes that this one consists of: bit 0 of `octant` is the upper half along x, bit 1 along y, bit 2 along z. `None` at
    /// [`NodeKey::DEEPEST`], or for an octant above 7.
    #[must_use]
    pub fn child(self, octant: usize) -> Option<Self> {
        let half = |axis: usize| 2 * self.place[axis] + (octant >> axis & 1) as u32;
        (self.level < Self::DEEPEST && octant < 8 && self.is_valid())
            .then(|| Self { level: self.level + 1, place: [half(0), half(1), half(2)] })
    }

    /// The cube of twice the side that this one is part of; `None` for the root.
    #[must_use]
    pub fn parent(self) -> Option<Self> {
        let level = self.level.checked_sub(1)?;
        Some(Self { level, place: self.place.map(|p| p / 2) })
    }

    /// Which of its parent's children it is.
    #[must_use]
    pub fn octant(self) -> usize {
        let [x, y, z] = self.place.map(|p| (p & 1) as usize);
        x + 2 * y + 4 * z
    }

    /// Whether there is such a cube.
    #[must_use]
    pub fn is_valid(self) -> bool {
        self.level <= Self::DEEPEST && self.place.iter().all(|&p| u64::from(p) < 1 << self.level)
    }
}
