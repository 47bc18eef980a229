//! Colors and numbers at a point: factors, textures and vertex colors multiplied.

use std::sync::Arc;

use glam::Vec3;
use translucid_scene::{ColorInput, Image, ScalarInput, Scene, TextureFilter, TextureRef};

use crate::ray::SurfacePoint;

pub(super) fn color(scene: &Scene, input: &ColorInput, point: &SurfacePoint) -> Vec3 {
    let mut value = input.factor;
    if let Some(texture) = &input.texture {
        let [r, g, b, _] = texel(&scene.images, texture, point);
        value *= Vec3::new(r, g, b);
    }
    if input.vertex_color { value * point.color } else { value }
}

pub(super) fn scalar(scene: &Scene, input: &ScalarInput, point: &SurfacePoint) -> f32 {
    match &input.texture {
        None => input.factor,
        Some((texture, channel)) => input.factor * texel(&scene.images, texture, point)[*channel as usize],
    }
}

pub(super) fn texel(images: &[Arc<Image>], texture: &TextureRef, point: &SurfacePoint) -> [f32; 4] {
    let uv = texture.coordinates(point.uv);
    let image = &images[texture.image];
    match texture.filter {
        TextureFilter::Linear => image.bilinear(uv.x, uv.y, texture.wrap),
        TextureFilter::Nearest => image.nearest(uv.x, uv.y, texture.wrap),
    }
}
