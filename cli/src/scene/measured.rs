//! Measured reflection from files, each read once.

use super::MeasuredBrdf;
use pointillist_shade::MerlTable;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The measured BRDFs of a scene.
#[derive(Default)]
pub(super) struct MeasuredTable {
    known: HashMap<PathBuf, MeasuredBrdf>,
}

impl MeasuredTable {
    /// The table in this file, read if it is new.
    ///
    /// # Errors
    ///
    /// What is wrong, as the end of a sentence that begins with the path.
    pub(super) fn load(&mut self, path: &Path) -> Result<MeasuredBrdf, String> {
        if let Some(known) = self.known.get(path) {
            return Ok(known.clone());
        }
        let bytes = crate::memory::read(path).map_err(|error| format!("cannot be read: {error}"))?;
        let table = MerlTable::from_bytes(&bytes).map_err(|error| format!("cannot be used: {error}"))?;
        let fingerprint = twox_hash::XxHash3_64::oneshot(&bytes);
        let measured = MeasuredBrdf { table: Arc::new(table), fingerprint };
        self.known.insert(path.to_path_buf(), measured.clone());
        Ok(measured)
    }
}
