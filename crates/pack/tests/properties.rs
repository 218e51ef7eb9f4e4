//! What holds of every packing: exact distances, nothing inside of something solid, the same bits on any number of threads.

use abf_pack::{Effort, PackError, PackSettings, Packing, Piece, pack};
use proptest::prelude::*;

type Point = [f64; 2];

/// A star-shaped loop: slivers and spikes where the radii are far apart.
fn star(radii: &[f64], size: Point, middle: Point) -> Vec<Point> {
    let angle = |i: usize| std::f64::consts::TAU * i as f64 / radii.len() as f64;
    let at =
        |(i, r): (usize, &f64)| [middle[0] + size[0] * r * angle(i).cos(), middle[1] + size[1] * r * angle(i).sin()];
    radii.iter().enumerate().map(at).collect()
}

fn any_piece() -> impl Strategy<Value = Piece> {
    let radii = prop::collection::vec(0.15..1.0_f64, 3..14);
    let shape = (radii, 0.001..3.0_f64, 0.2..3.0_f64, -5.0..5.0_f64, 0.0..0.9_f64, any::<bool>());
    shape.prop_map(|(radii, width, height, x, hole, keeps_its_angle)| {
        let outer = star(&radii, [width, height], [x, -x]);
        let least = radii.iter().copied().fold(1.0, f64::min);
        let mut loops = vec![outer];
        // A polygon with the smallest radius for its corners lies inside half of it at three corners.
        if hole > 0.3 {
            let inner = star(&[0.4 * least * hole; 5], [width, height], [x, -x]);
            loops.push(inner);
        }
        Piece { polygons: vec![loops], keeps_its_angle, group: 0 }
    })
}

fn loops(piece: &Piece, packing: &Packing, i: usize) -> Vec<Vec<Point>> {
    let moved = |ring: &Vec<Point>| ring.iter().map(|&p| packing.texel(i, p)).collect();
    piece.polygons.iter().flatten().map(moved).collect()
}

fn edges(loops: &[Vec<Point>]) -> Vec<[Point; 2]> {
    loops.iter().flat_map(|ring| (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]])).collect()
}

