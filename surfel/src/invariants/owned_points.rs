//! Clouds that own their points.

use crate::{Cloud, Points, SurfelError};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Points that own what [`Points`] borrows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnedPoints {
    /// World.
    pub positions: Vec<DVec3>,
    /// See [`Points::with_normals`].
    pub normals: Option<Vec<Vec3>>,
    /// See [`Points::with_shading_normals`].
    pub shading_normals: Option<Vec<Vec3>>,
    /// See [`Points::with_colors`].
    pub colors: Option<Vec<[f32; 3]>>,
    /// See [`Points::with_radii`].
    pub radii: Option<Vec<f32>>,
    /// See [`Points::with_opacities`].
    pub opacities: Option<Vec<f32>>,
}

/// Makes points ready for drawing.
///
/// # Errors
/// As [`Cloud::new`].
pub fn cloud(points: &OwnedPoints) -> Result<Cloud, SurfelError> {
    Cloud::new(&points.as_points())
}

impl OwnedPoints {
    /// Points without anything else.
    #[must_use]
    pub fn loose(positions: Vec<DVec3>) -> Self {
        Self { positions, ..Self::default() }
    }

    /// `columns` × `rows` points about `centre`, `right` and `up` apart, that face the side from which `up` is to the
    /// left of `right`. Discs leave no gap.
    #[must_use]
    pub fn plane(centre: DVec3, right: DVec3, up: DVec3, columns: u32, rows: u32) -> Self {
        let middle = |n: u32| 0.5 * f64::from(n.saturating_sub(1));
        let at = |c: u32, r: u32| {
            centre + right * (f64::from(c) - middle(columns)) + up * (f64::from(r) - middle(rows))
        };
        let positions: Vec<DVec3> = (0..rows).flat_map(|r| (0..columns).map(move |c| at(c, r))).collect();
        let normal = right.cross(up).normalize_or(DVec3::Z).as_vec3();
        let radius = (0.5 * (right + up).length().max((right - up).length())) as f32;
        let count = positions.len();
        Self {
            positions,
            normals: Some(vec![normal; count]),
            radii: (radius > 0.0).then(|| vec![radius; count]),
            ..Self::default()
        }
    }

    /// A round sheet of about `count` points that face along `normal`.
    #[must_use]
    pub fn disc(centre: DVec3, normal: DVec3, radius: f64, count: u32) -> Self {
        let (right, up) = normal.any_orthonormal_pair();
        let at = |i: u32| {
            let (sin, cos) = golden_angle(i).sin_cos();
            centre + (right * cos + up * sin) * (radius * ((f64::from(i) + 0.5) / f64::from(count)).sqrt())
        };
        let normals = Some(vec![normal.as_vec3(); count as usize]);
        Self { normals, ..Self::loose((0..count).map(at).collect()) }
    }

    /// `count` points evenly over a sphere (R. Swinbank, R. J. Purser, *Fibonacci grids*, 2006), facing outwards.
    #[must_use]
    pub fn sphere(centre: DVec3, radius: f64, count: u32) -> Self {
        let direction = |i: u32| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (sin, cos) = golden_angle(i).sin_cos();
            DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
        };
        let directions: Vec<DVec3> = (0..count).map(direction).collect();
        Self {
            positions: directions.iter().map(|d| centre + radius * d).collect(),
            normals: Some(directions.iter().map(|d| d.as_vec3()).collect()),
            ..Self::default()
        }
    }

    /// Each point moved along `direction` by up to its length, forth or back.
    #[must_use]
    pub fn jittered(&self, direction: DVec3, seed: u64) -> Self {
        let mut random = Random(seed);
        let positions = self.positions.iter().map(|p| *p + direction * (2.0 * random.share() - 1.0));
        Self { positions: positions.collect(), ..self.clone() }
    }

    /// The same points elsewhere; their discs keep their size.
    #[must_use]
    pub fn moved(&self, map: impl Fn(DVec3) -> DVec3) -> Self {
        Self { positions: self.positions.iter().map(|p| map(*p)).collect(), ..self.clone() }
    }

    /// Positions and radii times `k`.
    #[must_use]
    pub fn resized(&self, k: f64) -> Self {
        let radii = self.radii.as_ref().map(|all| all.iter().map(|r| (f64::from(*r) * k) as f32).collect());
        Self { radii, ..self.moved(|p| p * k) }
    }

    /// Every point in the color of its place.
    #[must_use]
    pub fn painted(&self, color: impl Fn(DVec3) -> [f32; 3]) -> Self {
        Self { colors: Some(self.positions.iter().map(|p| color(*p)).collect()), ..self.clone() }
    }

    /// Every point with the opacity of its place.
    #[must_use]
    pub fn thinned(&self, opacity: impl Fn(DVec3) -> f32) -> Self {
        Self { opacities: Some(self.positions.iter().map(|p| opacity(*p)).collect()), ..self.clone() }
    }

    /// Both lots of points, with the attributes that both have.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        fn both<T: Clone>(a: Option<&Vec<T>>, b: Option<&Vec<T>>) -> Option<Vec<T>> {
            Some([a?.as_slice(), b?.as_slice()].concat())
        }
        Self {
            positions: [self.positions.as_slice(), other.positions.as_slice()].concat(),
            normals: both(self.normals.as_ref(), other.normals.as_ref()),
            shading_normals: both(self.shading_normals.as_ref(), other.shading_normals.as_ref()),
            colors: both(self.colors.as_ref(), other.colors.as_ref()),
            radii: both(self.radii.as_ref(), other.radii.as_ref()),
            opacities: both(self.opacities.as_ref(), other.opacities.as_ref()),
        }
    }

    /// The same points in another order. Attributes that are not as many as points stay as they are.
    #[must_use]
    pub fn shuffled(&self, seed: u64) -> Self {
        fn reordered<T: Clone>(all: Option<&Vec<T>>, order: &[usize]) -> Option<Vec<T>> {
            let all = all?;
            let complete = all.len() == order.len();
            Some(if complete { order.iter().map(|i| all[*i].clone()).collect() } else { all.clone() })
        }
        let mut random = Random(seed);
        let mut order: Vec<usize> = (0..self.positions.len()).collect();
        for i in (1..order.len()).rev() {
            order.swap(i, (random.share() * (i as f64 + 1.0)) as usize);
        }
        Self {
            positions: order.iter().map(|i| self.positions[*i]).collect(),
            normals: reordered(self.normals.as_ref(), &order),
            shading_normals: reordered(self.shading_normals.as_ref(), &order),
            colors: reordered(self.colors.as_ref(), &order),
            radii: reordered(self.radii.as_ref(), &order),
            opacities: reordered(self.opacities.as_ref(), &order),
        }
    }

    /// As the crate takes them.
    #[must_use]
    pub fn as_points(&self) -> Points<'_> {
        Points {
            positions: &self.positions,
            normals: self.normals.as_deref(),
            shading_normals: self.shading_normals.as_deref(),
            colors: self.colors.as_deref(),
            radii: self.radii.as_deref(),
            opacities: self.opacities.as_deref(),
        }
    }
}

/// Steps of this angle never come near a place where they were: TAU / φ².
fn golden_angle(i: u32) -> f64 {
    f64::from(i) * TAU * 0.381_966_011_250_105_15
}

/// Knuth's MMIX generator: good enough to shuffle.
struct Random(u64);

impl Random {
    /// 0 to 1, without 1.
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as f64 / (1u64 << 32) as f64
    }
}
