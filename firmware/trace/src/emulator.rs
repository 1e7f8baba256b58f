//! QEMU's log as a stream of executed instructions.
//!
//! The log holds the disassembly of each block of code once, when it is translated, and one line for each execution of
//! a block. A block ends with the first instruction that may branch, so it always runs to its end. Asked to, the
//! emulator makes every block one instruction long: the counts are the same, the log is five times as long. Nothing is
//! added to the emulator and nothing runs beside the kernel in the target.

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::Failure;
use crate::instruction::{Instruction, Set};
use crate::target::Target;

/// One executed instruction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Executed {
    pub(crate) address: u32,
    pub(crate) instruction: Instruction,
}

fn program(set: Set) -> &'static str {
    match set {
        Set::Thumb => "qemu-system-arm",
        Set::RiscV => "qemu-system-riscv32",
    }
}

fn version(program: &str) -> Result<String, Failure> {
    let output = Command::new(program).arg("--version").output().map_err(|e| format!("{program}: {e}"))?;
    Ok(String::from_utf8_lossy(&output.stdout).lines().next().unwrap_or_default().to_owned())
}

/// The options that make every block one instruction long: a property of the accelerator since QEMU 8.1.
fn one_at_a_time(program: &str) -> Result<&'static [&'static str], Failure> {
    let version = version(program)?;
    let number = version.split("version ").nth(1).unwrap_or_default();
    let mut parts = number.split(|c: char| !c.is_ascii_digit()).filter_map(|part| part.parse::<u32>().ok());
    let new = (parts.next(), parts.next()) >= (Some(8), Some(1));
    Ok(if new { &["-accel", "tcg,one-insn-per-tb=on"] } else { &["-singlestep"] })
}

/// Runs the image and hands every executed instruction to `each`; returns what was printed, and the emulator's version.
pub(crate) fn run(
    target: &Target,
    image: &Path,
    singly: bool,
    mut each: impl FnMut(Executed) -> Result<(), Failure>,
) -> Result<(String, String), Failure> {
    let program = program(target.set);
    let mut command = Command::new(program);
    command.args(["-machine", target.machine, "-display", "none", "-monitor", "none"]);
    match target.set {
        Set::Thumb => command.args([
            "-serial",
            "none",
            "-chardev",
            "stdio,id=console",
            "-semihosting-config",
            "enable=on,target=native,chardev=console",
        ]),
        Set::RiscV => command.args(["-bios", "none", "-serial", "stdio"]),
    };
    if singly {
        command.args(one_at_a_time(program)?);
    }
    command.args(["-d", "in_asm,exec,nochain"]).arg("-kernel").arg(image);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().map_err(|e| format!("{program}: {e}"))?;
    let (Some(mut stdout), Some(stderr)) = (child.stdout.take(), child.stderr.take()) else {
        return Err("no pipes to the emulator".into());
    };
    let console = std::thread::spawn(move || {
        let mut text = String::new();
        stdout.read_to_string(&mut text).map(|_| text)
    });
    let outcome = read(stderr, target.set, &mut each);
    if outcome.is_err() {
        let _ = child.kill();
    }
    let status = child.wait()?;
    let printed = console.join().map_err(|_| "the console's reader failed")??;
    outcome?;
    if !status.success() || printed.contains("panic") || printed.contains("fault") {
        return Err(format!("{}: ended with {status}, having printed:\n{printed}", target.name).into());
    }
    Ok((printed, version(program)?))
}

