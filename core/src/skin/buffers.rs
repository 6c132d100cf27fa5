//! The caller's buffers for skinned vertices: three f32 per vertex in native byte order, any stride, no alignment
//! required.

use std::mem::MaybeUninit;

use glam::Vec4;

use super::block::{CHUNK_VERTICES, LANES, Lanes, transposed};
use crate::{Error, Result};

/// Size of three f32, bytes.
const WIDTH: usize = 12;

/// Write-only bytes.
#[derive(Debug)]
pub enum BytesMut<'a> {
    /// Initialised memory.
    Init(&'a mut [u8]),
    /// Possibly uninitialised memory, such as C has just allocated.
    Uninit(&'a mut [MaybeUninit<u8>]),
}

impl<'a> From<&'a mut [u8]> for BytesMut<'a> {
    fn from(bytes: &'a mut [u8]) -> Self {
        Self::Init(bytes)
    }
}

impl<'a> From<&'a mut [MaybeUninit<u8>]> for BytesMut<'a> {
    fn from(bytes: &'a mut [MaybeUninit<u8>]) -> Self {
        Self::Uninit(bytes)
    }
}

impl<'a> BytesMut<'a> {
    fn len(&self) -> usize {
        match self {
            Self::Init(bytes) => bytes.len(),
            Self::Uninit(bytes) => bytes.len(),
        }
    }

    /// Splits off the first `count` bytes, or all if there are fewer.
    fn split(self, count: usize) -> (Self, Self) {
        let count = count.min(self.len());
        match self {
            Self::Init(bytes) => {
                let (head, tail) = bytes.split_at_mut(count);
                (Self::Init(head), Self::Init(tail))
            }
            Self::Uninit(bytes) => {
                let (head, tail) = bytes.split_at_mut(count);
                (Self::Uninit(head), Self::Uninit(tail))
            }
        }
    }

    /// Writes a block of packed vectors; returns false if they do not fit.
    #[inline(always)]
    fn write_packed(&mut self, at: usize, vectors: &[[u8; 16]; LANES]) -> bool {
        let place = at..at + LANES * WIDTH;
        // Writes whole registers, each overwriting the previous one's unused fourth component.
        let (whole, last) = (&vectors[..LANES - 1], &vectors[LANES - 1][..WIDTH]);
        match self {
            Self::Init(bytes) => {
                let Some(packed) = bytes.get_mut(place) else { return false };
                for (lane, vector) in whole.iter().enumerate() {
                    packed[lane * WIDTH..lane * WIDTH + 16].copy_from_slice(vector);
                }
                packed[(LANES - 1) * WIDTH..].copy_from_slice(last);
            }
            Self::Uninit(bytes) => {
                let Some(packed) = bytes.get_mut(place) else { return false };
                for (lane, vector) in whole.iter().enumerate() {
                    packed[lane * WIDTH..lane * WIDTH + 16].write_copy_of_slice(vector);
                }
                packed[(LANES - 1) * WIDTH..].write_copy_of_slice(last);
            }
        }
        true
    }

    /// Writes at a byte offset; does nothing if the values do not fit.
    #[inline(always)]
    fn write(&mut self, at: usize, values: &[u8]) {
        match self {
            Self::Init(bytes) => {
                if let Some(out) = bytes.get_mut(at..at + values.len()) {
                    out.copy_from_slice(values);
                }
            }
            Self::Uninit(bytes) => {
                if let Some(out) = bytes.get_mut(at..at + values.len()) {
                    out.write_copy_of_slice(values);
                }
            }
        }
    }
}

/// Three f32 per vertex in a buffer: vertex v at byte `offset + v · stride`.
#[derive(Debug)]
pub struct StridedMut<'a> {
    /// The buffer; bytes between the vertices are not changed.
    pub bytes: BytesMut<'a>,
    /// Offset of the first vertex, bytes.
    pub offset: usize,
    /// Distance between vertices, bytes; at least 12.
    pub stride: usize,
}

/// Destination of positions and normals.
#[derive(Debug)]
pub enum SurfaceMut<'a> {
    /// Two buffers, or positions only.
    Separate {
        /// Metres.
        positions: StridedMut<'a>,
        /// Unit vectors.
        normals: Option<StridedMut<'a>>,
    },
    /// One buffer with both per vertex, the usual layout on GPUs.
    Interleaved {
        /// The buffer; bytes between the attributes are not changed.
        bytes: BytesMut<'a>,
        /// Distance between vertices, bytes.
        stride: usize,
        /// Offset of the position within a vertex, bytes.
        position_offset: usize,
        /// Offset of the normal within a vertex, bytes.
        normal_offset: usize,
    },
}

impl<'a> From<&'a mut [[f32; 3]]> for StridedMut<'a> {
    fn from(vectors: &'a mut [[f32; 3]]) -> Self {
        Self { bytes: BytesMut::Init(bytemuck::cast_slice_mut(vectors)), offset: 0, stride: WIDTH }
    }
}

