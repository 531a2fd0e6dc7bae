//! Where the corners of a cube land in a picture, and what is seen in its middle:
//! `cargo run -p pointillist-view --example cube_in_a_picture`

use glam::{DVec3, dvec3};
use pointillist_view::{Projection, View, ViewError};

fn main() -> Result<(), ViewError> {
    let camera = Projection::Perspective { fov_y_rad: 40_f64.to_radians() };
    let view = View::look_at(dvec3(3.0, 2.5, 4.0), DVec3::ZERO, DVec3::Y, camera, 60, 30)?;

    // The cube from −1 to 1: bit i of the number says on which side the corner is along axis i.
    let side = |number: usize, axis: usize| if number >> axis & 1 == 1 { 1.0 } else { -1.0 };
    let corner = |n: usize| dvec3(side(n, 0), side(n, 1), side(n, 2));
    let mut picture = vec![vec!['.'; 60]; 30];
    let mut draw = |point: DVec3, sign: char| {
        if let Some(seen) = view.project(point) {
            let (x, y) = (seen.pixel.x as usize, seen.pixel.y as usize);
            if let Some(pixel) = picture.get_mut(y).and_then(|row| row.get_mut(x)) {
                *pixel = sign;
            }
        }
    };
    for (from, axis) in (0..8).flat_map(|n| (0..3).map(move |axis| (n, axis))) {
        let to = from ^ (1 << axis);
        (1..16).for_each(|i| draw(corner(from).lerp(corner(to), f64::from(i) / 16.0), '+'));
    }
    for number in 0..8 {
        draw(corner(number), char::from_digit(number as u32, 10).unwrap_or('?'));
    }
    picture.iter().for_each(|row| println!("{}", row.iter().collect::<String>()));

    for number in 0..8 {
        if let Some(seen) = view.project(corner(number)) {
            println!("{number} {} is at pixel {:.1}, {:.3} deep", corner(number), seen.pixel, seen.depth);
        }
    }
    // Depth is counted along the view direction: the nearest corner is this far along its ray.
    if let Some(nearest) = view.project(DVec3::ONE) {
        let ray = view.ray(nearest.pixel);
        let distance = ray.direction.length() * nearest.depth;
        println!("corner 7: {:.3} deep, {distance:.3} from the eye", nearest.depth);
        println!("and back: {:.3}", view.unproject(nearest.pixel, nearest.depth));
    }
    Ok(())
}
