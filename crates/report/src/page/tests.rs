use super::*;
use abf_mesh::Point2;
use abf_shapes::Shape;

/// The name of a mesh, a solver, and a failure that would do harm if they were taken for markup.
const EVIL: &str = "<script>alert(\"1\")</script>&'\0";

/// The projection along z as a layout.
fn projected(mesh: &TriMesh) -> UvMap {
    let uv: Vec<_> = mesh.positions().iter().map(|p| Point2::new(p.x, p.y)).collect();
    UvMap::per_vertex(mesh, &uv)
}

fn number(value: f64) -> Cell {
    Cell::Number { value, shown: format!("{value} s") }
}

/// A run with a layout, one with a failure and one with figures only.
fn runs(uv: &UvMap) -> Vec<SolverRun<'_>> {
    let columns = vec![("time".to_owned(), number(1.5)), (EVIL.to_owned(), Cell::Text(EVIL.to_owned()))];
    let outer = vec![(0.0, 1.0), (1.0, 1e-4), (2.0, 0.0), (3.0, f64::NAN)];
    vec![
        SolverRun {
            solver: "linabf",
            uv: Some(uv),
            columns,
            outer,
            settings: vec![(EVIL.to_owned(), EVIL.to_owned())],
            ..SolverRun::default()
        },
        SolverRun { solver: EVIL, failure: Some(EVIL.to_owned()), inner: vec![1.0; 1000], ..SolverRun::default() },
        SolverRun {
            solver: "linabf",
            columns: vec![("time".to_owned(), number(f64::INFINITY))],
            ..SolverRun::default()
        },
    ]
}

fn page(triangles: usize) -> String {
    let mesh = Shape::BumpySheet.mesh(triangles);
    let uv = projected(&mesh);
    let section = MeshSection { name: EVIL, mesh: Some(&mesh), runs: runs(&uv), ..MeshSection::default() };
    let unseen = MeshSection { name: "plain", mesh: None, runs: runs(&uv), ..MeshSection::default() };
    let machine = vec![("processor".to_owned(), EVIL.to_owned())];
    render(&Page { title: EVIL, machine, meshes: vec![section, unseen] })
}

/// Every tag of the page but for what is inside of style and script, without its angle brackets.
fn tags(html: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = html;
    while let Some(start) = rest.find('<') {
        let inside = &rest[start + 1..];
        let mut quoted = false;
        let end = inside.find(|c| {
            quoted ^= c == '"';
            c == '>' && !quoted
        });
        let end = end.expect("every tag ends");
        found.push(&inside[..end]);
        rest = &inside[end + 1..];
        for raw in ["style", "script"] {
            if inside[..end] == *raw {
                rest = &rest[rest.find(&format!("</{raw}")).expect("it is closed")..];
            }
        }
    }
    found
}

/// The values of an attribute wherever it occurs.
fn values<'a>(tags: &[&'a str], attribute: &str) -> Vec<&'a str> {
    let marker = format!(" {attribute}=\"");
    tags.iter().filter_map(|tag| tag.split(marker.as_str()).nth(1)).filter_map(|rest| rest.split('"').next()).collect()
}

#[test]
fn every_tag_is_closed_in_order() {
    const VOID: [&str; 3] = ["meta", "link", "img"];
    let html = page(200);
    let mut open = Vec::new();
    for tag in tags(&html) {
        let name = tag.split_whitespace().next().expect("a name");
        if let Some(closed) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed));
        } else if !name.starts_with('!') && !tag.ends_with('/') && !VOID.contains(&name) {
            open.push(name);
        }
    }
    assert_eq!(open, [""; 0]);
}

#[test]
fn text_from_outside_is_never_markup() {
    let html = page(200);
    assert!(!html.contains("<script>alert") && !html.contains('\0'));
    assert_eq!(html.matches("<script").count(), 1);
    assert!(html.contains("<h1>&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt;&amp;&#39;\u{fffd}</h1>"));
}

