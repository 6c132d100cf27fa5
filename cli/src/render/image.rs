//! An 8-bit sRGB picture and its PNG.

use glam::Vec3;

use super::palette::indexed;
use crate::failure::{Failure, Result};

/// Rows from the top, three bytes a pixel, sRGB.
pub(crate) struct Image {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) pixels: Vec<u8>,
}

impl Image {
    /// A picture of one colour.
    pub(crate) fn new(width: usize, height: usize, colour: [u8; 3]) -> Self {
        Self { width, height, pixels: colour.repeat(width * height) }
    }

    /// Sets a pixel; outside the picture nothing happens.
    pub(crate) fn set(&mut self, x: usize, y: usize, colour: [u8; 3]) {
        if x < self.width && y < self.height {
            let at = (y * self.width + x) * 3;
            self.pixels[at..at + 3].copy_from_slice(&colour);
        }
    }

    /// Copies another picture in, its top left corner at (x, y).
    pub(crate) fn paste(&mut self, other: &Self, x: usize, y: usize) {
        for row in 0..other.height {
            for column in 0..other.width {
                let at = (row * other.width + column) * 3;
                let [r, g, b] = [other.pixels[at], other.pixels[at + 1], other.pixels[at + 2]];
                self.set(x + column, y + row, [r, g, b]);
            }
        }
    }

    /// The bytes of a PNG file.
    pub(crate) fn to_png(&self) -> Result<Vec<u8>> {
        self.encode(png::ColorType::Rgb, None, &self.pixels)
    }

    /// The bytes of a PNG file of 256 colours: much smaller, for large overviews.
    pub(crate) fn to_small_png(&self) -> Result<Vec<u8>> {
        let (palette, indices) = indexed(&self.pixels);
        self.encode(png::ColorType::Indexed, Some(palette.concat()), &indices)
    }

    fn encode(&self, colour: png::ColorType, palette: Option<Vec<u8>>, data: &[u8]) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let (width, height) = (u32::try_from(self.width), u32::try_from(self.height));
        let (Ok(width), Ok(height)) = (width, height) else {
            return Err(Failure::failed("the picture is too large for PNG"));
        };
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(colour);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        if let Some(palette) = palette {
            // Filters predict values; palette indices are not predictable.
            encoder.set_filter(png::Filter::NoFilter);
            encoder.set_palette(palette);
        }
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(data)?;
        writer.finish()?;
        Ok(bytes)
    }
}

/// Linear light, 0..1, to an sRGB byte (IEC 61966-2-1); `grain`, -0.5..0.5 of a step, decides the rounding.
pub(crate) fn srgb_from_linear(x: f32, grain: f32) -> u8 {
    let x = x.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::powf(x, 1.0 / 2.4) - 0.055 };
    (encoded * 255.0 + 0.5 + grain) as u8
}

/// An sRGB byte to linear light.
pub(crate) fn linear_from_srgb(byte: u8) -> f32 {
    let x = f32::from(byte) / 255.0;
    if x <= 0.040_45 { x / 12.92 } else { libm::powf((x + 0.055) / 1.055, 2.4) }
}

/// An sRGB colour to linear light.
pub(crate) fn linear(colour: [u8; 3]) -> Vec3 {
    Vec3::from_array(colour.map(linear_from_srgb))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_round_trips() {
        for byte in 0..=255 {
            assert_eq!(srgb_from_linear(linear_from_srgb(byte), 0.0), byte);
        }
    }

    #[test]
    fn png_reads_back() {
        let mut image = Image::new(3, 2, [10, 20, 30]);
        image.set(2, 1, [200, 100, 50]);
        image.set(7, 7, [0, 0, 0]);
        let bytes = image.to_png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut out = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut out).unwrap();
        assert_eq!(out, image.pixels);
        assert_eq!(&out[15..], [200, 100, 50]);

        let small = image.to_small_png().unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(small));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        assert_eq!(reader.info().palette.as_ref().map(|p| p.len()), Some(6));
        reader.next_frame(&mut out).unwrap();
        assert_eq!(out, image.pixels);
    }
}
