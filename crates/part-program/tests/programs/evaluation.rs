//! Programs that compute: variables, expressions, conditions, loops and subprograms. Expected values are those of
//! LinuxCNC's `rs274` unless a comment names another source.

use part_program::{Dialect, Part, ReadOptions, read_part, read_part_with};

fn part(text: &str) -> Part {
    read_part("p.ngc", text).unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

fn of(dialect: Dialect, text: &str) -> Part {
    let options = ReadOptions { dialect: Some(dialect), ..ReadOptions::default() };
    read_part_with("p.nc", text, options).unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

/// Where each curve ends on X.
fn ends(part: &Part) -> Vec<f64> {
    part.curves
        .iter()
        .map(|curve| curve.control_points_mm()[curve.control_points_mm().len() - 1][0])
        .collect()
}

/// The value of an expression, as the end of a move.
fn value(expression: &str) -> f64 {
    ends(&part(&format!("#5=3\n#6=-4\n#<width>=0.5\nG0 X-9999\nG1 X[{expression}]\n")))[0]
}

#[test]
fn expressions_have_the_values_of_rs274() {
    for (expression, expected) in [
        ("1 + 2 * 3", 7.0),
        ("2 * 3 ** 2", 18.0),
        ("2 - 3 - 4", -5.0),
        ("12 / 3 / 2", 2.0),
        ("#5 * -#6", 12.0),
        ("[#5 - #6] MOD 4", 3.0),
        ("-7 MOD 4", 1.0),
        ("#[#5 + 3]", -4.0),
        ("##5", 0.0),
        ("#<width> / 4", 0.125),
        ("#< WI dth > * 2", 1.0),
        ("SQRT[16] + ABS[#6]", 8.0),
        ("FIX[-2.5] + FUP[-2.5] * 100 + ROUND[2.5] * 1000", 2797.0),
        ("2 GT 1 AND 1 GT 2", 0.0),
        ("2 GT 1 OR 1 GT 2", 1.0),
        ("1 EQ 1.00001", 1.0),
        ("1 EQ 1.001", 0.0),
        ("EXISTS[#<width>] + EXISTS[#<none>] * 10", 1.0),
        ("1 (one) + 2 (and two)", 3.0),
        ("2**3**2", 64.0),
    ] {
        assert!((value(expression) - expected).abs() < 1e-12, "{expression}: {}", value(expression));
    }
    for (expression, expected) in [
        ("SIN[30]", 0.5),
        ("COS[60]", 0.5),
        ("TAN[45]", 1.0),
        ("ASIN[1]", 90.0),
        ("ACOS[0]", 90.0),
        ("ATAN[1]/[-1]", 135.0),
        ("ATAN[#5]/[3] * 2", 90.0),
        ("EXP[LN[5]]", 5.0),
    ] {
        assert!((value(expression) - expected).abs() < 1e-12, "{expression}: {}", value(expression));
    }
}

/// LinuxCNC evaluates a whole block before its variables have their new values.
#[test]
fn variables_change_behind_their_block() {
    assert_eq!(ends(&part("G0 X0\n#1=5\n#1=7 G1 X#1\nG1 X-#1\nG1 XABS[#1-20]\n")), [5.0, -7.0, 13.0]);
}

#[test]
fn loops_and_conditions_of_linuxcnc() {
    let text = "G0 X0 Y0
#1=0
o1 while [#1 LT 3]
  #1=[#1+1]
  o2 if [#1 EQ 1]
    G1 X10
  o2 elseif [#1 EQ 2]
    G1 X20
  o2 else
    G1 X30
  o2 endif
o1 endwhile
o3 repeat [2]
  G91 G1 X1
o3 endrepeat
G90
o4 do
  #1=[#1-1]
  o5 if [#1 EQ 1]
    o4 continue
  o5 endif
  G1 X[100+#1]
o4 while [#1 GT 0]
o6 while [1]
  #1=[#1+1]
  o7 if [#1 GT 2]
    o6 break
  o7 endif
o6 endwhile
G1 X#1
";
    let part = part(text);
    assert_eq!(ends(&part), [10.0, 20.0, 30.0, 31.0, 32.0, 102.0, 100.0, 3.0]);
    assert_eq!(part.moves.iter().map(|one| one.line).collect::<Vec<_>>(), [6, 8, 10, 14, 14, 22, 22, 30]);
    assert!(part.moves.windows(2).all(|pair| pair[0].block < pair[1].block));
}

#[test]
fn subroutines_of_linuxcnc_have_arguments_and_values() {
    let text = "o<twice> sub
  o1 if [#1 GT 100]
    o<twice> return [0]
  o1 endif
  G1 X#1
  #1=[#1*2]
o<twice> endsub [#1]
G0 X0
#1=7
o<twice> call [5] [6]
G1 X#<_value>
G1 X#1
o<TWICE> call [101]
G1 X[#<_value> + #<_value_returned>]
";
    assert_eq!(ends(&part(text)), [5.0, 10.0, 7.0, 1.0]);
}

/// A subroutine that calls itself has its own variables at each depth.
#[test]
fn a_subroutine_calls_itself() {
    let text = "o9 sub\no1 if [#1 GT 0]\nG1 X#1\no9 call [#1-1]\nG1 Y#1\no1 endif\no9 endsub\nG0 X0 Y0\no9 call [3]\n";
    let part = part(text);
    let last: Vec<_> =
        part.curves.iter().map(|curve| curve.control_points_mm()[1]).map(|p| (p[0], p[1])).collect();
    assert_eq!(last, [(3.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, 1.0), (1.0, 2.0), (1.0, 3.0)]);
}

/// By the macro manual of Series 30i.
#[test]
fn macros_of_fanuc() {
    let text = "%
O1
G0 X0
#1=0
WHILE [#1 LT 3] DO1
#1=#1+1
IF [#1 EQ 2] GOTO 10
G1 X#1
N10 END1
IF [#1 EQ 3] THEN #2=50
G1 X#2
G65 P9000 A1.5 B-2 I3 L2
M98 P20100
M98 P200 L1
G1 X#1
M30
O9000
G91 G1 X#1
X[#2*#4]
G90
M99
O100
G91 G1 X1
G90 M99
O200
GOTO 5
G1 X1000
N5 G1 X77
M99
%
";
    assert_eq!(
        ends(&of(Dialect::Fanuc, text)),
        [1.0, 3.0, 50.0, 51.5, 45.5, 47.0, 41.0, 42.0, 43.0, 77.0, 3.0]
    );
}

/// A vacant variable leaves out its word, and is not the same as 0.
#[test]
fn vacant_variables_of_fanuc() {
    let text = "G0 X0 Y0\n#2=0\nG1 X5 Y#1\nIF [#1 EQ #0] THEN #3=1\nIF [#2 EQ #0] THEN #3=2\nG1 X#3\n";
    assert_eq!(ends(&of(Dialect::Fanuc, text)), [5.0, 1.0]);
    let part = part("G0 X0 Y8\nG1 X5 Y#1\n");
    assert_eq!(part.curves[0].control_points_mm()[1], [5.0, 0.0, 0.0]);
    assert!(part.warnings[0].message.contains("has no value is taken as 0"), "{:?}", part.warnings);
}

#[test]
fn parameters_of_siemens() {
    let text =
        "R1=5\nR2=R1*2+1\nG0 X0 Y0\nG1 X=R2\nG1 X=(R1+1)*2 Y=-R1\nG1 X=R1*SIN(30)\nR[R1+1]=4\nG1 X=R6\n";
    let ends = ends(&part(text));
    assert!(
        ends.iter().zip([11.0, 12.0, 2.5, 4.0]).all(|(end, right)| (end - right).abs() < 1e-12),
        "{ends:?}"
    );
}

/// What a control knows of itself: rs274 prints `STRAIGHT_FEED` to these places.
#[test]
fn positions_and_settings_are_variables() {
    let inches = ends(&part("G20 G0 X1\nG1 X[#5420+2]\nG1 X[#<_x>+#<_imperial>]\n"));
    assert!(
        inches.iter().zip([3.0, 4.0]).all(|(end, inches)| (end - inches * 25.4).abs() < 1e-12),
        "{inches:?}"
    );
    assert_eq!(ends(&part("G0 X1\nG92 X10\nG1 X[#5420+1]\nG1 X[#<_metric>*2]\n")), [2.0, -7.0]);
    for (settings, name, expected) in [
        ("G18", "_plane", 180.0),
        ("G1", "_motion_mode", 10.0),
        ("G93", "_inverse_time", 1.0),
        ("G93", "_units_per_minute", 0.0),
        ("G90.1", "_ijk_absolute_mode", 1.0),
        ("S200", "_rpm", 200.0),
        ("", "_value", 0.0),
        ("", "_value_returned", 0.0),
        ("", "_ccomp", 400.0),
        ("", "_call_level", 0.0),
    ] {
        let text = format!("{settings}\n#1=#<{name}>\nG94 G0 X-1\nG1 X#1\n");
        assert_eq!(ends(&part(&text)), [expected], "{text}");
    }
    let text = "o2 sub\nG1 X[#<_call_level>*10]\no2 endsub\no1 sub\nG1 X#<_call_level>\no2 call\nG1 X[#<_call_level>+1]\n\
                o1 endsub\nG0 X0\no1 call\nG1 X[#<_call_level>+5]\n";
    assert_eq!(ends(&part(text)), [1.0, 20.0, 2.0, 5.0]);
}

#[test]
fn a_loop_without_an_end_is_stopped() {
    // Conditions, and searches for a block that another program has a hundred thousand times.
    let conditions = format!(
        "G0 X0\no9 while [1]\no1 if [0]\n{}o1 endif\no9 endwhile\n",
        "o1 elseif [0]\n".repeat(50_000)
    );
    let blocks = format!("G0 X0\nO1\nN8 X1\nGOTO 8\nO2\n{}", "N8\n".repeat(100_000));
    let short = ["G0 X0\no1 while [1]\no1 endwhile\n", "N1 GOTO 1\n", "O1\nM98 P1\nM99\n"];
    for text in short.into_iter().chain([&*conditions, &blocks]) {
        let errors = read_part("p", text).unwrap_err().to_string();
        assert!(errors.contains("executed again") || errors.contains("more than 100 calls"), "{errors}");
    }
}

/// The same line once gave a thousand messages, none of which named the turn.
#[test]
fn a_message_in_a_loop_names_its_turn() {
    let text = "G0 X0\n#1=3\no1 while [#1 GE 0]\n#1=[#1-1]\nG1 X[1/#1]\no1 endwhile\n";
    let errors = read_part("p", text).unwrap_err().to_string();
    assert!(errors.contains("a division by 0 (turn 3 of the loop of line 3)"), "{errors}");
    let errors = read_part("p", "o1 sub\nG1 X[1/0]\no1 endsub\nG0 X0\no1 call\n").unwrap_err().to_string();
    assert!(errors.contains("a division by 0 (called from line 5)"), "{errors}");
}

/// A word in a loop makes the machine rest in each turn, and only there.
#[test]
fn rests_follow_the_order_of_execution() {
    let part = part(
        "G0 X0\n#1=0\no1 while [#1 LT 2]\n#1=[#1+1]\nG1 X[#1*10]\nG1 X[#1*10+1]\nM8\no1 endwhile\nG1 X5\n",
    );
    let rests: Vec<_> = (1..5).map(|next| part.rest_before(next).is_some()).collect();
    assert_eq!(rests, [false, true, false, true]);
}

/// Comments hid the lines to which calls and loops lead, though not the commands themselves.
#[test]
fn comments_may_stand_around_labels() {
    let text = "(a) N1 (b) o1 (c) sub\nG1 X#1\n / (d) o1 (e) endsub\n(f) o<elseif> if [0]\no2 (g) repeat [2]\nG1 Y1\no2 endrepeat\n\
                (elseif [0]) o<elseif> (elseif) elseif [1]\nG1 X2\nN2(h)o<elseif> (i) endif\nG1 X3\n";
    assert_eq!(ends(&part(&format!("G0 X0\n{text}o1 (j) call (k) [5]\n"))), [2.0, 3.0, 5.0]);
}

/// The main program and its subprograms number their blocks alike: GOTO stays in its own.
#[test]
fn a_goto_stays_in_its_program() {
    let text = "O1\nG0 X0 F100\n#1=0\nN10 #1=#1+1\nG1 X#1\nIF [#1 LT 2] GOTO 10\nM98 P2\nGOTO 20\nG1 X98\nN20 M30\n\
                O2\nN10 G1 X50\nGOTO 20\nX99\nN20 X60\nM99\n";
    assert_eq!(ends(&of(Dialect::Fanuc, text)), [1.0, 2.0, 50.0, 60.0]);
    let text = "O1\nG0 X0 F100\nG1 X1\nGOTO 10\nM30\nO2\nN10 M99\n";
    let errors = read_part("p", text).unwrap_err().to_string();
    assert!(errors.contains("there is no block N10 in this program"), "{errors}");
}

/// M99 P goes to a block of the caller, behind the call first, and in a main program to one of its own.
#[test]
fn a_subprogram_returns_to_a_block() {
    let text = "O1\nG0 X0 F100\n#1=0\nN10 G1 X1\nM98 P2 L3\nG1 X99\nN10 G1 X2\nIF [#1 EQ 1] GOTO 30\n#1=1\nM99 P10\nN30 X4\nM30\n\
                O2\nG1 X[5+#1]\nM99 P10\n";
    assert_eq!(ends(&of(Dialect::Fanuc, text)), [1.0, 5.0, 2.0, 1.0, 6.0, 2.0, 4.0]);
}

/// By the macro manual of Series 30i, section 16.4: the bits of numbers, with AND as strong as `*`, OR and XOR as strong as `+`.
#[test]
fn logical_operators_of_fanuc_are_those_of_bits() {
    for (expression, expected) in [
        ("12 AND 10", 8.0),
        ("12 OR 3", 15.0),
        ("12 XOR 10", 6.0),
        ("6 AND 3 + 8", 10.0),
        ("8 + 6 AND 3", 10.0),
        ("1 + 4 OR 2", 7.0),
        ("[1 EQ 1] AND [2 GT 1]", 1.0),
        ("[1 EQ 1] AND [2 LT 1]", 0.0),
    ] {
        let part = of(Dialect::Fanuc, &format!("G0 X-9 F100\nG1 X[{expression}]\n"));
        assert_eq!(ends(&part), [expected], "{expression}");
    }
    assert_eq!(value("12 AND 10"), 1.0);
    let text = "G0 X-9 F100\nG1 X[1.5 AND 1]\n";
    let options = ReadOptions { dialect: Some(Dialect::Fanuc), ..ReadOptions::default() };
    let errors = read_part_with("p", text, options).unwrap_err().to_string();
    assert!(errors.contains("bits of a number that is not whole"), "{errors}");
}

/// A macro keeps the words in force, and ends with them: they were vacant, and G91 stayed.
#[test]
fn words_in_force_are_variables_of_fanuc() {
    let text = "O1\nG21 G90 G17 G0 X0 F100\nG55 G1 X1\nM98 P9\nX2\nM30\nO9\n#1=#4001\n#2=#4003\n#3=#4014\n#4=#4109\nG91 G0 X5\n\
                G#1 G#2 G#3 F#4\nX[#4002+#4006+#4005]\nM99\n";
    let part = of(Dialect::Fanuc, text);
    assert_eq!(ends(&part), [1.0, 6.0, 132.0, 2.0]);
    assert!(part.moves[3].feedrate_mm_per_s == Some(100.0 / 60.0), "{:?}", part.moves);
}

/// Each ATAN read its brackets twice, and so those within it four times: a line of 400 characters took hours.
#[test]
fn functions_within_one_another_are_read_once() {
    let text = format!("G0 X0\n#1=[{}1{}]\nG1 X[#1+2]\n", "ATAN[".repeat(60), ",1]".repeat(60));
    assert!(ends(&part(&text))[0] > 2.0, "{text}");
    let errors = read_part("p", &format!("G0 X[{}1,\n", "ATAN[".repeat(60))).unwrap_err().to_string();
    assert!(errors.contains("a value is missing here"), "{errors}");
}