impl<'a> SurfaceMut<'a> {
    /// Tightly packed positions and normals.
    pub fn packed(positions: &'a mut [[f32; 3]], normals: &'a mut [[f32; 3]]) -> Self {
        Self::Separate { positions: positions.into(), normals: Some(normals.into()) }
    }

    /// Splits the buffers, which hold `count` vertices, at the chunk boundaries.
    ///
    /// # Errors
    /// [`Error::Invalid`] when a buffer is too small or its parts overlap.
    pub(super) fn into_chunks(self, count: usize) -> Result<Vec<Target<'a>>> {
        match self {
            Self::Separate { positions, normals } => {
                let positions = positions.into_chunks("position buffer", count)?;
                let targets = match normals {
                    None => positions.map(|part| Target { first: part, second: Normals::None }).collect(),
                    Some(normals) => positions
                        .zip(normals.into_chunks("normal buffer", count)?)
                        .map(|(first, second)| Target { first, second: Normals::Own(second) })
                        .collect(),
                };
                Ok(targets)
            }
            Self::Interleaved { bytes, stride, position_offset, normal_offset } => {
                let what = "vertex buffer";
                let (low, high) = (position_offset.min(normal_offset), position_offset.max(normal_offset));
                let apart = high - low >= WIDTH;
                if !(apart && high.checked_add(WIDTH).is_some_and(|end| end <= stride)) {
                    return Err(Error::invalid(
                        what,
                        format!(
                            "expected positions and normals of {WIDTH} bytes each, side by side in a stride of \
                             {stride} bytes, got offsets {position_offset} and {normal_offset}"
                        ),
                    ));
                }
                let whole = StridedMut { bytes, offset: 0, stride };
                let chunks = whole.into_chunks_of(what, count, high + WIDTH)?;
                let at = |part: Part<'a>| Target {
                    first: Part { offset: position_offset, ..part },
                    second: Normals::Beside(normal_offset),
                };
                Ok(chunks.map(at).collect())
            }
        }
    }
}

impl<'a> StridedMut<'a> {
    fn into_chunks(self, what: &'static str, count: usize) -> Result<impl Iterator<Item = Part<'a>>> {
        self.into_chunks_of(what, count, WIDTH)
    }

    /// `width`: bytes needed for the last vertex.
    fn into_chunks_of(
        self,
        what: &'static str,
        count: usize,
        width: usize,
    ) -> Result<impl Iterator<Item = Part<'a>>> {
        let Self { bytes, offset, stride } = self;
        if stride < WIDTH {
            let message = format!("expected a stride of at least {WIDTH} bytes, got {stride}");
            return Err(Error::invalid(what, message));
        }
        let needed = count
            .checked_sub(1)
            .map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(offset)?.checked_add(width));
        if needed.is_none_or(|needed| needed > bytes.len()) {
            let expected = needed.map_or("more than fits in memory".to_owned(), |n| format!("{n} bytes"));
            let message = format!(
                "expected {expected} for {count} vertices at offset {offset} with stride {stride}, got {} bytes",
                bytes.len()
            );
            return Err(Error::invalid(what, message));
        }
        let (_, mut left) = bytes.split(offset);
        Ok((0..count.div_ceil(CHUNK_VERTICES)).map(move |c| {
            let all = std::mem::replace(&mut left, BytesMut::Init(&mut []));
            let (bytes, rest) = all.split(stride.saturating_mul(CHUNK_VERTICES));
            left = rest;
            Part { bytes, offset: 0, stride, count: CHUNK_VERTICES.min(count - c * CHUNK_VERTICES) }
        }))
    }
}

/// The part of a buffer that holds a chunk's vertices.
pub(super) struct Part<'a> {
    bytes: BytesMut<'a>,
    offset: usize,
    stride: usize,
    count: usize,
}

enum Normals<'a> {
    None,
    Own(Part<'a>),
    /// In the positions' buffer, at this offset.
    Beside(usize),
}

/// The destination of one chunk.
pub(super) struct Target<'a> {
    first: Part<'a>,
    second: Normals<'a>,
}

impl Target<'_> {
    /// Writes a block that starts at vertex `first` of the chunk; lanes past the last vertex are dropped.
    #[inline(always)]
    pub(super) fn write(&mut self, first: usize, positions: Lanes, normals: Lanes) {
        let offset = self.first.offset;
        self.first.write(first, offset, positions);
        match &mut self.second {
            Normals::None => {}
            Normals::Own(part) => part.write(first, 0, normals),
            Normals::Beside(offset) => self.first.write(first, *offset, normals),
        }
    }
}

impl Part<'_> {
    #[inline(always)]
    fn write(&mut self, first: usize, offset: usize, [x, y, z]: Lanes) {
        let vectors =
            transposed([x, y, z, Vec4::ZERO]).map(|v| bytemuck::cast::<[f32; 4], [u8; 16]>(v.to_array()));
        let start = first * self.stride + offset;
        if self.stride == WIDTH && self.bytes.write_packed(start, &vectors) {
            return;
        }
        for (lane, vector) in vectors.iter().enumerate().take(self.count.saturating_sub(first)) {
            self.bytes.write(start + lane * self.stride, &vector[..WIDTH]);
        }
    }
}
