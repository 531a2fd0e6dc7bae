//! Pairs a second beside pyviewfactor, if `POINTILLIST_PYVIEWFACTOR` names a Python that has it.

use std::fmt::Write as _;
use std::process::Command;

use pointillist_radiosity::{Scene, SceneOptions};

use crate::radiosity::cornell;
use crate::report::{Outcome, timed};

/// Visible, not obstructed, then the form factor, for pairs of the patches that standard input holds.
const SCRIPT: &str = r#"
import json, sys, time
import numpy as np, pyvista as pv, pyviewfactor as pvf
faces = json.load(sys.stdin)
cells = [pv.PolyData(np.array(f, float), faces=[len(f)] + list(range(len(f)))) for f in faces]
mesh = pv.merge([c.triangulate() for c in cells])
mesh = mesh if isinstance(mesh, pv.PolyData) else pvf.fc_unstruc2poly(mesh)
rng = np.random.default_rng(1)
pairs = rng.integers(0, len(cells), (400, 2))
def one(i, j):
    a, b = cells[i], cells[j]
    seen = pvf.get_visibility(a, b)
    seen = seen[0] if isinstance(seen, tuple) else seen
    if not seen: return 0.0
    free = pvf.get_obstruction(a, b, mesh)
    free = free[0] if isinstance(free, tuple) else free
    return pvf.compute_viewfactor(a, b) if free else 0.0
for i, j in pairs[:20]:
    if i != j: one(i, j)
start = time.perf_counter()
for i, j in pairs:
    if i != j: one(i, j)
print(len(pairs) / (time.perf_counter() - start))
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
                    "pyviewfactor, 400 random pairs of the same patches one by one (visibility, obstruction, form factor; one thread): {rate:.0} a second."
                )?,
                Err(_) => writeln!(text, "pyviewfactor did not answer: {said}")?,
            }
        }
    }
    Ok(true)
}
