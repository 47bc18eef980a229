//! glTF 2.0 (.gltf and .glb): meshes with their hierarchy and materials, lights and cameras.
//!
//! Everything is read from raw JSON and bytes with every index, range and count checked, so that no
//! input can make it panic or allocate more than the file's own size justifies.
//!
//! **Read**: external, embedded and GLB buffers, compressed by KHR_draco_mesh_compression, EXT_meshopt_compression,
//! KHR_meshopt_compression or not; all index types, strides, normalized and sparse accessors; lists, strips and fans;
//! KHR_mesh_quantization; EXT_mesh_gpu_instancing; node matrices and TRS; skins and morph targets in the pose that the file
//! has; KHR_node_visibility; the materials of [`materials`]; KHR_texture_transform; KHR_lights_punctual; cameras.
//!
//! **Left out, with a warning**: points, lines, animations, second texture coordinates.
//! **Refused**: extensions that a file requires and that are not read.

mod accessor;
mod buffers;
mod container;
mod document;
mod draco;
mod extensions;
mod geometry;
mod lights;
mod materials;
mod media;
mod meshopt;
mod nodes;
mod notes;
mod pose;
mod textures;
mod uri;

use std::collections::{HashMap, HashSet};
use std::path::Path;

use glam::{Affine3A, DAffine3, DVec3};
use translucid_scene::{Mesh, Object, Place, Scene, SceneError, Unit, Warning, repair_mesh};

use self::buffers::Arrays;
use self::document::{Document, Node, Primitive};
use self::extensions::{Support, support};
use self::geometry::MOST;
use self::materials::MaterialShelf;
use self::nodes::PlacedNode;
use self::notes::Notes;
use self::pose::Joints;
use super::MeshFile;
use super::mesh_file::NamedCamera;
use super::shared_mesh::SharedMesh;
use crate::loading::Loading;
use crate::origin::Anchor;
use crate::result::Result;
use crate::winding::{orient, orient_together, warn_of_turned};

/// Reads a glTF file, textures and buffers beside it included, into world space.
///
/// glTF's lengths are meters; `unit` is the scene's.
/// `warnings` say what was repaired or left out.
///
/// # Errors
/// The file cannot be read, is not glTF 2.0, contradicts itself, needs an extension that is not read, or has no
/// usable triangle; the message names the element at fault.
pub fn load_gltf(path: &Path, unit: Unit, warnings: &mut Vec<Warning>) -> Result<MeshFile> {
    read_gltf(path, unit, &mut Loading::unwatched(warnings))
}

/// As [`load_gltf`], as a part of a load.
pub(crate) fn read_gltf(path: &Path, unit: Unit, loading: &mut Loading<'_>) -> Result<MeshFile> {
    parse(&loading.read(path)?, path, unit, loading)
}

/// Reads glTF from memory; `path` is for messages and for the buffers and images beside it.
///
/// # Errors
/// As [`load_gltf`].
pub fn parse_gltf(bytes: &[u8], path: &Path, unit: Unit, warnings: &mut Vec<Warning>) -> Result<MeshFile> {
    parse(bytes, path, unit, &mut Loading::unwatched(warnings))
}

fn parse(bytes: &[u8], path: &Path, unit: Unit, loading: &mut Loading<'_>) -> Result<MeshFile> {
    let notes = Notes::new(path);
    let result = read(bytes, unit, &notes, loading);
    loading.add_files(notes.take_files());
    loading.warnings.extend(notes.into_warnings());
    result
}

fn read(bytes: &[u8], unit: Unit, notes: &Notes<'_>, loading: &mut Loading<'_>) -> Result<MeshFile> {
    let container = container::split(bytes, notes.path)?;
    let document = Document::parse(container.json, notes.path)?;
    check_extensions(&document, notes)?;
    let mut arrays = Arrays::load(&document, container.binary, notes)?;
    arrays.unpack()?;
    let units = 1000.0 / unit.in_millimeters();
    let mut placed = nodes::flatten(&document, notes, DAffine3::from_scale(DVec3::splat(units)))?;
    let origin = anchor(&placed, &arrays);
    placed.iter_mut().for_each(|node| node.world_from_local.translation -= origin);
    let uses = uses_of_primitives(&uses_of_meshes(&placed, &arrays), &arrays);
    let joints = pose::joints(&placed, &arrays);
    placed.retain(|node| node.is_in_scene);
    if document.animations > 0 {
        notes.warn("animations", "they are left out: the pose is that of the nodes and their weights");
    }
    let mut assembly = Assembly {
        arrays: &arrays,
        units,
        materials: MaterialShelf::default(),
        budget: MOST,
        uses,
        shared: HashMap::new(),
        joints,
        skins: HashMap::new(),
        warnings: loading.warnings,
        unusable: None,
        hidden: 0,
        next_group: 0,
        turned: 0,
        scene: MeshFile { origin, ..MeshFile::default() },
    };
    for (done, node) in placed.iter().enumerate() {
        loading.watch.tell(done, placed.len())?;
        assembly.add_node(node)?;
    }
    assembly.finish()
}

