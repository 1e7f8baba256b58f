//! The usual picture of a circle test: the radial error, magnified, around the commanded circle.

use std::f64::consts::TAU;

use svg::Document;
use svg::node::element::path::Data;
use svg::node::element::{Circle, Group, Line, Path, Text, Title};

use crate::{CircleTest, Roundness};

/// Side of the picture without the caption, in the picture's units.
const SIDE: f64 = 640.0;
/// Height of the caption.
const CAPTION: f64 = 90.0;
/// Radius of the commanded circle.
const NOMINAL: f64 = 190.0;
/// Distance of two rings.
const RING: f64 = 30.0;
/// Rings on either side of the commanded circle.
const RINGS: i32 = 3;
/// Points of the profile in the picture: two extremes in each of half as many sectors.
const POINTS: usize = 1440;

/// The magnified roundness plot of a test, as SVG text.
///
/// The heavy ring is the commanded circle. The rings beside it are whole steps of 1, 2 or 5 times a power of ten,
/// chosen so that the largest error stays within the outermost ring. The axes carry the units.
#[must_use]
pub fn roundness_plot(test: &CircleTest, circle: &Roundness, title: &str) -> String {
    let largest = circle.radial_error_max_mm.abs().max(circle.radial_error_min_mm.abs());
    let ring_um = ring_step_um(largest * 1000.0);
    let magnify = RING / (ring_um / 1000.0);
    let summary = format!(
        "radius {} mm, feed {:.0} mm/min; mean radial error {:+.2} µm, roundness {:.2} µm",
        test.radius,
        test.feedrate * 60.0,
        circle.radial_error_mean_mm * 1000.0,
        circle.roundness_mm * 1000.0,
    );
    let scale = format!(
        "rings {} µm apart; errors magnified {:.0} times against the circle",
        ring_um,
        magnify * test.radius / NOMINAL
    );
    Document::new()
        .set("viewBox", (0, 0, SIDE, SIDE + CAPTION))
        .set("font-family", "sans-serif")
        .set("font-size", 13)
        .set("role", "img")
        .add(Title::new(format!("{title}: {summary}")))
        .add(
            svg::node::element::Rectangle::new()
                .set("width", "100%")
                .set("height", "100%")
                .set("fill", "white"),
        )
        .add(grid(ring_um))
        .add(axes(test))
        .add(profile(circle, magnify))
        .add(text(SIDE / 2.0, SIDE + 16.0, "middle", title).set("font-weight", "bold").set("font-size", 15))
        .add(text(SIDE / 2.0, SIDE + 40.0, "middle", &summary))
        .add(text(SIDE / 2.0, SIDE + 62.0, "middle", &scale))
        .to_string()
}

/// The smallest of 1, 2 or 5 times a power of ten for which the outermost ring holds `largest_um`.
fn ring_step_um(largest_um: f64) -> f64 {
    let steps = (-3..=6).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10.0_f64.powi(power)));
    steps.into_iter().find(|step| step * f64::from(RINGS) >= largest_um).unwrap_or(1e6)
}

fn grid(ring_um: f64) -> Group {
    let mut group = Group::new().set("fill", "none").set("stroke", "#bbbbbb");
    for ring in -RINGS..=RINGS {
        let radius = NOMINAL + RING * f64::from(ring);
        let mut circle = Circle::new().set("cx", SIDE / 2.0).set("cy", SIDE / 2.0).set("r", radius);
        if ring == 0 {
            circle = circle.set("stroke", "black").set("stroke-width", 1.5);
        }
        let error = f64::from(ring) * ring_um;
        let label = if ring == 0 { "0 µm".to_string() } else { format!("{error:+} µm") };
        // On a diagonal, away from the axes and the quadrant points.
        let offset = radius * 0.5_f64.sqrt();
        let place = text(SIDE / 2.0 + offset + 2.0, SIDE / 2.0 - offset - 2.0, "start", &label);
        group =
            group.add(circle).add(place.set("font-size", 10).set("stroke", "none").set("fill", "#555555"));
    }
    group
}

fn axes(test: &CircleTest) -> Group {
    let (middle, margin) = (SIDE / 2.0, 14.0);
    let line = |x1: f64, y1: f64, x2: f64, y2: f64| {
        Line::new().set("x1", x1).set("y1", y1).set("x2", x2).set("y2", y2).set("stroke", "#888888")
    };
    let radius = test.radius;
    Group::new()
        .add(line(margin, middle, SIDE - margin, middle))
        .add(line(middle, margin, middle, SIDE - margin))
        .add(text(SIDE - margin, middle - 6.0, "end", &format!("X = {radius} mm")))
        .add(text(margin, middle - 6.0, "start", &format!("X = {} mm", -radius)))
        .add(text(middle + 6.0, margin + 6.0, "start", &format!("Y = {radius} mm")))
        .add(text(middle + 6.0, SIDE - margin, "start", &format!("Y = {} mm", -radius)))
}

