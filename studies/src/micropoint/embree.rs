//! Embree beside the pictures of `studies -- micropoint`: another program that takes point samples, faster than ours.

use std::fmt::Write as _;

use super::Case;
use crate::common::peer_scene;
use crate::common::peers;
use crate::common::picture::Picture;
use crate::common::report::{Row, distinct};
use crate::common::timing::Timing;

/// Names a program that takes scenes as `studies/peers/embree` does.
const EMBREE: &str = "POINTILLIST_EMBREE";

/// Its rows.
pub(super) const SERIES: &str = "Embree";

/// Samples along a pixel's side.
const SIDES: [u32; 3] = [4, 8, 16];

/// Rows of one case; none if the program is not there, or the scene has what it does not know.
pub(super) fn rows(case: &Case) -> std::io::Result<Vec<Row>> {
    let text = peer_scene::written(&case.scene, peer_scene::Lights::Simple);
    let (Some(program), Some(text)) = (peers::find(EMBREE, "embree"), text) else { return Ok(vec![]) };
    let image = &case.scene.image;
    let drawn = peers::draw(&program, &text, [image.width, image.height], &SIDES)?.into_iter();
    let row = |(side, (time, picture)): (u32, (Timing, Picture))| {
        super::row(case, SERIES.to_owned(), format!("{side}×{side}"), time, &picture)
    };
    Ok(SIDES.into_iter().zip(drawn).map(row).collect())
}

/// Our defaults beside its pictures, as a section.
pub(super) fn section(rows: &[Row]) -> String {
    let mut text = "\n## Beside Embree\n\n".to_owned();
    if !rows.iter().any(|r| r.series == SERIES) {
        return text + &peers::skipped("Embree", EMBREE) + "\n";
    }
    let _ = write!(
        text,
        "`studies/peers/embree`: one thread, stratified samples in packets of 16, compiled for this processor where ours is not. Seconds are its \
         processor's, without reading and writing. Scenes with textures are left out.\n\n\
         | scene | RMSE | seconds |{} our RMSE, seconds in those of 16×16 |\n| --- | ---: | ---: |{} ---: |\n",
        SIDES.map(|side| format!(" {side}×{side}: RMSE | seconds |")).concat(),
        " ---: | ---: |".repeat(SIDES.len())
    );
    for scene in distinct(rows.iter().filter(|r| r.series == SERIES).map(|r| r.scene.as_str())) {
        let of = |series: &'static str| rows.iter().filter(move |r| r.scene == scene && r.series == series);
        let Some(ours) = of("correlated").next() else { continue };
        let _ = write!(text, "| {scene} | {:.2e} | {} |", ours.rmse, ours.time);
        of(SERIES).for_each(|r| {
            let _ = write!(text, " {:.2e} | {} |", r.rmse, r.time);
        });
        if let Some(most) = of(SERIES).next_back() {
            let (error, time) = (ours.rmse / most.rmse, ours.time.seconds / most.time.seconds);
            let _ = writeln!(text, " {error:.3}, {time:.3} |");
        }
    }
    text
}
