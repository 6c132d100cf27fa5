//! The colour of the skin.
//!
//! Ten steps are those of the Monk Skin Tone scale (Ellis Monk, 2019; skintone.google, CC BY 4.0), which was designed to
//! represent people evenly; any other colour is given as `#rrggbb`.

use std::{fmt, str::FromStr};

use crate::{Error, Result};

/// The scale's swatches 1 to 10, sRGB.
const MONK: [[u8; 3]; 10] = [
    [0xf6, 0xed, 0xe4],
    [0xf3, 0xe7, 0xdb],
    [0xf7, 0xea, 0xd0],
    [0xea, 0xda, 0xba],
    [0xd7, 0xbd, 0x96],
    [0xa0, 0x7e, 0x56],
    [0x82, 0x5c, 0x43],
    [0x60, 0x41, 0x34],
    [0x3a, 0x31, 0x2a],
    [0x29, 0x24, 0x20],
];

/// A skin colour: a step of the Monk scale, written `1` (light) to `10` (dark), or an sRGB colour, written `#rrggbb`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SkinTone {
    srgb: [u8; 3],
    step: Option<u8>,
}

impl SkinTone {
    /// A step of the Monk Skin Tone scale, `1..=10`; `None` outside that range.
    pub fn monk(step: u8) -> Option<Self> {
        let srgb = *MONK.get(usize::from(step).checked_sub(1)?)?;
        Some(Self { srgb, step: Some(step) })
    }

    /// Any colour, as the three sRGB bytes red, green, blue.
    pub fn from_srgb(srgb: [u8; 3]) -> Self {
        Self { srgb, step: None }
    }

    /// The three sRGB bytes red, green, blue.
    pub fn srgb(self) -> [u8; 3] {
        self.srgb
    }

    /// The opaque base colour: linear RGB and alpha 1, as glTF wants it.
    pub fn base_color(self) -> [f32; 4] {
        let [r, g, b] = self.srgb.map(linear_from_srgb);
        [r, g, b, 1.0]
    }
}

impl Default for SkinTone {
    /// Step 5, the middle of the scale.
    fn default() -> Self {
        Self { srgb: MONK[4], step: Some(5) }
    }
}

impl FromStr for SkinTone {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let parsed = match text.strip_prefix('#') {
            Some(hex) => srgb_from_hex(hex).map(Self::from_srgb),
            None => text.parse().ok().and_then(Self::monk),
        };
        parsed.ok_or_else(|| {
            Error::request("skin_tone", format!("expected a Monk tone from 1 to 10 or #rrggbb, got `{text}`"))
        })
    }
}

impl fmt::Display for SkinTone {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.srgb;
        match self.step {
            Some(step) => write!(f, "{step}"),
            None => write!(f, "#{r:02x}{g:02x}{b:02x}"),
        }
    }
}

fn srgb_from_hex(hex: &str) -> Option<[u8; 3]> {
    // `from_str_radix` also accepts a sign.
    if hex.len() != 6 || !hex.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let [_, r, g, b] = u32::from_str_radix(hex, 16).ok()?.to_be_bytes();
    Some([r, g, b])
}

/// The sRGB transfer function of IEC 61966-2-1, decoding.
fn linear_from_srgb(byte: u8) -> f32 {
    let c = f64::from(byte) / 255.0;
    (if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decodes_known_srgb_values() {
        assert_eq!(linear_from_srgb(0), 0.0);
        assert_eq!(linear_from_srgb(255), 1.0);
        // 188 is the byte nearest to linear 0.5: published tables give 0.502886.
        assert!((linear_from_srgb(188) - 0.502_886).abs() < 1e-6);
        assert!((linear_from_srgb(10) - 0.003_035).abs() < 1e-6);
    }

    #[test]
    fn reads_steps_and_hex_and_writes_them_back() {
        for text in ["1", "10", "#8d5524"] {
            assert_eq!(text.parse::<SkinTone>().unwrap().to_string(), text);
        }
        assert_eq!("#FFFFFF".parse::<SkinTone>().unwrap().base_color(), [1.0; 4]);
        assert_eq!("5".parse::<SkinTone>().unwrap(), SkinTone::default());
    }

    #[test]
    fn refuses_anything_else_by_name() {
        for text in ["", "0", "11", "-1", "#", "#12345", "#1234567", "#+12345", "#ggg000", "#é1234", "tan"] {
            let message = text.parse::<SkinTone>().unwrap_err().to_string();
            assert!(message.starts_with("skin_tone: expected"), "{message}");
            assert!(message.contains(&format!("`{text}`")), "{message}");
        }
    }

    #[test]
    fn the_scale_runs_from_light_to_dark() {
        let light = |step| SkinTone::monk(step).unwrap().base_color()[1];
        assert!((4..10).all(|step| light(step) > light(step + 1)));
    }
}
