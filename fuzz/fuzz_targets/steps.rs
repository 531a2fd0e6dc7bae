//! Small integers as geometry: corners that are often shared, coplanar or coincident.

use glam::{DVec3, dvec3};
use pointillist_micropoint::invariants::Soup;

/// A point in steps of 1/64.
pub(crate) fn steps([x, y, z]: [i8; 3]) -> DVec3 {
    dvec3(x.into(), y.into(), z.into()) / 64.0
}

/// At most `most` triangles with their opacities, and an opaque box of side 1/2.
pub(crate) fn soup_of(triangles: &[([[i8; 3]; 3], u8)], most: usize, box_at: Option<[i8; 3]>) -> Soup {
    let mut soup = Soup::default();
    for (corners, opacity) in triangles.iter().take(most) {
        let surface = soup.surface(f32::from(*opacity) / 255.0);
        soup.polygon(&corners.map(steps), surface);
    }
    if let Some(low) = box_at {
        let surface = soup.surface(1.0);
        soup.cuboid(steps(low), steps(low) + 0.5, surface);
    }
    soup
}