/// Parses the log.
///
/// A block is told by its address and the translator's flags, which are in its line of execution but not in the
/// disassembly before it. An execution is held back by one line: when the emulator is interrupted by its host just
/// before a block, it logs the execution, then that it was stopped, and then the same execution again.
fn read(
    log: impl Read,
    set: Set,
    each: &mut impl FnMut(Executed) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut reader = BufReader::with_capacity(1 << 20, log);
    let mut line = Vec::new();
    let mut blocks: Vec<Vec<Executed>> = Vec::new();
    let mut known: HashMap<Vec<u8>, usize> = HashMap::new();
    let mut translated: Vec<Executed> = Vec::new();
    let mut held: Option<usize> = None;
    let mut run = |block: Option<usize>, blocks: &[Vec<Executed>]| {
        block.and_then(|b| blocks.get(b)).into_iter().flatten().try_for_each(|executed| each(*executed))
    };
    loop {
        line.clear();
        if reader.read_until(b'\n', &mut line)? == 0 {
            break;
        }
        if line.starts_with(b"Trace ") {
            let (address, key) = traced(&line).ok_or_else(|| unreadable(&line))?;
            if translated.first().is_some_and(|first| first.address == address) {
                known.insert(key.to_vec(), blocks.len());
                blocks.push(std::mem::take(&mut translated));
            }
            let block = *known.get(key).ok_or_else(|| format!("{address:#x} ran without a disassembly"))?;
            run(held.replace(block), &blocks)?;
        } else if line.starts_with(b"0x") {
            let text = String::from_utf8_lossy(&line);
            let (address, instruction) = disassembled(&text, set).ok_or_else(|| unreadable(&line))?;
            translated.push(Executed { address, instruction });
        } else if line.starts_with(b"IN:") {
            translated.clear();
        } else if line.starts_with(b"Stopped execution") {
            held = None;
        }
    }
    run(held, &blocks)
}

fn unreadable(line: &[u8]) -> Failure {
    format!("the emulator's log has an unknown line: {}", String::from_utf8_lossy(line)).into()
}

/// `Trace 0: 0x7f… [base/address/flags/flags] symbol`: the address, and all that is in the brackets.
fn traced(line: &[u8]) -> Option<(u32, &[u8])> {
    let open = line.iter().position(|b| *b == b'[')? + 1;
    let length = line.get(open..)?.iter().position(|b| *b == b']')?;
    let key = line.get(open..open + length)?;
    let address = std::str::from_utf8(key.split(|b| *b == b'/').nth(1)?).ok()?;
    Some((u32::from_str_radix(address, 16).ok()?, key))
}

/// `0x00000142:  f7ff fffe  bl   #0x13c`: the bytes in groups, then the instruction.
fn disassembled(line: &str, set: Set) -> Option<(u32, Instruction)> {
    let (address, rest) = line.trim_end().strip_prefix("0x")?.split_once(':')?;
    let rest = rest.trim_start();
    let is_code = |group: &&str| matches!(group.len(), 4 | 8) && group.bytes().all(|b| b.is_ascii_hexdigit());
    let mut groups = rest.split_whitespace().peekable();
    let mut size = 0;
    // At most four bytes, so that a mnemonic such as `adcs` is never taken for code.
    while let Some(group) = groups.next_if(|group| is_code(group) && size + group.len() <= 8) {
        size += group.len();
    }
    let text: Vec<_> = groups.collect();
    let (mnemonic, operands) = text.split_first()?;
    let bytes = u32::try_from(size / 2).ok()?;
    Some((
        u32::from_str_radix(address, 16).ok()?,
        Instruction::parse(set, mnemonic, &operands.join(" "), bytes),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instruction::Class;

    #[test]
    fn a_trace_line_has_an_address() {
        let line = b"Trace 0: 0x7f5e9c000100 [00000000/00000142/00000110/ff000201] k_step_f32\n";
        assert_eq!(traced(line), Some((0x142, &b"00000000/00000142/00000110/ff000201"[..])));
    }

    #[test]
    fn disassembly_has_address_size_and_kind() {
        let (address, found) = disassembled("0x00000142:  f7ff fffe  bl       #0x13c\n", Set::Thumb).unwrap();
        assert_eq!((address, found.bytes, found.class), (0x142, 4, Class::Call));
        let (_, found) = disassembled("0x00000142:  4148       adcs     r0, r1\n", Set::Thumb).unwrap();
        assert_eq!((found.bytes, found.class), (2, Class::Alu));
        let (_, found) =
            disassembled("0x80000010:  02f70733          mul             a4,a4,a5\n", Set::RiscV).unwrap();
        assert_eq!((found.bytes, found.class), (4, Class::Multiply));
    }
}
