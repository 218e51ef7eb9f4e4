//! The KKT matrix of a disk in both forms of the wheel condition: VMV04 fig. 2.

use crate::cli::args::SparsityArgs;
use crate::cli::targets::{check_distinct, check_extension};
use crate::record::Outcome;
use crate::record::failure::Failure;
use crate::record::number::count;
use crate::show::{console, files};
use abf::constraints::{ConstraintRows, Jacobian};
use abf::{FlattenError, KktCounts, WheelForm};
use abf_mesh::{CornerId, Topology, io};
use abf_report::{SparsityPanel, sparsity_png, sparsity_svg};

/// Checks the arguments.
///
/// # Errors
/// A usage error that names the option.
pub(crate) fn check(args: &SparsityArgs) -> Result<(), clap::Error> {
    let targets = [("--png", args.png.as_deref()), ("--svg", args.svg.as_deref())];
    for (option, path) in targets {
        path.map_or(Ok(()), |path| check_extension(option, path, &[&option[2..]]))?;
    }
    check_distinct(&targets, std::slice::from_ref(&args.mesh))
}

/// Counts and draws the entries.
pub(crate) fn show(args: &SparsityArgs) -> Outcome {
    match draw(args) {
        Ok(()) => Outcome::AsAsked,
        Err(failure) => {
            console::failure(&failure);
            Outcome::Failed
        }
    }
}

fn draw(args: &SparsityArgs) -> Result<(), Failure> {
    files::check([args.png.as_deref(), args.svg.as_deref()])?;
    let mesh = io::read(&args.mesh).map_err(|error| Failure::read(&error))?.mesh;
    let name = args.mesh.display().to_string();
    let refused = |error: FlattenError| Failure::flatten(&name, &error, false);
    let topology = Topology::build(mesh.vertex_count(), mesh.faces()).map_err(|error| refused(error.into()))?;
    topology.require_disk().map_err(|error| refused(error.into()))?;
    let rows = ConstraintRows::new(&topology);
    let forms = [WheelForm::Product, WheelForm::Log];
    let patterns = forms.map(|form| Pattern::of(form, &topology, &rows));
    let size = topology.corner_count() + rows.len();
    let triangles = topology.face_count();
    console::data(&format!("{name}: {}, {size} unknowns\n", count(triangles, "triangle", "triangles")))?;
    for (form, pattern) in forms.iter().zip(&patterns) {
        let per_triangle = pattern.count as f64 / triangles as f64;
        console::data(&format!("{form:<8} {:>10} nonzeros, {per_triangle:.1} per triangle\n", pattern.count))?;
    }
    let titles = forms.map(|form| format!("{form} wheel"));
    let panels = [0, 1].map(|k| {
        let Pattern { count, entries, blocks } = &patterns[k];
        SparsityPanel { title: &titles[k], size, count: *count, entries, blocks }
    });
    if let Some(path) = &args.png {
        let png = sparsity_png(&panels).map_err(|error| Failure::picture(path, &error))?;
        files::replace(path, &png)?;
    }
    args.svg.as_ref().map_or(Ok(()), |path| files::replace(path, sparsity_svg(&panels).as_bytes()))
}

/// The entries of `[∇²L Jᵀ; J 0]` that are not zero by construction.
struct Pattern {
    count: usize,
    /// Row and column of the diagonal's and the Jacobian's, each once.
    entries: Vec<[u32; 2]>,
    /// The product form couples the `next` corners of every ring with each other, and so the `prev` corners. A vertex of
    /// valence d has 2d² such entries, which are not listed: d may be a hundred thousand.
    blocks: Vec<Vec<u32>>,
}

impl Pattern {
    fn of(form: WheelForm, topology: &Topology, rows: &ConstraintRows) -> Self {
        let corners = topology.corner_count() as u32;
        let mut entries: Vec<[u32; 2]> = (0..corners).map(|c| [c, c]).collect();
        for (_, (row, column)) in &Jacobian::new(topology, rows).view() {
            entries.extend([[corners + row, column], [column, corners + row]]);
        }
        let ring = |v, side: fn(CornerId) -> CornerId| topology.fan(v).map(|c| side(c).index() as u32).collect();
        let blocks = match form {
            WheelForm::Log => Vec::new(),
            WheelForm::Product => {
                let sides: [fn(CornerId) -> CornerId; 2] = [CornerId::next, CornerId::prev];
                rows.interior().iter().flat_map(|&v| sides.map(|side| ring(v, side))).collect()
            }
        };
        Self { count: KktCounts::of(form, rows).nonzeros, entries, blocks }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::{Point3, TriMesh};
    use std::collections::BTreeSet;

    fn pattern(mesh: &TriMesh, form: WheelForm) -> Pattern {
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        Pattern::of(form, &topology, &ConstraintRows::new(&topology))
    }

    #[test]
    fn the_pattern_is_symmetric_and_has_as_many_entries_as_a_flattening_counts() {
        let mesh = abf_shapes::Shape::BumpySheet.mesh(200);
        for form in [WheelForm::Log, WheelForm::Product] {
            let Pattern { count, entries, blocks } = pattern(&mesh, form);
            let dense = blocks.iter().flat_map(|block| block.iter().flat_map(|&a| block.iter().map(move |&b| [a, b])));
            let all: BTreeSet<[u32; 2]> = entries.into_iter().chain(dense).collect();
            assert!(all.iter().all(|&[row, column]| all.contains(&[column, row])), "{form}");
            assert_eq!(all.len(), count, "{form}");
        }
        let counted = abf::flatten(&mesh).expect("a disk").kkt.map(|counts| counts.nonzeros);
        let [log, product] = [WheelForm::Log, WheelForm::Product].map(|form| pattern(&mesh, form).count);
        assert!(product > log);
        assert_eq!(counted, [log, product]);
    }

    #[test]
    fn a_wheel_of_large_valence_takes_no_list_of_its_valence_squared() {
        let valence = 100_000;
        let points = vec![Point3::origin(); valence + 1];
        let faces: Vec<[usize; 3]> = (0..valence).map(|k| [valence, k, (k + 1) % valence]).collect();
        let wheel = pattern(&TriMesh::new(points, &faces).expect("indices in range"), WheelForm::Product);
        assert!(wheel.count > 2 * valence * (valence - 1));
        assert!(wheel.entries.len() + wheel.blocks.iter().map(Vec::len).sum::<usize>() < 30 * valence);
    }
}
