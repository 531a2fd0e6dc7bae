//! Pairs a second beside pyviewfactor, if `POINTILLIST_PYVIEWFACTOR` names a Python that has it.

use std::fmt::Write as _;
use std::process::Command;

use pointillist_radiosity::{Scene, SceneOptions};

use crate::radiosity::cornell;
use crate::report::{Outcome, timed};

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
factors(mesh)
print(count * (count - 1) / 2 / (time.perf_counter() - start))
"#;

/// The section.
pub(crate) fn compare(text: &mut String) -> Outcome {
    let options = SceneOptions::DEFAULT.with_patch(0.126);
    let scene = Scene::new(&cornell(), &options)?;
    let count = scene.patch_count();
    let pairs = count as f64 * (count as f64 - 1.0) / 2.0;
    let (seconds, linked) = timed(|| scene.clone().transport(&[]));
    let (transport, _) = linked?;
    let counts = transport.counts();
    writeln!(text, "\n## Pairs a second with visibility\n")?;
    writeln!(
        text,
        "The Cornell box above in {count} patches, all pairs: {pairs:.0} pairs in {seconds:.2} s, {:.0} a second, \
         {} of them exchange light and {} of these are partly hidden ({} cells sampled); error asked for 1e-9 in the open, 1e-4 behind something or 1e-6 absolute.\n",
        pairs / seconds,
        counts.links,
        counts.partly_hidden,
        counts.cells
    )?;
    match std::env::var_os("POINTILLIST_PYVIEWFACTOR") {
        None => writeln!(
            text,
            "pyviewfactor was not run: `POINTILLIST_PYVIEWFACTOR` names no Python that has it."
        )?,
        Some(python) => {
            let mut child = Command::new(python)
                .args(["-c", SCRIPT])
                .stdin(std::process::Stdio::piped())
                .stdout(std::process::Stdio::piped())
                .spawn()?;
            let faces: Vec<Vec<[f64; 3]>> =
                transport.patch_corners().map(|ring| ring.iter().map(|p| p.to_array()).collect()).collect();
            if let Some(input) = child.stdin.take() {
                serde_json::to_writer(input, &faces)?;
            }
            let output = child.wait_with_output()?;
            let said = String::from_utf8_lossy(&output.stdout).trim().to_owned();
            match said.parse::<f64>() {
                Ok(rate) => writeln!(
                    text,
                    "pyviewfactor, `compute_viewfactor_matrix_fast` of the same patches with obstruction, all its threads: {rate:.0} a second; ours are {:.2} times as many.",
                    pairs / seconds / rate
                )?,
                Err(_) => writeln!(text, "pyviewfactor did not answer: {said}")?,
            }
        }
    }
    Ok(true)
}