#[test]
fn nothing_is_loaded_from_anywhere() {
    let html = page(200);
    for address in ["http:", "https:", "//www", "url(", "@import", "fetch("] {
        assert!(!html.contains(address), "{address}");
    }
    let tags = tags(&html);
    let (sources, links) = (values(&tags, "src"), values(&tags, "href"));
    assert!(sources.len() > 2 && sources.iter().all(|s| s.starts_with("data:image/png;base64,")));
    assert!(links.len() > 4 && links.iter().all(|s| s.starts_with('#') || *s == "data:,"), "{links:?}");
}

#[test]
fn every_id_is_there_once_and_every_link_leads_to_one() {
    let html = page(200);
    let tags = tags(&html);
    let ids = values(&tags, "id");
    let distinct: std::collections::BTreeSet<_> = ids.iter().collect();
    assert_eq!(distinct.len(), ids.len());
    for link in values(&tags, "href").iter().filter_map(|link| link.strip_prefix('#')) {
        assert!(distinct.contains(&link), "{link}");
    }
}

#[test]
fn every_run_has_a_row_and_a_failure_says_why() {
    let html = page(200);
    for mesh in [1, 2] {
        for run in [1, 2, 3] {
            assert_eq!(html.matches(&format!("<tr id=\"mesh-{mesh}-run-{run}\"")).count(), 1);
            assert!(html.contains(&format!("href=\"#mesh-{mesh}-run-{run}\"")));
        }
    }
    assert!(html.contains("class=\"reason\">failed: &lt;script&gt;alert"));
    assert!(html.contains("linabf (2)"));
    assert!(html.contains("data-number=\"Infinity\">inf s"));
}

#[test]
fn pictures_and_charts_say_their_numbers() {
    let html = page(200);
    let tags = tags(&html);
    let alts = values(&tags, "alt");
    assert_eq!(alts.len(), 3);
    assert!(alts[0].contains("with the same checkerboard: valid, F/3nt"), "{}", alts[0]);
    assert!(alts[1].contains("median") && alts[2].contains("L2 stretch"));
    let charts: Vec<_> = tags.iter().filter(|tag| tag.starts_with("svg class=\"chart\"")).copied().collect();
    let labels = values(&charts, "aria-label");
    // Outer, inner and histogram of the first mesh; the second one has no layout to count.
    assert_eq!(labels.len(), 5);
    assert!(labels[0].contains("last residual and outer iteration: linabf 0 after 2"), "{}", labels[0]);
    assert!(labels[2].contains("half are below"), "{}", labels[2]);
}

#[test]
fn tables_have_captions_and_heads_with_a_scope() {
    let html = page(200);
    let tags = tags(&html);
    let count = |name: &str| tags.iter().filter(|tag| **tag == name).count();
    assert_eq!(count("caption"), count("/table"));
    assert!(tags.iter().filter(|tag| tag.starts_with("th ") || **tag == "th").all(|tag| tag.contains("scope=")));
    assert_eq!((count("h1"), count("html lang=\"en\"")), (1, 1));
}

#[test]
fn a_layout_of_another_mesh_is_a_failure_and_not_a_panic() {
    let mesh = Shape::BumpySheet.mesh(200);
    let uv = projected(&Shape::BumpySheet.mesh(50));
    let html =
        MeshFragment::render(&MeshSection { name: "x", mesh: Some(&mesh), runs: runs(&uv), ..MeshSection::default() })
            .html;
    assert!(html.contains("failed: the layout cannot be judged: the UV map has"));
    assert!(html.contains("No layout is at hand."));
}

#[test]
fn a_page_without_meshes_is_a_page() {
    let html = render(&Page::default());
    assert!(html.contains("<h2 id=\"summary-name\">") && html.ends_with("</html>\n"));
}

#[test]
fn parts_make_the_same_page_as_the_whole_and_so_does_a_second_time() {
    let mesh = Shape::Hemisphere.mesh(300);
    let uv = projected(&mesh);
    let section = || MeshSection { name: "half", mesh: Some(&mesh), runs: runs(&uv), ..MeshSection::default() };
    let whole = render(&Page { title: "t", machine: Vec::new(), meshes: vec![section(), section()] });
    assert_eq!(whole, assemble("t", &[], &[MeshFragment::render(&section()), MeshFragment::render(&section())]));
}

