//! The error codes of this format; those that all formats share are in [`ivg_wire::codes`].
//! Source: `spec/tables/errors.toml`; a test compares every constant with its row.

/// Error codes of the .ivg format.
pub mod codes {
    ivg_wire::error_codes! {
        /// An axis has no vertex.
        DIMENSIONS = 301, Invalid, "IVG-LAT-01", "an axis of the lattice has no vertex";
        /// The origin, or the position of the last vertex, is not finite.
        ORIGIN = 302, Invalid, "IVG-LAT-02", "a vertex of the lattice has no finite position";
        /// The step does not fit the number of vertices.
        STEP = 303, Invalid, "IVG-LAT-03", "the step does not fit the number of vertices along its axis";
        /// The scale exponent is out of range.
        SCALE_EXPONENT = 304, Invalid, "IVG-HDR-04", "the scale exponent is not in -125 to 112, or to 110 in sh2-28";
        /// The number of vertices per slice is 0.
        SLICE_VERTICES = 305, Invalid, "IVG-ORD-03", "a bundle takes no vertex from a slice";
        /// The number of bundles does not follow from the lattice.
        BUNDLE_COUNT = 306, Invalid, "IVG-ORD-04",
            "the number of bundles is not the one that follows from the lattice";
        /// The number of validity records does not follow from the lattice.
        VALIDITY_COUNT = 307, Invalid, "IVG-VAL-01",
            "the number of validity records is neither 0 nor the one that follows from the lattice";
        /// A bundle would be longer than a record may be.
        RECORD_TOO_LARGE = 308, Invalid, "IVG-HDR-06", "a bundle would be longer than a record may be";
        /// A file of the order `explicit` does not begin with its directory.
        DIRECTORY_ABSENT = 309, Invalid, "IVG-DIRE-01",
            "a file of the order explicit has its directory as its first chunk";
        /// A directory in a file of another order.
        DIRECTORY_FORBIDDEN = 310, Invalid, "IVG-DIRE-01", "only files of the order explicit have a directory";
        /// The directory does not have one entry for each bundle.
        DIRECTORY_ENTRIES = 311, Invalid, "IVG-DIRE-02", "the directory does not have one entry for each bundle";
        /// A bundle has no vertex or too many, or all together have more than there are or lack some.
        DIRECTORY_VERTICES = 312, Invalid, "IVG-DIRE-03",
            "a bundle has no vertices or too many, or all bundles together have too many or too few";
        /// The list of vertices of a bundle cannot have this length.
        DIRECTORY_INDEX = 313, Invalid, "IVG-DIRE-03",
            "the list of a bundle's vertices cannot be as short or as long as the directory says";
        /// The forbidden encoding 0.
        ENCODING_FORBIDDEN = 401, Invalid, "IVG-ENC-01", "encoding 0 does not exist";
        /// An encoding that this reader does not have.
        ENCODING_UNKNOWN = 402, Unsupported, "IVG-ENC-02", "this encoding needs another reader";
        /// The forbidden order 0.
        ORDER_FORBIDDEN = 403, Invalid, "IVG-ORD-05", "order 0 does not exist";
        /// An order that this reader does not have.
        ORDER_UNKNOWN = 404, Unsupported, "IVG-ORD-06", "this order of vertices needs another reader";
        /// Units that this reader does not know.
        UNITS_UNKNOWN = 405, Unsupported, "IVG-HDR-05", "these units need a newer reader";
        /// A direction code with a forbidden half or byte.
        DIRECTION_CODE = 406, Invalid, "IVG-DIR-02", "a direction code has a forbidden value";
        /// A stored number that is NaN or infinite, or becomes so when scaled.
        NOT_FINITE = 407, Invalid, "IVG-VEC-02", "an irradiance vector is not finite";
        /// Unused bits after the blocked edges are not zero.
        UNUSED_BITS = 408, Invalid, "IVG-VAL-04", "unused bits after the blocked edges are not zero";
        /// A blocked edge that would leave the lattice.
        EDGE_OUTSIDE = 409, Invalid, "IVG-VAL-05", "a blocked edge leads out of the lattice";
        /// The list of lights cannot be read.
        LIGHTS = 410, Invalid, "IVG-LITE-02", "the list of lights is not well formed";
        /// The metadata cannot be read.
        METADATA = 411, Invalid, "IVG-META-02", "the metadata are not lines of key=value in UTF-8";
        /// The forbidden ratio code −128.
        RATIO_CODE = 412, Invalid, "IVG-SH-04", "a ratio code holds the forbidden value -128";
        /// A colour, stored as floating-point numbers, that is negative or not finite.
        PAIR_COLOUR = 413, Invalid, "IVG-PAIR-02", "a colour is negative or not finite";
        /// A component of a direction, stored as a floating-point number, that is not in −1 … 1.
        PAIR_DIRECTION = 414, Invalid, "IVG-PAIR-03", "a component of a direction is not in -1 to 1";
        /// A number in the list of a bundle's vertices is not in its shortest form, too long, or cut off.
        INDEX_NUMBER = 420, Invalid, "IVG-EXP-02",
            "a number in the list of vertices is not in its shortest form, is too long or has no end";
        /// A vertex in the list of a bundle is outside the lattice, or a corner.
        INDEX_VERTEX = 421, Invalid, "IVG-EXP-03", "the list of vertices names a corner or a vertex outside the lattice";
        /// The list of vertices does not fill its bytes.
        INDEX_LENGTH = 422, Invalid, "IVG-EXP-03", "the list of vertices does not fill its bytes exactly";
        /// The lattice has more vertices than the caller allows.
        LIMIT_VERTICES = 605, Limit, "IVG-LIM-01", "the lattice has more vertices than the limit";
    }
}
