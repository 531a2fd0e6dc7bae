//! Lights and writes a row of pixels that each show one surface of the cloud's own colour: several at a time.
//!
//! Nearly all pixels of an opaque frame without colours are such; the others are written over afterwards ([`Shader::nearest`]). The operations
//! and their order are those of one pixel, so results are the same on every processor.

use crate::shade::Shader;
use glam::Vec3;
use pulp::NullaryFnOnce;

/// Pixels of one row of the picture.
pub(crate) struct SolidRow<'a> {
    pub(crate) shader: &'a Shader,
    /// Column and row of the first.
    pub(crate) place: (usize, usize),
    /// Bent depth (+∞ where nothing is) and normal.
    pub(crate) surfaces: &'a [[f32; 4]],
    pub(crate) color: &'a mut [[f32; 4]],
    pub(crate) depth: &'a mut [f32],
}

impl NullaryFnOnce for SolidRow<'_> {
    type Output = ();

    // Not a closure: see `project::Transform`.
    #[inline(always)]
    fn call(self) {
        match self.shader.light {
            Some(light) => self.lit_from(|_, _| light),
            None => self.lit_from(Shader::towards_eye),
        }
    }
}

impl SolidRow<'_> {
    #[inline(always)]
    fn lit_from(self, towards_light: impl Fn(&Shader, (usize, usize)) -> Vec3) {
        let Self { shader, place, surfaces, color, depth } = self;
        let n = surfaces.len();
        let (color, depth) = (&mut color[..n], &mut depth[..n]);
        for i in 0..n {
            let [q, x, y, z] = surfaces[i];
            let light = shader.lit(Vec3::new(x, y, z), towards_light(shader, (place.0 + i, place.1)));
            let color_there = shader.base * light;
            let shown = q < f32::INFINITY;
            color[i] = if shown { color_there.extend(1.0).to_array() } else { [0.0; 4] };
            depth[i] = if shown { shader.depth_of_shown(q) } else { f32::INFINITY };
        }
    }
}
