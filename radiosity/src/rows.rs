//! Row sums of the matrix of form factors, and their correction to at most 1.

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
                of_element[child as usize] += of_element[i];
            }
        }
        self.leaves.iter().zip(&self.scale).map(|(&leaf, scale)| of_element[leaf as usize] * scale).collect()
    }

    /// Scales rows so that no sum exceeds 1, and returns the largest relative change of a row
    /// ([`LinkCounts::row_change`](crate::LinkCounts::row_change)).
    ///
    /// A link between groups holds the mean form factor of its patches. It is too large for a patch in a corner and too small for the
    /// patch's neighbours, while the area-weighted sum over the whole surface is right. For each surface:
    ///
    /// 1. Rows with a sum above 1 are scaled to 1. `above` is the area times the excess, summed over these rows.
    /// 2. `above` is given to the rows with sums between 0 and 1, in proportion to what each lacks to 1. The surface's sum stays the same.
    /// 3. If the rows lack less than `above` in total, all become 1 and the rest of the excess, an error of the factors, is dropped.
    pub(crate) fn even_rows(&mut self) -> f64 {
        let sums = self.row_sums();
        let (mut first, mut most) = (0, 0.0_f64);
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
                    most = most.max((wanted / sum - 1.0).abs());
                }
            }
        }
        most
    }
}
