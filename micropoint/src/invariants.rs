//! Facts that hold for every scene, as functions: property tests and fuzz targets call the same ones.
//!
//! Each takes any input at all. A scene or view that is refused satisfies every fact.

use glam::{DAffine3, DVec2, DVec3};

use crate::lens::TIE;
use crate::{
    Geometry, Interval, Lens, LensKind, MicropointError, MicropointOptions, PixelRect, Placement,
    PlainOpacity, Renderer, Shape, SurfaceOpacity, Tile, View,
};

/// Rounding allowed to a sum of weights over a pixel.
pub const SUM_TOLERANCE: f64 = 1e-12;

/// Areas below this are dropped where parts are cut by one another, once per cut.
pub const CUT_TOLERANCE: f64 = 1e-9;

/// What [`CUT_TOLERANCE`] makes of a pixel's shares where the hidden sides of solids are culled.
pub const CULLED_TOLERANCE: f64 = 10.0 * CUT_TOLERANCE;

/// Triangles as a renderer gets them.
#[derive(Clone, Debug, Default)]
pub struct Soup {
    /// Corners of triangles.
    pub positions: Vec<DVec3>,
    /// Positions of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Surface of each triangle.
    pub surface_of: Vec<u32>,
    /// The surfaces.
    pub surfaces: Vec<SurfaceOpacity>,
}

impl Soup {
    /// Adds a two-sided surface.
    pub fn surface(&mut self, opacity: f32) -> u32 {
        self.surfaces.push(SurfaceOpacity { opacity, ..SurfaceOpacity::default() });
        self.surfaces.len() as u32 - 1
    }

    /// Adds a convex polygon as a fan about its first corner.
    pub fn polygon(&mut self, corners: &[DVec3], surface: u32) {
        let first = self.positions.len() as u32;
        self.positions.extend_from_slice(corners);
        for i in 2..corners.len() as u32 {
            self.triangles.push([first, first + i - 1, first + i]);
            self.surface_of.push(surface);
        }
    }

    /// Adds triangles that share positions.
    pub fn mesh(&mut self, positions: &[DVec3], triangles: &[[u32; 3]], surface: u32) {
        let first = self.positions.len() as u32;
        self.positions.extend_from_slice(positions);
        self.triangles.extend(triangles.iter().map(|t| t.map(|v| first + v)));
        self.surface_of.resize(self.triangles.len(), surface);
    }

    /// Adds a closed box.
    pub fn cuboid(&mut self, low: DVec3, high: DVec3, surface: u32) {
        let corner = |i: u32| {
            let pick = |bit: u32, l: f64, h: f64| if i >> bit & 1 == 1 { h } else { l };
            DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
        };
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles: Vec<_> = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        self.mesh(&(0..8).map(corner).collect::<Vec<_>>(), &triangles, surface);
    }

    /// Adds a closed sphere of `rows` bands of `columns` quads.
    pub fn sphere(&mut self, centre: DVec3, radius: f64, rows: u32, columns: u32, surface: u32) {
        let mut positions = vec![centre + DVec3::Z * radius, centre - DVec3::Z * radius];
        for r in 1..rows {
            let theta = std::f64::consts::PI * f64::from(r) / f64::from(rows);
            for c in 0..columns {
                let phi = std::f64::consts::TAU * f64::from(c) / f64::from(columns);
                let (s, z) = theta.sin_cos();
                positions.push(centre + DVec3::new(s * phi.cos(), s * phi.sin(), z) * radius);
            }
        }
        let at = |r: u32, c: u32| match r {
            0 => 0,
            r if r == rows => 1,
            r => 2 + (r - 1) * columns + c % columns,
        };
        let mut triangles = vec![];
        for (r, c) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
            let (a, b, d, e) = (at(r, c), at(r + 1, c), at(r + 1, c + 1), at(r, c + 1));
            triangles.extend(
                [[a, b, d], [a, d, e]].iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]),
            );
        }
        self.mesh(&positions, &triangles, surface);
    }

    /// The same scene elsewhere.
    #[must_use]
    pub fn moved(&self, map: impl Fn(DVec3) -> DVec3) -> Self {
        Self { positions: self.positions.iter().map(|&p| map(p)).collect(), ..self.clone() }
    }

    /// The same triangles in another order: the new triangle `i` is the old `order[i]`.
    #[must_use]
    pub fn reordered(&self, order: &[u32]) -> Self {
        Self {
            triangles: order.iter().map(|&i| self.triangles[i as usize]).collect(),
            surface_of: order.iter().map(|&i| self.surface_of[i as usize]).collect(),
            ..self.clone()
        }
    }

    /// The first triangle of the same place and surface.
    fn first_like(&self, triangle: u32) -> u32 {
        let key = |t: u32| {
            let mut corners =
                self.triangles[t as usize].map(|v| self.positions[v as usize].to_array().map(f64::to_bits));
            corners.sort_unstable();
            (corners, self.surface_of[t as usize])
        };
        (0..triangle).find(|&o| key(o) == key(triangle)).unwrap_or(triangle)
    }

    /// Prepares it.
    ///
    /// # Errors
    /// As [`Geometry::new`].
    pub fn geometry(&self) -> Result<Geometry, MicropointError> {
        Geometry::new(&self.positions, &self.triangles, &self.surface_of, &self.surfaces)
    }
}

