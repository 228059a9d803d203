//! Material libraries: a check of each line, tobj, and what its values mean here.

use std::collections::HashMap;
use std::fmt::Write as _;

use glam::Vec3;

use crate::{Material, SceneError};

type Loaded = (Vec<tobj::Material>, HashMap<String, usize>);

/// Reads a material library.
///
/// # Errors
///
/// [`SceneError::Line`] for numbers missing, broken or not finite, and for names missing.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<Loaded, SceneError> {
    let text = String::from_utf8_lossy(bytes);
    let mut clean = String::with_capacity(text.len());
    for (at, line) in text.lines().enumerate() {
        clean_line(line, &mut clean).map_err(|what| SceneError::line(file, at + 1, what))?;
    }
    tobj::load_mtl_buf(&mut clean.as_bytes()).map_err(|e| SceneError::file(file, e.to_string()))
}

/// Checks a line and writes it so that tobj reads it as the format means it.
fn clean_line(line: &str, clean: &mut String) -> Result<(), String> {
    let mut words = line.split_whitespace();
    let keyword = words.next().unwrap_or_default();
    match keyword {
        "Ka" | "Kd" | "Ks" | "Ke" | "Tf" => {
            let words: Vec<&str> = words.take_while(|w| !w.starts_with('#')).collect();
            if matches!(words.first(), Some(&("spectral" | "xyz"))) {
                return Err(format!(
                    "{keyword} as {} is not supported: give linear red, green, blue",
                    words[0]
                ));
            }
            let values = words.iter().map(|w| number(keyword, w)).collect::<Result<Vec<_>, _>>()?;
            // One number stands for three equal ones.
            let [r, g, b] = match values[..] {
                [v] => [v; 3],
                [r, g, b] => [r, g, b],
                _ => return Err(format!("{keyword} has {} numbers instead of 3", values.len())),
            };
            let _ = writeln!(clean, "{keyword} {r} {g} {b}");
        }
        "Ns" | "Ni" | "d" | "Tr" => {
            let word = words.find(|w| *w != "-halo").ok_or_else(|| format!("{keyword} without a number"))?;
            let _ = writeln!(clean, "{keyword} {}", number(keyword, word)?);
        }
        "illum" => {
            let word = words.next().unwrap_or_default();
            let model: u8 =
                word.parse().map_err(|_| format!("illum \"{word}\" is no illumination model (0 to 10)"))?;
            let _ = writeln!(clean, "illum {model}");
        }
        "newmtl" => {
            let name = line.trim_start()["newmtl".len()..].trim();
            if name.is_empty() {
                return Err("newmtl without a name".into());
            }
            let _ = writeln!(clean, "newmtl {name}");
        }
        _ if keyword.to_ascii_lowercase().starts_with("map_")
            || matches!(keyword, "bump" | "disp" | "refl") =>
        {
            let arguments = line.trim_start()[keyword.len()..].trim();
            if arguments.is_empty() {
                return Err(format!("{keyword} without the name of an image"));
            }
            let _ = writeln!(clean, "{keyword} {arguments}");
        }
        _ => {
            let _ = writeln!(clean, "{}", line.trim());
        }
    }
    Ok(())
}

fn number(keyword: &str, word: &str) -> Result<f64, String> {
    word.parse()
        .ok()
        .filter(|v: &f64| v.is_finite())
        .ok_or_else(|| format!("{keyword} \"{word}\" is no finite number"))
}

