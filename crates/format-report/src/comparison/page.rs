//! The page of a comparison: the answer, the formats with their verdicts, and the pictures.

use askama::Template;
use format_compare::{Comparison, Engine, FewestBits, Requirement, Verdict};

use crate::comparison::material::Material;
use crate::comparison::runs::{self, RunView};
use crate::comparison::{Chapter, chapters, tables};
use crate::frame::Frame;
use crate::number;
use crate::report::{Report, files};
use crate::switch::Switch;
use crate::table::Table;

#[derive(Template)]
#[template(path = "index.html")]
struct Page<'a> {
    frame: Frame<'a>,
    part: &'a format_compare::PartSummary,
    machine: &'a format_compare::Machine,
    answer: Answer,
    margins: Vec<MarginView>,
    runs: Vec<Switch>,
    /// The formats on pieces, or by the engine that ran them if none ran on pieces.
    formats: &'a Table,
    /// The same formats on the global parameter, in a part of the page that is folded.
    raw: Option<&'a Table>,
    /// Bits against fluctuation, beside the answer.
    bits: Option<&'a Chapter>,
    costs: Option<&'a Table>,
    chapters: &'a [Chapter],
    reference: &'a str,
}

struct Answer {
    /// The fewest bits that are enough, if they were searched.
    bits: Option<String>,
    format: Option<String>,
    why: Vec<String>,
}

struct MarginView {
    requirement: &'static str,
    found: String,
    limit: String,
    width: f64,
    used: String,
}

impl Report {
    /// Draws all chapters for which the material has data.
    ///
    /// # Errors
    /// [`askama::Error`] if the page cannot be rendered; no known material causes this.
    pub fn of(material: &Material<'_>) -> Result<Self, askama::Error> {
        let comparison = material.comparison;
        let runs = runs::views(comparison, material.traces);
        let mut chapters = chapters(material, &runs);
        let bits =
            chapters.iter().position(|chapter| chapter.id == "bits").map(|place| chapters.remove(place));
        let recommended = runs::recommended(comparison);
        // Requirements with a limit above 0 come first.
        let mut requirements =
            recommended.map_or_else(Vec::new, |index| comparison.formats[index].requirements.clone());
        requirements.sort_by_key(|one| one.used().is_none());
        let formats = tables::formats(comparison.formats.iter());
        let costs = tables::costs(material, &runs);
        let margin_table = tables::margins(&requirements);
        let tables = [Some(&formats), Some(&margin_table), costs.as_ref()].into_iter().flatten();
        let files = files(bits.iter().chain(&chapters).flat_map(|chapter| &chapter.figures), tables);
        let (on_pieces, raw): (Vec<_>, Vec<_>) =
            comparison.formats.iter().partition(|row| row.engine == Engine::Pieces);
        let [on_pieces, raw] =
            [on_pieces, raw].map(|rows| (!rows.is_empty()).then(|| tables::formats(rows.into_iter())));
        let title = format!("feedbits: {}", comparison.part.name);
        let question = "How many bits does your feed need?";
        let page = Page {
            frame: Frame::new((title, question), &comparison.part.name, &files, material.command),
            part: &comparison.part,
            machine: &comparison.machine,
            answer: answer(comparison, &requirements),
            margins: requirements.iter().map(MarginView::of).collect(),
            runs: runs.iter().map(RunView::switch).collect(),
            formats: on_pieces.as_ref().or(raw.as_ref()).unwrap_or(&formats),
            raw: on_pieces.as_ref().and(raw.as_ref()),
            bits: bits.as_ref(),
            costs: costs.as_ref(),
            chapters: &chapters,
            reference: comparison.reference,
        };
        Ok(Self::new(&page.render()?, files))
    }
}

impl MarginView {
    fn of(one: &Requirement) -> Self {
        let (found, limit) = (number::short(one.found), number::short(one.limit));
        let unit = if matches!(one.unit, "mm") { " mm" } else { "" };
        Self {
            requirement: one.what,
            found: format!("{found}{unit}"),
            limit: format!("{limit}{unit}"),
            width: one.used().map_or(0.0, |used| (used * 100.0).clamp(0.0, 100.0)),
            used: one
                .used()
                .map_or_else(String::new, |used| format!("{} % used", number::short(used * 100.0))),
        }
    }
}

