//! Pictures: which renderer draws, and how bright the result is.

use std::path::Path;

use ivg_render::{Image, RenderOptions, RenderScene};

use crate::args::RendererArgument;
use crate::failure::Failure;
use crate::files;

/// A renderer that has been chosen once, for all pictures of a command.
#[derive(Debug)]
pub(crate) enum Renderer {
    Cpu,
    #[cfg(feature = "gpu")]
    Gpu(Box<ivg_render::GpuRenderer>),
}

impl Renderer {
    /// `auto` takes a GPU if there is one. A software adapter is not one: the CPU renderer draws the same picture in
    /// less time.
    pub(crate) fn choose(argument: RendererArgument) -> Result<Self, Failure> {
        match argument {
            RendererArgument::Cpu => Ok(Self::Cpu),
            #[cfg(feature = "gpu")]
            RendererArgument::Gpu => {
                ivg_render::GpuRenderer::new().map(|gpu| Self::Gpu(Box::new(gpu))).map_err(Failure::new)
            }
            #[cfg(feature = "gpu")]
            RendererArgument::Auto => match ivg_render::GpuRenderer::new() {
                Ok(gpu) if !gpu.is_software() => Ok(Self::Gpu(Box::new(gpu))),
                _ => Ok(Self::Cpu),
            },
            #[cfg(not(feature = "gpu"))]
            RendererArgument::Auto => Ok(Self::Cpu),
        }
    }

    /// Who draws, for people.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Cpu => "CPU".to_owned(),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.adapter_name().to_owned(),
        }
    }

    pub(crate) fn render(&self, scene: &RenderScene, options: &RenderOptions) -> Result<Image, Failure> {
        match self {
            Self::Cpu => ivg_render::render_cpu(scene, options).map_err(Failure::new),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.render(scene, options).map_err(Failure::new),
        }
    }
}

/// Writes a picture, shown with `exposure`.
pub(crate) fn write_png(path: &Path, image: &Image, exposure: f32) -> Result<(), Failure> {
    let display = ivg_render::tonemap(image, exposure);
    let bytes = ivg_render::png::encode(&display).map_err(|error| Failure::file(path, error))?;
    files::write(path, &bytes)
}
