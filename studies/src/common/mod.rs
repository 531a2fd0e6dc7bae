//! What several studies share: data, scenes, references, pictures, tables.

pub(crate) mod against_samples;
pub(crate) mod casters;
pub(crate) mod charts;
pub(crate) mod closed_form;
pub(crate) mod contour;
pub(crate) mod data;
pub(crate) mod draw;
pub(crate) mod frame_error;
pub(crate) mod kept;
pub(crate) mod layers;
pub(crate) mod line_reference;
pub(crate) mod loop_subdivision;
pub(crate) mod opacities;
pub(crate) mod paths;
pub(crate) mod peers;
pub(crate) mod picture;
pub(crate) mod picture_layers;
pub(crate) mod point_sampling;
pub(crate) mod provenance;
pub(crate) mod ray_reference;
pub(crate) mod report;
pub(crate) mod rooms;
pub(crate) mod scenes;
pub(crate) mod similarity;
pub(crate) mod timing;
pub(crate) mod true_surface;
