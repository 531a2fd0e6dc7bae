//! Files of probes may be refused, but nothing panics, and what is read can be written and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pointillist_cli::probe_io::{ProbeFile, parse_probes, write_probes};

/// Binary files may hold what JSON cannot.
fn is_finite(file: &ProbeFile) -> bool {
    file.probes.iter().all(|p| {
        let sh = p.sh.iter().flatten().flatten();
        let maps = p.distances.iter().flat_map(|d| d.nearness.iter().chain(&d.deviation));
        p.position.iter().chain(sh).chain(p.sky.iter().flatten()).all(|v| v.is_finite())
            && maps.into_iter().all(|v| v.is_finite())
    })
}

fuzz_target!(|bytes: &[u8]| {
    let Ok(file) = parse_probes("probes", bytes) else { return };
    let _ = file.field("probes");
    if !is_finite(&file) {
        return;
    }
    for binary in [false, true] {
        let mut written = vec![];
        write_probes(&mut written, &file, binary).unwrap();
        assert_eq!(parse_probes("again", &written).unwrap(), file);
    }
});
