use wgpu::util::{DeviceExt, TextureDataOrder};
use wgpu::{BindGroup, BindingResource, Buffer, BufferUsages, Extent3d, TextureUsages, TextureView};

use crate::GpuError;
use crate::gpu::pipelines::{COLOUR_FORMAT, DEPTH_FORMAT, Pipelines};
use crate::layout::{FaceRecord, LightRecord, MaterialRecord};
use crate::plan::FramePlan;
use crate::upload::{
    UNIFORM_ALIGNMENT, aligned_uniforms, corner_records, grid_flags, grid_textures, rgba_texels, slabs,
};

/// Everything that a plan needs on the device.
pub(super) struct Resources {
    /// Vertex positions, for the shadow passes.
    pub(super) positions: Buffer,
    /// Corner indices into `positions`.
    pub(super) indices: Buffer,
    /// Three corners a triangle, for the shading pass.
    pub(super) corners: Buffer,
    /// The faces; one lies at each multiple of [`UNIFORM_ALIGNMENT`].
    pub(super) faces: BindGroup,
    /// Depth of the first surface of the face at work.
    pub(super) first_depth: TextureView,
    /// The same, to be read.
    pub(super) first: BindGroup,
    /// One view for each layer of the shadow maps.
    pub(super) shadow_layers: Vec<TextureView>,
    /// Frame, lights, shadow maps and grid.
    pub(super) frame: BindGroup,
    /// One for each material.
    pub(super) materials: Vec<BindGroup>,
    /// The picture, before it is reduced.
    pub(super) colour: wgpu::Texture,
    /// Depth of the picture.
    pub(super) depth: TextureView,
}

impl Resources {
    /// Checks the device's limits, then creates and fills all that `plan` needs.
    pub(super) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        plan: &FramePlan<'_>,
    ) -> Result<Self, GpuError> {
        check_limits(&device.limits(), plan)?;
        let maker = Maker { device, queue };
        let (width, height) = plan.sample_size();
        let size = plan.frame.shadow_size;
        let positions: Vec<[f32; 3]> = plan.geometry.positions.iter().map(|p| p.to_array()).collect();
        let faces = maker.buffer("faces", &aligned_uniforms(&plan.faces), BufferUsages::UNIFORM);
        let first_depth = maker.depth("first surface", [size, size, 1]);
        let layers = (plan.faces.len() as u32).max(1);
        let shadow_side = if plan.faces.is_empty() { 1 } else { size };
        let shadow_maps = maker.depth("shadow maps", [shadow_side, shadow_side, layers]);
        let (frame, materials) =
            (maker.frame_group(pipelines, plan, &shadow_maps), maker.material_groups(pipelines, plan));
        let first_depth = first_depth.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self {
            positions: maker.buffer("positions", bytemuck::cast_slice(&positions), BufferUsages::VERTEX),
            indices: maker.buffer(
                "indices",
                bytemuck::cast_slice(plan.geometry.triangles.as_flattened()),
                BufferUsages::INDEX,
            ),
            corners: maker.buffer(
                "corners",
                bytemuck::cast_slice(&corner_records(&plan.geometry)),
                BufferUsages::VERTEX,
            ),
            faces: maker.group(&pipelines.face_layout, &[part_of(&faces, 0, size_of::<FaceRecord>())]),
            first: maker.group(&pipelines.first_layout, &[BindingResource::TextureView(&first_depth)]),
            first_depth,
            shadow_layers: (0..plan.faces.len() as u32)
                .map(|layer| layer_view(&shadow_maps, layer))
                .collect(),
            frame,
            materials,
            colour: device.create_texture(&descriptor(
                "picture",
                [width, height, 1],
                wgpu::TextureDimension::D2,
                COLOUR_FORMAT,
                TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
            )),
            depth: maker
                .depth("depth", [width, height, 1])
                .create_view(&wgpu::TextureViewDescriptor::default()),
        })
    }
}

struct Maker<'a> {
    device: &'a wgpu::Device,
    queue: &'a wgpu::Queue,
}

