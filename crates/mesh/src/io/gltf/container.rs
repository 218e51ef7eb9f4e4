//! What a document comes in: the chunks of a `.glb`, data URIs, names of files as URIs.

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use super::super::error::{FilePlace, Location, ReadError};

/// The first bytes of a `.glb`.
pub(super) const MAGIC: &[u8] = b"glTF";
/// Magic, version, length.
const HEADER: usize = 12;
/// Length and type of a chunk.
const CHUNK_HEADER: usize = 8;
const JSON: [u8; 4] = *b"JSON";
const BIN: [u8; 4] = *b"BIN\0";

/// The parts of a `.glb`.
pub(super) struct Chunks<'a> {
    pub(super) json: &'a [u8],
    pub(super) bin: Option<&'a [u8]>,
    /// Chunks of other types, which readers have to skip.
    pub(super) others: Vec<([u8; 4], &'a [u8])>,
}

/// Takes a `.glb` apart.
pub(super) fn split<'a>(file: &str, bytes: &'a [u8]) -> Result<Chunks<'a>, ReadError> {
    let at = |byte| Location { file: file.to_owned(), place: FilePlace::Byte(byte) };
    let truncated = |expected| ReadError::Truncated { file: file.to_owned(), expected, present: bytes.len() };
    if !bytes.starts_with(MAGIC) {
        let reason = "a .glb begins with `glTF`".to_owned();
        return Err(ReadError::BadHeader { at: at(0), reason });
    }
    let version = number(bytes, 4).ok_or_else(|| truncated(HEADER))?;
    if version != 2 {
        let feature = format!("version {version} of glTF");
        return Err(ReadError::Unsupported { at: at(4), feature });
    }
    let length = number(bytes, 8).ok_or_else(|| truncated(HEADER))?;
    let whole = bytes.get(..length).ok_or_else(|| truncated(length))?;
    let mut chunks = Chunks { json: &[], bin: None, others: Vec::new() };
    let mut start = HEADER;
    while start < whole.len() {
        let (size, kind) = number(whole, start)
            .zip(whole.get(start + 4..start + CHUNK_HEADER))
            .ok_or_else(|| truncated(start + CHUNK_HEADER))?;
        let begin = start + CHUNK_HEADER;
        let end = begin.checked_add(size).ok_or_else(|| truncated(usize::MAX))?;
        let content = whole.get(begin..end).ok_or_else(|| truncated(end))?;
        let first = start == HEADER;
        if first != (kind == JSON) {
            let reason = "the first chunk, and no other, has to be JSON".to_owned();
            return Err(ReadError::BadHeader { at: at(start), reason });
        }
        match kind {
            _ if first => chunks.json = content,
            kind if kind == BIN && chunks.bin.is_none() => chunks.bin = Some(content),
            kind => chunks.others.push(([kind[0], kind[1], kind[2], kind[3]], content)),
        }
        start = end;
    }
    if chunks.json.is_empty() {
        return Err(truncated(HEADER + CHUNK_HEADER));
    }
    Ok(chunks)
}

/// The little-endian number of 32 bits at `i`.
fn number(bytes: &[u8], i: usize) -> Option<usize> {
    let four = bytes.get(i..)?.first_chunk()?;
    usize::try_from(u32::from_le_bytes(*four)).ok()
}

/// Puts a `.glb` together; `None` where it gets longer than 32 bits can say.
pub(super) fn join(mut json: Vec<u8>, mut bin: Vec<u8>, others: &[([u8; 4], Vec<u8>)]) -> Option<Vec<u8>> {
    json.resize(json.len().next_multiple_of(4), b' ');
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut chunks: Vec<([u8; 4], &[u8])> = vec![(JSON, &json)];
    if !bin.is_empty() {
        chunks.push((BIN, &bin));
    }
    chunks.extend(others.iter().map(|(kind, content)| (*kind, content.as_slice())));
    let length = HEADER + chunks.iter().map(|(_, content)| CHUNK_HEADER + content.len()).sum::<usize>();
    let mut out = Vec::with_capacity(length);
    out.extend_from_slice(MAGIC);
    out.extend_from_slice(&2_u32.to_le_bytes());
    out.extend_from_slice(&u32::try_from(length).ok()?.to_le_bytes());
    for (kind, content) in chunks {
        out.extend_from_slice(&u32::try_from(content.len()).ok()?.to_le_bytes());
        out.extend_from_slice(&kind);
        out.extend_from_slice(content);
    }
    Some(out)
}

