//! Stub.
use glam::Vec3;
use translucid_scene::{Light, Scene};
pub struct EmissiveTriangle {
    pub vertices: [Vec3; 3],
    pub radiance: Vec3,
    pub primitive: u32,
}
pub struct LightSet {
    one: Option<Light>,
    rect: Option<(Vec3, Vec3, Vec3, Vec3)>,
    env: Vec3,
    vis: bool,
}
pub struct LightSample {
    pub direction: Vec3,
    pub distance: f32,
    pub radiance: Vec3,
    pub pdf: f32,
    pub is_delta: bool,
    pub primitive: Option<u32>,
}
pub struct LightHit {
    pub t: f32,
    pub radiance: Vec3,
    pub visible: bool,
    pub p: f32,
}
impl LightHit {
    pub fn pdf(&self, _l: &LightSet, _p: Vec3, _n: Vec3) -> f32 {
        self.p
    }
}
impl LightSet {
    pub fn new(scene: &Scene, _e: Vec<EmissiveTriangle>, _b: (Vec3, Vec3)) -> Self {
        let mut rect = None;
        for l in &scene.lights {
            if let Light::Rectangle { center, edge_x, edge_y, radiance, .. } = *l {
                rect = Some((center, edge_x, edge_y, radiance));
            }
        }
        Self {
            one: scene.lights.iter().copied().find(|l| !matches!(l, Light::Rectangle { .. })),
            rect,
            env: scene.environment.map_or(Vec3::ZERO, |e| e.radiance),
            vis: scene.environment.is_some_and(|e| e.visible),
        }
    }
    pub fn sample(&self, point: Vec3, _n: Vec3, u: f32, v: [f32; 2]) -> Option<LightSample> {
        match self.one {
            Some(Light::Distant { direction, irradiance, .. }) => {
                return Some(LightSample {
                    direction,
                    distance: f32::INFINITY,
                    radiance: irradiance,
                    pdf: 1.0,
                    is_delta: true,
                    primitive: None,
                });
            }
            Some(Light::Beam { origin, direction, radius, power }) => {
                let q = point - origin;
                let t = q.dot(direction);
                if t <= 0.0 || (q - direction * t).length() > radius {
                    return None;
                }
                return Some(LightSample {
                    direction: -direction,
                    distance: t,
                    radiance: power / (std::f32::consts::PI * radius * radius),
                    pdf: 1.0,
                    is_delta: true,
                    primitive: None,
                });
            }
            _ => {}
        }
        let pr = if self.rect.is_some() { 0.5 } else { 0.0 };
        if u < pr {
            let (c, x, y, l) = self.rect.unwrap();
            let q = c + x * (v[0] - 0.5) + y * (v[1] - 0.5);
            let n = x.cross(y);
            let a = n.length();
            let n = n / a;
            let d = q - point;
            let dist = d.length();
            let w = d / dist;
            let cos = -w.dot(n);
            if cos <= 0.0 {
                return None;
            }
            Some(LightSample {
                direction: w,
                distance: dist,
                radiance: l,
                pdf: pr * dist * dist / (cos * a),
                is_delta: false,
                primitive: None,
            })
        } else {
            let z = 1.0 - 2.0 * v[0];
            let r = (1.0 - z * z).max(0.0).sqrt();
            let (s, c) = (std::f32::consts::TAU * v[1]).sin_cos();
            Some(LightSample {
                direction: Vec3::new(r * c, r * s, z),
                distance: f32::INFINITY,
                radiance: self.env,
                pdf: (1.0 - pr) / (4.0 * std::f32::consts::PI),
                is_delta: false,
                primitive: None,
            })
        }
    }
    pub fn intersect(&self, o: Vec3, d: Vec3, t_max: f32) -> Option<LightHit> {
        let (c, x, y, l) = self.rect?;
        let n = x.cross(y);
        let a = n.length();
        let n = n / a;
        let cos = -d.dot(n);
        if cos <= 0.0 {
            return None;
        }
        let t = (c - o).dot(n) / d.dot(n);
        if t <= 0.0 || t >= t_max {
            return None;
        }
        let q = o + d * t - c;
        if (q.dot(x) / x.length_squared()).abs() > 0.5 || (q.dot(y) / y.length_squared()).abs() > 0.5 {
            return None;
        }
        Some(LightHit { t, radiance: l, visible: false, p: 0.5 * t * t / (cos * a) })
    }
    pub fn triangle_pdf(&self, _p: u32, _a: Vec3, _n: Vec3, _h: Vec3, _hn: Vec3) -> f32 {
        0.0
    }
    pub fn environment_radiance(&self, _d: Vec3) -> Vec3 {
        self.env
    }
    pub fn environment_pdf(&self, _p: Vec3, _n: Vec3, _d: Vec3) -> f32 {
        (if self.rect.is_some() { 0.5 } else { 1.0 }) / (4.0 * std::f32::consts::PI)
    }
    pub fn environment_visible(&self) -> bool {
        self.vis
    }
}
