//! What a point has beside its place, as the bytes of an octree.

use crate::cloud_io::{CloudBlock, CloudSummary, Scalar};
use glam::{DVec3, Vec3};
use pointillist_octree::{Cube, POSITION_BYTES};

/// Attributes of all points of a tree, in this order: bits of the layout number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Fields(u32);

const COLOURS: u32 = 1;
const NORMALS: u32 = 2;
const RADII: u32 = 4;
const OPACITIES: u32 = 8;
/// The first of the measured values; the others follow.
const SCALARS: u32 = 16;

/// Of the surface, beside normals that are interpolated.
const FACE_NORMALS: u32 = SCALARS << 3;

/// Bytes of each.
const SIZES: [(u32, usize); 8] = [
    (COLOURS, 6),
    (NORMALS, 12),
    (RADII, 4),
    (OPACITIES, 4),
    (SCALARS, 2),
    (SCALARS << 1, 2),
    (SCALARS << 2, 2),
    (FACE_NORMALS, 12),
];

/// Measured values have 16 bits, as in LAS; this one stands for none, and larger ones are moved below it.
const NO_VALUE: u16 = u16::MAX;

impl Fields {
    pub(super) fn of(summary: &CloudSummary) -> Self {
        let flags = [
            (summary.has_colours, COLOURS),
            (summary.has_normals, NORMALS),
            (summary.has_radii, RADII),
            (summary.has_opacities, OPACITIES),
            (summary.has_face_normals, FACE_NORMALS),
        ];
        let scalars = Scalar::ALL.map(|s| (summary.has_scalars[s as usize], SCALARS << s as u32));
        Self(flags.into_iter().chain(scalars).filter(|(has, _)| *has).fold(0, |all, (_, flag)| all | flag))
    }

    /// Of points with these values and nothing else.
    pub(super) fn of_scalars(scalars: &[Scalar]) -> Self {
        Self(scalars.iter().fold(0, |all, &scalar| all | SCALARS << scalar as u32))
    }

    pub(super) fn from_layout(layout: u32, payload: u32) -> Option<Self> {
        let fields = Self(layout);
        (layout < FACE_NORMALS << 1 && fields.bytes() == payload as usize).then_some(fields)
    }

    pub(super) fn layout(self) -> u32 {
        self.0
    }

    pub(super) fn bytes(self) -> usize {
        SIZES.iter().filter(|(flag, _)| self.has(*flag)).map(|(_, size)| size).sum()
    }

    pub(super) fn has_normals(self) -> bool {
        self.has(NORMALS)
    }

    fn has(self, flag: u32) -> bool {
        self.0 & flag != 0
    }

    /// The payload of a point of a block.
    pub(super) fn encode(self, block: &CloudBlock<'_>, i: usize, into: &mut Vec<u8>) {
        into.clear();
        let float = |into: &mut Vec<u8>, value: f32| into.extend_from_slice(&value.to_le_bytes());
        if self.has(COLOURS) {
            let colour = block.colours.map_or([0.0; 3], |all| all[i]);
            colour.iter().for_each(|&c| into.extend_from_slice(&root_code(c).to_le_bytes()));
        }
        let normal = |into: &mut Vec<u8>, all: Option<&[Vec3]>| {
            all.map_or(Vec3::Z, |all| all[i]).to_array().iter().for_each(|&n| float(into, n));
        };
        if self.has(NORMALS) {
            normal(into, block.normals);
        }
        if self.has(RADII) {
            float(into, block.radii.map_or(0.0, |all| all[i]));
        }
        if self.has(OPACITIES) {
            float(into, block.opacities.map_or(1.0, |all| all[i]));
        }
        for scalar in Scalar::ALL {
            if self.has(SCALARS << scalar as u32) {
                let value = block.scalar(scalar).map_or(f32::NAN, |all| all[i]);
                let code = if value.is_nan() { NO_VALUE } else { (value.round() as u16).min(NO_VALUE - 1) };
                into.extend_from_slice(&code.to_le_bytes());
            }
        }
        if self.has(FACE_NORMALS) {
            normal(into, block.face_normals);
        }
    }
}

/// A linear colour from 0 to 1 as 16 bits of its square root: finer than any file's where eyes are, without a power for each point.
fn root_code(linear: f32) -> u16 {
    (linear.max(0.0).sqrt() * 65_535.0 + 0.5) as u16
}

fn linear_of(code: u16) -> f32 {
    let root = f32::from(code) / 65_535.0;
    root * root
}

/// Points of a node, as columns.
#[derive(Debug, Default)]
pub(super) struct Columns {
    positions: Vec<DVec3>,
    colours: Vec<[f32; 3]>,
    normals: Vec<Vec3>,
    face_normals: Vec<Vec3>,
    radii: Vec<f32>,
    opacities: Vec<f32>,
    scalars: [Vec<f32>; 3],
    fields: Option<Fields>,
}

impl Columns {
    pub(super) fn decode(records: &[u8], fields: Fields, cube: &Cube) -> Self {
        let mut columns = Self { fields: Some(fields), ..Self::default() };
        for record in records.chunks_exact(POSITION_BYTES + fields.bytes()) {
            let mut rest = record;
            let mut word = || u32::from_le_bytes(take(&mut rest));
            columns.positions.push(cube.position([word(), word(), word()]));
            if fields.has(COLOURS) {
                columns.colours.push([(); 3].map(|()| linear_of(u16::from_le_bytes(take(&mut rest)))));
            }
            if fields.has(NORMALS) {
                columns.normals.push(take_normal(&mut rest));
            }
            if fields.has(RADII) {
                columns.radii.push(f32::from_le_bytes(take(&mut rest)));
            }
            if fields.has(OPACITIES) {
                columns.opacities.push(f32::from_le_bytes(take(&mut rest)));
            }
            for scalar in Scalar::ALL.into_iter().filter(|s| fields.has(SCALARS << *s as u32)) {
                let code = u16::from_le_bytes(take(&mut rest));
                columns.scalars[scalar as usize].push(if code == NO_VALUE { f32::NAN } else { code.into() });
            }
            if fields.has(FACE_NORMALS) {
                columns.face_normals.push(take_normal(&mut rest));
            }
        }
        columns
    }

    pub(super) fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    pub(super) fn block(&self) -> CloudBlock<'_> {
        let has = |flag: u32| self.fields.is_some_and(|fields| fields.has(flag));
        CloudBlock {
            positions: &self.positions,
            colours: has(COLOURS).then_some(&*self.colours),
            normals: has(NORMALS).then_some(&*self.normals),
            face_normals: has(FACE_NORMALS).then_some(&*self.face_normals),
            radii: has(RADII).then_some(&*self.radii),
            opacities: has(OPACITIES).then_some(&*self.opacities),
            scalars: Scalar::ALL.map(|s| has(SCALARS << s as u32).then_some(&*self.scalars[s as usize])),
        }
    }
}

fn take_normal(rest: &mut &[u8]) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| f32::from_le_bytes(take(rest))))
}

/// The next bytes of a record.
fn take<const N: usize>(rest: &mut &[u8]) -> [u8; N] {
    let (first, after) = rest.split_first_chunk().expect("a record is as long as its fields");
    *rest = after;
    *first
}
