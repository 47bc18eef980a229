//! Devices, and walks on them.

use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::{Duration, Instant};

use translucid_reference::walk::{Device, DeviceTally, DeviceWalk};

use crate::description::DeviceDescription;
use crate::walk_numbers::WalkNumbers;

/// The shaders, in the order in which they read best.
pub(crate) const SHADERS: [&str; 8] = [
    include_str!("shaders/walk.wgsl"),
    include_str!("shaders/source.wgsl"),
    include_str!("shaders/boundary.wgsl"),
    include_str!("shaders/scatter.wgsl"),
    include_str!("shaders/tally.wgsl"),
    include_str!("shaders/random.wgsl"),
    include_str!("shaders/pcg.wgsl"),
    include_str!("shaders/arithmetic.wgsl"),
];
/// Words of a photon in a slot.
const SLOT_WORDS: u64 = 12;
/// Words of a cell.
const CELL_WORDS: usize = 3;
/// Photons whose counts are added up on the device: fewer than words can count.
const BATCH: u64 = 1 << 30;
/// Invocations of a workgroup.
const GROUP: u32 = 64;
/// Photons under way at a time: as many as the threads of the largest processors of 2025; and on a central processor, where
/// a stop waits for all of them.
const SLOTS: (u32, u32) = (1 << 18, 1 << 10);
/// Steps of a dispatch, at the start and at most. (Mesa's llvmpipe ends loops after 65,535 iterations.)
const STEPS: (u32, u32) = (64, 4096);
/// Time that a dispatch is to take: systems kill those that take seconds.
pub(crate) const DISPATCH_TIME: Duration = Duration::from_millis(40);

/// The devices of this machine: none where there is no driver.
pub(crate) fn devices() -> Vec<DeviceDescription> {
    let describe =
        |adapter: &wgpu::Adapter| DeviceDescription { fault: Gpu::of(adapter).err(), ..description(adapter) };
    adapters().iter().map(describe).collect()
}

fn adapters() -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY))
}

fn description(adapter: &wgpu::Adapter) -> DeviceDescription {
    let info = adapter.get_info();
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => "discrete GPU",
        wgpu::DeviceType::IntegratedGpu => "integrated GPU",
        wgpu::DeviceType::VirtualGpu => "virtual GPU",
        wgpu::DeviceType::Cpu => "CPU",
        wgpu::DeviceType::Other => "other",
    };
    let driver = format!("{} {}", info.driver, info.driver_info).trim().to_owned();
    DeviceDescription {
        name: info.name,
        kind,
        backend: info.backend.to_string(),
        driver,
        buffer_bytes: adapter.limits().max_storage_buffer_binding_size,
        fault: None,
    }
}

/// A device that walks photons.
#[derive(Debug)]
pub struct Gpu {
    name: String,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// The first error that the device reported.
    fault: Arc<Mutex<Option<String>>>,
    slots: u32,
    group: u32,
    most_steps: u32,
    is_graphics_processor: bool,
}

