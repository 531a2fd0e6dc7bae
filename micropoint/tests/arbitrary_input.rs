//! Any values at all into every public function: an answer or a typed error, never a panic.

use glam::{DAffine3, DMat3, DVec2, DVec3, dvec2};
use pointillist_micropoint::{
    Bounds, DepthRange, Face, FaceVisitor, Geometry, GridRect, HiddenSides, Lens, MicropointError,
    MicropointOptions, Occlusion, PixelRect, PlainOpacity, ProjectedVertex, Projection, Renderer, Setup,
    SurfaceOpacity, TexelCorner, TexelSums, TexelWrap, Tile, View, VisitMemory,
};
use proptest::prelude::*;
use testkit::Rate;
use testkit::numbers::{finite, number, vector};

fn projection() -> impl Strategy<Value = Projection> {
    prop_oneof![
        1 => number().prop_map(|fov_y_rad| Projection::Perspective { fov_y_rad }),
        9 => (0.01..3.1f64).prop_map(|fov_y_rad| Projection::Perspective { fov_y_rad }),
        1 => number().prop_map(|height| Projection::Orthographic { height }),
        9 => (0.01..9.0f64).prop_map(|height| Projection::Orthographic { height }),
    ]
}

fn opacity() -> impl Strategy<Value = f32> {
    prop_oneof![4 => Just(1.0f32), 2 => 0.0..=1.0f32, 1 => any::<f32>()]
}

