//! Changes of bytes that readers stumble over: of single bits, numbers, lines and whole stretches.

use crate::random::Random;

/// Numbers that are no lengths, indices or angles.
const NUMBERS: [&str; 16] = [
    "0",
    "-1",
    "1",
    "255",
    "65536",
    "2147483648",
    "4294967295",
    "18446744073709551615",
    "99999999999999999999999",
    "1e39",
    "-1e308",
    "1e999",
    "1e-320",
    "nan",
    "inf",
    "",
];
const BRACKETS: &[u8] = b"{}[]()<>\"'#,:;=@";

pub(super) struct Mutation(Random);

impl Mutation {
    pub(super) fn new(seed: u64) -> Self {
        Self(Random::new(seed, 77))
    }

    /// From 0 to one below `count`, which is not 0.
    pub(super) fn below(&mut self, count: usize) -> usize {
        (self.0.bits() % count as u64) as usize
    }

    /// Changes bytes one to four times.
    pub(super) fn change(&mut self, bytes: &mut Vec<u8>) {
        for _ in 0..=self.below(4) {
            if bytes.is_empty() {
                bytes.push(self.0.bits() as u8);
            }
            let at = self.below(bytes.len());
            match self.below(10) {
                0 => bytes[at] ^= 1 << self.below(8),
                1 => bytes[at] = self.0.bits() as u8,
                2 => self.set_integer(bytes),
                3 => bytes.truncate(at),
                4 => self.move_stretch(bytes),
                5 => self.repeat_byte(bytes),
                6 => self.change_line(bytes),
                _ => self.change_number(bytes),
            }
        }
    }

    /// Somewhere in the bytes, and the end of a stretch from there, mostly a short one.
    fn stretch(&mut self, bytes: &[u8]) -> (usize, usize) {
        let start = self.below(bytes.len());
        let most = if self.below(4) == 0 { bytes.len() } else { 32 };
        (start, (start + 1 + self.below(most)).min(bytes.len()))
    }

    /// A binary integer of 2, 4 or 8 bytes, of the smallest or largest ones or a small difference from what is there.
    fn set_integer(&mut self, bytes: &mut [u8]) {
        let size = 2 << self.below(3);
        if bytes.len() < size {
            return;
        }
        let at = self.below(bytes.len() - size + 1);
        let mut old = [0; 8];
        old[..size].copy_from_slice(&bytes[at..at + size]);
        let old = u64::from_le_bytes(old);
        let new = match self.below(5) {
            0 => 0,
            1 => u64::MAX,
            2 => 1 << (8 * size - 1),
            3 => 1 << self.below(8 * size),
            _ => old.wrapping_add(self.below(17) as u64).wrapping_sub(8),
        };
        bytes[at..at + size].copy_from_slice(&new.to_le_bytes()[..size]);
    }

    /// Removes a stretch, or copies it to another place.
    fn move_stretch(&mut self, bytes: &mut Vec<u8>) {
        let (start, end) = self.stretch(bytes);
        if self.below(2) == 0 {
            bytes.drain(start..end);
        } else {
            let copy = bytes[start..end].to_vec();
            let at = self.below(bytes.len());
            bytes.splice(at..at, copy);
        }
    }

    /// Inserts a byte up to many thousand times: nested brackets, long names.
    fn repeat_byte(&mut self, bytes: &mut Vec<u8>) {
        let at = self.below(bytes.len());
        let byte = if self.below(4) == 0 { bytes[at] } else { BRACKETS[self.below(BRACKETS.len())] };
        let count = 1 << self.below(17);
        bytes.splice(at..at, std::iter::repeat_n(byte, count));
    }

    /// Removes a line or writes it elsewhere as well.
    fn change_line(&mut self, bytes: &mut Vec<u8>) {
        let lines: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
        let line = self.below(lines.len());
        let copy = lines[line].to_vec();
        let to = self.below(lines.len());
        let at = |line: usize| lines[..line].iter().map(|line| line.len()).sum::<usize>();
        let (from, to) = (at(line), at(to));
        if self.below(2) == 0 {
            bytes.drain(from..from + copy.len());
        } else {
            bytes.splice(to..to, copy);
        }
    }

    /// Writes another number in the place of one that is written in digits.
    fn change_number(&mut self, bytes: &mut Vec<u8>) {
        let is_part = |byte: &u8| byte.is_ascii_digit() || b".-+eE".contains(byte);
        let from = self.below(bytes.len());
        let Some(start) = (from..bytes.len()).find(|at| bytes[*at].is_ascii_digit()) else { return };
        let length = bytes[start..].iter().take_while(|byte| is_part(byte)).count();
        let new = NUMBERS[self.below(NUMBERS.len())];
        bytes.splice(start..start + length, new.bytes());
    }
}
