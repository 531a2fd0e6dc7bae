//! The ternary four-digit codes of the paper's appendix A.5.2.

/// Where the corners of a trapezium lie, as seen from a cell: one base-3 digit each for UL, BL, UR, BR, that is, for the
/// left edge at the upper and lower line and the right edge at the upper and lower line. 0 is left of the cell's
/// column, 1 inside (its lines included), 2 right of it.
///
/// ```
/// use pointillist_dice::{Code, CodeKind};
/// let code = Code::from_digits([2, 1, 2, 2]).unwrap();
/// assert_eq!(code.value(), 71);
/// assert_eq!(code.kind(), CodeKind::Cuts { corners: 3 });
/// assert_eq!(code.to_string(), "2122");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Code(u8);

/// What a [`Code`] means for the cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CodeKind {
    /// A piece with this many corners, fewer if some coincide (34 codes).
    Cuts {
        /// 3 to 6.
        corners: u8,
    },
    /// The trapezium passes on the left (0000) or on the right (2222).
    Nothing,
    /// UL would lie right of UR, or BL right of BR (45 codes).
    Impossible,
}

/// A corner of a piece: where two of the lines LU, LB, LL, LR and the edges EL, ER meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Corner {
    UpperLeft,        // EL and LU
    LowerLeft,        // EL and LB
    UpperRight,       // ER and LU
    LowerRight,       // ER and LB
    CellUpperLeft,    // LL and LU
    CellUpperRight,   // LR and LU
    CellLowerLeft,    // LL and LB
    CellLowerRight,   // LR and LB
    LeftEdgeAtLeft,   // EL and LL
    LeftEdgeAtRight,  // EL and LR
    RightEdgeAtLeft,  // ER and LL
    RightEdgeAtRight, // ER and LR
}

/// The corners of one code's piece: along LU to the right, down ER, along LB to the left, up EL.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    corners: [Corner; 6],
    count: u8,
}

impl Shape {
    pub(crate) fn corners(&self) -> &[Corner] {
        &self.corners[..usize::from(self.count)]
    }

    const fn with(mut self, corner: Corner) -> Self {
        self.corners[self.count as usize] = corner;
        self.count += 1;
        self
    }

    /// Adds the crossings with LL and LR of an edge that runs from column `from` to column `to`.
    const fn with_edge(self, from: u8, to: u8, at_left: Corner, at_right: Corner) -> Self {
        match (from, to) {
            (0, 1) | (1, 0) => self.with(at_left),
            (1, 2) | (2, 1) => self.with(at_right),
            (0, 2) => self.with(at_left).with(at_right),
            (2, 0) => self.with(at_right).with(at_left),
            _ => self,
        }
    }

    /// The piece that the digits describe; empty for the 45 impossible codes and for 0000 and 2222.
    const fn of(ul: u8, bl: u8, ur: u8, br: u8) -> Self {
        let mut shape = Self { corners: [Corner::UpperLeft; 6], count: 0 };
        if ul > ur || bl > br {
            return shape;
        }
        if ul < 2 && ur > 0 {
            shape = shape.with(if ul == 1 { Corner::UpperLeft } else { Corner::CellUpperLeft });
            shape = shape.with(if ur == 1 { Corner::UpperRight } else { Corner::CellUpperRight });
        }
        shape = shape.with_edge(ur, br, Corner::RightEdgeAtLeft, Corner::RightEdgeAtRight);
        if bl < 2 && br > 0 {
            shape = shape.with(if br == 1 { Corner::LowerRight } else { Corner::CellLowerRight });
            shape = shape.with(if bl == 1 { Corner::LowerLeft } else { Corner::CellLowerLeft });
        }
        shape.with_edge(bl, ul, Corner::LeftEdgeAtLeft, Corner::LeftEdgeAtRight)
    }
}

/// The table of the paper, by code value.
static SHAPES: [Shape; Code::COUNT as usize] = {
    let mut table = [Shape::of(0, 0, 0, 0); Code::COUNT as usize];
    let mut value = 0;
    while value < Code::COUNT {
        table[value as usize] = Shape::of(value / 27, value / 9 % 3, value / 3 % 3, value % 3);
        value += 1;
    }
    table
};

impl Code {
    /// How many codes there are, 3⁴.
    pub const COUNT: u8 = 81;
    /// 0022: the trapezium covers the cell's column from side to side.
    pub const FULL: Self = Self(8);

    /// The code with the digits of UL, BL, UR, BR; `None` if one is larger than 2.
    #[must_use]
    pub const fn from_digits(digits: [u8; 4]) -> Option<Self> {
        let [ul, bl, ur, br] = digits;
        if ul > 2 || bl > 2 || ur > 2 || br > 2 { None } else { Some(Self(ul * 27 + bl * 9 + ur * 3 + br)) }
    }

    /// The digits of UL, BL, UR, BR.
    #[must_use]
    pub const fn digits(self) -> [u8; 4] {
        [self.0 / 27, self.0 / 9 % 3, self.0 / 3 % 3, self.0 % 3]
    }

    /// The code as a number, 0 to 80.
    #[must_use]
    pub const fn value(self) -> u8 {
        self.0
    }

    /// What the code means.
    #[must_use]
    pub fn kind(self) -> CodeKind {
        let [ul, bl, ur, br] = self.digits();
        match self.shape().count {
            _ if ul > ur || bl > br => CodeKind::Impossible,
            0 => CodeKind::Nothing,
            corners => CodeKind::Cuts { corners },
        }
    }

    /// Every code, in the order of its value.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..Self::COUNT).map(Self)
    }

    pub(crate) fn shape(self) -> &'static Shape {
        &SHAPES[usize::from(self.0)]
    }
}

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.digits().iter().try_for_each(|d| write!(f, "{d}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thirty_four_codes_cut_two_do_nothing_and_the_rest_are_impossible() {
        let count = |wanted: fn(CodeKind) -> bool| Code::all().filter(|c| wanted(c.kind())).count();
        assert_eq!(count(|k| matches!(k, CodeKind::Cuts { corners: 3..=6 })), 34);
        assert_eq!(count(|k| k == CodeKind::Nothing), 2);
        assert_eq!(count(|k| k == CodeKind::Impossible), 45);
    }

    #[test]
    fn the_examples_of_the_paper_have_their_shapes() {
        use Corner::{
            CellLowerLeft, CellLowerRight, LeftEdgeAtRight, LowerLeft, LowerRight, RightEdgeAtLeft,
        };
        let corners = |digits| Code::from_digits(digits).map(|c| c.shape().corners().to_vec());
        assert_eq!(corners([2, 1, 2, 2]), Some(vec![CellLowerRight, LowerLeft, LeftEdgeAtRight]));
        assert_eq!(corners([0, 0, 0, 1]), Some(vec![RightEdgeAtLeft, LowerRight, CellLowerLeft]));
        assert_eq!(corners([0, 0, 0, 2]).map(|c| c.len()), Some(4));
        assert_eq!(corners([1, 0, 1, 2]).map(|c| c.len()), Some(6));
        assert_eq!(corners([0, 0, 0, 3]), None);
    }
}
