//! Lights that are not emissive meshes: each kind as data, and by its keys.

use std::mem::discriminant;

use glam::{DVec3, Vec3};

use crate::SceneError;
use crate::description::{Counts, Entry, Fallback, FileList, Key, Rule, SceneSlot, Table, Thing, field};
use translucid_words::Interval;

use Fallback::{Number, Plain, Required, Words};

/// A light with its placement. Colors are linear Rec. 709 and non-negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// One-sided rectangle that emits uniformly along `edge_x × edge_y`.
    Rectangle {
        /// Center \[L\].
        center: Vec3,
        /// Full edge vectors \[L\], perpendicular to each other.
        edge_x: Vec3,
        /// See `edge_x`.
        edge_y: Vec3,
        /// Emitted radiance.
        radiance: Vec3,
        /// Whether the camera sees it directly.
        visible: bool,
    },
    /// One-sided ellipse that emits uniformly along `edge_x × edge_y`.
    Ellipse {
        /// Center \[L\].
        center: Vec3,
        /// Whole axis \[L\]: the edge of the rectangle around it, perpendicular to `edge_y`.
        edge_x: Vec3,
        /// See `edge_x`.
        edge_y: Vec3,
        /// Emitted radiance.
        radiance: Vec3,
        /// Whether the camera sees it directly.
        visible: bool,
    },
    /// Sphere that emits uniformly outward.
    Sphere {
        /// Center \[L\].
        center: Vec3,
        /// Radius \[L\], > 0.
        radius: f32,
        /// Emitted radiance.
        radiance: Vec3,
        /// Whether the camera sees it directly.
        visible: bool,
    },
    /// Parallel light from infinity, or from a disc of the sky with an angular radius.
    Distant {
        /// Unit direction from the scene toward the light.
        direction: Vec3,
        /// Half the angle that the light subtends, in degrees, in [0, 90); 0 is a delta light.
        angular_radius: f32,
        /// Irradiance on a surface that faces the light.
        irradiance: Vec3,
    },
    /// Light with a cone: a point, or a sphere each of whose points shines into the cone.
    Spot {
        /// Position \[L\].
        position: Vec3,
        /// Unit direction of the cone's axis.
        direction: Vec3,
        /// Radius of the sphere \[L\]; 0 is a point, which no ray can meet.
        radius: f32,
        /// Radiant intensity on the axis [per steradian].
        intensity: Vec3,
        /// Half-angle within which the intensity is constant, in degrees; ≥ 0.
        inner_angle: f32,
        /// Half-angle beyond which it is zero, in degrees; in (inner_angle, 180]. 180 is a point light.
        outer_angle: f32,
        /// Whether the camera sees it directly, if it has a radius.
        visible: bool,
    },
    /// Parallel beam of finite radius: a laser spot.
    Beam {
        /// Center of the disc that the beam leaves from \[L\].
        origin: Vec3,
        /// Unit direction of travel.
        direction: Vec3,
        /// Radius of the beam \[L\], > 0.
        radius: f32,
        /// Total power; irradiance within the beam is power / (π radius²).
        power: Vec3,
    },
}

impl Light {
    /// Every kind of light; the first of a variant is that by which it is written.
    pub const KINDS: [&Thing<Self>; 7] = [&RECTANGLE, &ELLIPSE, &SPHERE, &DISTANT, &SPOT, &POINT, &BEAM];

    /// The light's kind.
    pub fn description(&self) -> &'static Thing<Self> {
        let is_own = |kind: &&&Thing<Self>| discriminant(&(kind.plain)()) == discriminant(self);
        Self::KINDS.iter().find(is_own).expect("every variant has a kind")
    }

    /// The name of its kind, as scene files write it.
    pub fn kind(&self) -> &'static str {
        self.description().name
    }

    /// Reads a light by its `type` and the keys of that.
    ///
    /// # Errors
    /// The type or a key is unknown or missing, or a value not allowed.
    pub fn read(table: Table<'_>) -> Result<Self, SceneError> {
        let kind = Self::KINDS[table.require("type")?.choice(&Self::KINDS.map(|kind| kind.name))?];
        let table = table.allow(&[vec!["type"], kind.keys()].concat())?;
        kind.read(&table, &mut FileList::default())
    }

    /// The keys and values that [`read`](Self::read) makes the light of.
    pub fn write(&self) -> Vec<Entry> {
        self.write_at(DVec3::ZERO)
    }

    /// As [`write`](Self::write), of a light in a scene of this [origin](crate::Scene::origin).
    pub fn write_at(&self, origin: DVec3) -> Vec<Entry> {
        let kind = self.description();
        [vec![Entry::new("type", kind.name)], kind.write_at(self, origin.to_array())].concat()
    }

    /// Checks every field of the light that messages know by this number.
    ///
    /// # Errors
    /// A number is out of its range, a direction has another length than 1, or the edges of a rectangle are not
    /// perpendicular.
    pub fn validate(&self, index: usize) -> Result<(), SceneError> {
        let check = self.description().check(self, &Counts::default());
        check.map_err(|error| error.within(format_args!("light {index} ({})", self.kind())))
    }
}

