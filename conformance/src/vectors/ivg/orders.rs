//! A file for each awkward lattice of `spec/tables/orders.toml`.

use super::super::{Format, Vector};
use super::{lattice, light};
use ivg_format::{EncodeOptions, GridSource, Order, encode};

const ORDERS: &str = include_str!("../../../../spec/tables/orders.toml");

/// The first number of their names.
const FIRST: usize = 100;

pub(super) fn accepted() -> Vec<Vector> {
    let table: toml::Table = ORDERS.parse().expect("a table of the specification");
    let rows = table["order"].as_array().expect("rows");
    rows.iter().enumerate().map(|(n, row)| vector(FIRST + n, row)).collect()
}

fn vector(number: usize, row: &toml::Value) -> Vector {
    let integer = |value: &toml::Value| value.as_integer().expect("a whole number");
    let dims = [0, 1, 2].map(|axis: usize| u16::try_from(integer(&row["dims"][axis])).expect("a short axis"));
    let name = row["order"].as_str().expect("a name");
    let options = EncodeOptions {
        order: Order::from_name(name).expect("an order"),
        vertices_per_slice: u32::try_from(integer(&row["per_slice"])).expect("a share"),
        seed: integer(&row["seed"]) as u64,
        ..EncodeOptions::new()
    };
    let lattice = lattice(dims);
    let light = light(&lattice, number as u64);
    let file = encode(&GridSource::new(lattice, &light), &options).expect("a sound grid");
    let [x, y, z] = dims;
    let name = format!("{number:04}-{name}-{x}x{y}x{z}");
    Vector::accepted(
        Format::Ivg,
        &name,
        file,
        "the order of vertices on an awkward lattice: each has other light",
    )
}
