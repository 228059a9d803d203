//! Conformance vectors and the oracles that tests and fuzz targets share.
