//! Many parts at a call: one answer for a controller that is to run all of them.

pub(crate) mod answer;
pub(crate) mod baseline;
mod formats;
pub(crate) mod known;
pub(crate) mod parts;
mod print;
mod registers;
mod search;
mod store;
pub(crate) mod work;

use std::cmp::Reverse;
use std::collections::BTreeMap;

use anyhow::{Result, bail};
use feed_plan::in_parallel;
use real::FormatName;
use serde::Serialize;
use serde_json::Value;
use target_cost::Target;

use crate::ending::Ending;
use crate::fingerprint::fingerprint_of;
use crate::input::PartReader;
use crate::places::{Folder, Place};
use crate::run_arguments::RunArguments;
use crate::{interrupt, output, report};
use answer::{Answer, OwnAnswers, PartLine};
use baseline::SetBaseline;
use formats::{FormatOfSet, cheapest};
use known::{PartEnding, PartOfSet, SetOfParts};
use parts::{PartFile, Parts};
use registers::RegistersOfSet;
use search::Search;
use store::Store;
use work::OfEachPart;

/// The version of the JSON of a set. It grows when a key goes or changes its meaning.
const SCHEMA: u64 = 1;

/// How the result of a set is given.
pub(crate) struct Outputs<'a> {
    /// Its place.
    pub(crate) out: Place,
    /// The folder of its report, if there is to be one.
    pub(crate) folder: Option<Folder>,
    /// Whether it is JSON.
    pub(crate) json: bool,
    /// The targets that a period is priced on.
    pub(crate) targets: &'a [Target],
    /// The set of an earlier call, and by which share a figure may be worse.
    pub(crate) baseline: Option<SetBaseline>,
}

/// Does the work of a command for each part of a set, and prints the answer for all of them.
pub(crate) fn run<W: OfEachPart>(
    work: &W,
    parts: &Parts,
    run: &RunArguments,
    outputs: &Outputs<'_>,
) -> Result<Ending> {
    let (resumed, folder) = (parts.resumed(W::COMMAND)?, parts.cache()?);
    let files = parts.files()?;
    let (machine, reader) = (parts.reading().machine()?, parts.reading().reader()?);
    let set = SetOfParts {
        set: W::COMMAND.to_string(),
        fingerprint: fingerprint_of(&format!(
            "{} {} {} {:?}",
            serde_json::to_string(&machine)?,
            work.options()?,
            env!("CARGO_PKG_VERSION"),
            outputs.targets,
        )),
        parts: in_parallel(&files, |file| part_of_set(&reader, file)),
    };
    let store = Store::open(&set, resumed.as_ref(), folder)?;
    let search = Search::new((work, run), (&reader, machine), &files, &set, store);
    let shard = parts.shard();
    let mut left: Vec<usize> = (0..files.len())
        .filter(|part| shard.is_none_or(|shard| shard.has(*part)))
        .filter(|part| search.store().known().ending(*part).is_none())
        .collect();
    // The longest first, so that no core waits for one that was begun last.
    left.sort_by_key(|part| Reverse(std::fs::metadata(&files[*part].path).map_or(0, |found| found.len())));
    interrupt::runs_begin();
    let is_whole = shard.is_none_or(|shard| !shard.is_part());
    let ended = || -> Result<Option<Found>> {
        search.finish(&left)?;
        if interrupt::is_set() || !is_whole {
            return Ok(None);
        }
        Found::of(&search, outputs.targets, &set).map(|found| Some(found).filter(|_| !interrupt::is_set()))
    };
    let found = interrupt::unless_interrupted(ended, || {
        output::status_of(unfinished(&search, &set, outputs).map(|_| ()));
    })?;
    say_remarks(search.remarked());
    let Some(found) = found else { return unfinished(&search, &set, outputs) };
    if found.results.is_empty() {
        bail!("{}", none_is_run(&search));
    }
    let ending = found.ending(parts.skips_refused());
    let by_name = found.by_name(&files);
    outputs.baseline.as_ref().map_or(Ok(()), |baseline| baseline.expect_machine(&by_name))?;
    // The report comes first: if it cannot be written, nothing is printed beside the error.
    let page = outputs.folder.as_ref().map(|folder| {
        let page = print::page(&found.answer, &found.lines, first_target(outputs));
        report::into(folder, &page.report(&report::command())?)
    });
    let page = page.transpose()?;
    output::write(&outputs.out, &text(&search, &found, outputs)?)?;
    if let Some(page) = page {
        output::note(&format!("report in {}", page.display()));
    }
    outputs.baseline.as_ref().map_or(Ok(ending), |baseline| baseline.judge(&found.answer, &by_name, ending))
}

