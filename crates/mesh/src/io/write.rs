//! Writing OBJ and PLY, and whatever is written to a file: complete, or not at all.
//!
//! Vertices and faces keep their order, and all numbers are read back to the bit (but for glTF, which stores 32 of them).

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::{MeshFormat, ReadError};
use crate::{FaceId, Point2, TriMesh, UvMap};

/// The formats that [`write`] knows, for its message.
const WRITTEN: &str = "glb, gltf, obj, ply";

/// Why a mesh cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The system refuses.
    #[error("{target}: cannot be written: {cause}")]
    Io {
        /// The file, or `output` where there is none.
        target: String,
        /// What the system says.
        cause: io::Error,
    },
    /// The extension names no format that is written.
    #[error("{file}: the extension names no format that can be written; known are {WRITTEN}")]
    UnknownExtension {
        /// The file.
        file: String,
    },
    /// The UV map belongs to another mesh.
    #[error("the UV map has {map} corners, but the mesh has {mesh}")]
    UvMismatch {
        /// How many corners the map has.
        map: usize,
        /// How many corners the mesh has.
        mesh: usize,
    },
    /// A number that no reader would take back.
    #[error("{what} {first} has a coordinate that is not finite ({count} in all)")]
    NotFinite {
        /// `vertex` or `UV point`.
        what: &'static str,
        /// The first, counted from 0.
        first: usize,
        /// How many there are.
        count: usize,
    },
    /// A glTF document cannot be edited because something in it is wrong.
    #[error(transparent)]
    Document(#[from] ReadError),
    /// A set of texture coordinates that a primitive has already.
    #[error(
        "{file}, meshes[{mesh}].primitives[{primitive}]: there is a TEXCOORD_{set} already; the next free set is TEXCOORD_{next}"
    )]
    TexcoordTaken {
        /// The document.
        file: String,
        /// The mesh.
        mesh: usize,
        /// The primitive in the mesh.
        primitive: usize,
        /// The set that was asked for.
        set: u32,
        /// The first that is free in all primitives.
        next: u32,
    },
    /// A set of texture coordinates that would leave a gap.
    #[error(
        "{file}: TEXCOORD_{set} would leave a gap, which glTF does not allow; the next free set is TEXCOORD_{next}"
    )]
    TexcoordGap {
        /// The document.
        file: String,
        /// The set that was asked for.
        set: u32,
        /// The first that is free in all primitives.
        next: u32,
    },
    /// More bytes or vertices than 32 bits can count.
    #[error("{target}: {what} are more than 32 bits can count")]
    TooLarge {
        /// The file, or `output` where there is none.
        target: String,
        /// What there is too much of.
        what: &'static str,
    },
    /// A file that the document names cannot be named from the folder it is written to.
    #[error("{target}: `{uri}` cannot be named from there")]
    Unreachable {
        /// The file to be written.
        target: String,
        /// The name in the document.
        uri: String,
    },
}

/// Writes a mesh file; its extension (`obj`, `ply`, `glb` or `gltf`, in whatever case) names the format.
///
/// glTF stores numbers of 32 bits. A `.gltf` has its buffer beside it, as `.bin`.
///
/// The file is written under a temporary name in the same folder and renamed when it is complete,
/// so that a half-written file never stands under the final name.
///
/// # Errors
/// A [`WriteError`]; what stood under that name before is then still there.
pub fn write(path: &Path, mesh: &TriMesh, uv: Option<&UvMap>) -> Result<(), WriteError> {
    let format = match MeshFormat::from_path(path) {
        Some(MeshFormat::Obj) => obj,
        Some(MeshFormat::Ply) => ply,
        Some(MeshFormat::Glb | MeshFormat::Gltf) => {
            check(mesh, uv)?;
            return super::gltf::write_plain(path, mesh, uv);
        }
        _ => return Err(WriteError::UnknownExtension { file: path.display().to_string() }),
    };
    check(mesh, uv)?;
    replace(path, |out| format(out, mesh, uv))
        .map_err(|cause| WriteError::Io { target: path.display().to_string(), cause })
}

