//! Projects the items of a node to discs on the picture.

use crate::batch::{Projected, Value};
use crate::ellipse::project;
use crate::grid::TileRect;
use crate::items::{Items, Run, Values};
use crate::placed::{Map, Placed, turned};
use crate::scene::Scene;
use crate::select::Selected;
use crate::splat::Shape;
use crate::splats::Splats;
use crate::vector::Vector;
use pulp::{Arch, Simd, WithSimd};

/// Items of a node in its own frame, and on the picture.
pub(crate) struct Projector {
    discs: Items,
    out: Projected,
}

impl Projector {
    pub(crate) fn new() -> Box<Self> {
        Box::new(Self { discs: Items::NOTHING, out: Projected::NOTHING })
    }

    /// Appends the discs of `selected` that may touch the tile.
    pub(crate) fn project(
        &mut self,
        scene: &Scene<'_>,
        selected: &Selected,
        shape: &Shape,
        tile: &TileRect,
        splats: &mut Splats,
    ) {
        let node = &scene.cloud.nodes[selected.node as usize];
        let map = Map::new(&scene.camera, node, selected.margin, tile);
        for run in Run::all(node, selected.in_pairs) {
            self.discs.take(scene.cloud, node, &run);
            let count = run.discs();
            Arch::new().dispatch(Project { lanes: self, scene, shape, map: &map, count });
            splats.append(&self.out, count, selected.place);
        }
    }
}

/// The arithmetic of [`Projector::project`].
struct Project<'a> {
    lanes: &'a mut Projector,
    scene: &'a Scene<'a>,
    shape: &'a Shape,
    map: &'a Map,
    count: usize,
}

impl WithSimd for Project<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { lanes, scene, shape, map, count } = self;
        let Projector { discs, out } = lanes;
        let Items { offsets, normals, shading_normals, radii, areas, spreads, paint, opacities } = discs;
        let has_shading_normals = scene.cloud.has_shading_normals();
        let vector = |all: &Values, i: usize| Vector::new(simd, S::as_simd_f32s(all).0[i]);
        let vectors =
            |all: &[Values; 3], i: usize| [vector(&all[0], i), vector(&all[1], i), vector(&all[2], i)];
        for i in 0..count.div_ceil(S::F32_LANES) {
            let placed = Placed::new(
                simd,
                &scene.camera,
                map,
                vectors(offsets, i),
                vectors(normals, i),
                vectors(spreads, i),
            );
            let may_show = placed.may_show(simd, &scene.camera, map);
            // Neighbours in the cloud are neighbours in the picture: often none of a vector is in the tile.
            if simd.first_true_m32s(may_show) == S::F32_LANES {
                out.set(i, Value::Kept, Vector::all(simd, 0.0));
                continue;
            }
            project(simd, &placed, [vector(radii, i), vector(areas, i)], (&scene.camera, shape, map), out, i);
            let at = (placed.x + map.first[0], placed.y + map.first[1]);
            let opacity = vector(opacities, i);
            let mut lit = placed.normal;
            if has_shading_normals {
                lit = turned(vectors(shading_normals, i), &scene.camera.axes);
            }
            let [red, green, blue] = scene.shader.lit((vectors(paint, i), opacity), lit, at);
            for (value, result) in [
                (Value::Red, red),
                (Value::Green, green),
                (Value::Blue, blue),
                (Value::Opacity, opacity),
                (Value::NormalX, lit[0]),
                (Value::NormalY, lit[1]),
                (Value::NormalZ, lit[2]),
            ] {
                out.set(i, value, result);
            }
        }
    }
}
