//! Packs the outlines that stand on stdin, and writes where they are to stdout, in texels.
//!
//! ```sh
//! cargo run --release -p abf-pack --example outlines -- --page 1024x1024 --margin 2 --pack good < charts.txt > packed.txt
//! ```
//!
//! Both are lines of text. `c LOOPS` begins a chart (what follows on the line is not read), `l POINTS` begins one of its
//! loops, and each point has a line `x y`. The output has `p PAGE` before each chart. Figures go to stderr, as JSON.

use abf_pack::{Effort, PackSettings, Piece, pack};
use std::error::Error;
use std::fmt::Write as _;
use std::io::{Read, Write};
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut settings = PackSettings::default();
    let mut args = std::env::args().skip(1);
    while let Some(option) = args.next() {
        let value = args.next().ok_or_else(|| format!("{option} needs a value"))?;
        match option.as_str() {
            "--page" => {
                let (width, height) = value.split_once('x').ok_or("a page is WxH")?;
                settings.page = [width.parse()?, height.parse()?];
            }
            "--margin" => settings.margin = value.parse()?,
            "--pack" => settings.effort = value.parse::<Effort>()?,
            "--pages" => settings.pages = value.parse()?,
            _ => return Err(format!("unknown option {option}").into()),
        }
    }
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    let pieces = read(&text)?;
    let (begin, cpu) = (Instant::now(), cpu_time::ProcessTime::now());
    let packing = pack(&pieces, &settings)?;
    let (wall, cpu) = (begin.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
    let mut out = String::new();
    for (i, piece) in pieces.iter().enumerate() {
        writeln!(out, "p {}\nc {}", packing.placements[i].page, piece.polygons[0].len())?;
        for ring in &piece.polygons[0] {
            writeln!(out, "l {}", ring.len())?;
            for &p in ring {
                let [x, y] = packing.texel(i, p);
                writeln!(out, "{x:?} {y:?}")?;
            }
        }
    }
    std::io::stdout().write_all(out.as_bytes())?;
    let (charts, pages, coverage) = (pieces.len(), packing.pages, packing.coverage);
    let scale = packing.texels_per_unit;
    writeln!(
        std::io::stderr(),
        r#"{{"charts": {charts}, "pages": {pages}, "coverage": {coverage}, "texels_per_unit": {scale:?}, "cpu_s": {cpu:.4}, "wall_s": {wall:.4}}}"#
    )?;
    Ok(())
}

fn read(text: &str) -> Result<Vec<Piece>, Box<dyn Error>> {
    let mut pieces: Vec<Piece> = Vec::new();
    for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let wrong = || format!("line {}: {line}", number + 1);
        let words: Vec<&str> = line.split_whitespace().collect();
        match (words[0], pieces.last_mut()) {
            ("c", _) => pieces.push(Piece::new(Vec::new())),
            ("l", Some(piece)) => piece.polygons[0].push(Vec::new()),
            (_, Some(piece)) if words.len() == 2 => {
                let ring = piece.polygons[0].last_mut().ok_or_else(wrong)?;
                ring.push([words[0].parse()?, words[1].parse()?]);
            }
            _ => return Err(wrong().into()),
        }
    }
    Ok(pieces)
}
