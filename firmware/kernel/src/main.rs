//! The program: on bare metal it prints a line a record and stops; on a host it prints the same lines.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod bare_metal;

#[cfg(not(target_os = "none"))]
struct Host;

#[cfg(not(target_os = "none"))]
impl kernel::Board for Host {
    fn paint_stack(&mut self) {}
    fn used_stack(&mut self) -> usize {
        0
    }
    fn record(&mut self, record: kernel::Record) {
        let kernel::Record { format, item, calls, checksum, .. } = record;
        println!("record {format} {item} {calls} {checksum:016x} 0");
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    kernel::run_all(&mut Host);
}
