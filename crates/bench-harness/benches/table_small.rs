//! The small table of LinABF §6: one iteration of ABF++ against LinABF. The paper heads the columns of
//! the former "ABF".

mod support;

use abf::{AbfNewton, Pipeline, StopCriteria};
use support::{Model, Table, judge, least_squares, models, one_pass, or_dash, published, scientific};

fn main() {
    let mut table = Table::new(
        "table_small",
        "The small table of Linear Angle Based Parameterization: one iteration of ABF++ against LinABF, least squares",
        &[
            "model",
            "F ABF++ ×1",
            "paper's F ABF++ ×1",
            "L2 ABF++ ×1",
            "paper's L2 ABF++ ×1",
            "F LinABF",
            "paper's F LinABF",
            "L2 LinABF",
            "paper's L2 LinABF",
            "flips",
        ],
    );
    for Model { name, mesh } in models(&["horse", "dino"]) {
        let stop = StopCriteria { max_iterations: 1, ..StopCriteria::default() };
        let (_, one) = judge(&Pipeline { stop, ..least_squares(AbfNewton::abf_plus_plus()) }, &mesh);
        let (_, linabf) = judge(&one_pass(), &mesh);
        let stretch = |x: f64| format!("{x:.4}");
        let paper = |column: &str| published("LinABF 2007", "small table", &name, column);
        table.push(vec![
            name.clone(),
            scientific(one.f),
            or_dash(paper("F one iteration of ABF++"), scientific),
            stretch(one.stretch_l2),
            or_dash(paper("L2 one iteration of ABF++"), stretch),
            scientific(linabf.f),
            or_dash(paper("F LinABF"), scientific),
            stretch(linabf.stretch_l2),
            or_dash(paper("L2 LinABF"), stretch),
            format!("{} / {}", one.certificate.flips, linabf.certificate.flips),
        ]);
    }
    table.finish();
}
