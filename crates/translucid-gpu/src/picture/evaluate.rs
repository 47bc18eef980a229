//! Functions of the shaders on many inputs at once, for tests that hold them against their twins on the CPU.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::{Mutex, OnceLock};

use crate::device::{Gpu, devices};

/// The device of the tests: `TRANSLUCID_DEVICE` names it, else it is the first that the system has, of any kind.
pub(crate) fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(open)
}

pub(crate) fn open() -> Gpu {
    let first =
        || devices().into_iter().next().expect("a device: on a machine without one, Mesa's llvmpipe").name;
    Gpu::open(&std::env::var("TRANSLUCID_DEVICE").unwrap_or_else(|_| first())).unwrap()
}

/// Statements of WGSL, run for every input.
pub(crate) struct Evaluation<'a> {
    /// Texts of the shaders that they call.
    pub(crate) shaders: &'a [&'a str],
    /// Statements that read `inputs[i]`, `inputs[i + 1]` … and write `outputs[o]`, `outputs[o + 1]` …
    pub(crate) body: &'a str,
    /// Values of the global array `tables`.
    pub(crate) tables: &'a [f32],
    /// Values of the global array `images`.
    pub(crate) images: &'a [u32],
    /// Numbers that an input and an output have.
    pub(crate) widths: [usize; 2],
}

impl Evaluation<'_> {
    /// The outputs of all inputs, one after the other.
    pub(crate) fn run(&self, inputs: &[f32]) -> Vec<f32> {
        use wgpu::BufferUsages as Usage;
        let gpu = gpu();
        let [width_in, width_out] = self.widths;
        let count = inputs.len() / width_in;
        let pipeline = self.pipeline(gpu);
        let filled = |words: &[u32]| {
            let buffer = gpu.buffer(4 * words.len().max(1) as u64, Usage::STORAGE | Usage::COPY_DST);
            gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(words));
            buffer
        };
        let bytes = 4 * (count * width_out) as u64;
        let outputs = gpu.buffer(bytes, Usage::STORAGE | Usage::COPY_SRC);
        let read = gpu.buffer(bytes, Usage::MAP_READ | Usage::COPY_DST);
        let buffers = [
            &filled(bytemuck::cast_slice(self.tables)),
            &filled(self.images),
            &filled(bytemuck::cast_slice(inputs)),
            &outputs,
        ];
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let device = &gpu.device;
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups((count as u32).div_ceil(64), 1, 1);
        drop(pass);
        encoder.copy_buffer_to_buffer(&outputs, 0, &read, 0, None);
        gpu.queue.submit([encoder.finish()]);
        gpu.read(&read).unwrap().into_iter().map(f32::from_bits).collect()
    }

    /// The statements for the device, which are translated once.
    fn pipeline(&self, gpu: &Gpu) -> wgpu::ComputePipeline {
        static MADE: Mutex<BTreeMap<String, wgpu::ComputePipeline>> = Mutex::new(BTreeMap::new());
        let text = self.text();
        let mut made = MADE.lock().unwrap();
        if let Some(pipeline) = made.get(&text) {
            return pipeline.clone();
        }
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("evaluate"),
            source: wgpu::ShaderSource::Wgsl(text.as_str().into()),
        });
        let entry = |binding: u32| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: binding < 3 },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let bindings = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[0, 1, 2, 3].map(entry),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&bindings)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&layout),
            module: &module,
            entry_point: Some("evaluate"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        gpu.check().unwrap();
        made.insert(text, pipeline.clone());
        pipeline
    }

    fn text(&self) -> String {
        let [width_in, width_out] = self.widths;
        let mut text = self.shaders.concat();
        let _ = write!(
            text,
            "
@group(0) @binding(0) var<storage, read> tables: array<f32>;
@group(0) @binding(1) var<storage, read> images: array<u32>;
@group(0) @binding(2) var<storage, read> inputs: array<f32>;
@group(0) @binding(3) var<storage, read_write> outputs: array<f32>;
@compute @workgroup_size(64)
fn evaluate(@builtin(global_invocation_id) id: vec3<u32>) {{
    if (id.x >= arrayLength(&inputs) / {width_in}u) {{
        return;
    }}
    let i = id.x * {width_in}u;
    let o = id.x * {width_out}u;
    {}
}}",
            self.body
        );
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_run_for_every_input() {
        let evaluation = Evaluation {
            shaders: &["fn twice(x: f32) -> f32 { return 2.0 * x; }\n"],
            body: "outputs[o] = twice(inputs[i]) + tables[1]; outputs[o + 1] = bitcast<f32>(images[0]);",
            tables: &[7.0, 0.5],
            images: &[1.25_f32.to_bits()],
            widths: [1, 2],
        };
        let inputs: Vec<f32> = (0..1000_u16).map(f32::from).collect();
        for (x, found) in inputs.iter().zip(evaluation.run(&inputs).chunks(2)) {
            assert_eq!(found, [2.0 * x + 0.5, 1.25]);
        }
    }
}
