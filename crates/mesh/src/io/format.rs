//! The formats of mesh files.

use std::path::Path;
use std::str::FromStr;

/// A file format of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshFormat {
    /// glTF 2.0, binary; with the feature `gltf`.
    #[cfg(feature = "gltf")]
    Glb,
    /// glTF 2.0, JSON with buffers beside it or within; with the feature `gltf`.
    #[cfg(feature = "gltf")]
    Gltf,
    /// Wavefront OBJ, text.
    Obj,
    /// Object File Format of Geomview, text.
    Off,
    /// Polygon File Format of Stanford, text or binary.
    Ply,
    /// Stereolithography, text or binary.
    Stl,
}

/// A word that names no [`MeshFormat`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a mesh format; known are {known}", known = MeshFormat::known())]
pub struct UnknownFormat(
    /// The word.
    pub String,
);

impl MeshFormat {
    /// Every format, in alphabetical order.
    #[cfg(feature = "gltf")]
    pub const ALL: [Self; 6] = [Self::Glb, Self::Gltf, Self::Obj, Self::Off, Self::Ply, Self::Stl];
    /// Every format, in alphabetical order.
    #[cfg(not(feature = "gltf"))]
    pub const ALL: [Self; 4] = [Self::Obj, Self::Off, Self::Ply, Self::Stl];

    /// The extension of its files, which is also the name that [`FromStr`] takes.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            #[cfg(feature = "gltf")]
            Self::Glb => "glb",
            #[cfg(feature = "gltf")]
            Self::Gltf => "gltf",
            Self::Obj => "obj",
            Self::Off => "off",
            Self::Ply => "ply",
            Self::Stl => "stl",
        }
    }

    /// The format that the extension of `path` names, in whatever case.
    #[must_use]
    pub fn from_path(path: &Path) -> Option<Self> {
        path.extension()?.to_str()?.parse().ok()
    }

    /// Whether it is one of the two of glTF.
    #[must_use]
    pub const fn is_gltf(self) -> bool {
        match self {
            #[cfg(feature = "gltf")]
            Self::Glb | Self::Gltf => true,
            Self::Obj | Self::Off | Self::Ply | Self::Stl => false,
        }
    }

    /// All extensions, for messages.
    pub(super) fn known() -> String {
        Self::ALL.map(Self::extension).join(", ")
    }
}

impl FromStr for MeshFormat {
    type Err = UnknownFormat;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        let named = |format: &Self| format.extension().eq_ignore_ascii_case(word);
        Self::ALL.into_iter().find(named).ok_or_else(|| UnknownFormat(word.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_name_formats_in_any_case() {
        assert_eq!(MeshFormat::from_path(Path::new("a/b.c/Cow.OBJ")), Some(MeshFormat::Obj));
        assert_eq!(MeshFormat::from_path(Path::new("cow.obj.gz")), None);
        assert_eq!(MeshFormat::from_path(Path::new("obj")), None);
        for format in MeshFormat::ALL {
            assert_eq!(format.extension().parse(), Ok(format));
        }
        let e = "fbx".parse::<MeshFormat>().unwrap_err();
        assert_eq!(e.to_string(), "`fbx` is not a mesh format; known are glb, gltf, obj, off, ply, stl");
    }
}
