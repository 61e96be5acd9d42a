//! Pixels with one to four channels.

use super::TextureError;
use crate::{ParameterError, math};
use std::io::{self, BufRead, Seek, Write};

/// An image with 8 bits per channel: 1 channel (grey), 3 (red, green, blue) or 4 (red, green, blue, alpha).
/// Rows from the top, pixels from the left; the texture coordinate (0, 0) is the upper left corner, as in
/// glTF.
///
/// The map decides what the numbers mean: colours are sRGB, everything else is linear.
///
/// Memory: one byte per channel and pixel.
///
/// ```
/// use treesynth::texture::Image;
///
/// let image = Image::new(2, 1, 3, vec![255, 0, 0, 0, 0, 255])?;
/// assert_eq!(image.pixel(1, 0), [0, 0, 255]);
/// assert_eq!(Image::read_png(std::io::Cursor::new(image.png()))?, image);
/// # Ok::<(), treesynth::texture::TextureError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    channels: u8,
    bytes: Vec<u8>,
}

impl Image {
    /// The longest side that an image may have, pixels.
    pub const LONGEST_SIDE: u32 = 8192;

    /// An image of these bytes, row by row from the top, the channels of a pixel side by side.
    ///
    /// # Errors
    /// Sides not within 1 to 8192, channels other than 1, 3 and 4, or another number of bytes than
    /// `width * height * channels`.
    pub fn new(width: u32, height: u32, channels: u8, bytes: Vec<u8>) -> Result<Self, TextureError> {
        for (name, side) in [("Image.width", width), ("Image.height", height)] {
            let holds = (1..=Self::LONGEST_SIDE).contains(&side);
            ParameterError::unless(holds, name, side, "1 to 8192 pixels")?;
        }
        ParameterError::unless([1, 3, 4].contains(&channels), "Image.channels", channels, "1, 3 or 4")?;
        let expected = width as usize * height as usize * usize::from(channels);
        let range = format!("{expected} bytes: width * height * channels");
        ParameterError::unless(bytes.len() == expected, "Image.bytes", bytes.len(), &range)?;
        Ok(Self { width, height, channels, bytes })
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// 1 (grey), 3 (red, green, blue) or 4 (and alpha).
    pub fn channels(&self) -> u8 {
        self.channels
    }

    /// `true` if there is an alpha channel.
    pub fn has_alpha(&self) -> bool {
        self.channels == 4
    }

    /// All bytes, row by row from the top.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The channels of the pixel in column `x` and row `y`; both wrap around, since textures repeat.
    pub fn pixel(&self, x: u32, y: u32) -> &[u8] {
        let channels = usize::from(self.channels);
        let index = (y % self.height) as usize * self.width as usize + (x % self.width) as usize;
        &self.bytes[index * channels..(index + 1) * channels]
    }

    /// The mean of all pixels as linear red, green and blue, each 0 to 1, if the numbers are sRGB; alpha does not count. O(pixels).
    pub fn mean_color(&self) -> [f32; 3] {
        let tones: Vec<f64> = (0..256u16).map(|tone| math::linear(f32::from(tone) / 255.0).into()).collect();
        let mut sums = [0.0; 3];
        for pixel in self.bytes.chunks_exact(usize::from(self.channels)) {
            for (i, sum) in sums.iter_mut().enumerate() {
                *sum += tones[usize::from(pixel[if self.channels == 1 { 0 } else { i }])];
            }
        }
        sums.map(|sum| (sum / (f64::from(self.width) * f64::from(self.height))) as f32)
    }

    /// The image as the bytes of a PNG file. The same bytes on every platform, for one version of the `png` crate.
    pub fn png(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        // Writing to memory cannot fail, and `new` has checked the sizes.
        let _ = self.write_png(&mut bytes);
        bytes
    }

    /// Writes the image as a PNG file.
    ///
    /// # Errors
    /// Whatever the writer returns.
    pub fn write_png(&self, writer: impl Write) -> Result<(), TextureError> {
        let mut encoder = png::Encoder::new(writer, self.width, self.height);
        encoder.set_color(match self.channels {
            1 => png::ColorType::Grayscale,
            3 => png::ColorType::Rgb,
            _ => png::ColorType::Rgba,
        });
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(written)?;
        writer.write_image_data(&self.bytes).map_err(written)?;
        writer.finish().map_err(written)
    }

    /// The image as the bytes of a JPEG file of a quality from 1 to 100; colours have as many pixels as brightness, for normals. At 85, an
    /// oak's bark is off by 2.4 of 255 (root mean square), its normals, which are rough, by 8.6. The same bytes on every platform, for
    /// one version of the `jpeg-encoder` crate.
    ///
    /// # Errors
    /// Another quality; an image with alpha, for which a JPEG has no room.
    #[cfg(feature = "jpeg")]
    pub fn jpeg(&self, quality: u8) -> Result<Vec<u8>, TextureError> {
        use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
        ParameterError::unless((1..=100).contains(&quality), "Image.quality", quality, "1 to 100")?;
        ParameterError::unless(!self.has_alpha(), "Image.channels", self.channels, "1 or 3 for a JPEG")?;
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, quality);
        encoder.set_sampling_factor(SamplingFactor::R_4_4_4);
        encoder.set_optimized_huffman_tables(true);
        let colors = if self.channels == 1 { ColorType::Luma } else { ColorType::Rgb };
        // No side is longer than 8192.
        let [width, height] = [self.width, self.height].map(|side| side as u16);
        encoder
            .encode(&self.bytes, width, height, colors)
            .map_err(|error| TextureError::Io(io::Error::other(error.to_string())))?;
        Ok(bytes)
    }

