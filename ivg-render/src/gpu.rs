//! The renderer on a GPU: carries out a [`FramePlan`] through wgpu, headless. All wgpu code is in this module.
//!
//! WebGPU's default limits suffice; what a scene needs beyond them is a [`GpuError::Limit`] before anything is
//! allocated. The shader modules are the files of `shaders/` put together, so constants and structures have one home.

mod device;
mod execute;
mod mesh;
mod pipelines;
mod resources;

use crate::plan::FramePlan;
use crate::{Image, RenderError, RenderOptions, RenderScene};
pub use mesh::GpuMesh;
use pipelines::Pipelines;
#[cfg(test)]
pub(crate) use pipelines::{SHADE_SHADER, SHADOW_SHADER};

/// What to install when a machine has no GPU that wgpu can use: Mesa's software Vulkan.
pub const INSTALL_SOFTWARE_ADAPTER: &str =
    "apt-get install -y --no-install-recommends mesa-vulkan-drivers libvulkan1";

/// Why a picture could not be made on a GPU.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No GPU, nor a software one.
    #[error("no adapter for wgpu: {0}; a software one on Debian: {INSTALL_SOFTWARE_ADAPTER}")]
    NoAdapter(String),
    /// The scene itself is at fault.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The scene needs more than every WebGPU device has; the CPU renderer has no such limit.
    #[error("{what}: {needed} needed, {limit} available; render on the CPU or use less")]
    Limit {
        /// What there is too little of.
        what: &'static str,
        /// How much is needed.
        needed: u64,
        /// How much there is.
        limit: u64,
    },
    /// The device failed or ran out of memory.
    #[error("the GPU failed: {0}")]
    Device(String),
}

/// A GPU with the pipelines of the renderer; renders any number of scenes.
#[derive(Debug)]
pub struct GpuRenderer {
    adapter: wgpu::AdapterInfo,
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipelines: Pipelines,
}

impl GpuRenderer {
    /// Opens the fastest adapter; a software one if there is no other.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoAdapter`] if there is none, [`GpuError::Device`] if it cannot be opened.
    pub fn new() -> Result<Self, GpuError> {
        let (adapter, device, queue) = device::open()?;
        let pipelines = device::checked(&device, || Ok(Pipelines::new(&device)))?;
        Ok(Self { adapter, device, queue, pipelines })
    }

    /// Name of the adapter, as its driver gives it.
    #[must_use]
    pub fn adapter_name(&self) -> &str {
        &self.adapter.name
    }

    /// Whether the adapter computes on the CPU; [`render_cpu`](crate::render_cpu) is faster then.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.adapter.device_type == wgpu::DeviceType::Cpu
    }

    /// Renders a scene: the picture of [`render_cpu`](crate::render_cpu), up to rounding.
    ///
    /// # Errors
    ///
    /// [`GpuError::Render`], [`GpuError::Limit`] or [`GpuError::Device`].
    pub fn render(&self, scene: &RenderScene, options: &RenderOptions) -> Result<Image, GpuError> {
        self.execute(&FramePlan::new(scene, options)?)
    }

    /// Renders a scene with progressive meshes that are on the device beside its own.
    ///
    /// # Errors
    ///
    /// As [`GpuRenderer::render`]; [`RenderError::Progressive`] if a mesh names materials that the scene does not have, was
    /// placed for another origin, or emits light.
    pub fn render_with(
        &self,
        scene: &RenderScene,
        options: &RenderOptions,
        meshes: &[&GpuMesh],
    ) -> Result<Image, GpuError> {
        let emissive: Vec<bool> = scene.materials.iter().map(|m| m.emission != glam::Vec3::ZERO).collect();
        let meshes: Vec<&GpuMesh> = meshes.iter().copied().filter(|mesh| mesh.level() > 0).collect();
        meshes.iter().try_for_each(|mesh| mesh.check(scene.origin, &emissive))?;
        let boxes: Vec<_> = meshes.iter().map(|mesh| mesh.bounds()).collect();
        let plan = FramePlan::around(scene, options, &boxes)?;
        device::checked(&self.device, || {
            execute::frame(&self.device, &self.queue, &self.pipelines, &plan, &meshes)
        })
    }

    /// Carries out a plan.
    ///
    /// # Errors
    ///
    /// [`GpuError::Limit`] or [`GpuError::Device`].
    pub fn execute(&self, plan: &FramePlan<'_>) -> Result<Image, GpuError> {
        device::checked(&self.device, || {
            execute::frame(&self.device, &self.queue, &self.pipelines, plan, &[])
        })
    }
}
