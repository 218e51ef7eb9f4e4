//! Pictures inside the page.

use tiny_skia::Pixmap;

/// The bits of a channel that are kept: half a step of the rest is not seen, but costs space.
const KEPT_BITS: u32 = 6;

/// A picture as a `data:` address; `None` if the encoder gives up.
pub(crate) fn data_uri(mut canvas: Pixmap) -> Option<String> {
    coarsen(&mut canvas);
    let png = canvas.encode_png().ok()?;
    Some(format!("data:image/png;base64,{}", base64(&png)))
}

/// Rounds every opaque pixel to fewer bits, which lets neighbours be equal and the file be small.
fn coarsen(canvas: &mut Pixmap) {
    let step = 1 << (u8::BITS - KEPT_BITS);
    let round = |x: u8| (u32::from(x) + step / 2).min(u32::from(u8::MAX)) / step * step;
    for pixel in canvas.pixels_mut() {
        let alpha = pixel.alpha();
        let [r, g, b] = [pixel.red(), pixel.green(), pixel.blue()].map(|x| (round(x) as u8).min(alpha));
        if let Some(rounded) = tiny_skia::PremultipliedColorU8::from_rgba(r, g, b, alpha) {
            *pixel = rounded;
        }
    }
}

/// The base 64 encoding of RFC 4648, §4, with padding.
fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |k: usize| u32::from(three.get(k).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for k in 0..4 {
            let digit = ALPHABET[(bits >> (18 - 6 * k) & 63) as usize];
            out.push(if k <= three.len() { char::from(digit) } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_agrees_with_the_vectors_of_its_rfc() {
        let vectors =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")];
        for (plain, encoded) in vectors {
            assert_eq!(base64(plain.as_bytes()), encoded);
        }
        assert_eq!(base64(&[255, 254, 253]), "//79");
    }

    #[test]
    fn a_coarser_picture_keeps_black_white_and_transparency() {
        let mut canvas = Pixmap::new(3, 1).expect("not empty");
        let colours = [(0, 255), (255, 255), (0, 0)];
        for (pixel, (grey, alpha)) in canvas.pixels_mut().iter_mut().zip(colours) {
            *pixel = tiny_skia::PremultipliedColorU8::from_rgba(grey, grey, grey, alpha).expect("premultiplied");
        }
        coarsen(&mut canvas);
        let kept: Vec<_> = canvas.pixels().iter().map(|p| (p.red(), p.alpha())).collect();
        assert_eq!(kept, [(0, 255), (252, 255), (0, 0)]);
    }
}
