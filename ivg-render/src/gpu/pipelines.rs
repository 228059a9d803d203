use std::mem::offset_of;

use wgpu::{
    BindGroupLayout, BindGroupLayoutEntry, BindingType, BufferBindingType, ShaderStages, TextureSampleType,
    TextureViewDimension,
};

use crate::layout::{FaceRecord, FrameRecord, LightRecord, MaterialRecord};
use crate::upload::CornerRecord;

/// Depth of shadow maps and of the view.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Linear radiance.
pub(super) const COLOUR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Source of the module of the shadow passes.
pub(crate) const SHADOW_SHADER: &str =
    concat!(include_str!("../shaders/shared.wgsl"), include_str!("../shaders/shadow.wgsl"));

/// Source of the module of the shading pass.
pub(crate) const SHADE_SHADER: &str = concat!(
    include_str!("../shaders/shared.wgsl"),
    include_str!("../shaders/shade.wgsl"),
    include_str!("../shaders/mesh.wgsl"),
    include_str!("../shaders/direct.wgsl"),
    include_str!("../shaders/irradiance.wgsl"),
);

/// Pipelines and the layouts of what is bound to them.
#[derive(Debug)]
pub(super) struct Pipelines {
    /// Group 0 of the shadow passes: the face, at a dynamic offset.
    pub(super) face_layout: BindGroupLayout,
    /// Group 1 of the limit pass: the depth of the first surface.
    pub(super) first_layout: BindGroupLayout,
    /// Group 0 of the shading pass: frame, lights, shadow maps, grid.
    pub(super) frame_layout: BindGroupLayout,
    /// Group 1 of the shading pass: material and its texture.
    pub(super) material_layout: BindGroupLayout,
    /// Group 2 of the shading pass of progressive meshes: positions, normals, texture coordinates, corners, materials.
    pub(super) mesh_layout: BindGroupLayout,
    /// Depth of the first surface.
    pub(super) shadow_first: wgpu::RenderPipeline,
    /// The limit where there is no second surface, for every texel.
    pub(super) shadow_limit_first: wgpu::RenderPipeline,
    /// The limit where there is one.
    pub(super) shadow_limit_second: wgpu::RenderPipeline,
    /// Shading.
    pub(super) shade: wgpu::RenderPipeline,
    /// Shading of progressive meshes.
    pub(super) shade_mesh: wgpu::RenderPipeline,
}