#[test]
fn eight_runs_on_twenty_thousand_triangles_take_little_room() {
    const LIMIT: usize = 1_200_000;
    let mesh = Shape::SpikyField.mesh(20_000);
    let uv = projected(&mesh);
    let runs = (0..8).map(|_| SolverRun { solver: "linabf", uv: Some(&uv), ..SolverRun::default() }).collect();
    let fragment =
        MeshFragment::render(&MeshSection { name: "spikes", mesh: Some(&mesh), runs, ..MeshSection::default() });
    assert!(fragment.bytes() < LIMIT, "{} bytes", fragment.bytes());
}

/// The colours that the style sheet names, of the light or the dark scheme.
fn colours(scheme: usize) -> std::collections::BTreeMap<&'static str, [u8; 3]> {
    let block = CSS.split(":root {").nth(1 + scheme).and_then(|rest| rest.split('}').next()).expect("a block");
    let byte = |hex: &str, k: usize| u8::from_str_radix(&hex[2 * k..2 * k + 2], 16).expect("two hexadecimal digits");
    let colour = |line: &'static str| {
        let (name, hex) = line.trim().strip_prefix("--")?.split_once(": #")?;
        Some((name, [0, 1, 2].map(|k| byte(hex, k))))
    };
    block.lines().filter_map(colour).collect()
}

/// The contrast ratio of the Web Content Accessibility Guidelines 2.1.
fn contrast(a: [u8; 3], b: [u8; 3]) -> f64 {
    let luminance = |bytes: [u8; 3]| {
        let linear = bytes.map(|byte| {
            let x = f64::from(byte) / 255.0;
            if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2] + 0.05
    };
    let (a, b) = (luminance(a), luminance(b));
    a.max(b) / a.min(b)
}

#[test]
fn text_stands_out_in_either_scheme() {
    const ENOUGH: f64 = 4.5;
    for scheme in [0, 1] {
        let colours = colours(scheme);
        let mut pairs = vec![("good-text", "good"), ("warn-text", "warn"), ("text", "good"), ("bad-text", "page")];
        for text in ["text", "soft", "link", "bad-text", "warn-text", "s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7"] {
            pairs.extend([(text, "page"), (text, "card")]);
        }
        for (text, ground) in pairs {
            let ratio = contrast(colours[text], colours[ground]);
            assert!(ratio >= ENOUGH, "{text} on {ground} of scheme {scheme}: {ratio:.2}");
        }
    }
}

#[test]
fn energies_of_other_names_are_not_drawn_together_and_residuals_are_drawn_against_time() {
    let curve = vec![(0.0, 1.0), (0.25, 0.5)];
    let run = |solver, energy: &str| SolverRun {
        solver,
        timed: curve.clone(),
        energies: vec![(energy.to_owned(), curve.clone())],
        ..SolverRun::default()
    };
    let runs = vec![run("descent", "abf"), run("barrier", "abf"), run("relaxed", "isometric")];
    let html = MeshFragment::render(&MeshSection { name: "x", runs, ..MeshSection::default() }).html;
    let lines = |heading: &str| {
        let figure = html.split("<figure>").find(|figure| figure.contains(&format!("<p>{heading}:"))).expect(heading);
        figure.matches("class=\"line\"").count() / 2
    };
    assert_eq!([lines("Against time"), lines("The energy abf"), lines("The energy isometric")], [3, 2, 1]);
    assert!(html.contains("descent: 0.50 after 0.250 s"), "{html}");
}

#[test]
fn a_tie_for_the_lowest_f_is_named_in_full() {
    let mesh = Shape::BumpySheet.mesh(200);
    let uv = projected(&mesh);
    let run = |solver| SolverRun { solver, uv: Some(&uv), ..SolverRun::default() };
    let runs = vec![run("abf"), run("abf++")];
    let html = MeshFragment::render(&MeshSection { name: "x", mesh: Some(&mesh), runs, ..MeshSection::default() }).html;
    assert!(html.contains("the same to 4 digits: <strong>abf</strong>, <strong>abf++</strong>"), "{html}");
    assert_eq!(html.matches("lowest F</span>").count(), 2);
}
