//! The options that are compared, each group about the defaults.

use pointillist_ibpr::{Culling, Light, Normals, Options, Passes, Scale, Weighting};

use crate::common::true_surface::{ALBEDO, AMBIENT, LIGHT};

/// A name and what it stands for.
pub(crate) type Setting = (String, Options);

/// Settings that differ in one option.
pub(crate) struct Group {
    pub(crate) name: &'static str,
    pub(crate) settings: Vec<Setting>,
}

/// The defaults under the light of the study.
pub(crate) fn defaults() -> Options {
    let mut options = Options::default();
    options.light = Light::Towards(LIGHT);
    options.ambient = AMBIENT as f32;
    options.base = glam::Vec3::splat(ALBEDO as f32);
    options
}

fn changed(name: impl Into<String>, change: impl FnOnce(&mut Options)) -> Setting {
    let mut options = defaults();
    change(&mut options);
    (name.into(), options)
}

/// One group per option.
pub(crate) fn groups() -> Vec<Group> {
    let scales = [1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.4];
    let numbers = |name: &'static str, values: &[f32], set: fn(&mut Options, f32)| Group {
        name,
        settings: values.iter().map(|v| changed(format!("{name} {v}"), |o| set(o, *v))).collect(),
    };
    vec![
        Group { name: "default", settings: vec![("default".to_owned(), defaults())] },
        numbers("factor", &scales, |o, v| o.scale = Scale::Auto(v)),
        Group { name: "triangles", settings: scales.map(triangles).into() },
        numbers("γ", &[1.0, 2.0, 3.0], |o, v| o.gamma = v),
        Group { name: "passes", settings: passes() },
        Group { name: "weighting", settings: weightings() },
        numbers("outline", &[0.0, 0.2, 0.3, 0.35, 0.5], |o, v| o.outline = v),
        numbers("fill", &[0.0, 1.0, 2.0], |o, v| o.fill = v as u32),
        Group { name: "culling", settings: cullings() },
        Group { name: "together", settings: together() },
    ]
}

/// The defaults once more, on scans with another seed.
pub(crate) fn again(seed: u64) -> Vec<Group> {
    vec![Group { name: "default", settings: vec![(format!("default, seed {seed}"), defaults())] }]
}

fn triangles(factor: f32) -> Setting {
    changed(format!("eight triangles, factor {factor}"), |o| {
        (o.normals, o.scale) = (Normals::Triangles, Scale::Auto(factor));
    })
}

fn passes() -> Vec<Setting> {
    let two = |finer: f32| changed(format!("two passes, {finer}"), |o| o.passes = Passes::Two { finer });
    let mut list = vec![changed("one pass", |_| {})];
    list.extend([0.66, 0.75, 0.83].map(two));
    list
}

fn weightings() -> Vec<Setting> {
    let rules = [
        ("printed", Weighting::Printed),
        ("falling", Weighting::Falling),
        ("even", Weighting::Even),
        ("symmetric", Weighting::Symmetric),
    ];
    let with = |(name, rule): (&str, Weighting), gamma: f32| {
        changed(format!("{name}, γ {gamma}"), |o| (o.weighting, o.gamma) = (rule, gamma))
    };
    rules.iter().flat_map(|r| [2.0, 3.0].map(|gamma| with(*r, gamma))).collect()
}

fn cullings() -> Vec<Setting> {
    [
        ("nothing culled", Culling::None),
        ("scans, as printed", Culling::Printed),
        ("scans", Culling::Scans),
        ("blocks", Culling::Blocks),
    ]
    .map(|(name, culling)| changed(name, |o| o.culling = culling))
    .into()
}

/// Small buffer pixels need wider gaps filled, and then show more.
fn together() -> Vec<Setting> {
    let with = |factor: f32, outline: f32, gamma: f32| {
        changed(format!("factor {factor}, fill 2, outline {outline}, γ {gamma}"), |o| {
            (o.scale, o.fill, o.outline, o.gamma) = (Scale::Auto(factor), 2, outline, gamma);
        })
    };
    let mut list: Vec<_> = [1.1, 1.2, 1.3, 1.4].map(|factor| with(factor, 0.3, 2.0)).into();
    list.extend([0.25, 0.35].map(|outline| with(1.2, outline, 2.0)));
    list.push(with(1.2, 0.3, 3.0));
    let (name, mut sharper) = with(1.2, 0.3, 2.0);
    sharper.passes = Passes::Two { finer: 0.83 };
    list.push((name + ", two passes 0.83", sharper));
    list
}