/// A part of the set, known by what it says now.
fn part_of_set(reader: &PartReader, file: &PartFile) -> PartOfSet {
    let text = reader.text_of(&file.path);
    PartOfSet {
        name: file.name.clone(),
        fingerprint: text.map_or_else(|_| String::new(), |text| text.fingerprint()),
    }
}

/// The answer for a set, and what it is made of.
pub(crate) struct Found {
    pub(crate) answer: Answer,
    pub(crate) lines: Vec<PartLine>,
    /// The result of each part that was run, by its number.
    pub(crate) results: BTreeMap<usize, Value>,
}

impl Found {
    fn of<W: OfEachPart>(search: &Search<'_, W>, targets: &[Target], set: &SetOfParts) -> Result<Self> {
        let results = search.results()?;
        let mut answer = Answer::of_endings(search, &results, set);
        let own = OwnAnswers::of(search.work, &results);
        answer.fewest_bits = answer::fewest(search, &own)?;
        let named: Vec<(&str, &Value)> =
            results.iter().map(|(part, result)| (search.files[*part].name.as_str(), result)).collect();
        answer.formats = FormatOfSet::all(&named);
        answer.registers = RegistersOfSet::of(&named);
        let uniform =
            answer.fewest_bits.as_ref().and_then(|fewest| FormatName::named(fewest.format.as_ref()?));
        if let Some((registers, uniform)) = answer.registers.take().zip(uniform) {
            let has_registers = |(_, result): &(&usize, &Value)| result["mixed"].is_object();
            let parts: Vec<usize> = results.iter().filter(has_registers).map(|(part, _)| *part).collect();
            answer.registers = Some(search.confirmed(registers, &parts, uniform)?);
        }
        let recommended = match targets.first() {
            Some(first) => cheapest(&answer.formats, &first.name),
            None => answer.formats.iter().find(|format| format.is_good_for_all()),
        };
        let pair = |format: &FormatOfSet| [format.format.clone(), format.engine.clone()];
        let recommended = recommended.map(pair);
        let on = targets
            .iter()
            .filter_map(|target| Some((target.name.clone(), pair(cheapest(&answer.formats, &target.name)?))));
        answer.recommended_on = on.collect();
        (answer.recommended, answer.recommended_engine) =
            recommended.map_or((None, None), |[format, engine]| (Some(format), Some(engine)));
        let lines = answer::lines(search, &results, &answer);
        Ok(Self { answer, lines, results })
    }

    /// The result of each part that was run, by its name.
    fn by_name(&self, files: &[PartFile]) -> BTreeMap<String, &Value> {
        self.results.iter().map(|(part, result)| (files[*part].name.clone(), result)).collect()
    }

    /// Good if a format of those compared, or of the search, is good for all parts that were run, and none was refused.
    fn ending(&self, skips_refused: bool) -> Ending {
        let is_good = if self.answer.formats.is_empty() {
            let fewest = self.answer.fewest_bits.as_ref();
            fewest.is_some_and(|fewest| fewest.format.is_some() && fewest.none_for.is_empty())
        } else {
            self.answer.recommended.is_some()
        };
        match (is_good, self.answer.not_run() > 0 && !skips_refused) {
            (false, _) => Ending::RequirementNotMet,
            (true, true) => Ending::PartsRefused,
            (true, false) => Ending::Good,
        }
    }
}

