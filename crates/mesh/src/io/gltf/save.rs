//! Writing a document: as one `.glb`, or as a `.gltf` with what has no file of its own beside it.

use std::ffi::OsStr;
use std::io;
use std::path::{Component, Path, PathBuf};

use serde_json::{Value, json};

use super::super::WriteError;
use super::super::file::{folder_of, replace};
use super::append::array;
use super::json::{Object, whole};
use super::{GltfDocument, Origin, container};
use crate::io::MeshFormat;

impl GltfDocument {
    /// Writes the document; the extension of the path (`glb` or `gltf`, in whatever case) says as what.
    ///
    /// A `.glb` holds all buffers. A `.gltf` names the files that its original named, and images are named in both cases:
    /// none is copied, and relative names are changed where the folder is another. Data without a place of its own goes
    /// to `.bin` beside a `.gltf`, under the same name, or to a data URI where all other buffers are such. Files appear when
    /// they are complete.
    ///
    /// # Errors
    /// A [`WriteError`].
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        let target = || path.display().to_string();
        let failed = |cause| WriteError::Io { target: target(), cause };
        let format = MeshFormat::from_path(path);
        let mut json = self.json.clone();
        self.rename(&mut json, path)?;
        match format {
            Some(MeshFormat::Glb) => {
                let bytes = self.packed(json, &target())?;
                replace(path, |out| out.write_all(&bytes)).map_err(failed)
            }
            Some(MeshFormat::Gltf) => self.write_json(json, path).map_err(failed),
            _ => Err(WriteError::UnknownExtension { file: target() }),
        }
    }

    /// Writes a `.gltf`, and the buffer that has no place of its own.
    fn write_json(&self, mut json: Object, path: &Path) -> io::Result<()> {
        let own = self.buffers.iter().position(|buffer| buffer.origin == Origin::Own);
        let alone = self.buffers.len() == 1 || self.buffers.iter().any(|buffer| buffer.origin == Origin::File);
        let beside = own.filter(|_| alone).map(|own| (free_name(&json, path), &self.buffers[own].bytes));
        if let Some(own) = own {
            let uri = match &beside {
                Some((name, _)) => container::uri_of(name),
                None => container::data_uri(&self.buffers[own].bytes),
            };
            if let Some(Value::Object(buffer)) = array(&mut json, "buffers").get_mut(own) {
                buffer.insert("uri".to_owned(), uri.into());
            }
        }
        let text = if self.in_lines { serde_json::to_vec_pretty(&json) } else { serde_json::to_vec(&json) }?;
        replace(path, |out| {
            out.write_all(&text)?;
            // An old document must not find a new buffer: that comes when nothing is left to do but to rename.
            out.flush()?;
            beside.map_or(Ok(()), |(name, bytes)| replace(&folder_of(path).join(name), |out| out.write_all(bytes)))
        })
    }

    /// The bytes of a `.glb` with all buffers. Images that are files keep their names.
    ///
    /// # Errors
    /// [`WriteError::TooLarge`] beyond 4 GiB.
    pub fn to_glb(&self) -> Result<Vec<u8>, WriteError> {
        self.packed(self.json.clone(), "output")
    }

    fn packed(&self, mut json: Object, target: &str) -> Result<Vec<u8>, WriteError> {
        const TOO_LARGE: &str = "the bytes of a .glb";
        let mut bin = Vec::new();
        let mut starts = Vec::new();
        for buffer in &self.buffers {
            bin.resize(bin.len().next_multiple_of(4), 0);
            starts.push(bin.len());
            bin.extend_from_slice(&buffer.bytes);
        }
        if !starts.is_empty() {
            let buffers = array(&mut json, "buffers");
            buffers.truncate(1);
            if let Some(Value::Object(buffer)) = buffers.first_mut() {
                buffer.shift_remove("uri");
                buffer.insert("byteLength".to_owned(), bin.len().into());
            }
        }
        if starts.len() > 1 {
            array(&mut json, "bufferViews").iter_mut().filter_map(Value::as_object_mut).for_each(|view| {
                let number = |key| view.get(key).and_then(whole).and_then(|n| usize::try_from(n).ok());
                // A view of no buffer was of no use before.
                let Some(&start) = number("buffer").and_then(|buffer| starts.get(buffer)) else { return };
                let offset = number("byteOffset").unwrap_or(0).saturating_add(start);
                view.insert("buffer".to_owned(), json!(0));
                if offset > 0 {
                    view.insert("byteOffset".to_owned(), offset.into());
                }
            });
        }
        let too_large = || WriteError::TooLarge { target: target.to_owned(), what: TOO_LARGE };
        let text = serde_json::to_vec(&json).map_err(|_| too_large())?;
        container::join(text, bin, &self.chunks).ok_or_else(too_large)
    }

    /// Changes relative names of files to what they are from the folder of `path`.
    fn rename(&self, json: &mut Object, path: &Path) -> Result<(), WriteError> {
        let Some(from) = &self.folder else { return Ok(()) };
        let to = folder_of(path);
        // A folder that does not exist is found when it is written to.
        let (Ok(from), Ok(to)) = (from.canonicalize(), to.canonicalize()) else { return Ok(()) };
        if from == to {
            return Ok(());
        }
        let way = way(&to, &from);
        for key in ["buffers", "images"] {
            let Some(Value::Array(list)) = json.get_mut(key) else { continue };
            for entry in list.iter_mut().filter_map(Value::as_object_mut) {
                let Some(uri) = entry.get("uri").and_then(Value::as_str) else { continue };
                if container::is_data(uri) || container::file_name(uri).is_none() {
                    continue;
                }
                let Some(way) = &way else {
                    return Err(WriteError::Unreachable { target: path.display().to_string(), uri: uri.to_owned() });
                };
                let uri = format!("{way}{uri}");
                entry.insert("uri".to_owned(), uri.into());
            }
        }
        Ok(())
    }
}

/// The way from one folder to another as the beginning of a URI; `None` where there is none, or where it has names that no
/// URI can say.
fn way(from: &Path, to: &Path) -> Option<String> {
    let common = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let rest = |path: &Path| path.components().skip(common).map(|c| c.as_os_str().to_owned()).collect::<Vec<_>>();
    let is_root = |path: &Path| path.components().skip(common).any(|c| !matches!(c, Component::Normal(_)));
    if common == 0 || is_root(from) || is_root(to) {
        return None;
    }
    let mut out = "../".repeat(rest(from).len());
    for folder in rest(to) {
        out += &container::uri_of(folder.to_str()?);
        out.push('/');
    }
    Some(out)
}

/// A name for the buffer beside a `.gltf` that no other buffer of it has.
fn free_name(json: &Object, path: &Path) -> String {
    let stem = path.file_stem().and_then(OsStr::to_str).unwrap_or("buffer");
    let buffers = json.get("buffers").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let uris = buffers.iter().filter_map(|buffer| buffer.get("uri")?.as_str());
    // Some systems make no difference between a and A.
    let taken: Vec<String> = uris
        .filter_map(container::file_name)
        .filter_map(|name| PathBuf::from(name).file_name()?.to_str().map(str::to_lowercase))
        .collect();
    let names = (0_usize..).map(|n| match n {
        0 => format!("{stem}.bin"),
        1 => format!("{stem}-uv.bin"),
        n => format!("{stem}-uv{n}.bin"),
    });
    names.into_iter().find(|name| !taken.contains(&name.to_lowercase())).expect("there are more names than buffers")
}
