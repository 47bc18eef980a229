//! Values that inputs have: constants, and images through the nodes that can be translated.
//!
//! | node | what becomes of it |
//! |---|---|
//! | constant, dot, convert | the value |
//! | image, tiledimage, gltf_image, gltf_colorimage | an image |
//! | multiply | an image or constant times a constant |
//! | extract, separate2, separate3, separate4 | a channel |
//! | swizzle, and the attribute `channels` of a connection, of MaterialX up to 1.38 | channels of a constant in another order, or one of an image |
//! | texcoord, geompropvalue, place2d | the mapping of an image |
//! | normalmap | a map of normals |
//!
//! Others get a warning, and the input keeps its default.

use std::path::{Path, PathBuf};

use glam::{Affine2, Mat2, Vec2, Vec3};
use roxmltree::{Node, NodeId};
use translucid_scene::description::{FileList, FileRequest};
use translucid_scene::{Channel, ColorSpace, ImageKind, SceneError, TextureFilter, TextureRef, Wrap};

use super::color_space::NamedSpace;
use super::document::{Kind, Source, inherited, shown, title};
use super::unit;
use crate::result::Result;

/// Most nodes that feed each other in a row.
const LONGEST_CHAIN: usize = 128;
/// Most nodes behind an input, each counted as often as it is used.
const MOST_STEPS: usize = 4096;

/// The value of an input.
#[derive(Clone, Copy, Debug)]
pub(super) struct Signal {
    /// Numbers of the type: 1 for a float, 3 for a color.
    pub(super) channels: usize,
    /// The constant, or the factor on the image.
    pub(super) factor: [f32; 4],
    pub(super) texture: Option<TextureRef>,
    /// Channel of the image that a single number reads.
    pub(super) channel: Channel,
    /// Unit of the numbers \[mm\], if they have one.
    pub(super) unit: Option<f64>,
}

impl Signal {
    /// The three channels of a color.
    pub(super) fn color(&self) -> Vec3 {
        let [r, g, b, _] = self.factor;
        Vec3::new(r, g, b)
    }

    /// The value without its channel's number: a float.
    fn single(self, index: usize) -> Self {
        let channel = [Channel::Red, Channel::Green, Channel::Blue, Channel::Alpha][index];
        Self { channels: 1, factor: [self.factor[index]; 4], channel, ..self }
    }
}

/// A signal, or nothing where a warning has been given.
type Found = Result<Option<Signal>>;

