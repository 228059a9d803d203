//! What all our formats share: magic, version, chunk and record envelopes, checksums, limits, errors.
