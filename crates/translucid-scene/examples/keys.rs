//! Writes what follows from the descriptions of things: the tables of keys in `docs/guide/scene-files.md`, and the keyword
//! arguments in Python's stub.
//!
//! ```sh
//! cargo run -p translucid-scene --example keys
//! ```
//!
//! Tables go between the markers `<!-- keys: NAME -->` and `<!-- end of keys -->`, arguments between `# keys` and
//! `# end of keys`. The test of this example fails where they are out of date.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use translucid_profile::convention::{PresetGroup, presets};
use translucid_scene::description::{Fallback, Field, Key, SceneSlot, Slot, Thing};
use translucid_scene::{
    Camera, Environment, Film, Integrator, Light, Material, Object, SubsurfaceLayer, SubsurfaceModel,
};

fn main() -> ExitCode {
    let written = pages().and_then(|pages| {
        pages.into_iter().try_for_each(|(path, _, new)| std::fs::write(path, new).map_err(|e| e.to_string()))
    });
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            #[expect(clippy::print_stderr, reason = "a program")]
            {
                eprintln!("{error}");
            }
            ExitCode::FAILURE
        }
    }
}

/// Each file with its text as it is and as it must be.
fn pages() -> Result<Vec<(PathBuf, String, String)>, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |name: &str| {
        let path = root.join(name);
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{name}: {error}"))?;
        Ok::<_, String>((path, text))
    };
    let (guide, before) = read("docs/guide/scene-files.md")?;
    let mut after = before.clone();
    for (name, table) in [
        (
            "camera",
            table(Camera::DESCRIPTION.fields, (Camera::DESCRIPTION.plain)(), &[], &[Camera::NAME_KEY]),
        ),
        ("film", table(Film::DESCRIPTION.fields, Film::default(), &[], &[])),
        ("integrator", table(Integrator::DESCRIPTION.fields, Integrator::default(), &[], &[])),
        ("material", table(Material::DESCRIPTION.fields, Material::default(), Material::ORIGIN_KEYS, &[])),
        ("layer", layers()),
        ("object", table(&[], (), Object::KEYS, &[])),
        ("light", lights()),
        ("environment", table(Environment::DESCRIPTION.fields, Environment::default(), &[], &[])),
    ] {
        after = replaced(
            &after,
            &format!("<!-- keys: {name} -->\n"),
            "<!-- end of keys -->",
            &format!("\n{table}\n"),
        )?;
    }
    let (page, page_before) = read("docs/guide/presets.md")?;
    let mut page_after = page_before.clone();
    for group in PresetGroup::ALL {
        let word = group.name().split(' ').next().unwrap_or_default();
        page_after = replaced(
            &page_after,
            &format!("<!-- presets: {word} -->\n"),
            "<!-- end of presets -->",
            &format!("\n{}\n", preset_table(group)),
        )?;
    }
    let (stub, stub_before) = read("python/translucid/__init__.pyi")?;
    let stub_after = replaced(&stub_before, "# keys\n", "# end of keys\n", &arguments())?;
    Ok(vec![(guide, before, after), (page, page_before, page_after), (stub, stub_before, stub_after)])
}

/// A Markdown table of the presets of a group.
fn preset_table(group: PresetGroup) -> String {
    let mut table = String::from(
        "| name | A | ℓ [mm] | index | roughness | coat | source |\n|---|---|---|---|---|---|---|\n",
    );
    for preset in presets().iter().filter(|preset| preset.group == group) {
        let coat = match preset.coat {
            [0.0, _] => String::from("–"),
            [weight, roughness] => format!("{weight}, roughness {roughness}"),
        };
        let albedo = preset.surface_albedo().map(|a| format!("{a:.3}")).join(" ");
        let mfp = preset.mfp_in_millimeters().map(|mfp| format!("{mfp:.2}")).join(" ");
        let clear = if preset.clear_absorption().is_some() { " (clear)" } else { "" };
        let (name, eta, roughness, source) = (preset.name, preset.eta, preset.roughness, preset.source);
        // Writing to a string cannot fail.
        let _ = writeln!(
            table,
            "| `{name}`{clear} | {albedo} | {mfp} | {eta} | {roughness} | {coat} | {source} |"
        );
    }
    table
}

