//! Reading and writing a million triangles: megabytes per second beside `tobj`, and what a flattening
//! costs from file to file compared with from mesh to UVs.

mod support;

use abf::mesh::io::{MeshFormat, parse, read, write, write_obj, write_ply};
use abf::mesh::{Topology, TriMesh};
use abf::{Flattening, Silent};
use abf_shapes::Shape;
use std::hint::black_box;
use support::{Table, once, seconds};

/// About how many triangles the round bumpy disk gets.
const TRIANGLES: usize = 1_000_000;
/// The least of so many runs counts: what else the machine does only adds.
const RUNS: usize = 5;

fn main() {
    let mesh = Shape::FatDisk.mesh(TRIANGLES);
    // This also warms up: the factorisations reserve scratch memory once per process.
    let flat = flatten(&mesh);
    let (mut plain, mut with_uvs) = (Vec::new(), Vec::new());
    write_obj(&mut plain, &mesh, None).expect("memory is writable");
    write_obj(&mut with_uvs, &mesh, Some(&flat.uv)).expect("memory is writable");

    let mut speeds = Table::new(
        "io",
        "Reading and writing a million triangles in memory, least of 5",
        &["what", "MB", "seconds", "MB/s"],
    );
    let mut row = |what: &str, bytes: usize, time: f64| {
        let megabytes = bytes as f64 * 1e-6;
        let (size, speed) = (format!("{megabytes:.1}"), format!("{:.0}", megabytes / time));
        speeds.push(vec![what.to_owned(), size, seconds(time), speed]);
    };
    for (what, bytes) in [("", &plain), (" with UVs", &with_uvs)] {
        row(&format!("read OBJ{what}"), bytes.len(), least(|| parse(MeshFormat::Obj, "bench", black_box(bytes))));
        // A comment behind a face makes it a file for the careful reader.
        let odd = [bytes, b"f 1 2 3 # odd\n".as_slice()].concat();
        row(&format!("read odd OBJ{what}"), odd.len(), least(|| parse(MeshFormat::Obj, "bench", black_box(&odd))));
        row(&format!("read OBJ{what}, tobj"), bytes.len(), least(|| by_tobj(black_box(bytes))));
    }
    for (what, bytes, uv) in [("", &plain, None), (" with UVs", &with_uvs, Some(&flat.uv))] {
        let mut out = Vec::with_capacity(bytes.len());
        let time = least(|| {
            out.clear();
            write_obj(&mut out, black_box(&mesh), uv)
        });
        row(&format!("write OBJ{what}"), bytes.len(), time);
        let time = least(|| {
            out.clear();
            write_ply(&mut out, black_box(&mesh), uv)
        });
        row(&format!("write PLY{what}"), out.len(), time);
    }
    speeds.finish();
    file_to_file(&mesh, &plain);
}

/// What reading, judging and writing add to a flattening.
fn file_to_file(mesh: &TriMesh, obj: &[u8]) {
    /// A flattening takes seconds.
    const RUNS: usize = 3;
    let folder = tempfile::tempdir().expect("a folder");
    let (input, output) = (folder.path().join("in.obj"), folder.path().join("out.obj"));
    std::fs::write(&input, obj).expect("a writable folder");
    let mut stages = [f64::INFINITY; 4];
    for _ in 0..RUNS {
        let (read, file) = once(|| read(&input).expect("a readable file"));
        let (to_uvs, flat) = once(|| flatten(&file.mesh));
        let (judge, _) = once(|| flat.metrics(&file.mesh).expect("metrics"));
        let (write, ()) = once(|| write(&output, &file.mesh, Some(&flat.uv)).expect("written"));
        for (least, time) in stages.iter_mut().zip([to_uvs, read, judge, write]) {
            *least = time.min(*least);
        }
    }
    let topology = least(|| Topology::build(mesh.vertex_count(), black_box(mesh.faces())));
    let [to_uvs, read, judge, write] = stages;
    let total: f64 = stages.iter().sum();
    let mut table = Table::new(
        "file_to_file",
        "A million triangles from file to file, least of 3 stage by stage",
        &["mesh to UVs", "of that corner table", "read", "metrics", "write", "file to file", "ratio"],
    );
    let times = [to_uvs, topology, read, judge, write, total].map(seconds);
    table.push(times.into_iter().chain([format!("{:.3}", total / to_uvs)]).collect());
    table.finish();
}

fn flatten(mesh: &TriMesh) -> Flattening {
    support::linabf().run(mesh, &mut Silent).expect("a flattening")
}

fn by_tobj(bytes: &[u8]) -> tobj::LoadResult {
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    tobj::load_obj_buf(&mut &bytes[..], &tobj::LoadOptions::default(), no_materials)
}

/// The least seconds of several runs.
fn least<T>(mut run: impl FnMut() -> T) -> f64 {
    (0..RUNS).map(|_| once(&mut run).0).fold(f64::INFINITY, f64::min)
}
