#![no_main]

use libfuzzer_sys::fuzz_target;
use part_program::read_machine;

fuzz_target!(|text: &str| {
    if let Err(errors) = read_machine("any", text) {
        assert!(errors.count() > 0 && !errors.to_string().is_empty());
    }
});