/// A text with something else between two markers.
fn replaced(text: &str, begin: &str, end: &str, new: &str) -> Result<String, String> {
    let missing = || format!("there is no {:?} … {:?}", begin.trim_end(), end.trim_end());
    let (head, rest) = text.split_once(begin).ok_or_else(missing)?;
    let (_, tail) = rest.split_once(end).ok_or_else(missing)?;
    Ok(format!("{head}{begin}{new}{end}{tail}"))
}

/// A Markdown table of keys: those that stand before and after the fields', which stand by the first word of their names.
fn table<T>(fields: &[Field<T>], mut plain: T, before: &[Key], after: &[Key]) -> String {
    let mut rows: Vec<(&str, String)> = Vec::new();
    for field in fields {
        for key in field.keys {
            rows.push((key.name, row(key, (field.slot)(&mut plain), field.keys)));
        }
    }
    let group = |name: &str| {
        let word = name.split('_').next();
        rows.iter().position(|(other, _)| other.split('_').next() == word)
    };
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by_key(|&i| group(rows[i].0));
    let mut text = String::from("| key | value | default |\n|---|---|---|\n");
    before.iter().for_each(|key| text += &row(key, SceneSlot::Absent, &[]));
    order.into_iter().for_each(|i| text += &rows[i].1);
    after.iter().for_each(|key| text += &row(key, SceneSlot::Absent, &[]));
    text
}

fn layers() -> String {
    let mut text = String::from("| key | value | default |\n|---|---|---|\n");
    for field in SubsurfaceLayer::fields() {
        let mut plain = SubsurfaceLayer::plain_of(field.key());
        text += &row(&field.keys[0], (field.slot)(&mut plain), field.keys);
    }
    text
}

fn row(key: &Key, slot: SceneSlot<'_>, keys: &'static [Key]) -> String {
    let doc = key.doc.replace("{range}", &range(&slot)).replace("{words}", &words(&slot).join(", "));
    let default = match key.fallback {
        Fallback::Required => String::from("must be given"),
        Fallback::Number(x) => x.to_string(),
        Fallback::Words(words) => words.to_owned(),
        Fallback::Plain => {
            let value = slot
                .write(keys, [0.0; 3])
                .first()
                .map_or(String::new(), |entry| format!("{:#}", entry.value));
            if value.parse::<f64>().is_ok() { value } else { format!("`{value}`") }
        }
    };
    format!("| `{}` | {doc} | {default} |\n", key.name)
}

fn range(slot: &SceneSlot<'_>) -> String {
    match slot {
        SceneSlot::Number(_, range)
        | SceneSlot::Length(_, range)
        | SceneSlot::Angle(_, range)
        | SceneSlot::Pair(_, range)
        | SceneSlot::Scalar(_, range)
        | SceneSlot::Rgb(_, range)
        | SceneSlot::Triple(_, range)
        | SceneSlot::Color(_, range) => format!("in {range}"),
        SceneSlot::Count(_, range) => range.to_string(),
        SceneSlot::Size(_, range) => format!("in [{}, {}]", range.low, range.high),
        _ => String::new(),
    }
}

/// The words of a slot as a scene file has them.
fn words(slot: &SceneSlot<'_>) -> Vec<String> {
    match slot {
        SceneSlot::Word(word) => word.names().iter().map(|name| format!("`\"{name}\"`")).collect(),
        _ => Vec::new(),
    }
}

fn lights() -> String {
    let mut text = String::new();
    let mut last: Vec<&str> = Vec::new();
    for kind in Light::KINDS {
        let Thing { name, doc, .. } = kind;
        if kind.keys() == last {
            let _ = writeln!(text, "`\"{name}\"` {doc}; its keys are the same.\n");
            continue;
        }
        last = kind.keys();
        let _ = writeln!(text, "`\"{name}\"` {doc}:\n\n{}", table(kind.fields, (kind.plain)(), &[], &[]));
    }
    text.trim_end().to_owned() + "\n"
}

