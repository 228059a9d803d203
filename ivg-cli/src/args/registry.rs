//! Encodings and orders as arguments: the names of the format's registries, with what each is good for.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use ivg_format::{Encoding, Order};
use pmesh_build::Cost;
use pmesh_format::{Mode, Positions};

/// The name of an encoding.
pub(crate) fn encoding() -> impl TypedValueParser<Value = Encoding> {
    let values = Encoding::ALL.iter().map(|encoding| {
        let bytes = encoding.bytes_per_vertex();
        PossibleValue::new(encoding.name())
            .help(format!("{}: {bytes} bytes a vertex", encoding_text(encoding.name())))
    });
    PossibleValuesParser::new(values)
        .try_map(|name| Encoding::from_name(&name).ok_or("not an encoding of this release"))
}

/// The name of an order.
pub(crate) fn order() -> impl TypedValueParser<Value = Order> {
    let values =
        Order::ALL.iter().map(|order| PossibleValue::new(order.name()).help(order_text(order.name())));
    PossibleValuesParser::new(values)
        .try_map(|name| Order::from_name(&name).ok_or("not an order of this release"))
}

/// The name of a way to store packets.
pub(crate) fn mode() -> impl TypedValueParser<Value = Mode> {
    let text = |mode| match mode {
        Mode::Raw => "Arrays as GPUs take them; the fastest to read",
        Mode::Coded => "Entropy coded; the smallest",
    };
    let values = Mode::ALL.iter().map(|&mode| PossibleValue::new(mode.name()).help(text(mode)));
    PossibleValuesParser::new(values)
        .try_map(|name| Mode::from_name(&name).ok_or("not a mode of this release"))
}

/// The name of a way to store positions.
pub(crate) fn positions() -> impl TypedValueParser<Value = Positions> {
    let values = Positions::ALL.iter().map(|positions| {
        let value = PossibleValue::new(positions.name());
        match positions.bits() {
            None => value.help("32-bit floats, exact"),
            Some(bits) => value.help(format!("{bits} bits along the longest side")),
        }
    });
    PossibleValuesParser::new(values)
        .try_map(|name| Positions::from_name(&name).ok_or("not an encoding of positions of this release"))
}

/// The name of a cost of collapses.
pub(crate) fn cost() -> impl TypedValueParser<Value = Cost> {
    let values = Cost::ALL.iter().map(|cost| PossibleValue::new(cost.name()).help(cost_text(cost.name())));
    PossibleValuesParser::new(values)
        .try_map(|name| Cost::from_name(&name).ok_or("not a cost of this release"))
}

fn cost_text(name: &str) -> &'static str {
    match name {
        "quadric" => "Area-weighted quadric error: the most accurate levels",
        "melax" => "Edge length times curvature, as Melax 1998 and Web3D 2008 have it; for comparison",
        _ => "See the documentation of pmesh-build",
    }
}

fn encoding_text(name: &str) -> &'static str {
    match name {
        "packed-oct24" => "24-bit octahedral direction and shared-exponent colour for each hemisphere",
        "packed-xyz24" => "The same with 8 bits a coordinate of the direction, as Web3D 2008 has it",
        "pair-f16" => "Direction and colour of each hemisphere as half-precision floats",
        "pair-f16x4" => "The same in fours, as GPUs take them",
        "pair-f32" => "Direction and colour of each hemisphere as f32",
        "vectors-f32" => "All six irradiance vectors of each colour as f32, nothing is lost",
        "sh2-28" => "Spherical harmonics of the radiance, the most accurate for its size",
        _ => "See spec/ivg.md",
    }
}

fn order_text(name: &str) -> &'static str {
    match name {
        "slices" => "Some vertices of every slice across the longest axis, in pseudo-random order",
        "octree" => "Evenly spread over the volume, whatever part has arrived",
        "explicit" => "What matters most first, found by measuring; each bundle lists its vertices",
        _ => "See spec/ivg.md",
    }
}
