//! What an adapter says that it can do (PROTOCOL.md, "Capabilities"), and what that leaves of a test.

use crate::manifest::{Op, Test, Verdict};
use std::collections::BTreeMap;

/// The lines that the command `capabilities` prints.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Capabilities {
    lines: BTreeMap<String, Vec<String>>,
}

/// What there is to do about a test.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Plan {
    /// The decoder does not claim what it takes.
    NotClaimed,
    /// Run it.
    Run {
        /// One of these must come.
        verdicts: Vec<Verdict>,
        /// The code is compared.
        code: Option<u16>,
        /// OUT is compared.
        out: bool,
    },
}

impl Capabilities {
    /// Reads what was printed. A text that names no format claims everything.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        let mut lines = BTreeMap::new();
        for line in text.lines() {
            let mut words = line.split_whitespace().map(str::to_owned);
            if let Some(key) = words.next() {
                lines.insert(key, words.collect());
            }
        }
        let named = lines.contains_key("ivg") || lines.contains_key("pmesh");
        Self { lines: if named { lines } else { BTreeMap::new() } }
    }

    /// What it calls itself.
    #[must_use]
    pub fn name(&self) -> Option<String> {
        self.lines.get("name").map(|words| words.join(" "))
    }

    fn claims_everything(&self) -> bool {
        self.lines.is_empty()
    }

    fn has(&self, key: &str, value: &str) -> bool {
        self.lines.get(key).is_some_and(|values| values.iter().any(|known| known == value))
    }

    /// Whether a value of a registry is there; without the line all are.
    fn knows(&self, key: &str, value: Option<&String>) -> bool {
        value.is_none_or(|value| !self.lines.contains_key(key) || self.has(key, value))
    }

    /// What there is to do about a test.
    #[must_use]
    pub fn plan(&self, test: &Test) -> Plan {
        let own = || Plan::Run {
            verdicts: [&[test.verdict][..], &test.also].concat(),
            code: test.code,
            out: test.out.is_some(),
        };
        if self.claims_everything() {
            return own();
        }
        let claimed = match &test.format {
            None => self.has("numeric", test.args.as_deref().unwrap_or("")),
            Some(format) => {
                self.lines.contains_key(format) && (test.op == Op::Decode || self.has(format, test.op.name()))
            }
        };
        let known = self.knows("encodings", test.needs.encoding.as_ref())
            && self.knows("orders", test.needs.order.as_ref())
            && self.knows("modes", test.needs.mode.as_ref());
        match (claimed, known) {
            (false, _) => Plan::NotClaimed,
            (true, false) if test.op == Op::Prefixes => Plan::NotClaimed,
            (true, false) => Plan::Run { verdicts: vec![Verdict::Unsupported], code: None, out: false },
            (true, true) => match own() {
                Plan::Run { verdicts, code, out } => {
                    Plan::Run { verdicts, code: code.filter(|_| self.lines.contains_key("codes")), out }
                }
                Plan::NotClaimed => Plan::NotClaimed,
            },
        }
    }
}

#[cfg(test)]
mod tests;