/// Refuses a file that requires an extension that is not read.
fn check_extensions(document: &Document, notes: &Notes<'_>) -> Result<()> {
    document.extensions_required.iter().try_for_each(|name| match support(name) {
        Support::NotRead(help) => {
            let message = format!("the file needs {}, which is not read", uri::clip(name));
            Err(notes.error("extensionsRequired", message).with_help(help))
        }
        _ => Ok(()),
    })
}

/// How often each mesh is used; what cannot be counted is refused when it is read.
fn uses_of_meshes(placed: &[PlacedNode], arrays: &Arrays<'_>) -> HashMap<usize, usize> {
    let mut uses = HashMap::new();
    for placed in placed.iter().filter(|placed| placed.is_visible) {
        let part = arrays.document.nodes.label(placed.index);
        let Ok(node) = arrays.document.nodes.get(placed.index, &part) else { continue };
        if let Some(mesh) = node.mesh {
            let count: &mut usize = uses.entry(mesh).or_insert(0);
            *count = count.saturating_add(nodes::instance_count(node, &part, arrays));
        }
    }
    uses
}

/// A point near the first position of the first mesh.
fn anchor(placed: &[PlacedNode], arrays: &Arrays<'_>) -> DVec3 {
    let Arrays { document, .. } = arrays;
    let first = placed.iter().filter(|placed| placed.is_visible).find_map(|of_mesh| {
        let node = document.nodes.get(of_mesh.index, "").ok()?;
        if let Some(skin) = node.skin.filter(|_| node.mesh.is_some()) {
            let joint = *document.skins.get(skin, "").ok()?.joints.first()?;
            return Some(placed.iter().find(|other| other.index == joint)?.world_from_local.translation);
        }
        let mesh = document.meshes.get(node.mesh?, "").ok()?;
        let accessor = *mesh.primitives.first()?.attributes.get("POSITION")?;
        // What is wrong with it is told of when the mesh is read
        let position = *arrays.numbers::<3>(accessor, "").ok()?.first()?;
        let world_from_local = *nodes::instances(node, of_mesh, "", arrays).ok()?.first()?;
        Some(world_from_local.transform_point3(DVec3::from_array(position.map(f64::from))))
    });
    first.map_or(DVec3::ZERO, |first| Anchor::at(first).position())
}

/// All that the triangles of a primitive depend on; one with morph targets, whose weights are the mesh's, is like no other.
type Signature<'a> = (&'a document::Attributes, Option<usize>, Option<u32>, Option<usize>);

fn signature(primitive: &Primitive) -> Signature<'_> {
    let own = (!primitive.targets.is_empty()).then(|| std::ptr::from_ref(primitive).addr());
    (&primitive.attributes, primitive.indices, primitive.mode, own)
}

/// A primitive of a mesh where a node has it.
struct MeshUse<'a, 'u> {
    mesh: &'a document::Mesh,
    primitive: &'a Primitive,
    node: &'u Node,
    world_from_local: Affine3A,
    name: &'u str,
}

impl MeshUse<'_, '_> {
    /// Whether the node has a pose of its own, by which the mesh becomes another one.
    fn is_posed(&self) -> bool {
        self.node.skin.is_some() || self.node.weights.is_some()
    }
}

/// For each primitive whether an earlier one of the mesh is the same triangles again.
fn repeated_primitives(primitives: &[Primitive]) -> Vec<bool> {
    let mut known = HashSet::new();
    primitives
        .iter()
        .map(|Primitive { attributes, indices, material, mode, targets, .. }| {
            !known.insert((attributes, indices, material, mode, targets))
        })
        .collect()
}

/// How often each primitive is used, in whatever mesh, by the uses of meshes.
fn uses_of_primitives<'a>(
    uses: &HashMap<usize, usize>,
    arrays: &Arrays<'a>,
) -> HashMap<Signature<'a>, usize> {
    let mut sums: HashMap<Signature<'a>, usize> = HashMap::new();
    for (&mesh, &uses) in uses {
        // What cannot be found is refused when it is read
        let Ok(mesh) = arrays.document.meshes.get(mesh, "") else { continue };
        for signature in mesh.primitives.iter().map(signature).collect::<HashSet<_>>() {
            let sum = sums.entry(signature).or_insert(0);
            *sum = sum.saturating_add(uses);
        }
    }
    sums
}

