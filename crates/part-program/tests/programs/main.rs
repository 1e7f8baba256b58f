//! Part programs, drawings and machine files as they are read and written. One program, so that its tests run side by side.

mod any_bytes;
mod approaches;
mod as_written;
mod cad;
mod canon;
mod compensation;
mod cycles;
mod dialects;
mod evaluation;
mod inspection;
mod known_words;
mod large_files;
mod left_out;
mod malformed;
mod meanings;
mod moves;
mod readers;
mod round_trips;
mod rounding;
mod side_axes;
mod siemens_words;
