//! Wavefront material libraries, with the extension for physically based materials (Pr, Pm, Pc, Pcr).

mod draft;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::{Affine2, Vec2, Vec3};
use translucid_scene::{
    Channel, ColorSpace, Image, ImageKind, Interval, Material, NormalMap, Pixels, Place, ScalarInput,
    SceneError, TextureRef, Warning, Wrap,
};

pub(crate) use draft::Beside;
use draft::{Draft, Notes};

use crate::image::read_image;
use crate::loading::Loading;
use crate::result::Result;
use crate::writer::Writer;

/// Range of the exponent of a highlight.
const EXPONENT: Interval = Interval::closed(0.0, f32::MAX as f64);

/// Range of four times a coat's weight.
const COATS: Interval = Interval::closed(0.0, 4.0);

/// Images by file and color space, each loaded once.
#[derive(Debug, Default)]
pub(crate) struct ImagePool {
    images: Vec<Image>,
    numbers: HashMap<(PathBuf, ImageKind), Option<usize>>,
}

impl ImagePool {
    pub(crate) fn into_images(self) -> Vec<Image> {
        self.images
    }

    /// The number of an image; one that cannot be loaded adds a warning, once.
    fn get(
        &mut self,
        path: PathBuf,
        kind: ImageKind,
        place: Place,
        loading: &mut Loading<'_>,
    ) -> Option<usize> {
        let key = (path, kind);
        if let Some(&known) = self.numbers.get(&key) {
            return known;
        }
        let number = match read_image(&key.0, kind, loading) {
            Ok(image) => {
                self.images.push(image);
                Some(self.images.len() - 1)
            }
            Err(error) => {
                let message = format!("the material is used without its image: {error}");
                loading.warnings.push(Warning { message, place: Some(place) });
                None
            }
        };
        self.numbers.insert(key, number);
        number
    }
}

/// Parses a material library.
///
/// | MTL | material |
/// |---|---|
/// | Kd, map_Kd, colors of vertices | `base_color`, their product, but colors of vertices do not count beside a map; a map or colors alone are not darkened: Blender leaves out Kd beside a map; nor are they beside a black Kd, which Maya writes |
/// | Ks, map_Ks | `specular_color`, and `specular_weight` = 2 max Ks, at most 1: ½ is what exporters write for an ordinary dielectric; above ½ beside a black Kd a metal of that color in the models that reflect (illum 3, 5, 8) |
/// | Ns | `specular_roughness` = (2/(Ns + 2))^¼ (B. Walter et al. 2007, equation 35 and below: the width is its square) |
/// | Pr, map_Pr, Pm, map_Pm, Pc, Pcr | `specular_roughness`, `base_metalness`, `coat_weight`, `coat_roughness`; the coat's index is 1.5, that of Disney's model (B. Burley 2012, §5.4), which the extension follows, and a metal's highlight is whole |
/// | Ni | `specular_ior` |
/// | d, Tr, map_d | `geometry_opacity`; for the glass models (illum 4, 6, 7, 9) `transmission_weight` = 1 − d. Tr = 1 − d counts where there is no d, and Tr 1 is what exporters write for an opaque material |
/// | illum 6, 7 | without d, `transmission_weight` = 1 if Ni is above 1 and Kd black, as of glass; else the model is opaque: Maya writes illum 4 for that |
/// | Tf | `transmission_color` of a glass model |
/// | Ke, map_Ke | emission |
/// | norm, and bump or map_bump if the image looks like a normal map | `geometry_normal` |
///
/// Programs that mean something else by these have their rules in [`writer`](crate::writer).
///
/// # Errors
/// A number cannot be read; the message names the line.
pub(crate) fn parse_mtl(
    bytes: &[u8],
    path: &Path,
    beside: Beside,
    pool: &mut ImagePool,
    loading: &mut Loading<'_>,
) -> Result<Vec<Material>> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut materials: Vec<Draft> = Vec::new();
    for (number, line) in String::from_utf8_lossy(bytes).lines().enumerate() {
        let place = Place::line(path, number + 1);
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        if keyword == "newmtl" {
            materials.push(Draft::new(rest.trim()));
        } else if let Some(draft) = materials.last_mut() {
            let mut reader = LineReader { path, place: &place, writer: beside.writer, pool, loading };
            reader
                .read(&keyword.to_ascii_lowercase(), rest.trim(), draft)
                .map_err(|m| SceneError::at(place.clone(), m))?;
        }
    }
    let mut notes = Notes::default();
    let materials = materials.into_iter().map(|draft| draft.finish(beside, &mut notes)).collect();
    notes.warn(path, loading.warnings);
    Ok(materials)
}

struct LineReader<'a, 'l> {
    path: &'a Path,
    place: &'a Place,
    writer: Writer,
    pool: &'a mut ImagePool,
    loading: &'a mut Loading<'l>,
}