/// Keys of a light that shines in a direction from a point.
const AIM: &[Key] =
    &[Key::new("target", "point that it faces", Words("this or a direction")), DIRECTION, UNIT_DIRECTION];

const DIRECTION: Key =
    Key::new("direction", "direction that it faces, of any length", Words("this or `target`"));

const UNIT_DIRECTION: Key = Key::new(
    "unit_direction",
    "in its place a direction of length 1, which is taken as it is, to the last bit",
    Words("none"),
);

/// Keys of a light that shines in a direction from infinity.
const TOWARD: &[Key] = &[
    Key::new(
        "direction",
        "direction of any length from the scene *toward* the light",
        Words("must be given"),
    ),
    UNIT_DIRECTION,
];

/// Keys of the edges of a rectangle about its center.
const EDGES: &[Key] = &[
    AIM[0],
    DIRECTION,
    Key::new("up", "direction along which its edges lie", Words("`[0, 1, 0]`")),
    Key::new("size", "`[width, height]`, lengths > 0", Words("must be given")),
    Key::new(
        "edge_x",
        "with `edge_y` in place of the four above: its whole edges, perpendicular vectors whose cross product points where it shines",
        Words("none"),
    ),
    Key::new("edge_y", "see `edge_x`", Words("none")),
];

const VISIBLE: &str = "whether the camera sees it other than through bodies and glass";
const VISIBLE_BODY: &str =
    "whether the camera sees it other than through bodies and glass, if it has a radius";

/// Kinds of lights at a distance of 3 from the origin, which they face with an irradiance of 3.
const PLACE: Vec3 = Vec3::new(0.0, 0.0, 3.0);
const EDGE_X: Vec3 = Vec3::X;
const EDGE_Y: Vec3 = Vec3::NEG_Y;

const RECTANGLE: Thing<Light> = Thing {
    name: "rectangle",
    doc: "shines to one side, from a rectangle whose edges are aligned with `up`",
    plain: || Light::Rectangle {
        center: PLACE,
        edge_x: EDGE_X,
        edge_y: EDGE_Y,
        radiance: Vec3::splat(27.0),
        visible: true,
    },
    fields: &[
        field!(Light::Rectangle { center } => SceneSlot::Point(center), "point", Required),
        field!(Light::Rectangle { center, edge_x, edge_y } => SceneSlot::Edges { center: *center, edges: [edge_x, edge_y] }; EDGES),
        field!(Light::Rectangle { radiance } => SceneSlot::Radiance(radiance), "color", Required),
        field!(Light::Rectangle { visible } => SceneSlot::Flag(visible), VISIBLE, Plain),
    ],
    rules: &[],
};

const ELLIPSE: Thing<Light> = Thing {
    name: "ellipse",
    doc: "is the ellipse that touches the edges of such a rectangle in their middles, a disc if they are equal",
    plain: || Light::Ellipse {
        center: PLACE,
        edge_x: EDGE_X,
        edge_y: EDGE_Y,
        radiance: Vec3::splat(34.4),
        visible: true,
    },
    fields: &[
        field!(Light::Ellipse { center } => SceneSlot::Point(center), "point", Required),
        field!(Light::Ellipse { center, edge_x, edge_y } => SceneSlot::Edges { center: *center, edges: [edge_x, edge_y] }; EDGES),
        field!(Light::Ellipse { radiance } => SceneSlot::Radiance(radiance), "color", Required),
        field!(Light::Ellipse { visible } => SceneSlot::Flag(visible), VISIBLE, Plain),
    ],
    rules: &[],
};

const SPHERE: Thing<Light> = Thing {
    name: "sphere",
    doc: "shines outward",
    plain: || Light::Sphere { center: PLACE, radius: 0.3, radiance: Vec3::splat(95.5), visible: true },
    fields: &[
        field!(Light::Sphere { center } => SceneSlot::Point(center), "point", Required),
        field!(Light::Sphere { radius } => SceneSlot::Length(radius, Interval::REACH), "length > 0", Required),
        field!(Light::Sphere { radiance } => SceneSlot::Radiance(radiance), "color", Required),
        field!(Light::Sphere { visible } => SceneSlot::Flag(visible), VISIBLE, Plain),
    ],
    rules: &[],
};