fn cross(o: Point, a: Point, b: Point) -> f64 {
    (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
}

fn to_segment(p: Point, [a, b]: [Point; 2]) -> f64 {
    let d = [b[0] - a[0], b[1] - a[1]];
    let squared = d[0] * d[0] + d[1] * d[1];
    let t = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / squared;
    let t = if squared > 0.0 { t.clamp(0.0, 1.0) } else { 0.0 };
    (p[0] - a[0] - t * d[0]).hypot(p[1] - a[1] - t * d[1])
}

fn between(s: [Point; 2], t: [Point; 2]) -> f64 {
    let apart = |[a, b]: [Point; 2], [c, d]: [Point; 2]| cross(a, b, c) * cross(a, b, d) >= 0.0;
    if !apart(s, t) && !apart(t, s) {
        return 0.0;
    }
    let ends = [to_segment(s[0], t), to_segment(s[1], t), to_segment(t[0], s), to_segment(t[1], s)];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

fn is_inside(p: Point, edges: &[[Point; 2]]) -> bool {
    let crossed = |[a, b]: &&[Point; 2]| {
        (a[1] <= p[1]) != (b[1] <= p[1]) && a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > p[0]
    };
    edges.iter().filter(crossed).count() % 2 == 1
}

/// Every distance, edge by edge.
fn check_margins(pieces: &[Piece], packing: &Packing, settings: &PackSettings) {
    let slack = 1e-9 * f64::from(settings.page[0].max(settings.page[1]));
    assert_eq!(packing.placements.len(), pieces.len(), "no piece is dropped");
    let all: Vec<Vec<[Point; 2]>> =
        pieces.iter().enumerate().map(|(i, piece)| edges(&loops(piece, packing, i))).collect();
    for (i, own) in all.iter().enumerate() {
        for p in own.iter().flatten() {
            for (x, side) in p.iter().zip(settings.page) {
                let kept = settings.margin - slack..=f64::from(side) - settings.margin + slack;
                assert!(kept.contains(x), "piece {i} at {p:?}");
            }
        }
        for (j, other) in all[..i].iter().enumerate() {
            if packing.placements[i].page != packing.placements[j].page {
                continue;
            }
            let nearest = own.iter().flat_map(|&s| other.iter().map(move |&t| between(s, t)));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest >= settings.margin - slack, "pieces {i} and {j} are {nearest} apart");
            assert!(!is_inside(own[0][0], other), "piece {i} is inside of the solid part of {j}");
            assert!(!is_inside(other[0][0], own), "piece {j} is inside of the solid part of {i}");
        }
    }
}

fn efforts() -> impl Strategy<Value = Effort> {
    prop::sample::select(vec![Effort::Fast, Effort::Good])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn margins_hold_exactly_for_any_polygons_with_holes(
        pieces in prop::collection::vec(any_piece(), 1..12),
        margin in prop::sample::select(vec![0.0, 1.0, 2.5, 20.0]),
        page in prop::sample::select(vec![[256, 256], [512, 256], [100, 333]]),
        pages in 1..3_usize,
        effort in efforts(),
    ) {
        let settings = PackSettings { page, margin, pages, effort, ..PackSettings::default() };
        let packing = pack(&pieces, &settings).expect("they fit");
        prop_assert!(packing.pages <= pages);
        prop_assert!(packing.coverage > 0.0 && packing.coverage < 1.0);
        check_margins(&pieces, &packing, &settings);
        for (piece, placement) in pieces.iter().zip(&packing.placements) {
            prop_assert!(!piece.keeps_its_angle || placement.turn == [1.0, 0.0]);
        }
    }
}

fn square(low: f64, high: f64) -> Vec<Point> {
    vec![[low, low], [high, low], [high, high], [low, high]]
}

/// Bars, triangles and frames of falling size.
fn some(count: usize) -> Vec<Piece> {
    let one = |i: usize| {
        let size = 1.0 + (i * 7 % 13) as f64;
        match i % 3 {
            0 => Piece::new(vec![vec![[0.0, 0.0], [size, 0.1 * size], [0.2 * size, 0.9 * size]]]),
            1 => Piece::new(vec![vec![[0.0, 0.0], [size, 0.0], [size, 0.2], [0.0, 0.2]]]),
            _ => Piece::new(vec![square(0.0, size), square(0.1 * size, 0.9 * size)]),
        }
    };
    (0..count).map(one).collect()
}

#[test]
fn small_pieces_at_the_left_border_keep_their_distance() {
    // Wide masks begin left of the page there.
    let mut pieces = some(30);
    pieces.extend((0..60).map(|_| Piece::new(vec![square(0.0, 0.3)])));
    for margin in [2.0, 30.0] {
        let settings = PackSettings { page: [512, 512], margin, ..PackSettings::default() };
        let packing = pack(&pieces, &settings).expect("they fit");
        check_margins(&pieces, &packing, &settings);
    }
}

#[test]
fn a_piece_goes_into_the_hole_of_another() {
    let pieces = [Piece::new(vec![square(0.0, 10.0), square(0.5, 9.5)]), Piece::new(vec![square(0.0, 8.5)])];
    let packing = pack(&pieces, &PackSettings::default()).expect("they fit");
    assert!(packing.coverage > 0.85, "{}", packing.coverage);
    check_margins(&pieces, &packing, &PackSettings::default());
}

#[test]
fn overlapping_polygons_of_one_piece_are_solid_where_they_overlap() {
    // Even and odd over all loops would leave a hole of eight by eight.
    let twice = Piece { polygons: vec![vec![square(0.0, 10.0)], vec![square(1.0, 9.0)]], ..Piece::default() };
    let packing = pack(&[twice, Piece::new(vec![square(0.0, 5.0)])], &PackSettings::default()).expect("they fit");
    let [x, y] = packing.texel(1, [2.5, 2.5]);
    let (low, high) = (packing.texel(0, [0.0, 0.0]), packing.texel(0, [10.0, 10.0]));
    let is_between = |x: f64, a: f64, b: f64| a.min(b) < x && x < a.max(b);
    assert!(!(is_between(x, low[0], high[0]) && is_between(y, low[1], high[1])), "{x} {y} {low:?} {high:?}");
}

#[test]
fn one_and_four_threads_give_the_same_bits() {
    let pieces = some(40);
    for effort in [Effort::Fast, Effort::Good] {
        let settings = PackSettings { page: [300, 300], effort, ..PackSettings::default() };
        let on = |threads: usize| {
            let packed = || pack(&pieces, &settings).expect("they fit");
            abf_parallel::with_threads(threads, packed).expect("threads")
        };
        assert_eq!(on(1), on(4));
    }
}

#[test]
fn points_and_segments_are_put_somewhere_too() {
    let flat = [vec![[1.0, 1.0]], vec![[0.0, 0.0], [3.0, 4.0]], vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]];
    let mut pieces: Vec<Piece> = flat.into_iter().map(|ring| Piece::new(vec![ring])).collect();
    for settings in [PackSettings::default(), PackSettings { effort: Effort::Fast, ..PackSettings::default() }] {
        let packing = pack(&pieces, &settings).expect("they fit");
        check_margins(&pieces, &packing, &settings);
    }
    pieces.truncate(1);
    let packing = pack(&[pieces.remove(0)], &PackSettings::default()).expect("a point fits");
    assert!(packing.texels_per_unit > 0.0 && packing.coverage == 0.0);
    assert_eq!(pack(&[], &PackSettings::default()).expect("nothing fits").placements, []);
}

