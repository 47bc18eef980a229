//! Materials at a point: textures evaluated, values clamped, lengths turned into profiles.

use glam::Vec3;
use translucid_profile::d_from_surface_albedo_f32;
use translucid_scene::{
    Channel, ColorInput, Image, Material, ScalarInput, Scene, SubsurfaceMethod, SubsurfaceModel, TextureRef,
};

use crate::ray::SurfacePoint;
use crate::subsurface::kernel::tables::{ProfileSource, ProfileTables};
use crate::subsurface::pairing::Pairing;
use crate::surface::bsdf::{MaterialTables, SurfaceParameters};

/// Mean free paths below this many rounding errors of a position count as a point: a walk would lose its way, and A be
/// off by more than 1 %.
const LEAST_OFFSETS_OF_MFP: f32 = 8.0;

/// What a scene's materials need beside their parameters.
pub(crate) struct Materials {
    tables: Vec<MaterialTables>,
    /// Index into `tables` for each material.
    table_of: Vec<usize>,
    /// For each material, whether light may pass it: shadow rays then look closer.
    lets_light_through: Vec<bool>,
    profile_tables: ProfileTables,
    /// For each material, where its profile is.
    profile_sources: Vec<ProfileSource>,
    /// For each material whose entry has a say, what that takes.
    pairings: Vec<Option<Pairing>>,
}

/// The subsurface profile, per channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Subsurface {
    /// Surface albedo A in [0, 1].
    pub(crate) albedo: Vec3,
    /// Length that scales the profile [L], 0 where the channel is Lambertian: the width d of normalized diffusion,
    /// for a tabulated model the length that the material states, for a walk the mean free path 1/σ_t.
    pub(crate) length: Vec3,
    /// The profile of length 1.
    pub(crate) source: ProfileSource,
}

impl Subsurface {
    /// Surface albedo, 0 in channels that do not scatter below the surface.
    pub(crate) fn scattering(&self) -> Vec3 {
        let of = |c: usize| if self.length[c] > 0.0 { self.albedo[c] } else { 0.0 };
        Vec3::new(of(0), of(1), of(2))
    }
}

impl Materials {
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut keys: Vec<(f32, f32)> = Vec::new();
        let mut tables = Vec::new();
        let mut table_of = Vec::new();
        for material in &scene.materials {
            let key = (material.specular_ior, material.coat_ior);
            let known = keys.iter().position(|&k| k == key);
            table_of.push(known.unwrap_or(keys.len()));
            if known.is_none() {
                keys.push(key);
                tables.push(MaterialTables::new(key.0, key.1));
            }
        }
        let lets_light_through = scene
            .materials
            .iter()
            .map(|m| {
                let opacity = &m.geometry_opacity;
                let clear = m.transmission_weight.factor > 0.0 && !scene.integrator.caustics;
                opacity.factor < 1.0 || opacity.texture.is_some() || clear
            })
            .collect();
        let mut profile_tables = ProfileTables::default();
        let files = &scene.profile_tables;
        let profile_sources: Vec<ProfileSource> =
            scene.materials.iter().map(|material| profile_tables.source(material, files)).collect();
        if scene.integrator.subsurface_method == SubsurfaceMethod::PointBased {
            for (material, source) in scene.materials.iter().zip(&profile_sources) {
                profile_tables.note_of_points(material, *source);
            }
        }
        profile_tables.note_lights(scene);
        let pairing =
            |(index, &source): (usize, &ProfileSource)| Pairing::new(scene, index, source, &profile_tables);
        let pairings = profile_sources.iter().enumerate().map(pairing).collect();
        Self { tables, table_of, lets_light_through, profile_tables, profile_sources, pairings }
    }

    pub(crate) fn profile_tables(&self) -> &ProfileTables {
        &self.profile_tables
    }

    /// Adds what a user should know.
    pub(crate) fn add_note(&mut self, note: String) {
        self.profile_tables.add_note(note);
    }

    /// Where a material's profile is.
    pub(crate) fn profile_source(&self, material: usize) -> ProfileSource {
        self.profile_sources[material]
    }

    /// How a material's parameters at exit and entry go together; `None` where those of the exit count alone.
    #[inline]
    pub(crate) fn pairing(&self, material: usize) -> Option<&Pairing> {
        self.pairings[material].as_ref()
    }

    pub(crate) fn tables(&self, material: usize) -> &MaterialTables {
        &self.tables[self.table_of[material]]
    }

    pub(crate) fn lets_light_through(&self, material: usize) -> bool {
        self.lets_light_through[material]
    }

    /// Whether any shadow ray has to look closer.
    pub(crate) fn any_lets_light_through(&self) -> bool {
        self.lets_light_through.contains(&true)
    }
}

