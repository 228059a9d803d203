//! The laws of the .pmesh format, on small files built here.

mod damage;
mod files;
mod hostile;
mod judgement;
mod levels;
mod shapes;
mod splits;
mod writer;