/// Writes an OBJ: `v` in their order, `vt` if there is a map, then the faces.
///
/// # Errors
/// A [`WriteError`].
pub fn write_obj(out: impl Write, mesh: &TriMesh, uv: Option<&UvMap>) -> Result<(), WriteError> {
    to_stream(out, mesh, uv, obj)
}

/// Writes a binary little-endian PLY of doubles.
///
/// UVs are the properties `s` and `t` of the vertices if no vertex has several (vertices that no
/// face uses get zeros), and otherwise the list `texcoord` of the faces, two values per corner.
///
/// # Errors
/// A [`WriteError`].
pub fn write_ply(out: impl Write, mesh: &TriMesh, uv: Option<&UvMap>) -> Result<(), WriteError> {
    to_stream(out, mesh, uv, ply)
}

/// A function that writes one format.
type Format = fn(&mut dyn Write, &TriMesh, Option<&UvMap>) -> io::Result<()>;

fn to_stream(out: impl Write, mesh: &TriMesh, uv: Option<&UvMap>, format: Format) -> Result<(), WriteError> {
    check(mesh, uv)?;
    let mut out = BufWriter::new(out);
    let written = format(&mut out, mesh, uv).and_then(|()| out.flush());
    written.map_err(|cause| WriteError::Io { target: "output".to_owned(), cause })
}

/// Writes a temporary file beside `path`, then renames it: what stood there before stays until the new
/// file is complete. A symbolic link stays one, and what it points to is replaced; a pipe or a device
/// (`/dev/stdout`) is written to as it is.
///
/// # Errors
/// When the system refuses, or `fill` does; no temporary file is left.
pub fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let path = destination(path)?;
    if std::fs::metadata(&path).is_ok_and(|found| !found.is_file()) {
        let mut out = BufWriter::new(std::fs::OpenOptions::new().write(true).open(&path)?);
        return fill(&mut out).and_then(|()| out.flush());
    }
    let mut file = temporary_beside(&path)?;
    let mut out = BufWriter::new(file.as_file_mut());
    fill(&mut out)?;
    out.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
    file.persist(&path).map(drop).map_err(|e| e.error)
}

/// Finds out whether [`replace`] could write there, and changes nothing: for programs that have work to do
/// before they write. A pipe is not opened, because that would wait for its reader.
///
/// # Errors
/// What the system would say to `replace`, but for what can be known only by writing, such as a full disk.
pub fn check_replaceable(path: &Path) -> io::Result<()> {
    let path = destination(path)?;
    match std::fs::metadata(&path) {
        Ok(found) if found.is_dir() => std::fs::OpenOptions::new().write(true).open(&path).map(drop),
        Ok(found) if !found.is_file() => Ok(()),
        _ => temporary_beside(&path).map(drop),
    }
}

