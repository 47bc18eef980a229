//! Scenes made ready, views of them, and the loop that renders them into films.

mod cryptomatte;
mod device_passes;
mod enclosed;
mod exact_sums;
mod film;
mod fingerprint;
mod live_film;
mod passes;
mod picker;
mod picture;
mod pixel_blocks;
mod pixel_widths;
mod prepared;
mod sample_ranges;
mod shard;
mod shard_merge;
mod tile_grid;
mod traced_block;
mod view;

pub use cryptomatte::{MOST_MATTE_SAMPLES, matte_hash, matte_id};
pub(crate) use device_passes::render_on;
pub use device_passes::{AT_ONCE, PathTracing, add_samples};
pub use film::{FilmSums, TileSums};
pub use fingerprint::{Fingerprint, content_hash};
pub use live_film::{FilmLayer, LiveFilm};
pub use passes::{Goal, Outcome, SampleProgress};
pub use picker::{Picked, Picker};
pub use picture::ImageInfo;
pub use prepared::{Edit, PreparedScene, Renewed};
pub use sample_ranges::SampleRanges;
pub use shard::{ShardHeader, ShardNotes, ShardReader, ShardRun, is_shard, save_shard};
pub use shard_merge::{Gap, ShardMerge};
pub use tile_grid::TILE_SIZE;
pub use traced_block::TracedBlock;
pub(crate) use view::FILTER_TABLE;
pub use view::{Fraction, View};
