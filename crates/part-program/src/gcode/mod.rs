//! Part programs: blocks of words, with modal state, to curves.
//!
//! A line becomes words, variables with their new values, and at most one command (`lexer`, `address`, `command_line`,
//! `expression`). `program`, `flow`, `o_words` and `marks` decide the order in which lines are executed. The execution
//! of a block of words begins in `block_words` and goes on in the files named below; all of them work on the state in
//! `reader`.
//!
//! | words | meaning | file |
//! |---|---|---|
//! | G0 G1 G33 G33.1 | straight moves: curves of degree 1 | `path_move` |
//! | G2 G3 with I J K or R (CR=), P turns | arcs and full circles: rational curves of degree 2; helices: of degree 3 | `path_move` |
//! | CIP, CT, TURN=, AR= | arcs of Siemens | `siemens_arcs`, `path_move` |
//! | `,R` `,C` RND= CHR= CHF= | corners that are rounded or cut off | `corner` |
//! | G73 G74 G76, G80 to G89 but G87, G98 G99 | drilling cycles | `drilling` |
//! | G06.2, G5.2 G5.3, G5, G5.1, BSPLINE | splines of FANUC, LinuxCNC and Siemens | `spline_move`, `fanuc`, `linuxcnc`, `siemens` |
//! | G17 G18 G19, G20 G21 (G70 G71 G700 G710), G90 G91, G90.1 G91.1 | planes, units, coordinates, centres | `preparatory` |
//! | TRANS ATRANS | a shift of the coordinates | `offsets` |
//! | G41 G42 G41.1 G42.1 G40 | the tool's centre beside the contour | `compensated`, `compensation`, `contour` |
//! | words that are not read | what they leave out | `left_out`, `unread_names` |
//! | G10 G28 G30 G52 G53 G54 to G59.3 G92 | where 0 is, and moves to places of the machine | `offsets` |
//! | F with G93 G94 G95 | feed | `feed` |
//! | G9, G61 G61.1 G64, of FANUC G62 G63, of Siemens G60 | exact stop at the ends of moves, or not | `preparatory` |
//! | M S T D H | no effect on the path; listed. M2, M30 and M99 end the program, as the second `%` does | `auxiliary` |
//! | G65 M98 M99 | subprograms of the same text | `auxiliary`, `flow` |
//! | A B C U V W | axes beside the path | `side_words` |
//! | E | a printer's filament | `axis_words` |
//!
//! A block has at most one word of each group of G words that exclude one another: G20 with G21 is an error, and so is
//! G1 with G2.
//!
//! A missing coordinate keeps its value. The tool's first place is unknown: an axis begins where it is first sent, and
//! earlier blocks are read as executed there. An axis that incremental words move first begins at 0.

mod address;
mod auxiliary;
mod axis_words;
mod block;
mod block_place;
mod block_words;
mod bracketed;
mod command;
mod command_line;
mod compensated;
mod compensation;
mod contour;
mod corner;
mod cycle;
mod drilling;
mod expression;
mod fanuc;
mod feed;
mod flow;
mod frame;
mod function;
mod known_words;
mod left_out;
mod lexer;
mod line;
mod linuxcnc;
mod marks;
mod modal;
mod o_words;
mod offsets;
mod operator;
mod other_axes;
mod path_move;
mod placing;
mod preparatory;
mod program;
mod reader;
mod scope;
mod side_words;
mod siemens;
mod siemens_arcs;
mod spline;
mod spline_move;
mod tool_in_use;
mod unread_names;
mod variables;
mod word;

pub use known_words::{KnownWord, WordUse, known_words};
pub(crate) use linuxcnc::LEAST_ORDER;
pub(crate) use program::read;
