//! Small surfaces that are not disks, as OBJ text.

use std::f64::consts::TAU;
use std::fmt::Write;

/// An OBJ of vertices and faces, indices counted from 0.
pub(crate) fn obj(points: &[[f64; 3]], faces: &[[usize; 3]]) -> String {
    let mut out = String::new();
    for [x, y, z] in points {
        writeln!(out, "v {x} {y} {z}").expect("a string");
    }
    for [a, b, c] in faces {
        writeln!(out, "f {} {} {}", a + 1, b + 1, c + 1).expect("a string");
    }
    out
}

/// A pyramid over a square, without its base: a disk.
pub(crate) const PYRAMID: ([[f64; 3]; 5], [[usize; 3]; 4]) = (
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 0.5]],
    [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
);

pub(crate) fn pyramid() -> String {
    obj(&PYRAMID.0, &PYRAMID.1)
}

pub(crate) fn tetrahedron() -> String {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    obj(&points, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
}

/// The faces of an `m × n` grid of squares whose vertices are numbered by `at`.
fn grid(m: usize, n: usize, at: impl Fn(usize, usize) -> usize) -> Vec<[usize; 3]> {
    let squares = (0..m).flat_map(|i| (0..n).map(move |j| (i, j)));
    squares
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
        .collect()
}

fn torus_points_and_faces() -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
    const SIDE: usize = 8;
    let angle = |i: usize| TAU * i as f64 / SIDE as f64;
    let points = (0..SIDE * SIDE).map(|k| {
        let (u, v) = (angle(k / SIDE), angle(k % SIDE));
        let radius = 2.0 + v.cos();
        [radius * u.cos(), radius * u.sin(), v.sin()]
    });
    (points.collect(), grid(SIDE, SIDE, |i, j| (i % SIDE) * SIDE + j % SIDE))
}

pub(crate) fn torus() -> String {
    let (points, faces) = torus_points_and_faces();
    obj(&points, &faces)
}

pub(crate) fn torus_with_a_hole() -> String {
    let (points, faces) = torus_points_and_faces();
    obj(&points, &faces[1..])
}

pub(crate) fn tube() -> String {
    const AROUND: usize = 6;
    let points: Vec<[f64; 3]> = (0..2 * AROUND)
        .map(|k| {
            let u = TAU * (k / 2) as f64 / AROUND as f64;
            [u.cos(), u.sin(), (k % 2) as f64]
        })
        .collect();
    obj(&points, &grid(AROUND, 1, |i, j| (i % AROUND) * 2 + j))
}

pub(crate) fn moebius_band() -> String {
    const AROUND: usize = 12;
    let points: Vec<[f64; 3]> = (0..2 * AROUND)
        .map(|k| {
            let u = TAU * (k / 2) as f64 / AROUND as f64;
            let across = (k % 2) as f64 - 0.5;
            let radius = 2.0 + across * (0.5 * u).cos();
            [radius * u.cos(), radius * u.sin(), across * (0.5 * u).sin()]
        })
        .collect();
    // Once around, the two sides have changed places.
    obj(&points, &grid(AROUND, 1, |i, j| (i % AROUND) * 2 + (j + i / AROUND) % 2))
}

pub(crate) fn two_components() -> String {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let far = points.map(|[x, y, z]| [x + 5.0, y, z]);
    obj(&[points, far].concat(), &[[0, 1, 2], [3, 4, 5]])
}

pub(crate) fn non_manifold_edge() -> String {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.5, -1.0, 0.0], [0.5, 0.0, 1.0]];
    obj(&points, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]])
}

pub(crate) fn non_manifold_vertex() -> String {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [-1.0, -1.0, 0.0]];
    obj(&points, &[[0, 1, 2], [0, 3, 4]])
}

pub(crate) fn inconsistent() -> String {
    let mut faces = PYRAMID.1;
    faces[1].swap(0, 1);
    obj(&PYRAMID.0, &faces)
}
