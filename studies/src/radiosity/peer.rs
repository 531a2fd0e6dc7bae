//! Pairs a second and errors beside pyviewfactor, if there is a Python that has it.

use std::fmt::Write as _;
use std::process::{Command, Stdio};

use pointillist_radiosity::{FactorOptions, Scene, SceneOptions, Transport};

use crate::common::peers;
use crate::common::report::Outcome;
use crate::common::timing::timed;
use crate::radiosity::boxes::cornell;

/// All form factors of the patches that standard input holds, with visibility and obstruction; the first call, of two
/// patches, compiles.
const SCRIPT: &str = r#"
import json, sys, time
import numpy as np, pyvista as pv, pyviewfactor as pvf
def mesh_of(faces):
    points = np.array([p for f in faces for p in f], float)
    cells, first = [], 0
    for f in faces:
        cells += [len(f), *range(first, first + len(f))]
        first += len(f)
    return pv.PolyData(points, faces=cells)
def factors(mesh):
    return pvf.compute_viewfactor_matrix_fast(mesh, obstacles=mesh.triangulate())
faces = json.load(sys.stdin)
factors(mesh_of(faces[:2]))
mesh, count = mesh_of(faces), len(faces)
start = time.perf_counter()
found = factors(mesh)
rate = count * (count - 1) / 2 / (time.perf_counter() - start)
print(json.dumps([rate, found.T.ravel().tolist()]))
"#;

/// Names a Python that has it.
const PYTHON: &str = "POINTILLIST_PYVIEWFACTOR";

/// Longest edge of the patches.
const PATCH: f64 = 0.126;
/// Error asked for: relative in the open, relative behind something, and absolute there.
const ASKED: [(f64, f64, f64); 4] =
    [(1e-4, 1e-1, 1e-3), (1e-6, 1e-2, 1e-4), (1e-9, 1e-3, 1e-5), (1e-9, 1e-4, 1e-6)];
/// The same, of what the others are compared with.
const REFERENCE: (f64, f64, f64) = (1e-11, 1e-5, 1e-7);

struct Peer {
    rate: f64,
    /// From the row's patch to the column's.
    factors: Vec<f64>,
}

type Fallible<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// Root mean square over all form factors, largest, and largest of a row's sum.
struct Errors {
    root_mean_square: f64,
    worst: f64,
    worst_row: f64,
}

impl Errors {
    fn of(found: &[f64], exact: &[f64], count: usize) -> Self {
        let apart: Vec<f64> = found.iter().zip(exact).map(|(f, e)| f - e).collect();
        let squares: f64 = apart.iter().map(|d| d * d).sum();
        Self {
            root_mean_square: (squares / apart.len() as f64).sqrt(),
            worst: apart.iter().fold(0.0, |m, d| m.max(d.abs())),
            worst_row: apart.chunks(count).fold(0.0, |m, row| m.max(row.iter().sum::<f64>().abs())),
        }
    }

    fn columns(&self) -> String {
        format!("{:.1e} | {:.1e} | {:.1e}", self.root_mean_square, self.worst, self.worst_row)
    }
}

/// The section.
pub(crate) fn compare(text: &mut String) -> Outcome {
    let (_, exact) = linked(FactorOptions::DEFAULT, REFERENCE)?;
    let count = exact.patch_count();
    let truth = matrix(&exact);
    let pairs = count as f64 * (count as f64 - 1.0) / 2.0;
    let counts = exact.counts();
    writeln!(
        text,
        "\n## Pairs a second with visibility\n\nThe Cornell box above in {count} patches, all {pairs:.0} pairs, of which {} exchange light and {} of these are partly hidden. \
         Asked for are a relative error in the open, a relative one behind something, and an absolute one that is enough there. Errors found are absolute, of form factors that \
         are {:.1e} in the mean, against {} asked for.\n",
        counts.links,
        counts.partly_hidden,
        truth.iter().sum::<f64>() / truth.len() as f64,
        list(REFERENCE),
    )?;
    let peer = peer(&exact)?;
    let columns = "| asked for | cells sampled | pairs a second | of pyviewfactor's | root mean square error | worst | worst row sum |";
    writeln!(text, "{columns}\n| --- | ---: | ---: | ---: | ---: | ---: | ---: |")?;
    for asked in ASKED {
        let (seconds, found) = linked(SceneOptions::DEFAULT.factors, asked)?;
        let rate = pairs / seconds;
        let times = peer.as_ref().map_or("–".to_owned(), |p| format!("{:.1}", rate / p.rate));
        let errors = Errors::of(&matrix(&found), &truth, count).columns();
        writeln!(text, "| {} | {} | {rate:.0} | {times} | {errors} |", list(asked), found.counts().cells)?;
    }
    match peer {
        Some(peer) => writeln!(
            text,
            "| pyviewfactor, `compute_viewfactor_matrix_fast` with obstruction, all its threads | – | {:.0} | 1 | {} |\n\n\
             pyviewfactor asks whether two centres see each other.",
            peer.rate,
            Errors::of(&peer.factors, &truth, count).columns()
        )?,
        None => {
            writeln!(text, "\n{} `studies/peers/build python` does.", peers::skipped("pyviewfactor", PYTHON))?
        }
    }
    writeln!(text, "\n{TRIED}")?;
    Ok(true)
}

