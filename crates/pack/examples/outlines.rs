//! Packs outlines from text files and prints coverage and processor time.
//!
//! `cargo run --release -p abf-pack --example outlines -- FOLDER|FILE… [--page 1024x1024] [--margin 2] [--effort good]
//! [--out FOLDER]`
//!
//! A file has charts: a line `c LOOPS AREA`, then for every loop a line `l POINTS` and the points, one a line. The first
//! loop is the outer one. With `--out` the packed outlines are written in the same form, each chart with its page.
#![allow(clippy::print_stdout)]

use abf_pack::{Effort, PackSettings, Packing, Piece, pack};
use cpu_time::ProcessTime;
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let mut files: Vec<PathBuf> = Vec::new();
    let mut settings = PackSettings::default();
    let mut efforts = Effort::ALL.to_vec();
    let mut out = None;
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or_else(|| format!("{arg} needs a value"));
        match arg.as_str() {
            "--page" => {
                let text = value()?;
                let (width, height) = text.split_once('x').ok_or("--page takes WIDTHxHEIGHT")?;
                settings.page = [width.parse()?, height.parse()?];
            }
            "--margin" => settings.margin = value()?.parse()?,
            "--pages" => settings.pages = value()?.parse()?,
            "--texels-per-unit" => settings.texels_per_unit = Some(value()?.parse()?),
            "--effort" => efforts = vec![value()?.parse()?],
            "--out" => out = Some(PathBuf::from(value()?)),
            _ => files.extend(text_files(Path::new(&arg))?),
        }
    }
    if files.is_empty() {
        return Err("no outlines: name a folder with .txt files, or such a file".into());
    }
    println!("charts-of effort charts pages coverage texels/unit cpu-s");
    for file in &files {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let pieces = read(file)?;
        for &effort in &efforts {
            let start = ProcessTime::now();
            let packing = pack(&pieces, &PackSettings { effort, ..settings })?;
            let seconds = start.elapsed().as_secs_f64();
            let Packing { pages, coverage, texels_per_unit, .. } = packing;
            let charts = pieces.len();
            println!("{name} {effort} {charts} {pages} {coverage:.4} {texels_per_unit:.3} {seconds:.3}");
            if let Some(folder) = &out {
                std::fs::write(folder.join(format!("{name}-{effort}.txt")), packed(&pieces, &packing))?;
            }
        }
    }
    Ok(())
}

fn text_files(path: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let entries: Result<Vec<PathBuf>, _> = std::fs::read_dir(path)?.map(|entry| entry.map(|e| e.path())).collect();
    let mut files: Vec<PathBuf> = entries?.into_iter().filter(|p| p.extension().is_some_and(|e| e == "txt")).collect();
    files.sort();
    Ok(files)
}

fn read(file: &Path) -> Result<Vec<Piece>, Box<dyn Error>> {
    let text = std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let mut charts: Vec<Vec<Vec<[f64; 2]>>> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let wrong = || format!("{}:{}: not a chart, a loop or a point", file.display(), number + 1);
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["c", ..] => charts.push(Vec::new()),
            ["l", ..] => charts.last_mut().ok_or_else(wrong)?.push(Vec::new()),
            [x, y] => {
                let point = [x.parse()?, y.parse()?];
                charts.last_mut().and_then(|chart| chart.last_mut()).ok_or_else(wrong)?.push(point);
            }
            _ => return Err(wrong().into()),
        }
    }
    Ok(charts.into_iter().map(Piece::new).collect())
}

fn packed(pieces: &[Piece], packing: &Packing) -> String {
    let mut text = String::new();
    for (i, piece) in pieces.iter().enumerate() {
        let loops: Vec<_> = piece.polygons.iter().flatten().collect();
        let _ = writeln!(text, "c {} {}", loops.len(), packing.placements[i].page);
        for ring in loops {
            let _ = writeln!(text, "l {}", ring.len());
            for &p in ring {
                let [x, y] = packing.texel(i, p);
                let _ = writeln!(text, "{x} {y}");
            }
        }
    }
    text
}
