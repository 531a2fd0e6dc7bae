//! Range scans for `scan`: files in, points in the world out.

mod mesh;
mod mesh_points;

use crate::cloud_io::{self, Pose};
use crate::error::CliError;
use crate::input;
use crate::input_error::InputError;
use crate::memory::Meter;
use crate::points::{Colouring, Legend, Part, PointOptions, read_points};
use crate::scene::Camera;
use glam::{DVec3, Vec3};
use mesh::LoadedMesh;
use pointillist_ibpr as ibpr;
use pointillist_render::fingerprint::ByteHash;
use std::path::Path;

/// Bytes of a point: as it is kept here, and what the renderer makes of it.
const POINT_BYTES: u64 = 48;

/// A file's points in the world.
#[derive(Clone, Debug, Default)]
pub struct LoadedScan {
    positions: Vec<DVec3>,
    /// Linear RGB, or empty.
    colours: Vec<[f32; 3]>,
    /// From 0 to 1, or empty: opaque.
    opacities: Vec<f32>,
    /// What was measured, if points are coloured by it.
    values: Vec<f32>,
    /// Name of the file.
    name: String,
    spacing: Option<f64>,
    /// Direction to the scanner.
    towards_scanner: Option<DVec3>,
}

/// Everything that one picture is made of.
#[derive(Clone, Debug, Default)]
pub struct ScanSet {
    /// In the order of the command line.
    pub scans: Vec<LoadedScan>,
    /// Meshes that get points once the view is known, after the scans.
    meshes: Vec<LoadedMesh>,
    /// The view that the first `.conf` with one suggests: camera from world, the camera looking along its −z.
    pub view: Option<Pose>,
    /// What may be wrong, with the name of the file.
    pub warnings: Vec<String>,
    /// Points left out because they were not finite.
    pub dropped: u64,
    /// What its points take.
    meter: Meter,
}

/// How files become scans.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// How their points are read.
    pub points: PointOptions,
    /// Distance of neighbouring points in the place of an estimate.
    pub spacing: Option<f64>,
    /// Take the vertices of meshes in the place of points all over them.
    pub vertices: bool,
}

impl ScanSet {
    /// Reads scans (`.ply`, `.xyz`, …), lists of scans (`.conf`) and meshes (`.obj`, `.ply` with faces).
    ///
    /// # Errors
    ///
    /// [`InputError`] for the first file that cannot be used.
    pub fn load(paths: &[std::path::PathBuf], options: &LoadOptions) -> Result<Self, InputError> {
        let mut set = Self::default();
        let mut meshes = vec![];
        for path in paths {
            match input::kind_of(path)?.as_str() {
                "conf" => {
                    let conf = cloud_io::read_conf(path)?;
                    set.view = set.view.or(conf.camera);
                    set.warnings.extend(conf.warnings);
                    for scan in &conf.scans {
                        set.read(&scan.path, Some(scan.pose), options)?;
                    }
                }
                "obj" => meshes.push(path),
                _ => {
                    let faces = set.read(path, None, options)?;
                    if faces > 0 && !options.vertices {
                        set.scans.pop();
                        meshes.push(path);
                    }
                }
            }
        }
        // What is selected may lie in other files.
        set.scans.retain(|scan| !scan.positions.is_empty());
        for path in meshes {
            options.points.refuse_mesh(path)?;
            let mesh = LoadedMesh::load(path)?;
            if options.vertices {
                set.scans.push(mesh.into_vertices(options.spacing));
            } else {
                set.meshes.push(mesh.with_area()?);
            }
        }
        let count: usize = set.scans.iter().map(|scan| scan.positions.len()).sum();
        if set.meshes.is_empty() {
            options.points.selection.check_any(count, paths)?;
        }
        Ok(set)
    }

    /// Gives the points the colours that are asked for; returns what they mean.
    pub fn colour(&mut self, colouring: &Colouring) -> Option<Legend> {
        let parts: Vec<Part<'_>> = (self.scans.iter().enumerate())
            .map(|(number, LoadedScan { positions, values, name, .. })| Part {
                positions,
                values,
                name,
                number,
            })
            .collect();
        let (colours, legend) = colouring.colours(&parts)?;
        for (scan, colours) in self.scans.iter_mut().zip(colours) {
            scan.colours = colours;
        }
        Some(legend)
    }

