//! Pictures one after the other in a file that plays: GIF, and APNG, both in 256 colours that all frames share, so that
//! nothing flickers.

use super::image::Image;
use super::palette::indexed;
use crate::failure::{Failure, Result};

/// Pictures of one size that follow each other at equal times.
pub(crate) struct Animation {
    pub(crate) frames: Vec<Image>,
    /// How long each is shown, hundredths of a second.
    pub(crate) delay: u16,
}

/// The frames as indices into one palette.
struct Indexed {
    width: u16,
    height: u16,
    palette: Vec<u8>,
    frames: Vec<Vec<u8>>,
}

impl Animation {
    /// The bytes of a GIF that repeats forever.
    pub(crate) fn to_gif(&self) -> Result<Vec<u8>> {
        let Indexed { width, height, palette, frames } = self.indexed("GIF")?;
        let mut bytes = Vec::new();
        let mut encoder = gif::Encoder::new(&mut bytes, width, height, &palette)?;
        encoder.set_repeat(gif::Repeat::Infinite)?;
        for buffer in frames {
            let frame = gif::Frame {
                width,
                height,
                delay: self.delay,
                buffer: buffer.into(),
                ..gif::Frame::default()
            };
            encoder.write_frame(&frame)?;
        }
        drop(encoder);
        Ok(bytes)
    }

    /// The bytes of an animated PNG that repeats forever.
    pub(crate) fn to_apng(&self) -> Result<Vec<u8>> {
        let Indexed { width, height, palette, frames } = self.indexed("APNG")?;
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width.into(), height.into());
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        encoder.set_filter(png::Filter::NoFilter);
        encoder.set_palette(palette);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_animated(frames.len() as u32, 0)?;
        encoder.set_frame_delay(self.delay, 100)?;
        let mut writer = encoder.write_header()?;
        for frame in &frames {
            writer.write_image_data(frame)?;
        }
        writer.finish()?;
        Ok(bytes)
    }

    fn indexed(&self, format: &str) -> Result<Indexed> {
        let first = self.frames.first().ok_or_else(|| Failure::failed("an animation needs a frame"))?;
        let (width, height) = (u16::try_from(first.width), u16::try_from(first.height));
        let (Ok(width), Ok(height)) = (width, height) else {
            return Err(Failure::failed(format!("the picture is too large for {format}")));
        };
        let all: Vec<u8> = self.frames.iter().flat_map(|frame| frame.pixels.iter().copied()).collect();
        let (palette, indices) = indexed(&all);
        let size = first.width * first.height;
        let frames = indices.chunks_exact(size.max(1)).map(<[u8]>::to_vec).collect();
        Ok(Indexed { width, height, palette: palette.concat(), frames })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blinking() -> Animation {
        let frames = [[10, 20, 30], [200, 100, 50], [10, 20, 30]].map(|colour| Image::new(5, 4, colour));
        Animation { frames: frames.into(), delay: 7 }
    }

    #[test]
    fn a_gif_reads_back() {
        let bytes = blinking().to_gif().unwrap();
        assert_eq!(bytes, blinking().to_gif().unwrap());
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut reader = options.read_info(bytes.as_slice()).unwrap();
        assert_eq!((reader.width(), reader.height(), reader.repeat()), (5, 4, gif::Repeat::Infinite));
        let mut colours = Vec::new();
        while let Some(frame) = reader.read_next_frame().unwrap() {
            assert_eq!(frame.delay, 7);
            colours.push([frame.buffer[0], frame.buffer[1], frame.buffer[2]]);
        }
        assert_eq!(colours, [[10, 20, 30], [200, 100, 50], [10, 20, 30]]);
    }

    #[test]
    fn an_animated_png_reads_back() {
        let bytes = blinking().to_apng().unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        assert_eq!(reader.info().animation_control.map(|all| (all.num_frames, all.num_plays)), Some((3, 0)));
        let mut out = vec![0; reader.output_buffer_size().unwrap()];
        for colour in [[10, 20, 30], [200, 100, 50], [10, 20, 30]] {
            reader.next_frame(&mut out).unwrap();
            assert_eq!(out[..3], colour);
            let shown = reader.info().frame_control.unwrap();
            assert_eq!((shown.delay_num, shown.delay_den), (7, 100));
        }
    }
}
