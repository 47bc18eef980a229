//! Two passes on a device: a mesh into a G-buffer, and the light that leaves its surface.

use bytemuck::cast_slice;
use glam::{Mat4, Vec4};
use wgpu::{BufferUsages as Usage, TextureFormat as Format};

/// Formats of irradiance, position and normal, and of the result.
const TARGETS: [Format; 3] = [Format::Rgba16Float, Format::Rgba32Float, Format::Rgba16Float];
const RESULT: Format = Format::Rgba32Float;
const DEPTH: Format = Format::Depth32Float;

/// A device and the side of what it draws, in pixels.
pub(crate) struct Canvas {
    name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
    size: u32,
}

/// A mesh and how it is seen.
pub(crate) struct Frame<'a> {
    /// Position and normal of each vertex.
    pub(crate) vertices: &'a [f32],
    pub(crate) triangles: &'a [u32],
    pub(crate) view: View,
}

/// Camera and light, as the shaders have them.
pub(crate) struct View {
    pub(crate) clip_from_world: Mat4,
    pub(crate) light: Vec4,
}

impl Canvas {
    /// Opens the device that `TRANSLUCID_DEVICE` names by a part of its name, or the first.
    pub(crate) fn open(size: u32) -> Result<Self, String> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        let wanted = std::env::var("TRANSLUCID_DEVICE").unwrap_or_default().to_lowercase();
        let is_wanted = |adapter: &wgpu::Adapter| adapter.get_info().name.to_lowercase().contains(&wanted);
        let adapter = adapters.into_iter().find(is_wanted).ok_or_else(|| {
            format!("there is no device for Vulkan, Metal or DirectX 12 whose name has {wanted:?} in it")
        })?;
        let made = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()));
        let (device, queue) = made.map_err(|error| error.to_string())?;
        Ok(Self { name: adapter.get_info().name, device, queue, size })
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Draws a mesh, scatters its light by an exported disk, and returns red, green, blue and coverage of the pixels.
    pub(crate) fn draw(
        &self,
        frame: &Frame<'_>,
        exported: &str,
        taps: u32,
        turns: u32,
    ) -> Result<Vec<f32>, String> {
        let (matrix, light) = (frame.view.clip_from_world.to_cols_array(), frame.view.light.to_array());
        let view = self.buffer(Usage::UNIFORM, cast_slice(&[&matrix[..], &light].concat()));
        let vertices = self.buffer(Usage::VERTEX, cast_slice(frame.vertices));
        let triangles = self.buffer(Usage::INDEX, cast_slice(frame.triangles));
        let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
        let layout = wgpu::VertexBufferLayout {
            array_stride: 24,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        };
        let text = include_str!("gbuffer.wgsl");
        let gbuffer = self.pipeline(text, &[Some(layout)], &TARGETS, true, &[]);
        let text = format!("{exported}\n{}", include_str!("scatter.wgsl"));
        let constants = [("taps", f64::from(taps)), ("turns", f64::from(turns))];
        let scatter = self.pipeline(&text, &[], &[RESULT], false, &constants);

        let targets = TARGETS.map(|format| self.texture(format));
        let views = targets.each_ref().map(|one| one.create_view(&Default::default()));
        let result = self.texture(RESULT);
        let depth = self.texture(DEPTH).create_view(&Default::default());
        let bind = |pipeline: &wgpu::RenderPipeline, textures: &[wgpu::TextureView]| {
            let textures = textures.iter().map(wgpu::BindingResource::TextureView);
            let resources = [view.as_entire_binding()].into_iter().chain(textures);
            let entries: Vec<_> = (0..)
                .zip(resources)
                .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
                .collect();
            let layout = &pipeline.get_bind_group_layout(0);
            self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout,
                entries: &entries,
            })
        };

        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let attachments = views.each_ref().map(attachment);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &attachments,
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &depth,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(1.0),
                        store: wgpu::StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_pipeline(&gbuffer);
            pass.set_bind_group(0, &bind(&gbuffer, &[]), &[]);
            pass.set_vertex_buffer(0, vertices.slice(..));
            pass.set_index_buffer(triangles.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..frame.triangles.len() as u32, 0, 0..1);
        }
        {
            let out = result.create_view(&Default::default());
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[attachment(&out)],
                ..Default::default()
            });
            pass.set_pipeline(&scatter);
            pass.set_bind_group(0, &bind(&scatter, &views), &[]);
            pass.draw(0..3, 0..1);
        }
        self.read(encoder, &result)
    }

    /// A pipeline from the functions `vertex` and `fragment` of a text.
    fn pipeline(
        &self,
        text: &str,
        buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
        targets: &[Format],
        has_depth: bool,
        constants: &[(&str, f64)],
    ) -> wgpu::RenderPipeline {
        let source = wgpu::ShaderSource::Wgsl(text.into());
        let module = &self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let compilation_options = wgpu::PipelineCompilationOptions { constants, ..Default::default() };
        let targets: Vec<_> = targets.iter().map(|format| Some((*format).into())).collect();
        let depth_stencil = has_depth.then(|| wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: Default::default(),
            bias: Default::default(),
        });
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: None,
            vertex: wgpu::VertexState {
                module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers,
            },
            primitive: Default::default(),
            depth_stencil,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some("fragment"),
                compilation_options,
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    fn buffer(&self, usage: Usage, bytes: &[u8]) -> wgpu::Buffer {
        let size = bytes.len() as u64;
        let usage = usage | Usage::COPY_DST;
        let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
        let buffer = self.device.create_buffer(&descriptor);
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    fn texture(&self, format: Format) -> wgpu::Texture {
        use wgpu::TextureUsages as Usage;

        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: self.extent(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING | Usage::COPY_SRC,
            view_formats: &[],
        })
    }

    fn extent(&self) -> wgpu::Extent3d {
        wgpu::Extent3d { width: self.size, height: self.size, depth_or_array_layers: 1 }
    }

    /// Ends the work and waits for the numbers of a texture.
    fn read(&self, mut encoder: wgpu::CommandEncoder, texture: &wgpu::Texture) -> Result<Vec<f32>, String> {
        let row = 16 * self.size; // A multiple of 256, as copies demand
        let descriptor = wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row * self.size),
            usage: Usage::MAP_READ | Usage::COPY_DST,
            mapped_at_creation: false,
        };
        let buffer = self.device.create_buffer(&descriptor);
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
        let destination = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), destination, self.extent());
        self.queue.submit([encoder.finish()]);
        let (send, receive) = std::sync::mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |mapped| drop(send.send(mapped)));
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| error.to_string())?;
        receive.recv().map_err(|error| error.to_string())?.map_err(|error| error.to_string())?;
        let bytes = buffer.get_mapped_range(..).map_err(|error| error.to_string())?;
        Ok(bytemuck::pod_collect_to_vec(&bytes[..]))
    }
}

/// A texture that is cleared and then drawn into.
fn attachment(view: &wgpu::TextureView) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let ops =
        wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store };
    Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
}
