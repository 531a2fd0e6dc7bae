//! Rows of the matrix: what a patch sees, all told.

use crate::transport::Transport;

impl Transport {
    /// Sum of the form factors of each patch, those of the patches that it is part of included: 1 in a closed scene.
    #[must_use]
    pub fn row_sums(&self) -> Vec<f64> {
        let mut of_element = vec![0.0; self.scene.tree.elements.len()];
        for (i, sum) in of_element.iter_mut().enumerate() {
            *sum = self.row(i as u32).iter().map(|e| e.factor).sum();
        }
        for (i, element) in self.scene.tree.elements.iter().enumerate() {
            for child in element.children() {
                // Children come after their parents, so each is complete before it is handed on.
                of_element[child as usize] += of_element[i];
            }
        }
        self.leaves.iter().zip(&self.scale).map(|(&leaf, scale)| of_element[leaf as usize] * scale).collect()
    }

    /// Scales rows so that none adds up to more than 1, and gives the largest relative change
    /// ([`LinkCounts::row_change`](crate::LinkCounts::row_change)).
    ///
    /// A link of groups is a mean: too much for a patch in a corner, too little for its neighbours. What a whole surface sees is
    /// right, and no patch sees more than all. So what rows have above 1 goes to the surface's others, each getting the same share of
    /// what it lacks: the surface's sum stays, and where that is all there is to see every row becomes 1, as it must be. Only
    /// what a surface has above 1 on the whole, by errors of its factors, is lost.
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