/// A scene on its way.
struct Assembly<'a> {
    arrays: &'a Arrays<'a>,
    /// Scene units to the meter.
    units: f64,
    materials: MaterialShelf,
    /// Vertices and triangles that the file may still have.
    budget: usize,
    /// How often each primitive is used.
    uses: HashMap<Signature<'a>, usize>,
    /// Primitives that their uses share, by the texture coordinates of their materials.
    shared: HashMap<(Signature<'a>, Option<usize>), SharedMesh>,
    joints: Joints,
    /// Maps of the joints of the skins that are used.
    skins: HashMap<usize, Vec<DAffine3>>,
    warnings: &'a mut Vec<Warning>,
    /// Why a mesh could not be used, for the message if none can.
    unusable: Option<SceneError>,
    /// Number of meshes that are not visible.
    hidden: usize,
    next_group: u32,
    /// Triangles that wound the other way than the rest of their body.
    turned: usize,
    scene: MeshFile,
}

impl<'a> Assembly<'a> {
    fn add_node(&mut self, placed: &PlacedNode) -> Result<()> {
        let (document, notes) = (self.arrays.document, self.arrays.notes);
        let part = document.nodes.label(placed.index);
        let node = document.nodes.get(placed.index, &part)?;
        if let Some(camera) = node.camera {
            self.add_camera(camera, placed, &part)?;
        }
        if !placed.is_visible {
            self.hidden += usize::from(node.mesh.is_some());
            return Ok(());
        }
        if let Some(mesh) = node.mesh {
            self.add_mesh(mesh, node, placed, &part)?;
        }
        let light = lights::light(node, &placed.world_from_local, self.units, &part, document, notes)?;
        self.scene.lights.extend(light);
        Ok(())
    }

    fn add_mesh(&mut self, index: usize, node: &Node, placed: &PlacedNode, part: &str) -> Result<()> {
        let (document, notes) = (self.arrays.document, self.arrays.notes);
        let mesh = document.meshes.get(index, part)?;
        let label = document.meshes.label(index);
        if mesh.primitives.is_empty() {
            notes.warn(&label, "a mesh without primitives is left out");
        }
        let name = node.name.as_ref().or(mesh.name.as_ref()).unwrap_or(&label);
        if let Some(skin) = node.skin
            && !self.skins.contains_key(&skin)
        {
            self.skins.insert(skin, self.arrays.joint_maps(skin, &self.joints, part)?);
        }
        let repeated = repeated_primitives(&mesh.primitives);
        if repeated.contains(&true) {
            notes.warn(&label, "primitives that repeat another one are left out");
        }
        for world_from_local in self.places(node, placed, part)? {
            let first = self.scene.objects.len();
            for (number, primitive) in
                mesh.primitives.iter().enumerate().filter(|&(number, _)| !repeated[number])
            {
                let place = format!("{label} primitive {number} of {part}");
                let world_from_local = world_from_local.as_affine3a();
                let of_mesh = MeshUse { mesh, primitive, node, world_from_local, name };
                let material = self.materials.get(primitive.material, &place, self.units, self.arrays)?;
                let shared = self.shared.get(&(signature(primitive), material.uv_set));
                let shared = shared.filter(|_| !of_mesh.is_posed());
                match shared.and_then(|mesh| mesh.placed(&world_from_local)) {
                    Some(object) => {
                        self.push(Object { name: name.clone(), material: material.index, ..object }, &place)?;
                    }
                    None => self.add_primitive(&of_mesh, &place)?,
                }
            }
            if self.scene.objects[first..].iter().all(|object| !object.is_placed()) {
                self.turned += orient_together(&mut self.scene.objects[first..]);
            }
            self.next_group = self.next_group.saturating_add(1);
        }
        Ok(())
    }

    /// Where a node has its mesh. A skin's joints are in one place.
    fn places(&self, node: &Node, placed: &PlacedNode, part: &str) -> Result<Vec<DAffine3>> {
        let places = nodes::instances(node, placed, part, self.arrays)?;
        if node.skin.is_some() && places.len() != 1 {
            self.arrays
                .notes
                .warn(part, "instances of a mesh with a skin are left out: it is in its pose once");
            return Ok(vec![placed.world_from_local]);
        }
        Ok(places)
    }

