//! The receivers of a batch in the frame of a light, and how they are grouped.

use super::light::Frame;
use super::piece::{self, Piece, around};
use crate::receiver::{Receivers, Viewer};
use glam::DVec3;
use pointillist_micropoint::{Face, Geometry};

pub(crate) type Box3 = (DVec3, DVec3);

/// A receiver in the frame of a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    pub(crate) receiver: u32,
    /// Unit normal of its surface, on the side that is seen.
    pub(crate) normal: DVec3,
    /// What it gives to the picture over what it would give with nothing in front.
    pub(crate) visibility: f64,
    pub(crate) bounds: Box3,
    pub(crate) first_piece: u32,
    pub(crate) piece_count: u32,
}

/// The receivers of a batch that may see something of a light.
#[derive(Debug, Default)]
pub(crate) struct Targets {
    pub(crate) list: Vec<Target>,
    pub(crate) pieces: Vec<Piece>,
    pub(crate) corners: Vec<DVec3>,
}

impl Targets {
    /// Takes the receivers that `is_lit`: of a face, its corners in the light's frame, their greatest coordinates, and its normal there.
    pub(crate) fn collect(
        &mut self,
        (geometry, frame): (&Geometry, &Frame),
        viewer: Viewer<'_>,
        receivers: &Receivers,
        is_lit: impl Fn(&Face, &[DVec3], DVec3, DVec3) -> bool,
    ) {
        let Self { list: targets, pieces, corners } = self;
        targets.clear();
        pieces.clear();
        corners.clear();
        let offset = viewer.lens.origin - frame.origin;
        let mut next = 0;
        while let Some(receiver) = receivers.list.get(next) {
            let index = next as u32;
            let (first_piece, first_corner) = (pieces.len(), corners.len());
            for (i, r) in receivers.list[next..].iter().enumerate() {
                if i > 0 && !r.joins {
                    break;
                }
                next += 1;
                if r.weight > 0.0 {
                    let first = corners.len();
                    corners.extend(receivers.corners(viewer, r).map(|c| frame.local_vector(c + offset)));
                    let (middle, _) = piece::middle(&corners[first..]);
                    let corner_count = (corners.len() - first) as u32;
                    pieces.push(Piece { first_corner: first as u32, corner_count, weight: r.weight, middle });
                }
            }
            let own = &corners[first_corner..];
            let (low, high) = around(own.iter());
            let face = &viewer.faces[receiver.face as usize];
            let normal = seen_normal(geometry, frame, face);
            let lit = is_lit(face, own, high, normal);
            if !(lit && low.is_finite() && high.is_finite()) {
                pieces.truncate(first_piece);
                corners.truncate(first_corner);
                continue;
            }
            targets.push(Target {
                receiver: index,
                normal,
                visibility: receiver.visibility,
                bounds: (low, high),
                first_piece: first_piece as u32,
                piece_count: (pieces.len() - first_piece) as u32,
            });
        }
    }
}

/// Unit normal of a face on the side that the viewer sees, in the light's frame.
fn seen_normal(geometry: &Geometry, frame: &Frame, face: &Face) -> DVec3 {
    let [a, b, c] = geometry.corners(face.source);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    frame.local_vector(if face.front { normal } else { -normal })
}

pub(crate) fn bounds(targets: &[Target]) -> Box3 {
    let union = |a: Box3, t: &Target| (a.0.min(t.bounds.0), a.1.max(t.bounds.1));
    targets.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), union)
}

/// Two halves of a group, side by side along the longest side of the box around it.
pub(crate) fn split(targets: &mut [Target], (low, high): Box3) -> (&mut [Target], &mut [Target]) {
    let middle = targets.len() / 2;
    let size = high - low;
    let axis = if size.x >= size.y.max(size.z) { 0 } else { 1 + usize::from(size.z > size.y) };
    let key = |t: &Target| t.bounds.0[axis] + t.bounds.1[axis];
    targets.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
    targets.split_at_mut(middle)
}
