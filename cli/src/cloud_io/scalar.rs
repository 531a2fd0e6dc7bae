//! What scanners measure of each point beside its position and colour.

/// How many kinds there are.
pub(super) const SCALARS: usize = 3;

/// Something for each kind, by [`Scalar`].
pub type Scalars<T> = [T; SCALARS];

/// A measured value of a point, as it is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// Strength of the return; files have different units.
    Intensity,
    /// Class, in LAS one of those of the ASPRS (LAS 1.4 R15, table 17): 2 is ground, 6 building.
    Class,
    /// Number of the return among those of its pulse, from 1.
    Return,
}

impl Scalar {
    /// All of them, in their order.
    pub const ALL: Scalars<Self> = [Self::Intensity, Self::Class, Self::Return];

    /// As messages call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Intensity => "intensity",
            Self::Class => "class",
            Self::Return => "return number",
        }
    }

    /// What a property of a PLY or a column of a text with this name is. Case does not count, and neither do underscores and the
    /// `scalar_` that CloudCompare puts before names.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        let plain: String = name.to_lowercase().replace('_', "");
        match plain.strip_prefix("scalar").unwrap_or(&plain) {
            "intensity" | "reflectance" => Some(Self::Intensity),
            "classification" | "class" | "label" => Some(Self::Class),
            "returnnumber" => Some(Self::Return),
            _ => None,
        }
    }

    /// For files that have at most this one.
    pub(super) fn alone(self, is_there: bool) -> Scalars<bool> {
        Self::ALL.map(|scalar| is_there && scalar == self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_other_programs_are_known() {
        for (name, scalar) in [
            ("Intensity", Scalar::Intensity),
            ("scalar_Intensity", Scalar::Intensity),
            ("Classification", Scalar::Class),
            ("label", Scalar::Class),
            ("ReturnNumber", Scalar::Return),
            ("scalar_Return_Number", Scalar::Return),
        ] {
            assert_eq!(Scalar::of_name(name), Some(scalar), "{name}");
        }
        assert_eq!(Scalar::of_name("x"), None);
        assert_eq!(Scalar::of_name("scalar_"), None);
    }
}
