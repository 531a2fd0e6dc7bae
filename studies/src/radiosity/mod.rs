//! `radiosity`: time against error of form factors and of solutions. Writes `radiosity.md`.

mod boxes;
mod buildings;
mod peer;
mod probes;
mod study;

pub(crate) use study::run;