impl Gpu {
    /// Opens a device by what the user calls it: `gpu` for the best graphics processor that can be used, else a part of a
    /// name, in any case of letters. Only by its name is a device taken that is no graphics processor.
    ///
    /// # Errors
    /// There is no such device, or it cannot be used; the message says what there is.
    pub fn open(name: &str) -> Result<Self, String> {
        let adapters = adapters();
        let wanted = name.to_lowercase();
        let rank = |adapter: &&wgpu::Adapter| match adapter.get_info().device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        };
        let is_meant = |adapter: &&wgpu::Adapter| match wanted.as_str() {
            "gpu" => rank(adapter) < 4,
            part => adapter.get_info().name.to_lowercase().contains(part),
        };
        let mut meant: Vec<&wgpu::Adapter> = adapters.iter().filter(is_meant).collect();
        meant.sort_by_key(rank);
        // A system may know a processor twice, by two of its interfaces, of which one may be broken
        let mut fault = None;
        for adapter in meant {
            match Self::of(adapter) {
                Ok(opened) => return Ok(opened),
                Err(reason) => {
                    let name = adapter.get_info().name;
                    fault.get_or_insert(format!("the device {name} cannot be used: {reason}"));
                }
            }
        }
        Err(fault.unwrap_or_else(|| none_found(name, &adapters)))
    }

    fn of(adapter: &wgpu::Adapter) -> Result<Self, String> {
        // Nothing beyond what every browser has
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("translucid"),
            required_limits: wgpu::Limits::default(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| error.to_string())?;
        let fault = Arc::new(Mutex::new(None));
        let note = |fault: &Arc<Mutex<Option<String>>>| {
            let fault = Arc::clone(fault);
            move |message: String| {
                fault.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(message);
            }
        };
        let (error, lost) = (note(&fault), note(&fault));
        device.on_uncaptured_error(Arc::new(move |reason: wgpu::Error| error(reason.to_string())));
        device.set_device_lost_callback(move |_, reason| lost(format!("it was lost: {reason}")));
        let info = adapter.get_info();
        let is_graphics_processor = info.device_type != wgpu::DeviceType::Cpu;
        let slots = if is_graphics_processor { SLOTS.0 } else { SLOTS.1 };
        let (group, most_steps) = (GROUP, STEPS.1);
        Ok(Self { name: info.name, device, queue, fault, slots, group, most_steps, is_graphics_processor })
    }

    /// Name, as its driver gives it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Invocations of a workgroup.
    pub(crate) fn group(&self) -> u32 {
        self.group
    }

    /// Returns `false` for a driver that calculates on the central processor.
    pub(crate) fn is_graphics_processor(&self) -> bool {
        self.is_graphics_processor
    }

    /// Shares the work out otherwise, which has no part in the result: photons under way at a time, invocations of a
    /// workgroup, and most steps of a dispatch.
    #[doc(hidden)]
    #[must_use]
    pub fn with_shares(mut self, slots: u32, group: u32, most_steps: u32) -> Self {
        let limits = self.device.limits();
        // wgpu itself does not check all of them on every device
        self.group = group
            .clamp(1, limits.max_compute_invocations_per_workgroup.min(limits.max_compute_workgroup_size_x));
        self.slots = slots.clamp(1, limits.max_compute_workgroups_per_dimension * self.group);
        self.most_steps = most_steps.clamp(1, STEPS.1);
        self
    }

    /// Returns the first error that the device reported, if any.
    pub(crate) fn check(&self) -> Result<(), String> {
        let fault = self.fault.lock().unwrap_or_else(PoisonError::into_inner);
        fault.as_ref().map_or(Ok(()), |fault| Err(format!("the device {} failed: {fault}", self.name)))
    }

    /// Waits for a buffer's words.
    pub(crate) fn read(&self, buffer: &wgpu::Buffer) -> Result<Vec<u32>, String> {
        let failed = |reason: String| format!("the device {} failed: {reason}", self.name);
        let (send, receive) = mpsc::channel();
        // A receiver that is gone waits no more
        buffer.map_async(wgpu::MapMode::Read, .., move |result| drop(send.send(result)));
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(error.to_string()))?;
        self.check()?;
        receive
            .recv()
            .map_err(|_| failed("it does not answer".to_owned()))?
            .map_err(|error| failed(error.to_string()))?;
        let bytes = buffer.get_mapped_range(..).map_err(|error| failed(error.to_string()))?;
        let words = bytemuck::pod_collect_to_vec(&bytes[..]);
        drop(bytes);
        buffer.unmap();
        Ok(words)
    }

    pub(crate) fn buffer(&self, bytes: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let descriptor =
            wgpu::BufferDescriptor { label: None, size: bytes, usage, mapped_at_creation: false };
        self.device.create_buffer(&descriptor)
    }
}

fn none_found(name: &str, adapters: &[wgpu::Adapter]) -> String {
    let names: Vec<String> =
        adapters.iter().map(description).map(|found| format!("{} ({})", found.name, found.kind)).collect();
    let what = if name.eq_ignore_ascii_case("gpu") {
        "no graphics processor".to_owned()
    } else {
        format!("no device {name:?}")
    };
    if names.is_empty() {
        return format!("there is {what}: no driver for Vulkan, Metal or DirectX 12 was found");
    }
    format!("there is {what}, but: {}", names.join(", "))
}

impl Device for Gpu {
    fn walk(
        &self,
        walk: &DeviceWalk,
        photons: Range<u64>,
        stops: &dyn Fn() -> bool,
        progress: &dyn Fn(u64),
    ) -> Result<DeviceTally, String> {
        let numbers = WalkNumbers::new(walk)?;
        let slots = u64::from(self.slots).min(photons.end - photons.start).max(1) as u32;
        let work = Work::new(self, &numbers, slots)?;
        let mut tally = DeviceTally { exits: vec![(0, 0); numbers.bins.cells()], ..DeviceTally::default() };
        let mut first = photons.start;
        // The first batch launches photons in any case: to compile shaders may have taken all the time there was
        while first < photons.end && (first == photons.start || !stops()) {
            let batch = (photons.end - first).min(BATCH);
            let launched = work.walk(first, batch as u32, stops, progress, &mut tally)?;
            first += launched;
            if launched < batch {
                break;
            }
        }
        Ok(tally)
    }
}

/// Buffers and pipeline of a walk.
struct Work<'a> {
    gpu: &'a Gpu,
    numbers: &'a WalkNumbers,
    slots: u32,
    pipeline: wgpu::ComputePipeline,
    bindings: wgpu::BindGroup,
    settings: wgpu::Buffer,
    photons: wgpu::Buffer,
    counters: wgpu::Buffer,
    cells: wgpu::Buffer,
    counters_read: wgpu::Buffer,
    cells_read: wgpu::Buffer,
}

/// Counts of the photons of a batch, kept by the device while they walk.
#[derive(Clone, Copy, Default)]
struct Counters {
    asked: u32,
    ended: u32,
    absorbed: u32,
    collisions: u64,
}

