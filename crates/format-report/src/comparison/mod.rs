//! A comparison of number formats as a page: its pictures, each in a file, its tables, and the answer.

mod bits;
mod chord_error;
mod cycles;
mod evaluations;
mod fluctuation;
mod material;
mod over_time;
mod page;
mod path;
mod plan;
mod ranges;
mod runs;
mod schedule;
mod solvers;
mod tables;

use crate::figure::Figure;
pub use material::{Material, Schedule, Solver};
use runs::RunView;

/// A chapter of the report: pictures that answer one question.
pub(crate) struct Chapter {
    /// Its name in links.
    pub(crate) id: &'static str,
    /// The question.
    pub(crate) title: &'static str,
    /// The pictures. If they belong to runs, one is shown at a time.
    pub(crate) figures: Vec<Figure>,
}

impl Chapter {
    /// Whether a run is chosen.
    pub(crate) fn one_at_a_time(&self) -> bool {
        self.figures.iter().any(|figure| figure.of_run.is_some())
    }

    /// A picture for the page. The template inserts it without escaping.
    fn shown(&self) -> impl Iterator<Item = (&Figure, String)> {
        self.figures.iter().map(|figure| (figure, figure.inline()))
    }
}

/// All chapters for which the material has data.
pub(crate) fn chapters(material: &Material<'_>, runs: &[RunView<'_>]) -> Vec<Chapter> {
    let chapter = |id, title, figures| Chapter { id, title, figures };
    let chapters = vec![
        chapter("fluctuation", "How much does the feed fluctuate?", fluctuation::figures(material, runs)),
        chapter("path", "Where on the path?", path::figures(material, runs)),
        chapter("plan", "What is the feed plan?", plan::figures(material)),
        chapter("chord", "How far is the path from the chords?", chord_error::figures(material, runs)),
        chapter("solvers", "What does the secant iteration buy?", solvers::figures(material)),
        chapter("evaluations", "How often is the curve evaluated?", evaluations::figures(runs)),
        chapter("ranges", "Which bits are used?", ranges::figures(runs)),
        chapter("bits", "What do more bits buy?", bits::figures(material, runs)),
        chapter("cycles", "What does a period cost?", cycles::figures(material, runs)),
        chapter("schedule", "What does the target do in a period?", schedule::figures(material)),
    ];
    chapters.into_iter().filter(|chapter| !chapter.figures.is_empty()).collect()
}
