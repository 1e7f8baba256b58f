//! Names that break a writer, for the tests of all writers.

/// Names of files, each of which ends a comment, a cell, an element, an attribute, a line or a path in some language.
pub const NAMES: [&str; 26] = [
    r"x*\ int injected(void){return 666;} \*.nc",
    "a*/b.nc",
    "*/ int injected(void){return 666;} /*.nc",
    "*",
    "??/",
    "x??/.nc",
    "back\\",
    "line\n int injected(void){return 666;} //.nc",
    "return\r.nc",
    "separator\u{2028}.nc",
    "bidi\u{202e}\u{2066}\u{200f}.nc",
    "\"><script>alert(1)</script>.nc",
    "' onload='alert(1)",
    "&lt;b&gt;.nc",
    "x]]>.nc",
    "-- pragma translate_off --.nc",
    "%{",
    "#{1+1}.nc",
    "=1+1.nc",
    "-rf.nc",
    "@x",
    "+1,\"=2\";=3.nc",
    ") (x.nc",
    "$(touch injected) `touch injected`; touch injected.nc",
    "\u{1b}[2J\u{9b}31m\u{7}\u{7f}.nc",
    "300/hundreds/of/characters/hundreds/of/characters/hundreds/of/characters/hundreds/of/characters/hundreds/of/characters/\
     hundreds/of/characters/hundreds/of/characters/hundreds/of/characters/hundreds/of/characters/hundreds/of/characters/hundreds/\
     of/characters/hundreds/of/characters/hundreds/of/characters.nc",
];
