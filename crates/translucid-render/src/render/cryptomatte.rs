//! Cryptomatte: the share of each pixel that each name covers [Friedman & Jones 2015, "Fully automatic ID mattes with
//! support for motion blur and transparency"; Psyop's specification 1.2.0].

use std::cmp::Reverse;

use rayon::prelude::*;

use super::prepared::PreparedScene;
use super::view::View;
use crate::path::PathTracer;
use crate::sampling::Sampler;

/// Samples of a pixel that count for its mattes, at most.
pub const MOST_MATTE_SAMPLES: u32 = 256;

/// MurmurHash3 (x86, 32 bits, seed 0) of a name.
pub fn matte_hash(name: &str) -> u32 {
    murmur3::murmur3_32(&mut name.as_bytes(), 0).expect("bytes in memory are read without an error")
}

/// The number that stands for a name in mattes: the bits of its hash, in which one changes where they would be no normal
/// number.
pub fn matte_id(name: &str) -> f32 {
    let id = f32::from_bits(matte_hash(name));
    if id.is_normal() { id } else { f32::from_bits(id.to_bits() ^ 1 << 23) }
}

impl PreparedScene {
    /// The ids that each pixel of a view's region shows: row by row, `levels` pairs of an id and the share of the pixel
    /// that it covers, the greatest first, (0, 0) behind the last. `None` where `is_stopped` has become true.
    ///
    /// `ids` has one for each object of the scene. What counts is the first surface that each of the first `samples`
    /// samples of the picture sees, or behind it where it is not opaque; so shares add up to the alpha of these samples,
    /// but for lights, an environment that is visible and shadow catchers, which have no id. Ids beyond `levels` are
    /// dropped. The number of threads does not matter.
    pub fn mattes(
        &self,
        view: &View,
        ids: &[f32],
        samples: u32,
        levels: usize,
        is_stopped: &(dyn Fn() -> bool + Sync),
    ) -> Option<Vec<[f32; 2]>> {
        let region = view.region();
        let mut pairs = vec![[0.0; 2]; region.area() as usize * levels];
        let row_length = (region.width as usize * levels).max(1);
        pairs.par_chunks_mut(row_length).zip(region.rows().into_par_iter()).for_each(|(row, y)| {
            let tracer = self.tracer(view.pixel_width());
            for (x, pairs) in region.columns().zip(row.chunks_mut(levels)) {
                if is_stopped() {
                    return;
                }
                let counts = ranked(first_ids(&tracer, view, [x, y], samples), ids);
                for (pair, (id, count)) in pairs.iter_mut().zip(counts) {
                    *pair = [f32::from_bits(id), count as f32 / samples as f32];
                }
            }
        });
        (!is_stopped()).then_some(pairs)
    }
}

/// Numbers of the objects that the samples of a pixel see.
fn first_ids<'a>(
    tracer: &'a PathTracer<'_>,
    view: &'a View,
    [x, y]: [u32; 2],
    samples: u32,
) -> impl Iterator<Item = u32> + 'a {
    (0..samples).filter_map(move |number| {
        let mut sampler = Sampler::new(view.seed(), x, y, number);
        let ray = view.ray(x, y, sampler.next_4d());
        tracer.first_object(ray, &mut sampler)
    })
}

