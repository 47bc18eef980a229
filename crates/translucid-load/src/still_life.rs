//! The scene that is rendered when none is given.

use translucid_scene::Scene;

use crate::result::Result;
use crate::{LoadOptions, SceneFile};

/// The built-in still life: a marble bust, fruit, milk in a glass, a candle and toys by a window.
///
/// It is `scenes/still-life.toml` of this crate, made of built-in shapes; of the options `size` and
/// `subsurface_model` apply to it.
///
/// # Errors
/// An option is for mesh files, of which the still life has none.
///
/// ```
/// let scene = translucid_load::still_life(&Default::default())?;
/// assert!(scene.objects.iter().any(|object| object.name == "bust"));
/// # Ok::<(), translucid_scene::SceneError>(())
/// ```
pub fn still_life(options: &LoadOptions) -> Result<Scene> {
    SceneFile::still_life()?.load(options, &mut Vec::new())
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn height_range(scene: &Scene, name: &str) -> [f32; 2] {
        let object = scene.objects.iter().find(|object| object.name == name).expect(name);
        let ys = || object.mesh.positions.iter().map(|p| p.y);
        [ys().fold(f32::MAX, f32::min), ys().fold(f32::MIN, f32::max)]
    }

    #[test]
    fn still_life_loads_without_warning() {
        let file = SceneFile::still_life().expect("valid");
        let mut warnings = Vec::new();
        let scene = file.load(&LoadOptions::default(), &mut warnings).expect("valid");
        assert_eq!(warnings, []);
        assert_eq!([scene.film.width, scene.film.height], [960, 540]);
        assert!(scene.images.is_empty(), "the still life must not need files");
    }

    /// Things on the table touch it: they neither float nor sink in by more than 0.5 mm.
    #[test]
    fn still_life_stands_on_its_table() {
        let scene = still_life(&LoadOptions::default()).expect("valid");
        assert_eq!(height_range(&scene, "table")[1], 0.0);
        for name in
            ["bust", "apple", "pear", "orange", "orange half", "grapes", "glass", "candle", "duck", "brick"]
        {
            let [low, _] = height_range(&scene, name);
            assert!(low.abs() < 0.05, "{name} is {low} cm above the table");
        }
    }

    #[test]
    fn still_life_is_in_the_picture() {
        let scene = still_life(&LoadOptions::default()).expect("valid");
        let camera = scene.camera;
        let forward = (camera.target - camera.position).normalize();
        let right = forward.cross(camera.up).normalize();
        let up = right.cross(forward);
        let tangent = camera.projection.width_at(0.5) as f32;
        let aspect = scene.film.width as f32 / scene.film.height as f32;
        let is_seen = |p: Vec3| {
            let offset = p - camera.position;
            let depth = offset.dot(forward) * tangent;
            offset.dot(right).abs() < depth && offset.dot(up).abs() * aspect < depth
        };
        for name in [
            "bust",
            "apple",
            "pear",
            "orange",
            "orange half",
            "grapes",
            "glass",
            "candle",
            "flame",
            "duck",
            "brick",
        ] {
            let object = scene.objects.iter().find(|object| object.name == name).expect(name);
            assert!(object.mesh.positions.iter().all(|&p| is_seen(p)), "{name} is cut off");
        }
    }
}
