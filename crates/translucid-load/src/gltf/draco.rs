//! Primitives compressed by KHR_draco_mesh_compression (Khronos, 2018), whose streams draco-core decodes.
//!
//! The accessors of such a primitive state types and counts and have no bufferView: a stream that is not as they state is
//! refused, so that nothing is read from it that the document does not expect.
//! A primitive that has a bufferView for each of them, as a fallback, is read from those, which lost nothing.

use std::collections::BTreeMap;

use draco_core::{DataType, DecodeLimits, DecoderBuffer, ErrorKind, Mesh, MeshDecoder, PointIndex};
use translucid_scene::SceneError;

use super::accessor::{component, components};
use super::buffers::{Arrays, Unpacked};
use super::document::{Accessor, Primitive};
use super::extensions::Members;
use crate::number::NumberType;
use crate::result::Result;

const NAME: &str = "KHR_draco_mesh_compression";

/// An accessor whose contents lie in a stream.
struct Wanted<'a> {
    accessor: usize,
    stated: &'a Accessor,
    /// Number of the attribute in the stream; none for the triangles.
    attribute: Option<u32>,
    /// Name in messages.
    part: String,
}

impl<'a> Arrays<'a> {
    /// Decodes the primitives that are compressed.
    ///
    /// # Errors
    /// A stream is damaged, or not as the accessors of its primitive state.
    pub(super) fn unpack(&mut self) -> Result<()> {
        let meshes = &self.document.meshes;
        for (mesh, primitives) in meshes.as_slice().iter().map(|mesh| &mesh.primitives).enumerate() {
            for (number, primitive) in primitives.iter().enumerate() {
                if primitive.extensions.contains_key(NAME) {
                    self.unpack_primitive(primitive, &format!("{} primitive {number}", meshes.label(mesh)))?;
                }
            }
        }
        Ok(())
    }

    fn unpack_primitive(&mut self, primitive: &Primitive, part: &str) -> Result<()> {
        let Some(data) = Members::of(&primitive.extensions, NAME, part, self.notes.path)? else {
            return Ok(());
        };
        let (view, wanted) = (data.require("bufferView")?, self.wanted(&data, primitive, part)?);
        let source = |wanted: &Wanted| self.unpacked.get(&wanted.accessor).map(|known| known.source);
        if wanted.iter().all(|wanted| source(wanted) == Some((view, wanted.attribute))) {
            return Ok(());
        }
        if primitive.mode.unwrap_or(4) != 4 {
            return Err(self.refused(part, format!("{NAME} is read of triangle lists only (mode 4)")));
        }
        // Decode the stream
        let corners =
            wanted.iter().find(|wanted| wanted.attribute.is_none()).map_or(0, |wanted| wanted.stated.count);
        let limits = DecodeLimits::default()
            .with_max_faces((corners / 3).min(self.allowance / 12) as u64)
            .with_max_decoded_bytes(self.allowance as u64);
        let stream = self.view(view, part)?;
        let mut mesh = Mesh::new();
        MeshDecoder::new()
            .decode(&mut DecoderBuffer::new(stream.bytes).with_limits(limits), &mut mesh)
            .map_err(|fault| match fault.kind() {
                ErrorKind::LimitExceeded => self.refused(
                    part,
                    "its Draco data has more than its accessors state, or 256 times the file's size",
                ),
                _ => self.notes.error(part, format!("its Draco data is damaged: {}", fault.message())),
            })?;
        let attributes = (0..mesh.num_attributes()).filter_map(|id| mesh.try_attribute(id).ok());
        let decoded: usize = attributes.map(|attribute| attribute.buffer().data().len()).sum();
        let length = stream.bytes.len() + decoded + mesh.num_faces() * 12;
        self.allow(length, part)?;
        for Wanted { accessor, stated, attribute, part } in wanted {
            match self.unpacked.get(&accessor) {
                Some(known) if known.source == (view, attribute) => continue,
                Some(_) => return Err(self.refused(&part, "it stands for two arrays that are compressed")),
                None => self.allow(length_of(stated), &part)?,
            }
            let bytes = match attribute {
                Some(id) => elements(&mesh, id, stated),
                None => indices(&mesh, stated),
            };
            let bytes = bytes.map_err(|fault| self.refused(&part, fault))?;
            self.unpacked.insert(accessor, Unpacked { bytes, source: (view, attribute) });
        }
        Ok(())
    }

