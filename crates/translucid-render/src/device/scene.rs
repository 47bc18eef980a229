//! A prepared scene as words.

use std::collections::HashSet;

use glam::Vec3;
use sobol_burley::parts::sobol_rev;
use translucid_scene::{SceneError, SubsurfaceMethod};

use super::images;
use super::lights::lights;
use super::limits::DeviceLimits;
use super::materials::{Materials, has_varied_emission};
use super::tables::material_tables;
use super::tree::DeviceTrees;
use super::triangles::{NODE_WORDS, TRIANGLE_WORDS, Triangles};
use crate::render::{PreparedScene, View};

/// Bits of a sample's number that its numbers are stratified over.
const SAMPLE_BITS: u32 = 16;
/// Greatest whole number up to which floating-point numbers hold all of them.
const MOST_NUMBERS: u64 = 1 << 24;

/// Places in [`DeviceScene::tables`], and numbers that all paths need: the first words of the tables, in this order.
#[derive(Clone, Copy, Debug)]
#[repr(usize)]
pub enum Header {
    /// Where materials begin.
    Materials,
    /// Where textures begin.
    Textures,
    /// Where tables of media begin.
    Media,
    /// Where lights begin.
    Lights,
    /// Where the inverse distribution of the pixel filter begins.
    Filter,
    /// Where the directions of Sobol's sequence begin: bits of four dimensions in halves, the lower first.
    Sobol,
    /// Where the places of images begin among the images.
    Images,
    /// Largest number of scattering events, and of diffuse ones.
    MaxDepth,
    /// Largest number of diffuse events.
    MaxDiffuseDepth,
    /// Whether caustics are looked for.
    Caustics,
    /// Words of a triangle's attributes.
    AttributeWords,
    /// Where texture coordinates begin among them; 0 if there are none.
    Uv,
    /// Where the tangent begins; 0 if there is none.
    Tangent,
    /// Where colors begin; 0 if there are none.
    Color,
    /// Middle of the scene's bounds \[L\], three words.
    Middle,
    /// Square of the distance from there beyond which walks are lost \[L²\].
    Farthest = Self::Middle as usize + 3,
    /// Whether shadow rays have to look at what they meet.
    ShadowsLook,
    /// Diagonal of the scene's bounds \[L\].
    Diagonal,
    /// Number of instances.
    Instances,
    /// Tangents of a triangle.
    Tangents,
    /// Where the points of shapes that profiles are normalized by begin; 0 if there are none.
    Shapes,
    /// Number of words of the header.
    Count,
}

/// Diagonals of the scene beyond which a walk has left an open mesh for good, as on the processor.
const FARTHEST: f32 = 2.0;

/// A prepared scene as arrays of words, each no larger than the device's limit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeviceScene {
    /// Instances, then nodes of a binary tree: lowest corner, number of triangles (0: an inner node, 2³² − 1: an instance), highest
    /// corner, first child or triangle, or the instance; then the trees of meshes that instances share.
    pub nodes: Vec<u32>,
    /// Corners, and behind them material, number as a light, subsurface group; those of shared meshes come last, in the mesh's
    /// own space.
    pub triangles: Vec<u32>,
    /// Normals, then texture coordinates, tangent and colors where the scene needs them.
    pub attributes: Vec<f32>,
    /// The [`Header`], materials, media, lights, reflectances.
    pub tables: Vec<f32>,
    /// Texels, and the environment's.
    pub images: Vec<u32>,
}

impl DeviceScene {
    /// The words of a scene, with the filter of a view.
    ///
    /// # Errors
    /// The scene needs something that devices lack, or is too large for this one; the message names it.
    pub fn new(prepared: &PreparedScene, view: &View, limits: &DeviceLimits) -> Result<Self, SceneError> {
        Self::edited(prepared, view, limits, &mut DeviceTrees::default())
    }

