//! Writing OBJ: shortest decimals that read back to the same bits.

use std::io::{self, Write};

use super::super::WriteError;
use super::super::blocks::{in_blocks, to_stream};
use crate::{FaceId, TriMesh, UvMap};

/// Writes an OBJ: `v` in their order, `vt` if there is a map, then the faces.
///
/// # Errors
/// A [`WriteError`].
pub fn write_obj(out: impl Write, mesh: &TriMesh, uv: Option<&UvMap>) -> Result<(), WriteError> {
    to_stream(out, mesh, uv, write)
}

/// Writes a checked mesh.
pub(crate) fn write(out: &mut dyn Write, mesh: &TriMesh, uv: Option<&UvMap>) -> io::Result<()> {
    in_blocks(out, mesh.vertex_count(), |block, v| {
        let p = mesh.positions()[v];
        line(block, b"v", [p.x, p.y, p.z], decimal);
    })?;
    let Some(map) = uv else {
        return in_blocks(out, mesh.face_count(), |block, f| {
            line(block, b"f", mesh.faces()[f], |block, v| index(block, v.index()));
        });
    };
    in_blocks(out, map.points().len(), |block, t| {
        let p = map.points()[t];
        line(block, b"vt", [p.x, p.y], decimal);
    })?;
    in_blocks(out, mesh.face_count(), |block, f| {
        let corners = FaceId::new(f).corners().map(|c| map.corners()[c.index()]);
        let [a, b, c] = mesh.faces()[f];
        line(block, b"f", [(a, corners[0]), (b, corners[1]), (c, corners[2])], |block, (v, t)| {
            index(block, v.index());
            block.push(b'/');
            index(block, t.index());
        });
    })
}

/// A keyword and its words.
fn line<T, const N: usize>(block: &mut Vec<u8>, keyword: &[u8], words: [T; N], append: impl Fn(&mut Vec<u8>, T)) {
    block.extend_from_slice(keyword);
    for word in words {
        block.push(b' ');
        append(block, word);
    }
    block.push(b'\n');
}

/// A shortest text that reads back to the same bits, laid out as `{:?}` does, with an exponent where that
/// saves zeros; `{}` would write 300 digits for 1e300. Of two such texts that are equally close to the
/// number `{:?}` takes the upper one, this the even one.
pub(super) fn decimal(block: &mut Vec<u8>, x: f64) {
    /// Between these (and for zero) `{:?}` and the fast formatter both write no exponent.
    const PLAIN: std::ops::Range<f64> = 1e-4..1e16;
    if x == 0.0 || PLAIN.contains(&x.abs()) {
        block.extend_from_slice(zmij::Buffer::new().format_finite(x).as_bytes());
    } else {
        write!(block, "{x:?}").expect("memory is writable");
    }
}

/// An index as OBJ counts: from 1.
pub(super) fn index(block: &mut Vec<u8>, from_zero: usize) {
    block.extend_from_slice(itoa::Buffer::new().format(from_zero + 1).as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Point2, Point3, UvId};

    fn triangle() -> TriMesh {
        let p = [[0.0, -0.0, 1e300], [1e-300, 1.0, 0.1], [123_456_789.0, 1.0 / 3.0, -2.5]];
        TriMesh::new(p.map(Point3::from).to_vec(), &[[0, 1, 2]]).expect("indices in range")
    }

    #[test]
    fn numbers_are_short_and_exact() {
        let mut out = Vec::new();
        write_obj(&mut out, &triangle(), None).expect("written");
        let text = String::from_utf8(out).expect("text");
        assert_eq!(text, "v 0.0 -0.0 1e300\nv 1e-300 1.0 0.1\nv 123456789.0 0.3333333333333333 -2.5\nf 1 2 3\n");
    }

    #[test]
    fn numbers_are_as_short_as_those_of_the_standard_library_and_read_back() {
        let check = |x: f64| {
            let mut block = Vec::new();
            decimal(&mut block, x);
            let (ours, theirs) = (String::from_utf8(block).expect("text"), format!("{x:?}"));
            let is_tie = || ours.len() == theirs.len() && ours.parse::<f64>().map(f64::to_bits) == Ok(x.to_bits());
            assert!(ours == theirs || is_tie(), "{ours} instead of {theirs}");
        };
        let edges =
            [0.0, 1e-5, 1e-4, 1.0, 1e15, 1e16, 1e17, f64::MAX, f64::MIN_POSITIVE, 5e-324, 157_501_270_407_469.62];
        let beside = edges.iter().flat_map(|x: &f64| [*x, x.next_up(), x.next_down()]);
        beside.flat_map(|x| [x, -x]).filter(|x| x.is_finite()).for_each(check);
        let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
        for _ in 0..200_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let mixed = bits ^ (bits >> 29);
            let (any, exponent) = (f64::from_bits(mixed), (mixed >> 32) as i32 % 17);
            // Any number; numbers that need no exponent, with many digits and with few.
            let plain = (mixed >> 11) as f64 * 2.0_f64.powi(-53) * 10.0_f64.powi(exponent);
            let short = (mixed >> 45) as f64 * 10.0_f64.powi(exponent / 2);
            [any, plain, short].into_iter().filter(|x| x.is_finite()).for_each(check);
        }
    }

    #[test]
    fn a_map_that_is_not_finite_is_refused() {
        let map = UvMap::new(vec![Point2::origin(), Point2::new(0.0, f64::NAN)], [0, 1, 1].map(UvId::new).to_vec());
        let e = write_obj(io::sink(), &triangle(), Some(&map)).unwrap_err();
        assert!(matches!(e, WriteError::NotFinite { what: "UV point", first: 1, count: 1 }), "{e}");
    }
}
