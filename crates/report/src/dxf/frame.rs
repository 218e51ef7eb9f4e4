//! The text of a DXF file: groups of a code and a value, and what every file of release 2000 has around its drawing.

use crate::svg::SvgUnit;
use std::fmt::{Display, Write};

/// The block that the drawing is in.
const MODEL_SPACE: &str = "1F";
/// The first handle of what is drawn: all below are of the frame.
const FIRST_HANDLE: u32 = 0x100;
/// The linetypes of folds, and how long their strokes and gaps (negative) are, millimetres.
const LINETYPES: [(&str, &str, &str, &[f64]); 2] = [
    ("16", "MOUNTAIN", "towards the viewer __ . __ . __", &[3.0, -1.0, 0.5, -1.0]),
    ("17", "VALLEY", "away from the viewer __ __ __", &[2.0, -1.0]),
];
/// The layers, with their handles and colours: white, red, green, magenta.
const LAYERS: [(&str, &str, u8); 4] = [("10", "0", 7), ("11", "CUT", 1), ("12", "FOLD", 3), ("13", "LABEL", 6)];

/// Writes groups.
pub(super) struct Writer {
    text: String,
    next_handle: u32,
    decimals: usize,
}

impl Writer {
    pub(super) fn new(decimals: usize) -> Self {
        Self { text: String::new(), next_handle: FIRST_HANDLE, decimals }
    }

    /// A polyline without width.
    pub(super) fn polyline(&mut self, layer: &str, points: &[[f64; 2]], is_closed: bool) {
        self.entity("LWPOLYLINE", layer, None);
        self.group(100, "AcDbPolyline").group(90, points.len()).group(70, u8::from(is_closed));
        for &p in points {
            self.place(10, p);
        }
    }

    /// A line, in the linetype of its layer if none is named.
    pub(super) fn line(&mut self, layer: &str, linetype: Option<&str>, [from, to]: [[f64; 2]; 2]) {
        self.entity("LINE", layer, linetype);
        self.group(100, "AcDbLine").place(10, from).place(11, to);
    }

    /// A text with its middle at a place.
    pub(super) fn text(&mut self, layer: &str, text: &str, at: [f64; 2], height: f64) {
        self.entity("TEXT", layer, None);
        self.group(100, "AcDbText").place(10, at).number(40, height).group(1, text).group(72, 1).place(11, at);
        // The second marker stands before the vertical alignment.
        self.group(100, "AcDbText").group(73, 2);
    }

    fn entity(&mut self, name: &str, layer: &str, linetype: Option<&str>) {
        let handle = format!("{:X}", self.next_handle);
        self.next_handle += 1;
        self.group(0, name).group(5, handle).group(330, MODEL_SPACE).group(100, "AcDbEntity").group(8, layer);
        if let Some(linetype) = linetype {
            self.group(6, linetype);
        }
    }

    fn group(&mut self, code: u16, value: impl Display) -> &mut Self {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{code}\n{value}");
        self
    }

    fn number(&mut self, code: u16, value: f64) -> &mut Self {
        let value = decimal(value, self.decimals);
        self.group(code, value)
    }

    fn place(&mut self, code: u16, [x, y]: [f64; 2]) -> &mut Self {
        self.number(code, x).number(code + 10, y)
    }

    /// A record of a table or an object.
    fn record(&mut self, name: &str, handle: &str, owner: &str) -> &mut Self {
        self.group(0, name).group(5, handle).group(330, owner)
    }

    fn table(&mut self, name: &str, handle: &str, entries: usize) -> &mut Self {
        self.group(0, "TABLE").group(2, name).group(5, handle).group(330, 0).group(100, "AcDbSymbolTable");
        self.group(70, entries)
    }

    fn named(&mut self, class: &str, name: &str) -> &mut Self {
        self.group(100, "AcDbSymbolTableRecord").group(100, class).group(2, name).group(70, 0)
    }

    fn end_of_table(&mut self) {
        self.group(0, "ENDTAB");
    }
}

