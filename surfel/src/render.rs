//! A frame, from the cloud to the picture.

use crate::camera::Camera;
use crate::cloud::Cloud;
use crate::error::SurfelError;
use crate::frame::{Band, Frame, FrameCounts};
use crate::options::Options;
use crate::parallel::{self, Pool};
use crate::select::{self, Selected};
use crate::shade::Shader;
use crate::splat::Shape;
use crate::tile::{self, Place, Scene, Tile};
use crate::view::View;

/// Draws frames. Keeps its working memory, so that later frames hardly allocate.
#[derive(Default)]
pub struct Renderer {
    selected: Vec<Selected>,
    stack: Vec<u32>,
    tiles: Pool<Tile>,
}

impl Renderer {
    /// A renderer without memory.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Draws `cloud` into `frame`.
    ///
    /// The same for every order of points and for every number of threads, bit for bit.
    ///
    /// # Errors
    /// [`SurfelError::BadOption`].
    pub fn draw(
        &mut self,
        cloud: &Cloud,
        view: &View,
        options: &Options,
        frame: &mut Frame,
    ) -> Result<(), SurfelError> {
        options.check()?;
        let camera = Camera::new(view, &cloud.lattice, &cloud.nodes[0], &options.focus);
        frame.reshape(view.width as usize, view.height as usize, options.normals);
        let mut counts = FrameCounts::default();
        select::select(cloud, &camera, options, &mut self.selected, &mut self.stack, &mut counts);
        frame.counts = counts;
        let shader = Shader::new(&camera, options);
        let shape = Shape::of(options.procedure);
        let scene = Scene { cloud, camera, shape, shader, culling: options.culling };
        let (selected, tiles) = (&self.selected, &self.tiles);
        parallel::for_each_mut(&mut frame.bands(), |band| {
            tiles.with(|tile| draw_band(tile, &scene, selected, band));
        });
        Ok(())
    }
}

fn draw_band(tile: &mut Tile, scene: &Scene<'_>, selected: &[Selected], band: &mut Band<'_>) {
    let rows = band.first_row..band.first_row + band.rows();
    let in_band =
        || selected.iter().filter(|s| usize::from(s.y[0]) < rows.end && usize::from(s.y[1]) >= rows.start);
    for number in 0..band.drawn.len() {
        let columns = band.columns(number);
        let place = Place { x: columns.start, y: band.first_row, width: columns.len(), height: rows.len() };
        let mut nodes = in_band()
            .filter(|s| usize::from(s.x[0]) < columns.end && usize::from(s.x[1]) >= columns.start)
            .copied()
            .peekable();
        if nodes.peek().is_none() {
            band.clear(number);
        } else {
            tile.draw(scene, &place, nodes, band);
        }
    }
    debug_assert_eq!(band.first_row % tile::HEIGHT, 0);
}
