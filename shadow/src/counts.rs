//! Counts of work done and of work skipped.

/// Counts of work done and of work skipped, summed over calls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ShadowCounts {
    /// Receivers asked about.
    pub receivers: u64,
    /// Receivers that show the viewer a side turned away from the light.
    pub facing_away: u64,
    /// Light screens used, summed over batches.
    pub screens: u64,
    /// Clusters whose triangles were projected.
    pub clusters: u64,
    /// Clusters skipped: outside the receivers' light, or behind them.
    pub clusters_skipped: u64,
    /// Triangles that may stand in the light of some group.
    pub casters: u64,
    /// Triangles skipped: away from receivers, behind them, or the lit side of a solid.
    pub casters_culled: u64,
    /// Receivers whose group has no caster near: lit without a test.
    pub lit_by_group: u64,
    /// Receivers behind one caster that covers their whole group: dark without a test.
    pub dark_by_group: u64,
    /// Receivers that had to be cut.
    pub partial: u64,
}

impl std::ops::AddAssign for ShadowCounts {
    fn add_assign(&mut self, o: Self) {
        self.receivers += o.receivers;
        self.facing_away += o.facing_away;
        self.screens += o.screens;
        self.clusters += o.clusters;
        self.clusters_skipped += o.clusters_skipped;
        self.casters += o.casters;
        self.casters_culled += o.casters_culled;
        self.lit_by_group += o.lit_by_group;
        self.dark_by_group += o.dark_by_group;
        self.partial += o.partial;
    }
}
