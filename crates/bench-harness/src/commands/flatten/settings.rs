//! What was meant by flattening: the arguments, checked before any file is read.

use crate::cli::args::FlattenArgs;
use crate::cli::charts::Charting;
use crate::cli::methods::{Method, methods};
use crate::cli::mistyped::check_is_no_command;
use crate::cli::sheet::Sheet;
use crate::cli::targets::{JsonTarget, check_distinct, check_extension, check_is_for_one, check_one_stdout};
use crate::cli::typed::Typed;
use crate::run::Wanted;
use crate::run::source::Source;
use crate::show::errors::ErrorFormat;
use abf_mesh::io::MeshFormat;
use std::path::{Path, PathBuf};

/// Everything a run needs to know.
#[derive(Debug)]
pub(crate) struct Settings {
    /// The meshes; at least one.
    pub(crate) sources: Vec<Source>,
    /// How to flatten each; at least one.
    pub(crate) methods: Vec<Method>,
    /// How to make charts.
    pub(crate) charting: Charting,
    /// How charts lie on a sheet, if they do.
    pub(crate) sheet: Option<Sheet>,
    /// Where the mesh goes.
    pub(crate) output: Option<PathBuf>,
    /// Where the picture goes.
    pub(crate) png: Option<PathBuf>,
    /// Where the errors of every triangle go.
    pub(crate) errors: Option<PathBuf>,
    /// Where to draw the layout in real units.
    pub(crate) svg: Option<PathBuf>,
    /// The same for CAD programs.
    pub(crate) dxf: Option<PathBuf>,
    /// Where the JSON goes.
    pub(crate) json: Option<JsonTarget>,
    /// Where every iteration goes.
    pub(crate) history: Option<JsonTarget>,
    /// What hints may name.
    pub(crate) typed: Typed,
}

impl Settings {
    /// Checks the arguments.
    ///
    /// # Errors
    /// A usage error: a setting out of range, outputs that fit no single result, an output that
    /// would replace an input.
    pub(crate) fn new(args: FlattenArgs, typed: Typed) -> Result<Self, clap::Error> {
        let methods = methods(&args.solver, &args.method)?;
        let sources = match args.meshes.as_slice() {
            [] => vec![Source::Builtin],
            meshes => meshes.iter().cloned().map(Source::File).collect(),
        };
        let (output, png, svg, dxf, errors) = (args.output, args.png, args.svg, args.dxf, args.errors);
        let sheet = Sheet::new(&args.sheet, &args.charts, args.method.normalize, svg.is_some() || dxf.is_some())?;
        let charting = Charting::new(args.charts, &args.meshes, output.as_deref())?;
        let (history, json) = (JsonTarget::new(args.history), JsonTarget::new(args.json));
        let (seam_lines, remap) = (&charting.seam_lines, &charting.remap);
        let singles = [
            ("--output", &output),
            ("--png", &png),
            ("--errors", &errors),
            ("--svg", &svg),
            ("--dxf", &dxf),
            ("--seam-lines", seam_lines),
            ("--remap", remap),
        ];
        for (option, path) in singles {
            if let Some(path) = path {
                check_is_for_one(option, path, sources.len(), methods.len())?;
            }
        }
        if let Some(path) = &output {
            check_extension("--output", path, &MeshFormat::extensions(MeshFormat::is_written))?;
        }
        let targets = [
            ("--output", output.as_deref()),
            ("--png", png.as_deref()),
            ("--errors", errors.as_deref()),
            ("--svg", svg.as_deref()),
            ("--dxf", dxf.as_deref()),
            ("--seam-lines", seam_lines.as_deref()),
            ("--remap", remap.as_deref()),
            ("--json", json.as_ref().and_then(JsonTarget::file)),
            ("--history", history.as_ref().and_then(JsonTarget::file)),
        ];
        check_distinct(&targets, &args.meshes)?;
        check_one_stdout(&[("--json", json.as_ref()), ("--history", history.as_ref())])?;
        for (option, path, extension) in [("--png", &png, "png"), ("--svg", &svg, "svg"), ("--dxf", &dxf, "dxf")] {
            if let Some(path) = path {
                check_extension(option, path, &[extension])?;
            }
        }
        if let Some(path) = &errors {
            check_extension("--errors", path, &ErrorFormat::ENDINGS)?;
        }
        args.meshes.iter().try_for_each(|mesh| check_is_no_command(mesh))?;
        Ok(Self { sources, methods, charting, sheet, output, png, errors, svg, dxf, json, history, typed })
    }

    /// The files that will be written.
    pub(crate) fn files(&self) -> [Option<&Path>; 9] {
        let [json, history] = [&self.json, &self.history].map(|target| target.as_ref().and_then(JsonTarget::file));
        let (seams, remap) = (self.charting.seam_lines.as_deref(), self.charting.remap.as_deref());
        [
            self.output.as_deref(),
            self.png.as_deref(),
            self.errors.as_deref(),
            self.svg.as_deref(),
            self.dxf.as_deref(),
            json,
            history,
            seams,
            remap,
        ]
    }

    /// What a run is to come to.
    pub(crate) fn wanted(&self) -> Wanted<'_> {
        Wanted {
            charting: self.charting.if_allowed(),
            sheet: self.sheet.as_ref(),
            with_history: self.history.is_some(),
        }
    }

    /// How much memory each may take.
    pub(crate) fn max_memory(&self) -> Option<u64> {
        self.methods[0].pipeline.max_memory
    }

    /// Whether several solvers are to be compared.
    pub(crate) fn is_comparison(&self) -> bool {
        self.methods.len() > 1
    }
}
