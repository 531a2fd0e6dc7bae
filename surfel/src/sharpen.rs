//! Colors of links, sharpened by what drawing them will blur.
//!
//! A link has the mean color of the area that it stands for, and its kernel spreads that once more. Both blur like a
//! kernel of variance v along each axis, which changes a color c by ½·v·Δc. Of the colors around a link, at distances d,
//! the mean m tells the Laplacian: m − c = ¼·mean(d²)·Δc on a surface. So c + 2·v/mean(d²)·(c − m) blurs to c, as in the
//! prefilters of interpolating splines.

use crate::lattice::between;
use crate::links::{DIVISIONS, Link, RADIUS_PER_ROOT_AREA};
use crate::octree::Cube;
use crate::splat::DEVIATION_PER_RADIUS;
use glam::Vec3;
use pointillist_parallel as parallel;

/// Variance along an axis of the blur of a link, in the area that it stands for: of its kernel and of a square.
const VARIANCE: f32 =
    DEVIATION_PER_RADIUS * DEVIATION_PER_RADIUS * RADIUS_PER_ROOT_AREA * RADIUS_PER_ROOT_AREA + 1.0 / 12.0;

/// Pairs drawn as one blur twice as much, and a level is drawn both ways. Found by experiment: 1 and 1.8 leave larger
/// errors at an eighth of the full size and at a quarter.
const AMOUNT: f32 = 1.4;

/// Variance of the Gaussian by which links around count, in the area of the link. Anything from 0.4 to 0.7 does as well.
const REACH: f32 = 0.5;

/// Links whose normals have a smaller product than this are not on the same surface.
const ALIKE: f32 = 0.5;

/// A link in a cell of the grid of its level, which is that in which links are made.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    level: u32,
    cell: [u32; 3],
    cube: u32,
    link: u32,
}

/// Sharpens the colors of all links, within the range of those of points. Nothing with opacities: their edges would have to
/// be sharpened alike.
pub(crate) fn sharpen(cubes: &[Cube], links: &mut [Vec<Link>], of_points: &[[f32; 3]]) {
    let range = range(of_points);
    let lists = cubes.iter().zip(&*links).zip(0..);
    let of_cube = |((cube, list), number): ((&Cube, &Vec<Link>), u32)| {
        let (level, cells) = (cube.level, list.iter().map(|l| cell(cube.level, l)).collect::<Vec<_>>());
        cells.into_iter().zip(0..).map(move |(cell, link)| Place { level, cell, cube: number, link })
    };
    let mut places: Vec<Place> = lists.flat_map(of_cube).collect();
    places.sort_unstable();
    let colors = parallel::map_heavy(cubes.len(), |number| {
        let own = links[number].iter().zip(0..);
        own.map(|(link, i)| {
            let mut around = Around::NOTHING;
            for place in nearby(&places, cubes[number].level, cell(cubes[number].level, link)) {
                if (place.cube as usize, place.link) != (number, i) {
                    around.add(link, &links[place.cube as usize][place.link as usize]);
                }
            }
            around.sharpened(link).clamp(range[0], range[1])
        })
        .collect::<Vec<_>>()
    });
    for (link, color) in links.iter_mut().flatten().zip(colors.into_iter().flatten()) {
        link.color = color;
    }
}

/// Least and largest of each channel.
fn range(colors: &[[f32; 3]]) -> [Vec3; 2] {
    let nothing = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    colors.iter().map(|c| Vec3::from(*c)).fold(nothing, |[low, high], c| [low.min(c), high.max(c)])
}

/// The cell of a link in the grid of a level.
fn cell(level: u32, link: &Link) -> [u32; 3] {
    link.cell.map(|c| c >> u32::BITS.saturating_sub(level + DIVISIONS))
}

/// The links in a cell and in the 26 around it.
fn nearby(places: &[Place], level: u32, [x, y, z]: [u32; 3]) -> impl Iterator<Item = &Place> {
    let span = |v: u32| v.saturating_sub(1)..=v.saturating_add(1);
    let rows = span(x).flat_map(move |x| span(y).map(move |y| (x, y)));
    rows.flat_map(move |(x, y)| {
        let (first, last) = ((level, [x, y, z.saturating_sub(1)]), (level, [x, y, z.saturating_add(1)]));
        let start = places.partition_point(|p| (p.level, p.cell) < first);
        places[start..].iter().take_while(move |p| (p.level, p.cell) <= last)
    })
}

/// Weighted sums over the links around one.
struct Around {
    weight: f32,
    color: Vec3,
    /// The ways there, their lengths, and the squares of these.
    way: Vec3,
    length: f32,
    length2: f32,
}