    /// Reads a PNG file of any kind; palettes, 16 bits per channel and grey with alpha are converted.
    ///
    /// # Errors
    /// Not a PNG, broken, or larger than 8192 pixels per side; errors of the reader.
    pub fn read_png(reader: impl BufRead + Seek) -> Result<Self, TextureError> {
        let mut decoder = png::Decoder::new(reader);
        decoder.set_transformations(png::Transformations::normalize_to_color8());
        let mut reader = decoder.read_info().map_err(read)?;
        let (width, height) = reader.info().size();
        if width.max(height) > Self::LONGEST_SIDE {
            return Err(TextureError::Png(format!("it has {width} x {height} pixels")));
        }
        let size = reader.output_buffer_size().ok_or_else(|| TextureError::Png("it is too large".into()))?;
        let mut bytes = vec![0; size];
        let info = reader.next_frame(&mut bytes).map_err(read)?;
        bytes.truncate(info.buffer_size());
        let channels = match info.color_type {
            png::ColorType::Grayscale => 1,
            png::ColorType::GrayscaleAlpha => {
                bytes = bytes
                    .chunks_exact(2)
                    .flat_map(|pixel| [pixel[0], pixel[0], pixel[0], pixel[1]])
                    .collect();
                4
            }
            png::ColorType::Rgba => 4,
            _ => 3,
        };
        Self::new(width, height, channels, bytes)
    }
}

fn written(error: png::EncodingError) -> TextureError {
    match error {
        png::EncodingError::IoError(error) => TextureError::Io(error),
        other => TextureError::Io(io::Error::other(other.to_string())),
    }
}

fn read(error: png::DecodingError) -> TextureError {
    match error {
        png::DecodingError::IoError(error) => TextureError::Io(error),
        other => TextureError::Png(other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// Read back by another library.
    #[cfg(feature = "jpeg")]
    #[test]
    fn a_jpeg_is_nearly_the_image() {
        for channels in [1u8, 3] {
            let smooth = |i: u32| (128.0 + 100.0 * math::sin((i / u32::from(channels)) as f32 * 0.01)) as u8;
            let bytes: Vec<u8> = (0..70 * 45 * u32::from(channels)).map(smooth).collect();
            let image = Image::new(70, 45, channels, bytes).unwrap();
            let file = image.jpeg(90).unwrap();
            assert_eq!(file, image.jpeg(90).unwrap());
            let read = jpeg_decoder::Decoder::new(&file[..]).decode().unwrap();
            assert_eq!(read.len(), image.bytes.len());
            let off = read.iter().zip(&image.bytes).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            assert!(off <= 4, "{off}");
        }
        let named = |result: Result<Vec<u8>, TextureError>| result.unwrap_err().to_string();
        let clear = Image::new(1, 1, 4, vec![0; 4]).unwrap();
        assert_eq!(named(clear.jpeg(90)), "Image.channels is 4, but must be 1 or 3 for a JPEG");
        let image = Image::new(1, 1, 3, vec![0; 3]).unwrap();
        assert_eq!(named(image.jpeg(0)), "Image.quality is 0, but must be 1 to 100");
        assert_eq!(named(image.jpeg(101)), "Image.quality is 101, but must be 1 to 100");
    }

    #[test]
    fn what_is_written_is_read() {
        for channels in [1, 3, 4] {
            let bytes = (0..5 * 3 * u32::from(channels)).map(|i| (i * 37 % 256) as u8).collect();
            let image = Image::new(5, 3, channels, bytes).expect("sizes are right");
            assert_eq!(Image::read_png(Cursor::new(image.png())).expect("a PNG"), image);
        }
    }

    #[test]
    fn means_are_linear() {
        let image = Image::new(2, 1, 4, vec![255, 0, 118, 0, 0, 0, 118, 255]).expect("sizes are right");
        let [red, green, blue] = image.mean_color();
        assert!((red - 0.5).abs() < 1e-6 && green == 0.0 && (blue - 0.18).abs() < 2e-3);
    }

    #[test]
    fn wrong_sizes_are_named() {
        for (width, height, channels, bytes, name) in [
            (0, 1, 1, 0, "Image.width"),
            (1, 8193, 1, 8193, "Image.height"),
            (1, 1, 2, 2, "Image.channels"),
            (2, 2, 3, 11, "Image.bytes"),
        ] {
            let error = Image::new(width, height, channels, vec![0; bytes]).expect_err("wrong").to_string();
            assert!(error.starts_with(name), "{error}");
        }
    }

    #[test]
    fn what_is_no_png_is_refused() {
        let whole = Image::new(4, 4, 3, vec![7; 48]).expect("sizes are right").png();
        for bytes in [&b""[..], b"GIF89a", &whole[..whole.len() / 2]] {
            let error = Image::read_png(Cursor::new(bytes)).expect_err("no PNG").to_string();
            assert!(error.contains("image"), "{error}");
        }
    }
}
