use meshopt::EncodeExpMode;
use serde_json::json;

use super::*;

/// The bytes of a view that is compressed as `extension` says, over `data`.
fn decoded(data: &[u8], mode: &str, filter: &str, stride: usize, count: usize) -> Result<Vec<u8>, String> {
    let compressed = json!({
        "buffer": 0, "byteLength": data.len(), "byteStride": stride, "mode": mode, "filter": filter, "count": count,
    });
    let root: Root = serde_json::from_value(json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": data.len() }, { "byteLength": 1000 }],
        "bufferViews": [{
            "buffer": 1, "byteLength": count * stride, "extensions": { "EXT_meshopt_compression": compressed },
        }],
    }))
    .expect("a small document");
    view(&root, &vec![Some(Cow::Borrowed(data)), None], 0).map(Cow::into_owned)
}

#[test]
fn attributes_of_any_stride_come_back() {
    fn round_trip<const N: usize>() {
        let vertices: Vec<Words<N>> =
            (0..300u32).map(|i| Words(std::array::from_fn(|w| i.wrapping_mul(w as u32 + 7)))).collect();
        let bytes: Vec<u8> = vertices.iter().flat_map(|v| v.0).flat_map(u32::to_ne_bytes).collect();
        let data = meshopt::encode_vertex_buffer(&vertices).expect("encoded");
        assert_eq!(decoded(&data, "ATTRIBUTES", "NONE", 4 * N, 300).expect("decoded"), bytes);
    }
    round_trip::<1>();
    round_trip::<3>();
    round_trip::<5>();
    round_trip::<64>();
}

#[test]
fn triangles_and_index_sequences_come_back_in_both_widths() {
    let triangles: Vec<u32> = (0..50).flat_map(|i| [i, i + 1, i + 2]).collect();
    let data = meshopt::encode_index_buffer(&triangles, 52).expect("encoded");
    // The codec may turn triangles round, never change them.
    let turned = |t: &[u32]| (0..3).map(|k| [t[k], t[(k + 1) % 3], t[(k + 2) % 3]]).min().unwrap_or_default();
    let expected: Vec<[u32; 3]> = triangles.chunks(3).map(turned).collect();
    let wide = decoded(&data, "TRIANGLES", "NONE", 4, 150).expect("decoded");
    let wide: Vec<u32> = wide.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
    assert_eq!(wide.chunks(3).map(turned).collect::<Vec<_>>(), expected);
    let narrow = decoded(&data, "TRIANGLES", "NONE", 2, 150).expect("decoded");
    let narrow: Vec<u32> = narrow.as_chunks().0.iter().map(|b| u32::from(u16::from_le_bytes(*b))).collect();
    assert_eq!(narrow, wide);

    let sequence: Vec<u32> = (0..97).map(|i| i * 31 % 89).collect();
    let data = meshopt::encode_index_sequence(&sequence, 89).expect("encoded");
    assert_eq!(decoded(&data, "INDICES", "NONE", 4, 97).expect("decoded"), little32(&sequence));
    let short: Vec<u16> = sequence.iter().map(|i| *i as u16).collect();
    assert_eq!(decoded(&data, "INDICES", "NONE", 2, 97).expect("decoded"), little16(&short));
}

