//! Sessions whose paths a device traces: a stand-in that sees the same light in every sample.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use glam::Vec3;
use translucid_render::device::{DeviceLimits, DeviceScene, TracingDevice};
use translucid_render::{
    Edit, Event, FilmLayer, OnDevice, Outcome, PathTracing, PixelSample, Plan, Session, View,
};
use translucid_scene::SubsurfaceMethod;

use crate::common::{matte, prepare, scene, sphere, uniform_environment};

/// Counts the scenes that it was given.
#[derive(Default)]
struct StandIn {
    opened: AtomicU32,
    is_lost: AtomicBool,
}

impl TracingDevice for StandIn {
    fn name(&self) -> &str {
        "stand-in"
    }

    fn limits(&self) -> DeviceLimits {
        DeviceLimits { array_bytes: 1 << 27 }
    }

    fn open(self: Arc<Self>, _: &DeviceScene) -> Result<Box<dyn PathTracing>, String> {
        self.opened.fetch_add(1, Ordering::Relaxed);
        Ok(Box::new(SameLight(self)))
    }
}

struct SameLight(Arc<StandIn>);

impl PathTracing for SameLight {
    fn trace(
        &mut self,
        view: &View,
        numbers: Range<u32>,
        _: &dyn Fn(u64),
        _: &AtomicBool,
    ) -> Result<Option<Vec<PixelSample>>, String> {
        if self.0.is_lost.load(Ordering::Relaxed) {
            return Err("the device was lost".into());
        }
        let sample = PixelSample { diffuse: Vec3::splat(7.0), alpha: 1.0, ..PixelSample::default() };
        Ok(Some(vec![sample; view.region().area() as usize * numbers.len()]))
    }
}

fn session() -> Session {
    let mut scene = scene(vec![sphere(0.3, 8)], matte(Vec3::splat(0.5)));
    scene.environment = uniform_environment(Vec3::ONE);
    let prepared = prepare(scene);
    let view = prepared.view().unwrap();
    Session::new(prepared, view)
}

fn middle(session: &mut Session) -> f32 {
    let outcome = session.run(&Plan::samples(2), &|_: &Event<'_>| {}, &AtomicBool::new(false));
    assert_eq!(outcome.unwrap(), Outcome::Finished);
    let radiance = session.film().layer(FilmLayer::Radiance);
    radiance[radiance.len() / 2]
}

#[test]
fn device_takes_the_scene_anew_after_edits_alone() {
    let (device, mut session) = (Arc::new(StandIn::default()), session());
    session.set_device(Some(OnDevice::required(device.clone()))).unwrap();
    assert_eq!(middle(&mut session), 7.0);
    let view = session.view().clone();
    session.set_view(view.with_region([0, 0, 5, 4]).unwrap());
    assert_eq!((middle(&mut session), device.opened.load(Ordering::Relaxed)), (7.0, 1));
    session.edit(Edit::Material(0, Box::new(matte(Vec3::splat(0.2))))).unwrap();
    assert_eq!((middle(&mut session), device.opened.load(Ordering::Relaxed)), (7.0, 2));
    session.set_device(None).unwrap();
    assert!(middle(&mut session) < 1.0);
}

#[test]
fn processor_takes_the_place_of_a_preferred_device() {
    let (device, mut session) = (Arc::new(StandIn::default()), session());
    session.set_device(Some(OnDevice::preferred(device.clone()))).unwrap();
    let mut integrator = session.prepared().scene().integrator;
    let plain = integrator;
    integrator.subsurface_method = SubsurfaceMethod::PointBased;
    session.edit(Edit::Integrator(integrator)).unwrap();
    assert!(middle(&mut session) < 1.0);
    assert!(session.refusal().unwrap().contains("ray-traced"), "{:?}", session.refusal());
    session.edit(Edit::Integrator(plain)).unwrap();
    assert_eq!((middle(&mut session), session.refusal()), (7.0, None));

    // One that is required refuses, and the session stays as it was
    session.edit(Edit::Integrator(integrator)).unwrap();
    let error = session.set_device(Some(OnDevice::required(device.clone()))).unwrap_err();
    assert!(error.to_string().contains("ray-traced"), "{error}");
    assert!(middle(&mut session) < 1.0);
}

#[test]
fn failure_of_a_device_is_an_error() {
    let (device, mut session) = (Arc::new(StandIn::default()), session());
    session.set_device(Some(OnDevice::preferred(device.clone()))).unwrap();
    device.is_lost.store(true, Ordering::Relaxed);
    let outcome = session.run(&Plan::samples(1), &|_: &Event<'_>| {}, &AtomicBool::new(false));
    assert_eq!(outcome.unwrap_err().to_string(), "the device was lost");
}
