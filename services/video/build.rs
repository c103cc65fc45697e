//! Says so when the H.264 codec is about to be built without its assembly, which nothing else does.

use std::process::{Command, Stdio};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=PATH");
    let x86 = std::env::var("CARGO_CFG_TARGET_ARCH").is_ok_and(|arch| arch == "x86" || arch == "x86_64");
    let assembler = Command::new("nasm").arg("-v").stdout(Stdio::null()).stderr(Stdio::null()).status();
    if x86 && !assembler.is_ok_and(|status| status.success()) {
        println!(
            "cargo::warning=nasm is missing, so H.264 is built from C++ alone, which works but takes longer for each \
             picture; install nasm (Debian: apt-get install nasm), then: cargo clean -p openh264-sys2"
        );
    }
}
