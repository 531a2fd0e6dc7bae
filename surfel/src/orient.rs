//! The same side for normals of one surface.
//!
//! Two neighbouring normals vote for facing the same way or opposite ways, from 1 to −1. On any arc of a circle a normal is the
//! other one's mirror image in the plane half-way between the points, so the vote is the product of the one and of the mirrored other: it is certain across a
//! bend as well as between the two faces of a thin sheet (S. König, S. Gumhold, *Consistent propagation of normal orientations in point
//! clouds*, VMV 2009; the product of both normals, as H. Hoppe et al. have it, is wrong for the latter).
//!
//! 1. Clear votes are followed at once. A cloud becomes a few *patches*.
//! 2. Between patches there are votes that contradict one another, along sharp edges and where surfaces touch. They are added up, and those two
//!    patches are joined for which the sum is largest, until nothing is left to join (greedy additive contraction; the problem is that of N. Schertler, B.
//!    Savchynskyy, S. Gumhold, *Towards globally optimal normal orientations for large point clouds*, CGF 2017).
//!
//! Nothing depends on the order of points, because places have an order of their own.

use crate::neighbours::Places;
use crate::signed_sets::SignedSets;
use glam::DVec3;
use pointillist_parallel as parallel;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap};

/// Neighbours of a place that vote.
pub(crate) const VOTERS: usize = 8;

/// The nearest places around one, itself not among them; its own number where there are fewer.
pub(crate) type Around = [u32; VOTERS];

/// Votes of at least this weight are followed at once. Of 97,000 points of the Stanford Dragon, whose crest and claws are thin, 291 have the wrong
/// side if none is, in 0.7 s more, 302 with this, and 439 with 0.95.
const CLEAR: f32 = 0.98;

/// The share of a place's votes that may be against what was found. On average surfaces none is; of the 302 places above, this finds 81, and
/// 166 others near them.
const DISPUTED: f32 = 0.2;

/// Which places are on one surface, and on which side of it their normals stand.
pub(crate) struct Orientation {
    /// Of each place, one that stands for its surface.
    pub(crate) surfaces: Vec<u32>,
    /// Whether its normal stands on the side that is not that of the other place.
    pub(crate) turned: Vec<bool>,
    /// Whether some of the neighbours are for the other side.
    pub(crate) disputed: Vec<bool>,
}

impl Orientation {
    /// Compares the normals of all places with those around them. Which side of a surface is outside is not known.
    pub(crate) fn of(places: &Places, normals: &[DVec3], around: &[Around]) -> Self {
        let votes =
            parallel::map(places.len(), |i| around[i].map(|j| vote(places, normals, i, j as usize) as f32));
        let all = || {
            let of = |(i, (near, votes)): (usize, (&Around, &[f32; VOTERS]))| {
                std::array::from_fn::<_, VOTERS, _>(|k| (i as u32, near[k], votes[k]))
            };
            around.iter().zip(&votes).enumerate().flat_map(of).filter(|(i, j, _)| i != j)
        };
        let mut sets = SignedSets::new(places.len());
        // 1
        for (i, j, vote) in all().filter(|(_, _, vote)| vote.abs() >= CLEAR) {
            sets.unite(i, j, vote < 0.0);
        }
        // 2
        let mut sums = Sums::default();
        for (i, j, vote) in all() {
            let ((a, a_opposite), (b, b_opposite)) = (sets.find(i), sets.find(j));
            if a != b {
                sums.add(a, b, f64::from(if a_opposite == b_opposite { vote } else { -vote }));
            }
        }
        sums.contract(&mut sets);
        let (surfaces, turned): (Vec<u32>, Vec<bool>) =
            (0..places.len() as u32).map(|i| sets.find(i)).unzip();
        let is_disputed = |(i, (near, votes)): (usize, (&Around, &[f32; VOTERS]))| {
            let is_against = |&(j, vote): &(&u32, &f32)| (*vote < 0.0) == (turned[i] == turned[*j as usize]);
            let weight = |(_, vote): (&u32, &f32)| vote.abs();
            let against: f32 = near.iter().zip(votes).filter(is_against).map(weight).sum();
            against > DISPUTED * near.iter().zip(votes).map(weight).sum::<f32>()
        };
        let disputed = around.iter().zip(&votes).enumerate().map(is_disputed).collect();
        Self { surfaces, turned, disputed }
    }
}

/// From 1 where the normals of two places stand on one side to −1 where they stand on opposite ones.
fn vote(places: &Places, normals: &[DVec3], i: usize, j: usize) -> f64 {
    let way = (places.at(j) - places.at(i)).normalize_or_zero();
    normals[i].dot(normals[j]) - 2.0 * way.dot(normals[i]) * way.dot(normals[j])
}

/// Sums of the votes between sets, by one member of each; both ways.
#[derive(Default)]
struct Sums(BTreeMap<u32, BTreeMap<u32, f64>>);

impl Sums {
    fn add(&mut self, a: u32, b: u32, vote: f64) {
        *self.0.entry(a).or_default().entry(b).or_default() += vote;
        *self.0.entry(b).or_default().entry(a).or_default() += vote;
    }

    fn get(&self, a: u32, b: u32) -> Option<f64> {
        self.0.get(&a)?.get(&b).copied()
    }

    /// Joins the two sets with the largest sum of votes between them, again and again.
    fn contract(mut self, sets: &mut SignedSets) {
        let pairs = |(&a, of): (&u32, &BTreeMap<u32, f64>)| {
            of.range(a + 1..).map(|(&b, sum)| Sum(sum.abs(), a, b)).collect::<Vec<_>>()
        };
        let mut queue: BinaryHeap<Sum> = self.0.iter().flat_map(pairs).collect();
        while let Some(Sum(weight, a, b)) = queue.pop() {
            // Sums that have changed since are in the queue again.
            let Some(sum) = self.get(a, b).filter(|sum| sum.abs() == weight) else { continue };
            sets.unite(a, b, sum < 0.0);
            // The one with more neighbours stands for both.
            let (kept, gone) = if self.0[&a].len() >= self.0[&b].len() { (a, b) } else { (b, a) };
            for (other, own) in self.0.remove(&gone).unwrap_or_default() {
                self.0.entry(other).or_default().remove(&gone);
                if other != kept {
                    self.add(kept, other, if sum < 0.0 { -own } else { own });
                    let new = self.get(kept, other).unwrap_or_default();
                    queue.push(Sum(new.abs(), kept.min(other), kept.max(other)));
                }
            }
        }
    }
}

/// The weight of the votes between two sets: the largest first, of equal ones that of the first sets.
struct Sum(f64, u32, u32);

impl Ord for Sum {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(other.1.cmp(&self.1)).then(other.2.cmp(&self.2))
    }
}

impl PartialOrd for Sum {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Sum {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Sum {}