/// Evaluates a material's subsurface parameters at the point where light leaves.
pub(crate) fn subsurface_at(
    scene: &Scene,
    materials: &Materials,
    index: usize,
    point: &SurfacePoint,
) -> Subsurface {
    let material = &scene.materials[index];
    let albedo = albedo_at(scene, material, point);
    if material.subsurface_model == SubsurfaceModel::None {
        return Subsurface { albedo, length: Vec3::ZERO, source: materials.profile_sources[index] };
    }
    let length = stated_length_at(scene, material, point);
    materials.subsurface(index, material, albedo, length, point.offset)
}

/// Surface albedo A in [0, 1].
pub(crate) fn albedo_at(scene: &Scene, material: &Material, point: &SurfacePoint) -> Vec3 {
    color(scene, &material.subsurface_color, point).clamp(Vec3::ZERO, Vec3::ONE)
}

/// The length that the material states, per channel \[L\]: a mean free path or a diffuse one.
pub(crate) fn stated_length_at(scene: &Scene, material: &Material, point: &SurfacePoint) -> Vec3 {
    let radius = scalar(scene, &material.subsurface_radius, point).max(0.0);
    color(scene, &material.subsurface_radius_scale, point).max(Vec3::ZERO) * radius
}

impl Materials {
    /// The profile of a surface albedo and a stated length, where positions are exact to `offset`.
    pub(crate) fn subsurface(
        &self,
        index: usize,
        material: &Material,
        albedo: Vec3,
        length: Vec3,
        offset: f32,
    ) -> Subsurface {
        let source = self.profile_sources[index];
        // Below the rounding error of a position the profile is a point: the Lambertian limit.
        let scale = |channel: usize| match source {
            ProfileSource::NormalizedDiffusion => {
                let d = d_from_surface_albedo_f32(
                    albedo[channel],
                    length[channel],
                    material.subsurface_parameter,
                    material.subsurface_configuration,
                );
                if d > offset { d } else { 0.0 }
            }
            ProfileSource::Table(table)
            | ProfileSource::Directional { table, .. }
            | ProfileSource::Oblique { table, .. } => {
                let length = length[channel];
                let profile = self.profile_tables.table(table).at(albedo[channel], length);
                // The length says little of the width: a file's radii may be in any unit
                if length > 0.0 && profile.cdf(offset) < 0.5 { length } else { 0.0 }
            }
            ProfileSource::RandomWalk(medium) => {
                let mfp = self.profile_tables.medium(medium).mfp(albedo[channel], length[channel]);
                if mfp > LEAST_OFFSETS_OF_MFP * offset { mfp } else { 0.0 }
            }
        };
        Subsurface { albedo, length: Vec3::new(scale(0), scale(1), scale(2)), source }
    }
}

/// Evaluates everything that the surface itself does.
pub(crate) fn surface_at(
    scene: &Scene,
    material: &Material,
    point: &SurfacePoint,
    subsurface: &Subsurface,
) -> SurfaceParameters {
    let unit_scalar = |input: &ScalarInput| scalar(scene, input, point).clamp(0.0, 1.0);
    let unit_color = |input: &ColorInput| color(scene, input, point).clamp(Vec3::ZERO, Vec3::ONE);
    let tint =
        if material.transmission_depth > 0.0 { Vec3::ONE } else { unit_color(&material.transmission_color) };
    SurfaceParameters {
        base_color: unit_color(&material.base_color) * material.base_weight,
        metalness: unit_scalar(&material.base_metalness),
        specular_weight: unit_scalar(&material.specular_weight),
        specular_color: unit_color(&material.specular_color),
        specular_roughness: unit_scalar(&material.specular_roughness),
        specular_ior: material.specular_ior,
        transmission_weight: unit_scalar(&material.transmission_weight),
        transmission_tint: tint,
        subsurface_weight: unit_scalar(&material.subsurface_weight),
        subsurface_color: subsurface.albedo,
        subsurface_active: subsurface.length.cmpgt(Vec3::ZERO).into(),
        coat_weight: unit_scalar(&material.coat_weight),
        coat_color: unit_color(&material.coat_color),
        coat_roughness: unit_scalar(&material.coat_roughness),
        coat_ior: material.coat_ior,
    }
}

