//! `shade`: what every reflection model does with the light that it gets, by quadrature, and what an evaluation costs.

use crate::common::provenance::provenance;
use crate::common::report::{Outcome, write};
use crate::common::timing::{Clock, HOW, Timing, timed, timed_by};
use glam::{DVec3, Vec3, vec3};
use pointillist_shade::{CubeMap, Environment, Material, MerlTable, Model, coat_albedo, directional_albedo};
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::Path;

/// Angles from the normal, in degrees.
const ANGLES: [f32; 6] = [0.0, 30.0, 60.0, 75.0, 85.0, 88.0];

/// Cells along each axis of the quadrature: its own error is then below 1e-3 but for the smoothest lobes at 88°.
const STEPS: usize = 500;

/// Energy that a model may seem to make: what the coat's table is off at grazing angles, and the quadrature's own error.
const TOLERANCE: f32 = 5e-3;

/// Pairs of directions for reciprocity and for time.
const PAIRS: u32 = 20_000;

/// A BRDF about the normal +Z.
struct Subject {
    name: String,
    brdf: Box<dyn Fn(Vec3, Vec3) -> Vec3>,
    /// Whether it promises to return no more light than it gets.
    promises: bool,
}

/// Writes `shade.md`; `false` if a model that promises otherwise makes light.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let mut text = format!(
        "# Reflection\n\n`cargo run --release -p studies -- shade` made this ({}).\n\n## Energy\n\nThe share of light that leaves again, by \
         the angle of the eye to the normal: ∫ f (n·l) dl with {STEPS}² cells packed towards the mirror direction. White \
         surfaces: 1 is all light. *Exchanged*: the largest relative difference after exchanging light and eye, over {PAIRS} pairs. *ns*: an \
         evaluation, called through a pointer. {HOW}\n\n| BRDF |",
        provenance()
    );
    for angle in ANGLES {
        write!(text, " {angle}° |")?;
    }
    text += " exchanged | ns |\n| --- |";
    text += &" ---: |".repeat(ANGLES.len() + 2);
    text += "\n";
    let mut kept = true;
    for subject in subjects() {
        let shares = ANGLES.map(|a| directional_albedo(tilted(a), STEPS, &subject.brdf).x);
        kept &= !subject.promises || shares.iter().all(|&s| s <= 1.0 + TOLERANCE);
        write!(text, "| {} |", subject.name)?;
        for share in shares {
            write!(text, " {share:.4} |")?;
        }
        writeln!(text, " {:.1e} | {:.0} |", exchanged(&subject), nanoseconds(&subject))?;
    }
    text += "\nThe plain Phong models promise nothing, and at the angles where they return more than 1 they make light. What GGX alone lacks at \
             high roughness is light that would bounce between facets more than once.\n";
    coat_table(&mut text)?;
    environment_table(&mut text)?;
    write(out_dir, "shade.md", &text)?;
    Ok(kept)
}

fn tilted(degrees: f32) -> Vec3 {
    let angle = degrees.to_radians();
    vec3(angle.sin(), 0.0, angle.cos())
}

fn subjects() -> Vec<Subject> {
    let mut list = Vec::new();
    let mut add = |name: String, promises: bool, material: Material| {
        list.push(Subject { name, promises, brdf: Box::new(move |l, v| material.brdf(Vec3::Z, l, v)) });
    };
    add("Lambert".to_owned(), true, Material::lambert(Vec3::ONE));
    let models = [
        (Model::Phong, "Phong, plain", false),
        (Model::BlinnPhong, "Blinn-Phong, plain", false),
        (Model::NormalizedPhong, "Phong", true),
        (Model::NormalizedBlinnPhong, "Blinn-Phong", true),
    ];
    for (model, name, promises) in models {
        for m in [1.0, 50.0, 1000.0] {
            let material = Material::lambert(Vec3::ZERO).with_specular(model, Vec3::ONE, m);
            add(format!("{name}, m = {m}"), promises, material);
        }
    }
    for roughness in [0.05, 0.2, 0.5, 1.0] {
        let mirror = Material::metallic_roughness(Vec3::ONE, 1.0, roughness);
        add(format!("GGX, mirror of roughness {roughness}"), true, mirror);
        let plastic = Material::metallic_roughness(Vec3::ONE, 0.0, roughness);
        add(format!("GGX, white plastic of roughness {roughness}"), true, plastic);
    }
    let plastic = Material::metallic_roughness(Vec3::ONE, 0.0, 0.5);
    let table = MerlTable::tabulate(|l, v| plastic.brdf(Vec3::Z, l, v));
    let brdf = Box::new(move |l, v| table.brdf(Vec3::Z, l, v));
    list.push(Subject {
        name: "MERL table of that plastic, roughness 0.5".to_owned(),
        promises: false,
        brdf,
    });
    list
}

/// Directions above the surface, the same in every run.
fn pairs() -> impl Iterator<Item = (Vec3, Vec3)> {
    let fraction = |i: u32, prime: f64| ((f64::from(i) + 0.5) * prime).fract();
    let direction = |u: f64, w: f64| {
        let (z, phi) = (u, std::f64::consts::TAU * w);
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * phi.cos(), r * phi.sin(), z).as_vec3()
    };
    // Steps by roots of primes: even in four dimensions.
    (0..PAIRS).map(move |i| {
        let [a, b, c, d] = [2.0f64, 3.0, 5.0, 7.0].map(|p| fraction(i, p.sqrt()));
        (direction(a, b), direction(c, d))
    })
}

