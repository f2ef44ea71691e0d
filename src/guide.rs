//! Where the path is and where to head: the path's forms, the cursor on it, and the guidance laws.

mod cursor;
mod law;
mod path;

pub use cursor::{Cursor, Fix, LOOK};
pub use law::guide;
pub use path::{MAX_PIECES, Path, PathError, Segment, Waypoint};
