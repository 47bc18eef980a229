//! The inputs of a shader as parameters of a material.

use glam::Vec3;
use roxmltree::Node;
use translucid_profile::nearest;
use translucid_scene::description::SceneSlot;
use translucid_scene::{ColorInput, Interval, Material, NormalMap, ScalarInput, Unit};

use super::document::{Kind, shown, title};
use super::graph::{Graph, Signal};
use super::model::{ShadingModel, Together, numbers};
use crate::result::Result;

/// Luminance of a radiance of 1 W/(sr m²) \[cd/m²\], as for the lamps of glTF files.
const LUMENS_PER_WATT: f32 = 683.0;

/// Parameters that are lengths, by our names.
const LENGTHS: [&str; 2] = ["subsurface_radius", "transmission_depth"];

/// Units of the lengths that a material is to have.
#[derive(Clone, Copy, Debug)]
pub(super) struct LengthUnits {
    /// The scene's.
    pub(super) of_scene: Unit,
    /// Unit of lengths that state none, if it is known.
    pub(super) stated: Option<Unit>,
}

impl LengthUnits {
    /// The length of a number with this unit \[mm\], in units of the scene.
    fn factor(&self, unit: Option<f64>) -> f32 {
        let unit = unit.unwrap_or(self.stated.unwrap_or(self.of_scene).in_millimeters());
        (unit / self.of_scene.in_millimeters()) as f32
    }
}

/// Reads a shader.
pub(super) fn read_shader<'d>(
    graph: &mut Graph<'_, 'd>,
    shader: Node<'d, 'd>,
    model: &ShadingModel,
    units: LengthUnits,
) -> Result<Material> {
    let mut reader = Reader {
        material: (model.defaults)(shader),
        together: Together::new(),
        without_unit: LENGTHS.to_vec(),
        model,
        shader,
        units,
    };
    for element in shader.children().filter(Node::is_element) {
        match (element.tag_name().name(), element.attribute("name")) {
            // One of two with a name is refused by their scope
            ("input", Some(name)) if graph.source.child(shader, Kind::Input, name)?.is_some() => {
                reader.read(graph, element, name)?;
            }
            _ => graph.source.warn(element, format!("{} of {} is left out", title(element), title(shader))),
        }
    }
    (model.translate)(&mut reader.material, &reader.together, &|message| {
        graph.source.warn(shader, format!("{}: {message}", title(shader)));
    });
    reader.finish(graph);
    Ok(reader.material)
}

struct Reader<'m, 'd> {
    material: Material,
    /// Inputs that become parameters only together with others.
    together: Together,
    model: &'m ShadingModel,
    shader: Node<'d, 'd>,
    units: LengthUnits,
    /// Lengths for which no unit has been found.
    without_unit: Vec<&'static str>,
}

