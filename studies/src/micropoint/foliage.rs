//! Foliage: hundreds of cards with a mask, one behind the other and in each other's shadow, alone and back to back.

use std::fmt::Write as _;
use std::path::Path;

use crate::common::against_samples::{CELLS, MORE, Subject, conditions, draw_cells, summary};
use crate::common::leaves::{CARDS, Cards, SIZE, bush};
use crate::common::ray_reference::sampled_with_shadows;
use crate::common::report::{Outcome, Row, table, verdict, write, write_csv};

/// Texels on a side of the masks.
const MASKS: [u32; 2] = [64, 512];

/// Samples along a side of a pixel in each half of an expected picture.
const FINE: u32 = 40;

/// Measures and writes `micropoint-foliage.csv` and `micropoint-foliage.md`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let (mut subjects, mut rows) = (vec![], vec![]);
    let mut differences =
        "| scene | cells | pixels that differ | RMSE | largest difference | equal |\n| --- | --- | ---: | ---: | ---: | --- |\n".to_owned();
    for texels in MASKS {
        eprintln!("micropoint: foliage, {texels} texels");
        let [single, pairs] = [Cards::Single, Cards::Pairs].map(|cards| bush(texels, cards));
        let name = format!("mask {texels}×{texels}");
        let subject = Subject::between(name, [2, 3].map(|seed| sampled_with_shadows(&single, FINE, seed)));
        rows.extend(subject.cells("cards", &CELLS, &single));
        rows.extend(subject.cells("pairs", &CELLS, &pairs));
        rows.extend(subject.samples(|n| sampled_with_shadows(&single, n, 1)));
        for cells in CELLS {
            let [single, pairs] = [draw_cells(&single, cells)?, draw_cells(&pairs, cells)?];
            let differ = single.pixels.iter().zip(&pairs.pixels).filter(|(a, b)| a != b).count();
            writeln!(
                differences,
                "| {} | {cells}×{cells} | {differ} | {:.1e} | {:.1e} | {} |",
                subject.name,
                pairs.rmse(&single),
                pairs.largest_error(&single),
                verdict(differ == 0)
            )?;
        }
        subjects.push(subject);
    }
    write_csv(out_dir, "micropoint-foliage", &MORE, &rows)?;
    write(out_dir, "micropoint-foliage.md", &markdown(&subjects, &rows, &differences))?;
    Ok(true)
}

fn markdown(subjects: &[Subject], rows: &[Row], differences: &str) -> String {
    format!(
        "# Foliage: time against error\n\n{}\n\n{CARDS} cards with a mask of a twig (alpha 0 between its leaflets), turned at random, in a bush above the \
         ground; a sun and a lamp, both with shadows; {SIZE}×{SIZE} pixels, flat shading. *Cards* are drawn once each, *pairs* are two \
         cards of opposite winding in one place, which must look like one. Samples are of the cards alone. Expected pictures: 2 × {} \
         samples a pixel; their own error is half of what the halves differ by.\n\n## Beside samples\n\n{}\n## Pairs against cards alone\n\n{differences}\n\
         ## All settings\n\n{}",
        conditions("micropoint foliage"),
        FINE * FINE,
        summary(subjects, rows),
        table(&MORE, rows)
    )
}
