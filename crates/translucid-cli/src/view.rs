//! `translucid view`: the look-dev page.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use translucid_gpu::Choice;
use translucid_load::{ExtendedBase, LoadOptions, MeshBase, Orientation, load_scene, still_life};
use translucid_scene::Unit;
use translucid_view::{Devices, MeshToTurn, Page, Settings, ViewError};

use crate::failure::Failure;
use crate::model::{ModelName, UnitName};
use crate::render;
use crate::{command_line, interrupt, machine, messages};

const EXAMPLES: &str = "\
The page is served on this machine only; its address, with a random token, is printed to stdout.
All open pages show the same scene and picture. Ctrl-C ends the server.

Examples:
  translucid view
  translucid view scenes/bust.ply --preset marble --unit cm
  translucid view scenes/bust.ply --unit cm --up y --rotate 30
  translucid view scenes/fruits.toml --size 960x540
  translucid view scenes/marble.toml --no-open --port 8080";

/// Opens a page in the browser to edit a scene while it is rendered
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ViewArguments {
    /// Scene file (.toml) or mesh (.glb, .gltf, .obj, .ply, .stl) [default: the built-in still life]
    #[arg(value_name = "SCENE|MESH")]
    scene: Option<PathBuf>,
    /// Port of the page's address; 0 chooses a free one
    #[arg(long, value_name = "N", default_value_t = 0)]
    port: u16,
    /// Print the address only, without opening a browser
    #[arg(long)]
    no_open: bool,
    /// Width and height in pixels [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = render::parse_size)]
    size: Option<[u32; 2]>,
    /// Samples per pixel to render [default: the scene's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(render::MAX_SAMPLES)))]
    spp: Option<u32>,
    /// Seed of the random numbers [default: the scene's]
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Threads to render with [default: one per processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Who traces the paths: cpu, gpu, auto, or a part of a device's name
    ///
    /// `translucid devices` lists them, and the page has a menu. Where a device lacks what the scene needs, the processor traces.
    #[arg(long, value_name = "NAME", default_value = "cpu")]
    device: String,
    /// Model for all materials, in place of the scene's
    #[arg(long, value_name = "MODEL")]
    subsurface: Option<ModelName>,
    /// Material of a bare mesh; `translucid render --preset list` shows all
    #[arg(long, value_name = "NAME")]
    preset: Option<String>,
    /// Unit of a bare mesh's coordinates [default: m for glTF, else mm]
    #[arg(long)]
    unit: Option<UnitName>,
    /// Mesh file for object NAME, or for the only one
    #[arg(long, value_name = "[NAME=]PATH", value_parser = render::parse_mesh)]
    mesh: Vec<(Option<String>, PathBuf)>,
    #[command(flatten, next_help_heading = render::MESH_AND_VIEW)]
    look: render::Look,
    #[command(flatten, next_help_heading = render::PICTURE)]
    tone: render::Tone,
}

/// Runs the verb.
pub(crate) fn run(arguments: &ViewArguments) -> Result<(), Failure> {
    let page = Page::serve(arguments.port).map_err(|error| {
        Failure::work(format!("cannot serve at port {}: {error}", arguments.port))
            .with_help("--port 0 takes one that is free")
    })?;
    let devices = devices(&arguments.device)?;
    let origin = Origin::of(arguments)?;
    print_address(&page)?;
    interrupt::catch("\nclosing")?;
    let model = arguments.subsurface.map(ModelName::model);
    let pool = machine::threads(arguments.threads)?;
    let (scene, warnings, orientation) =
        pool.install(|| render::oriented_scene(&arguments.of_render(), model))?;
    let settings = settings(arguments, origin, orientation, devices);
    messages::print_warnings(&warnings);
    render::require_memory(&scene)?;
    // Only now: a scene that cannot be loaded needs no browser, and what is prepared next takes as long as one to start
    if !arguments.no_open
        && let Err(error) = page.open()
    {
        messages::print_note(&format!("no browser could be opened ({error}): open the address above"));
    }
    pool.install(|| page.show(scene, settings, &interrupt::STOP)).map_err(|error| match error {
        ViewError::Scene(error) => Failure::from(error),
        ViewError::Io(error) => Failure::work(error.to_string()),
    })
}

/// Prints where the page is, to people and scripts.
fn print_address(page: &Page) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    let told = writeln!(stdout, "{}", page.address()).and_then(|()| stdout.flush());
    told.map_err(|error| Failure::work(format!("cannot print the address: {error}")))
}

