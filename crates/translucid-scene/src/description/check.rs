//! Checking every number of a thing, and going through them.

use std::fmt;

use glam::Affine2;

use super::layers::visit_layers;
use super::parts::{Counts, List, Part};
use super::slot::SceneSlot;
use crate::placement::{check_edges, check_unit, is_rotation};
use crate::{ColorInput, NormalMap, Projection, ScalarInput, SceneError, SubsurfaceModel, TextureRef};
use translucid_words::{Interval, check_index, refusal};

impl Part<'_> {
    fn check(&self, name: &str, counts: Counts) -> Result<(), SceneError> {
        match self {
            Self::Number(x, range) => range.check(name, **x),
            Self::Count(n, range) => range.check(name, **n),
            Self::Index(index, List::Images) => check_index(name, **index, counts.images, "images"),
            Self::Index(index, List::ProfileTables) => {
                check_index(name, **index, counts.profile_tables, "profile tables")
            }
        }
    }
}

impl SceneSlot<'_> {
    /// Visits every number, by its name.
    pub(super) fn visit(&mut self, key: &str, visit: &mut dyn FnMut(&str, Part<'_>)) {
        match self {
            Self::Absent | Self::Flag(_) | Self::Seed(_) | Self::Word(_) => {}
            Self::Count(n, range) => visit(key, Part::Count(n, *range)),
            Self::Size([width, height], range) => {
                visit("width", Part::Count(width, *range));
                visit("height", Part::Count(height, *range));
            }
            Self::Number(x, range) | Self::Length(x, range) | Self::Angle(x, range) => {
                visit(key, Part::Number(x, *range));
            }
            Self::Pair(pair, range) => visit_all(key, pair.as_mut(), *range, visit),
            Self::Point(point) => visit_all(key, point.as_mut(), Interval::PLACE, visit),
            Self::Vector(vector) => visit_all(key, vector.as_mut(), Interval::DIRECTION, visit),
            Self::Direction(vector, _) => visit_all("direction", vector.as_mut(), Interval::DIRECTION, visit),
            Self::Rgb(color, range) | Self::Triple(color, range) => {
                visit_all(key, color.as_mut(), *range, visit);
            }
            Self::Radiance(color) | Self::Power(color) => {
                visit_all(key, color.as_mut(), Interval::LIGHT, visit);
            }
            Self::Edges { edges: [x, y], .. } => {
                visit_all("edge_x", x.as_mut(), Interval::PLACE, visit);
                visit_all("edge_y", y.as_mut(), Interval::PLACE, visit);
            }
            Self::Projection(Projection::Perspective { horizontal_fov }) => {
                visit("fov", Part::Number(horizontal_fov, Projection::FOV));
            }
            Self::Projection(Projection::Orthographic { width }) => {
                visit("width", Part::Number(width, Interval::REACH));
            }
            Self::Rotation(matrix) => visit_all(key, matrix.as_mut(), Interval::DIRECTION, visit),
            Self::Image(image) => {
                image.iter_mut().for_each(|image| visit("image", Part::Index(image, List::Images)));
            }
            Self::Scalar(ScalarInput { factor, texture }, range) => {
                visit(
                    key,
                    Part::Number(factor, if texture.is_some() { ScalarInput::TEXTURED } else { *range }),
                );
                texture.iter_mut().for_each(|(texture, _)| visit_texture(key, texture, visit));
            }
            Self::Color(ColorInput { factor, texture, vertex_color }, range) => {
                let is_product = texture.is_some() || *vertex_color;
                visit_all(
                    key,
                    factor.as_mut(),
                    if is_product { ColorInput::TEXTURED } else { *range },
                    visit,
                );
                texture.iter_mut().for_each(|texture| visit_texture(key, texture, visit));
            }
            Self::NormalMap(map) => {
                if let Some(NormalMap { texture, scale }) = map {
                    visit(&format!("{key}.scale"), Part::Number(scale, NormalMap::SCALE));
                    visit_texture(key, texture, visit);
                }
            }
            Self::Model(SubsurfaceModel::Tabulated(table)) => {
                visit("subsurface_model.tabulated", Part::Index(table, List::ProfileTables));
            }
            Self::Model(_) => {}
            Self::Layers(layers) => {
                visit_layers(key, layers, visit);
            }
        }
    }

    /// Checks every number, and what the ranges of single numbers do not say.
    pub(super) fn check_all(mut self, key: &str, counts: Counts) -> Result<(), SceneError> {
        let mut result = Ok(());
        self.visit(key, &mut |name, part| {
            if result.is_ok() {
                result = part.check(name, counts);
            }
        });
        result?;
        match self {
            Self::Direction(direction, _) => check_unit("direction", *direction),
            Self::Edges { edges: [x, y], .. } => check_edges(*x, *y),
            Self::Rotation(matrix) if !is_rotation(*matrix) => Err(refusal(key, *matrix, "a rotation")),
            _ => Ok(()),
        }
    }
}

fn visit_all(
    key: impl fmt::Display,
    numbers: &mut [f32],
    range: Interval,
    visit: &mut dyn FnMut(&str, Part<'_>),
) {
    for (i, number) in numbers.iter_mut().enumerate() {
        visit(&format!("{key}[{i}]"), Part::Number(number, range));
    }
}

fn visit_texture(key: &str, texture: &mut TextureRef, visit: &mut dyn FnMut(&str, Part<'_>)) {
    visit(&format!("{key}.texture.image"), Part::Index(&mut texture.image, List::Images));
    let mut numbers = texture.image_from_uv.to_cols_array();
    visit_all(format_args!("{key}.texture.image_from_uv"), &mut numbers, TextureRef::MAPPING, visit);
    texture.image_from_uv = Affine2::from_cols_array(&numbers);
}
