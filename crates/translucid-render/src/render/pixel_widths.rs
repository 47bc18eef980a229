//! Widths of pixels on the surfaces that a view shows.

use super::view::{Fraction, View};
use crate::ray::Ray;
use crate::subsurface::transport::points::PixelWidths;
use crate::world::World;

/// Rays along each edge of the film.
const RAYS: u32 = 64;
/// Most surfaces that are looked at behind each other.
const MOST_SURFACES: usize = 32;

/// Widths of the film's pixels on every subsurface group that a grid of straight rays meets, first or behind others: glass
/// may be in front.
///
/// Neither the region nor the fraction of the resolution counts, so that all parts of a picture have the same points.
pub(super) fn pixel_widths(world: &World, view: &View) -> PixelWidths {
    let [width, height] = [view.film().width, view.film().height].map(|edge| edge as f32 / RAYS as f32);
    let pixel_width = view.at(Fraction::Whole).pixel_width();
    let mut seen = Vec::new();
    for place in 0..RAYS * RAYS {
        let [x, y] = [place % RAYS, place / RAYS].map(|i| i as f32 + 0.5);
        let mut ray = view.ray_through([x * width, y * height]);
        let eye = ray.origin;
        for _ in 0..MOST_SURFACES {
            let Some(hit) = world.geometry.closest(&ray) else { break };
            let point = world.surface_point(&hit);
            seen.push((point.group, f64::from(pixel_width.at(point.position.distance(eye)))));
            ray = Ray::new(point.ray_origin(ray.direction), ray.direction);
        }
    }
    PixelWidths::new(seen)
}
