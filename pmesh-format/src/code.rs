//! The error codes of this format; those that all formats share are in [`ivg_wire::codes`].
//! Source: `spec/tables/errors.toml`; a test compares every constant with its row.

/// Error codes of the .pmesh format.
pub mod codes {
    ivg_wire::error_codes! {
        /// Counts that contradict each other or exceed what the format holds.
        COUNTS = 351, Invalid, "PMESH-HDR-02", "the counts of the header contradict each other";
        /// The forbidden mode 0.
        MODE_FORBIDDEN = 352, Invalid, "PMESH-HDR-03", "mode 0 does not exist";
        /// A mode that this reader does not have.
        MODE_UNKNOWN = 353, Unsupported, "PMESH-HDR-03", "this mode of packets needs another reader";
        /// The forbidden position encoding 0.
        POSITIONS_FORBIDDEN = 354, Invalid, "PMESH-HDR-04", "position encoding 0 does not exist";
        /// A position encoding that this reader does not have.
        POSITIONS_UNKNOWN = 355, Unsupported, "PMESH-HDR-04",
            "this encoding of positions needs another reader";
        /// The origin is not finite.
        MESH_ORIGIN = 356, Invalid, "PMESH-HDR-06", "the origin is not finite";
        /// The bounding box is not finite, or inside out.
        BOUNDS = 357, Invalid, "PMESH-HDR-07", "the bounding box is not finite or inside out";
        /// The first chunk is not the packet directory.
        DIRECTORY_MISSING = 358, Invalid, "PMESH-DIR-01", "the first chunk is not the packet directory";
        /// The directory does not have one entry for each packet.
        DIRECTORY_LENGTH = 359, Invalid, "PMESH-DIR-02",
            "the packet directory does not have one entry for each packet";
        /// An entry contradicts the header or the entry before it.
        DIRECTORY_COUNTS = 360, Invalid, "PMESH-DIR-03",
            "an entry of the packet directory contradicts the header or the entry before it";
        /// A payload is too short for its arrays, or longer than a record may be.
        DIRECTORY_BYTES = 361, Invalid, "PMESH-DIR-04",
            "a packet is too short for its arrays or longer than a record may be";
        /// An error that is negative, not finite, or greater than that of the packet before.
        DIRECTORY_ERROR = 362, Invalid, "PMESH-DIR-05",
            "the error of a packet is negative, not finite or greater than that of the packet before";
        /// The material names cannot be read.
        MATERIAL_NAMES = 363, Invalid, "PMESH-MTRL-02", "the list of material names is not well formed";
        /// Parameters of coded attributes that do not fit what the file has.
        PARAMETERS = 364, Invalid, "PMESH-HDR-08",
            "the bits or the box of coded attributes do not fit what the file has";
        /// A position that is not finite or outside the bounding box.
        POSITION = 501, Invalid, "PMESH-POS-02", "a position is not finite or outside the bounding box";
        /// A normal or texture coordinate that is not finite.
        ATTRIBUTE = 502, Invalid, "PMESH-WDG-02", "a normal or texture coordinate is not finite";
        /// A vertex that does not collapse onto an earlier one.
        PARENT = 503, Invalid, "PMESH-COL-01", "a vertex does not collapse onto an earlier vertex";
        /// A corner that names a wedge that has not arrived.
        CORNER = 504, Invalid, "PMESH-FACE-01", "a face names a wedge that has not arrived";
        /// A face with a vertex twice.
        FACE_VERTICES = 505, Invalid, "PMESH-FACE-01", "two corners of a face are the same vertex";
        /// A number in variable length that is too long or too large.
        VARINT = 508, Invalid, "PMESH-PKT-04",
            "a number of variable length is not in its shortest form or exceeds 32 bits";
        /// Wedge counts that do not add up.
        WEDGE_COUNT = 509, Invalid, "PMESH-WDG-01",
            "the wedges of the vertices do not add up to those of the packet";
        /// A wedge that becomes one that its parent vertex does not have.
        WEDGE_TARGET = 510, Invalid, "PMESH-COL-02",
            "a wedge becomes a wedge that the parent vertex does not have";
        /// A corner that switches to a wedge that does not descend from it.
        SWITCH = 511, Invalid, "PMESH-SWI-06", "a corner switches to a wedge that does not collapse back onto it";
        /// A packet that ends before its last part, or goes on after it.
        PACKET_LENGTH = 512, Invalid, "PMESH-SWI-06", "the parts of a packet do not fill it exactly";
        /// Unused bits of a packed part that are not zero.
        PACKET_PADDING = 513, Invalid, "PMESH-PKT-02", "unused bits of a packet are not zero";
        /// A packet that is not the next one.
        PACKET_ORDER = 514, Invalid, "PMESH-LVL-04", "this packet is not the one that comes next";
        /// A coded packet whose symbols do not fill it.
        CODED_LENGTH = 515, Invalid, "PMESH-COD-03", "the symbols of a coded packet do not fill it exactly";
        /// Padding of a coded packet that is not zero.
        CODED_PADDING = 516, Invalid, "PMESH-COD-03", "bytes after the symbols of a coded packet are not zero";
        /// Faces of a coded packet that are more or fewer than the directory says.
        CODED_FACES = 517, Invalid, "PMESH-COD-07",
            "the faces of a coded packet are more or fewer than the directory says";
        /// A coded packet that looks at more slots than its bytes allow.
        CODED_WORK = 518, Invalid, "PMESH-COD-12", "a coded packet asks for more work than its bytes allow";
        /// A list of corners that switch that is none of ascending corners of earlier faces.
        SWITCH_SLOTS = 519, Invalid, "PMESH-SWI-05",
            "the list of corners that switch is not one of ascending corners of earlier faces";
        /// Corners that pass more vertices than the bytes of their packet allow.
        SWITCH_WORK = 520, Invalid, "PMESH-SWI-07",
            "corners pass more vertices than the bytes of the packet allow; write smaller packets";
        /// More vertices, wedges or faces than the caller allows.
        LIMIT_COUNTS = 620, Limit, "PMESH-LIM-02", "the mesh has more vertices, wedges or faces than the limit";
    }
}