/// The file that a path leads to, whether it exists or not; pipes and devices by the name they have.
fn destination(path: &Path) -> io::Result<PathBuf> {
    /// As many links after each other as Linux follows.
    const LINKS: usize = 40;
    match std::fs::metadata(path) {
        Ok(found) if found.is_file() => return path.canonicalize(),
        Ok(_) => return Ok(path.to_owned()),
        Err(_) => {}
    }
    let mut path = path.to_owned();
    for _ in 0..LINKS {
        match std::fs::read_link(&path) {
            // An absolute target replaces the whole.
            Ok(target) => path = folder_of(&path).join(target),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

/// The folder of a file.
pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn temporary_beside(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".abf-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Temporary files are private unless told; the mask of the process still applies.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder_of(path))
}

/// The map must belong to the mesh, and all numbers must be finite.
pub(super) fn check(mesh: &TriMesh, uv: Option<&UvMap>) -> Result<(), WriteError> {
    check_finite("vertex", mesh.positions().iter().map(|p| p.iter().all(|x| x.is_finite())))?;
    let Some(map) = uv else { return Ok(()) };
    let (map_corners, mesh_corners) = (map.corners().len(), 3 * mesh.face_count());
    if map_corners != mesh_corners {
        return Err(WriteError::UvMismatch { map: map_corners, mesh: mesh_corners });
    }
    check_finite("UV point", map.points().iter().map(|p| p.iter().all(|x| x.is_finite())))
}

/// Everything of a kind has to be finite.
pub(super) fn check_finite(what: &'static str, finite: impl Iterator<Item = bool>) -> Result<(), WriteError> {
    let mut bad = finite.enumerate().filter(|&(_, finite)| !finite).map(|(i, _)| i);
    match bad.next() {
        None => Ok(()),
        Some(first) => Err(WriteError::NotFinite { what, first, count: 1 + bad.count() }),
    }
}

/// A function that appends one element, by its number, to a block.
trait Append: Fn(&mut Vec<u8>, usize) + Sync {}
impl<F: Fn(&mut Vec<u8>, usize) + Sync> Append for F {}

/// Writes `count` elements in their order. Blocks of them are made side by side, as many as there are
/// threads, so that memory does not grow with the mesh.
fn in_blocks(out: &mut dyn Write, count: usize, append: impl Append) -> io::Result<()> {
    /// Elements of one block: some hundred kilobytes.
    const BLOCK: usize = 1 << 13;
    let mut blocks = vec![Vec::new(); rayon::current_num_threads().clamp(1, count.div_ceil(BLOCK).max(1))];
    for wave in (0..count).step_by(BLOCK * blocks.len()) {
        let fill = |(i, slot): (usize, &mut Vec<u8>)| {
            // On the stack, because lengths that stand side by side in memory slow down the threads that count them up.
            let mut block = std::mem::take(slot);
            block.clear();
            let start = (wave + i * BLOCK).min(count);
            (start..(start + BLOCK).min(count)).for_each(|element| append(&mut block, element));
            *slot = block;
        };
        match &mut blocks[..] {
            [only] => fill((0, only)),
            several => several.par_iter_mut().enumerate().for_each(fill),
        }
        blocks.iter().try_for_each(|block| out.write_all(block))?;
    }
    Ok(())
}

fn obj(out: &mut dyn Write, mesh: &TriMesh, uv: Option<&UvMap>) -> io::Result<()> {
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

fn ply(out: &mut dyn Write, mesh: &TriMesh, uv: Option<&UvMap>) -> io::Result<()> {
    let per_vertex = uv.and_then(|map| one_per_vertex(mesh, map));
    let per_corner = uv.filter(|_| per_vertex.is_none());
    write!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.vertex_count())?;
    out.write_all(b"property double x\nproperty double y\nproperty double z\n")?;
    if per_vertex.is_some() {
        out.write_all(b"property double s\nproperty double t\n")?;
    }
    write!(out, "element face {}\nproperty list uchar uint vertex_indices\n", mesh.face_count())?;
    if per_corner.is_some() {
        out.write_all(b"property list uchar double texcoord\n")?;
    }
    out.write_all(b"end_header\n")?;
    in_blocks(out, mesh.vertex_count(), |block, v| {
        doubles(block, &mesh.positions()[v].coords);
        if let Some(uv) = &per_vertex {
            doubles(block, &uv[v].coords);
        }
    })?;
    in_blocks(out, mesh.face_count(), |block, f| {
        block.push(3);
        // Ids are made of 32 bits.
        mesh.faces()[f].iter().for_each(|v| block.extend_from_slice(&(v.index() as u32).to_le_bytes()));
        if let Some(map) = per_corner {
            block.push(6);
            map.triangle(FaceId::new(f)).iter().for_each(|p| doubles(block, &p.coords));
        }
    })
}

fn doubles<'a>(block: &mut Vec<u8>, numbers: impl IntoIterator<Item = &'a f64>) {
    numbers.into_iter().for_each(|x| block.extend_from_slice(&x.to_le_bytes()));
}

/// The UV of every vertex, if none has several. "The same" is to the bit, so that −0 survives.
fn one_per_vertex(mesh: &TriMesh, map: &UvMap) -> Option<Vec<Point2<f64>>> {
    let bits = |p: Point2<f64>| [p.x.to_bits(), p.y.to_bits()];
    let mut found: Vec<Option<Point2<f64>>> = vec![None; mesh.vertex_count()];
    for (v, id) in mesh.faces().iter().flatten().zip(map.corners()) {
        let uv = map.points()[id.index()];
        let known = *found[v.index()].get_or_insert(uv);
        if bits(known) != bits(uv) {
            return None;
        }
    }
    Some(found.into_iter().map(|uv| uv.unwrap_or_else(Point2::origin)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Point3, UvId};

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
    fn blocks_are_written_in_their_order_whatever_the_number_of_threads() {
        let count = 100_000;
        let texts = [1, 2, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let mut out = Vec::new();
            pool.install(|| in_blocks(&mut out, count, index)).expect("written");
            out
        });
        let expected: String = (1..=count).map(|i| i.to_string()).collect();
        texts.iter().for_each(|text| assert!(text == expected.as_bytes()));
    }

    #[test]
    fn a_foreign_map_is_refused() {
        let map = UvMap::new(vec![Point2::origin()], vec![UvId::new(0); 6]);
        let e = write_ply(io::sink(), &triangle(), Some(&map)).unwrap_err();
        assert!(matches!(e, WriteError::UvMismatch { map: 6, mesh: 3 }), "{e}");
    }

    #[test]
    fn a_map_that_is_not_finite_is_refused() {
        let map = UvMap::new(vec![Point2::origin(), Point2::new(0.0, f64::NAN)], [0, 1, 1].map(UvId::new).to_vec());
        let e = write_obj(io::sink(), &triangle(), Some(&map)).unwrap_err();
        assert!(matches!(e, WriteError::NotFinite { what: "UV point", first: 1, count: 1 }), "{e}");
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_other() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.obj");
        std::fs::write(&path, "old").expect("written");
        let fail = |out: &mut dyn Write| out.write_all(b"half").and(Err(io::Error::other("no room")));
        assert_eq!(replace(&path, fail).unwrap_err().to_string(), "no room");
        assert_eq!(std::fs::read_to_string(&path).expect("read"), "old");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }
    #[cfg(unix)]
    #[test]
    fn links_are_followed_also_to_a_file_that_is_not_there_yet() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("inner")).expect("a folder");
        std::os::unix::fs::symlink("second", at("first")).expect("a link");
        std::os::unix::fs::symlink("inner/file", at("second")).expect("a link");
        for text in ["new", "newer"] {
            replace(&at("first"), |out| out.write_all(text.as_bytes())).expect("written");
            assert_eq!(std::fs::read_to_string(at("inner/file")).expect("read"), text);
        }
        assert!(at("first").is_symlink() && at("second").is_symlink());
        std::os::unix::fs::symlink("round", at("round")).expect("a link");
        assert!(replace(&at("round"), |_| Ok(())).is_err());
    }

    #[test]
    fn what_cannot_be_replaced_is_known_before_and_nothing_is_changed() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.obj");
        std::fs::write(&path, "old").expect("written");
        check_replaceable(&path).expect("it can");
        check_replaceable(&folder.path().join("b.obj")).expect("it can");
        assert_eq!(check_replaceable(&folder.path().join("no/b.obj")).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert!(check_replaceable(folder.path()).is_err());
        assert_eq!(std::fs::read_to_string(&path).expect("read"), "old");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error() {
        let full = Path::new("/dev/full");
        check_replaceable(full).expect("a device");
        let e = replace(full, |out| out.write_all(&[0; 100_000])).unwrap_err();
        assert_eq!(e.kind(), io::ErrorKind::StorageFull);
        assert_eq!(
            replace(full, |out| out.write_all(b"less than a buffer")).unwrap_err().kind(),
            io::ErrorKind::StorageFull
        );
    }
}
