//! Quantisation to 256 colours: median cut (Heckbert, "Color image quantization for frame buffer display", 1982). It
//! makes a sheet of many figures a third of the size without a visible difference.

/// Number of colours of a palette: what one byte can index.
const COLOURS: usize = 256;

/// A palette and the index of each pixel in it; pixels have three bytes.
pub(super) fn indexed(pixels: &[u8]) -> (Vec<[u8; 3]>, Vec<u8>) {
    let mut boxes = vec![Cut::new(histogram(pixels))];
    while boxes.len() < COLOURS {
        let costliest =
            (0..boxes.len()).filter(|&i| boxes[i].colours.len() > 1).max_by_key(|&i| boxes[i].cost);
        let Some(costliest) = costliest else { break };
        let (low, high) = boxes.swap_remove(costliest).halves();
        boxes.extend([low, high]);
    }
    let mut places: Vec<([u8; 3], u8)> = boxes
        .iter()
        .enumerate()
        .flat_map(|(i, cut)| cut.colours.iter().map(move |(colour, _)| (*colour, i as u8)))
        .collect();
    places.sort_unstable();
    let place = |pixel: &[u8]| places[places.partition_point(|(colour, _)| colour[..] < *pixel)].1;
    let mut before: Option<(&[u8], u8)> = None;
    let mut indices = Vec::with_capacity(pixels.len() / 3);
    for pixel in pixels.chunks_exact(3) {
        // Neighbours are often alike.
        let index = before.filter(|b| b.0 == pixel).map_or_else(|| place(pixel), |b| b.1);
        before = Some((pixel, index));
        indices.push(index);
    }
    (boxes.iter().map(Cut::mean).collect(), indices)
}

/// The distinct colours, ascending, with their number of pixels.
fn histogram(pixels: &[u8]) -> Vec<([u8; 3], u64)> {
    let mut all: Vec<[u8; 3]> = pixels.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    all.sort_unstable();
    all.chunk_by(|a, b| a == b).map(|same| (same[0], same.len() as u64)).collect()
}

/// A box of the median cut: near colours that share a palette entry.
struct Cut {
    colours: Vec<([u8; 3], u64)>,
    /// The channel with the largest range.
    channel: usize,
    /// Priority for cutting: that range squared, times the root of the number of pixels.
    cost: u64,
}

impl Cut {
    fn new(colours: Vec<([u8; 3], u64)>) -> Self {
        let spread = |c: usize| {
            let values = || colours.iter().map(|(colour, _)| u64::from(colour[c]));
            values().max().unwrap_or(0) - values().min().unwrap_or(0)
        };
        let channel = (0..3).max_by_key(|&c| spread(c)).unwrap_or(0);
        // Only the root of the number of pixels: a large backdrop must not take all colours.
        let pixels: u64 = colours.iter().map(|(_, n)| n).sum();
        let cost = spread(channel).pow(2) * pixels.isqrt();
        Self { colours, channel, cost }
    }

    /// Cuts so that about half of the pixels lie on either side; both have a colour where this has two.
    fn halves(mut self) -> (Self, Self) {
        let channel = self.channel;
        self.colours.sort_unstable_by_key(|(colour, _)| (colour[channel], *colour));
        let half = self.colours.iter().map(|(_, n)| n).sum::<u64>() / 2;
        let mut before = 0;
        let middle = self.colours.iter().position(|(_, n)| {
            before += n;
            before > half
        });
        let at = middle.unwrap_or(0).clamp(1, self.colours.len() - 1);
        let high = self.colours.split_off(at);
        (Self::new(self.colours), Self::new(high))
    }

    fn mean(&self) -> [u8; 3] {
        let pixels: u64 = self.colours.iter().map(|(_, n)| n).sum();
        std::array::from_fn(|c| {
            let sum: u64 = self.colours.iter().map(|(colour, n)| u64::from(colour[c]) * n).sum();
            ((sum + pixels / 2) / pixels.max(1)) as u8
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colours_stay_as_they_are() {
        let pixels = [0, 0, 0, 9, 8, 7, 0, 0, 0, 255, 255, 255];
        let (palette, indices) = indexed(&pixels);
        let back: Vec<u8> = indices.iter().flat_map(|i| palette[usize::from(*i)]).collect();
        assert_eq!(back, pixels);
        assert_eq!(palette.len(), 3);
    }

    #[test]
    fn many_colours_stay_near() {
        let pixels: Vec<u8> =
            (0..4096_u32).flat_map(|i| [(i % 64 * 4) as u8, (i / 64 * 4) as u8, 40]).collect();
        let (palette, indices) = indexed(&pixels);
        assert_eq!((palette.len(), indices.len()), (256, 4096));
        for (pixel, index) in pixels.chunks_exact(3).zip(&indices) {
            for (a, b) in pixel.iter().zip(palette[usize::from(*index)]) {
                // 16 × 16 boxes of 4 × 4 colours would be off by 6 at most.
                assert!(a.abs_diff(b) <= 12, "{pixel:?} {:?}", palette[usize::from(*index)]);
            }
        }
    }

    #[test]
    fn nothing_has_no_pixels() {
        assert!(indexed(&[]).1.is_empty());
    }
}
