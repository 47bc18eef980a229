//! Cameras with a thin lens, as data and by their keys.

use glam::{Vec2, Vec3};

use crate::description::{Counts, Fallback, Key, Rule, SceneSlot, Thing, field};
use crate::{Projection, SceneError};
use translucid_words::Interval;

use Fallback::{Plain, Required, Words};

/// A camera. Right-handed; the image's x axis points right, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Center of the lens \[L\].
    pub position: Vec3,
    /// Point on the optical axis \[L\], in the middle of an image without shift; differs from `position`.
    pub target: Vec3,
    /// Upward direction, not parallel to the viewing direction; any length.
    pub up: Vec3,
    /// How far the picture reaches.
    pub projection: Projection,
    /// Shift of the picture's frame to the right and upward, in widths of the picture: the axis is that far left of and
    /// below the picture's middle, and parallel edges stay parallel. Within ±100.
    pub shift: Vec2,
    /// Radius of the lens \[L\]; 0 is a pinhole. At most 256 times the distance to `target` or the focus, whichever is greater.
    pub lens_radius: f32,
    /// Distance from the lens to the plane in focus, along the viewing direction \[L\], > 0.
    pub focus_distance: f32,
}

/// A pinhole at z = 5 that looks at the origin, with y upward and a field of view of 40°.
impl Default for Camera {
    fn default() -> Self {
        Self {
            position: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            projection: Projection::Perspective { horizontal_fov: 40.0 },
            shift: Vec2::ZERO,
            lens_radius: 0.0,
            focus_distance: 5.0,
        }
    }
}

const PROJECTION: &[Key] = &[
    Key::new(
        "projection",
        "`\"perspective\"`, or `\"orthographic\"`: lines of sight are parallel, and nothing is seen that is behind the plane through `position`",
        Words("`\"perspective\"`"),
    ),
    Key::new(
        "fov",
        "of a perspective: full horizontal angle of view of a picture without `shift`, in (0, 180)",
        Words("40"),
    ),
    Key::new(
        "width",
        "of an orthographic projection: width of what the picture shows, a length > 0",
        Words("must be given"),
    ),
];

impl Camera {
    /// The key of a camera's name, in scene files alone.
    pub const NAME_KEY: Key = Key::new("name", "text, for `--camera NAME`", Words("none"));

    /// The camera by its keys.
    pub const DESCRIPTION: Thing<Self> = Thing {
        name: "camera",
        doc: "where the picture is seen from",
        plain: Self::default,
        fields: &[
            field!(Camera { position } => SceneSlot::Point(position), "point: the middle of the lens", Required),
            field!(Camera { target } => SceneSlot::Point(target),
                "point in the middle of a picture without `shift`, other than `position`", Required),
            field!(Camera { up } => SceneSlot::Vector(up), "direction of any length, not parallel to the view", Plain),
            field!(Camera { projection } => SceneSlot::Projection(projection); PROJECTION),
            field!(Camera { shift } => SceneSlot::Pair(shift, Interval::closed(-100.0, 100.0)),
                "`[right, up]`: how far the picture's frame is moved on its plane, in widths of the picture, each {range}; `target` then is as far left of the picture's middle and below, and upright edges stay upright", Plain),
            field!(Camera { lens_radius } => SceneSlot::Length(lens_radius, Interval::LENGTH),
                "length ≥ 0, up to 256 times the distance to `target` or the plane in focus, whichever is greater; 0 is a pinhole", Plain),
            field!(Camera { focus_distance } => SceneSlot::Length(focus_distance, Interval::REACH),
                "length > 0 along the view", Words("the distance to `target`"))
            .when_missing(|camera| {
                let distance = camera.position.as_dvec3().distance(camera.target.as_dvec3());
                camera.focus_distance = Interval::REACH.nearest(distance as f32);
            }),
        ],
        rules: &[
            Rule::Holds {
                key: "target",
                broken: |camera| {
                    let must_be = "a point other than the camera's position";
                    (camera.target == camera.position).then(|| must_be.to_owned())
                },
                help: "",
            },
            Rule::Holds {
                key: "up",
                broken: |camera| {
                    let must_be = "a direction that is not parallel to the viewing direction";
                    (!camera.has_usable_up()).then(|| must_be.to_owned())
                },
                help: "give camera.up, for example [0, 0, -1]",
            },
            Rule::Holds {
                key: "lens_radius",
                broken: |camera| {
                    let most = "at most 256 times the distance to `target` or the plane in focus, whichever is greater";
                    (f64::from(camera.lens_radius) > Self::WIDEST * camera.reach()).then(|| most.to_owned())
                },
                help: "",
            },
        ],
    };

    /// Sine of the smallest angle between `up` and the viewing direction.
    const LEAST_SINE: f64 = 1e-4;

    /// Widest lens in distances to what is seen: rays in single precision, which start all over it, still meet in the focus
    /// within a pixel, a 16,384th of the distance, of the largest film.
    const WIDEST: f64 = 256.0;

    /// Distance to the target or the focus \[L\], whichever is greater.
    fn reach(&self) -> f64 {
        self.position.as_dvec3().distance(self.target.as_dvec3()).max(self.focus_distance.into())
    }

    /// The camera to which things are `factor` times as large about the middle of the picture.
    pub fn zoomed(&self, factor: f32) -> Self {
        let projection = self.projection.widened(f64::from(factor).recip());
        // The middle stays where it is on the image plane, whose width is another
        Self { projection, shift: self.shift * factor, ..*self }
    }

    /// Whether `up` spans the image plane's vertical together with the viewing direction.
    fn has_usable_up(&self) -> bool {
        let view = self.target.as_dvec3() - self.position.as_dvec3();
        let sine = self.up.as_dvec3().normalize_or_zero().cross(view.normalize_or_zero()).length();
        sine > Self::LEAST_SINE
    }

    /// Checks every field.
    ///
    /// # Errors
    /// A number is out of its range, the camera looks at its own position, `up` is parallel to the view, or the lens is too wide for
    /// single precision.
    ///
    /// ```
    /// use translucid_scene::{Camera, Projection};
    ///
    /// let projection = Projection::Perspective { horizontal_fov: 180.0 };
    /// let camera = Camera { projection, ..Camera::default() };
    /// assert_eq!(camera.validate().unwrap_err().message, "camera, fov = 180: must be in (0, 180)");
    /// ```
    pub fn validate(&self) -> Result<(), SceneError> {
        Self::DESCRIPTION.check(self, &Counts::default()).map_err(|error| error.within("camera"))
    }
}