    /// The words of a scene that has been edited, with the trees that it had before.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn edited(
        prepared: &PreparedScene,
        view: &View,
        limits: &DeviceLimits,
        trees: &mut DeviceTrees,
    ) -> Result<Self, SceneError> {
        let scene = prepared.scene();
        let (world, transports) = prepared.parts();
        if scene.integrator.subsurface_method != SubsurfaceMethod::RayTraced {
            return Err(SceneError::new(
                "integrator.subsurface_method is not \"ray-traced\", which devices lack",
            ));
        }
        let mut lights = lights(prepared)?;
        let geometry = &world.geometry;
        let light_of = |object, triangle| lights.triangle(geometry.primitive(object, triangle));
        let emits = |object| lights.are_in(geometry.primitive(object, 0)..geometry.primitive(object + 1, 0));
        let has_layers =
            |index: usize| transports.of(index).medium().is_some_and(|medium| medium.has_shells());
        let layered = scene.objects.iter().filter(|object| has_layers(object.material));
        let groups: HashSet<u32> = layered.map(|object| object.subsurface_group).collect();
        let stays =
            |object| emits(object) || groups.contains(&scene.objects[object as usize].subsurface_group);
        let triangles = Triangles::new(scene, limits, stays, light_of, trees)?;
        for (place, material, light) in triangles.lights() {
            if has_varied_emission(&scene.materials[material]) {
                lights.look_up(light, place);
            }
        }

        let mut tables = vec![0.0; Header::Count as usize];
        let mut reflectances: Vec<([f32; 2], usize)> = Vec::new();
        let mut materials = Materials::new(scene);
        for (index, material) in scene.materials.iter().enumerate() {
            let iors = [material.specular_ior, material.coat_ior];
            let known = reflectances.iter().find(|(known, _)| *known == iors);
            let at = known.map_or(tables.len(), |&(_, at)| at);
            if at == tables.len() {
                reflectances.push((iors, at));
                tables.extend(material_tables(world.surfaces.of(index)));
            }
            materials.push(prepared, index, at)?;
        }
        let mut append = |words: &[f32]| {
            let at = tables.len();
            tables.extend(words);
            at as f32
        };
        let sobol = (0..SAMPLE_BITS).flat_map(|bit| {
            (0..4).flat_map(move |dimension| {
                let direction = sobol_rev(1 << (31 - bit), dimension);
                [direction & 0xffff, direction >> 16].map(|half| half as f32)
            })
        });
        let integrator = &scene.integrator;
        let shapes = transports.normalizer().map(|normalizer| normalizer.gatherer().words());
        let (low, high) = world.geometry.bounds();
        let (middle, diagonal) = (0.5 * (low + high), high - low);
        let mut images = lights.images;
        let layout = triangles.layout;
        let header = [
            (Header::Materials, append(&materials.words)),
            (Header::Textures, append(&materials.textures)),
            (Header::Media, append(&materials.medium_tables)),
            (Header::Lights, append(&lights.tables)),
            (Header::Filter, append(view.filter())),
            (Header::Sobol, append(&sobol.collect::<Vec<f32>>())),
            (Header::Images, images::append(scene.images.iter().map(AsRef::as_ref), &mut images)? as f32),
            (Header::MaxDepth, integrator.max_depth as f32),
            (Header::MaxDiffuseDepth, integrator.max_diffuse_depth as f32),
            (Header::Caustics, if integrator.caustics { 1.0 } else { 0.0 }),
            (Header::AttributeWords, layout.stride as f32),
            (Header::Uv, layout.uv as f32),
            (Header::Tangent, layout.tangent as f32),
            (Header::Color, layout.color as f32),
            (Header::Farthest, (diagonal * FARTHEST).length_squared()),
            (Header::ShadowsLook, if prepared.shadows_look() { 1.0 } else { 0.0 }),
            (Header::Diagonal, diagonal.length()),
            (Header::Instances, triangles.instances as f32),
            (Header::Tangents, layout.tangents as f32),
            (Header::Shapes, shapes.map_or(0.0, |words| append(&words))),
        ];
        for (place, value) in header {
            tables[place as usize] = value;
        }
        tables[Header::Middle as usize..][..3].copy_from_slice(&Vec3::to_array(&middle));
        limits.check("bytes of textures and environment", 4 * images.len() as u64, 1)?;
        limits.check("bytes of tables", 4 * tables.len() as u64, 1)?;
        let stored = triangles.triangles.len() / TRIANGLE_WORDS as usize;
        let numbers = tables.len().max(stored).max(triangles.instances) as u64;
        DeviceLimits { array_bytes: MOST_NUMBERS }.check("places", numbers, 1)?;
        debug_assert_eq!(triangles.nodes.len() as u64 % NODE_WORDS, 0);
        Ok(Self {
            nodes: triangles.nodes,
            triangles: triangles.triangles,
            attributes: triangles.attributes,
            tables,
            images,
        })
    }
}
