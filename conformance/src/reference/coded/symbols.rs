//! The entropy coder: symbols out of a state and words (PMESH-COD-02 to -04), residuals (PMESH-COD-10).

/// PMESH-COD-04: a choice of two.
#[derive(Debug, Clone)]
pub(super) struct Binary {
    pub(super) p: i64,
    pub(super) n: i64,
}

/// PMESH-COD-04: one of 16.
#[derive(Debug, Clone)]
pub(super) struct Sixteen {
    pub(super) starts: Vec<i64>,
    pub(super) n: i64,
}

impl Sixteen {
    pub(super) fn new(first: &[i64; 15]) -> Self {
        Self { starts: [&[0], &first[..]].concat(), n: 0 }
    }
}

/// PMESH-COD-02: the state and the words behind it.
pub(super) struct Symbols<'a> {
    pub(super) x: u64,
    pub(super) payload: &'a [u8],
    pub(super) at: usize,
    pub(super) missing: bool,
}

impl Symbols<'_> {
    pub(super) fn refill(&mut self) {
        if self.x < 1 << 16 {
            let word = match self.payload.get(self.at..self.at + 2) {
                Some(word) => {
                    self.at += 2;
                    u64::from(word[0]) + 256 * u64::from(word[1])
                }
                None => {
                    self.missing = true;
                    0
                }
            };
            self.x = (self.x << 16) + word;
        }
    }

    pub(super) fn range(&mut self, c: i64, f: i64) {
        let low = self.x % (1 << 15);
        self.x = f as u64 * (self.x >> 15) + low - c as u64;
        self.refill();
    }

    pub(super) fn bit(&mut self, model: &mut Binary) -> bool {
        let value = ((self.x % (1 << 15)) as i64) < model.p;
        if value {
            self.range(0, model.p);
        } else {
            self.range(model.p, (1 << 15) - model.p);
        }
        let target = if value { (1 << 15) - 32 } else { 32 };
        model.p += ((target - model.p) * (655_360 / (10 * model.n + 16))).div_euclid(1 << 16);
        model.n = (model.n + 1).min(60);
        value
    }

    pub(super) fn sixteen(&mut self, model: &mut Sixteen) -> i64 {
        let low = (self.x % (1 << 15)) as i64;
        let k = (0..16).rev().find(|&k| model.starts[k] <= low).expect("the first start is 0");
        let end = if k == 15 { 1 << 15 } else { model.starts[k + 1] };
        self.range(model.starts[k], end - model.starts[k]);
        let h = if model.n < 20 {
            4
        } else if model.n < 80 {
            5
        } else {
            6
        };
        for i in 1..16 {
            let target = if i <= k { 8 * i as i64 } else { (1 << 15) - 8 * (16 - i as i64) };
            model.starts[i] += (target - model.starts[i]).div_euclid(1 << h);
        }
        model.n = (model.n + 1).min(80);
        k as i64
    }

    pub(super) fn raw(&mut self, bits: u32) -> i64 {
        if bits > 16 {
            let low = self.raw(16);
            return low + (self.raw(bits - 16) << 16);
        }
        let value = self.x % (1 << bits);
        self.x >>= bits;
        self.refill();
        value as i64
    }
}

/// PMESH-COD-10: a residual of that class.
pub(super) fn residual(symbols: &mut Symbols<'_>, models: &mut [Sixteen], class: i64) -> i64 {
    let shift = (class / 4 - 5).max(0) as u32;
    let context = if shift == 0 { class } else { 20 + class % 4 };
    let size = match symbols.sixteen(&mut models[context as usize]) {
        k @ 0..4 => k,
        k @ 4..14 => ((2 + k % 2) << (k / 2 - 1)) + symbols.raw((k / 2 - 1) as u32),
        14 => 128 + symbols.raw(7),
        _ => {
            let octave = symbols.raw(5).min(27) as u32;
            (1 << octave) + symbols.raw(octave)
        }
    };
    let low = symbols.raw(shift);
    let negative = size != 0 && symbols.raw(1) == 1;
    let whole = if negative { -size } else { size };
    i64::from(((whole << shift) + low - (1i64 << shift) / 2) as i32)
}