impl LineReader<'_, '_> {
    fn read(&mut self, keyword: &str, rest: &str, draft: &mut Draft) -> Result<(), String> {
        let material = &mut draft.material;
        match keyword {
            "kd" => {
                draft.has_color = true;
                self.color(rest, Interval::UNIT, &mut material.base_color.factor)?;
            }
            "ks" => {
                let mut color = Vec3::ZERO;
                self.color(rest, Interval::UNIT, &mut color)?;
                draft.highlight = color;
                let strength = color.max_element();
                material.specular_weight.factor = (2.0 * strength).min(1.0);
                material.specular_color.factor = if strength > 0.0 { color / strength } else { Vec3::ONE };
            }
            "ka" => {
                self.color(rest, Interval::UNIT, draft.ambient.insert(Vec3::ZERO))?;
            }
            "ke" => {
                let mut color = Vec3::ZERO;
                self.color(rest, Interval::LIGHT, &mut color)?;
                material.emission_luminance = color.max_element();
                material.emission_color.factor =
                    (color / color.max_element().max(f32::MIN_POSITIVE)).min(Vec3::ONE);
            }
            "tf" => self.color(rest, Interval::UNIT, draft.filter.insert(Vec3::ONE))?,
            "ns" if !draft.has_roughness => {
                let exponent = self.scalar(rest, EXPONENT)?;
                material.specular_roughness.factor = match self.writer.principled {
                    Some(smooth) => 1.0 - libm::sqrtf(exponent / smooth).min(1.0),
                    None => libm::powf(2.0 / (exponent + 2.0), 0.25),
                };
            }
            "pr" => {
                draft.has_roughness = true;
                material.specular_roughness.factor = self.scalar(rest, Interval::UNIT)?;
            }
            "pm" => {
                draft.has_metalness = true;
                material.base_metalness.factor = self.scalar(rest, Interval::UNIT)?;
            }
            "pc" => {
                let range = if self.writer.principled.is_some() { COATS } else { Interval::UNIT };
                (material.coat_weight.factor, material.coat_ior) = (self.scalar(rest, range)?, 1.5);
            }
            "pcr" => material.coat_roughness.factor = self.scalar(rest, Interval::UNIT)?,
            "ps" | "aniso" if number(rest).is_some_and(|value| value != 0.0) => {
                self.warn(format!("{keyword} has no counterpart: passed over"));
            }
            "ni" => {
                draft.has_index = true;
                material.specular_ior = self.scalar(rest, Interval::IOR)?;
            }
            "d" => draft.opacity = Some(self.scalar(rest.trim_start_matches("-halo"), Interval::UNIT)?),
            "tr" => draft.transparency = Some(self.scalar(rest, Interval::UNIT)?),
            "illum" => {
                draft.illumination = rest
                    .parse()
                    .map_err(|_| format!("illum is \"{rest}\", but must be a number from 0 to 10"))?;
            }
            _ if keyword.starts_with("map_")
                || matches!(keyword, "bump" | "norm" | "disp" | "decal" | "refl") =>
            {
                self.map(keyword, rest, draft);
            }
            _ => (),
        }
        Ok(())
    }

    fn warn(&mut self, message: String) {
        self.loading.warnings.push(Warning { message, place: Some(self.place.clone()) });
    }

    /// A value brought into its range, with a warning if it was not.
    fn within(&mut self, value: f32, range: Interval) -> f32 {
        let nearest = range.nearest(value);
        if nearest != value {
            self.warn(format!("the value {value} is set to the nearest in {range}"));
        }
        nearest
    }

    fn scalar(&mut self, rest: &str, range: Interval) -> Result<f32, String> {
        let word = rest.split_whitespace().next().unwrap_or_default();
        let value = number(word).ok_or_else(|| format!("\"{word}\" is not a number"))?;
        Ok(self.within(value, range))
    }

    /// One number for all channels or three; a spectrum in a file is passed over.
    fn color(&mut self, rest: &str, range: Interval, color: &mut Vec3) -> Result<(), String> {
        let words: Vec<&str> = rest.split_whitespace().collect();
        if let ["spectral" | "xyz", ..] = words[..] {
            self.warn(format!("\"{rest}\" is not red, green, blue: passed over"));
            return Ok(());
        }
        let values: Option<Vec<f32>> = words.iter().take(3).map(|word| number(word)).collect();
        let [r, g, b] = match values.as_deref() {
            Some(&[grey]) => [grey; 3],
            Some(&[r, g, b]) => [r, g, b],
            _ => return Err(format!("\"{rest}\" is not a color of one or three numbers")),
        };
        *color = Vec3::from([r, g, b].map(|value| self.within(value, range)));
        Ok(())
    }

