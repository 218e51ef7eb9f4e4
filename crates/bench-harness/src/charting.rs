//! What was meant by charts: the options, checked, and what they make of a mesh.

use crate::args::{ChartArgs, SeamsFrom};
use crate::errors::Failure;
use crate::load::Loaded;
use crate::methods::usage;
use crate::number::count;
use crate::record::{Atlas as AtlasRecord, Charted};
use crate::settings::check_extension;
use abf::cut::RepairReport;
use abf::{
    Atlas, AtlasPages, Observer, Packed, Pipeline, Precision, SeamRule, Stored, SurfaceHints, Unwrap, Unwrapped,
};
use abf_mesh::TriMesh;
use abf_mesh::io::{MeshFormat, stored_uv};
use clap::error::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// How meshes become charts, and charts an atlas.
#[derive(Clone, Debug)]
pub(crate) struct Charting {
    unwrap: Unwrap,
    atlas: Atlas,
    seams: SeamsFrom,
    /// Whether disks are made charts, too.
    is_asked: bool,
    /// Whether there are no charts at all.
    disks_only: bool,
    /// Where the seams go.
    pub(crate) seam_lines: Option<PathBuf>,
    /// Where the remap of vertices goes.
    pub(crate) remap: Option<PathBuf>,
    /// Whether texture coordinates may be replaced.
    pub(crate) overwrite: bool,
    /// Whether the output is a glTF, which stores 32 bits.
    to_gltf: bool,
}

/// Charts in an atlas, and what there is to say of them.
#[derive(Debug)]
pub(crate) struct Charts {
    pub(crate) packed: Packed,
    pub(crate) record: AtlasRecord,
    /// The ends of every edge that is a seam.
    pub(crate) seams: Vec<[abf_mesh::VertexId; 2]>,
    /// How long it took to make them, without the packing, seconds.
    pub(crate) charts_s: f64,
}

impl Charting {
    /// Checks the options.
    ///
    /// # Errors
    /// A usage error that names the option and its range.
    pub(crate) fn new(args: ChartArgs, inputs: &[PathBuf], output: Option<&Path>) -> Result<Self, clap::Error> {
        let is_asked = args.is_asked();
        let (unwrap, atlas) = (Unwrap::default(), Atlas::default());
        let wrong = |message: String| Err(usage(ErrorKind::ValueValidation, message));
        let is_gltf = |path: &Path| MeshFormat::from_path(path).is_some_and(MeshFormat::is_gltf);
        let to_gltf = output.is_some_and(is_gltf);
        if args.disks_only && to_gltf {
            let message = "a glTF takes an atlas: leave out --disks-only, or write an obj or ply";
            return Err(usage(ErrorKind::ArgumentConflict, message));
        }
        for (option, is_given) in [("--remap", args.remap.is_some()), ("--overwrite", args.overwrite)] {
            if is_given && !(to_gltf && inputs.iter().any(|input| is_gltf(input))) {
                let message =
                    format!("{option} concerns a glTF that is read and written as one: name it, and -o FILE.glb");
                return Err(usage(ErrorKind::ArgumentConflict, message));
            }
        }
        if args.disks_only && is_asked {
            let message = "--disks-only makes no charts: leave out the options of charts, or it";
            return Err(usage(ErrorKind::ArgumentConflict, message));
        }
        if let Some(stretch) = args.max_stretch.filter(|s| !(*s >= 1.0)) {
            return wrong(format!("--max-stretch must be at least 1, got {stretch}"));
        }
        if let Some(length) = args.max_seam.filter(|l| !(*l >= 0.0)) {
            return wrong(format!("--max-seam must be at least 0, got {length}"));
        }
        let resolution = args.resolution.unwrap_or(atlas.resolution);
        if !(1..=Atlas::MAX_RESOLUTION).contains(&resolution) {
            return wrong(format!("--resolution must be in 1..={}, got {resolution}", Atlas::MAX_RESOLUTION));
        }
        let margin = args.margin.unwrap_or(atlas.margin.min(resolution / 4));
        if margin > resolution / 4 {
            return wrong(format!("--margin must be at most a quarter of --resolution {resolution}, got {margin}"));
        }
        for (option, path, extension) in [("--seam-lines", &args.seam_lines, "obj"), ("--remap", &args.remap, "json")] {
            if let Some(path) = path {
                check_extension(option, path, &[extension])?;
            }
        }
        // Pages per material make sense only where charts end at their borders.
        let by_material = args.atlas == Some(AtlasPages::PerMaterial);
        let seams = args.seams.unwrap_or(if by_material { SeamsFrom::File } else { SeamsFrom::Auto });
        let rule = if seams == SeamsFrom::Auto { SeamRule::Auto } else { SeamRule::Keep };
        Ok(Self {
            unwrap: Unwrap {
                seams: rule,
                holes: args.holes.unwrap_or(unwrap.holes),
                max_stretch: args.max_stretch.unwrap_or(unwrap.max_stretch),
                max_seam: args.max_seam,
                cut_disks: args.cut_disks,
                strict: args.strict,
                ..unwrap
            },
            atlas: Atlas { pages: args.atlas.unwrap_or(atlas.pages), resolution, margin },
            seams,
            is_asked,
            disks_only: args.disks_only,
            seam_lines: args.seam_lines,
            remap: args.remap,
            overwrite: args.overwrite,
            to_gltf,
        })
    }

