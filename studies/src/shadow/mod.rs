//! `shadow`: run time against error of shadows, beside a shadow map.

mod shadow_map;
mod study;

pub(crate) use study::run;