    /// The accessors of a primitive that are compressed; none where all of them have a bufferView as a fallback.
    fn wanted(&self, data: &Members<'_>, primitive: &Primitive, part: &str) -> Result<Vec<Wanted<'a>>> {
        let attributes: BTreeMap<String, u32> = data.require("attributes")?;
        let Some(indices) = primitive.indices else {
            return Err(self.refused(part, format!("it has {NAME}, but no indices")));
        };
        let mut found = vec![(indices, None, "indices".to_owned())];
        for (key, id) in attributes {
            found.extend(primitive.attributes.get(&key).map(|&accessor| (accessor, Some(id), key)));
        }
        let mut wanted = Vec::new();
        let all = found.len();
        for (accessor, attribute, key) in found {
            let stated = self.document.accessors.get(accessor, part)?;
            let part = format!("{}, {key} of {part}", self.document.accessors.label(accessor));
            if stated.buffer_view.is_none() {
                wanted.push(Wanted { accessor, stated, attribute, part });
            }
        }
        if !wanted.is_empty() && wanted.len() < all {
            return Err(
                self.refused(part, "some of its compressed accessors have a bufferView, others have none")
            );
        }
        Ok(wanted)
    }

    fn refused(&self, part: &str, message: impl Into<String>) -> SceneError {
        let help = "gltf-transform copy IN.glb OUT.glb takes the compression out";
        self.notes.error(part, message).with_help(help)
    }
}

/// Bytes that an accessor's elements fill.
fn length_of(stated: &Accessor) -> usize {
    let size = component(stated.component_type).map_or(0, NumberType::size);
    components(&stated.shape).map_or(0, |found| stated.count.saturating_mul(found * size))
}

/// The elements of an attribute, a point after the other, or why they are not what the accessor states.
fn elements(mesh: &Mesh, id: u32, stated: &Accessor) -> Result<Vec<u8>, String> {
    let attribute = mesh.attribute_by_unique_id(id).ok_or(format!("its Draco data has no attribute {id}"))?;
    let number = match attribute.data_type() {
        DataType::Int8 => Some(NumberType::I8),
        DataType::Uint8 => Some(NumberType::U8),
        DataType::Int16 => Some(NumberType::I16),
        DataType::Uint16 => Some(NumberType::U16),
        DataType::Uint32 => Some(NumberType::U32),
        DataType::Float32 => Some(NumberType::F32),
        _ => None,
    };
    let (shape, found) = (components(&stated.shape), usize::from(attribute.num_components()));
    let size = found * attribute.data_type().byte_length();
    if number.is_none() || number != component(stated.component_type) || shape != Some(found) {
        return Err(format!(
            "it is {} of component type {}, but its Draco data has {found} numbers of type {:?}",
            stated.shape,
            stated.component_type,
            attribute.data_type()
        ));
    }
    if stated.count != mesh.num_points() {
        return Err(format!("its count is {}, but its Draco data has {}", stated.count, mesh.num_points()));
    }
    let values = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(size * stated.count);
    for point in 0..stated.count as u32 {
        let start = (attribute.mapped_index(PointIndex(point)).0 as usize).saturating_mul(size);
        let value = values.get(start..start.saturating_add(size)).ok_or("its Draco data lacks values")?;
        bytes.extend_from_slice(value);
    }
    Ok(bytes)
}

/// The corners of the triangles in the accessor's type, or why they are not what it states.
fn indices(mesh: &Mesh, stated: &Accessor) -> Result<Vec<u8>, String> {
    let size = component(stated.component_type).map_or(0, NumberType::size);
    let found = 3 * mesh.num_faces();
    if stated.count != found {
        return Err(format!("its count is {}, but its Draco data has {found}", stated.count));
    }
    if size < 4 && mesh.num_points() > 1 << (8 * size) {
        let points = mesh.num_points();
        return Err(format!(
            "its component type is {}, too small for {points} vertices",
            stated.component_type
        ));
    }
    let corners = mesh.faces().iter().flatten();
    Ok(corners.flat_map(|corner| corner.0.to_le_bytes().into_iter().take(size)).collect())
}