#[test]
fn one_piece_gets_the_smallest_square_around_it() {
    let bar = Piece::new(vec![vec![[0.0, 0.0], [10.0, 0.0], [10.0, 1.0], [0.0, 1.0]]]);
    let packing = pack(&[bar], &PackSettings { margin: 0.0, ..PackSettings::default() }).expect("it fits");
    let expected = 1024.0 * 2.0_f64.sqrt() / 11.0;
    assert!((packing.texels_per_unit / expected - 1.0).abs() < 1e-8, "{}", packing.texels_per_unit);
}

#[test]
fn groups_share_the_scale_and_no_page() {
    let mut pieces = some(9);
    pieces.iter_mut().enumerate().for_each(|(i, piece)| piece.group = 7 * (i % 3));
    let settings = PackSettings { page: [256, 256], ..PackSettings::default() };
    let packing = pack(&pieces, &settings).expect("they fit");
    assert_eq!(packing.pages, 3);
    packing.placements.iter().enumerate().for_each(|(i, placement)| assert_eq!(placement.page, i % 3));
    check_margins(&pieces, &packing, &settings);
}

#[test]
fn a_given_scale_is_kept_and_takes_as_many_pages_as_it_needs() {
    let pieces = vec![Piece::new(vec![square(0.0, 10.0)]); 10];
    let settings = PackSettings { page: [64, 64], texels_per_unit: Some(2.5), pages: 9, ..PackSettings::default() };
    let packing = pack(&pieces, &settings).expect("four go onto a page");
    assert_eq!((packing.pages, packing.texels_per_unit.to_bits()), (3, 2.5_f64.to_bits()));
    check_margins(&pieces, &packing, &settings);
    let error = pack(&pieces, &PackSettings { pages: 2, ..settings }).unwrap_err();
    assert_eq!(error, PackError::TooManyPages { pieces: 10, pages: 2, texels_per_unit: 2.5 });
    let error = pack(&pieces, &PackSettings { texels_per_unit: Some(7.0), ..settings }).unwrap_err();
    assert!(
        matches!(error, PackError::PieceTooLarge { piece: 0, largest, .. } if (largest - 6.0).abs() < 1e-6),
        "{error}"
    );
}

#[test]
fn what_cannot_be_packed_is_refused_by_name() {
    let nan = Piece::new(vec![vec![[0.0, 0.0], [f64::NAN, 1.0]]]);
    let error = pack(&[Piece::new(vec![square(0.0, 1.0)]), nan], &PackSettings::default()).unwrap_err();
    assert_eq!(error, PackError::NotFinite { piece: 1 });
    assert_eq!(pack(&[Piece::default()], &PackSettings::default()).unwrap_err(), PackError::NoPoints { piece: 0 });
    let many = vec![Piece::new(vec![square(0.0, 1.0)]); 100];
    let settings = PackSettings { page: [16, 16], ..PackSettings::default() };
    let error = pack(&many, &settings).unwrap_err();
    assert!(matches!(error, PackError::TooManyPieces { pieces: 100, pages: 1, .. }), "{error}");
}

#[test]
fn thousands_of_tiny_pieces_are_packed() {
    let pieces: Vec<Piece> = some(20_000);
    let settings = PackSettings { page: [4096, 4096], ..PackSettings::default() };
    let packing = pack(&pieces, &settings).expect("they fit");
    assert_eq!(packing.placements.len(), pieces.len());
    assert!(packing.coverage > 0.1, "{}", packing.coverage);
}
