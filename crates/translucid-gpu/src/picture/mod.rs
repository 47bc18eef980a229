//! Pictures on graphics processors: the path tracer of `translucid-render` in WGSL.
//!
//! A path is a slot of a buffer. In a round each kernel works off the slots that wait for it (`shaders/kernels.wgsl`): rays,
//! surfaces, flights of walks, light samples. Nothing is followed to its end in one call, and a sample is a function of seed,
//! pixel and number alone, whichever slot it had.

#[cfg(test)]
mod broken_tests;
#[cfg(test)]
mod evaluate;
#[cfg(test)]
mod instance_tests;
#[cfg(test)]
mod layer_tests;
#[cfg(test)]
mod layout_tests;
#[cfg(test)]
mod light_tests;
#[cfg(test)]
mod profile_tests;
#[cfg(test)]
mod region_tests;
#[cfg(test)]
mod surface_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod walk_tests;

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use translucid_render::device::{DeviceLimits, DeviceScene, TracingDevice};
use translucid_render::{PathTracing, PixelSample, View};

use crate::device::{DISPATCH_TIME, Gpu};
use crate::program::{
    COUNTERS, EMPTY_NODE, KERNELS, LIST_COUNTERS, MOST_ROUNDS, SAMPLE_WORDS, SETTINGS, SLOT_BYTES, SLOTS,
    samples as samples_of, settings, text,
};

/// A device that traces pictures: its kernels are made once for all scenes.
#[derive(Debug)]
pub struct Tracer {
    gpu: Gpu,
    kernels: Vec<(wgpu::ComputePipeline, u32)>,
    layout: wgpu::BindGroupLayout,
    slots: u32,
}

impl Tracer {
    /// A tracer on a device.
    ///
    /// # Errors
    /// The device cannot be used.
    pub fn new(gpu: Gpu) -> Result<Self, String> {
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("picture"),
            source: wgpu::ShaderSource::Wgsl(text().into()),
        });
        let layout = bindings(device);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let constants = [("group_size", f64::from(gpu.group()))];
        let kernel = |(name, share)| {
            let kernel = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(name),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    ..Default::default()
                },
                cache: None,
            });
            (kernel, share)
        };
        let kernels = KERNELS.map(kernel).into();
        gpu.check()?;
        let slots = if gpu.is_graphics_processor() { SLOTS.0 } else { SLOTS.1 };
        Ok(Self { gpu, kernels, layout, slots })
    }

    /// Traces so many paths at a time, which has no part in the pictures.
    #[doc(hidden)]
    #[must_use]
    pub fn with_slots(self, slots: u32) -> Self {
        Self { slots: slots.clamp(1, SLOTS.0), ..self }
    }
}

impl TracingDevice for Tracer {
    fn name(&self) -> &str {
        self.gpu.name()
    }

    fn limits(&self) -> DeviceLimits {
        DeviceLimits { array_bytes: self.gpu.device.limits().max_storage_buffer_binding_size }
    }

    fn open(self: Arc<Self>, scene: &DeviceScene) -> Result<Box<dyn PathTracing>, String> {
        Ok(Box::new(Tracing::new(self, scene)?))
    }
}

/// A scene on a device.
struct Tracing {
    tracer: Arc<Tracer>,
    settings: wgpu::Buffer,
    scene: [wgpu::Buffer; 5],
    states: wgpu::Buffer,
    queues: wgpu::Buffer,
    counters_read: wgpu::Buffer,
    rounds: u32,
}

