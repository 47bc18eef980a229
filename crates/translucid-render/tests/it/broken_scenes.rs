//! Scenes made in code with one broken value: refused with its place, or rendered; never a panic.

use translucid_render::PreparedScene;
use translucid_testing::is_thorough;
use translucid_workbench::{BrokenScene, broken_scenes, scene_of_everything};

use crate::common::render;

/// One of so many sound scenes is prepared and rendered by default, for preparing takes a tenth of a second.
const RENDERED: usize = 48;

#[test]
fn scene_with_any_value_changed_is_refused_or_rendered() {
    let (mut refused, mut sound) = (0, 0);
    for BrokenScene { place, change, is_invalid, scene } in broken_scenes(&scene_of_everything()) {
        let film = scene.film;
        if let Err(error) = scene.validate() {
            // The renderer is no less strict with a scene
            let own = PreparedScene::new(scene).err().expect("as the scene says");
            assert_eq!(own.to_string(), error.to_string());
            refused += 1;
            continue;
        }
        assert!(!is_invalid, "{place} = {change} is accepted");
        sound += 1;
        if !is_thorough() && sound % RENDERED != 0 {
            continue;
        }
        let prepared = PreparedScene::new(scene).expect("the scene is valid");
        let mut sums = translucid_render::FilmSums::new(film.width.min(64), film.height.min(64));
        if (film.width, film.height) == (sums.width, sums.height) {
            render(&prepared, &mut sums, 1);
            let all = sums.tiles.iter().flat_map(|tile| tile.pixels()).flatten();
            assert!(all.clone().all(|sum| sum.is_finite()), "{place} = {change}");
        }
    }
    assert!(refused > 1000 && sound > 300, "{refused} refused, {sound} sound");
}
