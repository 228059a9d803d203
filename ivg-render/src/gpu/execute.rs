use glam::Vec3;
use wgpu::{CommandEncoder, LoadOp, Operations, StoreOp, TextureView};

use crate::gpu::mesh::GpuMesh;
use crate::gpu::pipelines::Pipelines;
use crate::gpu::resources::Resources;
use crate::plan::{FramePlan, Pass};
use crate::upload::UNIFORM_ALIGNMENT;
use crate::{GpuError, Image};

/// Bytes of a sample of the picture: four f32.
const SAMPLE_BYTES: u32 = 16;

/// Fourth number of a sample that sees no surface; the shading pass writes 1.
const NOTHING: f64 = 0.0;

/// Carries out a plan, with progressive meshes beside its geometry, and waits for the picture.
pub(super) fn frame(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    pipelines: &Pipelines,
    plan: &FramePlan<'_>,
    meshes: &[&GpuMesh],
) -> Result<Image, GpuError> {
    let resources = Resources::new(device, queue, pipelines, plan)?;
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let scene = Recorded { device, pipelines, plan, resources: &resources, meshes };
    for pass in plan.passes() {
        scene.record(&mut encoder, pass);
    }
    let (width, height) = plan.sample_size();
    let bytes_per_row = row_bytes(width);
    let readback = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: u64::from(bytes_per_row) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    encoder.copy_texture_to_buffer(
        resources.colour.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &readback,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(bytes_per_row),
                rows_per_image: None,
            },
        },
        resources.colour.size(),
    );
    queue.submit([encoder.finish()]);
    let (sender, receiver) = std::sync::mpsc::channel();
    readback.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver waits below, until this is called or dropped.
        let _ = sender.send(result);
    });
    let failed = |reason: String| GpuError::Device(format!("the picture cannot be read back: {reason}"));
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(error.to_string()))?;
    receiver.recv().map_err(|error| failed(error.to_string()))?.map_err(|error| failed(error.to_string()))?;
    let bytes = readback.get_mapped_range(..).map_err(|error| failed(error.to_string()))?;
    let mut pixels = Vec::with_capacity(width as usize * height as usize);
    for row in bytes.chunks_exact(bytes_per_row as usize) {
        for sample in row.chunks_exact(SAMPLE_BYTES as usize).take(width as usize) {
            let [r, g, b, surface]: [f32; 4] = bytemuck::pod_read_unaligned(sample);
            let nothing = surface == NOTHING as f32;
            pixels.push(if nothing { plan.background.radiance(pixels.len()) } else { Vec3::new(r, g, b) });
        }
    }
    Ok(Image::new(width, height, pixels).reduced(plan.supersampling))
}

/// Bytes from one row of the picture to the next when it is read back.
pub(super) fn row_bytes(width: u32) -> u32 {
    (width * SAMPLE_BYTES).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// What passes are recorded from.
struct Recorded<'a> {
    device: &'a wgpu::Device,
    pipelines: &'a Pipelines,
    plan: &'a FramePlan<'a>,
    resources: &'a Resources,
    meshes: &'a [&'a GpuMesh],
}

impl Recorded<'_> {
    fn record(&self, encoder: &mut CommandEncoder, pass: Pass) {
        let Self { pipelines, resources, .. } = *self;
        match pass {
            Pass::ShadowFirst { layer } => {
                let mut pass = depth_pass(encoder, "first surface", &resources.first_depth);
                pass.set_pipeline(&pipelines.shadow_first);
                pass.set_bind_group(0, &resources.faces, &[layer * UNIFORM_ALIGNMENT as u32]);
                self.draw_depth(&mut pass);
            }
            Pass::ShadowLimit { layer } => {
                let mut pass = depth_pass(encoder, "limit", &resources.shadow_layers[layer as usize]);
                pass.set_bind_group(0, &resources.faces, &[layer * UNIFORM_ALIGNMENT as u32]);
                pass.set_bind_group(1, &resources.first, &[]);
                pass.set_pipeline(&pipelines.shadow_limit_first);
                pass.draw(0..3, 0..1);
                pass.set_pipeline(&pipelines.shadow_limit_second);
                self.draw_depth(&mut pass);
            }
            Pass::Shade => self.record_shade(encoder),
        }
    }

    /// Every surface, for a shadow map.
    fn draw_depth(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.resources.positions.slice(..));
        pass.set_index_buffer(self.resources.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..3 * self.plan.geometry.triangles.len() as u32, 0, 0..1);
        self.meshes.iter().for_each(|mesh| mesh.draw_depth(pass));
    }

    fn record_shade(&self, encoder: &mut CommandEncoder) {
        let Self { device, pipelines, plan, resources, meshes } = *self;
        let view = resources.colour.create_view(&wgpu::TextureViewDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shade"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: Operations {
                    load: LoadOp::Clear(wgpu::Color { r: 0.0, g: 0.0, b: 0.0, a: NOTHING }),
                    store: StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(cleared(&resources.depth)),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&pipelines.shade);
        pass.set_bind_group(0, &resources.frame, &[]);
        pass.set_vertex_buffer(0, resources.corners.slice(..));
        for draw in &plan.geometry.draws {
            pass.set_bind_group(1, &resources.materials[draw.material as usize], &[]);
            pass.draw(3 * draw.triangles.start..3 * draw.triangles.end, 0..1);
        }
        if !meshes.is_empty() {
            pass.set_pipeline(&pipelines.shade_mesh);
            pass.set_bind_group(0, &resources.frame, &[]);
            meshes
                .iter()
                .for_each(|mesh| mesh.draw_shaded(device, pipelines, &mut pass, &resources.materials));
        }
    }
}

fn depth_pass<'a>(encoder: &'a mut CommandEncoder, label: &str, view: &TextureView) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        depth_stencil_attachment: Some(cleared(view)),
        ..wgpu::RenderPassDescriptor::default()
    })
}

/// A depth attachment cleared to 0, which is infinitely far.
fn cleared(view: &TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(Operations { load: LoadOp::Clear(0.0), store: StoreOp::Store }),
        stencil_ops: None,
    }
}
