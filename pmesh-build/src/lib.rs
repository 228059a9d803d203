//! Finding the collapse order of an indexed mesh: half-edge collapses by quadric cost.