/// A micropoint without references into its tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Position of its triangle in the caller's array.
    pub triangle: u32,
    /// Its surface.
    pub surface: u32,
    /// Its share of the pixel.
    pub weight: f64,
    /// Centroid of what is seen of it.
    pub grid: DVec2,
    /// Smallest and largest nearness.
    pub nearness: Interval,
}

/// What each pixel of a picture sees, row by row.
pub type Picture = Vec<Vec<Seen>>;

/// Adds the micropoints of a tile to a picture of this width.
pub fn put_tile(picture: &mut Picture, width: u32, tile: &Tile) {
    for p in tile.points() {
        let face = &tile.faces()[p.face as usize];
        picture[(p.y * width + p.x) as usize].push(Seen {
            triangle: face.id,
            surface: face.surface,
            weight: p.weight,
            grid: p.grid,
            nearness: p.nearness,
        });
    }
}

/// Renders these rectangles one after the other.
#[must_use]
pub fn picture_of(renderer: &Renderer<'_>, rects: impl IntoIterator<Item = PixelRect>) -> Picture {
    let (width, height) = (renderer.view().width(), renderer.view().height());
    let mut picture = vec![vec![]; (width * height) as usize];
    let mut tile = Tile::default();
    for rect in rects {
        renderer.render(rect, &mut tile);
        put_tile(&mut picture, width, &tile);
    }
    picture
}

/// Renders a scene whole; `None` if it is refused.
#[must_use]
pub fn picture(soup: &Soup, view: View, options: MicropointOptions) -> Option<Picture> {
    let geometry = soup.geometry().ok()?;
    let renderer = Renderer::new(&geometry, &PlainOpacity, view, options).ok()?;
    Some(picture_of(&renderer, [renderer.picture()]))
}

/// Share of each surface in each pixel, row by row.
#[must_use]
pub fn shares(picture: &Picture, surfaces: usize) -> Vec<Vec<f64>> {
    let share = |pixel: &Vec<Seen>| {
        let mut shares = vec![0.0; surfaces];
        pixel.iter().for_each(|s| shares[s.surface as usize] += s.weight);
        shares
    };
    picture.iter().map(share).collect()
}

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}

fn bits_differ(a: &Seen, b: &Seen) -> bool {
    let bits = |s: &Seen| [s.weight, s.grid.x, s.grid.y, s.nearness.least, s.nearness.most].map(f64::to_bits);
    (a.triangle, a.surface) != (b.triangle, b.surface) || bits(a) != bits(b)
}

/// Two pictures hold the same micropoints, bit for bit.
///
/// # Errors
/// The first pixel that differs.
pub fn pictures_are_identical(a: &Picture, b: &Picture, width: u32) -> Result<(), String> {
    for (i, (pa, pb)) in a.iter().zip(b).enumerate() {
        let same = pa.len() == pb.len() && !pa.iter().zip(pb).any(|(a, b)| bits_differ(a, b));
        let (x, y) = (i as u32 % width, i as u32 / width);
        check(same, || format!("pixel ({x}, {y}): {pa:?} and {pb:?}"))?;
    }
    check(a.len() == b.len(), || format!("{} and {} pixels", a.len(), b.len()))
}

