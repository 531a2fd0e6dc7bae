//! The demonstrations of the page: requests in, replies out, without a browser.
//!
//! ```
//! use pointillist_site::Site;
//!
//! // A unit square, half a cell off a grid of 2 × 2 cells: a quarter of each.
//! let reply = Site::new().answer(b"polygon 2 2 even-odd 0.5 0.5 1.5 0.5 1.5 1.5 0.5 1.5");
//! assert!(reply.facts().contains("areas 0.25 0.25 0.25 0.25\n"));
//! ```
//!
//! A request is a line of words, and the bytes of a file after it where one belongs to it. A reply is lines of facts (a name, then numbers),
//! and the bytes of a picture. What a request asks for is in the module of its demonstration: `cover`, `surfels`, `scans`, `probes`.
//!
//! The page calls [`exports`], which hand addresses of buffers to JavaScript; everything else is safe code, and the same natively.
#![deny(unsafe_code)]

mod camera;
mod cover;
mod error;
pub mod exports;
mod model;
mod paper;
// The reader that the command line has: a package of its own for one file would be more to keep than this line.
#[path = "../../cli/src/mesh_io/ply_records.rs"]
mod ply_records;
mod probes;
mod rays;
mod reply;
mod request;
mod rooms;
mod scanner;
mod scans;
mod site;
mod surfels;

pub use error::SiteError;
pub use reply::Reply;
pub use site::Site;
