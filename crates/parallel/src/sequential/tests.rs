//! Every stand-in beside what it stands for: the same code, with the names of both.

/// What `$body` makes of the stand-ins, and of rayon where it is there.
macro_rules! both {
    ($body:block) => {{
        let alone = {
            #[allow(unused_imports)]
            use crate::sequential::{join, prelude::*, scope};
            $body
        };
        #[cfg(feature = "rayon")]
        {
            #[allow(unused_imports)]
            use rayon::{join, prelude::*, scope};
            assert_eq!(alone, $body);
        }
        alone
    }};
}

/// Numbers of very different sizes, none of them in order.
fn numbers() -> Vec<f64> {
    (0..5000_u32).map(|i| f64::from(i.wrapping_mul(2_654_435_761) >> 4) * 1e-3 - 1e5).collect()
}

#[test]
fn items_come_in_their_order() {
    let x = numbers();
    let made = both!({
        let roots: Vec<f64> = x.par_iter().with_min_len(7).map(|x| x.abs().sqrt()).collect();
        roots.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    });
    assert_eq!(made.len(), x.len());
    assert_eq!(made[4999], x[4999].abs().sqrt().to_bits());
    assert_eq!(both!({ (3..9).into_par_iter().filter(|i| i % 2 == 0).collect::<Vec<usize>>() }), [4, 6, 8]);
    assert_eq!(both!({ vec!["a", "b"].into_par_iter().map(str::len).collect::<Vec<_>>() }), [1, 1]);
}

#[test]
fn pieces_are_changed_in_place() {
    let x = numbers();
    let changed = both!({
        let mut out = vec![0.0; x.len()];
        out.par_chunks_mut(64).zip(x.par_chunks(64)).enumerate().for_each(|(piece, (out, x))| {
            out.iter_mut().zip(x).for_each(|(out, x)| *out = x + piece as f64);
        });
        out.par_iter_mut().zip(&x).for_each(|(out, x)| *out -= x);
        out
    });
    assert_eq!(changed[0], 0.0);
    assert!((changed[4999] - 78.0).abs() < 1e-9, "4999 / 64 = 78");
}

#[test]
fn what_is_asked_of_all_items_is_answered_for_all() {
    let x = numbers();
    assert!(both!({ x.par_iter().all(|x| x.is_finite()) }));
    assert!(!both!({ x.par_iter().any(|x| *x > 1e9) }));
    let largest = both!({ x.par_iter().map(|x| x.abs()).reduce(|| 0.0, f64::max) });
    assert_eq!(largest, x.iter().fold(0.0, |most: f64, x| most.max(x.abs())));
    assert_eq!(both!({ x[..0].par_iter().map(|x| *x).reduce(|| 1.5, f64::max) }), 1.5);
    let negative = both!({ x.par_iter().filter(|x| **x < 0.0).count() });
    assert_eq!(negative, both!({ x.par_iter().map(|x| usize::from(*x < 0.0)).sum::<usize>() }));
    assert!(negative > 0 && negative < x.len());
}

#[test]
fn collecting_stops_at_what_is_missing() {
    let found = |missing: usize| {
        both!({ (0..9).into_par_iter().map(|i| (i != missing).then_some(i)).collect::<Option<Vec<_>>>() })
    };
    assert_eq!(found(4), None);
    assert_eq!(found(9), Some((0..9).collect()));
}

#[test]
fn two_closures_give_two_results() {
    assert_eq!(both!({ join(|| 1, || "two") }), (1, "two"));
    assert_eq!(both!({ scope(|_| 3) }), 3);
}
