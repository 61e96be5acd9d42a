//! Images that surfaces wear.

use bevy_asset::RenderAssetUsages;
use bevy_image::{Image, ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use treesynth::texture;
use wgpu_types::{Extent3d, TextureDimension, TextureFormat};

/// Use of an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Use {
    /// Colours, sRGB; with the alpha below which pixels are not drawn, if they are not: smaller sizes keep as much of it.
    Color(Option<f32>),
    /// Normals, roughness: linear.
    Data,
}

/// An image with all its smaller sizes, which Bevy does not make, so that leaves far away do not vanish or flicker. It repeats.
pub fn image(image: &texture::Image, what: Use) -> Image {
    let (format, sizes) = match what {
        Use::Color(cutoff) => {
            (TextureFormat::Rgba8UnormSrgb, texture::mips(image, cutoff).iter().map(rgba).collect())
        }
        Use::Data => (TextureFormat::Rgba8Unorm, halvings(image)),
    };
    let size = Extent3d { width: image.width(), height: image.height(), depth_or_array_layers: 1 };
    let mut made = Image::new_uninit(size, TextureDimension::D2, format, RenderAssetUsages::default());
    made.texture_descriptor.mip_level_count = sizes.len() as u32;
    made.data = Some(sizes.concat());
    made.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        anisotropy_clamp: 8,
        ..ImageSamplerDescriptor::default()
    });
    made
}

/// Four channels, whatever there were.
fn rgba(image: &texture::Image) -> Vec<u8> {
    let channels = usize::from(image.channels());
    let pixel = |pixel: &[u8]| match *pixel {
        [gray] => [gray, gray, gray, 255],
        [gray, alpha] => [gray, gray, gray, alpha],
        [red, green, blue] => [red, green, blue, 255],
        [red, green, blue, alpha] => [red, green, blue, alpha],
        _ => [255; 4],
    };
    image.bytes().chunks_exact(channels).flat_map(pixel).collect()
}

/// The image in ever smaller sizes, itself first: each pixel the mean of two by two. For what is no colour.
fn halvings(image: &texture::Image) -> Vec<Vec<u8>> {
    let (mut width, mut height) = (image.width() as usize, image.height() as usize);
    let mut sizes = vec![rgba(image)];
    while width > 1 || height > 1 {
        let (wide, high) = ((width / 2).max(1), (height / 2).max(1));
        let large = &sizes[sizes.len() - 1];
        let mut small = Vec::with_capacity(wide * high * 4);
        for (y, x) in (0..high).flat_map(|y| (0..wide).map(move |x| (y, x))) {
            for channel in 0..4 {
                let rows = [2 * y, 2 * y + 1].map(|row| row.min(height - 1));
                let columns = [2 * x, 2 * x + 1].map(|column| column.min(width - 1));
                let texels =
                    rows.iter().flat_map(|row| columns.map(|column| (row * width + column) * 4 + channel));
                let sum: usize = texels.map(|at| usize::from(large[at])).sum();
                small.push(((sum + 2) / 4) as u8);
            }
        }
        (width, height) = (wide, high);
        sizes.push(small);
    }
    sizes
}
