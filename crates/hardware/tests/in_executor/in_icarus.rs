//! The core itself, in Icarus Verilog: its first setpoints are those of the executor. Skipped, and said so, where it is not installed.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use hardware::{CoreFiles, QUEUES};

use crate::paths::lines;
use crate::runs::compared;

/// Writes each setpoint as its output words in hexadecimal.
const LISTING: &str = "`timescale 1ns / 1ps
module listing;
reg clk = 0, reset = 1, start = 0;
reg [30:0] section = 0;
wire idle, done, valid, error;
wire [31:0] piece, offset_x, offset_y, length;
wire [63:0] phase;
wire [7:0] evaluations;
feedbits_core core(.clk(clk), .reset(reset), .table_write(1'b0), .table_address('d0), .table_data(64'd0), .start(start),
    .section(section), .idle(idle), .done(done),
    .tick(1'b0), .error(error), .setpoint_tvalid(valid), .setpoint_tready(valid), .setpoint_tdata(), .piece(piece), .phase(phase), .offset_x(offset_x),
    .offset_y(offset_y), .length(length), .evaluations(evaluations));
always #5 clk = !clk;
initial begin #45 reset = 0; end
always @(posedge clk) begin
    start <= idle && !start && !reset;
    if (start) section <= section + 1;
    if (valid) $display(\"%h %h %h %h %h %h\", piece, phase, offset_x, offset_y, length, evaluations);
    if (section == 4 && idle && !start) $finish;
end
endmodule
";

/// Takes a setpoint every `+period` cycles, a section's first one as soon as it is shown, and says how many were taken and whether
/// one was late.
const PACED: &str = "`timescale 1ns / 1ps
module paced #(parameter QUEUE = 4);
reg clk = 0, reset = 1, start = 0, rests = 1;
reg [30:0] section = 0;
integer period, since = 0, count = 0;
wire idle, done, valid, error;
wire tick = since >= period && (rests ? valid : !idle);
feedbits_core #(.QUEUE(QUEUE)) core(.clk(clk), .reset(reset), .table_write(1'b0), .table_address('d0), .table_data(64'd0),
    .start(start), .section(section), .idle(idle), .done(done), .tick(tick), .error(error), .setpoint_tvalid(valid),
    .setpoint_tready(tick));
always #5 clk = !clk;
initial begin if ($value$plusargs(\"period=%d\", period)) #45 reset = 0; end
always @(posedge clk) begin
    start <= idle && !start && !reset;
    if (start) section <= section + 1;
    since <= tick ? 1 : since + 1;
    if (tick && valid) count <= count + 1;
    rests <= idle || (rests && !tick);
    if (error || (section == 4 && idle && !start)) begin
        $display(\"%0d setpoints, late: %0d\", count, error);
        $finish;
    end
end
endmodule
";

/// Whether Icarus is there.
fn has_icarus() -> bool {
    let is_there = Command::new("iverilog").arg("-V").output().is_ok();
    if !is_there {
        eprintln!("skipped: iverilog is not installed");
    }
    is_there
}

/// Writes the core and a bench into the folder.
fn write(folder: &Path, core: &CoreFiles, bench: (&str, &str)) {
    let files =
        [("core.v", core.core.as_str()), ("microcode.hex", &core.microcode), ("part.hex", &core.part), bench];
    for (name, text) in files {
        std::fs::write(folder.join(name), text).expect("a file");
    }
}

/// What a program prints in this folder.
fn run(folder: &Path, program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).current_dir(folder).output().expect("a program");
    assert!(output.status.success(), "{program}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn no_setpoint_is_late_at_the_least_period_and_one_is_below() {
    if !has_icarus() {
        return;
    }
    let core = compared(&lines(), "I4F28");
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    write(folder, &core, ("paced.v", PACED));
    for (queue, least) in QUEUES.iter().zip(core.figures.least_periods).take(3) {
        let depth = format!("-Ppaced.QUEUE={queue}");
        run(folder, "iverilog", &["-g2005", "-s", "paced", &depth, "-o", "paced", "core.v", "paced.v"]);
        let at = |period: u64| run(folder, "vvp", &["paced", &format!("+period={period}")]);
        let all = format!("{} setpoints, late: 0", core.setpoints.len());
        let (least_said, below) = (at(least), at(least - 1));
        assert!(least_said.contains(&all), "a queue of {queue} at {least}: {least_said}");
        assert!(below.contains("late: 1"), "a queue of {queue} below {least}: {below}");
    }
}

#[test]
fn the_core_gives_what_the_executor_gives() {
    if !has_icarus() {
        return;
    }
    let core = compared(&lines(), "I4F28");
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    write(folder, &core, ("listing.v", LISTING));
    run(folder, "iverilog", &["-g2005", "-s", "listing", "-o", "simulation", "core.v", "listing.v"]);
    let said = run(folder, "vvp", &["simulation"]);
    let mut expected = String::new();
    for words in &core.setpoints {
        for (index, (word, (_, bits))) in words.iter().zip(&core.outputs).enumerate() {
            let digits = *bits as usize / 4;
            let _ = write!(expected, "{}{word:0digits$x}", if index == 0 { "" } else { " " });
        }
        expected.push('\n');
    }
    let found: Vec<_> =
        said.lines().filter(|line| line.split(' ').count() == 6 && !line.contains(':')).collect();
    for (period, (found, expected)) in found.iter().zip(expected.lines()).enumerate() {
        assert_eq!(*found, expected, "period {period}");
    }
    assert_eq!(found.len(), core.setpoints.len());

    // A row that is not there is unknown to a simulator, and unknown is not equal.
    std::fs::write(folder.join("testbench.v"), &core.testbench).expect("a file");
    run(folder, "iverilog", &["-g2005", "-s", "testbench", "-o", "played", "core.v", "testbench.v"]);
    let played = Command::new("vvp").args(["played", "+vectors=/dev/null"]).current_dir(folder).output();
    let played = played.expect("a program");
    let said = String::from_utf8_lossy(&played.stdout);
    assert!(
        !played.status.success() && said.contains("DIFFERS: the vectors have no row of period 0"),
        "{said}"
    );
}
