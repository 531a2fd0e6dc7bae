//! Sets of things that are alike or opposite: disjoint sets (R. E. Tarjan, *Efficiency of a good but not linear set
//! union algorithm*, JACM 1975) in which each member knows whether it is opposite to the first of its set.

/// Disjoint sets of numbers with signs.
pub(crate) struct SignedSets {
    /// Of each member, one that is nearer to the first of its set; the first of a set has itself.
    parents: Vec<u32>,
    /// Whether a member is opposite to its parent.
    opposite: Vec<bool>,
    /// Of the first of each set, how many there are.
    sizes: Vec<u32>,
}

impl SignedSets {
    /// Each number alone.
    pub(crate) fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect(), opposite: vec![false; count], sizes: vec![1; count] }
    }

    /// The first of a member's set, and whether the member is opposite to it.
    pub(crate) fn find(&mut self, member: u32) -> (u32, bool) {
        // 1. To the first.
        let (mut first, mut is_opposite) = (member, false);
        while self.parents[first as usize] != first {
            is_opposite ^= self.opposite[first as usize];
            first = self.parents[first as usize];
        }
        // 2. Again, so that the next way is short.
        let (mut at, mut sign) = (member, is_opposite);
        while self.parents[at as usize] != first {
            let (next, step) = (self.parents[at as usize], self.opposite[at as usize]);
            (self.parents[at as usize], self.opposite[at as usize]) = (first, sign);
            (at, sign) = (next, sign ^ step);
        }
        (first, is_opposite)
    }

    /// Puts the sets of two members together, in which they are then opposite or not; nothing if they are in one set.
    pub(crate) fn unite(&mut self, a: u32, b: u32, are_opposite: bool) {
        let ((a, a_opposite), (b, b_opposite)) = (self.find(a), self.find(b));
        if a == b {
            return;
        }
        let [size_a, size_b] = [a, b].map(|first| self.sizes[first as usize]);
        let (large, small) = if size_a >= size_b { (a, b) } else { (b, a) };
        self.parents[small as usize] = large;
        self.opposite[small as usize] = a_opposite ^ b_opposite ^ are_opposite;
        self.sizes[large as usize] = size_a + size_b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_multiply_along_any_way() {
        // Member i is opposite to 0 where i has an odd number of bits.
        let is_odd = |i: u32| i.count_ones() % 2 == 1;
        let mut sets = SignedSets::new(1000);
        for i in 1..1000u32 {
            let other = (i * 7919) % i;
            sets.unite(i, other, is_odd(i) != is_odd(other));
        }
        let (first, zero) = sets.find(0);
        for i in 0..1000 {
            assert_eq!(sets.find(i), (first, is_odd(i) != is_odd(0) ^ zero));
        }
    }

    #[test]
    fn a_set_keeps_its_signs_when_told_otherwise() {
        let mut sets = SignedSets::new(3);
        sets.unite(0, 1, true);
        sets.unite(1, 0, false);
        assert!(sets.find(0).0 == sets.find(1).0 && sets.find(0).1 != sets.find(1).1);
        assert_ne!(sets.find(2).0, sets.find(0).0);
    }
}
