//! Curves of degree 2 to 7, with and without weights, in the plane and in space: points, derivatives and the step on pieces.

use feedbits_benches::{Path, helix_of_degree};
use nalgebra::{U3, U4};
use nurbs_core::NurbsBuf;
use serde_json::json;

use crate::compiled::Compiled;
use crate::contestants::{Asked, CURVO, Contestant, REMEMBERED, curvo, ours};
use crate::evaluation::{ascending, runners};
use crate::race::{Time, race, report};
use crate::real_time_step::in_format;

/// Control points of each curve.
const POINTS: u32 = 100;

/// A peer's forms of a curve.
type Peer<const D: usize> = fn(&NurbsBuf<f64, D>, Asked) -> Vec<Contestant>;

/// Every degree, with weights and without, in two dimensions and in three.
pub(crate) fn degrees() {
    for rational in [false, true] {
        let paths: Vec<_> =
            (2..=7).map(|degree| helix_of_degree("helix", degree, POINTS, rational)).collect();
        let planar: Vec<_> = paths.iter().map(Path::in_plane).collect();
        every_degree(&planar, rational, curvo::<2, U3>);
        every_degree(&paths, rational, curvo::<3, U4>);
    }
}

/// All degrees in one race: evaluation beside the peer's, and the step, which must come to the same mean position as in
/// `f32`.
fn every_degree<const D: usize>(paths: &[Path<D>], rational: bool, peer: Peer<D>) {
    let report_each = |what: &str, times: &[Time]| {
        for (path, times) in paths.iter().zip(times.chunks(times.len() / paths.len())) {
            let degree = path.curve.degree();
            let about = json!({ "dimensions": D, "rational": rational, "degree": degree, "what": what });
            report("degrees", &about, times);
        }
    };
    for asked in [Asked::Point, Asked::Derivatives] {
        let of = |path: &Path<D>| {
            let mut field = ours(path.curve.clone(), asked);
            field.extend(peer(&path.curve, asked));
            field.retain(|contestant| [REMEMBERED, CURVO].contains(&contestant.name));
            (ascending(path), field)
        };
        let work: Vec<_> = paths.iter().map(of).collect();
        let each = paths.iter().zip(&work);
        let mut field: Vec<_> =
            each.flat_map(|(path, (parameters, field))| runners(path, asked, parameters, field)).collect();
        report_each(&format!("{asked:?}"), &race(&mut field));
    }
    let step = |path| in_format::<f64, D>(path, Compiled::<f32, D>::new(path).follow().1);
    report_each("Step", &race(&mut paths.iter().map(step).collect::<Vec<_>>()));
}
