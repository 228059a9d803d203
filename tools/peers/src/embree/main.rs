//! Finds the closest hits of the rays of a file with Embree 4, as fast as it can one ray at a time on one thread, and compares
//! them with the hits in the file. Prints JSON.
//!
//! ```text
//! peers-embree LIBRARY RAYS [--runs N]
//! ```
//!
//! LIBRARY is `libembree4`, as the Python wheel `embreex` brings it. RAYS is what the example `rays` of `ivg-bake` writes with
//! `--dump`. Embree is measured as it is and in its robust mode, whose triangle test lets nothing through between neighbours,
//! with builds of medium and of high quality.
#![allow(unsafe_code, reason = "Embree is a C library")]

use std::ffi::{CStr, c_char, c_int, c_uint, c_void};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use cpu_time::ThreadTime;
use libloading::Library;
use serde_json::{Value, json};

/// Any error; its text says what and where.
type Failure = Box<dyn std::error::Error>;

/// Closest hits by Embree 4, one ray at a time on one thread.
#[derive(Debug, Parser)]
struct CommandLine {
    /// The library libembree4.
    library: PathBuf,
    /// Triangles, rays and hits.
    rays: PathBuf,
    /// How often the rays are traced; the time is the median.
    #[arg(long, default_value_t = 5)]
    runs: usize,
}

fn main() -> ExitCode {
    match measure(&CommandLine::parse()) {
        Ok(figures) => {
            println!("{figures}");
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("peers-embree: {failure}");
            ExitCode::FAILURE
        }
    }
}

/// Modes: what they are called, flags of the scene, quality of the build (`RTCSceneFlags`, `RTCBuildQuality`).
const MODES: [(&str, c_int, c_int); 4] =
    [("robust, medium", 4, 1), ("robust, high", 4, 2), ("medium", 0, 1), ("high", 0, 2)];

/// Distances that differ by less are of the same hit: relative to the distance, and to the largest coordinate, whose rounding
/// is all that the distance of a near hit consists of.
const SAME: [f32; 2] = [1e-4, 1e-5];

fn measure(arguments: &CommandLine) -> Result<Value, Failure> {
    let file = RayFile::read(&arguments.rays)?;
    let embree = Embree::open(&arguments.library)?;
    let reach = file.triangles.iter().flatten().fold(0f32, |reach, x| reach.max(x.abs()));
    let mut scenes = Vec::new();
    let mut builds = Vec::new();
    for (_, flags, quality) in MODES {
        let start = ThreadTime::now();
        scenes.push(embree.scene(&file.triangles, flags, quality)?);
        builds.push(start.elapsed().as_secs_f64());
    }
    let mut seconds = vec![Vec::new(); MODES.len()];
    let mut others = [0usize; MODES.len()];
    for _ in 0..arguments.runs.max(1) {
        for (mode, &scene) in scenes.iter().enumerate() {
            let start = ThreadTime::now();
            let found = embree.closest_hits(scene, &file.rays);
            seconds[mode].push(start.elapsed().as_secs_f64());
            others[mode] = found.iter().zip(&file.hits).filter(|(a, b)| differ(**a, **b, reach)).count();
        }
    }
    let rows: Vec<Value> = MODES
        .iter()
        .enumerate()
        .map(|(mode, (name, ..))| {
            seconds[mode].sort_by(f64::total_cmp);
            let median = seconds[mode][seconds[mode].len() / 2];
            json!({
                "mode": name,
                "build_seconds": builds[mode],
                "mrays": file.rays.len() as f64 / median / 1e6,
                "differ": others[mode],
            })
        })
        .collect();
    Ok(json!({ "version": embree.version(), "rays": file.rays.len(), "modes": rows }))
}

/// Whether two distances of hits, `None` for no hit, are of different places; `reach` is the largest coordinate.
fn differ(a: Option<f32>, b: Option<f32>, reach: f32) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() > SAME[0] * a + SAME[1] * reach,
        (None, None) => false,
        _ => true,
    }
}

/// What the example `rays` wrote.
#[derive(Debug)]
struct RayFile {
    triangles: Vec<[f32; 9]>,
    /// Origin and direction.
    rays: Vec<[f32; 6]>,
    /// Distance of each closest hit.
    hits: Vec<Option<f32>>,
}

impl RayFile {
    fn read(path: &Path) -> Result<Self, Failure> {
        let bytes = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        Self::parse(&bytes).ok_or_else(|| format!("{}: not a file of rays", path.display()).into())
    }

    fn parse(bytes: &[u8]) -> Option<Self> {
        let words: Vec<u32> =
            bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        let (&[triangles, rays], rest) = words.split_first_chunk::<2>()?;
        let (triangles, rays) = (triangles as usize, rays as usize);
        if !bytes.len().is_multiple_of(4) || rest.len() != 9 * triangles + 8 * rays {
            return None;
        }
        let (corners, rest) = rest.split_at(9 * triangles);
        let (lines, hits) = rest.split_at(6 * rays);
        Some(Self {
            triangles: floats(corners),
            rays: floats(lines),
            hits: hits.chunks_exact(2).map(hit).collect(),
        })
    }
}

/// Arrays of floats from their bits.
fn floats<const N: usize>(words: &[u32]) -> Vec<[f32; N]> {
    words.as_chunks::<N>().0.iter().map(|chunk| chunk.map(f32::from_bits)).collect()
}

/// The distance of a triangle's number and a distance; none for the number that stands for no triangle.
fn hit(words: &[u32]) -> Option<f32> {
    (words[0] != u32::MAX).then_some(f32::from_bits(words[1]))
}

