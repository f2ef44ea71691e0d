//! Where the path is and where to head: the path's forms, the cursor on it, and the guidance laws.

mod bends;
mod cursor;
mod law;
mod local;
mod path;
mod preview;
mod store;
mod track;

pub use bends::Bends;
pub use cursor::{Cursor, Fix, LOOK};
pub use law::{guide, pace};
pub use path::{MAX_PIECES, Path, PathError, Segment, Waypoint};
pub use store::{StoreError, StoredPath};
pub use track::{Mark, Track};
