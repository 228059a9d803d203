//! What some processors have instructions of their own for, and how it is done on others.

/// Sixteen numbers that are worked on together.
pub(crate) type Lanes = [[i16; 8]; 2];

#[cfg(target_arch = "x86_64")]
mod imp {
    use safe_arch::{
        add_i16_m128i, cmp_gt_mask_i16_m128i, m128i, move_mask_i8_m128i, pack_i16_to_i8_m128i, prefetch_t0,
        set_i64_m128i_s, set_splat_i16_m128i, shr_all_i16_m128i, sub_i16_m128i,
    };

    use super::Lanes;

    #[inline(always)]
    pub(crate) fn not_above(ascending: &Lanes, most: i16) -> usize {
        let most = set_splat_i16_m128i(most);
        let [low, high] = ascending.map(|half| cmp_gt_mask_i16_m128i(half.into(), most));
        let above = move_mask_i8_m128i(pack_i16_to_i8_m128i(low, high)) as u32;
        (above | 1 << 16).trailing_zeros() as usize
    }

    #[inline(always)]
    pub(crate) fn approach(lanes: &mut Lanes, targets: &Lanes, shift: u32) {
        let count = set_i64_m128i_s(shift.into());
        let nearer = |half: [i16; 8], targets: [i16; 8]| {
            let half = m128i::from(half);
            add_i16_m128i(half, shr_all_i16_m128i(sub_i16_m128i(targets.into(), half), count)).into()
        };
        *lanes = [nearer(lanes[0], targets[0]), nearer(lanes[1], targets[1])];
    }

    #[inline(always)]
    pub(crate) fn fetch<T>(from: &T) {
        prefetch_t0(from);
    }
}

#[cfg(not(target_arch = "x86_64"))]
mod imp {
    pub(crate) use super::portable::{approach, fetch, not_above};
}

/// How many of some ascending numbers are at most that.
pub(crate) use imp::not_above;

/// Moves each number towards its target by their difference, shifted right (rounded down).
pub(crate) use imp::approach;

/// Has something brought near, since it will be looked at soon.
pub(crate) use imp::fetch;

#[cfg(any(test, not(target_arch = "x86_64")))]
mod portable {
    use super::Lanes;

    #[inline(always)]
    pub(crate) fn not_above(ascending: &Lanes, most: i16) -> usize {
        usize::from(ascending.as_flattened().iter().map(|&x| u16::from(x <= most)).sum::<u16>())
    }

    #[inline(always)]
    pub(crate) fn approach(lanes: &mut Lanes, targets: &Lanes, shift: u32) {
        for (x, target) in lanes.as_flattened_mut().iter_mut().zip(targets.as_flattened()) {
            *x = x.wrapping_add(target.wrapping_sub(*x) >> shift);
        }
    }

    #[inline(always)]
    #[cfg(not(target_arch = "x86_64"))]
    pub(crate) fn fetch<T>(_: &T) {}
}

#[cfg(test)]
mod tests;
