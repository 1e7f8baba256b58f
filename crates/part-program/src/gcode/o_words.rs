//! LinuxCNC's O-words: how each changes the order of lines.

use crate::gcode::command::{Keyword, Label};
use crate::gcode::flow::{Context, Flow, Kind, Nested};
use crate::gcode::marks::behind_keyword;
use crate::gcode::variables::{LINUXCNC_LOCALS, Variable};
use crate::source::Span;

impl Flow {
    /// Executes an O-word.
    pub(super) fn o_word(
        &mut self,
        context: &mut Context<'_, '_, '_>,
        label: &Label,
        keyword: Keyword,
        at: usize,
        span: Span,
    ) -> Option<()> {
        let line = self.line;
        match keyword {
            // Lines of a subprogram are executed when it is called.
            Keyword::Sub => self.next = self.needed(context, label, Keyword::EndSub, span)? + 1,
            Keyword::EndSub | Keyword::Return => self.end_of_sub(context, label, at, span)?,
            Keyword::Call => self.call_word(context, label, at, span)?,
            Keyword::If => self.branch(context, label, line, at, span)?,
            Keyword::ElseIf | Keyword::Else => {
                self.leave(&Kind::If(label.clone()));
                self.next = self.needed(context, label, Keyword::EndIf, span)? + 1;
            }
            Keyword::EndIf => self.leave(&Kind::If(label.clone())),
            Keyword::While => self.while_word(context, label, at, span)?,
            Keyword::EndWhile => self.again(context, &Kind::While(label.clone()), span)?,
            Keyword::Do => self.begin(context, Kind::Do(label.clone()), span)?,
            Keyword::Repeat => self.repeat(context, label, at, span)?,
            Keyword::EndRepeat => self.end_of_repeat(context, label, span)?,
            Keyword::Break | Keyword::Continue => self.out_of_loop(context, label, keyword, span)?,
        }
        Some(())
    }

    /// `if`, or the first of its `elseif` and `else` whose condition holds.
    fn branch(
        &mut self,
        context: &mut Context<'_, '_, '_>,
        label: &Label,
        line: usize,
        at: usize,
        span: Span,
    ) -> Option<()> {
        let (mut line, mut at) = (line, at);
        while context.condition(line, at)? == 0.0 {
            let others = [Keyword::ElseIf, Keyword::Else, Keyword::EndIf];
            let Some((next, keyword)) = self.find(context.report, label, line, &others) else {
                context
                    .report
                    .error(span, format!("`{label}` has no endif behind it"))
                    .expected(format!("a line `{label} endif`"));
                return None;
            };
            self.next = next + 1;
            match keyword {
                Keyword::EndIf => return Some(()),
                Keyword::Else => break,
                _ => {
                    line = next;
                    let text = context.line(next).1;
                    at = behind_keyword(text);
                    // A condition is executed, though its line is not the next one.
                    self.repeated += 1;
                    self.repeated_bytes += text.len();
                }
            }
        }
        self.begin(context, Kind::If(label.clone()), span)
    }

    /// `while`, at the begin of its loop or at the end of a `do`.
    fn while_word(
        &mut self,
        context: &mut Context<'_, '_, '_>,
        label: &Label,
        at: usize,
        span: Span,
    ) -> Option<()> {
        let line = self.line;
        let holds = context.condition(line, at)? != 0.0;
        let kind = Kind::Do(label.clone());
        if let Some(index) = self.begun(&kind) {
            if holds {
                self.next = self.turn_again(index) + 1;
            } else {
                self.leave(&kind);
            }
            return Some(());
        }
        let kind = Kind::While(label.clone());
        if !holds {
            self.next = self.needed(context, label, Keyword::EndWhile, span)? + 1;
            self.leave(&kind);
            return Some(());
        }
        if self.begun(&kind).is_none() {
            self.begin(context, kind, span)?;
        }
        Some(())
    }

    /// Goes back to where a loop begins.
    fn again(&mut self, context: &mut Context<'_, '_, '_>, kind: &Kind, span: Span) -> Option<()> {
        let Some(index) = self.begun(kind) else {
            context
                .report
                .error(span, "the end of a loop that has not begun")
                .expected("its begin before it");
            return None;
        };
        self.next = self.turn_again(index);
        Some(())
    }