const DISTANT: Thing<Light> = Thing {
    name: "distant",
    doc: "shines in parallel from infinity",
    plain: || Light::Distant { direction: Vec3::Z, angular_radius: 0.27, irradiance: Vec3::splat(3.0) },
    fields: &[
        field!(Light::Distant { direction } => SceneSlot::Direction(direction, None); TOWARD),
        field!(Light::Distant { angular_radius } => SceneSlot::Angle(angular_radius, Interval::below(0.0, 90.0)),
            "half the angle that it subtends, {range}", Number(0.0)),
        field!(Light::Distant { irradiance } => SceneSlot::Radiance(irradiance),
            "color: irradiance of a surface that faces it", Required),
    ],
    rules: &[],
};

/// Range of the radius of a light that may be a point.
const MAYBE_POINT: Interval = Interval::closed(0.0, Interval::REACH.high);

const SPOT: Thing<Light> = Thing {
    name: "spot",
    doc: "shines from a point, or from a sphere all of whose points do so, into a cone",
    plain: || Light::Spot {
        position: PLACE,
        direction: Vec3::NEG_Z,
        radius: 0.0,
        intensity: Vec3::splat(27.0),
        inner_angle: 20.0,
        outer_angle: 30.0,
        visible: true,
    },
    fields: &[
        field!(Light::Spot { position } => SceneSlot::Point(position), "point", Required),
        field!(Light::Spot { direction, position } => SceneSlot::Direction(direction, Some(*position)); AIM),
        field!(Light::Spot { radius } => SceneSlot::Length(radius, MAYBE_POINT),
            "length ≥ 0 of the sphere; 0 is a point, with sharp shadows", Plain),
        field!(Light::Spot { intensity } => SceneSlot::Power(intensity),
            "color: radiant intensity on the axis, as seen from afar", Required),
        field!(Light::Spot { inner_angle } => SceneSlot::Angle(inner_angle, Interval::below(0.0, 180.0)),
            "half-angle of its even part, in [0, `outer_angle`); between the two the light falls by 3x² − 2x³ in the cosine of the angle",
            Words("0.8 of `outer_angle`"))
        .when_missing(|light| {
            if let Light::Spot { inner_angle, outer_angle, .. } = light {
                *inner_angle = 0.8 * *outer_angle;
            }
        }),
        field!(Light::Spot { outer_angle } => SceneSlot::Angle(outer_angle, Interval::above(0.0, 180.0)),
            "half-angle of the cone, {range}", Number(45.0)),
        field!(Light::Spot { visible } => SceneSlot::Flag(visible), VISIBLE_BODY, Plain),
    ],
    rules: &[Rule::Holds {
        key: "inner_angle",
        broken: |light| match *light {
            Light::Spot { inner_angle, outer_angle, .. } if inner_angle >= outer_angle => {
                Some(format!("in {}", Interval::below(0.0, f64::from(outer_angle))))
            }
            _ => None,
        },
        help: "",
    }],
};

const POINT: Thing<Light> = Thing {
    name: "point",
    doc: "shines in all directions: a spot without an edge",
    plain: || Light::Spot {
        position: PLACE,
        direction: Vec3::NEG_Y,
        radius: 0.0,
        intensity: Vec3::splat(27.0),
        inner_angle: 0.0,
        outer_angle: 180.0,
        visible: true,
    },
    fields: &[
        field!(Light::Spot { position } => SceneSlot::Point(position), "point", Required),
        field!(Light::Spot { radius } => SceneSlot::Length(radius, MAYBE_POINT), "length ≥ 0 of the sphere", Plain),
        field!(Light::Spot { intensity } => SceneSlot::Power(intensity), "color: radiant intensity", Required),
        field!(Light::Spot { visible } => SceneSlot::Flag(visible), VISIBLE_BODY, Plain),
    ],
    rules: &[],
};

const BEAM: Thing<Light> = Thing {
    name: "beam",
    doc: "is parallel light of a finite width, a laser",
    plain: || Light::Beam { origin: PLACE, direction: Vec3::NEG_Z, radius: 0.1, power: Vec3::splat(0.0942) },
    fields: &[
        field!(Light::Beam { origin } => SceneSlot::Point(origin), "point", Required),
        field!(Light::Beam { direction, origin } => SceneSlot::Direction(direction, Some(*origin)); AIM),
        field!(Light::Beam { radius } => SceneSlot::Length(radius, Interval::REACH), "length > 0", Required),
        field!(Light::Beam { power } => SceneSlot::Power(power), "color: its whole power", Required),
    ],
    rules: &[],
};