/// Weights are shares of a pixel: none is negative, with the transmittance they make up 1, and what a
/// micropoint weighs is what its fragments weigh. Fragments lie in their pixel.
///
/// # Errors
/// The pixel and what is wrong with it.
pub fn weights_are_shares(soup: &Soup, view: View, options: MicropointOptions) -> Result<(), String> {
    let Ok(geometry) = soup.geometry() else { return Ok(()) };
    let Ok(renderer) = Renderer::new(&geometry, &PlainOpacity, view, options) else { return Ok(()) };
    let mut tile = Tile::default();
    renderer.render(renderer.picture(), &mut tile);
    let cells = f64::from(options.cells_per_pixel);
    let mut sums = vec![0.0; (view.width() * view.height()) as usize];
    for p in tile.points() {
        let place = || format!("pixel ({}, {}): {p:?}", p.x, p.y);
        check(p.weight >= 0.0 && p.weight <= 1.0 + SUM_TOLERANCE, || format!("weight, {}", place()))?;
        check(p.nearness.least <= p.nearness.most, || format!("nearness, {}", place()))?;
        let low = DVec2::new(f64::from(p.x), f64::from(p.y)) * cells;
        let inside =
            |v: DVec2| v.cmpge(low - 1e-9 * cells).all() && v.cmple(low + cells * (1.0 + 1e-9)).all();
        check(inside(p.grid), || format!("centroid, {}", place()))?;
        let fragments = tile.fragments(p);
        let sum: f64 = fragments.iter().map(|f| f.weight).sum();
        check((sum - p.weight).abs() <= SUM_TOLERANCE, || format!("fragments weigh {sum}, {}", place()))?;
        for f in fragments {
            let outline = tile.outline(f);
            check(outline.iter().all(|&v| inside(v)), || format!("outline {outline:?}, {}", place()))?;
        }
        let q = tile.surface_point(p.face, p.grid);
        let b = q.barycentric;
        let sums_to_one = b.min_element() >= 0.0 && (b.element_sum() - 1.0).abs() < 1e-12;
        check(sums_to_one, || format!("barycentric {b}, {}", place()))?;
        sums[(p.y * view.width() + p.x) as usize] += p.weight;
    }
    let most = sums.iter().copied().fold(0.0, f64::max);
    check(most <= 1.0 + SUM_TOLERANCE * 10.0, || format!("a pixel's weights sum to {most:.17}"))
}

/// A picture does not depend on the rectangles in which it is rendered, bit for bit.
///
/// # Errors
/// The first pixel that differs.
pub fn tiles_do_not_matter(soup: &Soup, view: View, options: MicropointOptions) -> Result<(), String> {
    let Ok(geometry) = soup.geometry() else { return Ok(()) };
    let Ok(renderer) = Renderer::new(&geometry, &PlainOpacity, view, options) else { return Ok(()) };
    let (whole, width) = (renderer.picture(), view.width());
    let expected = picture_of(&renderer, [whole]);
    for size in [16, 7, 1] {
        let tiled = picture_of(&renderer, whole.tiles(size));
        pictures_are_identical(&expected, &tiled, width).map_err(|e| format!("tiles of {size}: {e}"))?;
    }
    let (cut_x, cut_y) = (view.width() / 3, 2 * view.height() / 3);
    let crops = [(0, 0, cut_x, cut_y), (cut_x, 0, width, cut_y), (0, cut_y, width, view.height())];
    let crops = crops.map(|(x0, y0, x1, y1)| PixelRect { x0, y0, x1, y1 });
    pictures_are_identical(&expected, &picture_of(&renderer, crops), width).map_err(|e| format!("crops: {e}"))
}

/// A permutation of `0..count` that depends on the seed only.
#[must_use]
pub fn permutation(count: usize, seed: u64) -> Vec<u32> {
    let mix = |i: u64| {
        let x = (i ^ seed).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (x ^ x >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9)
    };
    let mut order: Vec<u32> = (0..count as u32).collect();
    order.sort_by_key(|&i| mix(u64::from(i)));
    order
}

/// A picture does not depend on the order of triangles, bit for bit. (Triangles that are equal in surface and
/// place cannot be told apart and may change places.)
///
/// # Errors
/// The first pixel that differs.
pub fn triangle_order_does_not_matter(
    soup: &Soup,
    view: View,
    options: MicropointOptions,
    seed: u64,
) -> Result<(), String> {
    let order = permutation(soup.triangles.len(), seed);
    let pictures = (picture(soup, view, options), picture(&soup.reordered(&order), view, options));
    let (Some(mut expected), Some(mut got)) = pictures else { return Ok(()) };
    expected.iter_mut().flatten().for_each(|s| s.triangle = soup.first_like(s.triangle));
    got.iter_mut().flatten().for_each(|s| s.triangle = soup.first_like(order[s.triangle as usize]));
    pictures_are_identical(&expected, &got, view.width())
}