/// The origin of an input.
enum Origin<'d> {
    /// An element with a value, which may be an input of a graph's interface.
    Value(Node<'d, 'd>, &'d str),
    /// A node, and the name of its output.
    Node(Node<'d, 'd>, Option<&'d str>),
    Nothing,
}

/// Reads inputs of one shader.
pub(super) struct Graph<'s, 'd> {
    pub(super) source: &'s Source<'d>,
    /// Folder that paths are relative to.
    pub(super) folder: PathBuf,
    pub(super) files: FileList,
    /// The shader's input that is being read, for messages.
    pub(super) reading: String,
    /// Nodes between that input and the one at hand.
    chain: Vec<NodeId>,
    steps: usize,
}

impl<'s, 'd> Graph<'s, 'd> {
    pub(super) fn new(source: &'s Source<'d>, path: &Path) -> Self {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Self {
            source,
            folder,
            files: FileList::default(),
            reading: String::new(),
            chain: Vec::new(),
            steps: 0,
        }
    }

    /// The letters by which an element chooses channels of its value, in documents of MaterialX up to 1.38; in others they
    /// mean nothing, which adds a warning.
    fn channels(&self, element: Node<'d, 'd>) -> Option<&'d str> {
        let letters = element.attribute("channels")?;
        let version = self.source.document.root_element().attribute("version").unwrap_or("1.0");
        let minor = version.strip_prefix("1.").and_then(|minor| minor.parse::<u32>().ok());
        if minor.is_some_and(|minor| minor < 39) {
            return Some(letters);
        }
        self.tell_of_channels(element, letters, "it is of MaterialX up to 1.38");
        None
    }

    fn tell_of_channels(&self, element: Node<'d, 'd>, letters: &str, reason: &str) {
        let message = format!("{}: channels \"{}\" is left out: {reason}", self.reading, shown(letters));
        self.source.warn(element, message);
    }

    /// The value of an input of a shader; none if it has none, or (with a warning) one that cannot be translated.
    pub(super) fn read(&mut self, shader: Node<'d, 'd>, input: Node<'d, 'd>) -> Found {
        self.reading = format!("{}, {}", title(shader), shown(input.attribute("name").unwrap_or_default()));
        (self.chain, self.steps) = (Vec::new(), 0);
        self.signal(input)
    }

    /// The node that an input of a shader is connected to.
    pub(super) fn node_behind(&self, input: Node<'d, 'd>) -> Result<Option<Node<'d, 'd>>> {
        Ok(match self.origin(input)? {
            Origin::Node(node, _) => Some(node),
            _ => None,
        })
    }

    /// An error of what is being read.
    fn error(&self, element: Node<'_, '_>, message: &str) -> SceneError {
        self.source.error(element, format!("{}: {message}", self.reading))
    }

    /// Says that what is being read cannot be translated.
    pub(super) fn give_up(&self, element: Node<'_, '_>, reason: &str) -> Found {
        self.source.warn(element, format!("{} keeps its default: {reason}", self.reading));
        Ok(None)
    }

    /// The origin of an input that is no value of its own, whose channels keep their order.
    fn origin(&self, from: Node<'d, 'd>) -> Result<Origin<'d>> {
        let (origin, choices) = self.origin_and_channels(from)?;
        for (element, letters) in choices {
            self.tell_of_channels(element, letters, "it has no counterpart here");
        }
        Ok(origin)
    }

    /// Follows the references of an input, out of a graph's interface and into graphs; with the elements on the way that
    /// choose channels.
    fn origin_and_channels(&self, from: Node<'d, 'd>) -> Result<(Origin<'d>, Vec<(Node<'d, 'd>, &'d str)>)> {
        // An element's references are of the scope around the node whose input it is
        let (mut element, mut scope) = (from, scope_of(scope_of(from)));
        let mut choices = Vec::new();
        for _ in 0..LONGEST_CHAIN {
            choices.extend(self.channels(element).map(|letters| (element, letters)));
            if let Some(name) = element.attribute("interfacename") {
                element = self.source.referred(element, scope, Kind::Input, name)?;
                scope = scope_of(scope);
                continue;
            }
            let output = element.attribute("output");
            let node = element.attribute("nodegraph").or_else(|| element.attribute("nodename"));
            let Some(name) = node else {
                if let Some(value) = element.attribute("value") {
                    return Ok((Origin::Value(element, value), choices));
                }
                let Some(name) = output else { return Ok((Origin::Nothing, choices)) };
                element = self.source.referred(element, scope, Kind::Output, name)?;
                continue;
            };
            let node = self.source.referred(element, scope, Kind::Node, name)?;
            if node.tag_name().name() != "nodegraph" {
                return Ok((Origin::Node(node, output), choices));
            }
            element = match output {
                Some(name) => self.source.referred(element, node, Kind::Output, name)?,
                None => {
                    let mut outputs = node.children().filter(|child| child.has_tag_name("output"));
                    match (outputs.next(), outputs.next()) {
                        (Some(only), None) => only,
                        _ => {
                            let message =
                                format!("{} does not have one output, so one must be named", title(node));
                            return Err(self.error(element, &message));
                        }
                    }
                }
            };
            scope = node;
        }
        Err(self.error(from, &format!("more than {LONGEST_CHAIN} references in a row, or in a circle")))
    }

    fn signal(&mut self, input: Node<'d, 'd>) -> Found {
        let (origin, choices) = self.origin_and_channels(input)?;
        let found = match origin {
            Origin::Value(element, value) => self.constant(element, value).map(Some),
            Origin::Node(node, output) => self.entered(input, node, |graph| graph.node_signal(node, output)),
            Origin::Nothing => {
                if input.has_attribute("defaultgeomprop") {
                    return Ok(None);
                }
                self.give_up(input, "it has neither a value nor a connection")
            }
        };
        choices.into_iter().rev().try_fold(found?, |found, (element, letters)| match found {
            Some(signal) => self.swizzled(element, letters, signal),
            None => Ok(None),
        })
    }

    /// The channels of a value that letters choose, as MaterialX 1.39 converts them: r g b a or x y z w, 0 and 1.
    fn swizzled(&self, element: Node<'d, 'd>, letters: &str, signal: Signal) -> Found {
        let [r, g, b, a] = signal.factor;
        let values = [r, g, b, a, 0.0, 1.0];
        let number = |letter: char| {
            let number = "rgba01".find(letter).or_else(|| "xyzw".find(letter))?;
            Some(number).filter(|&number| number < signal.channels || number >= 4)
        };
        let numbers: Option<Vec<usize>> = letters.chars().take(5).map(number).collect();
        let kind = element.attribute("type").unwrap_or("");
        let Some(numbers) = numbers.filter(|numbers| channels_of(kind) == Some(numbers.len())) else {
            let must_be = format!(
                "the letters of channels of {} numbers, as many as a {}",
                signal.channels,
                shown(kind)
            );
            let message = format!("channels is \"{}\", but must be {must_be} has", shown(letters));
            return Err(self.error(element, &message));
        };
        let mut factor = [0.0; 4];
        match numbers[..] {
            [single] if signal.texture.is_none() || single < 4 && signal.channels > 1 => {
                let channels = [Channel::Red, Channel::Green, Channel::Blue, Channel::Alpha];
                let channel = channels.get(single).copied().unwrap_or(signal.channel);
                return Ok(Some(Signal { channels: 1, factor: [values[single]; 4], channel, ..signal }));
            }
            _ => factor.iter_mut().zip(&numbers).for_each(|(factor, &number)| *factor = values[number]),
        }
        let is_in_order = numbers.iter().enumerate().all(|(i, &number)| i == number);
        if signal.texture.is_some() && !is_in_order {
            let reason = format!("channels \"{}\" changes the order of an image's", shown(letters));
            return self.give_up(element, &reason);
        }
        Ok(Some(Signal { channels: numbers.len(), factor, ..signal }))
    }

    /// The result of `read` for a node that does not feed itself.
    fn entered<T>(
        &mut self,
        from: Node<'d, 'd>,
        node: Node<'d, 'd>,
        read: impl FnOnce(&mut Self) -> Result<T>,
    ) -> Result<T> {
        self.steps += 1;
        if self.chain.contains(&node.id()) {
            return Err(self.error(from, &format!("{} feeds itself, over others or at once", title(node))));
        }
        if self.chain.len() >= LONGEST_CHAIN || self.steps > MOST_STEPS {
            let most = format!("{LONGEST_CHAIN} nodes in a row and {MOST_STEPS} in all are allowed");
            return Err(self.error(from, &format!("too many nodes lie behind it: {most}")));
        }
        self.chain.push(node.id());
        let found = read(self);
        self.chain.pop();
        found
    }

    /// A constant in linear Rec. 709 if it is a color.
    fn constant(&mut self, element: Node<'d, 'd>, value: &str) -> Result<Signal> {
        let kind = element.attribute("type").unwrap_or("");
        let channels = channels_of(kind);
        let must_be = match channels {
            Some(1) => String::from("a finite number"),
            Some(count) => format!("{count} finite numbers ({kind})"),
            None => format!("of a type with numbers, not {}", shown(kind)),
        };
        let wrong = || {
            let part = if element.attribute("name") == Some("value") { "value" } else { "it" };
            self.error(element, &format!("{part} is \"{}\", but must be {must_be}", shown(value)))
        };
        let numbers = numbers(value).filter(|numbers| Some(numbers.len()) == channels).ok_or_else(wrong)?;
        let mut factor = [0.0; 4];
        match numbers[..] {
            [single] => factor = [single; 4],
            _ => factor[..numbers.len()].copy_from_slice(&numbers),
        }
        if kind.starts_with("color") {
            let [r, g, b, a] = factor;
            let [r, g, b] = self.managed(element, Vec3::new(r, g, b)).to_array();
            factor = [r, g, b, a];
        }
        Ok(Signal {
            channels: numbers.len(),
            factor,
            texture: None,
            channel: Channel::Red,
            unit: self.unit(element)?,
        })
    }

    /// A color of the space that is stated around an element, in ours.
    fn managed(&self, element: Node<'d, 'd>, color: Vec3) -> Vec3 {
        let Some(name) = inherited(element, "colorspace") else { return color };
        match NamedSpace::named(name) {
            Some(space) => space.to_rec_709(color),
            None => {
                let reason = format!("the color space {} is not known: taken as lin_rec709", shown(name));
                self.source.warn(element, format!("{}: {reason}", self.reading));
                color
            }
        }
    }

    /// The unit that an element states \[mm\].
    fn unit(&self, element: Node<'d, 'd>) -> Result<Option<f64>> {
        // Angles are in degrees
        let Some(name) = element.attribute("unit").filter(|name| *name != "degree") else { return Ok(None) };
        let length = unit::in_millimeters(name).ok_or_else(|| {
            let names = unit::names();
            self.error(element, &format!("unit is \"{}\", but must be one of {names}", shown(name)))
        });
        length.map(Some)
    }

    fn node_signal(&mut self, node: Node<'d, 'd>, output: Option<&str>) -> Found {
        match node.tag_name().name() {
            "constant" => self.required(node, "value"),
            "dot" => self.required(node, "in"),
            "convert" => self.converted(node),
            "image" | "tiledimage" => self.image(node, node.attribute("type").unwrap_or("")),
            "gltf_image" => self.gltf_image(node, node.attribute("type").unwrap_or("")),
            "gltf_colorimage" => {
                let Some(image) = self.gltf_image(node, "color4")? else { return Ok(None) };
                let is_alpha = output == Some("outa");
                Ok(Some(if is_alpha { image.single(3) } else { Signal { channels: 3, ..image } }))
            }
            "multiply" => self.product(node),
            "extract" => {
                let index = self.input(node, "index")?.map_or(0.0, |index| index.factor[0]);
                self.part(node, index)
            }
            "swizzle" => {
                let Some(signal) = self.required(node, "in")? else { return Ok(None) };
                match self.word(node, "channels")? {
                    Some((_, letters)) => self.swizzled(node, letters, signal),
                    None => self.give_up(node, &format!("{} has no input channels", title(node))),
                }
            }
            "separate2" | "separate3" | "separate4" => {
                let index = match output.unwrap_or("outr") {
                    "outr" | "outx" => 0.0,
                    "outg" | "outy" => 1.0,
                    "outb" | "outz" => 2.0,
                    "outa" | "outw" => 3.0,
                    _ => -1.0,
                };
                self.part(node, index)
            }
            _ => self.give_up(node, &format!("the node {} has no counterpart here", title(node))),
        }
    }

    /// The value of an input of a node, if it has that input.
    pub(super) fn input(&mut self, node: Node<'d, 'd>, name: &str) -> Found {
        match self.source.child(node, Kind::Input, name)? {
            Some(input) => self.signal(input),
            None => Ok(None),
        }
    }

    /// The value of an input that a node is nothing without.
    fn required(&mut self, node: Node<'d, 'd>, name: &str) -> Found {
        if self.source.child(node, Kind::Input, name)?.is_none() {
            return self.give_up(node, &format!("{} has no input {name}", title(node)));
        }
        self.input(node, name)
    }

    /// A value as one of the node's own type.
    fn converted(&mut self, node: Node<'d, 'd>) -> Found {
        let Some(signal) = self.required(node, "in")? else { return Ok(None) };
        let kind = node.attribute("type").unwrap_or("");
        let Some(channels) = channels_of(kind) else {
            return self.give_up(
                node,
                &format!("{} has the type {}, which is none of numbers", title(node), shown(kind)),
            );
        };
        if signal.texture.is_some() && channels != signal.channels && channels.min(signal.channels) < 3 {
            return self
                .give_up(node, &format!("{} of an image changes the number of channels", title(node)));
        }
        let mut factor = signal.factor;
        if signal.channels < 4 && channels == 4 && signal.channels > 1 {
            factor[3] = 1.0;
        }
        Ok(Some(Signal { channels, factor, ..signal }))
    }

    fn product(&mut self, node: Node<'d, 'd>) -> Found {
        let factors = [self.required(node, "in1")?, self.input(node, "in2")?];
        let (image, other) = match factors {
            [Some(one), Some(two)] if two.texture.is_none() => (one, two),
            [Some(one), Some(two)] if one.texture.is_none() => (two, one),
            // 1, which the node has by default
            [Some(one), None] if self.source.child(node, Kind::Input, "in2")?.is_none() => {
                return Ok(Some(one));
            }
            [None, _] | [_, None] => return Ok(None),
            _ => {
                return self.give_up(node, &format!("{} is the product of two images", title(node)));
            }
        };
        let mut factor = image.factor;
        factor.iter_mut().zip(other.factor).for_each(|(factor, other)| *factor *= other);
        if !factor[..image.channels].iter().all(|number| number.is_finite()) {
            return Err(self.error(node, &format!("{} is beyond all numbers", title(node))));
        }
        Ok(Some(Signal { factor, unit: image.unit.or(other.unit), ..image }))
    }

    /// One channel of the input `in`.
    fn part(&mut self, node: Node<'d, 'd>, index: f32) -> Found {
        let Some(signal) = self.required(node, "in")? else { return Ok(None) };
        let index = (0..signal.channels).find(|&channel| channel as f32 == index);
        index.map(|index| Some(signal.single(index))).ok_or_else(|| {
            let message =
                format!("{} asks for a channel that its input of {} has not", title(node), signal.channels);
            self.error(node, &message)
        })
    }

    /// An image of glTF times its factor, as the library's `gltf_image` and its kin have it.
    pub(super) fn gltf_image(&mut self, node: Node<'d, 'd>, kind: &str) -> Found {
        for name in ["geomcolor", "uvindex", "pivot", "scale", "rotate", "offset", "operationorder"] {
            if let Some(input) = self.source.child(node, Kind::Input, name)? {
                return self.give_up(input, &format!("{name} of {} has no counterpart here", title(node)));
            }
        }
        let Some(image) = self.image(node, kind)? else { return Ok(None) };
        let name = if node.has_tag_name("gltf_colorimage") { "color" } else { "factor" };
        match self.input(node, name)? {
            Some(Signal { texture: None, mut factor, .. }) => {
                factor.iter_mut().zip(image.factor).for_each(|(factor, of_image)| *factor *= of_image);
                Ok(Some(Signal { factor, ..image }))
            }
            Some(_) => self.give_up(node, &format!("{} is the product of two images", title(node))),
            None => Ok(Some(image)),
        }
    }

    fn image(&mut self, node: Node<'d, 'd>, kind: &str) -> Found {
        let Some(channels) = channels_of(kind) else {
            let message =
                format!("{} has the type {}, but must have one of numbers", title(node), shown(kind));
            return Err(self.error(node, &message));
        };
        let Some((file, name)) = self.word(node, "file")?.filter(|(_, name)| !name.is_empty()) else {
            if self.source.child(node, Kind::Input, "default")?.is_some() {
                return self.input(node, "default");
            }
            return Err(self.error(node, &format!("{} names no file", title(node))));
        };
        let name = inherited(file, "fileprefix").unwrap_or("").to_owned() + name;
        if name.contains(['<', '>', '{', '}', '[', ']']) {
            let reason = format!("the file name \"{}\" has parts to be substituted", shown(&name));
            return self.give_up(node, &reason);
        }
        if name.contains('\0') {
            return Err(self.error(file, "the file name has a character that no path has"));
        }
        let color_space = self.space_of_image(node, file, kind);
        let image_from_uv = self.mapping(node)?;
        if !image_from_uv.to_cols_array().iter().all(|&number| TextureRef::MAPPING.contains_single(number)) {
            let message = format!("{} scales or moves texture coordinates too far", title(node));
            return Err(self.error(node, &message));
        }
        let wrap = [self.wrap(node, "uaddressmode")?, self.wrap(node, "vaddressmode")?];
        let mut filter = TextureFilter::Linear;
        for (input, usual) in [("layer", ""), ("filtertype", "linear"), ("framerange", "")] {
            if let Some((element, value)) = self.word(node, input)?.filter(|(_, value)| *value != usual) {
                if (input, value) == ("filtertype", "closest") {
                    filter = TextureFilter::Nearest;
                    continue;
                }
                let message =
                    format!("{}: {input} \"{}\" of {} is left out", self.reading, shown(value), title(node));
                self.source.warn(element, message);
            }
        }
        let request = FileRequest {
            path: self.folder.join(name.replace('\\', "/")),
            kind: ImageKind::Plain(color_space),
            place: self.source.place(file),
            image: None,
        };
        let image = self.files.add_image(request);
        let texture = Some(TextureRef { image, image_from_uv, wrap, filter });
        let unit = self.unit(file)?;
        Ok(Some(Signal { channels, factor: [1.0; 4], texture, channel: Channel::Red, unit }))
    }

    /// How the integers of an image are decoded: colors are managed, other numbers are as they are.
    fn space_of_image(&self, node: Node<'d, 'd>, file: Node<'d, 'd>, kind: &str) -> ColorSpace {
        let Some(name) = inherited(file, "colorspace").filter(|_| kind.starts_with("color")) else {
            return ColorSpace::Linear;
        };
        let is_srgb = NamedSpace::named(name).and_then(|space| space.of_images()).unwrap_or_else(|| {
            let is_srgb = name.starts_with("srgb");
            let nearest = if is_srgb { "srgb_texture" } else { "lin_rec709" };
            let reason = format!("images in the color space {} are read as {nearest}", shown(name));
            self.source.warn(node, format!("{}: {reason}", self.reading));
            is_srgb
        });
        if is_srgb { ColorSpace::Srgb } else { ColorSpace::Linear }
    }

    /// A text that an input of a node has, and the element that it stands in.
    fn word(&self, node: Node<'d, 'd>, name: &str) -> Result<Option<(Node<'d, 'd>, &'d str)>> {
        let Some(input) = self.source.child(node, Kind::Input, name)? else { return Ok(None) };
        Ok(match self.origin(input)? {
            Origin::Value(element, value) => Some((element, value)),
            _ => None,
        })
    }

    /// Whether an input of a shader is true; false, with a warning, if it depends on other nodes.
    pub(super) fn flag(&mut self, shader: Node<'d, 'd>, input: Node<'d, 'd>, name: &str) -> Result<bool> {
        self.reading = format!("{}, {name}", title(shader));
        match self.word(shader, name)? {
            Some((_, "true")) => Ok(true),
            Some((_, "false")) => Ok(false),
            Some((element, word)) => {
                Err(self.error(element, &format!("it is \"{}\", but must be true or false", shown(word))))
            }
            None => {
                self.give_up(input, "it has no value of its own")?;
                Ok(false)
            }
        }
    }

    fn wrap(&self, node: Node<'d, 'd>, name: &str) -> Result<Wrap> {
        let Some((element, word)) = self.word(node, name)? else { return Ok(Wrap::Repeat) };
        match word {
            "periodic" => Ok(Wrap::Repeat),
            "clamp" => Ok(Wrap::Clamp),
            "mirror" => Ok(Wrap::Mirror),
            "constant" => {
                let message =
                    format!("{}: {name} constant of {} is taken as clamp", self.reading, title(node));
                self.source.warn(element, message);
                Ok(Wrap::Clamp)
            }
            _ => {
                let allowed = "constant, clamp, periodic or mirror";
                Err(self.error(element, &format!("{name} is \"{}\", but must be {allowed}", shown(word))))
            }
        }
    }

    /// Image coordinates from those of the mesh.
    fn mapping(&mut self, node: Node<'d, 'd>) -> Result<Affine2> {
        let uv = self.coordinates_of(node)?;
        if node.tag_name().name() == "image" {
            return Ok(uv);
        }
        // NG_tiledimage of the standard library: (uv · uvtiling − uvoffset) · realworldtilesize / realworldimagesize
        let tiling = self.pair(node, "uvtiling", Vec2::ONE)?;
        let offset = self.pair(node, "uvoffset", Vec2::ZERO)?;
        let sizes = self.pair(node, "realworldtilesize", Vec2::ONE)?
            / self.pair(node, "realworldimagesize", Vec2::ONE)?;
        Ok(Affine2::from_mat2_translation(Mat2::from_diagonal(sizes * tiling), -offset * sizes) * uv)
    }

    /// Two constant numbers of an input.
    fn pair(&mut self, node: Node<'d, 'd>, name: &str, default: Vec2) -> Result<Vec2> {
        match self.input(node, name)? {
            Some(Signal { texture: None, channels: 1 | 2, factor: [u, v, ..], unit, .. }) => {
                Ok(Vec2::new(u, v) * unit.unwrap_or(1.0) as f32)
            }
            Some(_) => Err(self.error(node, &format!("{name} of {} must be two numbers", title(node)))),
            None => Ok(default),
        }
    }

    /// The map that a node's input `texcoord` applies to the mesh's texture coordinates.
    fn coordinates_of(&mut self, node: Node<'d, 'd>) -> Result<Affine2> {
        let input = self.source.child(node, Kind::Input, "texcoord")?;
        input.map_or(Ok(Affine2::IDENTITY), |input| self.coordinates(input))
    }

    /// The map that an input applies to the mesh's texture coordinates.
    fn coordinates(&mut self, input: Node<'d, 'd>) -> Result<Affine2> {
        let Origin::Node(node, _) = self.origin(input)? else { return Ok(Affine2::IDENTITY) };
        match node.tag_name().name() {
            "texcoord" => {
                let index = self.input(node, "index")?.map_or(0.0, |index| index.factor[0]);
                if index != 0.0 {
                    let reason = "meshes have one set of texture coordinates, which is taken";
                    self.source.warn(node, format!("{}: {reason} for set {index}", self.reading));
                }
                Ok(Affine2::IDENTITY)
            }
            "geompropvalue" => Ok(Affine2::IDENTITY),
            "place2d" => self.entered(input, node, |graph| graph.place2d(node)),
            _ => {
                let reason =
                    format!("{} has no counterpart: the mesh's texture coordinates are taken", title(node));
                self.source.warn(node, format!("{}: {reason}", self.reading));
                Ok(Affine2::IDENTITY)
            }
        }
    }

    /// NG_place2d of the standard library: the coordinates divided by scale, turned and moved about the pivot, or with
    /// operationorder 1 moved, turned and divided.
    fn place2d(&mut self, node: Node<'d, 'd>) -> Result<Affine2> {
        let uv = self.coordinates_of(node)?;
        let pivot = self.pair(node, "pivot", Vec2::ZERO)?;
        let shrunk = Mat2::from_diagonal(1.0 / self.pair(node, "scale", Vec2::ONE)?);
        let offset = self.pair(node, "offset", Vec2::ZERO)?;
        let angle = self.pair(node, "rotate", Vec2::ZERO)?.x.to_radians();
        let order = self.pair(node, "operationorder", Vec2::ZERO)?.x;
        // rotate2d turns clockwise
        let turned = Mat2::from_cols(
            Vec2::new(libm::cosf(angle), -libm::sinf(angle)),
            Vec2::new(libm::sinf(angle), libm::cosf(angle)),
        );
        let moved = |by: Vec2| Affine2::from_translation(by);
        let about_pivot = match order {
            1.0 => Affine2::from_mat2(shrunk * turned) * moved(-offset),
            _ => moved(-offset) * Affine2::from_mat2(turned * shrunk),
        };
        Ok(moved(pivot) * about_pivot * moved(-pivot) * uv)
    }
}

/// The scope that an element's references are of: the element around it.
fn scope_of<'d>(element: Node<'d, 'd>) -> Node<'d, 'd> {
    element.parent_element().unwrap_or(element)
}

/// How many numbers a value of a type has.
fn channels_of(kind: &str) -> Option<usize> {
    match kind {
        "float" | "integer" => Some(1),
        "vector2" => Some(2),
        "color3" | "vector3" => Some(3),
        "color4" | "vector4" => Some(4),
        _ => None,
    }
}

/// Finite numbers between commas or spaces, four at most.
fn numbers(text: &str) -> Option<Vec<f32>> {
    let words = text.split([',', ' ', '\t', '\n', '\r']).filter(|word| !word.is_empty()).take(5);
    words.map(|word| word.parse().ok().filter(|number: &f32| number.is_finite())).collect()
}
