//! The charts of a page as drawings of their own, for papers and slides.

use crate::page::{CSS, Figure, MeshSection, PLOT_CSS, figures};

/// A chart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plot {
    /// What it shows, as a part of a file's name: `outer`, `time`, `inner`, `energy-NAME` or `histogram`.
    pub name: String,
    /// The drawing: an SVG document that needs nothing else.
    pub svg: String,
}

/// The charts of a section of a page, in its order; none of those that have nothing to show.
#[must_use]
pub fn plots(section: &MeshSection<'_>) -> Vec<Plot> {
    let style = light_style();
    figures(section).iter().map(|figure| plot(figure, &style)).collect()
}

fn plot(figure: &Figure, style: &str) -> Plot {
    let [width, height] = crate::page::CHART_SIZE;
    let opened = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" class=\"chart\" font-family=\"sans-serif\""
    );
    let chart = figure.chart.replacen("<svg class=\"chart\"", &opened, 1);
    let inside = format!("<style>\n{style}</style>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n");
    let svg = match chart.split_once(">\n") {
        Some((head, rest)) => format!("{head}>\n{inside}{rest}"),
        None => chart,
    };
    Plot { name: figure.name.clone(), svg }
}

/// The style of charts with the light colours of the page in the place of their names, which few programs but browsers know.
fn light_style() -> String {
    let colours = CSS.split_once(":root {").and_then(|(_, rest)| rest.split_once('}')).map_or("", |(inside, _)| inside);
    let named = colours.lines().filter_map(|line| line.trim().strip_suffix(';')?.split_once(": "));
    let named = named.filter(|(name, _)| name.starts_with("--"));
    named.fold(PLOT_CSS.to_owned(), |style, (name, value)| style.replace(&format!("var({name})"), value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::SolverRun;
    use abf_mesh::{Point2, UvMap};
    use abf_shapes::Shape;

    #[test]
    fn every_chart_is_a_document_of_its_own_that_names_no_colour_of_the_page() {
        let mesh = Shape::BumpySheet.mesh(200);
        let uv: Vec<_> = mesh.positions().iter().map(|p| Point2::new(p.x, p.y)).collect();
        let uv = UvMap::per_vertex(&mesh, &uv);
        let run = SolverRun {
            solver: "<uzawa>",
            uv: Some(&uv),
            outer: vec![(0.0, 1.0), (1.0, 1e-3)],
            inner: vec![1.0, 0.1],
            timed: vec![(0.0, 1.0), (0.5, 1e-3)],
            energies: vec![("abf + barrier".to_owned(), vec![(0.0, 2.0), (0.5, 1.0)])],
            ..SolverRun::default()
        };
        let section = MeshSection { name: "a & b", mesh: Some(&mesh), runs: vec![run], ..MeshSection::default() };
        let plots = plots(&section);
        let names: Vec<&str> = plots.iter().map(|plot| plot.name.as_str()).collect();
        assert_eq!(names, ["outer", "time", "inner", "energy-abf-barrier", "histogram"]);
        for Plot { name, svg } in &plots {
            let document = roxmltree::Document::parse(svg).unwrap_or_else(|error| panic!("{name}: {error}"));
            let root = document.root_element();
            assert_eq!(root.tag_name().namespace(), Some("http://www.w3.org/2000/svg"), "{name}");
            assert!(root.attribute("aria-label").is_some_and(|label| label.contains("a & b")), "{name}");
            assert!(!svg.contains("var(") && svg.contains(".axis"), "{name}");
        }
    }
}