/// What an MTL material means here.
///
/// `Kd` is the diffuse albedo in linear RGB, `Ke` the emitted radiance \[W/(m² sr)\] of the front side, the one from
/// which the corners run counter-clockwise. Surfaces reflect on both sides, as OBJ knows no other; those that emit do
/// so on the front side alone. Light passes through by the share 1 - `d`, all of it for `illum` 6 and 7; `illum` 4 and
/// 9 count only where `d` or `Tf` says so too, since some exporters write them for opaque materials. `Ks` is the colour of
/// a mirror reflection unless `illum` is 0, 1 or 2, which know only the highlights of lights.
pub(super) fn convert(source: &tobj::Material) -> Material {
    let colour = |c: Option<[f64; 3]>| c.map(|c| Vec3::new(c[0] as f32, c[1] as f32, c[2] as f32));
    let parameter = |name: &str| source.unknown_param.get(name);
    let filter = parameter("Tf").and_then(|text| {
        let v: Vec<f32> = text.split_whitespace().filter_map(|w| w.parse().ok()).collect();
        <[f32; 3]>::try_from(v).ok().map(Vec3::from)
    });
    let opacity = source
        .dissolve
        .or_else(|| parameter("Tr").and_then(|t| t.parse::<f64>().ok()).map(|t| 1.0 - t))
        .unwrap_or(1.0) as f32;
    let model = source.illumination_model;
    let transmission = match model {
        Some(6 | 7) => 1.0,
        Some(4 | 9) if opacity == 1.0 && filter.is_some_and(|f| f != Vec3::ONE) => 1.0,
        _ => 1.0 - opacity,
    };
    let mirrored = match model {
        Some(0..=2) => Vec3::ZERO,
        _ => colour(source.specular).unwrap_or(Vec3::ZERO),
    };
    let specular = mirrored.max_element();
    let emission = colour(source.emissive).unwrap_or(Vec3::ZERO);
    Material {
        name: source.name.clone(),
        albedo: colour(source.diffuse).unwrap_or(Material::default().albedo) * (1.0 - transmission),
        albedo_texture: None,
        emission,
        two_sided: emission == Vec3::ZERO,
        specular,
        specular_colour: if specular > 0.0 { mirrored / specular } else { Vec3::ONE },
        metallic: false,
        // Glass is smooth unless it says otherwise.
        roughness: match source.shininess {
            None if transmission > 0.0 => 0.0,
            exponent => roughness(exponent.unwrap_or(0.0)),
        },
        transmission,
        transmission_colour: filter.unwrap_or(Vec3::ONE),
        thin: false,
        refractive_index: source.optical_density.map_or(Material::default().refractive_index, |n| n as f32),
    }
}

/// Roughness of the lobe that a Blinn-Phong exponent describes: the width alpha with the same variance of slopes is
/// sqrt(2 / (Ns + 2)) (Walter et al. 2007, section 5.2), and alpha is the square of roughness (glTF 2.0, appendix B).
fn roughness(exponent: f64) -> f32 {
    (2.0 / (exponent.max(0.0) + 2.0)).sqrt().sqrt() as f32
}

/// The image of `map_Kd`, without its options.
pub(super) fn texture_file(source: &tobj::Material) -> Option<String> {
    let mut rest = source.diffuse_texture.as_deref()?.trim();
    while rest.starts_with('-') {
        let (option, after) = rest.split_once(char::is_whitespace)?;
        rest = after.trim_start();
        let (at_least, at_most) = match option {
            "-mm" => (2, 2),
            "-o" | "-s" | "-t" => (1, 3),
            _ => (1, 1),
        };
        for taken in 0..at_most {
            let Some((word, after)) = rest.split_once(char::is_whitespace) else { break };
            if taken >= at_least && word.parse::<f64>().is_err() {
                break;
            }
            rest = after.trim_start();
        }
    }
    (!rest.is_empty()).then(|| rest.to_owned())
}

/// Images that a material names and that are left out, as sentences.
pub(super) fn ignored_maps(source: &tobj::Material) -> Vec<String> {
    let mut ignored = Vec::new();
    let mut ignore = |present: bool, what: &str| {
        if present {
            ignored.push(format!("{what}: left out"));
        }
    };
    let named = |name: &str| source.unknown_param.keys().any(|k| k.eq_ignore_ascii_case(name));
    ignore(
        source.specular_texture.is_some() || source.shininess_texture.is_some(),
        "image of the mirror reflection",
    );
    ignore(source.normal_texture.is_some() || named("norm"), "bump or normal image");
    ignore(source.dissolve_texture.is_some(), "image of the opacity");
    ignore(named("map_Ke"), "image of the emission");
    ignore(named("disp"), "displacement image");
    let options = source.diffuse_texture.as_deref().is_some_and(|t| t.trim_start().starts_with('-'));
    ignore(options, "options of map_Kd");
    ignored
}