/// A shape that is stored once is drawn in its places as all of its triangles: each has the same share of each pixel, and if all is opaque each
/// surface has, also with closed components culled. Not bit for bit: clusters are others, so that parts behind what covers a cell may be left out in one case and cut in the other. By the
/// paper's rule it is not true at all, because there it matters what is left out.
///
/// # Errors
/// The first pixel that differs, or that one of the two is refused.
pub fn instances_are_their_triangles(shape: &Soup, places: &[DAffine3], view: View) -> Result<(), String> {
    let (all, instances) = placed(shape, places);
    let (instances, expanded) = match (instances, all.geometry()) {
        (Ok(instances), Ok(expanded)) => (instances, expanded),
        (Err(_), Err(_)) => return Ok(()),
        (a, b) => return Err(format!("{:?} and {:?}", a.map(|_| ()), b.map(|_| ()))),
    };
    check(instances.triangle_count() == expanded.triangle_count(), || "triangles are missing".to_owned())?;
    let by_triangle = |geometry: &Geometry, culls: bool| {
        let options = MicropointOptions::DEFAULT.with_cull_solids(culls);
        let renderer = Renderer::new(geometry, &PlainOpacity, view, options).ok()?;
        let mut picture = picture_of(&renderer, [renderer.picture()]);
        // Of triangles that coincide, which comes first is nothing that a picture shows.
        picture.iter_mut().flatten().for_each(|s| s.surface = all.first_like(s.triangle));
        Some(shares(&picture, all.triangles.len()))
    };
    let (Some(expected), Some(got)) = (by_triangle(&expanded, false), by_triangle(&instances, false)) else {
        return Ok(());
    };
    shares_agree(&expected, &got, CULLED_TOLERANCE)?;
    let by_surface = |shares: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let sum = |pixel: &Vec<f64>| {
            let mut sums = vec![0.0; all.surfaces.len()];
            pixel.iter().zip(&all.surface_of).for_each(|(share, &s)| sums[s as usize] += share);
            sums
        };
        shares.iter().map(sum).collect()
    };
    // Where fronts and backs coincide, another one of them is seen if one is culled. Behind dozens of translucent parts some are dimmed by their
    // mean, and which, depends on how many there are.
    let is_opaque = all.surfaces.iter().all(SurfaceOpacity::is_opaque);
    let Some(culled) = by_triangle(&instances, true).filter(|_| is_opaque) else { return Ok(()) };
    shares_agree(&by_surface(&expected), &by_surface(&culled), CULLED_TOLERANCE)
}

/// A shape in its places: as triangles of their own, and as instances.
fn placed(shape: &Soup, places: &[DAffine3]) -> (Soup, Result<Geometry, MicropointError>) {
    let mut all = Soup { surfaces: shape.surfaces.clone(), ..Soup::default() };
    let mut placements = vec![];
    for &world in places {
        placements.push(Placement { world_from_shape: world, first_id: all.triangles.len() as u32 });
        let first = all.positions.len() as u32;
        all.positions.extend(shape.positions.iter().map(|&p| world.transform_point3(p)));
        let mirrors = world.matrix3.determinant() < 0.0;
        let turned = |[a, b, c]: [u32; 3]| if mirrors { [a, c, b] } else { [a, b, c] };
        all.triangles.extend(shape.triangles.iter().map(|&t| turned(t).map(|v| first + v)));
        all.surface_of.extend_from_slice(&shape.surface_of);
    }
    let Soup { positions, triangles, surface_of, surfaces } = shape;
    let nothing = Shape { positions: &[], triangles: &[], surface_of: &[], places: &[] };
    let shape = Shape { positions, triangles, surface_of, places: &placements };
    let instances = Geometry::with_instances(&nothing, surfaces, &[shape]);
    (all, instances)
}

/// What a scene line sees of a triangle: a range of x, and nearness as an affine function.
struct Strip {
    from: f64,
    to: f64,
    surface: u32,
    opacity: f64,
    /// Nearness `a + b·x` on this line.
    nearness: (f64, f64),
}

/// A triangle by the lines that bound it: `l·(x, y, 1) ≥ 0` inside, and nearness `q·(x, y, 1)`. The fourth line is that in which
/// it meets the plane of a parallel view.
struct Bounded {
    edges: [DVec3; 4],
    nearness: DVec3,
    surface: u32,
    opacity: f64,
}

