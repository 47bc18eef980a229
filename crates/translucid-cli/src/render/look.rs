//! Options that turn a bare mesh, look at a scene and light it from around.

use std::path::PathBuf;

use clap::Args;
use translucid_load::{Floor, LoadOptions, MeshBase, Surroundings, UpAxis, Viewpoint};

/// The options.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Look {
    /// Axis of a bare mesh that points up: x, y, z, -x, -y or -z
    ///
    /// By default y, or the axis across the flat underside of a mesh other than glTF.
    #[arg(long, value_name = "AXIS", value_parser = parse_up, allow_hyphen_values = true)]
    up: Option<UpAxis>,
    /// Turn a bare mesh by degrees about x, y, then z, or y alone
    ///
    /// About its middle, once y is up.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_rotation, allow_hyphen_values = true)]
    rotate: Option<[f32; 3]>,
    /// Floor below a bare mesh: none, backdrop, shadow, #rrggbb or a grey
    ///
    /// A grey is in [0, 1]. By default backdrop if the file has neither camera nor light, else none.
    #[arg(long, value_name = "FLOOR", value_parser = parse_floor)]
    floor: Option<Floor>,
    /// Camera of a scene or glTF file, by name [default: the first]
    #[arg(long, value_name = "NAME", conflicts_with = "view")]
    camera: Option<String>,
    /// Side to look from: front, left, …, or degrees right and up
    ///
    /// front, back, left, right, top or bottom. The camera frames a bare mesh, and turns about its target in a scene.
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = parse_view, allow_hyphen_values = true)]
    view: Option<Viewpoint>,
    /// Enlarge things in the picture by this factor
    #[arg(long, value_name = "FACTOR", value_parser = parse_zoom, allow_negative_numbers = true)]
    zoom: Option<f32>,
    /// Image of the sky (.hdr, .exr, .png, .jpg)
    ///
    /// It replaces the scene's environment, or the lights of a bare mesh.
    #[arg(long, value_name = "FILE")]
    pub(super) environment: Option<PathBuf>,
    /// Turn the environment about y
    #[arg(long, value_name = "DEGREES", value_parser = parse_angle, allow_negative_numbers = true)]
    environment_rotation: Option<f32>,
    /// Brighten the environment by this factor
    #[arg(long, value_name = "FACTOR", value_parser = parse_strength, allow_negative_numbers = true)]
    environment_strength: Option<f32>,
}

impl Look {
    /// The loader's options with these.
    pub(crate) fn of(&self, options: LoadOptions) -> LoadOptions {
        LoadOptions {
            up: self.up,
            rotate: self.rotate.unwrap_or_default(),
            floor: self.floor,
            camera: self.camera.clone(),
            viewpoint: self.view,
            zoom: self.zoom,
            surroundings: Surroundings {
                file: self.environment.clone(),
                rotation: self.environment_rotation,
                strength: self.environment_strength,
            },
            ..options
        }
    }

    /// The keys of a scene file that extends the bare mesh, by these options; the rest becomes its camera, lights and
    /// environment.
    pub(crate) fn of_base(&self, base: MeshBase) -> MeshBase {
        // Without automatic lights there is no automatic floor either
        let floor = self.floor.or(self.environment.is_some().then_some(Floor::None));
        MeshBase { up: self.up, rotate: self.rotate.unwrap_or_default(), floor, viewpoint: self.view, ..base }
    }

    /// Whether a floor is made for one of a mesh's own cameras, which no scene file that extends the mesh can say.
    pub(crate) fn has_floor_of_camera(&self) -> bool {
        self.camera.is_some() && !matches!(self.floor, None | Some(Floor::None))
    }

    /// An option that is given and needs a mesh.
    pub(super) fn of_mesh(&self) -> Option<&'static str> {
        let given = [
            (self.up.is_some(), "--up"),
            (self.rotate.is_some(), "--rotate"),
            (self.floor.is_some(), "--floor"),
        ];
        given.into_iter().find(|(is_given, _)| *is_given).map(|(_, option)| option)
    }
}

fn parse_up(text: &str) -> Result<UpAxis, String> {
    UpAxis::from_name(text).ok_or_else(|| String::from("the axes are x, y, z, -x, -y and -z"))
}

/// A finite number in a range.
fn number(text: &str, low: f32, high: f32) -> Option<f32> {
    text.trim().parse().ok().filter(|value| (low..=high).contains(value))
}

fn parse_rotation(text: &str) -> Result<[f32; 3], String> {
    let angles: Option<Vec<f32>> = text.split(',').map(|text| number(text, -36_000.0, 36_000.0)).collect();
    match angles.as_deref() {
        Some(&[y]) => Ok([0.0, y, 0.0]),
        Some(&[x, y, z]) => Ok([x, y, z]),
        _ => Err(String::from("a rotation is X,Y,Z in degrees, or Y alone, each in [-36000, 36000]")),
    }
}

fn parse_floor(text: &str) -> Result<Floor, String> {
    Floor::from_text(text)
        .ok_or_else(|| String::from("a floor is none, backdrop, shadow, #rrggbb or a grey in [0, 1]"))
}

fn parse_view(text: &str) -> Result<Viewpoint, String> {
    Viewpoint::from_text(text).ok_or_else(|| {
        let names = Viewpoint::WORDS.map(|(name, _)| name).join(", ");
        format!("a view is one of {names}, or AZIMUTH,ELEVATION in degrees, the latter in [-90, 90]")
    })
}

fn parse_zoom(text: &str) -> Result<f32, String> {
    number(text, 0.01, 1000.0).ok_or_else(|| String::from("a zoom is a number in [0.01, 1000]"))
}

fn parse_angle(text: &str) -> Result<f32, String> {
    number(text, -36_000.0, 36_000.0).ok_or_else(|| String::from("an angle is in [-36000, 36000] degrees"))
}

fn parse_strength(text: &str) -> Result<f32, String> {
    number(text, 0.0, 1e9).ok_or_else(|| String::from("a strength is a number in [0, 1e9]"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_options_are_read_or_refused() {
        assert_eq!(parse_up("-z"), Ok(UpAxis::MinusZ));
        assert_eq!(parse_rotation("-30"), Ok([0.0, -30.0, 0.0]));
        assert_eq!(parse_rotation("1, 2,3"), Ok([1.0, 2.0, 3.0]));
        assert_eq!(parse_floor("shadow"), Ok(Floor::Shadow));
        assert_eq!(parse_floor("0.5"), Ok(Floor::Color([0.5; 3])));
        assert_eq!(parse_floor("#ff0000"), Ok(Floor::Color([1.0, 0.0, 0.0])));
        assert_eq!(parse_view("-30,15"), Ok(Viewpoint::of(-30.0, 15.0)));
        assert_eq!((parse_zoom("2"), parse_angle("-90"), parse_strength("0")), (Ok(2.0), Ok(-90.0), Ok(0.0)));
        assert!(parse_rotation("1,2").is_err() && parse_view("1,2,3").is_err());
        for wrong in ["", "1,2,3,4", "nan", "inf", "a", "1e9", "1,,2"] {
            assert!(parse_rotation(wrong).is_err() && parse_view(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "shadows", "#12345", "1.5", "-1", "nan", "floor"] {
            assert!(parse_floor(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "0", "-1", "nan", "inf", "1e9"] {
            assert!(parse_zoom(wrong).is_err(), "{wrong}");
        }
        assert!(parse_up("up").is_err() && parse_strength("-1").is_err() && parse_angle("nan").is_err());
    }
}
