# Layout of .ivg files for Kaitai Struct (https://kaitai.io): an aid for looking at files in a hex viewer.
#
# Not normative: `ivg.md` and `common.md` are the format. It checks neither checksums nor limits nor most values, and shows
# the bundles and the end record as bytes, since how many vertices a bundle has depends on the order.
# A test compares ids and offsets of the fields with `tables/common.toml` and `tables/ivg.toml`.
meta:
  id: ivg
  title: Irradiance vector grid
  file-extension: ivg
  endian: le
seq:
  - id: header
    type: header
  - id: chunks
    type: chunks
    size: header.data_offset - header.header_bytes
  - id: corners
    type: record(header.corner_count * header.bytes_per_vertex)
  - id: validity
    type: validity_record(_index)
    repeat: expr
    repeat-expr: header.validity_records
  - id: bundles_and_end
    size-eos: true
types:
  header:
    seq:
      - id: magic
        contents: [0x89, 0x49, 0x56, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]
      - id: major
        type: u2
      - id: minor
        type: u2
      - id: required_features
        type: u4
      - id: optional_features
        type: u4
      - id: header_bytes
        type: u4
      - id: reserved
        type: u4
      - id: header_crc
        type: u4
      - id: content_id
        type: u8
      - id: data_offset
        type: u8
      - id: file_bytes
        type: u8
      - id: dims
        type: u2
        repeat: expr
        repeat-expr: 3
      - id: encoding
        type: u2
        enum: encoding
      - id: origin
        type: f8
        repeat: expr
        repeat-expr: 3
      - id: step
        type: f8
        repeat: expr
        repeat-expr: 3
      - id: order
        type: u2
        enum: order
      - id: scale_exponent
        type: s2
      - id: vertices_per_slice
        type: u4
      - id: seed
        type: u8
      - id: bundle_count
        type: u4
      - id: validity_records
        type: u4
      - id: units
        type: u1
        enum: units
      - id: reserved_specific
        size: 7
      - id: newer_fields
        size: header_bytes - 144
    instances:
      corner_count:
        value: '(dims[0] < 2 ? dims[0] : 2) * (dims[1] < 2 ? dims[1] : 2) * (dims[2] < 2 ? dims[2] : 2)'
      vertex_count:
        value: dims[0] * dims[1] * dims[2]
      bytes_per_vertex:
        value: '[0, 42, 42, 72, 96, 144, 216, 28][encoding.to_i]'
  chunks:
    seq:
      - id: chunk
        type: chunk
        repeat: eos
  chunk:
    seq:
      - id: type
        type: str
        size: 4
        encoding: ASCII
      - id: flags
        type: u1
      - id: reserved
        size: 3
      - id: length
        type: u8
      - id: payload
        size: length
      - id: padding
        size: (8 - (length + 20) % 8) % 8
      - id: crc
        type: u4
  record:
    params:
      - id: payload_bytes
        type: u8
    seq:
      - id: id
        type: u4
      - id: generation
        type: u4
      - id: payload
        size: payload_bytes
      - id: padding
        size: (4 - payload_bytes % 4) % 4
      - id: crc
        type: u4
  validity_record:
    params:
      - id: j
        type: u4
    seq:
      - id: record
        type: record(vertices + (3 * vertices + 7) / 8)
    instances:
      vertices:
        value: '_root.header.vertex_count - 4096 * j < 4096 ? _root.header.vertex_count - 4096 * j : 4096'
enums:
  encoding:
    1: packed_oct24
    2: packed_xyz24
    3: pair_f16
    4: pair_f16x4
    5: pair_f32
    6: vectors_f32
    7: sh2_28
  order:
    1: slices
    2: octree
    3: explicit
  units:
    0: radiometric
    1: photometric
