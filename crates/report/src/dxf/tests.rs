use super::*;
use abf_mesh::Point3;

/// Faces over points of the plane, which are their own layout.
fn flat(points: &[[f64; 2]], faces: &[[usize; 3]]) -> (TriMesh, UvMap) {
    let uv: Vec<Point2<f64>> = points.iter().map(|&p| Point2::from(p)).collect();
    let positions = uv.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
    let mesh = TriMesh::new(positions, faces).expect("indices in range");
    let uv = UvMap::per_vertex(&mesh, &uv);
    (mesh, uv)
}

/// The groups of a file.
fn groups(text: &str) -> Vec<(u16, &str)> {
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len() % 2, 0);
    lines.chunks(2).map(|pair| (pair[0].parse().expect("a code"), pair[1])).collect()
}

#[test]
fn every_handle_is_there_once_and_below_the_seed() {
    let (mesh, uv) = flat(&[[0.0, 0.0], [20.0, 0.0], [20.0, 10.0], [0.0, 10.0]], &[[0, 1, 2], [0, 2, 3]]);
    let text = layout_dxf(&mesh, &uv, Some(&[0, 0]), &DxfStyle::default()).expect("a layout");
    let groups = groups(&text);
    let at = groups.iter().position(|group| *group == (9, "$HANDSEED")).expect("a seed");
    let number = |text: &str| u32::from_str_radix(text, 16).expect("a handle");
    let mut handles: Vec<u32> =
        groups[at + 2..].iter().filter(|(code, _)| *code == 5).map(|(_, handle)| number(handle)).collect();
    assert!(handles.iter().all(|&handle| handle < number(groups[at + 1].1)));
    let all = handles.len();
    handles.sort_unstable();
    handles.dedup();
    assert_eq!(handles.len(), all);
    assert_eq!(groups.last(), Some(&(0, "EOF")));
}

#[test]
fn a_cut_is_a_closed_polyline_in_the_unit_that_is_said() {
    let (mesh, uv) = flat(&[[1.0, 1.0], [3.0, 1.0], [3.0, 2.0], [1.0, 2.0]], &[[0, 1, 2], [0, 2, 3]]);
    for (unit, code, side) in
        [(SvgUnit::Millimetre, "4", "50.8"), (SvgUnit::Centimetre, "5", "5.08"), (SvgUnit::Inch, "1", "2.0")]
    {
        let style = DxfStyle { unit, mm_per_uv: 25.4, ..DxfStyle::default() };
        let text = layout_dxf(&mesh, &uv, None, &style).expect("a layout");
        assert!(text.contains(&format!("$INSUNITS\n70\n{code}\n")), "{text}");
        assert!(text.contains(&format!("LWPOLYLINE\n5\n100\n330\n1F\n100\nAcDbEntity\n8\nCUT\n100\nAcDbPolyline\n90\n4\n70\n1\n10\n0.0\n20\n0.0\n10\n{side}\n20\n0.0\n")), "{text}");
        assert!(!text.contains("8\nLABEL\n") && !text.contains("8\nFOLD\n"));
    }
}

#[test]
fn charts_are_numbered_from_one_on_inside_of_them() {
    let (mesh, uv) =
        flat(&[[0.0, 0.0], [20.0, 0.0], [0.0, 20.0], [50.0, 0.0], [70.0, 0.0], [50.0, 20.0]], &[[0, 1, 2], [3, 4, 5]]);
    let text = layout_dxf(&mesh, &uv, Some(&[1, 0]), &DxfStyle::default()).expect("a layout");
    let texts: Vec<(f64, &str)> = text
        .split("\n0\nTEXT\n")
        .skip(1)
        .map(|entity| {
            let groups = groups(entity.split("\n0\n").next().unwrap_or_default());
            let of = |code| groups.iter().find(|group| group.0 == code).expect("a group").1;
            (of(10).parse().expect("a number"), of(1))
        })
        .collect();
    assert_eq!(texts.iter().map(|&(_, text)| text).collect::<Vec<_>>(), ["1", "2"]);
    assert!((50.0..70.0).contains(&texts[0].0) && (0.0..20.0).contains(&texts[1].0), "{texts:?}");
    let error = layout_dxf(&mesh, &uv, Some(&[0]), &DxfStyle::default()).unwrap_err();
    assert_eq!(error, PictureError::Charts { given: 1, faces: 2 });
}
