//! Receivers behind masks: what passes several of them depends on where their holes are.

use glam::{DVec2, DVec3, dvec3};
use pointillist_micropoint::{
    Geometry, MicropointOptions, PlainOpacity, Projection, Renderer, SurfaceOpacity, SurfacePoint,
    TexturedOpacity, Tile, View,
};
use pointillist_shadow::{
    Emitter, Receivers, ShadowError, ShadowLight, ShadowOptions, ShadowScratch, Viewer,
};

/// Cards above the ground, each opaque on one side of x = 0 and empty on the other.
struct Cards {
    corners: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// By triangle: the sign of x where it is opaque; 0 for the ground.
    opaque: Vec<f64>,
}

impl Cards {
    fn on_ground() -> Self {
        let mut cards = Self { corners: vec![], triangles: vec![], opaque: vec![] };
        cards.add(0.0, 0.0);
        cards
    }

    fn add(&mut self, z: f64, opaque: f64) {
        let first = self.corners.len() as u32;
        self.corners
            .extend([(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)].map(|(x, y)| dvec3(x, y, z)));
        self.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k| k + first)));
        self.opaque.extend([opaque; 2]);
    }

    /// The lit fraction of the ground in the unit square about the origin, the only pixel, under light that falls straight down, and how many
    /// lit regions are known of it.
    fn lit(&self, options: ShadowOptions) -> (f64, usize) {
        let surface = |textured_opacity| SurfaceOpacity { textured_opacity, ..SurfaceOpacity::default() };
        let surface_of: Vec<u32> = self.opaque.iter().map(|side| u32::from(*side != 0.0)).collect();
        let surfaces = [surface(false), surface(true)];
        let geometry = Geometry::new(&self.corners, &self.triangles, &surface_of, &surfaces).unwrap();
        let camera = Projection::Orthographic { height: 1.0 };
        let view = View::look_at(DVec3::Z * 0.5, DVec3::ZERO, DVec3::Y, camera, 1, 1).unwrap();
        let renderer = Renderer::new(&geometry, self, view, MicropointOptions::DEFAULT).unwrap();
        let mut tile = Tile::default();
        renderer.render(renderer.picture(), &mut tile);
        let mut receivers = Receivers::default();
        for point in tile.points() {
            for fragment in tile.fragments(point) {
                let face = &tile.faces()[point.face as usize];
                let corner = |&v: &DVec2| tile.position(v, face.nearness_at(v));
                receivers.push_with_regions(point.face, tile.outline(fragment).iter().map(corner));
            }
        }
        let down = Emitter::Directional { direction: DVec3::NEG_Z };
        let light = ShadowLight::new(&geometry, self, down, options).unwrap();
        let (mut scratch, mut lit) = (ShadowScratch::default(), vec![]);
        light.lit(Viewer { lens: tile.lens(), faces: tile.faces() }, &receivers, &mut scratch, &mut lit);
        let weights = tile.points().iter().flat_map(|p| tile.fragments(p).iter().map(|f| f.weight));
        let regions = (0..lit.len()).map(|i| scratch.lit_regions(i as u32).count()).sum();
        (weights.zip(&lit).map(|(weight, lit)| weight * lit).sum(), regions)
    }
}

impl TexturedOpacity for Cards {
    fn mean_opacity(&self, triangle: u32, polygon: &[SurfacePoint]) -> f32 {
        let corners = self.triangles[triangle as usize].map(|k| self.corners[k as usize].truncate());
        let place = |p: &SurfacePoint| {
            let [a, b, c] = p.barycentric.to_array();
            corners[0] * a + corners[1] * b + corners[2] * c
        };
        let side = self.opaque[triangle as usize];
        let ring: Vec<DVec2> = polygon.iter().map(place).collect();
        let mut kept = vec![];
        for (i, &a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()];
            if a.x * side >= 0.0 {
                kept.push(a);
            }
            if (a.x < 0.0) != (b.x < 0.0) && a.x != b.x {
                kept.push(a.lerp(b, a.x / (a.x - b.x)));
            }
        }
        let area = |ring: &[DVec2]| -> f64 {
            (0..ring.len()).map(|i| ring[i].perp_dot(ring[(i + 1) % ring.len()])).sum()
        };
        (area(&kept) / area(&ring)).clamp(0.0, 1.0) as f32
    }
}

#[test]
fn what_passes_two_masks_depends_on_where_their_holes_are() {
    let mut cards = Cards::on_ground();
    cards.add(1.0, 1.0);
    assert!((cards.lit(ShadowOptions::default()).0 - 0.5).abs() < 1e-6);
    let mut alike = Cards::on_ground();
    let mut apart = Cards::on_ground();
    for z in [1.0, 2.0] {
        alike.add(z, 1.0);
        apart.add(z, if z == 1.0 { 1.0 } else { -1.0 });
    }
    assert!((alike.lit(ShadowOptions::default()).0 - 0.5).abs() < 1e-6);
    assert!(apart.lit(ShadowOptions::default()).0 < 1e-6);
    // In one piece they are taken to be independent. Of the ground's two triangles, one has three quarters of its area on each side.
    let one = ShadowOptions::default().with_squares_under_masks(1);
    let (same, other) = ((0.75_f64.powi(2) + 0.25_f64.powi(2)) / 2.0, 0.75 * 0.25);
    assert!((alike.lit(one).0 - same).abs() < 1e-6 && (apart.lit(one).0 - other).abs() < 1e-6);
}

#[test]
fn other_numbers_of_squares_are_refused() {
    let geometry = Geometry::new(&[], &[], &[], &[]).unwrap();
    for squares in [0, 3, 8] {
        let options = ShadowOptions::default().with_squares_under_masks(squares);
        let down = Emitter::Directional { direction: DVec3::NEG_Z };
        let refused = ShadowLight::new(&geometry, &PlainOpacity, down, options).err();
        assert_eq!(refused, Some(ShadowError::BadSquaresUnderMasks(squares)));
    }
}

#[test]
fn regions_are_known_of_what_is_not_evenly_lit() {
    let mut cards = Cards::on_ground();
    cards.add(1.0, 1.0);
    let (lit, regions) = cards.lit(ShadowOptions::default());
    // The two triangles of the ground, divided: half of their pieces are dark.
    assert!((lit - 0.5).abs() < 1e-6 && regions >= 8, "{lit} {regions}");
    let one = ShadowOptions::default().with_squares_under_masks(1);
    assert_eq!(cards.lit(one).1, 0, "a mask before all of a receiver lets the same pass everywhere");
    assert_eq!(Cards::on_ground().lit(ShadowOptions::default()), (1.0, 0));
}
