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
    /// Receivers whose group or face has no caster near: lit without a test.
    pub lit_by_group: u64,
    /// Receivers whose group or face is wholly covered by a caster, or by casters that share edges: dark without a test.
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

impl ShadowCounts {
    /// So many receivers that are lit or dark without a test of their own, if they are.
    pub(crate) fn settle(&mut self, fraction: Option<f64>, receivers: u64) {
        self.lit_by_group += receivers * u64::from(fraction == Some(1.0));
        self.dark_by_group += receivers * u64::from(fraction == Some(0.0));
    }
}

/// Counts of work done and of work skipped for lights with an area and lines that shine, summed over calls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct AreaCounts {
    /// Receivers asked about.
    pub receivers: u64,
    /// Receivers left out: behind the light, or with all of it below their horizon.
    pub facing_away: u64,
    /// Points at which receivers were asked.
    pub points: u64,
    /// Points whose group has no caster near: they see the whole light, without a test.
    pub lit_by_group: u64,
    /// Points that see nothing of the light.
    pub dark: u64,
    /// Casters of all groups in sum.
    pub casters: u64,
}

impl std::ops::AddAssign for AreaCounts {
    fn add_assign(&mut self, o: Self) {
        self.receivers += o.receivers;
        self.facing_away += o.facing_away;
        self.points += o.points;
        self.lit_by_group += o.lit_by_group;
        self.dark += o.dark;
        self.casters += o.casters;
    }
}

impl AreaCounts {
    /// Receivers of a batch, of which some are asked.
    pub(crate) fn batch(&mut self, receivers: usize, asked: usize) {
        self.receivers += receivers as u64;
        self.facing_away += (receivers - asked) as u64;
    }

    /// A point that was asked.
    pub(crate) fn point(&mut self, has_casters: bool, is_dark: bool) {
        self.points += 1;
        self.lit_by_group += u64::from(!has_casters && !is_dark);
        self.dark += u64::from(is_dark);
    }
}
