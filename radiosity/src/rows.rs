//! Row sums of the matrix of form factors, and their correction to at most 1.
//!
//! A link between groups holds the mean form factor of their patches. In truth a patch that looks into a corner, or at a lamp a hand's breadth
//! away, sees less of what is far than the mean does: its own links fill its hemisphere. Two steps correct that:
//!
//! 1. *Shares* ([`Transport::share_links`]): what arrives at a group is distributed over its children so that none gets more than its own links
//!    leave room for; what it cannot take goes to its siblings. The group as a source is the mean of its patches by the same shares, so that
//!    the form factors of patches stay reciprocal, and no light is lost or made: a patch that cannot see through the lamp before it does not
//!    send through it, either.
//! 2. *Scales* ([`Transport::even_rows`]): rows that are above 1 by their own links alone, an error of form factors, are scaled.

use crate::transport::Transport;

impl Transport {
    /// Sum of the form factors of each patch, in the order of the patches. Links of the elements that contain the patch are included. In a
    /// closed scene the exact sum is 1 (\[2\]). Cost: every link and every element once.
    #[must_use]
    pub fn row_sums(&self) -> Vec<f64> {
        let mut of_element = vec![0.0; self.scene.tree.elements.len()];
        for (i, sum) in of_element.iter_mut().enumerate() {
            *sum = self.row(i as u32).iter().map(|e| e.factor).sum();
        }
        for (i, element) in self.scene.tree.elements.iter().enumerate() {
            for child in element.children() {
                // Children have larger indices than their parents, so a parent's sum is complete here.
                of_element[child as usize] += of_element[i] * self.shares[child as usize];
            }
        }
        self.leaves.iter().zip(&self.scale).map(|(&leaf, scale)| of_element[leaf as usize] * scale).collect()
    }

    /// Distributes what arrives along the links of groups over their patches ([`Transport::shares`]).
    ///
    /// 1. From the leaves up: the room of a patch is 1 less its own links, that of a group the mean of its children less its own links.
    /// 2. From the roots down: each child gets its parent's mean, or what it has room for if that is less. The rest goes to its siblings in proportion to the
    ///    room that they have beyond the mean; what none has room for is dropped.
    pub(crate) fn share_links(&mut self) {
        let elements = &self.scene.tree.elements;
        let own: Vec<f64> =
            (0..elements.len()).map(|i| self.row(i as u32).iter().map(|e| e.factor).sum()).collect();
        let area = |i: u32| elements[i as usize].polygon.area();
        let mut room: Vec<f64> = own.iter().map(|o| 1.0 - o).collect();
        for (i, element) in elements.iter().enumerate().rev().filter(|(_, e)| !e.is_leaf()) {
            let (all, whole) = element.children().fold((0.0, 0.0), |(sum, whole), child| {
                (sum + area(child) * room[child as usize].max(0.0), whole + area(child))
            });
            room[i] = all / whole - own[i];
        }
        let mut arriving = own;
        for (i, element) in elements.iter().enumerate().filter(|(_, e)| !e.is_leaf()) {
            let mean = arriving[i];
            let (mut above, mut below) = (0.0, 0.0);
            for child in element.children() {
                let room = room[child as usize].max(0.0);
                above += area(child) * (mean - room).max(0.0);
                below += area(child) * (room - mean).max(0.0);
            }
            let given = if below > 0.0 { (above / below).min(1.0) } else { 0.0 };
            for child in element.children() {
                let room = room[child as usize].max(0.0);
                let gets = if room < mean { room } else { mean + given * (room - mean) };
                // Without anything that arrives, or anything that overflows, children are as their parent.
                let share = if above > 0.0 && mean > 0.0 { gets / mean } else { 1.0 };
                self.shares[child as usize] = share;
                arriving[child as usize] += share * mean;
            }
        }
    }

    /// Scales rows so that no sum exceeds 1.
    ///
    /// For each surface:
    ///
    /// 1. Rows with a sum above 1 are scaled to 1. `above` is the area times the excess, summed over these rows.
    /// 2. `above` is given to the rows with sums between 0 and 1, in proportion to what each lacks to 1. The surface's sum stays the same.
    /// 3. If the rows lack less than `above` in total, all become 1 and the rest of the excess, an error of the factors, is dropped.
    pub(crate) fn even_rows(&mut self) {
        let sums = self.row_sums();
        let mut first = 0;
        for &root in &self.scene.tree.roots {
            let mut areas = vec![];
            let elements = &self.scene.tree.elements;
            self.scene
                .tree
                .leaves_below(root, &mut |leaf| areas.push(elements[leaf as usize].polygon.area()));
            let rows = first..first + areas.len();
            first = rows.end;
            let (mut above, mut below) = (0.0, 0.0);
            for (&sum, area) in sums[rows.clone()].iter().zip(&areas) {
                above += area * (sum - 1.0).max(0.0);
                below += if sum > 0.0 { area * (1.0 - sum).max(0.0) } else { 0.0 };
            }
            let share = if below > 0.0 { (above / below).min(1.0) } else { 0.0 };
            for (scale, &sum) in self.scale[rows.clone()].iter_mut().zip(&sums[rows]) {
                let wanted = if sum > 1.0 { 1.0 } else { sum + share * (1.0 - sum) };
                if sum > 0.0 && wanted != sum {
                    *scale *= wanted / sum;
                }
            }
        }
    }
}
