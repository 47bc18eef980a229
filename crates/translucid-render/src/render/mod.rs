//! Scenes made ready, views of them, and the loop that renders them into films.

mod checkpoint;
mod film;
mod fingerprint;
mod live_film;
mod passes;
mod picker;
mod picture;
mod pixel_blocks;
mod pixel_widths;
mod prepared;
mod view;

pub use checkpoint::{CheckpointInfo, is_checkpoint, load_checkpoint, save_checkpoint};
pub use film::{FilmSums, TILE_SIZE, TileSums};
pub use live_film::{FilmLayer, LiveFilm};
pub use passes::{Goal, Outcome, Progress};
pub use picker::{Picked, Picker};
pub use picture::ImageInfo;
pub use prepared::{Edit, PreparedScene, Renewed};
pub use view::{Fraction, View};