/// A whole file: what was drawn, in its frame. `high` is the upper right corner.
pub(super) fn file(drawn: &Writer, unit: SvgUnit, high: [f64; 2]) -> String {
    let mut out = Writer::new(drawn.decimals);
    out.group(0, "SECTION").group(2, "HEADER").group(9, "$ACADVER").group(1, "AC1015");
    out.group(9, "$DWGCODEPAGE").group(3, "ANSI_1252");
    out.group(9, "$HANDSEED").group(5, format!("{:X}", drawn.next_handle));
    let is_metric = u8::from(unit != SvgUnit::Inch);
    out.group(9, "$INSUNITS").group(70, insunits(unit)).group(9, "$MEASUREMENT").group(70, is_metric);
    out.group(9, "$EXTMIN").place(10, [0.0; 2]).number(30, 0.0).group(9, "$EXTMAX").place(10, high).number(30, 0.0);
    out.group(0, "ENDSEC").group(0, "SECTION").group(2, "CLASSES").group(0, "ENDSEC");
    out.group(0, "SECTION").group(2, "TABLES");
    tables(&mut out, unit, high);
    out.group(0, "ENDSEC").group(0, "SECTION").group(2, "BLOCKS");
    for (name, block, begin, end) in [("*Model_Space", MODEL_SPACE, "20", "21"), ("*Paper_Space", "1E", "22", "23")] {
        out.record("BLOCK", begin, block).group(100, "AcDbEntity").group(8, 0).group(100, "AcDbBlockBegin");
        out.group(2, name).group(70, 0).place(10, [0.0; 2]).number(30, 0.0).group(3, name).group(1, "");
        out.record("ENDBLK", end, block).group(100, "AcDbEntity").group(8, 0).group(100, "AcDbBlockEnd");
    }
    out.group(0, "ENDSEC").group(0, "SECTION").group(2, "ENTITIES");
    out.text.push_str(&drawn.text);
    out.group(0, "ENDSEC").group(0, "SECTION").group(2, "OBJECTS");
    out.record("DICTIONARY", "C", "0")
        .group(100, "AcDbDictionary")
        .group(281, 1)
        .group(3, "ACAD_GROUP")
        .group(350, "D");
    out.record("DICTIONARY", "D", "C").group(100, "AcDbDictionary").group(281, 1);
    out.group(0, "ENDSEC").group(0, "EOF");
    out.text
}

fn tables(out: &mut Writer, unit: SvgUnit, high: [f64; 2]) {
    let middle = high.map(|x| 0.5 * x);
    out.table("VPORT", "8", 1).record("VPORT", "2E", "8").named("AcDbViewportTableRecord", "*ACTIVE");
    out.place(10, [0.0; 2]).place(11, [1.0; 2]).place(12, middle).number(40, high[1].max(1.0));
    out.number(41, (high[0] / high[1].max(f64::MIN_POSITIVE)).clamp(0.1, 10.0)).end_of_table();
    out.table("LTYPE", "5", 3 + LINETYPES.len());
    for (handle, name) in [("14", "ByBlock"), ("15", "ByLayer"), ("18", "Continuous")] {
        out.record("LTYPE", handle, "5").named("AcDbLinetypeTableRecord", name);
        out.group(3, "").group(72, 65).group(73, 0).number(40, 0.0);
    }
    for (handle, name, says, strokes) in LINETYPES {
        let strokes: Vec<f64> = strokes.iter().map(|mm| mm / unit.millimetres()).collect();
        out.record("LTYPE", handle, "5").named("AcDbLinetypeTableRecord", name);
        out.group(3, says).group(72, 65).group(73, strokes.len());
        out.number(40, strokes.iter().map(|stroke| stroke.abs()).sum());
        for stroke in strokes {
            out.number(49, stroke).group(74, 0);
        }
    }
    out.end_of_table();
    out.table("LAYER", "2", LAYERS.len());
    for (handle, name, colour) in LAYERS {
        out.record("LAYER", handle, "2").named("AcDbLayerTableRecord", name).group(62, colour).group(6, "Continuous");
    }
    out.end_of_table();
    out.table("STYLE", "3", 1).record("STYLE", "19", "3").named("AcDbTextStyleTableRecord", "Standard");
    out.number(40, 0.0).number(41, 1.0).number(50, 0.0).group(71, 0).number(42, 2.5).group(3, "txt").group(4, "");
    out.end_of_table();
    out.table("VIEW", "6", 0).end_of_table();
    out.table("UCS", "7", 0).end_of_table();
    out.table("APPID", "9", 1).record("APPID", "1A", "9").named("AcDbRegAppTableRecord", "ACAD").end_of_table();
    out.table("DIMSTYLE", "A", 0).group(100, "AcDbDimStyleTable").group(71, 0).end_of_table();
    out.table("BLOCK_RECORD", "1", 2);
    for (handle, name) in [(MODEL_SPACE, "*Model_Space"), ("1E", "*Paper_Space")] {
        out.record("BLOCK_RECORD", handle, "1").group(100, "AcDbSymbolTableRecord");
        out.group(100, "AcDbBlockTableRecord").group(2, name);
    }
    out.end_of_table();
}

/// `$INSUNITS`.
const fn insunits(unit: SvgUnit) -> u8 {
    match unit {
        SvgUnit::Inch => 1,
        SvgUnit::Millimetre => 4,
        SvgUnit::Centimetre => 5,
    }
}

/// A number with at most so many digits after the point, and at least one.
fn decimal(x: f64, decimals: usize) -> String {
    let text = crate::svg::decimal(x, decimals);
    if text.contains('.') { text } else { format!("{text}.0") }
}
