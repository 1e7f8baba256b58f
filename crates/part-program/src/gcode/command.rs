//! The commands in a line that change the order in which lines are executed.

/// The label of lines that belong together: `o100`, `o<name>`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Label {
    Number(u32),
    Name(Box<str>),
}

impl Label {
    /// The label of a name, whose case and white space do not matter.
    pub(crate) fn named(name: &str) -> Self {
        Self::Name(name.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_lowercase().into())
    }
}

impl std::fmt::Display for Label {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "O{number}"),
            Self::Name(name) => write!(f, "O<{name}>"),
        }
    }
}

/// The keyword behind the label of an O-word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Keyword {
    Sub,
    EndSub,
    Call,
    Return,
    If,
    ElseIf,
    Else,
    EndIf,
    While,
    EndWhile,
    Do,
    Repeat,
    EndRepeat,
    Break,
    Continue,
}

impl Keyword {
    const ALL: [(&'static str, Self); 15] = [
        ("sub", Self::Sub),
        ("endsub", Self::EndSub),
        ("call", Self::Call),
        ("return", Self::Return),
        ("if", Self::If),
        ("elseif", Self::ElseIf),
        ("else", Self::Else),
        ("endif", Self::EndIf),
        ("while", Self::While),
        ("endwhile", Self::EndWhile),
        ("do", Self::Do),
        ("repeat", Self::Repeat),
        ("endrepeat", Self::EndRepeat),
        ("break", Self::Break),
        ("continue", Self::Continue),
    ];

    /// The keyword of a run of letters.
    pub(crate) fn of(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, keyword)| *keyword)
    }

    /// The keyword as programs write it.
    pub(crate) fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, keyword)| *keyword == self).map_or("", |(name, _)| name)
    }
}

/// A command that changes the order of lines.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Command {
    /// LinuxCNC's O-word; its values begin at byte `at` of the line.
    Word { label: Label, keyword: Keyword, at: usize },
    /// FANUC's GOTO to the block with a number.
    Goto(u32),
    /// FANUC's WHILE … DO, with the value of its condition.
    While { number: u32, holds: bool },
    /// FANUC's END of such a loop.
    End(u32),
}