fn exchanged(subject: &Subject) -> f32 {
    let difference = |(l, v): (Vec3, Vec3)| {
        let (there, back) = ((subject.brdf)(l, v).x, (subject.brdf)(v, l).x);
        if there.max(back) > 0.0 { (there - back).abs() / there.max(back) } else { 0.0 }
    };
    pairs().map(difference).fold(0.0, f32::max)
}

/// Of one evaluation.
fn nanoseconds(subject: &Subject) -> Timing {
    let list: Vec<(Vec3, Vec3)> = pairs().collect();
    let once = || {
        let sum: Vec3 = list.iter().map(|&(l, v)| (subject.brdf)(l, v)).sum();
        black_box(sum);
    };
    let (all, ()) = timed_by(Clock::Processor, once);
    Timing { seconds: all.seconds * 1e9 / f64::from(PAIRS), ..all }
}

/// The tabulated albedo of a coat against quadrature.
fn coat_table(text: &mut String) -> std::fmt::Result {
    *text += "\n## The coat's albedo from its table\n\nLargest difference from quadrature (1000² cells) over angles from 0° to 80°.\n\n\
              | roughness | f0 = 0.04 | f0 = 0.5 | f0 = 1 |\n| ---: | ---: | ---: | ---: |\n";
    for roughness in [0.1, 0.15, 0.25, 0.4, 0.6, 0.8, 1.0] {
        write!(text, "| {roughness} |")?;
        for f0 in [0.04, 0.5, 1.0] {
            let coat = Material::ggx(Vec3::ZERO, Vec3::splat(f0), roughness);
            let error = [0.0, 20.0, 40.0, 60.0, 80.0].map(|degrees| {
                let v = tilted(degrees);
                let exact = directional_albedo(v, 1000, |l, v| coat.brdf(Vec3::Z, l, v)).x;
                (coat_albedo(coat.specular, roughness, v.z).x - exact).abs()
            });
            write!(text, " {:.1e} |", error.into_iter().fold(0.0, f32::max))?;
        }
        text.push('\n');
    }
    Ok(())
}

/// A smooth sky with a sun, as rough mirrors see it, against quadrature over the same lobe.
fn environment_table(text: &mut String) -> std::fmt::Result {
    let sky = |d: DVec3| {
        let sun = (200.0 * (d.dot(DVec3::new(0.48, 0.6, 0.64)) - 1.0)).exp();
        (0.5 + 0.5 * d.y + 4.0 * sun) as f32
    };
    let (sharp, map) = timed(|| Environment::sharp(CubeMap::from_function(256, |d| Vec3::splat(sky(d)))));
    let (rough, map) = timed(|| map.clone().with_rough_levels());
    let (irradiance, map) = timed(|| map.clone().with_irradiance());
    write!(
        text,
        "\n## Mirrored surroundings\n\nA gradient from 0 to 1 with a sun of 4 that is 8° wide, on a cube of 256² a face ({sharp:.2} s), with \
         rough levels ({rough:.2} s) and irradiance ({irradiance:.2} s): difference from quadrature of the same lobe (n = v = r), \
         over 48 directions.\n\n| roughness | largest | RMS | mean radiance |\n| ---: | ---: | ---: | ---: |\n"
    )?;
    for roughness in [0.1, 0.2, 0.25, 0.5, 0.75, 1.0] {
        let (mut largest, mut squares, mut mean) = (0.0f64, 0.0, 0.0);
        for (r, _) in pairs().take(48) {
            let exact = lobe(&sky, r.as_dvec3(), f64::from(roughness));
            let error = (f64::from(map.radiance(r, roughness).x) - exact).abs();
            largest = largest.max(error);
            squares += error * error / 48.0;
            mean += exact / 48.0;
        }
        writeln!(text, "| {roughness} | {largest:.1e} | {:.1e} | {mean:.2} |", squares.sqrt())?;
    }
    Ok(())
}

/// ∫ L D (n·l) over its own weight, with n = v = r.
fn lobe(sky: &impl Fn(DVec3) -> f32, r: DVec3, roughness: f64) -> f64 {
    const CELLS: usize = 400;
    let a2 = roughness.powi(4);
    let (x, y) = r.any_orthonormal_pair();
    let (mut sum, mut whole) = (0.0, 0.0);
    for i in 0..CELLS {
        // Half vectors by the density of the distribution, evenly.
        let u = (i as f64 + 0.5) / CELLS as f64;
        let cos2 = (1.0 - u) / (1.0 + (a2 - 1.0) * u);
        let (cos, sin) = (cos2.sqrt(), (1.0 - cos2).sqrt());
        let cos_l = 2.0 * cos2 - 1.0;
        if cos_l <= 0.0 {
            continue;
        }
        for j in 0..CELLS {
            let phi = (j as f64 + 0.5) / CELLS as f64 * std::f64::consts::TAU;
            let h = x * (sin * phi.cos()) + y * (sin * phi.sin()) + r * cos;
            sum += f64::from(sky(2.0 * cos * h - r)) * cos_l;
            whole += cos_l;
        }
    }
    sum / whole
}
