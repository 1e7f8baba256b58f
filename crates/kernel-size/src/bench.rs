//! A run of a kernel in the numbers of one backend, step by step before an observer.

use std::any::Any;
use std::cell::Cell;
use std::ops::ControlFlow;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

use real::Backend;

use crate::case::Case;
use crate::ended::Ended;
use crate::input::Input;
use crate::kernel::Kernel;
use crate::output::Output;
use crate::steps::{Port, Steps};

/// Looks at the steps of a run while they are made.
pub(crate) trait Observer<R> {
    /// A step begins.
    fn begins(&mut self, _step: usize) {}

    /// A step has ended. Break: nothing more is to be learnt.
    fn ends(&mut self, step: usize, outputs: &[R]) -> ControlFlow<()>;
}

struct Bench<'a, R> {
    inputs: &'a [Input],
    outputs: &'a [Output],
    steps: usize,
    /// The step that is running, or the next one.
    step: usize,
    is_running: bool,
    ended: Option<Ended>,
    observer: &'a mut dyn Observer<R>,
}

impl<R: Backend> Bench<'_, R> {
    fn number(&mut self, signal: &'static str, value: f64) -> Option<R> {
        let number = R::from_f64(value).map(|number| number.signal(signal));
        if number.is_none() {
            self.end_with(Ended::DoesNotFit { signal, step: self.step, value });
        }
        number
    }

    fn end_with(&mut self, ended: Ended) {
        self.ended.get_or_insert(ended);
    }

    fn misused(&mut self, what: String) {
        self.end_with(Ended::Misused { step: self.step, what });
    }
}

impl<R: Backend> Port<R> for Bench<'_, R> {
    fn constant(&mut self, name: &'static str, value: f64) -> R {
        self.number(name, value).unwrap_or_else(R::zero)
    }

    fn begin(&mut self, inputs: &mut [R]) -> bool {
        if self.is_running {
            self.misused("the kernel begins another step: expected it to end this one".to_string());
        } else if inputs.len() != self.inputs.len() {
            self.misused(format!("the kernel takes {} inputs: expected {}", inputs.len(), self.inputs.len()));
        } else if self.step == self.steps {
            self.end_with(Ended::Finished);
        }
        if self.ended.is_some() {
            return false;
        }
        self.observer.begins(self.step);
        let given = self.inputs;
        for (place, input) in inputs.iter_mut().zip(given) {
            match self.number(input.name, input.values[self.step]) {
                Some(number) => *place = number,
                None => return false,
            }
        }
        self.is_running = true;
        true
    }

    fn end(&mut self, outputs: &[R]) {
        if self.ended.is_some() {
            return;
        }
        if !self.is_running || outputs.len() != self.outputs.len() {
            let expected = self.outputs.len();
            self.misused(format!(
                "the kernel ends a step with {} outputs: expected {expected}, once in a step that has begun",
                outputs.len()
            ));
            return;
        }
        if let Some((output, _)) = self.outputs.iter().zip(outputs).find(|(_, number)| !number.is_finite()) {
            self.end_with(Ended::NotFinite { output: output.name, step: self.step });
            return;
        }
        if self.observer.ends(self.step, outputs).is_break() {
            self.end_with(Ended::Enough);
        }
        self.is_running = false;
        self.step += 1;
    }
}

/// Runs the kernel in the numbers `R`.
pub(crate) fn run<K: Kernel, R: Backend>(case: &Case<'_, K>, observer: &mut dyn Observer<R>) -> Ended {
    let Case { kernel, steps, inputs, outputs } = case;
    let (steps, step) = (*steps, 0);
    let mut bench = Bench { inputs, outputs, steps, step, is_running: false, ended: None, observer };
    let result = without_a_message(|| {
        panic::catch_unwind(AssertUnwindSafe(|| kernel.run(&mut Steps::new(&mut bench))))
    });
    let Bench { step, is_running, ended, .. } = bench;
    match (ended, result) {
        // A panic may follow from what ended the run before; not so from its last step.
        (None | Some(Ended::Finished), Err(payload)) => {
            Ended::Panicked { step, message: message(payload.as_ref()) }
        }
        (Some(ended), _) => ended,
        (None, Ok(())) if step == steps && !is_running => Ended::Finished,
        (None, Ok(())) => Ended::Early { step },
    }
}

fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(ToString::to_string);
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
    let text = text.unwrap_or_else(|| "what it panics with is no text".to_string());
    text.chars().take(200).collect()
}

thread_local! {
    static IS_SILENT: Cell<bool> = const { Cell::new(false) };
}

/// Runs `work`, which catches its panics. The message that a program prints at a panic is not printed for those of this thread.
fn without_a_message<T>(work: impl FnOnce() -> T) -> T {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let others = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !IS_SILENT.get() {
                others(info);
            }
        }));
    });
    let outer = IS_SILENT.replace(true);
    let result = work();
    IS_SILENT.set(outer);
    result
}
