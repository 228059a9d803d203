//! Light transport on the CPU: photons traced through a scene into an irradiance vector grid.
