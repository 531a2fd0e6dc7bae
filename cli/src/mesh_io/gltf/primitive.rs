//! Triangles of a glTF mesh, placed in the world.

use super::accessor::{indices, numbers};
use super::bytes::Buffers;
use crate::coordinate::{LARGEST, is_usable};
use crate::mesh_io::FileMesh;
use ::gltf::Semantic;
use ::gltf::mesh::{Mode, Primitive};
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};
use pointillist_render::NONE;

/// Adds a primitive; `Ok(false)` for points and lines, which have no surface.
pub(super) fn append(
    primitive: &Primitive<'_>,
    world: DAffine3,
    material: u32,
    buffers: &Buffers,
    mesh: &mut FileMesh,
) -> Result<bool, String> {
    let Some(positions) = primitive.get(&Semantic::Positions) else { return Ok(false) };
    let positions = numbers::<3>(&positions, buffers)?;
    let count = positions.len();
    let order = match primitive.indices() {
        Some(accessor) => indices(&accessor, buffers)?,
        None => (0..count as u32).collect(),
    };
    if let Some(beyond) = order.iter().find(|&&i| i as usize >= count) {
        return Err(format!("index {beyond}, but there are {count} vertices"));
    }
    let Some(triangles) = triangles(primitive.mode(), &order) else { return Ok(false) };
    let base = [mesh.positions.len(), mesh.normals.len(), mesh.uvs.len()];
    // Two sets of coordinates may come from here.
    if base.iter().any(|b| b + 2 * count >= NONE as usize) {
        return Err("more vertices than can be numbered in 32 bits".to_owned());
    }
    mesh.positions.extend(positions.into_iter().map(|p| world.transform_point3(DVec3::from_array(p))));
    if mesh.positions[base[0]..].iter().any(|p| !is_usable(*p)) {
        return Err(format!("a vertex is beyond ±{LARGEST:e} where its node puts it"));
    }
    let has_normals = append_normals(primitive, world.matrix3, count, buffers, mesh)?;
    let has_uvs = append_uvs(primitive, 0, count, buffers, mesh)?;
    let second_base = mesh.uvs.len();
    let has_second = append_uvs(primitive, 1, count, buffers, mesh)?;
    if has_second {
        // Triangles before had none.
        mesh.second_uv_of.resize(mesh.triangles.len(), [NONE; 3]);
    }
    let lists_second = !mesh.second_uv_of.is_empty() || has_second;
    append_colors(primitive, base[0], count, buffers, mesh)?;
    let mirrored = world.matrix3.determinant() < 0.0;
    for [a, b, c] in triangles {
        let corners = if mirrored { [a, c, b] } else { [a, b, c] };
        let from = |base: usize, has: bool| corners.map(|i| if has { base as u32 + i } else { NONE });
        mesh.triangles.push(from(base[0], true));
        mesh.normal_of.push(from(base[1], has_normals));
        mesh.uv_of.push(from(base[2], has_uvs));
        if lists_second {
            mesh.second_uv_of.push(from(second_base, has_second));
        }
        mesh.material_of.push(material);
    }
    Ok(true)
}

/// `None` for what is not triangles.
fn triangles(mode: Mode, order: &[u32]) -> Option<Vec<[u32; 3]>> {
    match mode {
        Mode::Triangles => Some(order.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect()),
        Mode::TriangleStrip => {
            let turn =
                |(i, t): (usize, &[u32])| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
            Some(order.windows(3).enumerate().map(turn).collect())
        }
        Mode::TriangleFan => {
            let (first, rest) = order.split_first()?;
            Some(rest.windows(2).map(|t| [*first, t[0], t[1]]).collect())
        }
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => None,
    }
}

fn attribute<const N: usize>(
    primitive: &Primitive<'_>,
    semantic: Semantic,
    count: usize,
    buffers: &Buffers,
) -> Result<Option<Vec<[f64; N]>>, String> {
    let Some(accessor) = primitive.get(&semantic) else { return Ok(None) };
    let list = numbers::<N>(&accessor, buffers)?;
    if list.len() == count {
        return Ok(Some(list));
    }
    Err(format!("{} of {} for {count} vertices", list.len(), semantic.to_string()))
}

fn append_normals(
    primitive: &Primitive<'_>,
    linear: DMat3,
    count: usize,
    buffers: &Buffers,
    mesh: &mut FileMesh,
) -> Result<bool, String> {
    let Some(normals) = attribute::<3>(primitive, Semantic::Normals, count, buffers)? else {
        return Ok(false);
    };
    // Cofactors: the inverse transposed without a division.
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
    let turn = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * linear.determinant().signum();
    mesh.normals
        .extend(normals.into_iter().map(|n| (turn * DVec3::from_array(n)).normalize_or_zero().as_vec3()));
    Ok(true)
}

fn append_uvs(
    primitive: &Primitive<'_>,
    set: u32,
    count: usize,
    buffers: &Buffers,
    mesh: &mut FileMesh,
) -> Result<bool, String> {
    let Some(uvs) = attribute::<2>(primitive, Semantic::TexCoords(set), count, buffers)? else {
        return Ok(false);
    };
    // glTF's v runs downward.
    mesh.uvs.extend(uvs.into_iter().map(|[u, v]| DVec2::new(u, 1.0 - v)));
    Ok(true)
}

/// Colours are either none, or one for each position.
fn append_colors(
    primitive: &Primitive<'_>,
    first: usize,
    count: usize,
    buffers: &Buffers,
    mesh: &mut FileMesh,
) -> Result<(), String> {
    let semantic = Semantic::Colors(0);
    let Some(accessor) = primitive.get(&semantic) else {
        if !mesh.colors.is_empty() {
            mesh.colors.resize(first + count, Vec3::ONE);
        }
        return Ok(());
    };
    let colors: Vec<[f64; 3]> = if accessor.dimensions().multiplicity() == 4 {
        attribute::<4>(primitive, semantic, count, buffers)?
            .map(|list| list.into_iter().map(|[r, g, b, _]| [r, g, b]).collect())
    } else {
        attribute::<3>(primitive, semantic, count, buffers)?
    }
    .unwrap_or_default();
    mesh.colors.resize(first, Vec3::ONE);
    mesh.colors
        .extend(colors.into_iter().map(|c| DVec3::from_array(c).as_vec3().clamp(Vec3::ZERO, Vec3::ONE)));
    Ok(())
}
