//! Dev.
fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, stem, bits, fraction, out] = arguments.as_slice() else { panic!() };
    let name = std::path::Path::new(stem).file_name().unwrap().to_string_lossy().into_owned();
    let header = std::fs::read_to_string(format!("{stem}.h")).unwrap();
    let source = std::fs::read_to_string(format!("{stem}.c")).unwrap();
    let periods = header.lines().find_map(|l| l.split_once("_PERIODS UINT32_C(")).unwrap().1.trim_end_matches(')').parse().unwrap();
    let checksum = u64::from_str_radix(header.lines().find_map(|l| l.split_once("_CHECKSUM 0x")).unwrap().1.trim_end_matches("ULL"), 16).unwrap();
    let request = hardware::CoreRequest { header: &header, source: &source, name: &name, about: "x", bits: bits.parse().unwrap(), fraction_bits: fraction.parse().unwrap(), periods, checksum };
    match hardware::compile(&request) {
        Err(e) => println!("refused: {e}"),
        Ok(files) => {
            println!("{:?}", files.figures);
            std::fs::create_dir_all(out).unwrap();
            for (n, t) in [("core.v", &files.core), ("microcode.hex", &files.microcode), ("part.hex", &files.part), ("testbench.v", &files.testbench)] { std::fs::write(format!("{out}/{n}"), t).unwrap(); }
        }
    }
}