    fn map(&mut self, keyword: &str, rest: &str, draft: &mut Draft) {
        // Blender's names of pictures of a roughness, a metal and a Specular IOR Level
        let is_principled = self.writer.principled.is_some();
        let keyword = match keyword {
            "map_ns" if is_principled => "map_pr",
            "map_refl" | "refl" if is_principled => "map_pm",
            "map_ks" if is_principled => "map_level",
            _ => keyword,
        };
        let kind = match keyword {
            "map_kd" | "map_ks" | "map_ke" => ImageKind::Color(ColorSpace::Srgb),
            "map_pr" | "map_pm" | "map_level" | "map_d" | "norm" | "map_kn" | "bump" | "map_bump" => {
                ImageKind::Plain(ColorSpace::Linear)
            }
            // Ambient light is what the renderer computes
            "map_ka" => {
                draft.has_ambient_map = true;
                return;
            }
            _ => return self.warn(format!("{keyword} has no counterpart: passed over")),
        };
        let mut options = MapOptions::parse(rest);
        for number in options.scale.as_mut().iter_mut().chain(options.offset.as_mut()) {
            *number = self.within(*number, TextureRef::MAPPING);
        }
        options.bump = self.within(options.bump, NormalMap::SCALE);
        let path = self.path.with_file_name(options.file.replace('\\', "/"));
        let Some(image) = self.pool.get(path, kind, self.place.clone(), self.loading) else { return };
        let texture = options.texture(image);
        let scalar = |channel| Some((texture, channel));
        let material = &mut draft.material;
        match keyword {
            "map_kd" => material.base_color.texture = Some(texture),
            "map_ks" => material.specular_color.texture = Some(texture),
            "map_ke" => {
                material.emission_color.texture = Some(texture);
                if material.emission_luminance == 0.0 {
                    (material.emission_luminance, material.emission_color.factor) = (1.0, Vec3::ONE);
                }
            }
            "map_pr" => {
                draft.has_roughness = true;
                material.specular_roughness = ScalarInput { factor: 1.0, texture: scalar(Channel::Red) };
            }
            "map_pm" => {
                draft.has_metalness = true;
                material.base_metalness = ScalarInput { factor: 1.0, texture: scalar(Channel::Red) };
            }
            "map_level" => {
                material.specular_weight = ScalarInput { factor: 2.0, texture: scalar(Channel::Red) };
            }
            "map_d" => {
                let channel = if has_alpha(&self.pool.images[image]) { Channel::Alpha } else { Channel::Red };
                material.geometry_opacity.texture = scalar(channel);
            }
            "norm" | "map_kn" => material.geometry_normal = Some(NormalMap { texture, scale: options.bump }),
            _ if looks_like_normals(&self.pool.images[image]) => {
                material.geometry_normal = Some(NormalMap { texture, scale: options.bump });
            }
            _ => self.warn(format!("\"{}\" is a height map, not a normal map: passed over", options.file)),
        }
    }
}

/// A finite number.
fn number(word: &str) -> Option<f32> {
    word.parse().ok().filter(|value: &f32| value.is_finite())
}

fn has_alpha(image: &Image) -> bool {
    match &image.pixels {
        Pixels::Byte(pixels) => pixels.iter().any(|pixel| pixel[3] != 255),
        Pixels::Float(pixels) => pixels.iter().any(|pixel| pixel[3] != 1.0),
    }
}

/// Whether the mean points up, as that of a map of normals (0.5, 0.5, 1) does and of heights does not.
fn looks_like_normals(image: &Image) -> bool {
    let [x, y, z, _] = image.mean();
    (x - 0.5).abs() < 0.15 && (y - 0.5).abs() < 0.15 && z > 0.7
}

/// The options of a map and its file's name.
struct MapOptions {
    file: String,
    offset: Vec2,
    scale: Vec2,
    bump: f32,
    clamp: bool,
}

impl MapOptions {
    fn parse(rest: &str) -> Self {
        let mut options =
            Self { file: String::new(), offset: Vec2::ZERO, scale: Vec2::ONE, bump: 1.0, clamp: false };
        let mut words = rest.split_whitespace().peekable();
        while let Some(word) = words.next() {
            let mut values = |most: usize| {
                let mut values = Vec::new();
                while let Some(value) = words.peek().filter(|_| values.len() < most).and_then(|w| number(w)) {
                    values.push(value);
                    words.next();
                }
                values
            };
            let pair = |values: &[f32], other: f32| {
                let [u, v] = [0, 1].map(|i| values.get(i).copied().unwrap_or(other));
                Vec2::new(u, v)
            };
            match word {
                "-o" => options.offset = pair(&values(3), 0.0),
                "-s" => options.scale = pair(&values(3), 1.0),
                "-t" => drop(values(3)),
                "-bm" => options.bump = values(1).first().copied().unwrap_or(1.0),
                "-mm" => drop(values(2)),
                "-texres" | "-boost" => drop(values(1)),
                "-clamp" => options.clamp = words.next() == Some("on"),
                "-blendu" | "-blendv" | "-cc" | "-imfchan" | "-type" => drop(words.next()),
                _ => {
                    let name: Vec<&str> = std::iter::once(word).chain(words).collect();
                    options.file = name.join(" ").trim_matches('"').to_owned();
                    break;
                }
            }
        }
        options
    }

