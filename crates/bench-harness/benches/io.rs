//! Reading and writing a million triangles: megabytes per second beside `tobj`, and what a flattening
//! costs from file to file compared with from mesh to UVs.

mod support;

use abf::mesh::io::{MeshFormat, parse, read, write, write_obj, write_ply};
use abf::mesh::{Topology, TriMesh};
use abf::{Flattening, Silent};
use abf_shapes::Shape;
use cpu_time::ProcessTime;
use std::hint::black_box;
use support::{Table, Timed, once, seconds};

/// About how many triangles the round bumpy disk gets.
const TRIANGLES: usize = 1_000_000;
/// The least of so many runs counts: what else the machine does only adds.
const RUNS: usize = 7;

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
    file_to_file(&plain);
}

/// What reading, judging and writing add to a flattening, on one thread in processor time and on all in time of the
/// clock. A flattening is what the library gives: certified UVs.
fn file_to_file(obj: &[u8]) {
    let folder = tempfile::tempdir().expect("a folder");
    let (input, output) = (folder.path().join("in.obj"), folder.path().join("out.obj"));
    std::fs::write(&input, obj).expect("a writable folder");
    let mut table = Table::new(
        "file_to_file",
        "A million triangles from file to file, median of 7 and its standard deviation, stage by stage",
        &[
            "threads",
            "seconds of",
            "mesh to UVs",
            "of that corner table",
            "read",
            "metrics",
            "write",
            "file to file",
            "ratio",
        ],
    );
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut measure = |threads: usize, of: &str, timed: fn(&mut dyn FnMut()) -> f64| {
        let mut stages = [const { Vec::new() }; 5];
        for _ in 0..RUNS {
            let (mut file, mut flat) = (None, None);
            let read = timed(&mut || file = Some(read(&input).expect("a readable file")));
            let mesh = file.expect("read").mesh;
            let to_uvs = timed(&mut || flat = Some(rayon::scope(|_| flatten(&mesh))));
            let flat = flat.expect("flattened");
            let judge = timed(&mut || drop(flat.metrics(&mesh).expect("metrics")));
            let write = timed(&mut || write(&output, &mesh, Some(&flat.uv)).expect("written"));
            let topology = timed(&mut || drop(Topology::build(mesh.vertex_count(), black_box(mesh.faces()))));
            stages.iter_mut().zip([to_uvs, topology, read, judge, write]).for_each(|(all, time)| all.push(time));
        }
        let stages = stages.map(Timed::of);
        let [to_uvs, _, read, judge, write] = stages.map(|stage| stage.median);
        let total = to_uvs + read + judge + write;
        let head = [threads.to_string(), of.to_owned()];
        let ends = [seconds(total), format!("{:.3}", total / to_uvs)];
        table.push(head.into_iter().chain(stages.map(Timed::shown)).chain(ends).collect());
    };
    one_thread.install(|| measure(1, "the processor", processor_seconds));
    one_thread.install(|| measure(1, "the clock", clock_seconds));
    measure(rayon::current_num_threads(), "the clock", clock_seconds);
    table.finish();
}

fn processor_seconds(run: &mut dyn FnMut()) -> f64 {
    let begin = ProcessTime::now();
    run();
    begin.elapsed().as_secs_f64()
}

fn clock_seconds(run: &mut dyn FnMut()) -> f64 {
    once(run).0
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