proptest! {
    #![proptest_config(testkit::config(512))]

    #[test]
    fn geometry_is_prepared_or_refused(
        positions in prop::collection::vec(vector(number), 0..6), triangles in prop::collection::vec([0..8u32, 0..8, 0..8], 0..6),
        surface_of in prop::collection::vec(0..3u32, 0..6), opacities in prop::collection::vec(opacity(), 0..3),
    ) {
        let surfaces: Vec<_> = opacities.iter().map(|&opacity| SurfaceOpacity { opacity, ..SurfaceOpacity::default() }).collect();
        let result = Geometry::new(&positions, &triangles, &surface_of, &surfaces);
        let bad_number = positions.iter().any(|p| !p.is_finite());
        let bad_index = triangles.iter().flatten().any(|&v| v as usize >= positions.len());
        let bad_surface = surface_of.iter().any(|&s| s as usize >= surfaces.len());
        let bad_opacity = opacities.iter().any(|o| !(0.0..=1.0).contains(o));
        let bad = bad_number || bad_index || bad_surface || bad_opacity || surface_of.len() != triangles.len();
        prop_assert!(!(bad && result.is_ok()));
        match result {
            Err(MicropointError::VertexNotFinite { index, .. }) => prop_assert!(index < positions.len()),
            Err(MicropointError::VertexOutOfRange { triangle, count, .. }) => {
                prop_assert!(triangle < triangles.len() && count == positions.len());
            }
            _ => {}
        }
    }

    #[test]
    fn anything_that_is_accepted_can_be_rendered(
        positions in prop::collection::vec(vector(finite), 6), indices in prop::collection::vec([0..6usize, 0..6, 0..6], 0..8),
        opacities in prop::collection::vec(opacity(), 8), textured: bool, eye in vector(finite), target in vector(finite), up in vector(finite),
        projection in projection(), w in 1..6u32, h in 1..6u32, cells in 1..5u32, paper: bool, rect in [0..9u32, 0..9, 0..9, 0..9],
    ) {
        let triangles: Vec<_> = indices.iter().map(|t| t.map(|v| v as u32)).collect();
        let surfaces: Vec<_> = opacities.iter().map(|&o| SurfaceOpacity { opacity: if o.is_nan() { 0.5 } else { o.clamp(0.0, 1.0) }, textured_opacity: textured, two_sided: o > 0.2 }).collect();
        let surface_of: Vec<u32> = (0..triangles.len() as u32).collect();
        let Ok(geometry) = Geometry::new(&positions, &triangles, &surface_of, &surfaces) else { return Ok(()) };
        let occlusion = if paper { Occlusion::Paper } else { Occlusion::Correlated };
        let options = MicropointOptions::DEFAULT.with_cells_per_pixel(cells).with_occlusion(occlusion);
        static ACCEPTED: Rate = Rate::of_at_least(0.3);
        let view = View::look_at(eye, target, up, projection, w, h);
        let renderer = view.ok().and_then(|view| Renderer::new(&geometry, &PlainOpacity, view, options).ok());
        ACCEPTED.count(renderer.is_some())?;
        let Some(renderer) = renderer else { return Ok(()) };
        let mut tile = Tile::default();
        for rect in [renderer.picture(), PixelRect { x0: rect[0], y0: rect[1], x1: rect[2], y1: rect[3] }] {
            renderer.render(rect, &mut tile);
            for p in tile.points() {
                prop_assert!(p.weight.is_finite() && p.weight >= 0.0, "{p:?}");
                let s = tile.surface_point(p.face, p.grid);
                let _ = tile.position(p.grid, s.nearness);
            }
        }
    }

    #[test]
    fn views_are_valid_or_refused(m in prop::collection::vec(number(), 12), projection in projection(), w in any::<u32>(), h in any::<u32>()) {
        let matrix = DMat3::from_cols_slice(&m[..9]);
        let view = DAffine3::from_mat3_translation(matrix, DVec3::from_slice(&m[9..]));
        if let Ok(v) = View::from_matrix(view, projection, w, h) {
            let ray = v.ray(dvec2(m[0], m[1]));
            let lens = Lens::of_view(&v, 2);
            prop_assert!(lens.scale > 0.0 && (lens.forward.length() - 1.0).abs() < 1e-6, "{lens:?}");
            prop_assert!(!ray.direction.is_finite() || ray.direction != DVec3::ZERO, "{ray:?}");
        }
    }

    #[test]
    fn rectangles_have_tiles(r in (any::<u32>(), any::<u32>(), 0..40u32, 0..40u32), size in 0..50u32) {
        let rect = PixelRect { x0: r.0, y0: r.1, x1: r.0.saturating_add(r.2), y1: r.1.saturating_add(r.3) };
        let area: u64 = rect.tiles(size).map(|t| u64::from(t.width()) * u64::from(t.height())).sum();
        prop_assert_eq!(area, u64::from(rect.width()) * u64::from(rect.height()));
    }

    #[test]
    fn textures_have_means(
        w in 0..5u32, h in 0..40u32, values in prop::collection::vec(prop_oneof![4 => 0.0..2.0f32, 1 => any::<f32>()], 1..4), wrap in 0..3usize,
        corners in prop::collection::vec((number(), number(), number(), number(), number()), 0..12),
    ) {
        let wrap = [TexelWrap::Repeat, TexelWrap::Clamp, TexelWrap::Mirror][wrap];
        let texel = |x: u32, y: u32| [values[(x + 3 * y) as usize % values.len()]];
        if let Ok(sums) = TexelSums::<1>::new(w, h, wrap, texel) {
            let corners: Vec<_> = corners.iter()
                .map(|c| TexelCorner { grid: dvec2(c.0, c.1), rational: c.2, texel: dvec2(c.3, c.4) }).collect();
            let texels = (0..h).flat_map(|y| (0..w).map(move |x| (x, y))).map(|(x, y)| f64::from(texel(x, y)[0]));
            let (least, most) = texels.fold((f64::INFINITY, 0.0), |(l, m): (f64, f64), v| (l.min(v), m.max(v)));
            let mut means = vec![sums.mean(&corners)[0]];
            means.extend(corners.iter().map(|c| sums.texel(c.texel.x, c.texel.y)[0]));
            for mean in means {
                prop_assert!(least <= mean && mean <= most, "{mean} is not from {least} to {most}");
            }
        }
    }

    #[test]
    fn faces_and_volumes_take_any_lens(
        v in [vector(number), vector(number), vector(number)], eye in vector(number), target in vector(number), projection in projection(),
        rect in prop::collection::vec(number(), 4),
    ) {
        let Ok(view) = View::look_at(eye, target, DVec3::Y, projection, 4, 4) else { return Ok(()) };
        let lens = Lens::of_view(&view, 1);
        let rect = GridRect { low: dvec2(rect[0], rect[1]), high: dvec2(rect[2], rect[3]) };
        let Ok(geometry) = Geometry::new(&v, &[[0, 1, 2]], &[0], &[SurfaceOpacity::default()]) else { return Ok(()) };
        let _ = geometry.hidden_sides(&lens);
        let picture = GridRect { low: DVec2::ZERO, high: DVec2::splat(4.0) };
        let setup = Setup { lens: &lens, rect: &picture, hidden: &HiddenSides::default(), keeps_backs: true, range: DepthRange::ALL };
        for farthest in [f64::INFINITY, target.x] {
            let mut seen = Faces { farthest: eye.x, count: 0 };
            let counts = geometry.visit_faces(&setup, &rect, farthest, &mut VisitMemory::default(), &mut seen);
            prop_assert!(counts.clusters + counts.clusters_skipped <= 1 && seen.count <= 1);
            prop_assert_eq!(counts.clusters, counts.triangles_culled + seen.count);
        }
    }
}

/// Takes every face.
struct Faces {
    farthest: f64,
    count: u64,
}

impl FaceVisitor for Faces {
    fn wants(&self, bounds: &Bounds) -> bool {
        assert!(bounds.low.cmple(bounds.high).all());
        true
    }

    fn skips(&self, _: [&ProjectedVertex; 3], _: &SurfaceOpacity) -> bool {
        false
    }

    fn visit(&mut self, _: Face, outline: &[DVec2], opacity: Option<f32>) {
        assert!(outline.len() >= 3 && opacity == Some(1.0));
        self.count += 1;
    }

    fn farthest(&self) -> f64 {
        self.farthest
    }
}