    /// How to make charts, if any are to be made.
    pub(crate) fn if_allowed(&self) -> Option<&Self> {
        (!self.disks_only).then_some(self)
    }

    /// Whether this mesh is made charts even if it is a disk: textures want UVs in the unit square.
    pub(crate) fn is_for(&self, loaded: &Loaded) -> bool {
        self.is_asked || self.to_gltf || loaded.is_gltf()
    }

    /// Makes charts and an atlas of a mesh.
    ///
    /// # Errors
    /// Why there are none.
    pub(crate) fn run(
        &self,
        loaded: &Loaded,
        pipeline: &Pipeline,
        observer: &mut (dyn Observer + Send),
    ) -> Result<Charts, Failure> {
        let begin = Instant::now();
        let mesh = &loaded.mesh;
        let known = loaded.known_of_faces(self.seams == SeamsFrom::File)?;
        let keeps = self.seams != SeamsFrom::Auto;
        let hints = SurfaceHints {
            uv: loaded.uv.as_ref().filter(|_| keeps),
            face_labels: known.labels.as_deref().filter(|_| keeps),
            forbidden: known.forbidden.as_deref(),
        };
        // Without materials the packing has more to say.
        let says_more = self.atlas.pages == AtlasPages::PerMaterial;
        if keeps && !says_more && hints.uv.is_none() && hints.face_labels.is_none() {
            return Err(Failure::no_seams(&loaded.name));
        }
        let unwrap = Unwrap { pipeline: Pipeline { normalize: false, ..*pipeline }, ..self.unwrap };
        let unwrapped =
            unwrap.run(mesh, &hints, observer).map_err(|e| Failure::unwrap(&loaded.name, &e, loaded.fanned))?;
        let charts_s = begin.elapsed().as_secs_f64();
        let stored: (Stored, Precision) = match (self.to_gltf, pipeline.precision) {
            (true, _) => (stored_uv, Precision::Single),
            (false, Precision::Single) => (|p| p.map(|x| Precision::Single.round(x)), Precision::Single),
            (false, Precision::Double) => (|p| p, Precision::Double),
        };
        let packed = self.atlas.pack(mesh, &unwrapped, known.materials.as_deref(), stored);
        let packed = packed.map_err(|error| Failure::atlas(&loaded.name, &error))?;
        let record = self.record(&unwrapped, &packed);
        Ok(Charts { packed, record, seams: unwrapped.seams, charts_s })
    }

    fn record(&self, unwrapped: &Unwrapped, packed: &Packed) -> AtlasRecord {
        let repairs: &RepairReport = &unwrapped.repairs;
        let mut said = repairs.sentences();
        if unwrapped.without_area > 0 {
            let faces = count(unwrapped.without_area, "face", "faces");
            said.push(format!("{faces} of components without any area put into one point"));
        }
        if !unwrapped.turned.is_empty() || !unwrapped.followers.is_empty() {
            let (turned, dropped) = (unwrapped.turned.len(), unwrapped.followers.len().div_ceil(3));
            said.push(format!(
                "faces are written with the corners of the file, and judged as repaired: `metrics` of the output counts {} \
                 that were turned around, and {} that were dropped, as they stand there",
                count(turned, "face", "faces"),
                count(dropped, "face", "faces")
            ));
        }
        AtlasRecord {
            charts: unwrapped
                .charts
                .iter()
                .zip(&packed.placements)
                .map(|(chart, at)| Charted::new(chart, at))
                .collect(),
            pages: packed.pages,
            resolution: self.atlas.resolution,
            margin: self.atlas.margin,
            texels_per_unit: packed.texels_per_unit,
            coverage: packed.coverage,
            seam_edges: unwrapped.seams.len(),
            seam_length: unwrapped.seam_length,
            diagonal: unwrapped.diagonal,
            max_stretch: self.unwrap.max_stretch,
            repairs: said,
        }
    }
}

/// The seams as an OBJ of lines.
pub(crate) fn seam_lines(mesh: &TriMesh, seams: &[[abf_mesh::VertexId; 2]]) -> String {
    use std::collections::BTreeMap;
    use std::fmt::Write;
    let mut number: BTreeMap<_, usize> = seams.iter().flatten().map(|&v| (v, 0)).collect();
    let mut out = String::new();
    // Writing to a string cannot fail.
    for (i, (v, n)) in number.iter_mut().enumerate() {
        *n = i + 1;
        let p = mesh.positions()[v.index()];
        let _ = writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z);
    }
    for [a, b] in seams {
        let _ = writeln!(out, "l {} {}", number[a], number[b]);
    }
    out
}