impl Counters {
    const BYTES: u64 = 20;

    fn of(words: &[u32]) -> Option<Self> {
        let &[asked, ended, absorbed, low, high] = words else { return None };
        Some(Self { asked, ended, absorbed, collisions: u64::from(low) | u64::from(high) << 32 })
    }
}

impl<'a> Work<'a> {
    fn new(gpu: &'a Gpu, numbers: &'a WalkNumbers, slots: u32) -> Result<Self, String> {
        use wgpu::BufferUsages as Usage;
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("walk"),
            source: wgpu::ShaderSource::Wgsl(SHADERS.concat().into()),
        });
        let constants = [
            ("phase_function", f64::from(numbers.phase_function)),
            ("incidence", f64::from(numbers.incidence)),
            ("matched", f64::from(numbers.matched)),
            ("group_size", f64::from(gpu.group)),
        ];
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("walk"),
            layout: None,
            module: &module,
            entry_point: Some("walk"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..Default::default()
            },
            cache: None,
        });
        gpu.check()?;

        let words = numbers.settings(0, 0, slots, 0);
        let settings = gpu.buffer(4 * words.len() as u64, Usage::UNIFORM | Usage::COPY_DST);
        // A buffer is never empty
        let bounds =
            gpu.buffer(4 * numbers.bins.bounds.len().max(1) as u64, Usage::STORAGE | Usage::COPY_DST);
        let photons = gpu.buffer(4 * SLOT_WORDS * u64::from(slots), Usage::STORAGE | Usage::COPY_DST);
        let counters = gpu.buffer(Counters::BYTES, Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC);
        let bytes = 4 * (CELL_WORDS * numbers.bins.cells()) as u64;
        let cells = gpu.buffer(bytes, Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC);
        let counters_read = gpu.buffer(Counters::BYTES, Usage::MAP_READ | Usage::COPY_DST);
        let cells_read = gpu.buffer(bytes, Usage::MAP_READ | Usage::COPY_DST);
        gpu.queue.write_buffer(&bounds, 0, bytemuck::cast_slice(&numbers.bins.bounds));
        let entries = [&settings, &bounds, &photons, &counters, &cells];
        let entries: Vec<_> = (0..)
            .zip(entries)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        gpu.check()?;
        Ok(Self {
            gpu,
            numbers,
            slots,
            pipeline,
            bindings,
            settings,
            photons,
            counters,
            cells,
            counters_read,
            cells_read,
        })
    }

    /// Walks a batch, to its end or until all under way when it was stopped have ended; how many were launched.
    fn walk(
        &self,
        first: u64,
        batch: u32,
        stops: &dyn Fn() -> bool,
        progress: &dyn Fn(u64),
        tally: &mut DeviceTally,
    ) -> Result<u64, String> {
        let gpu = self.gpu;
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for buffer in [&self.photons, &self.counters, &self.cells] {
            encoder.clear_buffer(buffer, 0, None);
        }
        gpu.queue.submit([encoder.finish()]);

        let (mut photons, mut steps) = (batch, STEPS.0.min(gpu.most_steps));
        let counters = loop {
            let start = Instant::now();
            let counters = self.step(first, photons, steps)?;
            progress(tally.launched + u64::from(counters.ended));
            if stops() {
                photons = photons.min(counters.asked);
            }
            if counters.ended == photons {
                break counters;
            }
            let pace = DISPATCH_TIME.as_secs_f64() / start.elapsed().as_secs_f64();
            steps = ((f64::from(steps) * pace.clamp(0.25, 2.0)) as u32).clamp(1, gpu.most_steps);
        };

        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&self.cells, 0, &self.cells_read, 0, None);
        gpu.queue.submit([encoder.finish()]);
        let cells = gpu.read(&self.cells_read)?;
        for ((count, order_sum), &[more, low, high]) in tally.exits.iter_mut().zip(cells.as_chunks().0) {
            *count += u64::from(more);
            *order_sum += u64::from(low) | u64::from(high) << 32;
        }
        tally.launched += u64::from(photons);
        tally.absorbed += u64::from(counters.absorbed);
        tally.collisions += counters.collisions;
        Ok(u64::from(photons))
    }

    /// One dispatch.
    fn step(&self, first: u64, photons: u32, steps: u32) -> Result<Counters, String> {
        let gpu = self.gpu;
        let words = self.numbers.settings(first, photons, self.slots, steps);
        gpu.queue.write_buffer(&self.settings, 0, bytemuck::cast_slice(&words));
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.dispatch_workgroups(self.slots.div_ceil(gpu.group), 1, 1);
        drop(pass);
        encoder.copy_buffer_to_buffer(&self.counters, 0, &self.counters_read, 0, None);
        gpu.queue.submit([encoder.finish()]);
        Counters::of(&gpu.read(&self.counters_read)?)
            .ok_or_else(|| "the device sent too few counters".to_owned())
    }
}

#[cfg(test)]
mod tests;
