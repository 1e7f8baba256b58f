//! The core itself, in Icarus Verilog: its first setpoints are those of the executor. Skipped, and said so, where it is not installed.

use std::fmt::Write;
use std::process::Command;

use crate::paths::lines;
use crate::runs::compared;

/// Writes each setpoint as its output words in hexadecimal.
const LISTING: &str = "`timescale 1ns / 1ps
module listing;
reg clk = 0, reset = 1, start = 0;
reg [30:0] section = 0;
wire idle, done, valid;
wire [31:0] piece, offset_x, offset_y, length;
wire [63:0] phase;
wire [7:0] evaluations;
feedbits_core core(.clk(clk), .reset(reset), .table_write(1'b0), .table_address('d0), .table_data(64'd0), .start(start),
    .section(section), .idle(idle), .done(done), .valid(valid), .ready(valid), .piece(piece), .phase(phase), .offset_x(offset_x),
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

#[test]
fn the_core_gives_what_the_executor_gives() {
    if Command::new("iverilog").arg("-V").output().is_err() {
        eprintln!("skipped: iverilog is not installed");
        return;
    }
    let core = compared(&lines(), "I4F28");
    let folder = tempfile::tempdir().expect("a folder");
    let files = [
        ("core.v", core.core.as_str()),
        ("microcode.hex", &core.microcode),
        ("part.hex", &core.part),
        ("listing.v", LISTING),
    ];
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    let run = |program: &str, arguments: &[&str]| {
        let output =
            Command::new(program).args(arguments).current_dir(folder.path()).output().expect("a program");
        assert!(output.status.success(), "{program}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    run("iverilog", &["-g2005", "-s", "listing", "-o", "simulation", "core.v", "listing.v"]);
    let said = run("vvp", &["simulation"]);
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
    std::fs::write(folder.path().join("testbench.v"), &core.testbench).expect("a file");
    run("iverilog", &["-g2005", "-s", "testbench", "-o", "played", "core.v", "testbench.v"]);
    let played =
        Command::new("vvp").args(["played", "+vectors=/dev/null"]).current_dir(folder.path()).output();
    let played = played.expect("a program");
    let said = String::from_utf8_lossy(&played.stdout);
    assert!(
        !played.status.success() && said.contains("DIFFERS: the vectors have no row of period 0"),
        "{said}"
    );
}