impl Pipelines {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let module = |label, source: &'static str| {
            let source = wgpu::ShaderSource::Wgsl(source.into());
            device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(label), source })
        };
        let shadow = module("shadow", SHADOW_SHADER);
        let shade_module = module("shade", SHADE_SHADER);
        let group = |label, entries: &[BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let both = ShaderStages::VERTEX_FRAGMENT;
        let fragment = ShaderStages::FRAGMENT;
        let face_layout = group("face", &[entry(0, both, uniform(size_of::<FaceRecord>(), true))]);
        let first_layout = group(
            "first surface",
            &[entry(0, fragment, texture(TextureSampleType::Depth, TextureViewDimension::D2))],
        );
        let filterable = TextureSampleType::Float { filterable: true };
        let grid_texture = texture(filterable, TextureViewDimension::D3);
        let frame_layout = group(
            "frame",
            &[
                entry(0, both, uniform(size_of::<FrameRecord>(), false)),
                entry(1, fragment, storage(size_of::<LightRecord>())),
                entry(2, fragment, texture(TextureSampleType::Depth, TextureViewDimension::D2Array)),
                entry(3, fragment, grid_texture),
                entry(4, fragment, grid_texture),
                entry(5, fragment, grid_texture),
                entry(6, fragment, texture(TextureSampleType::Uint, TextureViewDimension::D3)),
                entry(7, fragment, BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            ],
        );
        let material_layout = group(
            "material",
            &[
                entry(0, fragment, uniform(size_of::<MaterialRecord>(), false)),
                entry(1, fragment, texture(filterable, TextureViewDimension::D2)),
            ],
        );
        let array = |binding| entry(binding, ShaderStages::VERTEX, storage(size_of::<f32>()));
        let mesh_layout = group("mesh", &[0, 1, 2, 3, 4].map(array));
        let pipeline = |recipe: Recipe<'_>| recipe.build(device);
        let positions = wgpu::VertexBufferLayout {
            array_stride: size_of::<[f32; 3]>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3],
        };
        let corners = wgpu::VertexBufferLayout {
            array_stride: size_of::<CornerRecord>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &[
                attribute(0, wgpu::VertexFormat::Float32x3, offset_of!(CornerRecord, position)),
                attribute(1, wgpu::VertexFormat::Float32x3, offset_of!(CornerRecord, normal)),
                attribute(2, wgpu::VertexFormat::Float32x2, offset_of!(CornerRecord, uv)),
                attribute(3, wgpu::VertexFormat::Float32x3, offset_of!(CornerRecord, face_normal)),
            ],
        };
        let shadow_first = pipeline(Recipe {
            label: "first surface",
            module: &shadow,
            groups: &[Some(&face_layout)],
            vertex: "vertex_shadow",
            buffer: Some(positions.clone()),
            fragment: None,
            colour: None,
            compare: wgpu::CompareFunction::Greater,
        });
        let limit_groups = [Some(&face_layout), Some(&first_layout)];
        let shadow_limit_first = pipeline(Recipe {
            label: "limit of the first surface",
            module: &shadow,
            groups: &limit_groups,
            vertex: "vertex_everywhere",
            buffer: None,
            fragment: Some("fragment_first"),
            colour: None,
            compare: wgpu::CompareFunction::Always,
        });
        let shadow_limit_second = pipeline(Recipe {
            label: "limit of the second surface",
            module: &shadow,
            groups: &limit_groups,
            vertex: "vertex_shadow",
            buffer: Some(positions),
            fragment: Some("fragment_second"),
            colour: None,
            compare: wgpu::CompareFunction::Greater,
        });
        let shade = pipeline(Recipe {
            label: "shade",
            module: &shade_module,
            groups: &[Some(&frame_layout), Some(&material_layout)],
            vertex: "vertex_shade",
            buffer: Some(corners),
            fragment: Some("fragment_shade"),
            colour: Some(COLOUR_FORMAT),
            compare: wgpu::CompareFunction::Greater,
        });
        let shade_mesh = pipeline(Recipe {
            label: "shade progressive meshes",
            module: &shade_module,
            groups: &[Some(&frame_layout), Some(&material_layout), Some(&mesh_layout)],
            vertex: "vertex_mesh",
            buffer: None,
            fragment: Some("fragment_shade"),
            colour: Some(COLOUR_FORMAT),
            compare: wgpu::CompareFunction::Greater,
        });
        Self {
            face_layout,
            first_layout,
            frame_layout,
            material_layout,
            mesh_layout,
            shadow_first,
            shadow_limit_first,
            shadow_limit_second,
            shade,
            shade_mesh,
        }
    }
}

/// What the pipelines differ in.
struct Recipe<'a> {
    label: &'static str,
    module: &'a wgpu::ShaderModule,
    groups: &'a [Option<&'a BindGroupLayout>],
    vertex: &'static str,
    buffer: Option<wgpu::VertexBufferLayout<'a>>,
    fragment: Option<&'static str>,
    colour: Option<wgpu::TextureFormat>,
    compare: wgpu::CompareFunction,
}

impl Recipe<'_> {
    fn build(self, device: &wgpu::Device) -> wgpu::RenderPipeline {
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.label),
            bind_group_layouts: self.groups,
            immediate_size: 0,
        });
        let buffers: Vec<Option<wgpu::VertexBufferLayout<'_>>> = self.buffer.into_iter().map(Some).collect();
        let targets: Vec<Option<wgpu::ColorTargetState>> =
            self.colour.into_iter().map(|format| Some(format.into())).collect();
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(self.vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &buffers,
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(self.compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: self.fragment.map(|entry_point| wgpu::FragmentState {
                module: self.module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

fn entry(binding: u32, visibility: ShaderStages, ty: BindingType) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

fn uniform(bytes: usize, has_dynamic_offset: bool) -> BindingType {
    let min_binding_size = wgpu::BufferSize::new(bytes as u64);
    BindingType::Buffer { ty: BufferBindingType::Uniform, has_dynamic_offset, min_binding_size }
}

fn storage(bytes: usize) -> BindingType {
    BindingType::Buffer {
        ty: BufferBindingType::Storage { read_only: true },
        has_dynamic_offset: false,
        min_binding_size: wgpu::BufferSize::new(bytes as u64),
    }
}

fn texture(sample_type: TextureSampleType, view_dimension: TextureViewDimension) -> BindingType {
    BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

fn attribute(shader_location: u32, format: wgpu::VertexFormat, offset: usize) -> wgpu::VertexAttribute {
    wgpu::VertexAttribute { format, offset: offset as u64, shader_location }
}
