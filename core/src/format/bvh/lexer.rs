//! Lines and words of a BVH file, with their line numbers.

use std::fmt::Display;

use crate::error::{BvhError, Fault};
use crate::format::bvh::Result;

/// No number of a motion is as large; `f32` holds all smaller ones.
const HUGE: f64 = 1e30;

/// Iterates over the words of a text.
pub(super) struct Lexer<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Lexer<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { rest: text, line: 1 }
    }

    /// An error at the current line.
    pub(super) fn fail<T>(&self, fault: Fault) -> Result<T> {
        Err(BvhError { line: self.line, fault })
    }

    /// An error at the current line: something else was expected.
    pub(super) fn unexpected<T>(&self, expected: impl Display, found: impl Display) -> Result<T> {
        self.fail(Fault::unexpected(expected, found))
    }

    /// Number of bytes left.
    pub(super) fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// The next word, on this line or a later one; `None` at the end of the file.
    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        while let Some((&first, rest)) = self.rest.split_first() {
            if !first.is_ascii_whitespace() {
                break;
            }
            self.line += usize::from(first == b'\n');
            self.rest = rest;
        }
        self.word()
    }

    /// The next word on this line; `None` at its end.
    pub(super) fn next_in_line(&mut self) -> Option<&'a [u8]> {
        let blanks = self.rest.iter().take_while(|&&c| c != b'\n' && c.is_ascii_whitespace()).count();
        self.rest = &self.rest[blanks..];
        self.word()
    }

    fn word(&mut self) -> Option<&'a [u8]> {
        let length = self.rest.iter().take_while(|c| !c.is_ascii_whitespace()).count();
        let (word, rest) = self.rest.split_at(length);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    /// Consumes the next word, which must be this one in any case.
    pub(super) fn expect(&mut self, expected: &str) -> Result<()> {
        match self.next() {
            Some(word) if word.eq_ignore_ascii_case(expected.as_bytes()) => Ok(()),
            Some(word) => self.unexpected(expected, shown(word)),
            None => self.fail(Fault::truncated(expected, "the end of the file")),
        }
    }

    /// The next word on this line as a finite number.
    pub(super) fn number(&mut self, what: &str) -> Result<f64> {
        let Some(word) = self.next_in_line() else {
            return self.unexpected(what, "the end of the line");
        };
        self.parse(word, what)
    }

    /// A word as a finite number.
    pub(super) fn parse(&self, word: &[u8], what: &str) -> Result<f64> {
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse::<f64>().ok());
        match number {
            Some(number) if number.abs() < HUGE => Ok(number),
            // Digits that are beyond any number become infinity.
            Some(number) if number.is_finite() || word.iter().any(u8::is_ascii_digit) => {
                self.fail(Fault::too_large(what, shown(word), format_args!("less than {HUGE:e}")))
            }
            Some(_) => self.fail(Fault::not_finite(what, shown(word))),
            None => self.unexpected(what, shown(word)),
        }
    }

    /// The next word on this line as a non-negative integer.
    pub(super) fn count(&mut self, what: &str) -> Result<usize> {
        let word = self.next_in_line().unwrap_or_default();
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.map_or_else(|| self.unexpected(what, shown(word)), Ok)
    }

    /// Checks that nothing else follows on this line.
    pub(super) fn end_of_line(&mut self, after: &str) -> Result<()> {
        match self.next_in_line() {
            None => Ok(()),
            Some(word) => self.unexpected(format_args!("the end of the line after {after}"), shown(word)),
        }
    }

    /// The words up to the end of this line or an opening brace, which is not consumed, joined by single spaces.
    pub(super) fn name(&mut self) -> Result<String> {
        let mut name = String::new();
        loop {
            let before = self.rest;
            match self.next_in_line() {
                Some(b"{") => self.rest = before,
                Some(word) => {
                    let Ok(word) = std::str::from_utf8(word) else {
                        return self.unexpected("a name in UTF-8", shown(word));
                    };
                    if !name.is_empty() {
                        name.push(' ');
                    }
                    name.push_str(word);
                    continue;
                }
                None => {}
            }
            return if name.is_empty() { self.unexpected("a joint's name", "none") } else { Ok(name) };
        }
    }
}

/// The start of a word, quoted and escaped for a message.
pub(super) fn shown(word: &[u8]) -> String {
    let start = word[..word.len().min(40)].escape_ascii();
    format!("`{start}{}`", if word.len() > 40 { "…" } else { "" })
}
