//! The light of renderers that have one light and no shadows.

use glam::DVec3;

/// Where the light of a simply lit picture comes from: one light without shadows, equally strong everywhere.
///
/// Renderers match on it: another kind of light would be a breaking change, on purpose, since each has to say what it
/// does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Light {
    /// From the eye: at each point of a surface, from where it is seen.
    #[default]
    Eye,
    /// From far away: the direction towards the light, world space, of any length above 0.
    Towards(DVec3),
}

impl Light {
    /// Whether the direction, if there is one, is finite and not zero.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        match *self {
            Self::Eye => true,
            Self::Towards(direction) => direction.is_finite() && direction != DVec3::ZERO,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_light_without_a_direction_is_refused() {
        assert!(Light::Eye.is_valid());
        for length in [f64::from_bits(1), 1e-200, 1.0, 1e200, f64::MAX] {
            assert!(Light::Towards(DVec3::Y * length).is_valid(), "{length}");
        }
        for direction in [DVec3::ZERO, DVec3::NAN, DVec3::X * f64::INFINITY, DVec3::new(1.0, f64::NAN, 0.0)] {
            assert!(!Light::Towards(direction).is_valid(), "{direction}");
        }
    }
}