    fn texture(&self, image: usize) -> TextureRef {
        let image_from_uv = Affine2::from_scale_angle_translation(self.scale, 0.0, self.offset);
        let wrap = if self.clamp { Wrap::Clamp } else { Wrap::Repeat };
        TextureRef { image_from_uv, wrap: [wrap; 2], ..TextureRef::new(image) }
    }
}

#[cfg(test)]
mod tests {
    use translucid_scene::ColorInput;
    use translucid_testing::mutants;

    use super::*;
    use crate::{MeshFile, load_obj};

    fn parsed(text: &str) -> Result<(Vec<Material>, String)> {
        let mut warnings = Vec::new();
        let materials = parse_mtl(
            text.as_bytes(),
            Path::new("a.mtl"),
            Beside { writer: Writer::of_library(text.as_bytes(), b""), has_colors: false },
            &mut ImagePool::default(),
            &mut Loading::unwatched(&mut warnings),
        )?;
        let lines: Vec<_> = warnings.iter().map(ToString::to_string).collect();
        Ok((materials, lines.join("\n")))
    }

    fn material(lines: &str) -> Material {
        let (mut materials, warnings) = parsed(&format!("newmtl one\n{lines}")).unwrap();
        assert_eq!((materials.len(), warnings.as_str()), (1, ""));
        materials.remove(0)
    }

    const TRIANGLE: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";

    /// A folder with a triangle of material "m", whose library has these lines, and two images.
    fn loaded(lines: &str) -> (MeshFile, String) {
        loaded_with(TRIANGLE, &format!("newmtl m\n{lines}"))
    }

    fn loaded_with(faces: &str, library: &str) -> (MeshFile, String) {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
        write("a.obj", faces.as_bytes());
        write("a.mtl", library.as_bytes());
        write("blue ish.png", &png([128, 128, 255]));
        write("grey.png", &png([90, 90, 90]));
        let mut warnings = Vec::new();
        let scene = load_obj(&folder.path().join("a.obj"), &mut warnings).unwrap();
        let lines: Vec<_> = warnings.iter().map(ToString::to_string).collect();
        (scene, lines.join("\n"))
    }