/// Whether a URI is data itself.
pub(super) fn is_data(uri: &str) -> bool {
    uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

/// The bytes of a data URI; `None` where it makes no sense.
pub(super) fn data(uri: &str) -> Option<Vec<u8>> {
    const LENIENT: GeneralPurposeConfig =
        GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    let (kind, content) = uri.get(5..)?.split_once(',')?;
    if kind.to_ascii_lowercase().ends_with(";base64") {
        return GeneralPurpose::new(&alphabet::STANDARD, LENIENT).decode(content.trim_ascii()).ok();
    }
    Some(percent_decoded(content))
}

/// Bytes as a data URI.
pub(super) fn data_uri(bytes: &[u8]) -> String {
    let mut out = "data:application/octet-stream;base64,".to_owned();
    base64::engine::general_purpose::STANDARD.encode_string(bytes, &mut out);
    out
}

/// The name of a file that a URI means, relative to the document; `None` for anything that is no relative name.
pub(super) fn file_name(uri: &str) -> Option<String> {
    let scheme = uri.split(['/', '?', '#']).next().is_some_and(|first| first.contains(':'));
    if uri.is_empty() || scheme || uri.starts_with(['/', '\\']) {
        return None;
    }
    String::from_utf8(percent_decoded(uri)).ok().filter(|name| !name.contains('\0'))
}

/// `%20` as a blank, and so on; a `%` that is followed by no two digits stays.
fn percent_decoded(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let digit = |i: usize| bytes.get(i).and_then(|&b| char::from(b).to_digit(16));
    let mut i = 0;
    while i < bytes.len() {
        match (bytes[i], digit(i + 1), digit(i + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push((16 * high + low) as u8);
                i += 3;
            }
            (byte, ..) => {
                out.push(byte);
                i += 1;
            }
        }
    }
    out
}

/// A name of a file as a URI.
pub(super) fn uri_of(name: &str) -> String {
    let mut out = String::new();
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/()+,!".contains(&byte) {
            out.push(char::from(byte));
        } else {
            out += &format!("%{byte:02X}");
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_uris_are_read_with_and_without_padding() {
        for uri in ["data:application/octet-stream;base64,AQID", "DATA:;Base64,AQID"] {
            assert_eq!(data(uri), Some(vec![1, 2, 3]), "{uri}");
        }
        for uri in ["data:a/b;base64,AQI=", "data:a/b;base64,AQI", "data:,%01%02"] {
            assert_eq!(data(uri), Some(vec![1, 2]), "{uri}");
        }
        assert_eq!(data(&data_uri(&[0, 255, 7, 9])), Some(vec![0, 255, 7, 9]));
        assert_eq!(data("data:a/b;base64,*"), None);
        assert_eq!(data("data:nothing"), None);
        assert!(!is_data("däta:"));
    }

    #[test]
    fn names_of_files_are_relative_and_come_back() {
        assert_eq!(file_name("a%20b/%C3%A4.bin").as_deref(), Some("a b/ä.bin"));
        assert_eq!(file_name("100%.bin").as_deref(), Some("100%.bin"));
        for refused in ["", "/etc/passwd", "http://a/b", "C:\\a", "file:a", "%FF", "a%00"] {
            assert_eq!(file_name(refused), None, "{refused}");
        }
        for name in ["a b%/ä#?.bin", "plain-1.bin"] {
            assert_eq!(file_name(&uri_of(name)).as_deref(), Some(name));
        }
    }
}