    /// All positions that there are so far: those of scans, and the corners of meshes.
    pub fn positions(&self) -> impl Iterator<Item = DVec3> + '_ {
        let scans = self.scans.iter().flat_map(|scan| scan.positions.iter().copied());
        scans.chain(self.meshes.iter().flat_map(LoadedMesh::corners))
    }

    /// Whether any point is not opaque.
    pub fn has_translucent(&self) -> bool {
        self.scans.iter().any(|scan| !scan.opacities.is_empty())
    }

    /// Puts points on the meshes, as many as a picture of the view needs: as far apart as pixels, or as the points of the scans
    /// if those are farther apart, or as `spacing` says.
    pub fn cover_meshes(&mut self, camera: &Camera, size: [u32; 2], spacing: Option<f64>) {
        let meshes = std::mem::take(&mut self.meshes);
        if meshes.is_empty() {
            return;
        }
        let least = spacing.or_else(|| self.typical_spacing());
        for (mesh, most) in meshes.iter().zip(mesh::shares(&meshes)) {
            let (scan, warning) = mesh.covered(camera, size, least, most);
            self.warnings.extend(warning);
            self.scans.push(scan);
        }
    }

    /// Adds a file's points and returns how many faces it has beside.
    fn read(&mut self, path: &Path, pose: Option<Pose>, options: &LoadOptions) -> Result<u64, InputError> {
        let mut scan = LoadedScan { name: input::name_of(path), ..LoadedScan::default() };
        let summary = read_points(path, &options.points, pose.as_ref(), &mut |block, values| {
            scan.positions.extend_from_slice(block.positions);
            scan.values.extend_from_slice(values);
            scan.colours.extend_from_slice(block.colours.unwrap_or_default());
            scan.opacities.extend_from_slice(block.opacities.unwrap_or_default());
            let taken = block.positions.len() as u64 * POINT_BYTES;
            self.meter
                .add(taken, || "its points take".to_owned())
                .map_err(|error| error.in_file(input::name_of(path)))
        })?;
        let name = input::name_of(path);
        self.warnings.extend(summary.warnings.iter().map(|warning| format!("{name}: {warning}")));
        self.dropped += summary.dropped;
        // Programs that write an opacity mostly write 1.
        if scan.opacities.iter().all(|&opacity| opacity == 1.0) {
            scan.opacities = Vec::new();
        } else if scan.opacities.iter().all(|&opacity| opacity == 0.0) {
            let warning = "all its points have opacity 0, so that nothing is seen of them";
            self.warnings.push(format!("{name}: {warning}; `--ignore-alpha` draws them opaque"));
        }
        scan.spacing = options.spacing.or(summary.grid.and_then(|grid| grid.spacing));
        // A Stanford range grid is seen from its +z, and so is every scan of a .conf.
        if pose.is_some() || summary.grid.is_some() {
            scan.towards_scanner = Some(pose.map_or(DVec3::Z, |pose| pose.rotation * DVec3::Z));
        }
        self.scans.push(scan);
        Ok(summary.faces)
    }

    /// Spacing of the scans read so far, measured all together.
    fn typical_spacing(&self) -> Option<f64> {
        let cloud = self.cloud(Vec3::ONE).ok()?;
        Some(cloud.spacing()).filter(|s| *s > 0.0)
    }

    /// Makes the points ready to be drawn; `base` is the colour of those that have none.
    ///
    /// # Errors
    ///
    /// [`CliError::Failed`] if the renderer refuses them, for example for being too many.
    pub fn cloud(&self, base: Vec3) -> Result<ibpr::Cloud, CliError> {
        let scans: Vec<ibpr::Scan<'_>> = self.scans.iter().map(LoadedScan::as_scan).collect();
        ibpr::Cloud::new(&scans, base).map_err(|error| CliError::Failed(error.to_string()))
    }

    /// Hash of all that is drawn.
    pub fn fingerprint(&self) -> u64 {
        let mut hash = ByteHash::default();
        for scan in &self.scans {
            for value in scan.positions.iter().flat_map(|p| p.to_array()) {
                hash.write(&value.to_le_bytes());
            }
            for value in scan.colours.iter().flatten().chain(&scan.opacities) {
                hash.write(&value.to_le_bytes());
            }
            hash.write(format!("{:?} {:?};", scan.spacing, scan.towards_scanner).as_bytes());
        }
        hash.finish()
    }
}

impl LoadedScan {
    fn as_scan(&self) -> ibpr::Scan<'_> {
        let mut scan = ibpr::Scan::new(&self.positions);
        if !self.colours.is_empty() {
            scan = scan.with_colors(&self.colours);
        }
        if !self.opacities.is_empty() {
            scan = scan.with_opacities(&self.opacities);
        }
        if let Some(spacing) = self.spacing {
            scan = scan.with_spacing(spacing);
        }
        if let Some(towards) = self.towards_scanner {
            scan = scan.with_scanner(towards);
        }
        scan
    }
}
