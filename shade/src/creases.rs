//! Corner normals that keep sharp edges sharp.

use crate::normals::{corners_of, extent, shares, unit};
use crate::{ShadeError, Weighting, face_normal};
use glam::{DVec3, Vec3};

/// A normal for every corner of every triangle; corners on the same side of all creases share one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CornerNormals {
    /// Unit normals; zero where all faces of a corner are without area.
    pub normals: Vec<Vec3>,
    /// For each triangle, the normals of its corners.
    pub normal_of: Vec<[u32; 3]>,
}

/// Means over the faces around each vertex, split where neighbouring faces meet at more than `crease_rad`.
///
/// Faces are neighbours if they share an edge. Around a vertex they form groups that can be walked through without crossing
/// an edge with a sharper fold, and each group has its own mean. At π and above nothing is a crease, and all faces of a
/// vertex form one group; below 0 every edge is one. A face without area joins no group but its own. The same input gives the same bytes.
///
/// # Errors
///
/// As [`crate::vertex_normals`]; [`ShadeError::BadCrease`] if the angle is NaN.
pub fn corner_normals(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    weighting: Weighting,
    crease_rad: f64,
) -> Result<CornerNormals, ShadeError> {
    if crease_rad.is_nan() {
        return Err(ShadeError::BadCrease { crease_rad });
    }
    if let Some(index) = positions.iter().position(|p| !p.is_finite()) {
        return Err(ShadeError::VertexNotFinite { index, value: positions[index].to_array() });
    }
    let extent = extent(positions);
    let mut faces = Vec::with_capacity(triangles.len());
    let mut parts = Vec::with_capacity(triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        let points = corners_of(positions, triangle, *corners)?;
        faces.push(face_normal(points[0], points[1], points[2]));
        parts.push(shares(points, weighting, extent));
    }
    let around = Fans::new(positions.len(), triangles);
    let mut result = CornerNormals { normals: Vec::new(), normal_of: vec![[0; 3]; triangles.len()] };
    let mut groups = Groups::default();
    for vertex in 0..positions.len() {
        let fan = around.of(vertex);
        groups.find(vertex as u32, fan, triangles, &faces, crease_rad);
        for first in (0..fan.len()).filter(|&i| groups.root(i) == i) {
            let number = result.normals.len() as u32;
            let mut sum = DVec3::ZERO;
            for (i, &(triangle, corner)) in fan.iter().enumerate() {
                if groups.root(i) == first {
                    sum += parts[triangle as usize][corner as usize];
                    result.normal_of[triangle as usize][corner as usize] = number;
                }
            }
            result.normals.push(unit(sum).as_vec3());
        }
    }
    Ok(result)
}

/// The corners (triangle and place in it) at each vertex, in the order of the triangles.
struct Fans {
    first: Vec<u32>,
    corners: Vec<(u32, u8)>,
}

impl Fans {
    fn new(vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let mut first = vec![0; vertices + 1];
        triangles.iter().flatten().for_each(|&v| first[v as usize + 1] += 1);
        for v in 0..vertices {
            first[v + 1] += first[v];
        }
        let mut next = first.clone();
        let mut corners = vec![(0, 0); 3 * triangles.len()];
        for (t, triangle) in triangles.iter().enumerate() {
            for (k, &v) in triangle.iter().enumerate() {
                corners[next[v as usize] as usize] = (t as u32, k as u8);
                next[v as usize] += 1;
            }
        }
        Self { first, corners }
    }

    fn of(&self, vertex: usize) -> &[(u32, u8)] {
        &self.corners[self.first[vertex] as usize..self.first[vertex + 1] as usize]
    }
}

/// Groups of one vertex's corners: a forest in which every root is the first of its group.
#[derive(Default)]
struct Groups {
    parent: Vec<usize>,
    /// The vertex at the other end of an edge, and a corner that has this edge.
    edges: Vec<(u32, usize)>,
}

impl Groups {
    fn find(
        &mut self,
        vertex: u32,
        fan: &[(u32, u8)],
        triangles: &[[u32; 3]],
        faces: &[DVec3],
        crease_rad: f64,
    ) {
        self.parent.clear();
        if crease_rad >= std::f64::consts::PI {
            self.parent.resize(fan.len(), 0);
            return;
        }
        self.parent.extend(0..fan.len());
        self.edges.clear();
        for (i, &(t, _)) in fan.iter().enumerate() {
            let others = triangles[t as usize].iter().filter(|&&v| v != vertex);
            self.edges.extend(others.map(|&v| (v, i)));
        }
        self.edges.sort_unstable();
        for pair in 1..self.edges.len() {
            let ((v, a), (w, b)) = (self.edges[pair - 1], self.edges[pair]);
            let (na, nb) = (faces[fan[a].0 as usize], faces[fan[b].0 as usize]);
            if v == w && na != DVec3::ZERO && nb != DVec3::ZERO && na.angle_between(nb) <= crease_rad {
                self.join(a, b);
            }
        }
    }

    fn root(&self, mut i: usize) -> usize {
        while self.parent[i] != i {
            i = self.parent[i];
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = (a.min(b), a.max(b));
        self.parent[high] = low;
    }
}
