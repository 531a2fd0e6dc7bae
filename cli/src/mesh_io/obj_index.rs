//! Indices of faces: which kinds a run of faces has, and how far each kind reaches.

/// The kinds of index that all corners of a face, or of a run of faces, have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kinds {
    pub(super) uv: bool,
    pub(super) normal: bool,
}

impl Kinds {
    /// What an empty face has: every corner narrows it.
    pub(super) const ALL: Self = Self { uv: true, normal: true };

    /// The kinds that both have.
    #[must_use]
    pub(super) fn and(self, other: Self) -> Self {
        Self { uv: self.uv && other.uv, normal: self.normal && other.normal }
    }
}

/// The largest index of one kind that a face asks for, and how many elements of that kind there are.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Range {
    pub(super) count: i64,
    pub(super) largest: i64,
    pub(super) line_of_largest: usize,
}

impl Range {
    /// The index from 1 that `number` of a face in `line` stands for: itself, or counted back from the last element
    /// read so far. `None` if that is before the first element.
    pub(super) fn index(&mut self, number: i32, line: usize) -> Option<i64> {
        let index = if number < 0 { self.count + 1 + i64::from(number) } else { i64::from(number) };
        if index > self.largest {
            (self.largest, self.line_of_largest) = (index, line);
        }
        (index >= 1).then_some(index)
    }
}
