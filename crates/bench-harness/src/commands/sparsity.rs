//! The KKT matrix of a disk in both forms of the wheel condition: VMV04 fig. 2.

use crate::cli::args::SparsityArgs;
use crate::cli::targets::{check_distinct, check_extension};
use crate::record::Outcome;
use crate::record::failure::Failure;
use crate::record::number::count;
use crate::show::{console, files};
use abf::constraints::{ConstraintRows, Jacobian};
use abf::{FlattenError, WheelForm};
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
    let patterns = forms.map(|form| kkt_pattern(form, &topology, &rows));
    let size = topology.corner_count() + rows.len();
    let triangles = topology.face_count();
    console::data(&format!("{name}: {}, {size} unknowns\n", count(triangles, "triangle", "triangles")))?;
    for (form, entries) in forms.iter().zip(&patterns) {
        let per_triangle = entries.len() as f64 / triangles as f64;
        console::data(&format!("{form:<8} {:>10} nonzeros, {per_triangle:.1} per triangle\n", entries.len()))?;
    }
    let titles = forms.map(|form| format!("{form} wheel"));
    let panels = [0, 1].map(|k| SparsityPanel { title: &titles[k], size, entries: &patterns[k] });
    if let Some(path) = &args.png {
        let png = sparsity_png(&panels).map_err(|error| Failure::picture(path, &error))?;
        files::replace(path, &png)?;
    }
    args.svg.as_ref().map_or(Ok(()), |path| files::replace(path, sparsity_svg(&panels).as_bytes()))
}

/// Row and column of every entry of `[∇²L Jᵀ; J 0]` that is not zero by construction, sorted, each once.
fn kkt_pattern(form: WheelForm, topology: &Topology, rows: &ConstraintRows) -> Vec<[u32; 2]> {
    let corners = topology.corner_count() as u32;
    let mut entries: Vec<[u32; 2]> = (0..corners).map(|c| [c, c]).collect();
    for (_, (row, column)) in &Jacobian::new(topology, rows).view() {
        entries.extend([[corners + row, column], [column, corners + row]]);
    }
    if form == WheelForm::Product {
        for &v in rows.interior() {
            for side in [CornerId::next, CornerId::prev] {
                let ring: Vec<u32> = topology.fan(v).map(|c| side(c).index() as u32).collect();
                entries.extend(ring.iter().flat_map(|&a| ring.iter().map(move |&b| [a, b])));
            }
        }
    }
    entries.sort_unstable();
    entries.dedup();
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pattern_is_symmetric_and_has_as_many_entries_as_a_flattening_counts() {
        let mesh = abf_shapes::Shape::BumpySheet.mesh(200);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let rows = ConstraintRows::new(&topology);
        let counted = abf::flatten(&mesh).expect("a disk").kkt.map(|counts| counts.nonzeros);
        let patterns = [WheelForm::Log, WheelForm::Product].map(|form| kkt_pattern(form, &topology, &rows));
        let mut lengths = patterns.each_ref().map(Vec::len);
        lengths.sort_unstable();
        let mut counted = counted;
        counted.sort_unstable();
        assert_eq!(lengths, counted);
        for entries in &patterns {
            assert!(entries.iter().all(|&[row, column]| entries.binary_search(&[column, row]).is_ok()));
        }
    }
}
