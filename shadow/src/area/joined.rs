//! Panes that join at an edge and lie on either side of it, as the two triangles of a leaf do: what they cover adds up.

/// A pane's edge: its number, and whether the pane lies to its left as it is seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PaneEdge {
    pub(crate) number: u32,
    pub(crate) on_left: bool,
}

const NONE: u32 = u32::MAX;

/// Sets of panes that hang together by their edges, and memory.
#[derive(Debug, Default)]
pub(crate) struct Joined {
    /// For each edge, the call that knows it, and a pane on its right and on its left.
    known: Vec<(u32, [u32; 2])>,
    call: u32,
    /// For each pane one of its set that is not after it; itself for the first one.
    earlier: Vec<u32>,
    /// The first of the set, and the pane.
    order: Vec<(u32, u32)>,
}

impl Joined {
    /// Finds the sets of panes with these edges.
    pub(crate) fn find<E: IntoIterator<Item = PaneEdge>>(
        &mut self,
        edge_count: usize,
        panes: impl Iterator<Item = E>,
    ) {
        if self.call == u32::MAX || self.known.len() < edge_count {
            self.known.clear();
            self.known.resize(edge_count, (0, [NONE; 2]));
            self.call = 0;
        }
        self.call += 1;
        self.earlier.clear();
        for (pane, edges) in panes.enumerate() {
            let pane = pane as u32;
            self.earlier.push(pane);
            for edge in edges {
                let known = &mut self.known[edge.number as usize];
                if known.0 != self.call {
                    *known = (self.call, [NONE; 2]);
                }
                let sides = &mut known.1;
                let own = usize::from(edge.on_left);
                if sides[own] == NONE {
                    sides[own] = pane;
                }
                let across = sides[1 - own];
                if across != NONE {
                    self.join(pane, across);
                }
            }
        }
        self.order.clear();
        for pane in 0..self.earlier.len() as u32 {
            let first = self.first(pane);
            self.order.push((first, pane));
        }
        self.order.sort_unstable();
    }

    /// The sets, by their first panes; in each the panes rise.
    pub(crate) fn sets(&self) -> impl Iterator<Item = impl Iterator<Item = u32> + '_> + '_ {
        self.order.chunk_by(|a, b| a.0 == b.0).map(|set| set.iter().map(|&(_, pane)| pane))
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.first(a), self.first(b));
        self.earlier[a.max(b) as usize] = a.min(b);
    }

    fn first(&mut self, pane: u32) -> u32 {
        let mut pane = pane;
        loop {
            let earlier = self.earlier[pane as usize];
            if earlier == pane {
                return pane;
            }
            // Ways are halved as they are gone.
            self.earlier[pane as usize] = self.earlier[earlier as usize];
            pane = earlier;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sets(joined: &mut Joined, panes: &[&[(u32, bool)]]) -> Vec<Vec<u32>> {
        let edge = |&(number, on_left)| PaneEdge { number, on_left };
        joined.find(10, panes.iter().map(|edges| edges.iter().map(edge)));
        joined.sets().map(Iterator::collect).collect()
    }

    #[test]
    fn panes_join_across_an_edge_and_not_on_one_side_of_it() {
        let mut joined = Joined::default();
        let across: [&[_]; 3] = [&[(0, true), (1, true)], &[(5, true)], &[(1, false), (2, true)]];
        assert_eq!(sets(&mut joined, &across), [vec![0, 2], vec![1]]);
        let folded: [&[_]; 2] = [&[(0, true), (1, true)], &[(1, true), (2, true)]];
        assert_eq!(sets(&mut joined, &folded), [vec![0], vec![1]]);
        assert_eq!(sets(&mut joined, &[]), Vec::<Vec<u32>>::new());
    }

    #[test]
    fn chains_are_one_set_whatever_joins_first() {
        let mut joined = Joined::default();
        let chain: [&[_]; 4] =
            [&[(3, true)], &[(1, true), (2, false)], &[(3, false), (4, true)], &[(2, true), (4, false)]];
        assert_eq!(sets(&mut joined, &chain), [vec![0, 1, 2, 3]]);
    }
}
