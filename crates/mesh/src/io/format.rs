//! The formats of mesh files: one table that says what is done with each.

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

/// What is done with the files of one format. All formats are read.
struct Row {
    format: MeshFormat,
    extension: &'static str,
    has_uvs: bool,
    is_written: bool,
    /// What stays of a file that is written again in its own format.
    keeps: &'static str,
}

/// One row for each format, in the order of the variants, which is that of the extensions.
const TABLE: &[Row] = &[
    #[cfg(feature = "gltf")]
    Row {
        format: MeshFormat::Glb,
        extension: "glb",
        has_uvs: true,
        is_written: true,
        keeps: "everything, with the UVs as a new set or in the place of an old one",
    },
    #[cfg(feature = "gltf")]
    Row {
        format: MeshFormat::Gltf,
        extension: "gltf",
        has_uvs: true,
        is_written: true,
        keeps: "everything, with the UVs as a new set or in the place of an old one",
    },
    Row {
        format: MeshFormat::Obj,
        extension: "obj",
        has_uvs: true,
        is_written: true,
        keeps: "polygons, materials, groups, normals, comments; UVs it had are replaced",
    },
    Row { format: MeshFormat::Off, extension: "off", has_uvs: true, is_written: false, keeps: "" },
    Row {
        format: MeshFormat::Ply,
        extension: "ply",
        has_uvs: true,
        is_written: true,
        keeps: "the mesh, and the colours of its vertices",
    },
    Row { format: MeshFormat::Stl, extension: "stl", has_uvs: false, is_written: false, keeps: "" },
];

// A variant is the index of its row.
const _: () = {
    let mut i = 0;
    while i < TABLE.len() {
        assert!(TABLE[i].format as usize == i, "the rows are in the order of the variants");
        i += 1;
    }
};

/// A word that names no [`MeshFormat`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a mesh format; known are {known}", known = MeshFormat::known())]
pub struct UnknownFormat(
    /// The word.
    pub String,
);

impl MeshFormat {
    /// Every format, in alphabetical order.
    pub const ALL: [Self; TABLE.len()] = {
        let mut all = [Self::Obj; TABLE.len()];
        let mut i = 0;
        while i < all.len() {
            all[i] = TABLE[i].format;
            i += 1;
        }
        all
    };

    const fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }

    /// The extension of its files, which is also the word that [`FromStr`] takes.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        self.row().extension
    }

    /// Whether its files can hold UVs.
    #[must_use]
    pub const fn has_uvs(self) -> bool {
        self.row().has_uvs
    }

    /// Whether [`write`](super::write) writes it; every format is read.
    #[must_use]
    pub const fn is_written(self) -> bool {
        self.row().is_written
    }

    /// What stays of a file that is written again in its own format; empty if it is not written.
    #[must_use]
    pub const fn keeps(self) -> &'static str {
        self.row().keeps
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

    /// The extensions of some formats.
    #[must_use]
    pub fn extensions(of: impl Fn(Self) -> bool) -> Vec<&'static str> {
        Self::ALL.into_iter().filter(|&format| of(format)).map(Self::extension).collect()
    }

    /// The extensions of some formats, for a sentence; `last` stands before the last one.
    ///
    /// ```
    /// # use abf_mesh::io::MeshFormat;
    /// // With the feature `gltf`: "glb, gltf, obj or ply".
    /// let written = MeshFormat::list(MeshFormat::is_written, " or ");
    /// assert!(written.ends_with("obj or ply"));
    /// ```
    #[must_use]
    pub fn list(of: impl Fn(Self) -> bool, last: &str) -> String {
        match &Self::extensions(of)[..] {
            [others @ .., end] if !others.is_empty() => format!("{}{last}{end}", others.join(", ")),
            all => all.concat(),
        }
    }

    /// All extensions, for messages.
    pub(super) fn known() -> String {
        Self::list(|_| true, ", ")
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

    #[test]
    fn every_format_has_its_own_row() {
        assert!(MeshFormat::ALL.iter().all(|&format| format.row().format == format));
        assert!(MeshFormat::ALL.map(MeshFormat::extension).is_sorted());
    }

    #[test]
    fn what_is_written_is_what_the_table_says() {
        let mesh = crate::TriMesh::new(vec![crate::Point3::origin(); 3], &[[0, 1, 2]]).expect("indices in range");
        let folder = tempfile::tempdir().expect("a folder");
        for format in MeshFormat::ALL {
            let path = folder.path().join(format!("a.{}", format.extension()));
            assert_eq!(crate::io::write(&path, &mesh, None).is_ok(), format.is_written(), "{format:?}");
        }
    }
}