/// The device of the start, and those that the page's menu has.
fn devices(name: &str) -> Result<Devices, Failure> {
    let open = |name: &str| {
        let choice = Choice::open_for_pictures(name)?;
        choice.device.ok_or_else(|| format!("there is no device {name:?}"))
    };
    let choice = Choice::open_for_pictures(name).map_err(render::no_device)?;
    choice.note.iter().for_each(|note| messages::print_note(note));
    // A build without devices has none to choose from
    let usable =
        translucid_gpu::devices().unwrap_or_default().into_iter().filter(|device| device.fault.is_none());
    let mut names = Vec::new();
    for device in usable {
        if !names.contains(&device.name) {
            names.push(device.name);
        }
    }
    Ok(Devices { names, open: Box::new(open), first: choice.device, by_script: None })
}

/// Where the scene comes from: its name for people, and for a file that extends it.
struct Origin {
    name: String,
    extends: String,
}

impl Origin {
    fn of(arguments: &ViewArguments) -> Result<Self, Failure> {
        if arguments.look.has_floor_of_camera() {
            let message = "--floor is for the automatic camera here, but --camera chooses another";
            return Err(
                Failure::input(message).with_help("leave one of them out, or choose a side by --view")
            );
        }
        let Some(path) = &arguments.scene else {
            return Ok(Self { name: String::from("still life"), extends: String::from("still-life") });
        };
        // A saved scene lies in another folder
        let absolute = std::path::absolute(path)
            .map_err(|error| Failure::input(format!("{} has no place: {error}", path.display())))?;
        Ok(Self { name: path.display().to_string(), extends: absolute.display().to_string() })
    }
}

fn settings(
    arguments: &ViewArguments,
    Origin { name, extends }: Origin,
    orientation: Option<Orientation>,
    devices: Devices,
) -> Settings {
    let render = arguments.of_render();
    let preset = arguments.preset.clone();
    let mesh = MeshBase { preset, unit: arguments.unit.map(Unit::from), ..MeshBase::default() };
    // Of what is seen of a scene file, a saved scene has the camera
    let mesh = if orientation.is_some() { arguments.look.of_base(mesh) } else { mesh };
    let base = ExtendedBase { extends, mesh };
    let of_base =
        base.mesh.apply(LoadOptions { mesh_overrides: arguments.mesh.clone(), ..LoadOptions::default() });
    let scene = arguments.scene.clone();
    let load_base = move |turned: Option<Orientation>| {
        let options = of_base.clone();
        let options = match turned {
            Some(orientation) => orientation.apply(options),
            None => options,
        };
        match &scene {
            Some(path) => load_scene(path, &options, &mut Vec::new()),
            None => still_life(&options),
        }
    };
    let shown = render::load_options(&render, arguments.subsurface.map(ModelName::model));
    let mesh = orientation.zip(arguments.scene.clone()).map(|(orientation, path)| {
        let load = move |to: Orientation, size| {
            load_scene(&path, &to.apply(LoadOptions { size: Some(size), ..shown.clone() }), &mut Vec::new())
        };
        MeshToTurn { orientation, load: Box::new(load) }
    });
    let option = |(name, path): &(Option<String>, PathBuf)| match name {
        Some(name) => format!("--mesh '{name}={}'", path.display()),
        None => format!("--mesh '{}'", path.display()),
    };
    Settings {
        name,
        base,
        load_base: Box::new(load_base),
        mesh,
        is_metered: render::exposure(&render).is_metered(),
        command: command_line::shown(),
        options: arguments.mesh.iter().map(option).collect::<Vec<_>>().join(" "),
        devices,
    }
}

impl ViewArguments {
    /// What loads the scene for a picture loads it for a page.
    fn of_render(&self) -> render::Arguments {
        let mut arguments = render::Arguments::default();
        arguments.scene.clone_from(&self.scene);
        arguments.size = self.size;
        arguments.spp = self.spp;
        arguments.seed = self.seed;
        arguments.preset.clone_from(&self.preset);
        arguments.unit = self.unit;
        arguments.mesh.clone_from(&self.mesh);
        arguments.look.clone_from(&self.look);
        arguments.tone.clone_from(&self.tone);
        arguments
    }
}