/// Share of light that the surface stops, in [0, 1].
pub(crate) fn opacity_at(scene: &Scene, material: &Material, point: &SurfacePoint) -> f32 {
    scalar(scene, &material.geometry_opacity, point).clamp(0.0, 1.0)
}

/// Largest color of an emission, as scene files have it.
const GREATEST_FACTOR: f32 = 1e6;

/// Emitted radiance.
pub(crate) fn emission_at(scene: &Scene, material: &Material, point: &SurfacePoint) -> Vec3 {
    if material.emission_luminance <= 0.0 {
        return Vec3::ZERO;
    }
    let color = color(scene, &material.emission_color, point).clamp(Vec3::ZERO, Vec3::splat(GREATEST_FACTOR));
    color * material.emission_luminance
}

/// Absorption coefficient of a clear material [1/L]; zero where its color is a tint of the surface.
pub(crate) fn absorption(material: &Material) -> Vec3 {
    if material.transmission_depth <= 0.0 {
        return Vec3::ZERO;
    }
    let color = material.transmission_color.factor.clamp(Vec3::splat(1e-6), Vec3::ONE);
    -Vec3::new(color.x.ln(), color.y.ln(), color.z.ln()) / material.transmission_depth
}

/// The shading normal, bent by the normal map if there is one.
pub(crate) fn shading_normal_at(scene: &Scene, material: &Material, point: &SurfacePoint) -> Vec3 {
    let Some(map) = &material.geometry_normal else { return point.shading_normal };
    let Some(frame) = tangent_frame(scene, point) else { return point.shading_normal };
    let texel = texel(&scene.images, &map.texture, point);
    let x = (texel[0] * 2.0 - 1.0) * map.scale;
    let y = (texel[1] * 2.0 - 1.0) * map.scale;
    let z = texel[2] * 2.0 - 1.0;
    let normal = frame[0] * x + frame[1] * y + point.shading_normal * z;
    match normal.try_normalize() {
        Some(normal) if normal.dot(point.geometric_normal) > 0.0 => normal,
        _ => point.shading_normal,
    }
}

/// Tangent and bitangent along u and v: the mesh's own, or the triangle's.
fn tangent_frame(scene: &Scene, point: &SurfacePoint) -> Option<[Vec3; 2]> {
    let mesh = &scene.objects[point.object as usize].mesh;
    let corners = mesh.triangles[point.triangle as usize].map(|corner| corner as usize);
    let normal = point.shading_normal;
    let (tangent, sign) = if mesh.tangents.is_empty() {
        if mesh.uvs.is_empty() {
            return None;
        }
        let [p0, p1, p2] = corners.map(|c| mesh.positions[c]);
        let [t0, t1, t2] = corners.map(|c| mesh.uvs[c]);
        let (d1, d2) = (t1 - t0, t2 - t0);
        let determinant = d1.perp_dot(d2);
        let tangent = ((p1 - p0) * d2.y - (p2 - p0) * d1.y) * determinant.signum();
        (tangent, determinant.signum())
    } else {
        // Corner weights would matter only where tangents differ much within a triangle.
        let [a, b, c] = corners.map(|c| mesh.tangents[c]);
        let sum = a + b + c;
        (sum.truncate(), sum.w.signum())
    };
    let tangent = (tangent - normal * normal.dot(tangent)).try_normalize()?;
    Some([tangent, normal.cross(tangent) * sign])
}

fn color(scene: &Scene, input: &ColorInput, point: &SurfacePoint) -> Vec3 {
    let mut value = input.factor;
    if let Some(texture) = &input.texture {
        let [r, g, b, _] = texel(&scene.images, texture, point);
        value *= Vec3::new(r, g, b);
    }
    if input.vertex_color { value * point.color } else { value }
}

fn scalar(scene: &Scene, input: &ScalarInput, point: &SurfacePoint) -> f32 {
    match &input.texture {
        None => input.factor,
        Some((texture, channel)) => {
            let texel = texel(&scene.images, texture, point);
            let index = match channel {
                Channel::Red => 0,
                Channel::Green => 1,
                Channel::Blue => 2,
                Channel::Alpha => 3,
            };
            input.factor * texel[index]
        }
    }
}

fn texel(images: &[Image], texture: &TextureRef, point: &SurfacePoint) -> [f32; 4] {
    let uv = texture.coordinates(point.uv);
    images[texture.image].bilinear(uv.x, uv.y, texture.wrap)
}
