//! Colours and dashes. The hues are those of Okabe and Ito (Color Universal Design, 2008), which people with any of the
//! common colour blindnesses can tell apart; yellow, too faint on white, is left out. Dashes and marks distinguish the
//! series once more, without colour.

use std::fmt::Write;

/// Hues on white and on dark grey.
const HUES: [(&str, &str); 7] = [
    ("#0072b2", "#56a9e8"),
    ("#d55e00", "#ff8a3d"),
    ("#007a5a", "#22c796"),
    ("#b07aa1", "#e29bc8"),
    ("#b98300", "#f0c040"),
    ("#222222", "#e8e8e8"),
    ("#3a93bf", "#8fd3f5"),
];

/// Dashes; the first is a solid line.
const DASHES: [&str; 4] = ["none", "7 4", "2 3", "10 3 2 3"];

/// Number of hues.
pub(crate) const HUE_COUNT: usize = HUES.len();

/// Number of dashes.
pub(crate) const DASH_COUNT: usize = DASHES.len();

/// Colours from far within a limit to far beyond it, on white and on dark grey. One half is blue and one orange, which
/// all people tell apart.
const LEVELS: [(&str, &str); 8] = [
    ("#053061", "#9ecae1"),
    ("#2166ac", "#6baed6"),
    ("#4393c3", "#4292c6"),
    ("#7fb8d8", "#2f78ad"),
    ("#f4a582", "#b35806"),
    ("#e08214", "#e08214"),
    ("#b35806", "#fdb863"),
    ("#7f3b08", "#fee0b6"),
];

/// Number of levels; the upper half is beyond the limit.
pub(crate) const LEVEL_COUNT: usize = LEVELS.len();

const FIXED: &str = "text{font-family:system-ui,-apple-system,'Segoe UI',Roboto,'Liberation Sans',sans-serif;font-size:12px}\
.note{font-size:11px}.axis,.grid,.line,.limit,.trail,.rest{fill:none}.line{stroke-width:1.4;stroke-linejoin:round}\
.axis{stroke-width:1}.grid{stroke-width:.6}.limit{stroke-width:1.3;stroke-dasharray:5 3}.trail{stroke-width:3.2;stroke-linecap:round}\
.rest{stroke-width:1.6}.bound .line{stroke-width:1;opacity:.75;stroke-dasharray:1 3}.mark{stroke-width:1}.operation{opacity:.72}.off{display:none}";

/// The styles of one theme. Each rule begins with `before`, the selector under which it holds.
fn themed(before: &str, theme: impl Fn(&(&'static str, &'static str)) -> &'static str) -> String {
    let ink = theme(&("#1b1f24", "#e6e8eb"));
    let soft = theme(&("#5a636e", "#a4adb8"));
    let faint = theme(&("#dfe3e8", "#343b44"));
    let alarm = theme(&("#a3195b", "#ff7ab0"));
    let mut text = format!(
        "{before}.tick,{before}.note{{fill:{soft}}}{before}.label{{fill:{ink}}}{before}.axis{{stroke:{soft}}}\
         {before}.grid{{stroke:{faint}}}{before}.limit{{stroke:{alarm}}}{before}.fate{{fill:{alarm}}}{before}.rest{{stroke:{soft}}}\
         {before}.rest-fill{{fill:{soft}}}{before}.outside{{fill:{alarm};opacity:.1}}"
    );
    for (place, hue) in HUES.iter().enumerate() {
        let hue = theme(hue);
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{before}.c{place} .line{{stroke:{hue}}}{before}.c{place} .fill{{fill:{hue}}}\
             {before}.c{place} .mark{{stroke:{hue};fill:{hue}}}{before}.k{place}{{fill:{hue}}}"
        );
    }
    for (place, level) in LEVELS.iter().enumerate() {
        let level = theme(level);
        let _ = write!(text, "{before}.v{place}{{stroke:{level}}}{before}.f{place}{{fill:{level}}}");
    }
    text
}

fn dashes() -> String {
    let rule = |(place, dash): (usize, &&str)| format!(".d{place} .line{{stroke-dasharray:{dash}}}");
    DASHES.iter().enumerate().skip(1).map(rule).collect::<String>() + ".hollow .mark{fill-opacity:.15}"
}

/// The styles of a picture that is a file of its own.
pub(crate) fn styles_of_a_file() -> String {
    FIXED.to_string() + &themed("", |(light, _)| light) + &dashes()
}

/// The styles of the pictures in the page, in both themes. The system's theme holds unless the page sets another.
pub(crate) fn styles_of_the_page() -> String {
    let light = themed("svg ", |(light, _)| light);
    let dark = themed(":root:not([data-theme=light]) svg ", |(_, dark)| dark);
    let chosen = themed(":root[data-theme=dark] svg ", |(_, dark)| dark);
    format!("{FIXED}{light}@media (prefers-color-scheme:dark){{{dark}}}{chosen}{}", dashes())
}

/// The classes of a run's elements, by which the page switches them on and off.
pub(crate) fn series(run: usize, hue: usize, dash: usize) -> String {
    format!("series run{run} c{hue} d{dash}")
}

/// The colour of a hue on white and on dark grey, for a sample beside a name.
pub(crate) fn hue(place: usize) -> (&'static str, &'static str) {
    HUES[place % HUE_COUNT]
}

/// The dashes of a series, as SVG writes them.
pub(crate) fn dash(place: usize) -> &'static str {
    DASHES[place % DASH_COUNT]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(hex: &str) -> f64 {
        let part = |at: usize| {
            let x =
                f64::from(u8::from_str_radix(&hex[at..at + 2], 16).expect("two hexadecimal digits")) / 255.0;
            if x <= 0.039_28 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5)
    }

    /// Contrast as WCAG 2 defines it; WCAG asks for 3 : 1 in graphics.
    #[test]
    fn every_hue_stands_out_in_both_themes() {
        let contrast = |a: f64, b: f64| (a.max(b) + 0.05) / (a.min(b) + 0.05);
        for (light, dark) in HUES {
            assert!(contrast(luminance(light), 1.0) >= 3.0, "{light} {}", contrast(luminance(light), 1.0));
            assert!(contrast(luminance(dark), luminance("#14181d")) >= 3.0, "{dark}");
        }
    }
}
