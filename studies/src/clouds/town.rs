//! A town of points: as many as are asked for, always the same ones, in blocks that need nobody else, so that it is never in memory.
//!
//! Blocks of 40 m are streets with a building or a park on hilly ground, at national coordinates, as a survey from the air and from the street has
//! them: about [`DENSITY`] points to the square metre, with noise of 2 cm, in classes of LAS.

use glam::{DVec2, DVec3, dvec2, dvec3};

/// Points per square metre.
const DENSITY: f64 = 20.0;

/// Side of a block, and the width of the street along each of its sides, metres.
const BLOCK: f64 = 40.0;
const STREET: f64 = 6.0;

/// Points of a block, in the mean.
const BLOCK_POINTS: f64 = 53_000.0;

/// The corner of all towns with the lowest coordinates.
const CORNER: DVec2 = DVec2::new(412_000.0, 5_318_000.0);

const GROUND: f32 = 2.0;
const VEGETATION: f32 = 5.0;
const BUILDING: f32 = 6.0;

/// A square town.
#[derive(Clone, Copy, Debug)]
pub(super) struct Town {
    /// Blocks along a side.
    pub(super) side: u32,
}

/// Points of a block with their classes.
#[derive(Debug, Default)]
pub(super) struct Block {
    pub(super) positions: Vec<DVec3>,
    pub(super) classes: Vec<f32>,
}

/// Numbers from 0 to 1, by which all of a block is drawn.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        // SplitMix64 (Steele, Lea, Flood 2014).
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn ground(at: DVec2) -> f64 {
    6.0 * (at.x / 90.0).sin() * (at.y / 70.0).cos()
}

impl Town {
    /// A town of about so many points.
    pub(super) fn of(points: f64) -> Self {
        Self { side: (points / BLOCK_POINTS).sqrt().round().max(1.0) as u32 }
    }

    /// The middle, on the ground.
    pub(super) fn middle(&self) -> DVec3 {
        let at = DVec2::splat(0.5 * BLOCK * f64::from(self.side));
        (CORNER + at).extend(ground(at))
    }

    /// All points are between these.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let far = CORNER + DVec2::splat(BLOCK * f64::from(self.side));
        [(CORNER - 1.0).extend(-10.0), (far + 1.0).extend(60.0)]
    }

    /// The points of all blocks, row by row.
    pub(super) fn blocks(self) -> impl Iterator<Item = Block> {
        (0..self.side).flat_map(move |y| (0..self.side).map(move |x| Block::at(x, y)))
    }
}

impl Block {
    fn at(x: u32, y: u32) -> Self {
        let mut random = Random(u64::from(x) << 32 | u64::from(y));
        let low = dvec2(f64::from(x), f64::from(y)) * BLOCK;
        let mut block = Self::default();
        let is_park = random.next() < 0.2;
        // A building's footprint, in the block.
        let margin = dvec2(STREET + 4.0 * random.next(), STREET + 4.0 * random.next());
        let foot = (!is_park).then_some([margin, DVec2::splat(BLOCK) - margin]);
        let height = 5.0 + 17.0 * random.next() * random.next();
        let roof = ground(low + 0.5 * BLOCK) + height;
        block.cover(low, foot, roof, &mut random);
        match foot {
            Some(foot) => block.walls(low, foot, roof, &mut random),
            None => (0..12).for_each(|_| block.tree(low, &mut random)),
        }
        block
    }

    fn add(&mut self, position: DVec3, class: f32, random: &mut Random) {
        let noise = 0.02 * (random.next() + random.next() + random.next() - 1.5);
        self.positions.push(CORNER.extend(0.0) + position + DVec3::Z * noise);
        self.classes.push(class);
    }

    /// Ground and roof, a point in each cell of a grid.
    fn cover(&mut self, low: DVec2, foot: Option<[DVec2; 2]>, roof: f64, random: &mut Random) {
        let cells = (BLOCK * DENSITY.sqrt()).round() as u32;
        for cell in 0..cells * cells {
            let at = dvec2(f64::from(cell % cells) + random.next(), f64::from(cell / cells) + random.next());
            let at = at * (BLOCK / f64::from(cells));
            let is_roof = foot.is_some_and(|[a, b]| at.cmpge(a).all() && at.cmple(b).all());
            let (z, class) = if is_roof { (roof, BUILDING) } else { (ground(low + at), GROUND) };
            self.add((low + at).extend(z), class, random);
        }
    }

    fn walls(&mut self, low: DVec2, [a, b]: [DVec2; 2], roof: f64, random: &mut Random) {
        let corners = [a, dvec2(b.x, a.y), b, dvec2(a.x, b.y)];
        for (i, &from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % 4];
            let bottom = ground(low + from).min(ground(low + to)) - 0.5;
            let (columns, rows) =
                [from.distance(to), roof - bottom].map(|side| (side * DENSITY.sqrt()).ceil() as u32).into();
            for cell in 0..columns * rows {
                let along = (f64::from(cell % columns) + random.next()) / f64::from(columns);
                let up = (f64::from(cell / columns) + random.next()) / f64::from(rows);
                let at = (low + from.lerp(to, along)).extend(bottom + up * (roof - bottom));
                self.add(at, BUILDING, random);
            }
        }
    }

    /// A crown of leaves.
    fn tree(&mut self, low: DVec2, random: &mut Random) {
        let radius = 1.5 + 2.0 * random.next();
        let reach = BLOCK - 2.0 * (STREET + radius);
        let foot = low + STREET + radius + dvec2(random.next(), random.next()) * reach;
        let middle = foot.extend(ground(foot) + radius + 2.0);
        let points = (4.0 * std::f64::consts::PI * radius * radius * DENSITY) as u32;
        for _ in 0..points {
            let z = 2.0 * random.next() - 1.0;
            let (sin, cos) = (std::f64::consts::TAU * random.next()).sin_cos();
            let way = dvec3(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z;
            self.add(middle + way * radius * (0.85 + 0.15 * random.next()), VEGETATION, random);
        }
    }
}
