//! Writes a town of any number of points as LAS, as a flight with a scanner would see it from above and aside: for trying clouds larger than memory.
//!
//! ```bash
//! cargo run --release -p pointillist --example generated_town -- 100000000 town.las
//! ```
//!
//! The points are a low-discrepancy sequence over 2 × 2 km: neighbours in the file are far apart in the town, which is the hardest order for a reader that
//! wants to keep neighbours together.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};

/// Metres along a side, and from house to house.
const SIDE: f64 = 2000.0;
const PLOT: f64 = 40.0;

/// Metres of the last digit, and where the town is: coordinates of a survey.
const SCALE: f64 = 0.001;
const OFFSET: [f64; 3] = [691_000.0, 5_334_000.0, 500.0];

/// LAS 1.2, format 2.
const HEADER_BYTES: u16 = 227;
const RECORD_BYTES: u16 = 26;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [count, path] = &arguments[..] else { return Err("usage: generated_town POINTS FILE.las".into()) };
    let count: u32 = count.parse()?;
    let mut output = BufWriter::with_capacity(1 << 20, File::create(path)?);
    output.write_all(&[0; HEADER_BYTES as usize])?;
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for number in 0..count {
        let (place, colour) = point(number);
        for axis in 0..3 {
            low[axis] = low[axis].min(place[axis]);
            high[axis] = high[axis].max(place[axis]);
            output.write_all(&((place[axis] / SCALE).round() as i32).to_le_bytes())?;
        }
        // Intensity; one return of one; class; angle, user data, source.
        output.write_all(&[0, 0, 0b0000_1001, if place[2] > 4.0 { 6 } else { 2 }, 0, 0, 0, 0])?;
        for channel in colour {
            output.write_all(&((channel * 65_535.0) as u16).to_le_bytes())?;
        }
    }
    output.seek(SeekFrom::Start(0))?;
    write_header(&mut output, count, low, high)?;
    output.flush()?;
    Ok(())
}

fn write_header(output: &mut impl Write, count: u32, low: [f64; 3], high: [f64; 3]) -> io::Result<()> {
    let mut header = vec![0; HEADER_BYTES as usize];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"LASF");
    put(24, &[1, 2]);
    put(94, &HEADER_BYTES.to_le_bytes());
    put(96, &u32::from(HEADER_BYTES).to_le_bytes());
    put(104, &[2]);
    put(105, &RECORD_BYTES.to_le_bytes());
    put(107, &count.to_le_bytes());
    put(111, &count.to_le_bytes());
    for axis in 0..3 {
        put(131 + 8 * axis, &SCALE.to_le_bytes());
        put(155 + 8 * axis, &OFFSET[axis].to_le_bytes());
        put(179 + 16 * axis, &(high[axis] + OFFSET[axis]).to_le_bytes());
        put(187 + 16 * axis, &(low[axis] + OFFSET[axis]).to_le_bytes());
    }
    output.write_all(&header)
}

/// A number from 0 to 1 that looks like chance, for a pair of whole ones.
fn noise(x: i64, y: i64, what: u64) -> f64 {
    let mut hash = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (y as u64).rotate_left(32)
        ^ what.wrapping_mul(0xd6e8_feb8_6659_fd93);
    for _ in 0..2 {
        hash = (hash ^ hash >> 32).wrapping_mul(0xd6e8_feb8_6659_fd93);
    }
    (hash >> 40) as f64 / (1u64 << 24) as f64
}

fn ground(x: f64, y: f64) -> f64 {
    12.0 * (x / 310.0).sin() * (y / 270.0).cos() + 1.5 * (x / 47.0 + y / 61.0).sin()
}

/// A point, metres from the corner, and its colour.
fn point(number: u32) -> ([f64; 3], [f64; 3]) {
    // Roberts' sequence in three dimensions.
    let along = |g: f64| (0.5 + f64::from(number) * g).fract();
    let [u, v, w] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3].map(along);
    let (x, y) = (u * SIDE, v * SIDE);
    let plot = [(x / PLOT).floor() as i64, (y / PLOT).floor() as i64];
    let middle = plot.map(|p| (p as f64 + 0.5) * PLOT);
    let chance = |what| noise(plot[0], plot[1], what);
    let (half_x, half_y) = (6.0 + 6.0 * chance(1), 6.0 + 6.0 * chance(2));
    let (dx, dy) = (x - middle[0], y - middle[1]);
    let base = ground(middle[0], middle[1]);
    let eaves = base + 5.0 + 12.0 * chance(3).powi(3);
    let grain = 0.85 + 0.15 * noise(i64::from(number), 7, 4);
    if chance(5) < 0.12 {
        return tree([x, y], [dx, dy], grain, w);
    }
    let over = (half_x - dx.abs()).min(half_y - dy.abs());
    if over > 0.0 {
        // The roof, and a share of its edge as walls.
        if over < 0.6 {
            let (wx, wy) = if half_x - dx.abs() < half_y - dy.abs() {
                (half_x * dx.signum(), dy)
            } else {
                (dx, half_y * dy.signum())
            };
            let low = ground(x, y).min(base);
            return (
                [middle[0] + wx, middle[1] + wy, low + w * (eaves - low)],
                [0.8, 0.76, 0.68].map(|c| c * grain),
            );
        }
        let height = eaves + 0.6 * (half_x - dx.abs());
        let tile = [[0.62, 0.25, 0.18], [0.45, 0.42, 0.42], [0.7, 0.45, 0.3]][(chance(6) * 3.0) as usize % 3];
        return ([x, y, height], tile.map(|c| c * grain));
    }
    let is_street = dx.abs() > 0.5 * PLOT - 3.0 || dy.abs() > 0.5 * PLOT - 3.0;
    let colour = if is_street { [0.42, 0.42, 0.44] } else { [0.32, 0.47, 0.22] };
    ([x, y, ground(x, y)], colour.map(|c| c * grain))
}

/// A plot with four trees.
fn tree([x, y]: [f64; 2], [dx, dy]: [f64; 2], grain: f64, w: f64) -> ([f64; 3], [f64; 3]) {
    let (tx, ty) = (dx.abs() - 8.0, dy.abs() - 8.0);
    let radius2 = tx * tx + ty * ty;
    let floor = ground(x, y);
    if radius2 > 25.0 {
        return ([x, y, floor], [0.3, 0.45, 0.2].map(|c| c * grain));
    }
    let crown = (25.0 - radius2).sqrt();
    ([x, y, floor + 7.0 + crown * (2.0 * w - 1.0)], [0.16, 0.36 + 0.1 * w, 0.12].map(|c| c * grain))
}
