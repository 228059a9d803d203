use super::*;

fn light(layers: u32) -> LightRecord {
    LightRecord { layers, ..LightRecord::default() }
}

#[test]
fn groups_of_lights_hold_all_lights_in_order_and_fit_into_memory() {
    // 2048 x 2048 texels: four maps at a time.
    let lights = [1, 1, 1, 6, 0, 2, 2, 1, 0].map(light);
    assert_eq!(light_groups(&lights, 2048), [0..3, 3..5, 5..7, 7..9]);
    assert_eq!(light_groups(&lights, 64).as_slice(), std::slice::from_ref(&(0..9)));
    assert!(light_groups(&[], 64).is_empty());
}