fn profile(circle: &Roundness, magnify: f64) -> Path {
    let place = |(angle, error): (f64, f64)| {
        let radius = NOMINAL + error * magnify;
        // A hundredth of a unit is far below a pixel; y points down in SVG.
        let round = |x: f64| (x * 100.0).round() / 100.0;
        (round(SIDE / 2.0 + radius * angle.cos()), round(SIDE / 2.0 - radius * angle.sin()))
    };
    let mut points = extremes_by_sector(&circle.profile).into_iter().map(place);
    let mut data = Data::new();
    if let Some(first) = points.next() {
        data = points.fold(data.move_to(first), |data, point| data.line_to(point)).close();
    }
    Path::new().set("fill", "none").set("stroke", "#c02020").set("stroke-width", 1.5).set("d", data)
}

/// The profile thinned to the smallest and the largest error of each sector, in the order of the angle.
fn extremes_by_sector(profile: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut sorted = profile.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    if sorted.len() <= POINTS {
        return sorted;
    }
    let width = TAU / (POINTS / 2) as f64;
    let sectors = sorted.chunk_by(|a, b| (a.0 / width).floor() == (b.0 / width).floor());
    sectors
        .flat_map(|sector| {
            let by_error = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
            let mut pair: Vec<_> = [sector.iter().min_by(by_error), sector.iter().max_by(by_error)]
                .into_iter()
                .flatten()
                .copied()
                .collect();
            pair.sort_by(|a, b| a.0.total_cmp(&b.0));
            pair.dedup();
            pair
        })
        .collect()
}

fn text(x: f64, y: f64, anchor: &str, content: &str) -> Text {
    Text::new(content).set("x", x).set("y", y).set("text-anchor", anchor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ServoParameters;

    fn plot(title: &str) -> (Roundness, String) {
        let parameters = ServoParameters { feed_forward: 0.95, ..ServoParameters::new(50.7, 0.39) };
        let circle = CircleTest::PAPER.run::<f64>(&[parameters; 2]).unwrap();
        let text = roundness_plot(&CircleTest::PAPER, &circle, title);
        (circle, text)
    }

    #[test]
    fn axes_rings_and_result_are_labelled_with_units() {
        let (_, text) = plot("Feed-forward 95 %");
        for label in
            ["X = 10 mm", "Y = -10 mm", "0 µm", "+2 µm", "-6 µm", "feed 4000 mm/min", "rings 2 µm apart"]
        {
            assert!(text.contains(label), "{label} in {text}");
        }
    }

    #[test]
    fn the_picture_parses_and_shows_the_error_to_scale() {
        let (circle, text) = plot("a < b & c");
        let mut paths = Vec::new();
        for event in svg::read(&text).unwrap() {
            match event {
                svg::parser::Event::Error(error) => panic!("{error}"),
                svg::parser::Event::Tag("path", _, attributes) => {
                    paths.push(Data::parse(attributes.get("d").unwrap()).unwrap());
                }
                _ => {}
            }
        }
        assert_eq!(paths.len(), 1);
        // Rings 2 µm apart are 30 units: -4.92 µm is 74 units inside. The first point lies on the X axis.
        let svg::node::element::path::Command::Move(_, start) = paths[0].first().unwrap() else { panic!() };
        let expected = f64::from(320.0_f32) + NOMINAL + circle.profile[0].1 * RING / 0.002;
        assert!((f64::from(start[0]) - expected).abs() < 0.5, "{start:?} {expected}");
        assert!(text.contains("a &lt; b &amp; c"), "the title is escaped");
    }

    #[test]
    fn thinning_keeps_the_extremes() {
        let mut profile: Vec<(f64, f64)> =
            (0..20_000).map(|k| (TAU * f64::from(k) / 20_000.0, 0.0)).collect();
        profile[777].1 = 1.0;
        profile[12_345].1 = -1.0;
        let thinned = extremes_by_sector(&profile);
        assert!(thinned.len() <= POINTS);
        assert!(thinned.contains(&profile[777]) && thinned.contains(&profile[12_345]));
        assert!(thinned.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    }

    #[test]
    fn the_outermost_ring_holds_the_largest_error() {
        for (largest, step) in [(0.0, 1e-3), (2.9, 1.0), (3.1, 2.0), (14.0, 5.0), (80.0, 50.0)] {
            assert!((ring_step_um(largest) - step).abs() < 1e-12, "{largest}");
        }
    }
}
