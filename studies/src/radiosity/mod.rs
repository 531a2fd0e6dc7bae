//! `radiosity`: time against error of form factors and of solutions. Writes `radiosity.md`.

mod boxes;
mod peer;
mod probes;
mod study;

pub(crate) use study::run;
