//! Small scenes, ways to render them, and statistics of the results.

mod rendering;
mod scenes;
mod statistics;

pub(crate) use rendering::{
    PreparedScene, make_points, on_threads, picture, pictures, prepare, prepare_with_points, render,
    render_until, sample_ray, with_points,
};
pub(crate) use scenes::{GRAY, distant, matte, quad, scene, sphere, uniform_environment};
pub(crate) use statistics::{
    assert_agree, assert_within, even, flux_of, mean_of, measure, precision, samples,
};