impl Maker<'_> {
    /// A buffer with `contents`; WebGPU has no empty buffers to bind, so there is always a byte.
    fn buffer(&self, label: &str, contents: &[u8], usage: BufferUsages) -> Buffer {
        let contents = if contents.is_empty() { &[0; 4] } else { contents };
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents,
            usage,
        })
    }

    fn depth(&self, label: &str, size: [u32; 3]) -> wgpu::Texture {
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        self.device.create_texture(&descriptor(label, size, wgpu::TextureDimension::D2, DEPTH_FORMAT, usage))
    }

    fn texture(
        &self,
        label: &str,
        size: [u32; 3],
        dimension: wgpu::TextureDimension,
        format: wgpu::TextureFormat,
        texels: &[u8],
    ) -> TextureView {
        let descriptor = descriptor(label, size, dimension, format, TextureUsages::TEXTURE_BINDING);
        self.device
            .create_texture_with_data(self.queue, &descriptor, TextureDataOrder::LayerMajor, texels)
            .create_view(&wgpu::TextureViewDescriptor::default())
    }

    fn group(&self, layout: &wgpu::BindGroupLayout, resources: &[BindingResource<'_>]) -> BindGroup {
        let entries: Vec<wgpu::BindGroupEntry<'_>> = (0u32..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    fn frame_group(
        &self,
        pipelines: &Pipelines,
        plan: &FramePlan<'_>,
        shadow_maps: &wgpu::Texture,
    ) -> BindGroup {
        let mut record = plan.frame;
        // Without a grid, textures of one texel that no lookup reads.
        let (mut dims, mut depth) = ([1; 3], 1);
        let mut textures = [0, 1, 2].map(|_| vec![half::f16::ZERO; 4]);
        let mut flags = vec![0];
        if let Some(lookup) = plan.grid {
            dims = lookup.grid.lattice().dims.map(u32::from);
            depth = dims[2] * slabs(lookup.grid.quantity()) as u32;
            (textures, record.value_scale) = grid_textures(lookup.grid);
            flags = grid_flags(lookup.grid);
        }
        let stacked = [dims[0], dims[1], depth];
        let volume = wgpu::TextureDimension::D3;
        let [grid_x, grid_y, grid_z] = textures.map(|texels| {
            let bytes = bytemuck::cast_slice(&texels);
            self.texture("grid", stacked, volume, wgpu::TextureFormat::Rgba16Float, bytes)
        });
        let flags = self.texture("grid flags", dims, volume, wgpu::TextureFormat::R8Uint, &flags);
        let sampler = self.device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..wgpu::SamplerDescriptor::default()
        });
        let maps = shadow_maps.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..wgpu::TextureViewDescriptor::default()
        });
        let no_light = [LightRecord::default()];
        let lights = if plan.lights.is_empty() { &no_light } else { plan.lights.as_slice() };
        let frame = self.buffer("frame", bytemuck::bytes_of(&record), BufferUsages::UNIFORM);
        let lights = self.buffer("lights", bytemuck::cast_slice(lights), BufferUsages::STORAGE);
        self.group(
            &pipelines.frame_layout,
            &[
                frame.as_entire_binding(),
                lights.as_entire_binding(),
                BindingResource::TextureView(&maps),
                BindingResource::TextureView(&grid_x),
                BindingResource::TextureView(&grid_y),
                BindingResource::TextureView(&grid_z),
                BindingResource::TextureView(&flags),
                BindingResource::Sampler(&sampler),
            ],
        )
    }

    fn material_groups(&self, pipelines: &Pipelines, plan: &FramePlan<'_>) -> Vec<BindGroup> {
        let srgb = wgpu::TextureFormat::Rgba8UnormSrgb;
        let flat = wgpu::TextureDimension::D2;
        let plain = self.texture("no texture", [1, 1, 1], flat, srgb, &[255; 4]);
        // Materials often share a texture: each goes to the device once.
        let mut known: Vec<(&ivg_scene::Texture, TextureView)> = Vec::new();
        for texture in plan.material_textures.iter().flatten() {
            if !known.iter().any(|(other, _)| std::ptr::eq(*other, *texture)) {
                let size = [texture.width, texture.height, 1];
                known.push((texture, self.texture(&texture.name, size, flat, srgb, &rgba_texels(texture))));
            }
        }
        let records = self.buffer("materials", &aligned_uniforms(&plan.materials), BufferUsages::UNIFORM);
        plan.material_textures
            .iter()
            .enumerate()
            .map(|(index, texture)| {
                let view = texture
                    .and_then(|texture| known.iter().find(|(other, _)| std::ptr::eq(*other, texture)))
                    .map_or(&plain, |(_, view)| view);
                let record = part_of(&records, index, size_of::<MaterialRecord>());
                self.group(&pipelines.material_layout, &[record, BindingResource::TextureView(view)])
            })
            .collect()
    }
}

/// The record at the `index`-th multiple of the alignment.
fn part_of(buffer: &Buffer, index: usize, bytes: usize) -> BindingResource<'_> {
    BindingResource::Buffer(wgpu::BufferBinding {
        buffer,
        offset: (index * UNIFORM_ALIGNMENT) as u64,
        size: wgpu::BufferSize::new(bytes as u64),
    })
}

fn layer_view(shadow_maps: &wgpu::Texture, layer: u32) -> TextureView {
    shadow_maps.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_array_layer: layer,
        array_layer_count: Some(1),
        ..wgpu::TextureViewDescriptor::default()
    })
}

fn descriptor<'a>(
    label: &'a str,
    [width, height, depth_or_array_layers]: [u32; 3],
    dimension: wgpu::TextureDimension,
    format: wgpu::TextureFormat,
    usage: TextureUsages,
) -> wgpu::TextureDescriptor<'a> {
    wgpu::TextureDescriptor {
        label: Some(label),
        size: Extent3d { width, height, depth_or_array_layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension,
        format,
        usage,
        view_formats: &[],
    }
}

fn check_limits(limits: &wgpu::Limits, plan: &FramePlan<'_>) -> Result<(), GpuError> {
    let within = |what, needed: u64, limit: u64| {
        if needed <= limit { Ok(()) } else { Err(GpuError::Limit { what, needed, limit }) }
    };
    let (width, height) = plan.sample_size();
    let plane = u64::from(limits.max_texture_dimension_2d);
    within("samples along a side of the picture", u64::from(width.max(height)), plane)?;
    within("layers of shadow maps", plan.faces.len() as u64, u64::from(limits.max_texture_array_layers))?;
    for texture in plan.material_textures.iter().flatten() {
        within("texels along a side of a texture", u64::from(texture.width.max(texture.height)), plane)?;
    }
    if let Some(lookup) = plan.grid {
        let [x, y, z] = lookup.grid.lattice().dims.map(u64::from);
        let deepest = x.max(y).max(z * slabs(lookup.grid.quantity()) as u64);
        within("texels along a side of the grid", deepest, u64::from(limits.max_texture_dimension_3d))?;
    }
    let buffers = [
        ("bytes of vertices", 3 * plan.geometry.triangles.len() * size_of::<crate::upload::CornerRecord>()),
        ("bytes of positions", plan.geometry.positions.len() * size_of::<[f32; 3]>()),
        ("bytes of the picture", super::execute::row_bytes(width) as usize * height as usize),
    ];
    for (what, bytes) in buffers {
        within(what, bytes as u64, limits.max_buffer_size)?;
    }
    Ok(())
}