/// What was measured when cells began to be cut along lines.
const TRIED: &str = "\
    Cells are cut along the lines where what is hidden changes its kind. Beside the algorithm before, which only quartered them, both in turn on one thread, processor seconds for all pairs, errors against \
    1e-12, 1e-6, 1e-9 asked for: at 1e-9, 1e-3, 1e-5 it took 1.94 s and erred by 7.9e-7 in the root mean square, at 1e-9, 1e-4, 1e-6 4.05 s and 4.0e-7, at 1e-12, 1e-6, 1e-9 41 s and 3.3e-7, since samples missed the light \
    between lamp and ceiling; now 1.72 s and 1.3e-7, 1.73 s and 8.0e-8 (a ten-thousandth of the mean). Tried: cut only where a first sample is not good enough, 1.98 s and 9.2e-8; parts no narrower than a twenty-fifth in the place of three thousandths, \
    1.94 s and 3.6e-7; smoothness taken to the second power in the place of the third, 2.40 s and 8.8e-8. What limits it: pairs in the open and the search for occluders alone take 0.6 s, and twenty times pyviewfactor's rate is 0.92 s, which leaves 7 µs for each \
    of the partly hidden pairs; a single cell of 13 samples takes 8. \
     Rates are wall-clock: beside work for six times as many cores as there are, two runs in a row gave 5.3 and 8.8 times pyviewfactor's in its last row. By processor time \
     the rate is 2.34 times what it was before, when it was 4.2 times pyviewfactor's on a quiet machine.";

fn list((open, relative, absolute): (f64, f64, f64)) -> String {
    format!("{open:e}, {relative:e}, {absolute:e}")
}

/// Seconds, and all links.
fn linked(factors: FactorOptions, (open, relative, absolute): (f64, f64, f64)) -> Fallible<(f64, Transport)> {
    let factors = factors.with_unoccluded(open).with_occluded(relative).with_absolute(absolute);
    let scene = Scene::new(&cornell(), &SceneOptions::DEFAULT.with_patch(PATCH).with_factors(factors))?;
    let (time, found) = timed(|| scene.clone().transport(&[]));
    Ok((time.seconds, found?))
}

/// Form factors, row by row.
fn matrix(transport: &Transport) -> Vec<f64> {
    let count = transport.patch_count();
    let mut all = vec![0.0; count * count];
    transport.factors(|from, to, factor| all[from * count + to] = factor);
    all
}

/// What pyviewfactor says of the same patches; none without it.
fn peer(transport: &Transport) -> Fallible<Option<Peer>> {
    let Some(python) = peers::find(PYTHON, "python/bin/python") else { return Ok(None) };
    let mut child =
        Command::new(python).args(["-c", SCRIPT]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    let faces: Vec<Vec<[f64; 3]>> =
        transport.patch_corners().map(|ring| ring.iter().map(|p| p.to_array()).collect()).collect();
    if let Some(input) = child.stdin.take() {
        serde_json::to_writer(input, &faces)?;
    }
    let output = child.wait_with_output()?;
    let (rate, factors) = serde_json::from_slice(&output.stdout)?;
    Ok(Some(Peer { rate, factors }))
}
