//! Parsers of composite arguments. Each error says what a right value looks like.

use std::num::ParseIntError;
use std::str::FromStr;

use glam::DVec3;

/// Number of grid vertices along x, y and z, each in 1..=65535.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct GridSize(pub(crate) [u16; 3]);

impl FromStr for GridSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wanted =
            || format!("'{text}' is not a grid size; give vertices along x, y and z such as 16x16x16");
        let numbers: Vec<u16> =
            text.split('x').map(str::parse).collect::<Result<_, _>>().map_err(|_| wanted())?;
        match numbers[..] {
            [x, y, z] if x > 0 && y > 0 && z > 0 => Ok(Self([x, y, z])),
            _ => Err(wanted()),
        }
    }
}

/// Two points \[m\] given as six numbers: lower and upper corner of a box, or eye and target of a camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bounds(pub(crate) DVec3, pub(crate) DVec3);

impl FromStr for Bounds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Vec<f64> = text
            .split(',')
            .map(|part| part.trim().parse::<f64>().ok().filter(|value| value.is_finite()))
            .collect::<Option<_>>()
            .ok_or_else(|| {
                format!("'{text}' has a part that is not a finite number; give X,Y,Z,X,Y,Z in metres")
            })?;
        match numbers[..] {
            [a, b, c, d, e, f] => Ok(Self(DVec3::new(a, b, c), DVec3::new(d, e, f))),
            _ => Err(format!("'{text}' has {} numbers; give six: X,Y,Z,X,Y,Z in metres", numbers.len())),
        }
    }
}

/// A grid size, or one that the scene calls for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GridArgument {
    Size(GridSize),
    Auto,
}

impl FromStr for GridArgument {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        text.parse().map(Self::Size).map_err(|error| format!("{error}, or auto"))
    }
}

/// Part K of N of the photons of a bake.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ShardArgument(pub(crate) ivg_bake::Shard);

impl FromStr for ShardArgument {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').map(|(k, n)| (k.parse::<u32>(), n.parse::<u32>()));
        match numbers {
            Some((Ok(index), Ok(count))) if (1..=count).contains(&index) => {
                Ok(Self(ivg_bake::Shard { index, count }))
            }
            _ => Err(format!("'{text}' is not a shard; give its number and how many there are, such as 2/4")),
        }
    }
}

/// Largest side of a picture \[pixels\].
const MAX_SIDE: u32 = 16_384;

/// Width and height of a picture \[pixels\].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PictureSize {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl FromStr for PictureSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |part: &str| part.parse::<u32>().ok().filter(|side| (1..=MAX_SIDE).contains(side));
        match text.split_once('x').map(|(w, h)| (side(w), side(h))) {
            Some((Some(width), Some(height))) => Ok(Self { width, height }),
            _ => Err(format!(
                "'{text}' is not a picture size; give pixels such as 640x480, each side up to {MAX_SIDE}"
            )),
        }
    }
}

/// In which order geometry and light are asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ScheduleArgument(pub(crate) ivg_stream::Schedule);

impl FromStr for ScheduleArgument {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "alternate" => Ok(Self(ivg_stream::Schedule::Alternate)),
            "geometry" => Ok(Self(ivg_stream::Schedule::GeometryFirst)),
            "light" => Ok(Self(ivg_stream::Schedule::LightFirst)),
            _ => share(text).map(|light| Self(ivg_stream::Schedule::Proportion { light: light as f32 })).map_err(|_| {
                format!("'{text}' is not a schedule; give alternate, geometry, light, or the share of light such as 0.3")
            }),
        }
    }
}

/// A number of things of which there must be one.
pub(crate) fn count<T: FromStr<Err = ParseIntError> + From<u8> + PartialEq>(text: &str) -> Result<T, String> {
    match text.parse::<T>() {
        Ok(value) if value == T::from(0) => Err("must be at least 1".to_owned()),
        parsed => parsed.map_err(|error| error.to_string()),
    }
}

/// A share in (0, 1).
pub(crate) fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value < 1.0 => Ok(value),
        _ => Err(format!("'{text}' is not a number between 0 and 1")),
    }
}

/// A share in (0, 1) as a number of per cent with its sign.
pub(crate) fn percent(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix('%').and_then(|number| number.trim().parse::<f64>().ok());
    match number {
        Some(value) if value > 0.0 && value < 100.0 => Ok(value / 100.0),
        _ => Err(format!("'{text}' is not an accuracy; give more than 0% and less than 100%, such as 2%")),
    }
}

/// A number of bytes, with a decimal unit or none.
pub(crate) fn bytes(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, f64); 4] = [("kB", 1e3), ("MB", 1e6), ("GB", 1e9), ("B", 1.0)];
    let (number, unit) = (UNITS.iter())
        .find_map(|(name, bytes)| text.strip_suffix(name).map(|number| (number, *bytes)))
        .unwrap_or((text, 1.0));
    match number.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value * unit < 1e15 => Ok((value * unit) as u64),
        _ => Err(format!("'{text}' is not a size; give bytes, or kB, MB or GB, such as 500kB")),
    }
}

/// A number of seconds above zero, up to a year.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    const YEAR: f64 = 365.0 * 86_400.0;
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= YEAR => Ok(value),
        _ => Err(format!("'{text}' is not a number of seconds above zero")),
    }
}

/// A share in [0, 1].
pub(crate) fn share_or_all(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err(format!("'{text}' is not a number from 0 to 1")),
    }
}

/// A finite number, zero or more.
pub(crate) fn weight(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value >= 0.0 && value.is_finite() => Ok(value),
        _ => Err(format!("'{text}' is not a number of zero or more")),
    }
}

/// A finite number above zero.
pub(crate) fn positive(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err(format!("'{text}' is not a number above zero")),
    }
}

#[cfg(test)]
mod tests;