/// The recommended format, and the reasons.
fn answer(comparison: &Comparison, requirements: &[Requirement]) -> Answer {
    let Some(index) = runs::recommended(comparison) else {
        return Answer { bits: fewest_bits(comparison), format: None, why: why_none(comparison) };
    };
    let row = &comparison.formats[index];
    let priced = comparison.recommended_on.len();
    let mut why = vec![if priced == 0 {
        format!(
            "The narrowest of the formats compared that meets every requirement: {} bits, on the {} path.",
            row.bits,
            path(row)
        )
    } else {
        format!(
            "The cheapest of the formats compared that meets every requirement, on the {} path.",
            path(row)
        )
    }];
    let allowed = comparison.machine.fluctuation_limit;
    if let Some(fluctuation) = row.fluctuation.map(|all| all.cruise_max_abs).filter(|found| *found > 0.0) {
        why.push(format!(
            "Its feed fluctuates {} times less than is allowed.",
            number::short(allowed / fluctuation)
        ));
    }
    let used = requirements.iter().filter_map(|one| Some((one.used()?, one)));
    if let Some((used, one)) = used.max_by(|a, b| a.0.total_cmp(&b.0)) {
        why.push(format!(
            "Closest to its limit is the {}: {} % of it is used.",
            one.what,
            number::short(used * 100.0)
        ));
    }
    let rejected: Vec<&format_compare::JudgedRun> =
        comparison.formats.iter().take(index).filter(|row| matches!(row.verdict, Verdict::Bad(_))).collect();
    if let Some(row) = rejected.last().filter(|_| priced == 0) {
        let reason = tables::verdict(&row.verdict);
        why.push(format!("{} {}, listed before it, does not do: {reason}.", row.format, row.engine));
    }
    for (target, (format, engine)) in &comparison.recommended_on {
        why.push(format!("Cheapest on {target}: {format} {engine}."));
    }
    Answer { bits: fewest_bits(comparison), format: Some(row.format.clone()), why }
}

/// The number of bits that is enough.
fn fewest_bits(comparison: &Comparison) -> Option<String> {
    match comparison.fewest_bits.as_ref()? {
        FewestBits::Found { format, bits, margin, .. } => Some(format!(
            "{bits} bits are enough: {format}, {} times better than asked",
            number::short(*margin)
        )),
        _ => None,
    }
}

fn path(row: &format_compare::JudgedRun) -> &'static str {
    if row.engine == format_compare::Engine::Pieces { "compiled (pieces)" } else { "raw" }
}

fn why_none(comparison: &Comparison) -> Vec<String> {
    if let Some(why) = &comparison.not_a_question_of_format {
        return why.to_string().lines().map(|line| line.trim_start_matches("- ").to_string()).collect();
    }
    let bad = comparison.formats.iter().rev().filter(|row| matches!(row.verdict, Verdict::Bad(_)));
    let refused = comparison.formats.iter().rev().filter(|row| matches!(row.verdict, Verdict::Refused(_)));
    bad.chain(refused)
        .take(3)
        .map(|row| format!("{} {}: {}.", row.format, row.engine, tables::verdict(&row.verdict)))
        .collect()
}

#[cfg(test)]
mod tests {
    use format_compare::{Engine, Options, Problem, Watch, compare_with, plan_for, select};
    use part_program::{read_machine, read_part};

    use super::*;
    use crate::report::listed;

    const EXAMPLE: &str = include_str!("../../../../data/seed-000.toml");

    fn example(part: &str, formats: &[&str]) -> Report {
        let machine = read_machine("m", EXAMPLE).expect("a machine");
        let problem =
            Problem::<3>::new(&read_part("p.nc", part).expect("a part"), &machine).expect("a problem");
        let names: Vec<String> = formats.iter().map(ToString::to_string).collect();
        let formats = select::<3>(&names).expect("formats");
        let options = Options::default();
        let watch = Watch { traces: true, ..Watch::default() };
        let engines = [Engine::DeBoorSecant, Engine::Pieces];
        let format_compare::Compared { comparison, traces, .. } =
            compare_with(&problem, &formats, &engines, &options, &watch).expect("a comparison");
        let plan = plan_for(&problem, formats[0].as_ref(), &options).expect("a plan");
        let material = Material {
            comparison: &comparison,
            traces: &traces,
            plan: &plan.sampled(&problem, 1).expect("samples"),
            solvers: &[],
            targets: &[],
            schedules: &[],
            command: "feedbits <compare> & \"more\"",
        };
        Report::of(&material).expect("a report")
    }

