//! Where the entries of a matrix are, as a picture: VMV04 fig. 2.

use std::fmt::Write;

use tiny_skia::{Color, Pixmap, PremultipliedColorU8};

use crate::PictureError;

/// The side of a panel in a PNG, pixels.
const SIDE: u32 = 900;
/// The most cells along a side of a panel in an SVG; a larger matrix has several entries in a cell.
const CELLS: usize = 900;
/// The side of a panel in an SVG, and the room around it, in its units.
const WIDTH: f64 = 400.0;
const ROOM: f64 = 24.0;
/// The room around a panel in a PNG, pixels.
const MARGIN: u32 = 20;

/// One matrix.
#[derive(Clone, Copy, Debug)]
pub struct SparsityPanel<'a> {
    /// What stands above it in an SVG.
    pub title: &'a str,
    /// How many rows and columns it has.
    pub size: usize,
    /// How many entries it has.
    pub count: usize,
    /// Row and column of every entry that is in no block.
    pub entries: &'a [[u32; 2]],
    /// Indices of which every two, one as the row and one as the column, have an entry: a dense part, without a list of its
    /// entries.
    pub blocks: &'a [Vec<u32>],
}

/// The matrices side by side as a PNG: a pixel is dark where one of its entries is.
///
/// # Errors
/// [`PictureError::Encoding`], for more matrices than fit into a picture, too.
pub fn sparsity_png(panels: &[SparsityPanel<'_>]) -> Result<Vec<u8>, PictureError> {
    let (width, height) = (MARGIN + panels.len().max(1) as u32 * (SIDE + MARGIN), SIDE + 2 * MARGIN);
    let too_large = || PictureError::Encoding { reason: format!("{} panels are too many", panels.len()) };
    let mut canvas = Pixmap::new(width, height).ok_or_else(too_large)?;
    canvas.fill(Color::WHITE);
    let grey = PremultipliedColorU8::from_rgba(150, 150, 150, 255).expect("opaque");
    let ink = PremultipliedColorU8::from_rgba(20, 40, 90, 255).expect("opaque");
    for (k, panel) in panels.iter().enumerate() {
        let left = MARGIN + k as u32 * (SIDE + MARGIN);
        let mut put = |x: u32, y: u32, colour| canvas.pixels_mut()[(y * width + x) as usize] = colour;
        for t in 0..SIDE + 2 {
            for (x, y) in [(t, 0), (t, SIDE + 1), (0, t), (SIDE + 1, t)] {
                put(left - 1 + x, MARGIN - 1 + y, grey);
            }
        }
        let cells = Cells::of(panel, SIDE as usize);
        // A matrix smaller than its panel has larger dots.
        let place = |cell: usize| (cell * SIDE as usize / cells.side) as u32;
        for (row, runs) in cells.runs.iter().enumerate() {
            for &[first, end] in runs {
                for y in place(row)..place(row + 1) {
                    (place(first)..place(end)).for_each(|x| put(left + x, MARGIN + y, ink));
                }
            }
        }
    }
    canvas.encode_png().map_err(|e| PictureError::Encoding { reason: e.to_string() })
}

/// The matrices side by side as an SVG, each with its title and the number of its entries.
#[must_use]
pub fn sparsity_svg(panels: &[SparsityPanel<'_>]) -> String {
    let (width, height) = (ROOM + panels.len() as f64 * (WIDTH + ROOM), WIDTH + 2.0 * ROOM);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
         <title>Entries that are not zero</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    for (k, panel) in panels.iter().enumerate() {
        let left = ROOM + k as f64 * (WIDTH + ROOM);
        let cells = Cells::of(panel, CELLS);
        let scale = WIDTH / cells.side as f64;
        let title = crate::page::escape(panel.title);
        push(&mut out, format_args!("<g transform=\"translate({left} {ROOM})\">\n"));
        push(
            &mut out,
            format_args!(
                "<text x=\"0\" y=\"-7\" font-family=\"sans-serif\" font-size=\"13\">{title}: {} rows, {} entries</text>\n",
                panel.size, panel.count
            ),
        );
        push(&mut out, format_args!("<path transform=\"scale({scale})\" fill=\"#14285a\" d=\""));
        for (row, runs) in cells.runs.iter().enumerate() {
            for [first, end] in runs {
                push(&mut out, format_args!("M{first} {row}h{0}v1h-{0}z", end - first));
            }
        }
        push(
            &mut out,
            format_args!("\"/>\n<rect width=\"{WIDTH}\" height=\"{WIDTH}\" fill=\"none\" stroke=\"#969696\"/>\n</g>\n"),
        );
    }
    out.push_str("</svg>\n");
    out
}

fn push(out: &mut String, text: std::fmt::Arguments<'_>) {
    out.write_fmt(text).expect("a string takes everything");
}

/// The cells of a panel that have an entry.
struct Cells {
    side: usize,
    /// In every row of cells the runs of them, first and one after the last.
    runs: Vec<Vec<[usize; 2]>>,
}

impl Cells {
    fn of(panel: &SparsityPanel<'_>, most: usize) -> Self {
        let size = panel.size.max(1);
        let side = size.min(most);
        let cell = |k: u32| (k as usize * side / size).min(side - 1);
        let mut columns: Vec<Vec<usize>> = vec![Vec::new(); side];
        for &[row, column] in panel.entries {
            columns[cell(row)].push(cell(column));
        }
        for block in panel.blocks {
            // No more cells than there are in the picture.
            let mut cells: Vec<usize> = block.iter().map(|&k| cell(k)).collect();
            cells.sort_unstable();
            cells.dedup();
            cells.iter().for_each(|&row| columns[row].extend(&cells));
        }
        let runs = columns.into_iter().map(|mut columns| {
            columns.sort_unstable();
            columns.dedup();
            columns.chunk_by(|a, b| a + 1 == *b).map(|run| [run[0], run[0] + run.len()]).collect()
        });
        Self { side, runs: runs.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENTRIES: [[u32; 2]; 4] = [[0, 0], [0, 1], [2, 2], [1, 3]];

    fn panel(title: &str, size: usize) -> SparsityPanel<'_> {
        SparsityPanel { title, size, count: ENTRIES.len(), entries: &ENTRIES, blocks: &[] }
    }

    #[test]
    fn a_pixel_is_dark_where_an_entry_is() {
        let png = sparsity_png(&[panel("a", 4), panel("b", 4)]).expect("a picture");
        let canvas = Pixmap::decode_png(&png).expect("a PNG");
        let is_dark = |panel: u32, row: u32, column: u32| {
            let at = |cell: u32| cell * SIDE / 4 + SIDE / 8;
            let (x, y) = (MARGIN + panel * (SIDE + MARGIN) + at(column), MARGIN + at(row));
            canvas.pixel(x, y).expect("inside").red() < 100
        };
        for panel in 0..2 {
            for row in 0..4 {
                for column in 0..4 {
                    assert_eq!(is_dark(panel, row, column), ENTRIES.contains(&[row, column]), "{row} {column}");
                }
            }
        }
    }

    #[test]
    fn the_drawing_has_a_run_for_neighbours_and_says_how_many_entries_there_are() {
        let svg = sparsity_svg(&[panel("product & log", 4)]);
        let document = roxmltree::Document::parse(&svg).expect("SVG");
        let path = document.descendants().find(|node| node.has_tag_name("path")).expect("a path");
        assert_eq!(path.attribute("d"), Some("M0 0h2v1h-2zM3 1h1v1h-1zM2 2h1v1h-1z"));
        assert!(svg.contains("product &amp; log: 4 rows, 4 entries"), "{svg}");
    }

    #[test]
    fn a_block_is_drawn_as_its_entries_are() {
        let block: Vec<u32> = (0..40).map(|k| 7 * k % 300).collect();
        let listed: Vec<[u32; 2]> = block.iter().flat_map(|&a| block.iter().map(move |&b| [a, b])).collect();
        let blocks = [block];
        for most in [50, 900] {
            let dense = Cells::of(&SparsityPanel { size: 300, entries: &[], blocks: &blocks, ..panel("", 0) }, most);
            let sparse = Cells::of(&SparsityPanel { size: 300, entries: &listed, ..panel("", 0) }, most);
            assert_eq!((dense.side, dense.runs), (sparse.side, sparse.runs));
        }
    }

    #[test]
    fn a_matrix_larger_than_the_panel_has_several_entries_in_a_cell_and_an_empty_one_none() {
        let entries: Vec<[u32; 2]> = (0..5000).map(|k| [k, k]).collect();
        let cells = Cells::of(&SparsityPanel { size: 5000, entries: &entries, ..panel("", 0) }, 900);
        assert_eq!(cells.side, 900);
        assert!(cells.runs.iter().enumerate().all(|(k, runs)| runs == &[[k, k + 1]]));
        let empty = Cells::of(&SparsityPanel { entries: &[], ..panel("", 0) }, 900);
        assert!(empty.side == 1 && empty.runs.iter().all(Vec::is_empty));
    }
}