/// The bits of the ids of objects, with their numbers: the greatest number first, then the least id.
fn ranked(objects: impl Iterator<Item = u32>, ids: &[f32]) -> Vec<(u32, u32)> {
    let mut counts: Vec<(u32, u32)> = Vec::new();
    for object in objects {
        let id = ids[object as usize].to_bits();
        match counts.iter_mut().find(|(known, _)| *known == id) {
            Some((_, count)) => *count += 1,
            None => counts.push((id, 1)),
        }
    }
    counts.sort_unstable_by_key(|&(id, count)| (Reverse(count), id));
    counts
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use glam::Vec3;
    use translucid_scene::{
        Camera, Film, FilterKind, Material, Mesh, Object, Projection, ScalarInput, Scene,
    };

    use super::*;
    use crate::{FilmSums, Goal, LiveFilm, layer};

    const SAMPLES: u32 = 64;

    /// A square from (left, −1) to (right, 1) at a height, of the material of a number.
    fn square(left: f32, right: f32, z: f32, material: usize) -> Object {
        let corners = [[left, -1.0], [right, -1.0], [right, 1.0], [left, 1.0]];
        let positions = corners.map(|[x, y]| Vec3::new(x, y, z)).to_vec();
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
        Object { mesh: mesh.into(), material, ..Object::default() }
    }

    /// Squares seen from above in pixels of 1/4; material 1 has an opacity of 1/4.
    fn prepared(objects: Vec<Object>) -> PreparedScene {
        let clear = Material { geometry_opacity: ScalarInput::constant(0.25), ..Material::default() };
        let camera = Camera {
            position: Vec3::Z * 5.0,
            target: Vec3::ZERO,
            up: Vec3::Y,
            projection: Projection::Orthographic { width: 4.0 },
            ..Camera::default()
        };
        let film =
            Film { width: 16, height: 12, filter: FilterKind::Box, filter_radius: 0.5, ..Film::default() };
        let materials = vec![Material::default(), clear];
        PreparedScene::new(Scene { camera, film, objects, materials, ..Scene::default() }).unwrap()
    }

    /// The pairs of all pixels, with ids 1, 2, … of the objects.
    fn mattes(prepared: &PreparedScene, levels: usize) -> Vec<[f32; 2]> {
        let ids: Vec<f32> = (1..).map(|id| id as f32).take(prepared.scene().objects.len()).collect();
        prepared.mattes(&prepared.view().unwrap(), &ids, SAMPLES, levels, &|| false).unwrap()
    }

    #[test]
    fn ids_are_those_of_other_programs() {
        // From the manifests that Cycles 5.2.3 writes
        for (name, hash) in [("ball", 0x645d_3bc4), ("mat é", 0xcd76_3f66), ("default_surface", 0x78d0_5529)]
        {
            assert_eq!(matte_hash(name), hash, "{name}");
            assert_eq!(matte_id(name).to_bits(), hash, "{name}");
        }
        for name in (0..1000).map(|i| i.to_string()) {
            let (id, hash) = (matte_id(&name), matte_hash(&name));
            assert!(id.is_normal() && (id.to_bits() == hash || id.to_bits() == hash ^ 1 << 23), "{name}");
        }
    }

    #[test]
    fn shares_add_up_to_the_alpha_of_the_picture() {
        let prepared =
            prepared(vec![square(-1.1, 0.3, 1.0, 1), square(-0.9, 1.3, 0.0, 1), square(0.9, 1.7, -1.0, 0)]);
        let view = prepared.view().unwrap();
        let film = LiveFilm::new(FilmSums::new(16, 12));
        let goal = Goal { samples: 0..SAMPLES, deadline: None };
        prepared.render(&view, &film, &goal, &|_| {}, &AtomicBool::new(false));
        let sums = film.sums();
        let mut partly = 0;
        for ((x, y), pairs) in view.region().pixels().zip(mattes(&prepared, 3).chunks(3)) {
            let alpha = sums.mean(x, y)[layer::ALPHA];
            let sum: f64 = pairs.iter().map(|pair| f64::from(pair[1])).sum();
            assert!((sum - alpha).abs() < 1e-6, "({x}, {y}): {sum} is not {alpha}");
            partly += u32::from(alpha > 0.1 && alpha < 0.9);
        }
        assert!(partly > 20, "{partly}");
    }

    #[test]
    fn edges_and_clear_surfaces_share_their_pixels() {
        // The edge is at 3/4 of the pixel from 0 to 1/4; a clear square is above both from 1/2 on.
        let objects =
            vec![square(-1.0, 0.1875, 0.0, 0), square(0.1875, 1.0, 0.0, 0), square(0.5, 1.0, 1.0, 1)];
        let pairs = mattes(&prepared(objects), 2);
        let at = |x: usize| &pairs[2 * (6 * 16 + x)..][..2];
        assert_eq!(at(3), [[0.0, 0.0]; 2]);
        assert_eq!(at(5), [[1.0, 1.0], [0.0, 0.0]]);
        // Sobol numbers are exact for such shares, but for the corners of their cells
        for (x, expected) in [(8, [[1.0, 0.75], [2.0, 0.25]]), (11, [[2.0, 0.75], [3.0, 0.25]])] {
            for (found, expected) in at(x).iter().zip(expected) {
                assert!(
                    found[0] == expected[0] && (found[1] - expected[1]).abs() <= 1.0 / 64.0,
                    "{x}: {found:?}"
                );
            }
        }
    }

    #[test]
    fn threads_and_stops_change_nothing() {
        let prepared = prepared(vec![square(-1.1, 0.3, 1.0, 1), square(-0.9, 1.3, 0.0, 0)]);
        let with = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let of = |threads| with(threads).install(|| mattes(&prepared, 2));
        assert_eq!(of(1), of(2));
        assert_eq!(prepared.mattes(&prepared.view().unwrap(), &[1.0; 2], SAMPLES, 2, &|| true), None);
    }
}