    fn file<'a>(report: &'a Report, name: &str) -> &'a str {
        report.files.iter().find(|file| file.0 == name).map_or_else(|| panic!("{name}"), |file| &file.1)
    }

    /// The page links only to files that are there, and escapes names.
    #[test]
    fn the_page_needs_nothing_but_the_files_beside_it() {
        let report = example(EXAMPLE, &["I16F16", "I4F28", "f64"]);
        let page = file(&report, "index.html");
        assert_eq!(report.files[0].0, "index.html");
        for reference in page.match_indices("href=\"").chain(page.match_indices("src=\"")) {
            let target = &page[reference.0..].split('"').nth(1).expect("a target");
            let here = *target == "data:," || report.files.iter().any(|(name, _)| name == target);
            assert!(here, "{target}");
        }
        assert!(
            page.contains("feedbits &#60;compare&#62; &#38;")
                || page.contains("feedbits &lt;compare&gt; &amp;")
        );
        assert!(page.contains("Use <strong>I4F28</strong>"), "the answer is I4F28");
        assert!(page.len() < 3_000_000, "{}", page.len());
    }

    /// A chapter and its first picture may share a name.
    #[test]
    fn every_id_is_given_once() {
        let report = example(EXAMPLE, &["I16F16", "I4F28", "f64"]);
        let page = file(&report, "index.html");
        let mut ids: Vec<&str> =
            page.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        assert!(ids.contains(&"fluctuation") && ids.contains(&"figure-fluctuation"), "{ids:?}");
        ids.sort_unstable();
        let twice: Vec<_> = ids.windows(2).filter(|pair| pair[0] == pair[1]).collect();
        assert!(twice.is_empty(), "{twice:?}");
    }

    /// Both axes of each picture have a label with a unit; names need no unit.
    #[test]
    fn every_axis_has_a_unit() {
        let report = example(EXAMPLE, &["I4F28"]);
        let mut pictures = 0;
        for (name, content) in report.files.iter().filter(|(name, _)| name.ends_with(".svg")) {
            let flat: String = content.lines().collect();
            let labels: Vec<&str> = flat
                .split("class=\"label\"")
                .skip(1)
                .filter_map(|rest| rest.split(['>', '<']).nth(1))
                .collect();
            let wanted = if name.starts_with("ranges") || name.starts_with("schedule") { 1 } else { 2 };
            assert_eq!(labels.len(), wanted, "{name}: {labels:?}");
            assert!(
                labels.iter().all(|label| label.contains('[') && label.ends_with(']')),
                "{name}: {labels:?}"
            );
            pictures += 1;
        }
        assert!(pictures >= 10, "{pictures}");
    }

    /// A path in space is shown from two sides. If no format is good, the page says so first.
    #[test]
    fn a_path_in_space_and_no_format_that_does() {
        let report = example("G0 X0 Y0 Z0\nG1 X10 Y0 F6000\nG1 X20 Y5 Z10\n", &["I16F16"]);
        assert!(report.files.iter().any(|(name, _)| name == "path-I16F16_pieces-xz.svg"));
        assert!(file(&report, "index.html").contains("meets the requirements"));
    }

    /// The page lists exactly the files beside it. A page that is not a report's lists none.
    #[test]
    fn a_page_lists_the_files_beside_it() {
        let report = example(EXAMPLE, &["I4F28", "f64"]);
        let page = file(&report, Report::PAGE);
        let beside: Vec<&str> = report.files.iter().skip(1).map(|(name, _)| name.as_str()).collect();
        assert_eq!(listed(page), beside);
        assert!(listed(&page.replace("Made by <code>feedbits", "Made by <code>another")).is_empty());
        let outside =
            page.replace("\"formats.csv\"", "\"../formats.csv\"").replace("\"feed.svg\"", "\"notes.txt\"");
        assert_eq!(listed(&outside).len(), beside.len() - 2);
        assert!(listed("").is_empty());
    }

    #[test]
    fn tables_have_a_row_a_run() {
        let report = example(EXAMPLE, &["I4F28", "f64"]);
        let csv = file(&report, "formats.csv");
        assert_eq!(csv.lines().count(), 5, "{csv}");
        assert!(csv.starts_with("format,bits,path,verdict,fluctuation_at_cruise,"), "{csv}");
        let margins: serde_json::Value = serde_json::from_str(file(&report, "margins.json")).expect("JSON");
        let margins = margins.as_array().expect("a row a requirement");
        // Requirements whose limit is 0 come last.
        assert_eq!(margins.iter().filter(|one| one["used_percent"].is_null()).count(), 2);
        assert!(margins[margins.len() - 2..].iter().all(|one| one["used_percent"].is_null()), "{margins:?}");
        let chord = margins.iter().find(|one| one["requirement"] == "chord error").expect("the chord error");
        assert!(chord["used_percent"].as_f64().is_some_and(|used| used > 90.0 && used < 100.0), "{chord}");
    }
}