    fn repeat(
        &mut self,
        context: &mut Context<'_, '_, '_>,
        label: &Label,
        at: usize,
        span: Span,
    ) -> Option<()> {
        let times = context.condition(self.line, at)?.round();
        if times < 1.0 {
            self.next = self.needed(context, label, Keyword::EndRepeat, span)? + 1;
            return Some(());
        }
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at least 1; a cast keeps to the most"
        )]
        let left = times as u32;
        self.begin(context, Kind::Repeat { label: label.clone(), left }, span)
    }

    fn end_of_repeat(&mut self, context: &mut Context<'_, '_, '_>, label: &Label, span: Span) -> Option<()> {
        let is_own =
            |nested: &Nested| matches!(&nested.kind, Kind::Repeat { label: own, .. } if own == label);
        let Some(index) = self.frame().nested.iter().rposition(is_own) else {
            context.report.error(span, "endrepeat without repeat").expected("its repeat before it");
            return None;
        };
        let frame = self.frame();
        let Kind::Repeat { left, .. } = &mut frame.nested[index].kind else { return Some(()) };
        *left -= 1;
        if *left == 0 {
            frame.nested.truncate(index);
        } else {
            self.next = self.turn_again(index) + 1;
        }
        Some(())
    }

    /// `break` and `continue`.
    fn out_of_loop(
        &mut self,
        context: &mut Context<'_, '_, '_>,
        label: &Label,
        keyword: Keyword,
        span: Span,
    ) -> Option<()> {
        let is_own = |nested: &Nested| match &nested.kind {
            Kind::While(own) | Kind::Do(own) | Kind::Repeat { label: own, .. } => own == label,
            Kind::If(_) | Kind::Fanuc(_) => false,
        };
        let Some(index) = self.frame().nested.iter().rposition(is_own) else {
            let message = format!("{} outside of loop `{label}`", keyword.name());
            context.report.error(span, message).expected("a line of that loop");
            return None;
        };
        let end = match self.frame().nested[index].kind {
            Kind::Do(_) => Keyword::While,
            Kind::Repeat { .. } => Keyword::EndRepeat,
            _ => Keyword::EndWhile,
        };
        let line = self.needed(context, label, end, span)?;
        if keyword == Keyword::Break {
            self.frame().nested.truncate(index);
            self.next = line + 1;
        } else {
            self.frame().nested.truncate(index + 1);
            self.next = line;
        }
        Some(())
    }

    fn call_word(
        &mut self,
        context: &mut Context<'_, '_, '_>,
        label: &Label,
        at: usize,
        span: Span,
    ) -> Option<()> {
        let values = context.arguments(self.line, at)?;
        let first = self.marks(context.report).words.get(label).and_then(|lines| {
            lines.iter().find(|(_, keyword)| *keyword == Some(Keyword::Sub)).map(|(line, _)| line + 1)
        });
        let Some(first) = first else {
            context
                .report
                .error(span, format!("subroutine `{label}` is not in this file"))
                .expected(format!("lines from `{label} sub` to `{label} endsub`; other files are not read"));
            return None;
        };
        let arguments: Vec<_> = (1..).zip(values).collect();
        context.variables.enter(LINUXCNC_LOCALS, &arguments);
        self.enter(context.report, first, 0, true, span)?;
        context.variables.calls += 1;
        Some(())
    }

    fn end_of_sub(
        &mut self,
        context: &mut Context<'_, '_, '_>,
        label: &Label,
        at: usize,
        span: Span,
    ) -> Option<()> {
        if !self.is_called() {
            context
                .report
                .error(span, format!("`{label}` was not called"))
                .expected("a return in a subroutine");
            return None;
        }
        let values = context.arguments(self.line, at)?;
        self.return_from(context.variables);
        let has_value = f64::from(u8::from(!values.is_empty()));
        let kept = [("_value", values.first().copied().unwrap_or(0.0)), ("_value_returned", has_value)];
        for (name, value) in kept {
            context.variables.set(Variable::Name(name.into()), Some(value));
        }
        Some(())
    }
}