    fn add_primitive(&mut self, of: &MeshUse<'a, '_>, part: &str) -> Result<()> {
        let primitive = of.primitive;
        let material = self.materials.get(primitive.material, part, self.units, self.arrays)?;
        let set = material.uv_set.unwrap_or(0);
        let Some(mut mesh) = self.arrays.primitive_mesh(primitive, part, set, &mut self.budget)? else {
            return Ok(());
        };
        if material.uv_set.is_some() && mesh.uvs.is_empty() {
            self.arrays.notes.warn(part, format!("its material has textures, but it has no TEXCOORD_{set}"));
        }
        let weights = of.node.weights.as_ref().unwrap_or(&of.mesh.weights);
        self.arrays.add_targets(primitive, weights, part, &mut mesh)?;
        if self.add_shared(of, &mut mesh, (material.index, material.uv_set), part)? {
            return Ok(());
        }
        let maps = match of.node.skin.and_then(|skin| self.skins.get(&skin)) {
            Some(joints) => self.arrays.vertex_maps(primitive, joints, mesh.positions.len(), part)?,
            None => None,
        };
        match maps {
            Some(maps) => mesh.transform_vertices(&maps),
            None => mesh.transform(&of.world_from_local),
        }
        if let Err(error) = repair_mesh(&mut mesh, &Place::part(self.arrays.notes.path, part), self.warnings)
        {
            self.arrays.notes.warn(part, format!("left out: {}", error.message));
            self.unusable.get_or_insert(error);
            return Ok(());
        }
        let (name, mesh, material) = (of.name.to_owned(), mesh.into(), material.index);
        self.push(Object { name, mesh, material, ..Object::default() }, part)
    }

    /// Adds an object that shares its mesh with others to come, if it is worth it.
    fn add_shared(
        &mut self,
        of: &MeshUse<'a, '_>,
        mesh: &mut Mesh,
        (material, uv_set): (usize, Option<usize>),
        part: &str,
    ) -> Result<bool> {
        let key = (signature(of.primitive), uv_set);
        let uses = self.uses.get(&key.0).copied().unwrap_or(1);
        if of.is_posed() || !mesh.is_worth_sharing(uses) || self.shared.contains_key(&key) {
            return Ok(false);
        }
        let (place, mut of_mesh) = (Place::part(self.arrays.notes.path, part), Vec::new());
        self.turned += orient(mesh);
        // One that cannot be repaired is told of when it is baked
        let Ok(shared) = SharedMesh::new(mesh.clone().into(), uses, &place, &mut of_mesh) else {
            return Ok(false);
        };
        let object = shared.placed(&of.world_from_local);
        self.shared.insert(key, shared);
        let Some(object) = object else { return Ok(false) };
        self.warnings.append(&mut of_mesh);
        self.push(Object { name: of.name.to_owned(), material, ..object }, part)?;
        Ok(true)
    }

    /// Adds an object of the mesh at hand.
    fn push(&mut self, object: Object, part: &str) -> Result<()> {
        if self.scene.objects.len() >= Scene::MOST_OBJECTS {
            let most = Scene::MOST_OBJECTS;
            let message = format!("the file has more than {most} objects up to here");
            return Err(self.arrays.notes.error(part, message));
        }
        self.scene.objects.push(Object { subsurface_group: self.next_group, ..object });
        Ok(())
    }

    fn add_camera(&mut self, index: usize, placed: &PlacedNode, part: &str) -> Result<()> {
        let (document, notes) = (self.arrays.document, self.arrays.notes);
        let data = document.cameras.get(index, part)?;
        let label = document.cameras.label(index);
        let Some((camera, of_square)) =
            lights::camera(data, &placed.world_from_local, self.units, &label, notes)?
        else {
            return Ok(());
        };
        let of_node = document.nodes.get(placed.index, part)?.name.clone();
        let name = of_node.or_else(|| data.name.clone()).unwrap_or(label);
        self.scene.cameras.push(NamedCamera { name, camera, of_square: Some(of_square) });
        Ok(())
    }

    fn finish(self) -> Result<MeshFile> {
        self.materials.report(self.arrays);
        warn_of_turned(self.turned, &Place::file(self.arrays.notes.path), self.warnings);
        if self.scene.objects.is_empty() {
            let none = || {
                let place = Place::file(self.arrays.notes.path);
                let error = SceneError::at(place, "the file's scene has no triangles");
                match self.hidden {
                    0 => error,
                    count => error.with_help(format!("KHR_node_visibility hides {count} of its meshes")),
                }
            };
            return Err(self.unusable.unwrap_or_else(none));
        }
        let MaterialShelf { mut materials, images, .. } = self.materials;
        if self.arrays.document.materials.as_slice().is_empty() {
            materials.clear();
        }
        self.warnings.extend(images.warnings);
        Ok(MeshFile { materials, images: images.images, ..self.scene })
    }
}
