//! Renders SVG to PNG with an embedded typeface, so that pictures do not depend on installed fonts.
//! Sole user of `resvg`.

use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb::Database};

/// The family name of the embedded typeface.
pub const FAMILY: &str = "Inter";

const REGULAR: &[u8] = include_bytes!("font/Inter-Regular.otf");
const SEMI_BOLD: &[u8] = include_bytes!("font/Inter-SemiBold.otf");

/// Renders a PNG file with `scale` pixels per unit of length of the SVG. An error for pictures of
/// this crate is a bug.
pub fn png(svg: &str, scale: u32) -> Result<Vec<u8>, String> {
    let mut fonts = Database::new();
    fonts.load_font_data(REGULAR.to_vec());
    fonts.load_font_data(SEMI_BOLD.to_vec());
    let options =
        Options { font_family: FAMILY.to_owned(), fontdb: Arc::new(fonts), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(|e| e.to_string())?;
    let factor = scale as f32;
    let size = tree.size().to_int_size();
    let pixels = |length: u32| length.checked_mul(scale).ok_or("the picture is too large");
    let mut pixmap = Pixmap::new(pixels(size.width())?, pixels(size.height())?)
        .ok_or("the picture is empty or too large")?;
    resvg::render(&tree, Transform::from_scale(factor, factor), &mut pixmap.as_mut());
    pixmap.encode_png().map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dark_pixels(text: &str, weight: &str) -> usize {
        let svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='200' height='30'>\
             <rect width='200' height='30' fill='white'/>\
             <text x='5' y='22' font-size='20' font-weight='{weight}' \
             font-family='Inter, sans-serif'>{text}</text></svg>"
        );
        let pixmap = Pixmap::decode_png(&png(&svg, 1).unwrap()).unwrap();
        assert_eq!((pixmap.width(), pixmap.height()), (200, 30));
        pixmap.pixels().iter().filter(|p| p.red() < 128).count()
    }

    #[test]
    fn text_is_drawn_with_the_embedded_faces() {
        let regular = dark_pixels("valve", "normal");
        assert!(regular > 50, "{regular}");
        assert!(dark_pixels("valve", "bold") > regular * 5 / 4);
        // The symbols of units and numbers must be in the font subset.
        for sign in "µ·°Ω²³⁻⁶−×Äß".chars() {
            assert!(dark_pixels(&sign.to_string(), "normal") > 2, "{sign}");
        }
    }
}