impl Tracing {
    fn new(tracer: Arc<Tracer>, scene: &DeviceScene) -> Result<Self, String> {
        use wgpu::BufferUsages as Usage;
        let Tracer { gpu, slots, .. } = &*tracer;
        let slots = u64::from(*slots);
        let filled = |words: &[u32]| {
            let buffer = gpu.buffer(4 * words.len().max(8) as u64, Usage::STORAGE | Usage::COPY_DST);
            gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(words));
            buffer
        };
        let on_device = [
            if scene.nodes.is_empty() { filled(&EMPTY_NODE) } else { filled(&scene.nodes) },
            filled(&scene.triangles),
            filled(bytemuck::cast_slice(&scene.attributes)),
            filled(bytemuck::cast_slice(&scene.tables)),
            filled(&scene.images),
        ];
        let lists = LIST_COUNTERS.end - LIST_COUNTERS.start;
        let settings = gpu.buffer(4 * SETTINGS as u64, Usage::UNIFORM | Usage::COPY_DST);
        let states = gpu.buffer(SLOT_BYTES * slots, Usage::STORAGE | Usage::COPY_DST);
        let queues =
            gpu.buffer(4 * (COUNTERS + lists * slots), Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC);
        let counters_read = gpu.buffer(4 * COUNTERS, Usage::MAP_READ | Usage::COPY_DST);
        gpu.check()?;
        Ok(Self { settings, scene: on_device, states, queues, counters_read, rounds: 1, tracer })
    }

    fn group(&self, samples: &wgpu::Buffer) -> wgpu::BindGroup {
        let buffers =
            std::iter::once(&self.settings).chain(&self.scene).chain([&self.states, &self.queues, samples]);
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        self.tracer.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.tracer.layout,
            entries: &entries,
        })
    }

    /// Rounds by so many slots, and how many samples are done after them, of which so many were left: no list is longer than
    /// they allow.
    fn advance(&mut self, group: &wgpu::BindGroup, slots: u32, left: u32) -> Result<u32, String> {
        let start = Instant::now();
        let Tracer { gpu, kernels, .. } = &*self.tracer;
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for _ in 0..self.rounds {
            let Range { start, end } = LIST_COUNTERS;
            encoder.clear_buffer(&self.queues, 4 * start, Some(4 * (end - start)));
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_bind_group(0, group, &[]);
            for (number, (kernel, share)) in kernels.iter().enumerate() {
                let longest = if number == 0 { slots } else { slots.min(left) };
                pass.set_pipeline(kernel);
                pass.dispatch_workgroups((share * longest).div_ceil(gpu.group()), 1, 1);
            }
        }
        encoder.copy_buffer_to_buffer(&self.queues, 0, &self.counters_read, 0, 4 * COUNTERS);
        gpu.queue.submit([encoder.finish()]);
        let counters = gpu.read(&self.counters_read)?;
        let pace = DISPATCH_TIME.as_secs_f64() / start.elapsed().as_secs_f64();
        self.rounds = ((f64::from(self.rounds) * pace.clamp(0.25, 2.0)) as u32).clamp(1, MOST_ROUNDS);
        counters.get(1).copied().ok_or_else(|| "the device sent too few counters".to_owned())
    }
}

impl PathTracing for Tracing {
    fn trace(
        &mut self,
        view: &View,
        numbers: Range<u32>,
        progress: &dyn Fn(u64),
        stop: &AtomicBool,
    ) -> Result<Option<Vec<PixelSample>>, String> {
        use wgpu::BufferUsages as Usage;
        let gpu = &Arc::clone(&self.tracer).gpu;
        let items = (view.region().area() * numbers.len() as u64) as u32;
        let slots = self.tracer.slots.min(items);
        let words = settings(view, numbers.start, items, slots);
        let bytes = 4 * (items as usize * SAMPLE_WORDS) as u64;
        let samples = gpu.buffer(bytes, Usage::STORAGE | Usage::COPY_SRC);
        let read = gpu.buffer(bytes, Usage::MAP_READ | Usage::COPY_DST);
        gpu.check()?;
        let group = self.group(&samples);
        gpu.queue.write_buffer(&self.settings, 0, bytemuck::cast_slice(&words));
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.clear_buffer(&self.states, 0, None);
        encoder.clear_buffer(&self.queues, 0, None);
        gpu.queue.submit([encoder.finish()]);
        let mut done = 0;
        while done < items {
            done = self.advance(&group, slots, items - done)?;
            progress(done.into());
            if done < items && stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
        }
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&samples, 0, &read, 0, bytes);
        gpu.queue.submit([encoder.finish()]);
        let words = gpu.read(&read)?;
        Ok(Some(samples_of(&words)))
    }
}

fn bindings(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding: u32| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: match binding {
                0 => wgpu::BufferBindingType::Uniform,
                _ => wgpu::BufferBindingType::Storage { read_only: binding < 6 },
            },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let entries: Vec<_> = (0..9).map(entry).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
}
