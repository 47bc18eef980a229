//! The way of one photon, from wall to wall and from collision to collision.

use std::f64::consts::TAU;

use translucid_profile::fresnel_from_inside;

use crate::ray::{Ray, Vector, across, dot};
use crate::split_mix::SplitMix;

/// Place in which photons walk: convex regions of one medium each, with walls around them.
pub(crate) trait Space {
    /// Collisions per length in a region.
    fn extinction(&self, _region: usize) -> f64 {
        1.0
    }

    /// Probability of surviving a collision.
    fn single_scattering_albedo(&self, region: usize) -> f64;

    /// Draws the direction after a collision from that before it.
    fn scatter(&self, region: usize, direction: Vector, random: &mut SplitMix) -> Vector;

    /// The wall that a ray inside a region meets; `None` where it meets none.
    fn wall(&self, region: usize, ray: &Ray) -> Option<Wall>;
}

/// Place where a flight leads out of a region.
pub(crate) struct Wall {
    /// Length of the flight, at least 0.
    pub(crate) distance: f64,
    /// Unit normal that points inside.
    pub(crate) inward: Vector,
    /// Index of refraction inside over that beyond.
    pub(crate) eta: f64,
    /// Place that light gets to.
    pub(crate) beyond: Beyond,
}

/// Place that light gets to through a wall.
#[derive(Clone, Copy)]
pub(crate) enum Beyond {
    /// Another region.
    Region(usize),
    /// The outside, through a part of the surface.
    Outside(usize),
    /// A Lambertian ground of this reflectance.
    #[cfg_attr(not(test), expect(dead_code, reason = "layers alone have a ground"))]
    Ground(f64),
}

/// End of a photon's walk.
#[cfg_attr(not(test), expect(dead_code, reason = "tests of other walks read all of it"))]
pub(crate) struct PhotonEnd {
    pub(crate) fate: Fate,
    /// Place, and direction inside the last region.
    pub(crate) ray: Ray,
    /// Collisions, the one that absorbed it included.
    pub(crate) collisions: u64,
}

/// The way in which a photon's walk ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fate {
    /// Out through a part of the surface.
    Left(usize),
    /// Absorbed in a region.
    Absorbed(usize),
    /// Absorbed by the ground.
    Ground,
}

/// Follows a photon until it is out or absorbed.
pub(crate) fn follow(
    space: &impl Space,
    mut region: usize,
    mut ray: Ray,
    random: &mut SplitMix,
) -> PhotonEnd {
    let mut collisions = 0;
    loop {
        let mut depth = -libm::log(random.uniform());
        while let Some(wall) = space.wall(region, &ray)
            && wall.distance * space.extinction(region) < depth
        {
            ray.advance(wall.distance);
            depth -= wall.distance * space.extinction(region);
            match (reflects(&wall, &ray, random), wall.beyond) {
                (true, _) => ray.direction = mirrored(&wall, &ray),
                (_, Beyond::Region(next)) => {
                    ray.direction = refracted(&wall, &ray);
                    region = next;
                }
                (_, Beyond::Outside(part)) => return PhotonEnd { fate: Fate::Left(part), ray, collisions },
                (_, Beyond::Ground(reflectance)) => {
                    if random.uniform() >= reflectance {
                        return PhotonEnd { fate: Fate::Ground, ray, collisions };
                    }
                    ray.direction = across(wall.inward, random.uniform().sqrt(), TAU * random.uniform());
                }
            }
        }
        ray.advance(depth / space.extinction(region));
        collisions += 1;
        if random.uniform() >= space.single_scattering_albedo(region) {
            return PhotonEnd { fate: Fate::Absorbed(region), ray, collisions };
        }
        ray.direction = space.scatter(region, ray.direction, random);
    }
}

/// Cosine of a ray to the normal that points out.
fn cosine(wall: &Wall, ray: &Ray) -> f64 {
    -dot(wall.inward, ray.direction)
}

/// Draws whether a wall reflects; between regions of one index there is nothing to draw.
fn reflects(wall: &Wall, ray: &Ray, random: &mut SplitMix) -> bool {
    let is_drawn = wall.eta != 1.0 || matches!(wall.beyond, Beyond::Outside(_));
    is_drawn && random.uniform() < fresnel_from_inside(cosine(wall, ray).clamp(0.0, 1.0), wall.eta)
}

fn mirrored(wall: &Wall, ray: &Ray) -> Vector {
    let cosine = cosine(wall, ray);
    std::array::from_fn(|i| ray.direction[i] + 2.0 * cosine * wall.inward[i])
}

/// Direction beyond a wall, by Snell's law.
fn refracted(wall: &Wall, ray: &Ray) -> Vector {
    if wall.eta == 1.0 {
        return ray.direction;
    }
    let inside = cosine(wall, ray);
    let beyond = (1.0 - wall.eta * wall.eta * (1.0 - inside * inside)).max(0.0).sqrt();
    std::array::from_fn(|i| wall.eta * ray.direction[i] + (wall.eta * inside - beyond) * wall.inward[i])
}
