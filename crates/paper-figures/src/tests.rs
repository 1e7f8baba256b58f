//! Every figure beside the printed one.

use super::*;

fn all() -> &'static PaperFigures {
    static ALL: std::sync::OnceLock<PaperFigures> = std::sync::OnceLock::new();
    ALL.get_or_init(|| paper_figures().expect("all can be computed"))
}

#[test]
fn scratch() {
    use crate::adaptive_feed::adaptive_feed;
    for (name, text) in [("A", PAPER_A), ("D", PAPER_D)] {
        let m = crate::judged::machine("m", PAPER_A).unwrap();
        let p = crate::judged::problem(&crate::judged::part("p", text).unwrap(), &m).unwrap();
        for f in [50.0, 66.67, 100.0, 200.0] {
            for t in [0.001, 0.002, 0.003, 0.004] {
                for e in [0.0005, 0.001, 0.002] {
                    let steps = adaptive_feed(&p.curves[0], f, e, t);
                    let a = steps
                        .windows(2)
                        .map(|w| ((w[1].feed_mm_per_s - w[0].feed_mm_per_s) / t).abs())
                        .fold(0.0, f64::max);
                    println!("{name} F{f} T{t} E{e}: {a:.0}");
                }
            }
        }
    }
    for row in &all().rows {
        if row.paper == 'A' {
            println!("{row:?}");
        }
    }
    for row in contour_table().unwrap() {
        println!("{row:?}");
    }
}
