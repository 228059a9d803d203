//! What must hold for any bytes: the bodies of the fuzz targets, which tests on the stable toolchain call too. Each function
//! takes bytes, returns nothing, and panics when something does not hold.

pub mod stream;
