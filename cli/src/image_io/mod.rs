//! Pictures in and out: EXR with layers, PNG, and what is read for comparison.

mod frame;

pub use frame::{Frame, Layer, LayerKind, Window};