impl<'d> Reader<'_, 'd> {
    fn read(&mut self, graph: &mut Graph<'_, 'd>, input: Node<'d, 'd>, name: &str) -> Result<()> {
        if let Some(&name) = self.model.together.iter().find(|other| **other == name) {
            self.together.extend(graph.read(self.shader, input)?.map(|signal| (name, signal)));
            return Ok(());
        }
        if self.model.has_thin_walls(name) {
            self.material.geometry_thin_walled = graph.flag(self.shader, input, name)?;
            return Ok(());
        }
        match self.model.parameter(name) {
            Some("geometry_normal") => self.read_normal(graph, input),
            Some(parameter) => match graph.read(self.shader, input)? {
                Some(signal) => self.set(graph, input, parameter, signal),
                None => Ok(()),
            },
            None => {
                self.tell_of_loss(graph, input, name);
                Ok(())
            }
        }
    }

    /// Says that an input is not translated, if it would change something.
    fn tell_of_loss(&self, graph: &Graph<'_, 'd>, input: Node<'d, 'd>, name: &str) {
        let place = format!("{}, {}", title(self.shader), shown(name));
        if self.model.silent.contains(&name) {
            return;
        }
        let Some((_, neutral)) = self.model.lost.iter().find(|(lost, _)| *lost == name) else {
            let near = nearest(name, self.model.inputs());
            let advice = near.map_or(String::new(), |near| format!(": did you mean {near}?"));
            return graph.source.warn(input, format!("{place} is no input that is known: left out{advice}"));
        };
        let words = |text: &str| -> Vec<String> {
            let word = |word: &str| word.parse::<f32>().map_or(word.trim().to_owned(), |x| x.to_string());
            text.split(',').map(|part| word(part.trim())).collect()
        };
        let is_connected =
            ["nodename", "nodegraph", "interfacename", "output"].iter().any(|key| input.has_attribute(*key));
        let changes = match input.attribute("value") {
            _ if is_connected => true,
            Some(value) => words(value) != words(neutral),
            None => false,
        };
        if changes {
            graph.source.warn(input, format!("{place} has no counterpart here: left out"));
        }
    }

    /// Sets a parameter.
    fn set(
        &mut self,
        graph: &Graph<'_, 'd>,
        input: Node<'d, 'd>,
        name: &'static str,
        mut signal: Signal,
    ) -> Result<()> {
        let Some(parameter) = numbers().find(|parameter| parameter.key() == name) else { return Ok(()) };
        if name == "geometry_opacity" && signal.channels == 3 {
            signal = red_alone(graph, input, signal);
        }
        let is_photometric = name == "emission_luminance" && self.model.is_photometric;
        let scale = match signal.unit {
            unit if LENGTHS.contains(&name) => {
                if unit.is_some() {
                    self.without_unit.retain(|other| *other != name);
                }
                self.units.factor(unit)
            }
            Some(_) => {
                graph.source.warn(input, format!("{} is no length: its unit is left out", graph.reading));
                1.0
            }
            None if is_photometric => LUMENS_PER_WATT.recip(),
            None => 1.0,
        };
        signal.factor.iter_mut().for_each(|number| *number *= scale);
        let slot = (parameter.slot)(&mut self.material);
        let channels = if matches!(slot, SceneSlot::Color(..)) { 3 } else { 1 };
        if signal.channels != channels && (signal.channels, channels) != (4, 3) {
            let types = if channels == 3 { "a color3" } else { "a float" };
            let message = format!("{} has {} channels, but must be {types}", graph.reading, signal.channels);
            return Err(graph.source.error(input, message));
        }
        let within = |number: f32, range: Interval| {
            let nearest = range.nearest(number);
            if nearest != number {
                let message = format!("is {number}, but must be in {range}: it becomes {nearest}");
                graph.source.warn(input, format!("{} {message}", graph.reading));
            }
            nearest
        };
        let [number, ..] = signal.factor;
        match (slot, signal.texture) {
            (SceneSlot::Number(slot, range) | SceneSlot::Length(slot, range), None) => {
                *slot = within(number, range);
            }
            (SceneSlot::Number(..) | SceneSlot::Length(..), Some(_)) => {
                graph.give_up(input, "it may not vary over the surface here, but has an image")?;
            }
            (SceneSlot::Scalar(slot, range), None) => *slot = ScalarInput::constant(within(number, range)),
            (SceneSlot::Scalar(slot, _), Some(texture)) => {
                let factor = within(number, ScalarInput::TEXTURED);
                *slot = ScalarInput { factor, texture: Some((texture, signal.channel)) };
            }
            (SceneSlot::Color(slot, range), texture) => {
                let range = if texture.is_some() { ColorInput::TEXTURED } else { range };
                let factor =
                    Vec3::from_array(signal.color().to_array().map(|channel| within(channel, range)));
                *slot = ColorInput { factor, texture, vertex_color: false };
            }
            _ => {}
        }
        Ok(())
    }

    /// Reads a map of normals behind a node normalmap.
    fn read_normal(&mut self, graph: &mut Graph<'_, 'd>, input: Node<'d, 'd>) -> Result<()> {
        graph.reading = format!("{}, {}", title(self.shader), input.attribute("name").unwrap_or_default());
        let Some(node) = graph.node_behind(input)? else { return Ok(()) };
        if node.tag_name().name() == "gltf_normalmap" {
            let image = graph.gltf_image(node, "vector3")?;
            let texture = image.and_then(|image| image.texture);
            self.material.geometry_normal = texture.map(|texture| NormalMap { texture, scale: 1.0 });
            return Ok(());
        }
        if node.tag_name().name() != "normalmap" {
            return graph.give_up(node, &format!("{} is no normalmap", title(node))).map(drop);
        }
        let scale = graph.input(node, "scale")?;
        match (graph.input(node, "in")?, scale) {
            (Some(Signal { texture: Some(texture), .. }), None) => {
                self.material.geometry_normal = Some(NormalMap { texture, scale: 1.0 });
            }
            (
                Some(Signal { texture: Some(texture), .. }),
                Some(Signal { texture: None, channels: 1, factor, .. }),
            ) => {
                let scale = NormalMap::SCALE.nearest(factor[0]);
                if scale != factor[0] {
                    let (range, found) = (NormalMap::SCALE, factor[0]);
                    let message = format!("scale is {found}, but must be in {range}: it becomes {scale}");
                    graph.source.warn(node, format!("{}: {message}", graph.reading));
                }
                self.material.geometry_normal = Some(NormalMap { texture, scale });
            }
            _ => drop(graph.give_up(node, &format!("{} is not an image times a constant", title(node)))?),
        }
        Ok(())
    }

    /// Says what lengths without a unit were taken for.
    fn finish(&self, graph: &Graph<'_, 'd>) {
        let Material { subsurface_weight, transmission_weight, transmission_depth, .. } = self.material;
        let counts = |name: &&&str| match **name {
            "subsurface_radius" => subsurface_weight.factor > 0.0,
            _ => transmission_weight.factor > 0.0 && transmission_depth > 0.0,
        };
        let names: Vec<&str> = self.without_unit.iter().filter(counts).copied().collect();
        if names.is_empty() || self.units.stated.is_some() {
            return;
        }
        let inputs: Vec<&str> = names.iter().map(|name| self.own_name(name)).collect();
        let unit = self.units.of_scene.name();
        let message = format!(
            "{}, {} without a unit: taken in the scene's, {unit} (file_unit in the material says another)",
            title(self.shader),
            inputs.join(" and ")
        );
        graph.source.warn(self.shader, message);
    }

    /// The name that the shader has for a parameter.
    fn own_name(&self, parameter: &'static str) -> &'static str {
        self.model.renamed.iter().find(|(_, ours)| *ours == parameter).map_or(parameter, |(name, _)| *name)
    }
}

/// The red channel of an opacity of three, as MaterialX's own translation to OpenPBR has it.
fn red_alone<'d>(graph: &Graph<'_, 'd>, input: Node<'d, 'd>, signal: Signal) -> Signal {
    let [r, g, b, _] = signal.factor;
    if signal.texture.is_some() || r != g || g != b {
        let message = format!("{} has three channels: red counts for all", graph.reading);
        graph.source.warn(input, message);
    }
    Signal { channels: 1, ..signal }
}