impl Bounded {
    /// `None` for a triangle seen edge-on. Triangles that reach behind a perspective eye are right without clipping:
    /// a direction inside all three edges meets the triangle in front of the eye.
    fn new(lens: &Lens, v: [DVec3; 3], surface: u32, opacity: f64) -> Option<Self> {
        let v = v.map(|p| lens.local(p));
        let n = (v[1] - v[0]).cross(v[2] - v[0]);
        // In coordinates relative to the centre, in units of cells.
        let grid = |l: DVec3| DVec3::new(l.x / lens.scale, l.y / lens.scale, l.z);
        let (edges, nearness) = match lens.kind {
            LensKind::Perspective => {
                let k = n.dot(v[0]);
                let edge = |i: usize| grid(v[i].cross(v[(i + 1) % 3])) * k.signum();
                ((k != 0.0).then_some([edge(0), edge(1), edge(2), DVec3::Z])?, grid(n) / k)
            }
            LensKind::Orthographic => {
                let edge = |i: usize| {
                    let (a, b) = (v[i], v[(i + 1) % 3]);
                    let d = b - a;
                    grid(DVec3::new(-d.y, d.x, d.y * a.x - d.x * a.y)) * n.z.signum()
                };
                let q = DVec3::new(n.x, n.y, -n.dot(v[0])) / n.z;
                ((n.z != 0.0).then_some([edge(0), edge(1), edge(2), -grid(q)])?, grid(q))
            }
        };
        nearness.is_finite().then_some(Self { edges, nearness, surface, opacity })
    }

    fn strip(&self, y: f64, width: f64) -> Option<Strip> {
        let (mut from, mut to) = (-width, width);
        for e in &self.edges {
            let constant = e.y * y + e.z;
            match e.x {
                0.0 if constant < 0.0 => return None,
                0.0 => {}
                s if s > 0.0 => from = from.max(-constant / s),
                s => to = to.min(-constant / s),
            }
        }
        let nearness = (self.nearness.y * y + self.nearness.z, self.nearness.x);
        (from < to).then_some(Strip { from, to, surface: self.surface, opacity: self.opacity, nearness })
    }
}

/// The share of each surface in each pixel by another way: exact integration of the arrangement of all edges and
/// crossings, without dicing, tiles, culling or polygons. For few triangles: time grows with the sixth power.
///
/// Surfaces closer than `TIE` of their nearness coincide; the one with the lower number is in front.
#[must_use]
pub fn shares_by_arrangement(soup: &Soup, view: &View) -> Vec<Vec<f64>> {
    let lens = Lens::of_view(view, 1);
    let bounded: Vec<Bounded> = (soup.triangles.iter().zip(&soup.surface_of))
        .filter_map(|(t, &s)| {
            let opacity = f64::from(soup.surfaces[s as usize].opacity);
            Bounded::new(&lens, t.map(|v| soup.positions[v as usize]), s, opacity)
        })
        .collect();
    let (width, height) = (view.width() as usize, view.height() as usize);
    let (half_width, half_height) = (lens.centre.x, lens.centre.y);
    let mut lines: Vec<DVec3> = bounded.iter().flat_map(|b| b.edges).collect();
    for (i, a) in bounded.iter().enumerate() {
        lines.extend(bounded[..i].iter().map(|b| a.nearness - b.nearness));
    }
    lines.extend((0..=width).map(|x| DVec3::new(1.0, 0.0, half_width - x as f64)));
    // Between two of these heights, every share is a linear function of the height.
    let mut heights: Vec<f64> = (0..=height).map(|y| y as f64 - half_height).collect();
    for (i, a) in lines.iter().enumerate() {
        for b in &lines[..i] {
            let p = a.cross(*b);
            let (x, y) = (p.x / p.z, p.y / p.z);
            if x.abs() <= half_width + 1.0 && y.abs() < half_height {
                heights.push(y);
            }
        }
    }
    heights.sort_by(f64::total_cmp);
    let mut shares = vec![vec![0.0; soup.surfaces.len()]; width * height];
    for pair in heights.windows(2) {
        let (y, thickness) = (0.5 * (pair[0] + pair[1]), pair[1] - pair[0]);
        if thickness <= 0.0 {
            continue;
        }
        let strips: Vec<Strip> = bounded.iter().filter_map(|b| b.strip(y, half_width)).collect();
        let row = ((y + half_height) as usize).min(height - 1);
        add_line(&strips, half_width, thickness, &mut shares[row * width..(row + 1) * width]);
    }
    shares
}