/// `RTCRayHit` of Embree 4.
#[repr(C, align(16))]
struct RayHit {
    origin: [f32; 3],
    near: f32,
    direction: [f32; 3],
    time: f32,
    far: f32,
    mask: c_uint,
    id: c_uint,
    flags: c_uint,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: c_uint,
    geometry: c_uint,
    instance: [c_uint; 2],
}

/// `RTC_INVALID_GEOMETRY_ID`.
const NOTHING: c_uint = c_uint::MAX;
/// `RTC_FORMAT_UINT3`, `RTC_FORMAT_FLOAT3`.
const FORMATS: [c_int; 2] = [0x5003, 0x9003];

/// The library and a device of one thread, which the operating system takes back at the end.
struct Embree {
    library: Library,
    device: *mut c_void,
}

impl Embree {
    fn open(path: &Path) -> Result<Self, Failure> {
        // SAFETY: Embree's initialisers have no requirements.
        let library =
            unsafe { Library::new(path) }.map_err(|error| format!("{}: {error}", path.display()))?;
        let mut embree = Self { library, device: std::ptr::null_mut() };
        let configuration: &CStr = c"threads=1";
        // SAFETY: `RTCDevice rtcNewDevice(const char*)`.
        embree.device = unsafe {
            let new =
                embree.library.get::<unsafe extern "C" fn(*const c_char) -> *mut c_void>(b"rtcNewDevice")?;
            new(configuration.as_ptr())
        };
        if embree.device.is_null() { Err("Embree gives no device".into()) } else { Ok(embree) }
    }

    /// Embree's version, such as 40400.
    fn version(&self) -> i64 {
        /// `RTC_DEVICE_PROPERTY_VERSION`.
        const VERSION: c_int = 0;
        // SAFETY: `ssize_t rtcGetDeviceProperty(RTCDevice, enum RTCDeviceProperty)` of a device that is there.
        unsafe {
            self.library
                .get::<unsafe extern "C" fn(*mut c_void, c_int) -> isize>(b"rtcGetDeviceProperty")
                .map_or(0, |property| property(self.device, VERSION) as i64)
        }
    }

    /// A committed scene of triangles.
    fn scene(&self, triangles: &[[f32; 9]], flags: c_int, quality: c_int) -> Result<*mut c_void, Failure> {
        type One = unsafe extern "C" fn(*mut c_void);
        type Buffer = unsafe extern "C" fn(*mut c_void, c_int, c_uint, c_int, usize, usize) -> *mut c_void;
        let corners = 3 * triangles.len();
        // SAFETY: the signatures are those of Embree 4's headers; each buffer has the bytes that are written to it (items times
        // stride); every handle is used while it is there.
        unsafe {
            let library = &self.library;
            let scene =
                library.get::<unsafe extern "C" fn(*mut c_void) -> *mut c_void>(b"rtcNewScene")?(self.device);
            library.get::<unsafe extern "C" fn(*mut c_void, c_int)>(b"rtcSetSceneFlags")?(scene, flags);
            library.get::<unsafe extern "C" fn(*mut c_void, c_int)>(b"rtcSetSceneBuildQuality")?(
                scene, quality,
            );
            let new =
                library.get::<unsafe extern "C" fn(*mut c_void, c_int) -> *mut c_void>(b"rtcNewGeometry")?;
            let geometry = new(self.device, 0);
            let buffer = library.get::<Buffer>(b"rtcSetNewGeometryBuffer")?;
            let indices: *mut u32 = buffer(geometry, 0, 0, FORMATS[0], 12, triangles.len()).cast();
            let points: *mut f32 = buffer(geometry, 1, 0, FORMATS[1], 12, corners).cast();
            if indices.is_null() || points.is_null() {
                return Err("Embree has no memory for the triangles".into());
            }
            (0..corners).for_each(|corner| indices.add(corner).write(corner as u32));
            std::ptr::copy_nonoverlapping(triangles.as_ptr().cast::<f32>(), points, 9 * triangles.len());
            library.get::<One>(b"rtcCommitGeometry")?(geometry);
            library.get::<unsafe extern "C" fn(*mut c_void, *mut c_void) -> c_uint>(b"rtcAttachGeometry")?(
                scene, geometry,
            );
            library.get::<One>(b"rtcReleaseGeometry")?(geometry);
            library.get::<One>(b"rtcCommitScene")?(scene);
            Ok(scene)
        }
    }

    /// The distance of each ray's closest hit.
    fn closest_hits(&self, scene: *mut c_void, rays: &[[f32; 6]]) -> Vec<Option<f32>> {
        type Intersect = unsafe extern "C" fn(*mut c_void, *mut RayHit, *const c_void);
        // SAFETY: `void rtcIntersect1(RTCScene, struct RTCRayHit*, struct RTCIntersectArguments*)`, whose last may be null.
        let Ok(intersect) = (unsafe { self.library.get::<Intersect>(b"rtcIntersect1") }) else {
            return vec![None; rays.len()];
        };
        rays.iter()
            .map(|&[x, y, z, u, v, w]| {
                let mut ray = RayHit {
                    origin: [x, y, z],
                    near: 0.0,
                    direction: [u, v, w],
                    time: 0.0,
                    far: f32::INFINITY,
                    mask: c_uint::MAX,
                    id: 0,
                    flags: 0,
                    normal: [0.0; 3],
                    u: 0.0,
                    v: 0.0,
                    primitive: NOTHING,
                    geometry: NOTHING,
                    instance: [NOTHING; 2],
                };
                // SAFETY: as above; the ray lives on, and its alignment is what Embree asks for.
                unsafe { intersect(scene, &raw mut ray, std::ptr::null()) };
                (ray.geometry != NOTHING).then_some(ray.far)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
