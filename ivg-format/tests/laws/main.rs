//! The laws of the .ivg format, on small files built here.

mod damage;
mod encodings;
mod explicit;
mod fields;
mod files;
mod judgement;
mod orders;
mod roundtrip;
mod sizes;
mod splits;
mod updates;
