//! The entropy coder: symbols out of two states and words, raw bits (PMESH-COD-02 to -04), residuals (PMESH-COD-10).

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

/// PMESH-COD-02: the states, the words behind them, and the raw bits at the end.
pub(super) struct Symbols<'a> {
    x: u64,
    y: u64,
    payload: &'a [u8],
    /// Where the next word begins.
    pub(super) at: usize,
    /// Raw bits that have been read.
    raw_bits: usize,
    dictation: Option<Dictation>,
    /// What the next question is about.
    what: &'static str,
}

/// Answers in place of a payload, and what was asked.
struct Dictation {
    /// `None`: the payload answers.
    answers: Option<std::vec::IntoIter<i64>>,
    asked: Vec<Asked>,
}

/// A question that a reader of a coded packet asks, and its answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Asked {
    /// What it is about; empty where nobody has to know.
    pub what: &'static str,
    /// The answer: a bit, a symbol, a raw number.
    pub answer: i64,
    /// First and number of the probabilities of a symbol; `None` for a raw number.
    range: Option<(i64, i64)>,
    /// Bits of a raw number.
    pub bits: u32,
}

impl Asked {
    /// Whether it is a raw number, which leaves all other answers as they are.
    #[must_use]
    pub fn is_raw(&self) -> bool {
        self.range.is_none()
    }
}

impl<'a> Symbols<'a> {
    /// `None` if the payload is too short for the states.
    pub(super) fn new(payload: &'a [u8]) -> Option<Self> {
        let state = |at: usize| payload.get(at..at + 4)?.try_into().ok().map(u32::from_le_bytes);
        let (x, y) = (state(0)?, state(4)?);
        Some(Self { x: x.into(), y: y.into(), payload, at: 8, raw_bits: 0, dictation: None, what: "" })
    }

    /// Notes from now on what is asked; `answers` come in place of what the payload says, and 0 when they end.
    pub(super) fn note(&mut self, answers: Option<Vec<i64>>) {
        self.dictation = Some(Dictation { answers: answers.map(Vec::into_iter), asked: Vec::new() });
    }

    /// What was asked since.
    pub(super) fn asked(self) -> Vec<Asked> {
        self.dictation.map_or_else(Vec::new, |dictation| dictation.asked)
    }

    /// Says what the next question is about.
    pub(super) fn about(&mut self, what: &'static str) -> &mut Self {
        self.what = what;
        self
    }

    fn is_dictated(&self) -> bool {
        self.dictation.as_ref().is_some_and(|dictation| dictation.answers.is_some())
    }

    /// The answer to a question, if somebody dictates: at most `most`.
    fn dictated(&mut self, most: i64) -> Option<i64> {
        let answers = self.dictation.as_mut()?.answers.as_mut()?;
        Some(answers.next().unwrap_or(0).min(most))
    }

    fn answered(&mut self, answer: i64, range: Option<(i64, i64)>, bits: u32) {
        let what = std::mem::take(&mut self.what);
        if let Some(dictation) = &mut self.dictation {
            dictation.asked.push(Asked { what, answer, range, bits });
        }
    }

    /// Where the raw bits begin that have been read.
    pub(super) fn raw_at(&self) -> isize {
        self.payload.len() as isize - self.raw_bits.div_ceil(8) as isize
    }

    /// PMESH-COD-03: whether more has been read than there is.
    pub(super) fn missing(&self) -> bool {
        !self.is_dictated() && self.at as isize > self.raw_at()
    }

    /// PMESH-COD-03: whether nothing is left to be read.
    pub(super) fn at_end(&self) -> bool {
        !self.missing() && self.x == 1 << 16 && self.y == 1 << 16
    }

    /// The bits that are left of the last byte of raw bits.
    pub(super) fn rest(&self) -> u8 {
        let used = self.raw_bits % 8;
        if used == 0 { 0 } else { self.payload[self.raw_at() as usize] >> used }
    }

    fn range(&mut self, c: i64, f: i64, answer: i64) {
        self.answered(answer, Some((c, f)), 0);
        if self.is_dictated() {
            return;
        }
        let low = self.x % (1 << 15);
        self.x = f as u64 * (self.x >> 15) + low - c as u64;
        if self.x < 1 << 16 {
            let word = self.payload.get(self.at..self.at + 2).unwrap_or(&[0, 0]);
            self.x = (self.x << 16) + u64::from(word[0]) + 256 * u64::from(word[1]);
            self.at += 2;
        }
        std::mem::swap(&mut self.x, &mut self.y);
    }

    pub(super) fn bit(&mut self, model: &mut Binary) -> bool {
        let value = match self.dictated(1) {
            Some(answer) => answer == 1,
            None => ((self.x % (1 << 15)) as i64) < model.p,
        };
        if value {
            self.range(0, model.p, 1);
        } else {
            self.range(model.p, (1 << 15) - model.p, 0);
        }
        let target = if value { (1 << 15) - 32 } else { 32 };
        model.p += ((target - model.p) * (655_360 / (10 * model.n + 16))).div_euclid(1 << 16);
        model.n = (model.n + 1).min(60);
        value
    }

    pub(super) fn sixteen(&mut self, model: &mut Sixteen) -> i64 {
        let low = (self.x % (1 << 15)) as i64;
        let found = || (0..16).rev().find(|&k| model.starts[k] <= low).expect("the first start is 0");
        let k = self.dictated(15).map_or_else(found, |answer| answer as usize);
        let end = if k == 15 { 1 << 15 } else { model.starts[k + 1] };
        self.range(model.starts[k], end - model.starts[k], k as i64);
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
        let mut number = 0;
        for k in 0..bits {
            let byte = self.payload.len().checked_sub(self.raw_bits / 8 + 1).map_or(0, |at| self.payload[at]);
            number |= i64::from(byte >> (self.raw_bits % 8) & 1) << k;
            self.raw_bits += 1;
        }
        let number = self.dictated((1 << bits) - 1).unwrap_or(number);
        self.answered(number, None, bits);
        number
    }
}

/// What both states are behind the last symbol (PMESH-COD-03).
pub const LAST_STATES: [u64; 2] = [1 << 16; 2];

/// The payload that gives these answers, in two parts: states and words; raw bits, which end it (PMESH-COD-02). `last`: the states
/// behind the last symbol.
pub fn payload_of(asked: &[Asked], last: [u64; 2]) -> [Vec<u8>; 2] {
    let [mut x, mut y] = last;
    let mut words = Vec::new();
    for (c, f) in asked.iter().rev().filter_map(|asked| asked.range) {
        std::mem::swap(&mut x, &mut y);
        let (c, f) = (c as u64, f as u64);
        if x >> 17 >= f {
            words.push(x as u16);
            x >>= 16;
        }
        x = ((x / f) << 15) + x % f + c;
    }
    let mut front = [x as u32, y as u32].map(u32::to_le_bytes).concat();
    front.extend(words.iter().rev().flat_map(|word| word.to_le_bytes()));
    let bits: Vec<u8> = asked
        .iter()
        .filter(|asked| asked.range.is_none())
        .flat_map(|asked| (0..asked.bits).map(|k| (asked.answer >> k & 1) as u8))
        .collect();
    let byte = |bits: &[u8]| bits.iter().rev().fold(0, |byte, bit| byte << 1 | bit);
    let raw = bits.chunks(8).rev().map(byte).collect();
    [front, raw]
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