#[test]
fn filters_are_undone() {
    let vectors = [[1.0f32, 0.0, 0.0, 0.0], [0.6, -0.8, 0.0, 0.0], [-0.48, 0.64, -0.6, 0.0]];

    let filtered: Vec<[i8; 4]> = meshopt::encode_filter_oct(&vectors, 8);
    let data = meshopt::encode_vertex_buffer(&filtered).expect("encoded");
    let bytes = decoded(&data, "ATTRIBUTES", "OCTAHEDRAL", 4, 3).expect("decoded");
    // Eight bits a component: half a step of 1/127 in the code, some twice that in the direction.
    check_near(bytes.iter().map(|b| f32::from(*b as i8) / 127.0), &vectors, 0.02);

    let filtered: Vec<[i16; 4]> = meshopt::encode_filter_oct(&vectors, 16);
    let data = meshopt::encode_vertex_buffer(&filtered).expect("encoded");
    let bytes = decoded(&data, "ATTRIBUTES", "OCTAHEDRAL", 8, 3).expect("decoded");
    let shorts = bytes.as_chunks().0.iter().map(|b| f32::from(i16::from_le_bytes(*b)) / 32767.0);
    check_near(shorts, &vectors, 1e-4);

    let quaternions = [[0.5f32, 0.5, 0.5, 0.5], [0.0, 0.6, 0.0, 0.8]];
    let data =
        meshopt::encode_vertex_buffer(&meshopt::encode_filter_quat(&quaternions, 16)).expect("encoded");
    let bytes = decoded(&data, "ATTRIBUTES", "QUATERNION", 8, 2).expect("decoded");
    let shorts = bytes.as_chunks().0.iter().map(|b| f32::from(i16::from_le_bytes(*b)) / 32767.0);
    check_near(shorts, &quaternions, 1e-3);

    let floats = [[1.5f32, -0.25, 1024.0], [0.0, 3.0, -7.0]];
    let filtered = meshopt::encode_filter_exp(&floats, 24, EncodeExpMode::Separate);
    let data = meshopt::encode_vertex_buffer(&filtered).expect("encoded");
    let bytes = decoded(&data, "ATTRIBUTES", "EXPONENTIAL", 12, 2).expect("decoded");
    check_near(bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)), &floats, 0.0);

    let colours = [[1.0f32, 0.5, 0.0, 1.0], [0.2, 0.4, 0.6, 1.0]];
    let filtered: Vec<[u8; 4]> = meshopt::encode_filter_color(&colours, 8);
    let data = meshopt::encode_vertex_buffer(&filtered).expect("encoded");
    let bytes = decoded(&data, "ATTRIBUTES", "COLOR", 4, 2).expect("decoded");
    check_near(bytes.iter().map(|b| f32::from(*b) / 255.0), &colours, 0.02);
}

fn check_near<const N: usize>(found: impl Iterator<Item = f32>, expected: &[[f32; N]], tolerance: f32) {
    let found: Vec<f32> = found.collect();
    let expected: Vec<f32> = expected.concat();
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(&expected) {
        assert!((f - e).abs() <= tolerance, "{found:?} is not {expected:?}");
    }
}

#[test]
fn damaged_and_hostile_views_are_errors() {
    let data = meshopt::encode_vertex_buffer(&[[1u32, 2, 3]; 100]).expect("encoded");
    let check = |result: Result<Vec<u8>, String>, what: &str| {
        let message = result.expect_err(what);
        assert!(message.contains(what), "{message}");
    };
    check(decoded(&data[..data.len() / 2], "ATTRIBUTES", "NONE", 12, 100), "damaged");
    check(decoded(&data, "ATTRIBUTES", "NONE", 16, 100), "damaged");
    check(decoded(&data, "ATTRIBUTES", "NONE", 10, 100), "stride 10");
    check(decoded(&data, "ATTRIBUTES", "NONE", 12, usize::MAX / 12), "cannot hold");
    check(decoded(&data, "ATTRIBUTES", "NONE", 12, 1 << 40), "cannot hold");
    check(decoded(&data, "VERTICES", "NONE", 12, 100), "VERTICES is not known");
    check(decoded(&data, "ATTRIBUTES", "SECRET", 12, 100), "SECRET");
    check(decoded(&data, "TRIANGLES", "NONE", 4, 100), "count 100");
}

#[test]
fn base64_and_percent_escapes() {
    for (text, bytes) in
        [("", &b""[..]), ("Zg==", b"f"), ("Zm8=", b"fo"), ("Zm9v", b"foo"), ("Zm9vYmE", b"fooba")]
    {
        assert_eq!(base64(text).as_deref(), Some(bytes), "{text}");
    }
    assert_eq!(base64("Z"), None);
    assert_eq!(base64("Zm9*"), None);
    assert_eq!(percent_decoded("a%20b%C3%A9").as_deref(), Some("a bé"));
    assert_eq!(percent_decoded("a%2"), None);
    assert_eq!(percent_decoded("%ff"), None);
}