impl Around {
    const NOTHING: Self = Self { weight: 0.0, color: Vec3::ZERO, way: Vec3::ZERO, length: 0.0, length2: 0.0 };

    fn add(&mut self, link: &Link, other: &Link) {
        if link.normal.dot(other.normal) < ALIKE {
            return;
        }
        let way = between(link.cell, other.cell);
        let length2 = way.length_squared();
        let weight = other.area * (-length2 / (2.0 * REACH * link.area)).exp();
        self.weight += weight;
        self.color += other.color * weight;
        self.way += way * weight;
        self.length += length2.sqrt() * weight;
        self.length2 += length2 * weight;
    }

    /// The color of a link with these around it. Where they lie to one side of it, at a border of the surface or of a
    /// level, a slope of color would pass for a bend: the less they surround it the less is changed.
    fn sharpened(&self, link: &Link) -> Vec3 {
        if self.weight < LEAST_AROUND * link.area {
            return link.color;
        }
        let mean = self.color / self.weight;
        let surrounded = 1.0 - self.way.length() / self.length;
        let amount = AMOUNT * 2.0 * VARIANCE * link.area * self.weight / self.length2;
        let change = (link.color - mean) * (amount.min(MOST) * surrounded * surrounded);
        // Not below 0, and not farther above than that: what is dark between bright links must not make these brighter on the whole.
        let change = change.clamp(-link.color, link.color);
        if change.is_finite() { link.color + change } else { link.color }
    }
}

/// Links around that count for less than this, in areas of the link, are left out: they are so far away that they would change its color by two
/// hundredths of the difference, and the numbers of those that are farther have no digits left.
const LEAST_AROUND: f32 = 1e-12;

/// Most that differences from the mean around are enlarged by: links may lie as close together as they like.
const MOST: f32 = 1.5;

#[cfg(test)]
mod tests {
    use super::*;

    /// Links a step apart on a plane of 16 × 16 of them, in one cube; colors of points have this range.
    fn sharpened(range: [f32; 2], color: impl Fn(u32, u32) -> f32) -> Vec<f32> {
        let step = 1 << 26;
        let link = |i: u32| Link {
            point: i,
            cell: [(i % 16 + 8) * step, (i / 16 + 8) * step, 1 << 31],
            area: (f64::from(step) / 4_294_967_296.0).powi(2) as f32,
            normal: Vec3::Z,
            shading_normal: None,
            color: Vec3::splat(color(i % 16, i / 16)),
            opacity: 1.0,
        };
        let cube = Cube { points: 0..256, level: 3, children: 1..2 };
        let mut links = [(0..256).map(link).collect::<Vec<_>>()];
        sharpen(&[cube], &mut links, &range.map(|c| [c; 3]));
        links[0].iter().map(|l| l.color.x).collect()
    }

    #[test]
    fn slopes_stay_and_waves_grow() {
        let slope = sharpened([0.0, 9.0], |x, y| 1.0 + 0.1 * x as f32 + 0.05 * y as f32);
        let wave = sharpened([0.0, 2.0], |x, _| 1.0 + 0.5 * (x as f32 * std::f32::consts::FRAC_PI_2).cos());
        for (x, y) in (1..15).flat_map(|x| (1..15).map(move |y| (x, y))) {
            let i = (y * 16 + x) as usize;
            let (x, y) = (x as f32, y as f32);
            assert!((slope[i] - (1.0 + 0.1 * x + 0.05 * y)).abs() < 1e-5, "{x}, {y}: {}", slope[i]);
            // A kernel of this variance would leave exp(−½·v·k²) of the wave.
            let left = (-0.5 * VARIANCE * std::f32::consts::FRAC_PI_2.powi(2)).exp();
            let of_wave = (wave[i] - 1.0) / (0.5 * (x * std::f32::consts::FRAC_PI_2).cos());
            if (x as u32).is_multiple_of(2) {
                assert!(of_wave > 1.15 && of_wave * left < 1.2, "{x}, {y}: {of_wave}");
            }
        }
    }

    #[test]
    fn colors_stay_within_bounds() {
        let spot = sharpened([0.0, 100.0], |x, y| if (x, y) == (7, 7) { 100.0 } else { 0.0 });
        assert!(spot.iter().all(|c| (0.0..=100.0).contains(c)), "{spot:?}");
        let even = sharpened([0.0, 1.0], |_, _| 0.3);
        assert!(even.iter().all(|c| (c - 0.3).abs() < 1e-6), "{even:?}");
    }
}
