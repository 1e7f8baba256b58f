//! What is drawn from bytes.

use arbitrary::Unstructured;
use nurbs_core::MAX_DEGREE;
use stress::{RandomPath, SplitMix64, any_curve};

fn bytes(seed: u64) -> Vec<u8> {
    SplitMix64::new(seed).take(4096).map(|word| word.to_be_bytes()[0]).collect()
}

#[test]
fn the_generator_covers_what_it_claims() {
    let (mut made, mut rational, mut many, mut repeated, mut close, mut coincident) = (0, 0, 0, 0, 0, 0);
    let mut degrees = [0; MAX_DEGREE + 1];
    for seed in 0..1000 {
        let Some(path) = RandomPath::<2>::from_bytes(&bytes(seed * 7919)) else { continue };
        made += 1;
        many += usize::from(path.curves.len() > 1);
        assert!(path.limits.validate().is_ok());
        for pair in path.curves.windows(2) {
            assert_eq!(pair[0].control_points().last(), pair[1].control_points().first());
        }
        let curve = &path.curves[0];
        degrees[curve.degree()] += 1;
        rational += usize::from(curve.as_curve().weights().is_some());
        coincident += usize::from(curve.control_points().windows(2).any(|p| p[0] == p[1]));
        let inner = &curve.knots()[curve.degree() + 1..curve.control_points().len()];
        repeated += usize::from(inner.windows(2).any(|k| k[0] == k[1]));
        close += usize::from(inner.windows(2).any(|k| k[0] < k[1] && k[1] - k[0] < 1e-14));
    }
    assert!(made > 950, "{made}");
    assert!(degrees[1..].iter().all(|n| *n > 10), "{degrees:?}");
    assert!((200..700).contains(&rational), "{rational}");
    assert!(
        many > 100 && repeated > 200 && close > 30 && coincident > 30,
        "{many} {repeated} {close} {coincident}"
    );
}

#[test]
fn no_bytes_are_a_path_and_any_numbers_are_now_and_then_a_curve() {
    assert!(RandomPath::<2>::from_bytes(&[]).is_some());
    assert!(RandomPath::<3>::from_bytes(&[7; 3]).is_some());
    let valid = (0..2000).filter(|seed| any_curve::<2>(&mut Unstructured::new(&bytes(*seed))).is_ok());
    let valid = valid.count();
    assert!(valid > 20, "{valid}");
}
