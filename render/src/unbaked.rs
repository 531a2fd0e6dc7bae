//! Which triangles came into a scene after light was baked.

use std::ops::Range;

/// Triangles of objects that came into a scene after its light was baked. What probes saw goes on where these stand: they take their light from all
/// sides, where what was baked has probes behind itself that do not light it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Unbaked {
    /// Their numbers, in ascending order.
    ranges: Vec<Range<u32>>,
}

impl Unbaked {
    /// There are none.
    pub const NONE: Self = Self { ranges: vec![] };

    /// All of so many triangles but those with these numbers.
    #[must_use]
    pub fn all_but(known: &[u32], triangle_count: u32) -> Self {
        let mut known = known.to_vec();
        known.sort_unstable();
        let mut ranges = vec![];
        let mut next = 0;
        for number in known.into_iter().chain([triangle_count]) {
            if number > next {
                ranges.push(next..number.min(triangle_count));
            }
            next = next.max(number.saturating_add(1));
        }
        ranges.retain(|range| !range.is_empty());
        Self { ranges }
    }

    /// Whether a triangle is one of them.
    #[must_use]
    pub fn contains(&self, triangle: u32) -> bool {
        let after = self.ranges.partition_point(|range| range.end <= triangle);
        self.ranges.get(after).is_some_and(|range| range.contains(&triangle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_new() {
        let known = [7, 2, 3, 2, 9, 12];
        let unbaked = Unbaked::all_but(&known, 11);
        for triangle in 0..14 {
            assert_eq!(unbaked.contains(triangle), triangle < 11 && !known.contains(&triangle), "{triangle}");
        }
        assert_eq!(Unbaked::all_but(&[0, 1, 2], 3), Unbaked::NONE);
        assert_eq!(Unbaked::all_but(&[], 0), Unbaked::NONE);
    }
}