/// The keyword arguments of each thing as a dictionary with types.
fn arguments() -> String {
    let mut text = String::new();
    let material: Vec<(&str, String)> =
        Material::ORIGIN_KEYS[1..].iter().map(|key| (key.name, python_path(key.name))).collect();
    text += &class("_MaterialKeys", material.into_iter().chain(types(&Material::DESCRIPTION)));
    text += &class("_LightKeys", Light::KINDS.into_iter().flat_map(types));
    text += &class("_EnvironmentKeys", types(&Environment::DESCRIPTION));
    text += &class("_CameraKeys", types(&Camera::DESCRIPTION));
    text += &class("_FilmKeys", types(&Film::DESCRIPTION));
    text += &class("_IntegratorKeys", types(&Integrator::DESCRIPTION));
    let kinds = Light::KINDS.map(|kind| format!("\"{}\"", kind.name)).join(", ");
    let _ = writeln!(text, "_LightType: TypeAlias = Literal[{kinds}]");
    text
}

fn class<'a>(name: &str, keys: impl IntoIterator<Item = (&'a str, String)>) -> String {
    let mut text = format!("class {name}(TypedDict, total=False):\n");
    let mut seen = Vec::new();
    for (key, of) in keys {
        if !seen.contains(&key) {
            seen.push(key);
            let _ = writeln!(text, "    {key}: {of} | None");
        }
    }
    text + "\n"
}

/// Every key of a thing with its type in Python.
fn types<T>(thing: &Thing<T>) -> Vec<(&'static str, String)> {
    let mut plain = (thing.plain)();
    let mut all = Vec::new();
    for field in thing.fields {
        let slot = (field.slot)(&mut plain);
        let names = field.keys.iter().map(|key| key.name);
        let literal = |names: &[&str]| {
            format!(
                "Literal[{}]",
                names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
            )
        };
        let of = match &slot {
            SceneSlot::Flag(_) => "bool",
            SceneSlot::Count(..) | SceneSlot::Seed(_) => "int",
            SceneSlot::Number(..) | SceneSlot::Length(..) | SceneSlot::Angle(..) => "float",
            SceneSlot::Radiance(_) | SceneSlot::Power(_) => "_Color",
            SceneSlot::Scalar(..) => "_Scalar | dict[str, Any]",
            SceneSlot::Color(..) => "_Color | dict[str, Any]",
            SceneSlot::NormalMap(_) => "_Path | ArrayLike | dict[str, Any]",
            SceneSlot::Image(_) => "_Path | ArrayLike",
            SceneSlot::Word(word) => &literal(&word.names()),
            SceneSlot::Projection(_) => {
                all.extend([("projection", literal(&["perspective", "orthographic"]))]);
                all.extend(["fov", "width"].map(|key| (key, String::from("float"))));
                continue;
            }
            SceneSlot::Rotation(_) => {
                all.extend(
                    [("rotation", "float"), ("matrix", "ArrayLike")].map(|(key, of)| (key, of.to_owned())),
                );
                continue;
            }
            SceneSlot::Layers(_) => "Sequence[dict[str, Any]] | Literal[\"none\"]",
            SceneSlot::Model(_) => {
                all.push(("subsurface_model", literal(&SubsurfaceModel::ALL.map(SubsurfaceModel::name))));
                all.push(("subsurface_table", String::from("_Path")));
                continue;
            }
            _ => "ArrayLike",
        };
        all.extend(names.map(|name| (name, of.to_owned())));
    }
    all
}

/// The type of a key that says where a material is from.
fn python_path(key: &str) -> String {
    String::from(match key {
        "file" => "_Path",
        "file_unit" => "_Unit",
        _ => "str",
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn guide_and_stub_are_up_to_date() {
        for (path, before, after) in super::pages().unwrap() {
            let path = path.display();
            assert!(
                before == after,
                "{path} is out of date: run cargo run -p translucid-scene --example keys"
            );
        }
    }
}
