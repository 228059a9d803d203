//! Arguments that several examples take: the scene and how it is baked.

use std::path::PathBuf;

use glam::DVec3;
use ivg_bake::BakeOptions;

use crate::common::{AnyError, numbers};

/// A scene and how it is baked, as `[SCENE] [--lights FILE] [--grid NXxNYxNZ] [--bounds x0,y0,z0,x1,y1,z1] [--photons N]`.
pub(crate) struct SceneArguments {
    /// The scene's file; `None`: the built-in room.
    pub(crate) scene: Option<PathBuf>,
    /// A file of lights.
    pub(crate) lights: Option<PathBuf>,
    /// How it is baked.
    pub(crate) options: BakeOptions,
}

impl SceneArguments {
    /// Reads the program's arguments. Those that it does not know are offered to `own`, with what reads their value; it says
    /// whether it knows them.
    ///
    /// # Errors
    ///
    /// If neither knows one, or a value is missing or cannot be read.
    pub(crate) fn read(
        options: BakeOptions,
        mut own: impl FnMut(&str, &mut dyn FnMut() -> Result<String, AnyError>) -> Result<bool, AnyError>,
    ) -> Result<Self, AnyError> {
        let mut read = Self { scene: None, lights: None, options };
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            let mut value = || -> Result<String, AnyError> {
                arguments.next().ok_or_else(|| format!("{argument} needs a value").into())
            };
            match argument.as_str() {
                "--lights" => read.lights = Some(value()?.into()),
                "--grid" => read.options.dims = numbers(&value()?, 'x')?,
                "--bounds" => {
                    let [x0, y0, z0, x1, y1, z1] = numbers(&value()?, ',')?;
                    read.options.bounds = Some((DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1)));
                }
                "--photons" => read.options.photons = value()?.parse()?,
                name if own(name, &mut value)? => {}
                option if option.starts_with("--") => return Err(format!("unknown option {option}").into()),
                _ => read.scene = Some(argument.into()),
            }
        }
        Ok(read)
    }
}
