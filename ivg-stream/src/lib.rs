//! Serving and fetching scene directories: HTTP ranges, scheduling, resuming.