fn add_line(strips: &[Strip], half_width: f64, thickness: f64, row: &mut [Vec<f64>]) {
    let mut ends: Vec<f64> = (0..=row.len()).map(|x| x as f64 - half_width).collect();
    for (i, a) in strips.iter().enumerate() {
        ends.extend([a.from, a.to]);
        ends.extend(
            strips[..i].iter().map(|b| (b.nearness.0 - a.nearness.0) / (a.nearness.1 - b.nearness.1)),
        );
    }
    ends.retain(|x| x.abs() <= half_width);
    ends.sort_by(f64::total_cmp);
    for pair in ends.windows(2) {
        let (x, length) = (0.5 * (pair[0] + pair[1]), pair[1] - pair[0]);
        let mut here: Vec<&Strip> = strips.iter().filter(|s| s.from < x && x < s.to).collect();
        let nearness = |s: &Strip| s.nearness.0 + s.nearness.1 * x;
        here.sort_by(|a, b| {
            let (qa, qb) = (nearness(a), nearness(b));
            let coincide = (qa - qb).abs() <= TIE * qa.abs().max(qb.abs());
            if coincide { a.surface.cmp(&b.surface) } else { qb.total_cmp(&qa) }
        });
        let mut transmittance = thickness * length;
        let column = ((x + half_width) as usize).min(row.len() - 1);
        for s in here {
            row[column][s.surface as usize] += transmittance * s.opacity;
            transmittance *= 1.0 - s.opacity;
        }
    }
}

/// Two tables of shares agree.
///
/// # Errors
/// The pixel that differs most.
pub fn shares_agree(a: &[Vec<f64>], b: &[Vec<f64>], tolerance: f64) -> Result<(), String> {
    let difference =
        |(p, q): (&Vec<f64>, &Vec<f64>)| p.iter().zip(q).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    let worst = a.iter().zip(b).map(difference).enumerate().max_by(|x, y| x.1.total_cmp(&y.1));
    match worst {
        Some((i, d)) if d > tolerance || d.is_nan() => {
            Err(format!("pixel {i} is off by {d:.3e}: {:?} and {:?}", a[i], b[i]))
        }
        _ => Ok(()),
    }
}

/// Under the correlated rule, every pixel shows the exact share of every surface.
///
/// # Errors
/// The pixel that is farthest off.
pub fn shares_are_exact(soup: &Soup, view: View, tolerance: f64) -> Result<(), String> {
    let Some(seen) = picture(soup, view, MicropointOptions::DEFAULT) else { return Ok(()) };
    let got = shares(&seen, soup.surfaces.len());
    shares_agree(&got, &shares_by_arrangement(soup, &view), tolerance)
}

/// Under the correlated rule, the shares of a pixel are the means of those of the `factor`² pixels that it is divided into: what is seen in a
/// cell of many parts is what is seen in many cells of few.
///
/// # Errors
/// The pixel that is farthest off, or that the finer picture is refused.
pub fn pixels_are_means_of_finer_ones(
    soup: &Soup,
    view: View,
    factor: u32,
    tolerance: f64,
) -> Result<(), String> {
    let options = MicropointOptions::DEFAULT;
    let Some(coarse) = picture(soup, view, options) else { return Ok(()) };
    let (width, surfaces) = (view.width(), soup.surfaces.len());
    let finer = view.with_size(width * factor, view.height() * factor).map_err(|e| e.to_string())?;
    let fine = picture(soup, finer, options).ok_or("the finer picture is refused")?;
    let fine = shares(&fine, surfaces);
    let mut means = vec![vec![0.0; surfaces]; coarse.len()];
    for (i, pixel) in fine.iter().enumerate() {
        let (x, y) = (i as u32 % (width * factor) / factor, i as u32 / (width * factor) / factor);
        let mean = &mut means[(y * width + x) as usize];
        mean.iter_mut().zip(pixel).for_each(|(m, s)| *m += s / f64::from(factor * factor));
    }
    shares_agree(&shares(&coarse, surfaces), &means, tolerance)
}

/// Every pixel is covered by what stands before it: its weights sum to 1.
///
/// # Errors
/// The pixel through which most can be seen.
pub fn nothing_shows_through(
    soup: &Soup,
    view: View,
    options: MicropointOptions,
    tolerance: f64,
) -> Result<(), String> {
    let Some(seen) = picture(soup, view, options) else { return Ok(()) };
    for (i, pixel) in seen.iter().enumerate() {
        let sum: f64 = pixel.iter().map(|s| s.weight).sum();
        check((sum - 1.0).abs() <= tolerance, || format!("pixel {i} sums to 1 − {:.3e}", 1.0 - sum))?;
    }
    Ok(())
}