    fn png(pixel: [u8; 3]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixel)).unwrap();
        bytes
    }

    #[test]
    fn mtl_maps_constants() {
        let m = material("Kd .1 .2 .3\nKs .5 .5 .5\nNs 998\nNi 1.33\nd .25\nKe 0 2 4\nillum 2\n");
        assert_eq!(m.name, "one");
        assert_eq!(m.base_color.factor, Vec3::new(0.1, 0.2, 0.3));
        assert_eq!((m.specular_weight.factor, m.specular_color.factor), (1.0, Vec3::ONE));
        assert!((m.specular_roughness.factor - 0.002_f32.powf(0.25)).abs() < 1e-6);
        assert_eq!((m.specular_ior, m.geometry_opacity.factor), (1.33, 0.25));
        assert_eq!((m.emission_luminance, m.emission_color.factor), (4.0, Vec3::new(0.0, 0.5, 1.0)));
        assert_eq!(material("Tr .25").geometry_opacity.factor, 0.75);
        assert_eq!(material("Kd .5").base_color.factor, Vec3::splat(0.5));
        assert_eq!(material("illum 1").specular_weight.factor, 0.0);
        assert_eq!(material("Ks 0 0 0").specular_weight.factor, 0.0);
    }

    /// Blender 5.2 writes a map without its constant; others write a black Ke beside a map.
    #[test]
    fn mtl_maps_images_that_have_no_constant() {
        let of = |lines: &str| loaded(lines).0.materials[0].clone();
        assert_eq!(of("map_Kd grey.png\n").base_color.factor, Vec3::ONE);
        for lines in ["Kd .5\nmap_Kd grey.png\n", "map_Kd grey.png\nKd .5\n"] {
            assert_eq!(of(lines).base_color.factor, Vec3::splat(0.5));
        }
        for lines in ["map_Ke grey.png\n", "Ke 0 0 0\nmap_Ke grey.png\n"] {
            let m = of(lines);
            assert_eq!((m.emission_luminance, m.emission_color.factor), (1.0, Vec3::ONE));
        }
    }

    #[test]
    fn mtl_maps_the_physical_extension_in_any_order() {
        for lines in ["Ns 10\nPr .7\nPm 1\nPc .5\nPcr .1\n", "Pr .7\nNs 10\nPcr .1\nPc .5\nPm 1\n"] {
            let m = material(lines);
            assert_eq!((m.specular_roughness.factor, m.base_metalness.factor), (0.7, 1.0));
            assert_eq!((m.coat_weight.factor, m.coat_roughness.factor, m.coat_ior), (0.5, 0.1, 1.5));
        }
    }

    /// A chrome ball is Kd 0, Ks 1: as a dielectric it would be black.
    #[test]
    fn mtl_takes_black_with_a_bright_highlight_for_a_metal() {
        let (materials, warnings) = parsed("newmtl m\nKd 0 0 0\nKs 1 .8 .2\nNs 900\nillum 3\n").unwrap();
        let m = &materials[0];
        assert_eq!((m.base_metalness.factor, m.base_color.factor), (1.0, Vec3::new(1.0, 0.8, 0.2)));
        assert!(
            warnings.contains("material \"m\" reflects by illum, with a black Kd and a bright Ks"),
            "{warnings}"
        );
        for plain in
            ["Kd 0 0 0\nKs .5 .5 .5\nillum 3\n", "Kd .1 .1 .1\nKs 1 1 1\nillum 3\n", "Kd 0 0 0\nKs 1 1 1\n"]
        {
            assert_eq!(material(plain).base_metalness.factor, 0.0, "{plain}");
        }
    }

    #[test]
    fn mtl_tells_of_a_color_that_is_ambient_only() {
        for lines in ["Ka .5 .2 .1\n", "map_Ka grey.png\n"] {
            let (file, warnings) = loaded(lines);
            assert_eq!(file.materials[0].base_color.factor, Vec3::splat(0.8));
            assert!(warnings.contains("neither Kd nor map_Kd: the color is gray, 0.8"), "{warnings}");
        }
        let (file, warnings) = loaded("Kd 0 0 0\nmap_Ka grey.png\n");
        assert_eq!(file.materials[0].base_color, ColorInput::constant(Vec3::ZERO));
        assert!(
            warnings.contains("map_Ka of material \"m\" is left out, and Kd is black without a map_Kd"),
            "{warnings}"
        );
        for lines in ["Ka 0 0 0\n", "Ka 1 1 1\nKd .5 .5 .5\n", "Ka 1 1 1\nmap_Kd \"blue ish.png\"\n"] {
            assert_eq!(loaded(lines).1, "");
        }
    }

    #[test]
    fn mtl_maps_glass() {
        let m = material("illum 7\nd .1\nTf .9 1 1\nNi 1.5\n");
        assert_eq!((m.transmission_weight.factor, m.geometry_opacity.factor), (0.9, 1.0));
        assert_eq!(m.transmission_color.factor, Vec3::new(0.9, 1.0, 1.0));
    }

    /// Maya writes an opaque Lambert so, and Poly a textured one.
    #[test]
    fn mtl_of_a_glass_model_is_opaque_unless_something_says_glass() {
        for model in [4, 6, 7, 9] {
            for rest in ["", "Ni 1.00\n", "d 1\nNi 1.5\n", "Tr 0\nNi 1.5\n"] {
                let m = material(&format!("illum {model}\nKd .5 .5 .5\nTf 1 1 1\n{rest}"));
                assert_eq!((m.transmission_weight.factor, m.geometry_opacity.factor), (0.0, 1.0), "{rest}");
            }
            let m = material(&format!("illum {model}\nd 0\nNi 1.5\n"));
            assert_eq!((m.transmission_weight.factor, m.geometry_opacity.factor), (1.0, 1.0));
        }
        assert_eq!(material("illum 7\nKd 0 0 0\nNi 1.5\n").transmission_weight.factor, 1.0);
        let (materials, warnings) = parsed("newmtl a\nillum 7\nKd 1 1 1\nNi 1.5\n").unwrap();
        assert_eq!(materials[0].transmission_weight.factor, 0.0);
        assert!(warnings.contains("illum 6 or 7 of material \"a\" is refraction"), "{warnings}");
    }

    /// As in tinyobjloader d counts before Tr; OpenMVS and others write Tr 1 for what is opaque.
    #[test]
    fn mtl_opacity_is_that_of_d_and_tr_1_alone_hides_nothing() {
        for lines in ["d 1\nTr 1\n", "Tr 1\nd 1\n"] {
            assert_eq!(material(lines).geometry_opacity.factor, 1.0);
        }
        assert_eq!(material("Tr .1\nd .5\n").geometry_opacity.factor, 0.5);
        let (materials, warnings) = parsed("newmtl a\nTr 1\nnewmtl b\nTr 1.0\n").unwrap();
        assert!(materials.iter().all(|m| m.geometry_opacity.factor == 1.0));
        assert!(
            warnings.starts_with("a.mtl: Tr 1 without a d would hide 2 materials, \"a\" and others: "),
            "{warnings}"
        );
        assert_eq!(warnings.lines().count(), 1);
    }

    #[test]
    fn mtl_tells_of_a_tr_that_may_be_an_opacity_and_of_a_tf_without_glass() {
        let warnings = |lines: &str| parsed(&format!("newmtl m\n{lines}")).unwrap().1;
        assert!(
            warnings("Tr .9\n")
                .contains("Tr of material \"m\", above 0.5 without a d, is taken as transparency")
        );
        for lines in ["illum 2\nTf .5 .5 .5\n", "illum 4\nd 1\nTf .5 1 1\n"] {
            assert!(warnings(lines).contains("Tf of material \"m\" is left out"), "{lines}");
        }
        for lines in ["Tr .9\nd .1\n", "Tr .5\n", "Tf 1 1 1\n", "Tf 0 0 0\n", "illum 4\nd 0\nTf .5 .5 .5\n"] {
            assert_eq!(warnings(lines), "", "{lines}");
        }
    }

    /// A library as the named program writes it; expected are the numbers of its own material.
    fn of_writer(head: &str, lines: &str) -> Material {
        let (mut materials, warnings) = parsed(&format!("{head}\n\nnewmtl m\n{lines}")).unwrap();
        assert_eq!((materials.len(), warnings.as_str()), (1, ""), "{lines}");
        materials.remove(0)
    }

    fn blender(lines: &str) -> Material {
        of_writer("# Blender 5.3.0 MTL File: 'None'\n# www.blender.org", lines)
    }

    /// Files of Blender 5.3.0 for roughnesses 0, 0.3, 0.5, 0.8 and 1, which its importer gives back.
    #[test]
    fn mtl_of_blender_has_its_roughness() {
        let cases =
            [("1000", 0.0), ("490", 0.3), ("250", 0.5), ("39.999996", 0.8), ("0", 1.0), ("1001", 0.0)];
        for (exponent, roughness) in cases {
            let found = blender(&format!("Ns {exponent}\nillum 2\n")).specular_roughness.factor;
            assert!((found - roughness).abs() < 1e-6, "{exponent}: {found}");
        }
        assert_eq!(blender("Ns 250\nPr .7\n").specular_roughness.factor, 0.7);
        // io_scene_obj of 2.80 to 3.0: 900 (1 − 0.4)²
        let obj = format!("# Blender v2.93.4 OBJ File: ''\n# www.blender.org\n{TRIANGLE}");
        let library = "# Blender MTL File: 'a.blend'\n# Material Count: 1\n\nnewmtl m\nNs 323.999994\n";
        let material = &loaded_with(&obj, library).0.materials[0];
        assert!((material.specular_roughness.factor - 0.4).abs() < 1e-6);
        let material = &loaded_with(TRIANGLE, library).0.materials[0];
        assert!((material.specular_roughness.factor - 0.28).abs() < 1e-3);
    }

    /// Files of Blender 5.3.0: a cut-out with and without highlight, metals, a coat, glass, a doubled reflectance.
    #[test]
    fn mtl_of_blender_has_its_weights() {
        for model in ["9", "1", "6", "2"] {
            let m = blender(&format!("Ka 1 1 1\nd .2\nillum {model}\n"));
            assert_eq!((m.geometry_opacity.factor, m.transmission_weight.factor), (0.2, 0.0), "{model}");
        }
        let metalness = |lines: &str| blender(lines).base_metalness.factor;
        assert_eq!(metalness("Ka 1 1 1\nKs .5 .5 .5\nillum 2\n"), 0.0);
        assert_eq!(metalness("Ka 1 1 1\nKs .5 .5 .5\nillum 3\n"), 1.0);
        assert_eq!(metalness("Ka .25 .25 .25\nKs .5 .5 .5\nillum 3\n"), 0.25);
        assert_eq!(metalness("Pm .5\nKs .5 .5 .5\nillum 3\n"), 0.5);
        let black = blender("Ka 1 1 1\nKd 0 0 0\nKs .8 .8 .8\nillum 3\n");
        assert_eq!((black.base_metalness.factor, black.base_color.factor), (1.0, Vec3::ZERO));
        let dull = blender("Pm 1\nKs 0 0 0\nillum 1\n");
        assert_eq!((dull.base_metalness.factor, dull.specular_weight.factor), (1.0, 1.0));
        for (code, weight) in [(".4", 0.1), ("1", 0.25), ("2", 0.5), ("4", 1.0)] {
            let m = blender(&format!("Pc {code}\nPcr 0\n"));
            assert_eq!((m.coat_weight.factor, m.coat_ior, m.coat_roughness.factor), (weight, 1.5, 0.0));
        }
        let glass = blender("Kd .25 1 .81\nd 1\nillum 2\nPr 0\nTf .4 .4 .4\n");
        assert!((glass.transmission_weight.factor - 0.4).abs() < 1e-6);
        assert!(glass.transmission_color.factor.distance(Vec3::new(0.5, 1.0, 0.9)) < 1e-6);
        let doubled = blender("Ks 1 1 1\nNi 1.5\n");
        assert!(((doubled.specular_ior - 1.0) / (doubled.specular_ior + 1.0)).powi(2) - 0.08 < 1e-6);
        assert_eq!(blender("Ks .25 .25 .25\nNi 1.5\n").specular_weight.factor, 0.5);
    }

    #[test]
    fn mtl_of_blender_has_pictures_of_numbers() {
        let head = "# Blender 5.3.0 MTL File: 'None'\n";
        let library =
            format!("{head}newmtl m\nmap_Ks grey.png\nmap_Ns grey.png\nnewmtl n\nmap_refl grey.png\n");
        let (scene, warnings) = loaded_with(TRIANGLE, &library);
        let [m, n] = &scene.materials[..] else { panic!() };
        assert_eq!((warnings.as_str(), scene.images[0].color_space), ("", ColorSpace::Linear));
        assert!(m.specular_roughness.texture.is_some() && n.base_metalness.texture.is_some());
        assert!(m.specular_weight.texture.is_some() && m.specular_weight.factor == 2.0);
        let plain = loaded_with(TRIANGLE, &library[head.len()..]);
        assert!(plain.0.materials[0].specular_color.texture.is_some());
        assert!(
            plain.1.contains("map_ns has no counterpart") && plain.1.contains("map_refl has no"),
            "{}",
            plain.1
        );
    }

    #[test]
    fn mtl_of_vtk_has_its_opacity() {
        let head = "# wavefront mtl file written by the visualization toolkit";
        for (lines, opacity) in [("Tr 0.9\nillum 3\n", 0.9), ("Tr 1 illum 3\n", 1.0), ("Tr 0\n", 0.0)] {
            assert_eq!(of_writer(head, lines).geometry_opacity.factor, opacity);
        }
    }

    /// As assimp, Open3D and MeshLab write them: the last with white vertices beside a Kd.
    #[test]
    fn mtl_multiplies_the_colors_of_vertices() {
        let colored = TRIANGLE.replace("0 0 0\n", "0 0 0 1 0 0\n");
        let of = |obj: &str, lines: &str| loaded_with(obj, &format!("newmtl m\n{lines}"));
        for (lines, factor) in [("Kd 1 1 1\n", 1.0), ("Kd .5 .5 .5\n", 0.5), ("", 1.0)] {
            let (scene, warnings) = of(&colored, lines);
            let expected = ColorInput { factor: Vec3::splat(factor), ..ColorInput::vertex() };
            assert_eq!((scene.materials[0].base_color, warnings.as_str()), (expected, ""));
            assert_eq!(scene.objects[0].mesh.colors, [Vec3::X, Vec3::ONE, Vec3::ONE]);
        }
        let (scene, warnings) = of(&colored.replace("usemtl m\n", ""), "");
        assert_eq!((scene.materials[1].base_color, warnings.as_str()), (ColorInput::vertex(), ""));
        let (scene, warnings) = of(&colored, "Kd 0 0 0\n");
        assert_eq!(scene.materials[0].base_color, ColorInput::vertex());
        assert!(
            warnings.contains("the black Kd of material \"m\" is left out beside the colors of"),
            "{warnings}"
        );
        let (scene, warnings) = of(&colored, "map_Kd grey.png\n");
        assert!(!scene.materials[0].base_color.vertex_color);
        assert!(warnings.contains("the colors of vertices are left out beside the map_Kd of"), "{warnings}");
        let white = colored.replace("1 0 0\n", "1 1 1\n");
        for lines in ["Kd .5 .5 .5\n", "map_Kd grey.png\n"] {
            let (scene, warnings) = of(&white, lines);
            assert!(!scene.materials[0].base_color.vertex_color && scene.objects[0].mesh.colors.is_empty());
            assert_eq!(warnings, "");
        }
    }

    #[test]
    fn mtl_black_beside_a_map_is_left_out_and_told_of() {
        let (scene, warnings) = loaded("Kd 0 0 0\nmap_Kd grey.png\n");
        assert_eq!(scene.materials[0].base_color.factor, Vec3::ONE);
        assert!(
            warnings.contains("the black Kd beside the map_Kd of material \"m\" is left out"),
            "{warnings}"
        );
        assert_eq!(material("Kd 0 0 0\n").base_color.factor, Vec3::ZERO);
    }

    #[test]
    fn mtl_loads_images_once_and_in_the_right_space() {
        let (scene, warnings) = loaded(
            "map_Kd -o .5 .25 -s 2 3 -clamp on blue ish.png\nmap_Pr grey.png\nmap_Pm grey.png\n\
             map_Bump -bm .5 blue ish.png\nmap_d grey.png\n",
        );
        assert_eq!(warnings, "");
        assert_eq!(scene.objects[0].material, 0);
        let m = &scene.materials[0];
        let spaces: Vec<_> = scene.images.iter().map(|image| image.color_space).collect();
        assert_eq!(spaces, [ColorSpace::Srgb, ColorSpace::Linear, ColorSpace::Linear]);
        let texture = m.base_color.texture.unwrap();
        assert_eq!(texture.coordinates(Vec2::ONE), Vec2::new(2.5, 3.25));
        assert_eq!(texture.wrap, [Wrap::Clamp; 2]);
        assert_eq!(m.specular_roughness.texture.unwrap().0.image, 1);
        assert_eq!(m.base_metalness.texture.unwrap().0.image, 1);
        assert_eq!(m.geometry_opacity.texture.unwrap().1, Channel::Red);
        let normals = m.geometry_normal.unwrap();
        assert_eq!((normals.texture.image, normals.scale), (2, 0.5));
    }

    #[test]
    fn mtl_of_parts_is_shared_by_name_and_every_part_has_one() {
        let (scene, _) =
            loaded_with(&format!("{TRIANGLE}usemtl gone\nf 1 2 3\no b\nf 1 2 3\n"), "newmtl m\n");
        let objects: Vec<_> =
            scene.objects.iter().map(|o| (o.name.as_str(), o.material, o.subsurface_group)).collect();
        assert_eq!(objects, [("a", 0, 0), ("a", 1, 0), ("b", 1, 1)]);
        assert_eq!(scene.materials.len(), 2);
    }

    #[test]
    fn mtl_warns_of_what_it_leaves_out() {
        for (lines, part) in [
            ("map_Kd gone.png\n", "a.mtl:2: the material is used without its image: "),
            ("map_Kd a.obj\n", "is not an image of a known format"),
            ("map_Kd\n", "a.mtl:2: the material is used without its image: "),
            ("bump grey.png\n", "a.mtl:2: \"grey.png\" is a height map"),
            ("disp grey.png\n", "a.mtl:2: disp has no counterpart"),
            ("Ps .5\n", "a.mtl:2: ps has no counterpart"),
            ("Pm .5\nKs .1 .1 .1\n", "Ks of material \"m\" is left out, as for metals"),
            ("Kd 2 0 0\n", "a.mtl:2: the value 2 is set to the nearest in [0, 1]"),
            ("Ni .1\n", "the value 0.1 is set to the nearest in [1, 4]"),
            ("Kd spectral a.rfl 1\n", "is not red, green, blue"),
        ] {
            let (scene, warnings) = loaded(lines);
            assert!(warnings.contains(part), "{warnings}: {part}");
            assert_eq!(scene.objects[0].material, 0);
            assert!(scene.materials[0].base_color.factor.max_element() <= 1.0);
        }
    }

    #[test]
    fn mtl_that_is_broken_is_refused_with_its_place() {
        for (lines, part) in [
            ("Kd 1 2", "a.mtl:2: \"1 2\" is not a color"),
            ("Kd", "a.mtl:2: \"\" is not a color"),
            ("\nKs 1 x 1", "a.mtl:3: \"1 x 1\" is not a color"),
            ("Ns nan", "a.mtl:2: \"nan\" is not a number"),
            ("Ni", "a.mtl:2: \"\" is not a number"),
            ("illum two", "a.mtl:2: illum is \"two\""),
        ] {
            let message = parsed(&format!("newmtl m\n{lines}\n")).unwrap_err().to_string();
            assert!(message.starts_with(part), "{message}: {part}");
        }
    }

    #[test]
    fn mtl_survives_any_mutation() {
        let text = "# Blender 5.3 MTL\nnewmtl a\nKd 1 .5 0\nKs .5 .5 .5\nNs 100\nNi 1.4\nd .5\nTf 1 1 1\nKe 1 2 3\nillum 7\nPr .5\n\
            map_Kd -s 1 2 3 -o 1 no.png\nnewmtl b\nmap_bump -bm 2 no.png\n";
        for mutant in mutants(text.as_bytes(), 3_000) {
            let materials = parse_mtl(
                &mutant,
                Path::new("no/a.mtl"),
                Beside { writer: Writer::of_library(&mutant, b""), has_colors: true },
                &mut ImagePool::default(),
                &mut Loading::unwatched(&mut Vec::new()),
            );
            for m in materials.into_iter().flatten() {
                assert!(m.base_color.factor.is_finite() && m.emission_color.factor.is_finite());
                assert!(
                    (1.0..=4.0).contains(&m.specular_ior) && (0.0..=1.0).contains(&m.geometry_opacity.factor)
                );
                assert!((0.0..=1.0).contains(&m.specular_roughness.factor));
            }
        }
    }
}