/// Prints the parts that are finished: Ctrl-C has ended the work, or the others are of other shards.
fn unfinished<W: OfEachPart>(
    search: &Search<'_, W>,
    set: &SetOfParts,
    outputs: &Outputs<'_>,
) -> Result<Ending> {
    let results = search.results()?;
    let answer = Answer::of_endings(search, &results, set);
    let lines = answer::lines(search, &results, &answer);
    let found = Found { answer, lines, results };
    output::write(&outputs.out, &text(search, &found, outputs)?)?;
    if !interrupt::is_set() {
        output::note("other shards have the other parts: `feedbits merge` joins their files");
        return Ok(Ending::Good);
    }
    let finished = output::counted(search.store().known().len(), "part", "parts");
    output::say(&format!("feedbits: interrupted: {finished} of {} finished", set.parts.len()));
    Ok(Ending::Interrupted)
}

/// Says in how many parts there is something to be told, which a call of one part alone tells.
fn say_remarks(count: usize) {
    if count > 0 {
        let parts = output::counted(count, "part has", "parts have");
        output::note(&format!("{parts} notes or warnings: the same command prints them for a part alone"));
    }
}

/// Why no part was run: the first reason, and how many more there are.
fn none_is_run<W: OfEachPart>(search: &Search<'_, W>) -> String {
    let store = search.store();
    let first = (0..search.files.len()).find_map(|part| match store.known().ending(part)? {
        PartEnding::Unread(why) | PartEnding::Refused(why) => Some(why.clone()),
        PartEnding::Result(_) => None,
    });
    let all = search.files.len();
    format!("none of {} can be run: {}", output::counted(all, "part", "parts"), first.unwrap_or_default())
}

/// The result as text or as JSON.
fn text<W: OfEachPart>(search: &Search<'_, W>, found: &Found, outputs: &Outputs<'_>) -> Result<String> {
    let Found { answer, lines, .. } = found;
    if outputs.json {
        return json(search, found);
    }
    Ok(print::screen(answer, lines, outputs.out.path().is_some(), first_target(outputs)))
}

/// The name of the target by which a format is recommended.
fn first_target<'o>(outputs: &'o Outputs<'_>) -> Option<&'o str> {
    outputs.targets.first().map(|target| target.name.as_str())
}

/// The first members of a set's JSON.
#[derive(Serialize)]
struct Head<'a> {
    schema: u64,
    command: String,
    answer: &'a Answer,
}

/// The answer and each part, with the JSON of the command for this part alone as `result`, byte by byte but for the indentation.
fn json<W: OfEachPart>(search: &Search<'_, W>, found: &Found) -> Result<String> {
    let head = Head { schema: SCHEMA, command: format!("{}-set", W::COMMAND), answer: &found.answer };
    let head = serde_json::to_string_pretty(&head)?;
    let mut text = format!("{},\n  \"parts\": [", opened(&head));
    let store = search.store();
    for (part, line) in found.lines.iter().enumerate() {
        let line = serde_json::to_string_pretty(line)?;
        let line = opened(&line);
        let result = match store.known().ending(part) {
            Some(PartEnding::Result(json)) => format!(",\n  \"result\": {}", indented(json.trim_end(), 2)),
            _ => String::new(),
        };
        let comma = if part > 0 { "," } else { "" };
        text += &format!("{comma}\n    {}", indented(&format!("{line}{result}\n}}"), 4));
    }
    Ok(text + "\n  ]\n}\n")
}

/// An object in JSON of several lines without its end.
fn opened(object: &str) -> &str {
    object.strip_suffix("\n}").unwrap_or(object)
}

/// A text whose lines, but for the first, are indented by some more spaces. Text in JSON has no line breaks of its own.
fn indented(text: &str, by: usize) -> String {
    text.replace('\n', &format!("\n{}", " ".repeat(by)))
}
